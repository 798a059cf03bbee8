//! Strings, and the drums that they are wound on.
//!
//! A string is fastened on a drum's rim, goes about the drum, leaves it along a tangent, and goes straight on to its
//! other end. Where the rim does not hide that end, it goes there straight from where it is fastened. Its length `F` is
//! a smooth function of where its ends are, as it winds, as it unwinds, and as it goes over from one side of the drum
//! to the other. It pulls along the gradient of `F`, on both ends in one line, so it gives and takes no energy and no
//! angular momentum.
//!
//! Along the drum's axis, what is wound stays where it is, but for the last of it: of the length `w` about the drum,
//! the part `s = w c / (w + c)` may slide, with `c` a fraction of the radius ([`SLIDES`]). With the free length `d` as
//! it is seen along the axis, and the offset `z` along it, `F = w - s + √((d + s)² + z²)`. Where the end is in the
//! drum's plane, this is `w + d`, and the string pulls along its tangent. So it does where `z` is small to first order.
//!
//! The other end of a string cannot be within a drum. Where a world brings it there, beyond the end of a real drum, it
//! is taken to be on the rim, in the same direction.

use glam::{DVec2, DVec3};
use plaus_dist::math;
use std::f64::consts::TAU;

/// A string: it pulls where it is taut, and never pushes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StringJoint {
    /// Its whole length in m, what is wound included, in (0, ∞).
    pub length: f64,
    /// The drum on which it is wound; none if it is fastened to a point. Default none.
    pub drum: Option<Drum>,
}

/// A drum of a body: a cylinder about the z axis of the joint's frame there, as wide as the string wants. The string is
/// fastened on its rim, on the frame's x axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drum {
    /// In m, in (0, ∞).
    pub radius: f64,
    /// The angle about the axis in radians, whole turns included, from where the string is fastened to its other end,
    /// at the start for which the joint is made.
    pub turned: f64,
}

/// How a string is wound at the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Winding {
    /// The axis of the drum, of any length but 0. As the string is pulled off, it turns the drum about this axis by the
    /// right-hand rule.
    pub axis: DVec3,
    /// The radius of the drum in m.
    pub radius: f64,
    /// How much of the string is wound, in m, in [0, ∞).
    pub length: f64,
}

/// Part of the radius that may slide along the drum's axis at most of what is wound. Without any, a string would break
/// off where the end of its free part meets the drum; a large part lets a string of many turns draw a drum's axis
/// towards it.
const SLIDES: f64 = 0.25;

/// Distance from a drum's axis, over its radius, below which a string's end counts as farther away: directions about
/// the axis have no limit there.
const LEAST_FAR: f64 = 0.1;

/// The course of a string, seen from its drum.
#[derive(Debug, Clone, Copy)]
pub(super) struct Course {
    /// Where its free part begins.
    pub(super) from: DVec3,
    /// The unit vector along its free part.
    pub(super) along: DVec3,
    pub(super) length: f64,
    /// How much longer it becomes per distance by which its end moves along it: 1 in the plane of the drum.
    pub(super) gain: f64,
    /// The angle of its other end, as [`Drum::turned`].
    pub(super) turned: f64,
}

impl Course {
    /// The straight course from the origin to a point.
    pub(super) fn straight(to: DVec3) -> Self {
        Self { from: DVec3::ZERO, along: to.normalize_or(DVec3::Z), length: to.length(), gain: 1.0, turned: 0.0 }
    }
}

impl Drum {
    /// The drum, and the length that a string has that is wound as asked and whose other end is `to`, in axes whose z
    /// is the drum's.
    pub(super) fn wound(radius: f64, wound: f64, to: DVec3) -> (Self, f64) {
        // A negative length is refused with the joint.
        let wound = if wound >= 0.0 { wound } else { f64::NAN };
        let drum = Self { radius, turned: math::atan2(reach(to.truncate().length(), radius), radius) + wound / radius };
        let (sin, cos) = math::sin_cos(drum.turned);
        let far = to.truncate().length();
        (drum, drum.course(DVec3::new(far * cos, far * sin, to.z), drum.turned).length)
    }

    /// The course of a string to this point. `near` is about the angle of the point.
    pub(super) fn course(&self, to: DVec3, near: f64) -> Course {
        let (flat, r) = (to.truncate(), self.radius);
        let far = flat.length();
        let turned = near_to(math::atan2(flat.y, flat.x), near);
        let free = reach(far, r);
        let wound = r * (turned.abs() - math::atan2(free, r));
        if wound <= 0.0 {
            let from = DVec3::X * r;
            return Course { from, turned, ..Course::straight(to - from) };
        }
        let c = SLIDES * r;
        let (slides, slope) = (wound * c / (wound + c), (c / (wound + c)) * (c / (wound + c)));
        let (level, side) = (free + slides, if turned < 0.0 { -1.0 } else { 1.0 });
        let last = DVec2::new(level, to.z).length();
        let part = level / last;
        let out = flat / far.max(f64::MIN_POSITIVE);
        let (rim, gradient) = if free > 0.0 {
            let (cos, sin) = (r / far, free / far);
            let rim = DVec2::new(out.x * cos + side * out.y * sin, out.y * cos - side * out.x * sin);
            (rim, rim.perp() * (side * part) - rim * ((1.0 - part) * (1.0 - slope) * r / free))
        } else {
            (out, out.perp() * (side * (1.0 - slope * (1.0 - part)) * r / far.max(LEAST_FAR * r)))
        };
        let gradient = gradient.extend(to.z / last);
        let gain = gradient.length();
        let from = (rim * r).extend(to.z * (1.0 - free / level));
        Course { from, along: gradient / gain, length: wound - slides + last, gain, turned }
    }

    /// The angle of a point with which the string is wound as far as its length allows.
    pub(super) fn most_turned(&self, to: DVec3, length: f64) -> f64 {
        let angle = math::atan2(to.y, to.x);
        let most = length / self.radius + std::f64::consts::FRAC_PI_2;
        let mut turned = angle + TAU * ((most - angle) / TAU).floor();
        while turned > std::f64::consts::PI && self.course(to, turned).length > length {
            turned -= TAU;
        }
        turned
    }
}

/// The length of the tangent to a circle from a point that is so far from its middle; 0 within it.
fn reach(far: f64, radius: f64) -> f64 {
    (far * far - radius * radius).max(0.0).sqrt()
}

/// The angle that is nearest to another, whole turns apart from this one.
fn near_to(angle: f64, near: f64) -> f64 {
    angle + TAU * ((near - angle) / TAU).round()
}
