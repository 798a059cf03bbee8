//! Boxes in a row in a vertical plane, without restitution: a wave of dominoes, in steps of one length.
//!
//! Moreau's steps over all contacts at once: corners on the floor, and corners of a box on a face of its neighbour. A
//! corner that is still apart may come as near as its gap within the step, so no time of contact has to be found.

use glam::DVec2;
use std::collections::BTreeMap;

/// A row of identical boxes.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    /// Half the thickness and half the height, in m.
    pub half: DVec2,
    /// Distance of neighbours' centres at the start, in m.
    pub pitch: f64,
    pub count: usize,
    pub friction: f64,
    pub gravity: f64,
    /// Rate at which the first box tips about its lower front edge, in rad/s.
    pub push: f64,
}

#[derive(Debug, Clone, Copy)]
struct Body {
    x: DVec2,
    /// How far it leans forward, in rad.
    lean: f64,
    v: DVec2,
    w: f64,
    /// Nothing happens to it until its neighbour comes near.
    sleeps: bool,
}

/// A corner on the floor, or on a face of another box.
#[derive(Debug, Clone, Copy)]
struct Contact {
    /// The body with the corner, the corner, and the other body; for the floor, the body itself.
    key: (usize, usize, usize),
    /// Towards the corner's body.
    normal: DVec2,
    arms: [DVec2; 2],
    gap: f64,
    impulse: DVec2,
}

const SWEEPS: usize = 300;
const CHANGE: f64 = 1e-9;

fn turned(lean: f64, p: DVec2) -> DVec2 {
    let (s, c) = plaus_dist::math::sin_cos(lean);
    DVec2::new(c * p.x + s * p.y, c * p.y - s * p.x)
}

/// Velocity of a point by rotation.
fn swing(w: f64, arm: DVec2) -> DVec2 {
    DVec2::new(w * arm.y, -w * arm.x)
}

fn moment(arm: DVec2, impulse: DVec2) -> f64 {
    arm.y * impulse.x - arm.x * impulse.y
}

impl Row {
    /// Moment of inertia per mass.
    fn inertia(&self) -> f64 {
        self.half.length_squared() / 3.0
    }

    fn corner(&self, k: usize) -> DVec2 {
        self.half * DVec2::new([-1.0, 1.0][k & 1], [-1.0, 1.0][k >> 1])
    }

    /// When each box was first pushed by the one before it; none for boxes that were not pushed by `until`.
    pub fn wave(&self, until: f64, dt: f64) -> Vec<Option<f64>> {
        let mut bodies: Vec<Body> = (0..self.count)
            .map(|k| {
                let x = DVec2::new(k as f64 * self.pitch, self.half.y);
                Body { x, lean: 0.0, v: DVec2::ZERO, w: 0.0, sleeps: k > 0 }
            })
            .collect();
        bodies[0].w = self.push;
        bodies[0].v = swing(self.push, DVec2::new(-self.half.x, self.half.y));
        let (mut times, mut kept) = (vec![None; self.count], BTreeMap::new());
        for step in 0..(until / dt) as usize {
            let contacts = self.step(&mut bodies, &kept, dt);
            for c in contacts.iter().filter(|c| c.impulse != DVec2::ZERO && c.key.0 != c.key.2) {
                times[c.key.0.max(c.key.2)].get_or_insert((step + 1) as f64 * dt);
            }
            if times[self.count - 1].is_some() {
                break;
            }
            kept = contacts.into_iter().map(|c| (c.key, c.impulse)).collect();
        }
        times
    }

    fn step(&self, bodies: &mut [Body], kept: &BTreeMap<(usize, usize, usize), DVec2>, dt: f64) -> Vec<Contact> {
        let mut contacts = self.contacts(bodies, dt);
        for b in bodies.iter_mut().filter(|b| !b.sleeps) {
            b.v.y -= self.gravity * dt;
        }
        for c in &mut contacts {
            c.impulse = kept.get(&c.key).copied().unwrap_or(DVec2::ZERO);
            self.push(bodies, c, c.impulse);
        }
        for _ in 0..SWEEPS {
            let mut change = 0.0_f64;
            for c in &mut contacts {
                let new = self.solve(bodies, c, dt);
                let more = new - c.impulse;
                self.push(bodies, c, more);
                c.impulse = new;
                change = change.max(more.length());
            }
            if change <= CHANGE * self.gravity * dt {
                break;
            }
        }
        for b in bodies.iter_mut() {
            b.x += b.v * dt;
            b.lean += b.w * dt;
        }
        contacts
    }

    /// Impulses are per mass.
    fn push(&self, bodies: &mut [Body], c: &Contact, impulse: DVec2) {
        let inertia = self.inertia();
        let a = &mut bodies[c.key.0];
        a.v += impulse;
        a.w += moment(c.arms[0], impulse) / inertia;
        if c.key.2 != c.key.0 {
            let b = &mut bodies[c.key.2];
            b.v -= impulse;
            b.w -= moment(c.arms[1], impulse) / inertia;
        }
    }

    fn solve(&self, bodies: &[Body], c: &Contact, dt: f64) -> DVec2 {
        let (a, b) = (&bodies[c.key.0], &bodies[c.key.2]);
        let is_pair = c.key.0 != c.key.2;
        let mut u = a.v + swing(a.w, c.arms[0]);
        if is_pair {
            u -= b.v + swing(b.w, c.arms[1]);
        }
        let along = DVec2::new(c.normal.y, -c.normal.x);
        let response = |n: DVec2| {
            let one = |arm: DVec2| 1.0 + moment(arm, n) * moment(arm, n) / self.inertia();
            one(c.arms[0]) + if is_pair { one(c.arms[1]) } else { 0.0 }
        };
        let normal = (c.impulse.dot(c.normal) - (u.dot(c.normal) + c.gap / dt) / response(c.normal)).max(0.0);
        let most = self.friction * normal;
        let rub = (c.impulse.dot(along) - u.dot(along) / response(along)).clamp(-most, most);
        c.normal * normal + along * rub
    }

    fn contacts(&self, bodies: &mut [Body], dt: f64) -> Vec<Contact> {
        let mut found = Vec::new();
        for i in 0..bodies.len() - 1 {
            if bodies[i].sleeps {
                break;
            }
            let first = found.len();
            for [a, b] in [[i, i + 1], [i + 1, i]] {
                self.corners_on(&bodies[a], &bodies[b], [a, b], dt, &mut found);
            }
            bodies[i + 1].sleeps &= found.len() == first;
        }
        for (i, b) in bodies.iter().enumerate().filter(|(_, b)| !b.sleeps) {
            for k in 0..4 {
                let arm = turned(b.lean, self.corner(k));
                let gap = b.x.y + arm.y;
                if gap < self.near(dt) {
                    let impulse = DVec2::ZERO;
                    found.push(Contact { key: (i, k, i), normal: DVec2::Y, arms: [arm, DVec2::ZERO], gap, impulse });
                }
            }
        }
        found
    }

    /// How near boxes may be to come together within a step, at up to twice √(g·height).
    fn near(&self, dt: f64) -> f64 {
        4.0 * (2.0 * self.gravity * self.half.y).sqrt() * dt
    }

    fn corners_on(&self, a: &Body, b: &Body, [i, j]: [usize; 2], dt: f64, found: &mut Vec<Contact>) {
        for k in 0..4 {
            let arm = turned(a.lean, self.corner(k));
            let there = turned(-b.lean, a.x + arm - b.x);
            let out = there.abs() - self.half;
            let gap = out.x.max(out.y);
            // Beside the other box, not beyond a corner of it.
            if gap >= self.near(dt) || out.x.min(out.y) > 0.0 {
                continue;
            }
            let side = if out.x > out.y { DVec2::X * there.x.signum() } else { DVec2::Y * there.y.signum() };
            let normal = turned(b.lean, side);
            let arms = [arm, a.x + arm - b.x - normal * gap];
            found.push(Contact { key: (i, k, j), normal, arms, gap, impulse: DVec2::ZERO });
        }
    }
}
