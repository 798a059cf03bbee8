//! Lasting contact without a closed form: a group of marbles on its own adaptive clock.
//!
//! Each step solves the contacts' impulses together: block Gauss–Seidel with exact Coulomb blocks, which [`relax`]
//! makes converge for any masses, until no contact is left approaching by more than `sweep_tolerance · g · step`. It
//! moves every centre along the parabola that joins the two ends, and puts the centres back onto the surfaces that they
//! touch ([`lift`]). Between its ends a step is a parabola like any other motion, so collisions with others are found
//! exactly on the path actually taken. Energy never grows; when the energy that discretisation added is taken back,
//! every momentum that the laws conserve is kept ([`guard`]).
//!
//! What this costs, and where it is not exact: an impact on one member ends the step of the whole group, so a
//! collapsing pile of n balls costs n times its impacts. If impacts come faster than steps, a step's correction of
//! positions takes effect only in part. Then balls overlap by the approach that sweeps leave, `sweep_tolerance · g ·
//! step²` per step (`cargo run --release -p plaus-sim --example pile -- 1.5`).

use super::Marbles;
use super::anderson::{Memory, Swept, relax};
use super::body::{Marble, Phase};
use super::energy_projection::guard;
use super::position_projection::{Lift, lift, overlap};
use super::solve::{Ball, Contact, Member, Push, With};
use crate::links::Links;
use crate::scenery::Projection;
use glam::DVec3;
use std::ops::ControlFlow;

/// Work space for groups of marbles in lasting contact.
#[derive(Debug, Default)]
pub struct MarbleScratch {
    pub(super) members: Vec<Member>,
    pub(super) contacts: Vec<Contact>,
    lifts: Vec<Lift>,
    memory: Memory,
}

/// If a sweep changes more than this, relative to what rest may leave, rest is not near. Default 0.03: sweeps shrink by
/// about half, so little is still to come.
const CREEP: f64 = 0.03;

/// The remaining change is assumed to be at least this many times the change of a sweep, because combined sweeps do not
/// shrink evenly. Default 20; danger: with less, groups that could rest are taken for moving ones, and continue
/// stepping.
const DOUBT: f64 = 20.0;

/// Sweeps that only predict the end of a step may stop at a change larger by this factor. Default 10.
const PREDICT: f64 = 10.0;

/// How often a step is halved, at most, if it would lift its members more than their motion can pay for. Default 3.
pub(super) const HALVINGS: u32 = 3;

/// Overlap over the radius that rest may keep. Default 2e-5.
pub(super) const OVERLAP: f64 = 2e-5;

/// Approach along a lasting contact that a step may start with, over the speed at which contacts settle. Default 0.02:
/// a path then dips into the surface by less than 1e-4 radii at the standard preset.
pub(super) const APPROACH: f64 = 0.02;

/// Largest slip of the touching points, over the centre's speed, at which a ball counts as rolling for the length of a
/// step. Default 0.01; danger: if it still slips, steps are longer than its sliding requires, by up to `√(1 +
/// gyration)`.
const ROLLS: f64 = 0.01;

/// Gravity's effect on the centre of a ball over a surface with this normal: rolling turns a part of it into spin.
#[inline]
pub(super) fn moving_strength(world: &Marbles, ball: &Ball, normal: DVec3, v: DVec3, w: DVec3) -> f64 {
    let slip = v - w.cross(normal) * ball.radius;
    let rolls = slip.length_squared() <= ROLLS * ROLLS * v.length_squared();
    if rolls { world.strength * ball.share } else { world.strength }
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
    /// Gives a group its next step, or rest.
    pub(super) fn go_on(&mut self, world: &Marbles, members: &[u32], bodies: &mut [Marble], links: &Links) {
        self.gather(world, members, bodies, links);
        self.stop_approach(world, bodies);
        let h = self.step_length(world);
        if !self.try_rest(world, bodies, h) {
            self.step(world, bodies, h);
        }
    }

    pub(super) fn gather(&mut self, world: &Marbles, indices: &[u32], bodies: &[Marble], links: &Links) {
        self.members.clear();
        for &k in indices {
            let b = &bodies[k as usize];
            self.members.push(Member::new(k, world.balls[k as usize], b.path.x, b.path.v, b.spin));
        }
        // Bottom first, then by position: loads travel up in one sweep, and the order knows nothing of labels.
        self.members.sort_by(|a, b| world.bottom_first(a.start, b.start));
        self.contacts.clear();
        for a in 0..self.members.len() {
            let index = self.members[a].index;
            for &surface in bodies[index as usize].contacts() {
                let (projection, law) = (
                    world.scenery.project(surface, self.members[a].start),
                    *world.surface_law(index as usize, surface),
                );
                self.members[a].is_held = true;
                self.contacts.push(Contact::new(&self.members, a, With::Surface(surface), law, projection));
            }
            if links.is_empty() {
                continue;
            }
            for b in 0..a {
                let other = self.members[b].index;
                if links.contains(index, other) {
                    let law = *world.pair_law(index as usize, other as usize);
                    let offset = self.members[a].start - self.members[b].start;
                    let projection = Projection {
                        normal: offset.normalize_or(DVec3::Z),
                        distance: offset.length(),
                        curvature_radius: f64::INFINITY,
                    };
                    (self.members[a].is_held, self.members[b].is_held) = (true, true);
                    self.contacts.push(Contact::new(&self.members, a, With::Member(b), law, projection));
                }
            }
        }
    }

    /// Removes the remaining slow approach along lasting contacts, so that no step starts into a surface.
    fn stop_approach(&mut self, world: &Marbles, bodies: &mut [Marble]) {
        let approaches = |c: &Contact| {
            let a = &self.members[c.a];
            let other = match c.with {
                With::Surface(_) => DVec3::ZERO,
                With::Member(b) => self.members[b].start_v,
            };
            -(a.start_v - other).dot(c.projection.normal)
                > APPROACH * world.accuracy.settle * world.speed_scale(a.index as usize)
        };
        if !self.contacts.iter().any(approaches) {
            return;
        }
        let enough = world.accuracy.sweep_tolerance * world.strength * self.step_length(world);
        self.relax(world.accuracy.sweeps, enough);
        self.clear();
        for m in &mut self.members {
            (m.start_v, m.start_w) = (m.v, m.w);
            let body = &mut bodies[m.index as usize];
            (body.path.v, body.spin) = (m.v, m.w);
        }
    }

    /// Length of the next step: a part of the time in which gravity, or the motion, covers the curvature of what is
    /// touched.
    pub(super) fn step_length(&self, world: &Marbles) -> f64 {
        let mut shortest = f64::INFINITY;
        for c in &self.contacts {
            let m = &self.members[c.a];
            let time = match c.with {
                With::Surface(_) => {
                    let strength = moving_strength(world, &m.ball, c.projection.normal, m.start_v, m.start_w);
                    time_scale(c.projection.curvature_radius, m.ball.radius, m.start_v.length(), strength)
                }
                With::Member(b) => {
                    let other = &self.members[b];
                    let (scale, speed) =
                        (0.5 * (m.ball.radius + other.ball.radius), (m.start_v - other.start_v).length());
                    (scale / world.strength).sqrt().min(scale / speed)
                }
            };
            shortest = shortest.min(time);
        }
        world.accuracy.step * shortest
    }

    /// Whether anything overlaps by more than rest allows: then a step comes first, which puts it back.
    fn overlaps(&self, world: &Marbles) -> bool {
        self.contacts.iter().any(|c| {
            let radius = |k: usize| self.members[k].ball.radius;
            let (reach, distance) = match c.with {
                // Beyond a side of its triangle, a contact is with the edge there.
                With::Surface(s) => (radius(c.a), world.scenery.project_near(s, self.members[c.a].start).distance),
                With::Member(b) => (radius(c.a) + radius(b), c.projection.distance),
            };
            reach - distance > OVERLAP * reach
        })
    }

    /// Rest, if everything is slow and the contacts can hold everything still.
    fn try_rest(&mut self, world: &Marbles, bodies: &mut [Marble], h: f64) -> bool {
        let slow = self.members.iter().all(|m| {
            let limit = world.accuracy.rest_speed * world.speed_scale(m.index as usize);
            m.start_v.length() <= limit && m.start_w.length() * m.ball.radius <= limit
        });
        if !slow || self.contacts.is_empty() || !h.is_finite() || self.overlaps(world) {
            return false;
        }
        for m in &mut self.members {
            m.set_free(world.gravity * h, DVec3::ZERO);
            m.x = m.start;
        }
        // If they cannot, the step starts from the impulses found, which are close to those that it needs.
        if !self.can_hold(world.accuracy.sweeps, world.accuracy.rest_residual * world.strength * h) {
            return false;
        }
        self.clear();
        for m in &self.members {
            let body = &mut bodies[m.index as usize];
            (body.path.v, body.spin) = (DVec3::ZERO, DVec3::ZERO);
            body.begin(Phase::Rest, DVec3::ZERO);
        }
        true
    }

    /// Whether the contacts can stop all members up to speeds of `left`.
    fn can_hold(&mut self, most: u32, left: f64) -> bool {
        let mut last = f64::INFINITY;
        let mut holds = false;
        let Self { members, contacts, memory, .. } = self;
        relax(&mut Loads { members, contacts }, memory, most, |loads, change| {
            let fastest = |m: &Member| m.v.length().max(m.w.length() * m.ball.radius);
            let worst = loads.members.iter().map(fastest).fold(0.0, f64::max);
            holds = worst <= left;
            // Sweeps shrink geometrically: all that are still to come change no more than this.
            let to_come = if change < last { change / (1.0 - change / last) } else { f64::INFINITY };
            last = change;
            if holds || change <= CREEP * left || worst - left > to_come.max(DOUBT * change) {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        holds
    }

    /// Solves all contacts for members whose velocities are free of them, starting from the impulses that the contacts
    /// hold, until a sweep changes no velocity by more than `enough`, or `most` sweeps are done.
    pub(super) fn relax(&mut self, most: u32, enough: f64) {
        for c in &self.contacts {
            c.apply(&mut self.members);
        }
        let Self { members, contacts, memory, .. } = self;
        relax(&mut Loads { members, contacts }, memory, most, |loads, change| {
            if change <= enough || loads.contacts.len() == 1 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
    }

    fn clear(&mut self) {
        for c in &mut self.contacts {
            c.clear();
        }
    }

    fn step(&mut self, world: &Marbles, bodies: &mut [Marble], mut h: f64) {
        if !h.is_finite() {
            // Weightless and without relative motion: it goes on as it is.
            for m in &self.members {
                bodies[m.index as usize].begin(Phase::Flight, world.gravity);
            }
            return;
        }
        for _ in 0..=HALVINGS {
            self.solve(world, bodies, h);
            self.put_back(world);
            if guard(world, &mut self.members, &self.contacts) {
                break;
            }
            h *= 0.5;
        }
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
            let gravity = if body.phase == Phase::Step { body.path.a } else { DVec3::ZERO };
            m.x = m.start + (m.start_v + gravity * (0.5 * h)) * h;
        }
        // The first pass predicts where the step ends.
        for tolerance in [PREDICT, 1.0] {
            for c in &mut self.contacts {
                let x = self.members[c.a].x;
                let first = c.projection.normal;
                let last = match c.with {
                    With::Surface(s) => world.scenery.project_near(s, x).normal,
                    With::Member(b) => (x - self.members[b].x).normalize_or(first),
                };
                let (reach, motion) = c.start(&self.members);
                c.push = Push::new(first, last).across(first, c.projection.distance - reach, motion, h);
            }
            for m in &mut self.members {
                m.set_free(m.start_v + world.gravity * h, m.start_w);
            }
            self.relax(world.accuracy.sweeps, tolerance * world.accuracy.sweep_tolerance * world.strength * h);
            for m in &mut self.members {
                m.x = m.start + (m.start_v + m.v) * (0.5 * h);
            }
        }
    }

    /// Puts centres back onto what they touch: first towards things that bear a load, one contact after the other with
    /// the scenery last, then only out of remaining overlaps.
    fn put_back(&mut self, world: &Marbles) {
        for c in self.contacts.iter().rev() {
            let (missing, normal) = overlap(world, &self.members, c);
            if missing <= 0.0 && !c.is_loaded() {
                continue;
            }
            match c.with {
                With::Surface(_) => self.members[c.a].x += normal * missing,
                With::Member(b) => {
                    let (mass, other) = (self.members[c.a].ball.mass, self.members[b].ball.mass);
                    let share = missing / (mass + other);
                    self.members[c.a].x += normal * (share * other);
                    self.members[b].x -= normal * (share * mass);
                }
            }
        }
        if self.contacts.len() > 1 {
            let Self { members, contacts, lifts, memory } = self;
            lift(world, members, contacts, lifts, memory);
        }
    }
}

/// The impulses of a group's contacts.
struct Loads<'g> {
    members: &'g mut [Member],
    contacts: &'g mut [Contact],
}

impl Swept for Loads<'_> {
    /// Solves each contact twice, up and down again. The lowest come last, so that nothing is left moving into the
    /// scenery. Gives the largest change of a velocity on the way down.
    fn sweep(&mut self) -> f64 {
        for c in &mut *self.contacts {
            c.solve(self.members);
        }
        let mut change: f64 = 0.0;
        for c in self.contacts.iter_mut().rev() {
            change = change.max(c.solve(self.members));
        }
        change.sqrt()
    }

    fn read(&self, loads: &mut Vec<f64>) {
        self.contacts.iter().for_each(|c| c.read(self.members, loads));
    }

    fn write(&mut self, loads: &[f64]) {
        for m in &mut *self.members {
            (m.v, m.w) = m.free;
        }
        for (c, given) in self.contacts.iter_mut().zip(loads.chunks_exact(6)) {
            c.write(self.members, given);
            c.apply(self.members);
        }
    }
}
