//! Lasting contact without a closed form: a group of marbles on its own adaptive clock.
//!
//! Each step solves the contacts' impulses together (block Gauss–Seidel with exact Coulomb blocks), moves every centre along the parabola that joins the two
//! ends, and puts the centres back onto the surfaces they touch. Between its ends a step is a parabola like any other motion, so collisions with
//! others are found exactly on the path that is really taken.

use super::Marbles;
use super::body::{Ending, Marble, Phase};
use super::closed;
use super::solve::{Contact, Member, With};
use crate::mechanics::Link;
use crate::scenery::Surface;
use glam::DVec3;

/// Work space of [`settle`].
#[derive(Debug, Default)]
pub struct MarbleScratch {
    members: Vec<Member>,
    contacts: Vec<Contact>,
}

/// Passes over normals and impulses within a step: the first predicts the end, the second uses it.
const PASSES: usize = 2;

/// Corrections of position per step; each reduces what overlapping corrections leave by about half.
const CORRECTIONS: usize = 6;

/// Speed over `√(g r)` with which a contact that bears no load is let go. So small that it is no motion, so large that rounding cannot re-trigger the contact.
const LET_GO: f64 = 1e-12;

/// How often a step is quartered to find when a contact ends within it: to 1/64 of a step.
const SHORTENINGS: usize = 4;

/// Closing acceleration over g from which a contact without load is kept for one more short step. Default 1e-6; smaller is rounding.
const PRESSES: f64 = 1e-6;

/// Approach over `√(g r)` along a lasting contact that a step may start with. Default 1e-9: a step then starts into the surface by less than 1e-9 radii.
const APPROACH: f64 = 1e-9;

/// Decides how a group of marbles goes on.
pub(super) fn settle(world: &Marbles, members: &[u32], bodies: &mut [Marble], links: &mut Vec<Link>, scratch: &mut MarbleScratch) {
    for &k in members {
        follow_contacts(world, k as usize, &mut bodies[k as usize]);
    }
    if let [only] = *members {
        let (index, body) = (only as usize, &mut bodies[only as usize]);
        if body.contacts().is_empty() {
            return body.begin(Phase::Flight, world.gravity);
        }
        if let &[surface] = body.contacts()
            && closed::begin(world, index, body, surface)
        {
            return;
        }
    }
    scratch.gather(world, members, bodies, links);
    scratch.stop_approach(world, bodies);
    if !scratch.try_rest(world, bodies) {
        scratch.step(world, bodies, links);
    }
}

/// Lets contacts follow the surface, and ends those that separate.
fn follow_contacts(world: &Marbles, index: usize, body: &mut Marble) {
    let at_end = body.path.t >= body.expiry;
    let leaves = match body.ending {
        Ending::Leaves(side) if at_end => Some(side),
        _ => None,
    };
    let was_waiting = body.phase == Phase::Waiting;
    body.ending = Ending::Plain;
    if was_waiting || body.contacts().is_empty() {
        return;
    }
    let (x, v, scale) = (body.path.x, body.path.v, world.speed_scale(index));
    body.revise_contacts(|surface| {
        let surface = match (leaves, surface) {
            (Some(side), Surface::Face(f)) => across(world, f, usize::from(side)),
            _ => world.scenery.track(surface, x)?,
        };
        let speed = v.dot(world.scenery.foot(surface, x).normal);
        let law = world.surface_law(index, surface);
        (speed <= world.settle_speed(scale, law).max(LET_GO * scale)).then_some(surface)
    });
}

/// What lies beyond a side of a triangle: its neighbour where they are level, else the edge.
fn across(world: &Marbles, f: u32, side: usize) -> Surface {
    let mesh = world.scenery.mesh();
    let face = &mesh.faces[f as usize];
    if let Some(g) = face.neighbours[side]
        && mesh.faces[g as usize].normal.cross(face.normal).length() <= 1e-12
    {
        return Surface::Face(g);
    }
    let (a, b) = (face.corners[side], face.corners[(side + 1) % 3]);
    mesh.edge_between(a, b).map_or(Surface::Face(f), Surface::Edge)
}

impl MarbleScratch {
    fn gather(&mut self, world: &Marbles, indices: &[u32], bodies: &[Marble], links: &[Link]) {
        self.members.clear();
        for &k in indices {
            let (s, b) = (&world.specs[k as usize], &bodies[k as usize]);
            let inertia = s.gyration * s.mass * s.radius * s.radius;
            let (start, start_v, start_w) = (b.path.x, b.path.v, b.spin);
            self.members.push(Member {
                index: k,
                mass: s.mass,
                inertia,
                radius: s.radius,
                gyration: s.gyration,
                start,
                start_v,
                start_w,
                v: start_v,
                w: start_w,
                x: start,
                is_held: false,
            });
        }
        // Bottom first, then by position: loads travel up in one sweep, and the order knows nothing of labels.
        let g = world.gravity;
        self.members.sort_by(|a, b| {
            let key = |m: &Member| [-g.dot(m.start), m.start.x, m.start.y, m.start.z];
            let (p, q) = (key(a), key(b));
            p.iter().zip(&q).map(|(s, t)| s.total_cmp(t)).find(|o| o.is_ne()).unwrap_or(std::cmp::Ordering::Equal)
        });
        self.contacts.clear();
        for a in 0..self.members.len() {
            let index = self.members[a].index;
            for &surface in bodies[index as usize].contacts() {
                let normal = world.scenery.foot(surface, self.members[a].start).normal;
                self.contacts.push(Contact::new(a, With::Surface(surface), *world.surface_law(index as usize, surface), normal));
            }
            for b in 0..a {
                let other = self.members[b].index;
                if !links.is_empty() && links.contains(&[index.min(other), index.max(other)]) {
                    let law = *world.pair_law(index as usize, other as usize);
                    let normal = (self.members[a].start - self.members[b].start).normalize_or(DVec3::Z);
                    self.contacts.push(Contact::new(a, With::Member(b), law, normal));
                }
            }
        }
    }

    /// Takes away what slow approach is left along lasting contacts, so that no step starts into a surface.
    fn stop_approach(&mut self, world: &Marbles, bodies: &mut [Marble]) {
        let approaches = |c: &Contact| {
            let a = &self.members[c.a];
            let other = match c.with {
                With::Surface(_) => DVec3::ZERO,
                With::Member(b) => self.members[b].start_v,
            };
            -(a.start_v - other).dot(c.first) > APPROACH * (world.strength * a.radius).sqrt()
        };
        if !self.contacts.iter().any(approaches) {
            return;
        }
        self.sweep(world, self.step_length(world));
        self.clear();
        for m in &mut self.members {
            (m.start_v, m.start_w) = (m.v, m.w);
            let body = &mut bodies[m.index as usize];
            (body.path.v, body.spin) = (m.v, m.w);
        }
    }

    /// Length of the next step: a part of the time in which gravity, or the motion, covers the curvature of what is touched.
    fn step_length(&self, world: &Marbles) -> f64 {
        let mut shortest = f64::INFINITY;
        for c in &self.contacts {
            let m = &self.members[c.a];
            let (scale, speed) = match c.with {
                With::Surface(s) => {
                    let curvature = world.scenery.foot(s, m.start).curvature_radius;
                    let scale = if curvature < 0.0 { -curvature - m.radius } else if curvature.is_finite() { curvature + m.radius } else { m.radius };
                    (scale, m.start_v.length())
                }
                With::Member(b) => (0.5 * (m.radius + self.members[b].radius), (m.start_v - self.members[b].start_v).length()),
            };
            shortest = shortest.min((scale / world.strength).sqrt()).min(scale / speed);
        }
        world.accuracy.step * shortest
    }

    /// Rest, where everything is slow and the contacts can hold everything still.
    fn try_rest(&mut self, world: &Marbles, bodies: &mut [Marble]) -> bool {
        let slow = self.members.iter().all(|m| {
            let limit = world.accuracy.rest_speed * (world.strength * m.radius).sqrt();
            m.start_v.length() <= limit && m.start_w.length() * m.radius <= limit
        });
        if !slow || self.contacts.is_empty() {
            return false;
        }
        let h = self.step_length(world);
        if !h.is_finite() {
            return false;
        }
        for m in &mut self.members {
            (m.v, m.w, m.x) = (world.gravity * h, DVec3::ZERO, m.start);
        }
        self.sweep(world, h);
        self.clear();
        let left = self.members.iter().map(|m| m.v.length().max(m.w.length() * m.radius)).fold(0.0, f64::max);
        if left > world.accuracy.rest_residual * world.strength * h {
            return false;
        }
        for m in &self.members {
            let body = &mut bodies[m.index as usize];
            (body.path.v, body.spin) = (DVec3::ZERO, DVec3::ZERO);
            body.begin(Phase::Rest, DVec3::ZERO);
        }
        true
    }

    /// Solves all contacts for members whose velocities are free of them, starting from the impulses that the contacts hold.
    fn sweep(&mut self, world: &Marbles, h: f64) {
        if let [only] = &mut self.contacts[..] {
            only.clear();
            only.solve(&mut self.members);
            return;
        }
        for c in &self.contacts {
            c.apply(&mut self.members);
        }
        let enough = world.accuracy.sweep_tolerance * world.strength * h;
        for _ in 0..world.accuracy.sweeps {
            // Up and down again: the lowest contacts come last, so that nothing is left moving into the scenery.
            let mut change: f64 = 0.0;
            for c in &mut self.contacts {
                c.solve(&mut self.members);
            }
            for c in self.contacts.iter_mut().rev() {
                change = change.max(c.solve(&mut self.members));
            }
            if change <= enough {
                break;
            }
        }
    }

    fn clear(&mut self) {
        for c in &mut self.contacts {
            c.clear();
        }
    }

    fn step(&mut self, world: &Marbles, bodies: &mut [Marble], links: &mut Vec<Link>) {
        let mut h = self.step_length(world);
        if h.is_finite() {
            for _ in 0..SHORTENINGS {
                self.clear();
                self.solve(world, bodies, h);
                if !self.contacts.iter().any(|c| c.load == 0.0 && self.still_presses(world, c, h, |m| (m.v - m.start_v) / h)) {
                    break;
                }
                h *= 0.25;
            }
        }
        if h.is_finite() {
            self.put_back(world);
            self.guard_energy(world);
        }
        self.let_go(world, bodies, links, h);
        for m in &self.members {
            let body = &mut bodies[m.index as usize];
            if !m.is_held {
                body.begin(Phase::Flight, world.gravity);
                continue;
            }
            body.begin(Phase::Step, (m.x - m.start - body.path.v * h) * (2.0 / (h * h)));
            body.spin_rate = (m.w - m.start_w) / h;
            body.end_velocity = m.v;
            body.expiry = body.path.t + h;
        }
    }

    fn solve(&mut self, world: &Marbles, bodies: &[Marble], h: f64) {
        for m in &mut self.members {
            let body = &bodies[m.index as usize];
            let pull = if body.phase == Phase::Step { body.path.a } else { DVec3::ZERO };
            m.x = m.start + (m.start_v + pull * (0.5 * h)) * h;
        }
        for _ in 0..PASSES {
            for c in &mut self.contacts {
                let x = self.members[c.a].x;
                c.last = match c.with {
                    With::Surface(s) => world.scenery.foot(s, x).normal,
                    With::Member(b) => (x - self.members[b].x).normalize_or(c.first),
                };
            }
            for m in &mut self.members {
                (m.v, m.w) = (m.start_v + world.gravity * h, m.start_w);
            }
            self.sweep(world, h);
            for m in &mut self.members {
                m.x = m.start + (m.start_v + m.v) * (0.5 * h);
            }
        }
    }

    /// Whether the gap of a contact would still close at the start of a step, though it bears no load over the whole of it: the contact ends within the step.
    fn still_presses(&self, world: &Marbles, c: &Contact, h: f64, acceleration: impl Fn(&Member) -> DVec3) -> bool {
        let a = &self.members[c.a];
        // Rate of v · n at the start: by the forces, and by the turning of the normal, seen over a small part of the step.
        let dt = h * (1.0 / 64.0);
        let (v, pull, soon) = match c.with {
            With::Surface(s) => (a.start_v, acceleration(a), world.scenery.foot(s, a.start + a.start_v * dt).normal),
            With::Member(b) => {
                let b = &self.members[b];
                let v = a.start_v - b.start_v;
                (v, acceleration(a) - acceleration(b), (a.start - b.start + v * dt).normalize_or(c.first))
            }
        };
        let rate = pull.dot(c.first) + v.dot(soon - c.first) / dt;
        rate < -PRESSES * world.strength
    }

    /// Ends the contacts that bore no load, with a speed that keeps rounding from finding them again at once.
    fn let_go(&mut self, world: &Marbles, bodies: &mut [Marble], links: &mut Vec<Link>, h: f64) {
        for m in &mut self.members {
            m.is_held = false;
        }
        for c in &self.contacts {
            let index = self.members[c.a].index;
            if c.load > 0.0 || (h.is_finite() && self.still_presses(world, c, h, |m| m.acceleration(h))) {
                self.members[c.a].is_held = true;
                if let With::Member(b) = c.with {
                    self.members[b].is_held = true;
                }
                continue;
            }
            let least = LET_GO * world.speed_scale(index as usize);
            let body = &mut bodies[index as usize];
            let mut speed = body.path.v.dot(c.first);
            match c.with {
                With::Surface(s) => body.revise_contacts(|t| (t != s).then_some(t)),
                With::Member(b) => {
                    let other = self.members[b].index;
                    links.retain(|&l| l != [index.min(other), index.max(other)]);
                    speed -= bodies[other as usize].path.v.dot(c.first);
                }
            }
            if speed < least {
                bodies[index as usize].path.v += c.first * (least - speed);
            }
        }
    }

    /// Puts centres back onto what they touch; the scenery has the last word.
    fn put_back(&mut self, world: &Marbles) {
        let rounds = if self.contacts.len() == 1 { 1 } else { CORRECTIONS };
        for _ in 0..rounds {
            for c in self.contacts.iter().rev() {
                let m = self.members[c.a];
                match c.with {
                    With::Surface(s) => {
                        let foot = world.scenery.foot(s, m.x);
                        if c.load == 0.0 && foot.distance >= m.radius {
                            continue;
                        }
                        self.members[c.a].x = m.x + foot.normal * (m.radius - foot.distance);
                    }
                    With::Member(b) => {
                        let other = self.members[b];
                        let offset = m.x - other.x;
                        let distance = offset.length();
                        if c.load == 0.0 && distance >= m.radius + other.radius {
                            continue;
                        }
                        let missing = (m.radius + other.radius - distance) / (m.mass + other.mass);
                        let normal = if distance > 0.0 { offset / distance } else { c.last };
                        self.members[c.a].x = m.x + normal * (missing * other.mass);
                        self.members[b].x = other.x - normal * (missing * m.mass);
                    }
                }
            }
        }
    }

    /// Takes back what discretisation added: a group's energy never grows.
    fn guard_energy(&mut self, world: &Marbles) {
        let kinetic = |m: &Member, v: DVec3, w: DVec3| 0.5 * (m.mass * v.length_squared() + m.inertia * w.length_squared());
        let held = || self.members.iter();
        let before: f64 = held().map(|m| kinetic(m, m.start_v, m.start_w) + m.mass * world.gravity.dot(m.x - m.start)).sum();
        let after: f64 = held().map(|m| kinetic(m, m.v, m.w)).sum();
        if after > before {
            let part = (before.max(0.0) / after).sqrt();
            for m in &mut self.members {
                m.v *= part;
                m.w *= part;
            }
        }
    }
}
