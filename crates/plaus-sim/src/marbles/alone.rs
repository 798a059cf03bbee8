//! A step of one marble on one surface: what most steps are, without the bookkeeping of a group.
//!
//! It does what [`step`](super::step) does with a group of one contact, in the same order of operations, so that both give the same bits.

use super::Marbles;
use super::body::{Marble, Phase};
use super::solve::{Push, respond};
use super::step::{APPROACH, OVERLAP, time_scale};
use crate::scenery::{Foot, Surface};
use glam::DVec3;

/// Gives the marble its next step, or rest. Its only contact must be `surface`.
pub(super) fn settle(world: &Marbles, index: usize, body: &mut Marble, surface: Surface) {
    let alone = Alone { world, index, surface, foot: world.scenery.foot(surface, body.path.x) };
    alone.stop_approach(body);
    let h = world.accuracy.step * alone.time_scale(body);
    if !h.is_finite() {
        // Weightless and without relative motion: it goes on as it is.
        return body.begin(Phase::Flight, world.gravity);
    }
    if alone.holds_still(body, h) {
        (body.path.v, body.spin) = (DVec3::ZERO, DVec3::ZERO);
        return body.begin(Phase::Rest, DVec3::ZERO);
    }
    alone.step(body, h);
}

struct Alone<'w> {
    world: &'w Marbles,
    index: usize,
    surface: Surface,
    /// Where the surface is at the start.
    foot: Foot,
}

impl Alone<'_> {
    /// Velocity and spin after the contact's impulse, and its load, where `push` says at which normals it acts.
    fn respond(&self, push: &Push, v: DVec3, w: DVec3) -> (f64, DVec3, DVec3) {
        let spec = &self.world.specs[self.index];
        respond(spec.mass, spec.radius, spec.gyration, self.world.surface_law(self.index, self.surface), push, v, w)
    }

    /// Takes away what slow approach is left, so that no step starts into the surface.
    fn stop_approach(&self, body: &mut Marble) {
        let (n, scale) = (self.foot.normal, self.world.speed_scale(self.index));
        if -body.path.v.dot(n) > APPROACH * self.world.accuracy.settle * scale {
            (_, body.path.v, body.spin) = self.respond(&Push { first: n, last: n }, body.path.v, body.spin);
        }
    }

    fn time_scale(&self, body: &Marble) -> f64 {
        let radius = self.world.specs[self.index].radius;
        time_scale(self.foot.curvature_radius, radius, body.path.v.length(), self.world.strength)
    }

    /// Whether it is slow and the contact can hold it.
    fn holds_still(&self, body: &Marble, h: f64) -> bool {
        let (world, radius) = (self.world, self.world.specs[self.index].radius);
        let limit = world.accuracy.rest_speed * world.speed_scale(self.index);
        if body.path.v.length() > limit
            || body.spin.length() * radius > limit
            || radius - self.foot.distance > OVERLAP * radius
        {
            return false;
        }
        let n = self.foot.normal;
        let (_, v, w) = self.respond(&Push { first: n, last: n }, world.gravity * h, DVec3::ZERO);
        v.length().max(w.length() * radius) <= world.accuracy.rest_residual * world.strength * h
    }

    fn step(&self, body: &mut Marble, h: f64) {
        let (world, scenery) = (self.world, &self.world.scenery);
        let (start, start_v, start_w) = (body.path.x, body.path.v, body.spin);
        let pull = if body.phase == Phase::Step { body.path.a } else { DVec3::ZERO };
        let mut x = start + (start_v + pull * (0.5 * h)) * h;
        let (mut load, mut v, mut w) = (0.0, start_v, start_w);
        // The first pass predicts where the step ends.
        for _ in 0..2 {
            let push = Push { first: self.foot.normal, last: scenery.foot_near(self.surface, x).normal };
            (load, v, w) = self.respond(&push, start_v + world.gravity * h, start_w);
            x = start + (start_v + v) * (0.5 * h);
        }
        let spec = &world.specs[self.index];
        let foot = scenery.foot_near(self.surface, x);
        let missing = spec.radius - foot.distance;
        if missing > 0.0 || load != 0.0 {
            x += foot.normal * missing;
        }
        let inertia = spec.gyration * spec.mass * spec.radius * spec.radius;
        let kinetic =
            |v: DVec3, w: DVec3| 0.5 * (spec.mass * v.length_squared() + inertia * w.length_squared());
        let before = kinetic(start_v, start_w) + spec.mass * world.gravity.dot(x - start);
        let after = kinetic(v, w);
        if after > before {
            let part = if before > 0.0 { (before / after).sqrt() } else { 0.0 };
            (v, w) = (v * part, w * part);
        }
        body.begin(Phase::Step, (x - start - start_v * h) * (2.0 / (h * h)));
        body.spin_rate = (w - start_w) / h;
        body.end_velocity = v;
        body.expiry = body.path.t + h;
    }
}
