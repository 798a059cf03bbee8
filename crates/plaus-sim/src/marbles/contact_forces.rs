//! What each contact of an island of marbles carries, as for rigid bodies.

use super::Marbles;
use super::body::{Marble, Phase};
use super::island::MarbleScratch;
use super::solve::With;
use crate::links::Links;
use crate::mechanics::{ContactForce, Island, Other};
use glam::DVec3;

/// Velocity over `g · step` that static equilibrium may leave. Default 1e-6; sweeps end there.
const NO_MOTION: f64 = 1e-6;

/// Sweeps for finding static equilibrium. Default 2000; it is asked for once each time that an island comes to rest.
const SWEEPS: u32 = 2000;

impl Marbles {
    /// Calls `each` for the points at which an island that has just settled carries load.
    pub(super) fn tell_forces(
        &self,
        island: &Island<'_, Self>,
        work: &mut MarbleScratch,
        each: &mut dyn FnMut(&ContactForce),
    ) {
        let Island { members, bodies, links, scratch } = *island;
        if let [only] = *members
            && let [surface] = *bodies[only as usize].contacts()
        {
            let (index, body) = (only as usize, &bodies[only as usize]);
            let acceleration = match body.phase {
                Phase::Waiting | Phase::Flight => return,
                Phase::Slide | Phase::Roll | Phase::Spin | Phase::Rest => body.path.a,
                Phase::Step => (body.end_velocity - body.path.v) / (body.expiry - body.path.t),
            };
            let projection = self.scenery.project(surface, body.path.x);
            let force = (acceleration - self.gravity) * self.specs[index].mass;
            let radius = self.specs[index].radius;
            let told = ContactForce {
                body: index,
                other: Other::Surface(surface),
                point: body.path.x - projection.normal * radius,
                normal: projection.normal,
                force,
                gap: projection.distance - radius,
            };
            return self.tell_if_loaded(&told, each);
        }
        let phase = |k: &u32| bodies[*k as usize].phase;
        if members.iter().all(|k| phase(k) == Phase::Rest) {
            let h = work.balance(self, members, bodies, links);
            work.tell(self, h, each);
        } else if let Some(step) = members.iter().find(|k| phase(k) == Phase::Step) {
            let step = &bodies[*step as usize];
            scratch.tell(self, step.expiry - step.path.t, each);
        }
    }

    /// Passes on what is more than the solver's error of the lighter marble's weight.
    fn tell_if_loaded(&self, told: &ContactForce, each: &mut dyn FnMut(&ContactForce)) {
        let mass = match told.other {
            Other::Body(other) => self.specs[told.body].mass.min(self.specs[other].mass),
            Other::Surface(_) => self.specs[told.body].mass,
        };
        if told.force.dot(told.normal) > NO_MOTION * mass * self.strength {
            each(told);
        }
    }
}

impl MarbleScratch {
    /// Finds impulses that hold an island at rest, and gives the time in s over which they act.
    fn balance(&mut self, world: &Marbles, members: &[u32], bodies: &[Marble], links: &Links) -> f64 {
        self.gather(world, members, bodies, links);
        let h = self.step_length(world);
        for m in &mut self.members {
            m.set_free(world.gravity * h, DVec3::ZERO);
        }
        self.relax(SWEEPS, 0.1 * NO_MOTION * world.strength * h);
        h
    }

    /// Calls `each` for the contacts that bear a load in `h` seconds.
    fn tell(&self, world: &Marbles, h: f64, each: &mut dyn FnMut(&ContactForce)) {
        for c in self.contacts.iter().filter(|c| c.is_loaded()) {
            let (a, n) = (&self.members[c.a], c.projection.normal);
            let force = c.given() * (a.ball.mass / h);
            let (body, reach) = (a.index as usize, a.ball.radius);
            let told = match c.with {
                With::Surface(surface) => ContactForce {
                    body,
                    other: Other::Surface(surface),
                    point: a.start - n * reach,
                    normal: n,
                    force,
                    gap: c.projection.distance - reach,
                },
                With::Member(b) => {
                    let b = &self.members[b];
                    let (other, sign) = (b.index as usize, if b.index < a.index { -1.0 } else { 1.0 });
                    ContactForce {
                        body: body.min(other),
                        other: Other::Body(body.max(other)),
                        point: a.start - n * reach,
                        normal: n * sign,
                        force: force * sign,
                        gap: c.projection.distance - reach - b.ball.radius,
                    }
                }
            };
            world.tell_if_loaded(&told, each);
        }
    }
}
