//! A step of one marble on one surface: most steps are of this kind, and need no bookkeeping of a group.
//!
//! It does the same as [`group`](crate::marbles::island) does for a group with one contact.

use super::Marbles;
use super::body::{Marble, Phase};
use super::energy_projection::FORGIVEN;
use super::island::{APPROACH, HALVINGS, OVERLAP, moving_strength, time_scale};
use super::solve::{Ball, Push, respond};
use crate::material::Law;
use crate::scenery::{Projection, Surface};
use glam::DVec3;

/// Gives the marble its next step, or rest. Its only contact must be `surface`, with the position in `projection`.
pub(super) fn settle(world: &Marbles, index: usize, body: &mut Marble, surface: Surface, projection: Projection) {
    let (ball, law, scale) = (&world.balls[index], world.surface_law(index, surface), world.speed_scale(index));
    let alone = Alone { world, ball, law, scale, surface, projection };
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
    /// Speed after a fall over one radius, up to a factor of √2.
    scale: f64,
    surface: Surface,
    /// Where the surface is at the start.
    projection: Projection,
}

impl Alone<'_> {
    /// The approach that was stopped, and velocity and spin after the contact's impulse.
    #[inline]
    fn respond(&self, push: &Push, v: DVec3, w: DVec3) -> (f64, DVec3, DVec3) {
        respond(self.ball, self.law, push, v, w)
    }

    /// Removes the remaining slow approach, so that no step starts into the surface.
    fn stop_approach(&self, body: &mut Marble) {
        let n = self.projection.normal;
        if -body.path.v.dot(n) > APPROACH * self.world.accuracy.settle * self.scale {
            (_, body.path.v, body.spin) = self.respond(&Push::along(n), body.path.v, body.spin);
        }
    }

    fn time_scale(&self, body: &Marble) -> f64 {
        let (v, w) = (body.path.v, body.spin);
        let strength = moving_strength(self.world, self.ball, self.projection.normal, v, w);
        time_scale(self.projection.curvature_radius, self.ball.radius, v.length(), strength)
    }

    /// Whether it is slow and the contact can hold it.
    fn holds_still(&self, body: &Marble, h: f64) -> bool {
        let (world, radius) = (self.world, self.ball.radius);
        let limit = world.accuracy.rest_speed * self.scale;
        if body.path.v.length() > limit
            || body.spin.length() * radius > limit
            || radius - self.projection.distance > OVERLAP * radius
        {
            return false;
        }
        let n = self.projection.normal;
        let (_, v, w) = self.respond(&Push::along(n), world.gravity * h, DVec3::ZERO);
        v.length().max(w.length() * radius) <= world.accuracy.rest_residual * world.strength * h
    }

    fn step(&self, body: &mut Marble, mut h: f64) {
        let (start, v, w) = (body.path.x, body.path.v, body.spin);
        let mut halvings = HALVINGS;
        let end = loop {
            let mut end = self.end_of_step(body, h);
            if self.guard((v, w), self.world.gravity.dot(end.x - start), &mut end) || halvings == 0 {
                break end;
            }
            (halvings, h) = (halvings - 1, 0.5 * h);
        };
        body.begin(Phase::Step, (end.x - start - v * h) * (2.0 / (h * h)));
        body.spin_rate = (end.w - w) / h;
        body.end_velocity = end.v;
        body.expiry = body.path.t + h;
    }

    fn end_of_step(&self, body: &Marble, h: f64) -> End {
        let (world, scenery, radius) = (self.world, &self.world.scenery, self.ball.radius);
        let (start, start_v, start_w) = (body.path.x, body.path.v, body.spin);
        let gravity = if body.phase == Phase::Step { body.path.a } else { DVec3::ZERO };
        let (gap, first) = (self.projection.distance - radius, self.projection.normal);
        let motion = [start_v, start_v - start_w.cross(first) * radius];
        let mut x = start + (start_v + gravity * (0.5 * h)) * h;
        let (mut load, mut v, mut w) = (0.0, start_v, start_w);
        // The first pass predicts where the step ends.
        for _ in 0..2 {
            let push = Push::new(first, scenery.project_near(self.surface, x).normal).across(first, gap, motion, h);
            (load, v, w) = self.respond(&push, start_v + world.gravity * h, start_w);
            x = start + (start_v + v) * (0.5 * h);
        }
        let projection = scenery.project_near(self.surface, x);
        let missing = radius - projection.distance;
        if missing > 0.0 || load != 0.0 {
            x += projection.normal * missing;
        }
        End { x, v, w }
    }

    /// Takes back the energy that discretisation has added, like [`guard`](crate::marbles::energy_projection): from the
    /// motion downhill and from slip, not from rolling or gliding across the slope. `fallen` is the work of gravity per
    /// unit mass. False if there was not enough to take it from.
    fn guard(&self, start: (DVec3, DVec3), fallen: f64, end: &mut End) -> bool {
        let (n, gravity, End { v, w, .. }) = (self.projection.normal, self.world.gravity, *end);
        let inertia = self.ball.inertia() * self.ball.inverse_mass;
        let kinetic = |v: DVec3, w: DVec3| 0.5 * (v.length_squared() + inertia * w.length_squared());
        let before = kinetic(start.0, start.1) + fallen;
        if kinetic(v, w) <= before {
            return true;
        }
        let downhill = gravity - n * gravity.dot(n);
        let steep = downhill.length_squared();
        let level = steep <= LEVEL * LEVEL * gravity.length_squared();
        let across = |u: DVec3| {
            let u = u - n * u.dot(n);
            if level { u } else { u - downhill * (u.dot(downhill) / steep) }
        };
        let (kept_v, kept_w) = if self.law.friction > 0.0 {
            let rolls = across(self.ball.rolling(n, v, w));
            (rolls, n.cross(rolls) / self.ball.radius + n * w.dot(n))
        } else {
            (across(v), w)
        };
        let rest = kinetic(v - kept_v, w - kept_w);
        let left = before - kinetic(kept_v, kept_w);
        let part = if rest > 0.0 { (left / rest).clamp(0.0, 1.0).sqrt() } else { 1.0 };
        (end.v, end.w) = (kept_v + (v - kept_v) * part, kept_w + (w - kept_w) * part);
        left >= -FORGIVEN * self.world.unseen * self.world.strength * self.ball.radius
    }
}

/// Where and how a step ends.
#[derive(Clone, Copy)]
struct End {
    x: DVec3,
    v: DVec3,
    w: DVec3,
}

/// Largest tangential gravity over gravity at which a surface counts as level. Default 1e-9.
const LEVEL: f64 = 1e-9;
