//! A step of one marble on one surface: what most steps are, without the bookkeeping of a group.
//!
//! It does what [`group`](super::group) does with a group of one contact, in the same order of operations, so that both give the same bits.

use super::Marbles;
use super::body::{Marble, Phase};
use super::group::{APPROACH, OVERLAP, moving_strength, time_scale};
use super::solve::{Ball, Push, respond};
use crate::material::Law;
use crate::scenery::{Foot, Surface};
use glam::DVec3;

/// Gives the marble its next step, or rest. Its only contact must be `surface`, which stands to it as `foot` says.
pub(super) fn settle(world: &Marbles, index: usize, body: &mut Marble, surface: Surface, foot: Foot) {
    let (ball, law, scale) = (&world.balls[index], world.surface_law(index, surface), world.speed_scale(index));
    let alone = Alone { world, ball, law, scale, surface, foot };
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
    ball: &'w Ball,
    law: &'w Law,
    /// Speed that a fall over one radius gives, up to √2.
    scale: f64,
    surface: Surface,
    /// Where the surface is at the start.
    foot: Foot,
}

impl Alone<'_> {
    /// Approach stopped, velocity and spin after the contact's impulse.
    #[inline]
    fn respond(&self, push: &Push, v: DVec3, w: DVec3) -> (f64, DVec3, DVec3) {
        respond(self.ball, self.law, push, v, w)
    }

    /// Takes away what slow approach is left, so that no step starts into the surface.
    fn stop_approach(&self, body: &mut Marble) {
        let n = self.foot.normal;
        if -body.path.v.dot(n) > APPROACH * self.world.accuracy.settle * self.scale {
            (_, body.path.v, body.spin) = self.respond(&Push::along(n), body.path.v, body.spin);
        }
    }

    fn time_scale(&self, body: &Marble) -> f64 {
        let (v, w) = (body.path.v, body.spin);
        let strength = moving_strength(self.world, self.ball, self.foot.normal, v, w);
        time_scale(self.foot.curvature_radius, self.ball.radius, v.length(), strength)
    }

    /// Whether it is slow and the contact can hold it.
    fn holds_still(&self, body: &Marble, h: f64) -> bool {
        let (world, radius) = (self.world, self.ball.radius);
        let limit = world.accuracy.rest_speed * self.scale;
        if body.path.v.length() > limit
            || body.spin.length() * radius > limit
            || radius - self.foot.distance > OVERLAP * radius
        {
            return false;
        }
        let n = self.foot.normal;
        let (_, v, w) = self.respond(&Push::along(n), world.gravity * h, DVec3::ZERO);
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
            let push = Push::new(self.foot.normal, scenery.foot_near(self.surface, x).normal);
            (load, v, w) = self.respond(&push, start_v + world.gravity * h, start_w);
            x = start + (start_v + v) * (0.5 * h);
        }
        let foot = scenery.foot_near(self.surface, x);
        let missing = self.ball.radius - foot.distance;
        if missing > 0.0 || load != 0.0 {
            x += foot.normal * missing;
        }
        let (mass, inertia) = (self.ball.mass, self.ball.inertia());
        let kinetic = |v: DVec3, w: DVec3| 0.5 * (mass * v.length_squared() + inertia * w.length_squared());
        let before = kinetic(start_v, start_w) + mass * world.gravity.dot(x - start);
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
