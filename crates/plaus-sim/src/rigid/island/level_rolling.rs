//! A ball on level ground in closed form: sliding, then rolling, section by section of the ground's friction.
//!
//! While it slides, friction points against the slip `u = v − R ω × n` of its lowest point, whose direction does not
//! change: `v̇ = −μ g û`, `ω̇ = μ m g R (n × û)/I`, `|u̇| = −μ g (1 + m R²/I)`. So its path is a parabola until the
//! slip is gone, and straight after that. If the friction changes (oil, then dry boards), a new parabola begins: the
//! ball hooks.
//!
//! Resistance to rolling, a torque of ρ m g R, slows a rolling ball by `ρ g/(1 + I/(m R²))` until it stops; resistance
//! to spinning slows its spin about the normal by `σ m g R/I`. A sliding ball has no resistance to rolling, with one
//! exception, as for marbles: if ρ is at least μ, a ball that does not turn does not begin to turn.
//!
//! Source: textbook, e.g. Hopkins & Patterson, "Bowling frames: Paths of a bowling ball", Am. J. Phys. 45 (1977).

use crate::material::Law;
use crate::rigid::body_state::{NEVER, Phase, RigidBodyState};
use crate::rigid::narrow_phase::contact_point::ContactPoint;
use crate::rigid::static_shape::StaticShape;
use crate::rigid::tolerances::{CLOCK_RESOLUTION, LEVEL_GROUND, NO_SLIP};
use crate::rigid::{BodyDef, RigidWorld};
use crate::roots::roots_of_quadratic;
use glam::DVec3;

/// Starts a closed form, if the body is a ball on one level part.
pub(crate) fn begin(world: &RigidWorld, index: usize, body: &mut RigidBodyState, touch: &ContactPoint) -> bool {
    let spec = &world.specs[index];
    let part = &world.parts[usize::from(touch.part)];
    let n = touch.normal;
    let level = n.cross(spec.gravity).length() <= LEVEL_GROUND * spec.gravity_magnitude && n.dot(spec.gravity) < 0.0;
    if !spec.is_ball
        || spec.anisotropy != 0.0
        || spec.damping.is_some()
        || !level
        || matches!(part, StaticShape::Table(_) | StaticShape::Solid(_) | StaticShape::Mesh(_) | StaticShape::Arc(_))
        || is_leaving(part, body)
    {
        return false;
    }
    let law = world.law_at(index, touch, body.path.x);
    if body.path.v.dot(n).abs() > world.settle_speed(spec, &law) {
        return false;
    }
    // Slow approach is stopped, and so is slow parting: the contact lasts.
    body.path.v -= n * body.path.v.dot(n);
    let friction = friction_ahead(part, law.friction, body.path.x, body.path.v);
    let Some((gravity, turn, until)) = along(spec, body, n, &Law { friction, ..law }) else { return false };
    let (drill, drills) = drill(spec, body, n, &law);
    // What nothing slows down may go on spinning on the spot.
    let is_still = [body.path.v, gravity, drill] == [DVec3::ZERO; 3];
    if is_still && body.spin.length() * spec.bounding_radius <= NO_SLIP * spec.speed {
        body.begin(Phase::Rest, DVec3::ZERO);
        return true;
    }
    body.begin(Phase::Glide, gravity);
    body.spin_rate = if drill == DVec3::ZERO { turn } else { turn + drill };
    body.rolls_after = until.is_finite() && until <= drills;
    body.line = None;
    let until = until.min(drills);
    if let Some((time, line)) = next_line(part, body)
        && time < until
    {
        body.rolls_after = false;
        body.line = Some(line);
        body.expiry = body.path.t + time;
    } else {
        body.expiry = (body.path.t + until).min(NEVER);
    }
    if body.expiry <= body.path.t {
        // The time is so short that the clock cannot show it.
        body.end_section(spec);
        body.expiry = body.path.t + f64::EPSILON * body.path.t.max(spec.rattle);
    }
    body.list(std::iter::once(touch.surface));
    true
}

/// Acceleration of a ball on level ground, the rate of change of its angular velocity, and how long both last. `None`
/// if the ball rolls and would need more friction than is available to be slowed down.
fn along(spec: &BodyDef, body: &mut RigidBodyState, n: DVec3, law: &Law) -> Option<(DVec3, DVec3, f64)> {
    let radius = spec.bounding_radius;
    let slip = body.path.v - body.spin.cross(n) * radius;
    let speed = slip.length();
    let stiff = 1.0 + spec.mass * radius * radius / spec.inertia.moments.x;
    if speed > NO_SLIP * spec.speed {
        let u = slip / speed;
        let force = law.friction * spec.gravity_magnitude;
        if law.holds_from_turning() && force > 0.0 && body.spin.cross(n) == DVec3::ZERO {
            return Some((u * -force, DVec3::ZERO, speed / force));
        }
        let until = if force > 0.0 { speed / (force * stiff) } else { f64::INFINITY };
        return Some((u * -force, n.cross(u) * (force * (stiff - 1.0) / radius), until));
    }
    // Exact rolling: the spin across the normal follows from the velocity.
    body.spin = n * body.spin.dot(n) + n.cross(body.path.v) / radius;
    let speed = body.path.v.length();
    if speed == 0.0 || law.rolling == 0.0 {
        return Some((DVec3::ZERO, DVec3::ZERO, f64::INFINITY));
    }
    // 1 + I/(m R²) is stiff/(stiff − 1).
    let brake = law.rolling * spec.gravity_magnitude * (stiff - 1.0) / stiff;
    let gravity = body.path.v * (-brake / speed);
    (brake <= law.grip() * spec.gravity_magnitude).then(|| (gravity, n.cross(gravity) / radius, speed / brake))
}

/// The rate at which resistance reduces the spin about the normal, and how long that lasts.
fn drill(spec: &BodyDef, body: &RigidBodyState, n: DVec3, law: &Law) -> (DVec3, f64) {
    let about = body.spin.dot(n);
    let rate = law.spinning * spec.gravity_magnitude * spec.mass * spec.bounding_radius / spec.inertia.moments.x;
    if about == 0.0 || rate == 0.0 {
        return (DVec3::ZERO, f64::INFINITY);
    }
    (n * (-rate * about.signum()), about.abs() / rate)
}

/// Whether the ball's centre is at an edge of the part that supports it and moving outward, or beyond the edge.
fn is_leaving(part: &StaticShape, body: &RigidBodyState) -> bool {
    let StaticShape::Block { bounds, .. } = part else { return false };
    let (x, v) = (body.path.x, body.path.v);
    (0..2).any(|k| {
        x[k] < bounds.min[k]
            || x[k] > bounds.max[k]
            || (x[k] == bounds.min[k] && v[k] < 0.0)
            || (x[k] == bounds.max[k] && v[k] > 0.0)
    })
}

/// The friction of the section that a ball is in, or is just entering.
fn friction_ahead(part: &StaticShape, usual: f64, at: DVec3, v: DVec3) -> f64 {
    let StaticShape::Block { sections, .. } = part else { return usual };
    let entered = |from: f64| at.y > from || (at.y == from && v.y >= 0.0);
    sections.iter().rev().find(|s| entered(s.from)).and_then(|s| s.friction).unwrap_or(usual)
}

/// Time until the ball's centre reaches another section or an edge of the part that supports it, and the line that it
/// reaches then: axis and position.
fn next_line(part: &StaticShape, body: &RigidBodyState) -> Option<(f64, (u8, f64))> {
    let StaticShape::Block { bounds, sections, .. } = part else { return None };
    let (x, v, a) = (body.path.x, body.path.v, body.path.a);
    let mut soonest: Option<(f64, (u8, f64))> = None;
    let mut line = |axis: usize, at: f64| {
        for t in roots_of_quadratic([x[axis] - at, v[axis], 0.5 * a[axis]]).into_iter().flatten() {
            if t > 0.0 && soonest.is_none_or(|(best, _)| t < best) {
                soonest = Some((t, (axis as u8, at)));
            }
        }
    };
    for s in sections {
        line(1, s.from);
    }
    for axis in 0..2 {
        line(axis, bounds.min[axis]);
        line(axis, bounds.max[axis]);
    }
    soonest
}

impl RigidBodyState {
    /// Ends a section of a ball's way over the ground at its time. It removes what rounding has left of the slip, of
    /// the speed or of the spin about the normal, and puts the ball exactly on the line that it reached.
    pub(crate) fn end_section(&mut self, spec: &BodyDef) {
        let n = -spec.gravity / spec.gravity_magnitude;
        if self.rolls_after {
            // Friction turns a sliding ball in the opposite sense to that of a rolling ball that slows down.
            if n.cross(self.path.a).dot(self.spin_rate) >= 0.0 {
                self.path.v = DVec3::ZERO;
            }
            self.spin = n * self.spin.dot(n) + n.cross(self.path.v) / spec.bounding_radius;
            self.rolls_after = false;
        }
        let (about, rate) = (self.spin.dot(n), self.spin_rate.dot(n));
        if rate != 0.0 && about.abs() <= CLOCK_RESOLUTION * self.path.t * rate.abs() {
            self.spin -= n * about;
        }
        if let Some((axis, at)) = self.line.take() {
            self.path.x[usize::from(axis)] = at;
        }
    }
}
