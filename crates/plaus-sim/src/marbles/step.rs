//! Lasting contact without a closed form: a group of marbles on its own adaptive clock.
//!
//! Each step solves the contacts' impulses together (block Gauss–Seidel with exact Coulomb blocks), moves every centre along the parabola that joins the two
//! ends, and puts the centres back onto the surfaces they touch. Between its ends a step is a parabola like any other motion, so collisions with
//! others are found exactly on the path that is really taken.

use super::Marbles;
use super::body::{Ending, Marble, Phase};
use super::{alone, closed};
use super::solve::{Contact, Member, With};
use crate::links::{Link, Links};
use crate::scenery::Surface;
use glam::DVec3;

/// Work space for groups of marbles in lasting contact.
#[derive(Debug, Default)]
pub struct MarbleScratch {
    members: Vec<Member>,
    contacts: Vec<Contact>,
}

/// Sweeps of the pass that only predicts where a step ends.
const PREDICT: u32 = 3;

/// Most corrections of position per step; more than two are rare outside piles.
const CORRECTIONS: usize = 40;

/// Change of a sweep over what rest may leave, at which no rest is in sight. Default 0.03: sweeps shrink by about half, so that little is still to come.
const CREEP: f64 = 0.03;

/// Overlap over the radius that rest may keep. Default 2e-5.
pub(super) const OVERLAP: f64 = 2e-5;

/// Overlap over the radius that needs no further correction. Default 1e-6.
const CORRECTED: f64 = 1e-6;

/// Separating speed over `√(g r)` plus the body's own that never ends a contact. Default 1e-9: far above rounding, far below any motion.
const KEEP: f64 = 1e-9;

/// Approach along a lasting contact that a step may start with, over the speed at which contacts settle. Default 0.02: a path then dips into the surface by less than
/// 1e-4 radii at the standard preset.
pub(super) const APPROACH: f64 = 0.02;

/// Decides how a group of marbles goes on.
pub(super) fn settle(
    world: &Marbles,
    members: &[u32],
    bodies: &mut [Marble],
    links: &mut Links,
    scratch: &mut MarbleScratch,
) {
    for &k in members {
        follow_contacts(world, k as usize, &mut bodies[k as usize]);
    }
    if !links.is_empty() {
        links.retain(|link| members.binary_search(&link[0]).is_err() || link_lasts(world, link, bodies));
    }
    if let [only] = *members {
        let (index, body) = (only as usize, &mut bodies[only as usize]);
        if body.contacts().is_empty() {
            return body.begin(Phase::Flight, world.gravity);
        }
        if let &[surface] = body.contacts() {
            if !closed::begin(world, index, body, surface) {
                alone::settle(world, index, body, surface);
            }
            return;
        }
    }
    scratch.gather(world, members, bodies, links);
    scratch.stop_approach(world, bodies);
    if !scratch.try_rest(world, bodies) {
        scratch.step(world, bodies);
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
    let (x, v, radius) = (body.path.x, body.path.v, world.specs[index].radius);
    let scale = world.speed_scale(index);
    let (before, count) = (*body.contacts_in_full(), body.contacts().len());
    body.revise_contacts(|old| {
        let surface = match (leaves, old) {
            (Some(side), Surface::Face(f)) => across(world, f, usize::from(side)),
            _ => world.scenery.track(old, x)?,
        };
        // Two contacts never merge: what one of them then lacks would be found again at once.
        let surface = if surface != old && before[..count].contains(&surface) { old } else { surface };
        let foot = world.scenery.foot(surface, x);
        let most = world.settle_speed(scale, world.surface_law(index, surface)).max(KEEP * (scale + v.length()));
        (v.dot(foot.normal) <= most && foot.distance - radius <= world.unseen * radius).then_some(surface)
    });
}

fn link_lasts(world: &Marbles, [i, j]: Link, bodies: &[Marble]) -> bool {
    let (i, j) = (i as usize, j as usize);
    let (a, b) = (&bodies[i], &bodies[j]);
    let (offset, v) = (a.path.x - b.path.x, a.path.v - b.path.v);
    let (distance, reach) = (offset.length(), world.specs[i].radius + world.specs[j].radius);
    let scale = world.speed_scale(i).min(world.speed_scale(j));
    let most = world.settle_speed(scale, world.pair_law(i, j)).max(KEEP * (scale + v.length()));
    v.dot(offset) <= most * distance && distance - reach <= world.unseen * reach
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

/// Time in which gravity, or the motion, covers the curvature of what a ball touches.
#[inline]
pub(super) fn time_scale(curvature: f64, radius: f64, speed: f64, strength: f64) -> f64 {
    let scale = if curvature < 0.0 {
        -curvature - radius
    } else if curvature.is_finite() {
        curvature + radius
    } else {
        radius
    };
    (scale / strength).sqrt().min(scale / speed)
}

impl MarbleScratch {
    fn gather(&mut self, world: &Marbles, indices: &[u32], bodies: &[Marble], links: &Links) {
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
                self.members[a].is_held = true;
                self.contacts.push(Contact::new(
                    a,
                    With::Surface(surface),
                    *world.surface_law(index as usize, surface),
                    normal,
                ));
            }
            if links.is_empty() {
                continue;
            }
            for b in 0..a {
                let other = self.members[b].index;
                if links.contains(index, other) {
                    let law = *world.pair_law(index as usize, other as usize);
                    let normal = (self.members[a].start - self.members[b].start).normalize_or(DVec3::Z);
                    (self.members[a].is_held, self.members[b].is_held) = (true, true);
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
            -(a.start_v - other).dot(c.first) > APPROACH * world.accuracy.settle * (world.strength * a.radius).sqrt()
        };
        if !self.contacts.iter().any(approaches) {
            return;
        }
        let enough = world.accuracy.sweep_tolerance * world.strength * self.step_length(world);
        self.sweep(world.accuracy.sweeps, enough, |_| false);
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
            let time = match c.with {
                With::Surface(s) => {
                    let curvature = world.scenery.foot(s, m.start).curvature_radius;
                    time_scale(curvature, m.radius, m.start_v.length(), world.strength)
                }
                With::Member(b) => {
                    let other = &self.members[b];
                    let (scale, speed) = (0.5 * (m.radius + other.radius), (m.start_v - other.start_v).length());
                    (scale / world.strength).sqrt().min(scale / speed)
                }
            };
            shortest = shortest.min(time);
        }
        world.accuracy.step * shortest
    }

    /// Whether anything overlaps by more than rest may keep: then a step comes first, which puts it back.
    fn overlaps(&self, world: &Marbles) -> bool {
        self.contacts.iter().any(|c| {
            let m = &self.members[c.a];
            let (distance, reach) = match c.with {
                With::Surface(s) => (world.scenery.foot(s, m.start).distance, m.radius),
                With::Member(b) => ((m.start - self.members[b].start).length(), m.radius + self.members[b].radius),
            };
            reach - distance > OVERLAP * reach
        })
    }

    /// Rest, where everything is slow and the contacts can hold everything still.
    fn try_rest(&mut self, world: &Marbles, bodies: &mut [Marble]) -> bool {
        let slow = self.members.iter().all(|m| {
            let limit = world.accuracy.rest_speed * (world.strength * m.radius).sqrt();
            m.start_v.length() <= limit && m.start_w.length() * m.radius <= limit
        });
        if !slow || self.contacts.is_empty() || self.overlaps(world) {
            return false;
        }
        let h = self.step_length(world);
        if !h.is_finite() {
            return false;
        }
        for m in &mut self.members {
            (m.v, m.w, m.x) = (world.gravity * h, DVec3::ZERO, m.start);
        }
        let left = world.accuracy.rest_residual * world.strength * h;
        let holds =
            self.sweep(world.accuracy.sweeps, CREEP * left, |m| m.v.length().max(m.w.length() * m.radius) <= left);
        self.clear();
        if !holds {
            return false;
        }
        for m in &self.members {
            let body = &mut bodies[m.index as usize];
            (body.path.v, body.spin) = (DVec3::ZERO, DVec3::ZERO);
            body.begin(Phase::Rest, DVec3::ZERO);
        }
        true
    }

    /// Solves all contacts for members whose velocities are free of them, starting from the impulses that the contacts hold, until a sweep
    /// changes no velocity by more than `enough`, all members are `good`, or `most` sweeps are done. Whether they are good.
    fn sweep(&mut self, most: u32, enough: f64, good: impl Fn(&Member) -> bool) -> bool {
        if let [only] = &mut self.contacts[..] {
            only.clear();
            only.solve(&mut self.members);
            return self.members.iter().all(good);
        }
        for c in &self.contacts {
            c.apply(&mut self.members);
        }
        for _ in 0..most {
            // Up and down again: the lowest contacts come last, so that nothing is left moving into the scenery.
            let mut change: f64 = 0.0;
            for c in &mut self.contacts {
                c.solve(&mut self.members);
            }
            for c in self.contacts.iter_mut().rev() {
                change = change.max(c.solve(&mut self.members));
            }
            if self.members.iter().all(&good) {
                return true;
            }
            if change <= enough {
                break;
            }
        }
        false
    }

    fn clear(&mut self) {
        for c in &mut self.contacts {
            c.clear();
        }
    }

    fn step(&mut self, world: &Marbles, bodies: &mut [Marble]) {
        let h = self.step_length(world);
        if !h.is_finite() {
            // Weightless and without relative motion: it goes on as it is.
            for m in &self.members {
                bodies[m.index as usize].begin(Phase::Flight, world.gravity);
            }
            return;
        }
        self.solve(world, bodies, h);
        self.put_back(world);
        self.guard_energy(world);
        for m in &self.members {
            let body = &mut bodies[m.index as usize];
            if !m.is_held {
                body.begin(Phase::Flight, world.gravity);
                continue;
            }
            body.begin(Phase::Step, m.acceleration(h));
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
        for most in [PREDICT, world.accuracy.sweeps] {
            for c in &mut self.contacts {
                let x = self.members[c.a].x;
                c.last = match c.with {
                    With::Surface(s) => world.scenery.foot_near(s, x).normal,
                    With::Member(b) => (x - self.members[b].x).normalize_or(c.first),
                };
            }
            for m in &mut self.members {
                (m.v, m.w) = (m.start_v + world.gravity * h, m.start_w);
            }
            self.sweep(most, world.accuracy.sweep_tolerance * world.strength * h, |_| false);
            for m in &mut self.members {
                m.x = m.start + (m.start_v + m.v) * (0.5 * h);
            }
        }
    }

    /// Puts centres back onto what they touch: first towards what bears a load, then only out of what they are in. The scenery has the last word.
    fn put_back(&mut self, world: &Marbles) {
        let rounds = if self.contacts.len() == 1 { 1 } else { CORRECTIONS };
        for round in 0..rounds {
            let mut moved = false;
            for c in self.contacts.iter().rev() {
                let m = self.members[c.a];
                let (missing, normal) = match c.with {
                    With::Surface(s) => {
                        let foot = world.scenery.foot_near(s, m.x);
                        (m.radius - foot.distance, foot.normal)
                    }
                    With::Member(b) => {
                        let offset = m.x - self.members[b].x;
                        let distance = offset.length();
                        (
                            m.radius + self.members[b].radius - distance,
                            if distance > 0.0 { offset / distance } else { c.last },
                        )
                    }
                };
                if missing <= 0.0 && (round > 0 || c.load == 0.0) {
                    continue;
                }
                moved |= missing.abs() > CORRECTED * m.radius;
                match c.with {
                    With::Surface(_) => self.members[c.a].x += normal * missing,
                    With::Member(b) => {
                        let other = self.members[b].mass;
                        let share = missing / (m.mass + other);
                        self.members[c.a].x += normal * (share * other);
                        self.members[b].x -= normal * (share * m.mass);
                    }
                }
            }
            if !moved {
                break;
            }
        }
    }

    /// Takes back what discretisation added: a group's energy never grows.
    fn guard_energy(&mut self, world: &Marbles) {
        let kinetic =
            |m: &Member, v: DVec3, w: DVec3| 0.5 * (m.mass * v.length_squared() + m.inertia * w.length_squared());
        let held = || self.members.iter().filter(|m| m.is_held);
        let before: f64 =
            held().map(|m| kinetic(m, m.start_v, m.start_w) + m.mass * world.gravity.dot(m.x - m.start)).sum();
        let after: f64 = held().map(|m| kinetic(m, m.v, m.w)).sum();
        if after > before {
            let part = if before > 0.0 { (before / after).sqrt() } else { 0.0 };
            for m in self.members.iter_mut().filter(|m| m.is_held) {
                m.v *= part;
                m.w *= part;
            }
        }
    }
}
