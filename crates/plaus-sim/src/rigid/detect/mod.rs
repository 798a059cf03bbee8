//! First contact of a turning body with a fixed part, by conservative advancement of second order.
//!
//! Each feeler's gap `f` obeys `f(t + τ) ≥ f + f′ τ − M τ²/2`, where `M` bounds its acceleration towards the part:
//! gravity, rotation, and the surface's curvature times speed squared. The body is advanced by the first root of these
//! parabolas over all feelers, which cannot overshoot and converges quadratically, until a gap is below half of the one
//! at which bodies touch, and closing. A gap that is small but opening is no event (rule of `crate::roots`); the search
//! goes on from where it can close again.

mod block;
mod corners;
mod plane;
mod table;

use super::body::{Phase, Turning};
use super::facets::Flat;
use super::part::Part;
use super::strike::LEFT;
use super::tumble::Tumble;
use super::{Rigid, Skin, Spec};
use crate::roots::{earliest, fall_of_quadratic};
use crate::scenery::{Aabb, Surface};
use glam::DVec3;

/// Maximum number of advancements of one search. When they are used up, the time reached is handed on as an event, and
/// the body is examined anew.
const MOST_ADVANCES: usize = 200;

/// Up to this many parts, all are asked: 8.
const FEW: usize = 8;

/// A search for the first contact of one body.
pub(in crate::rigid) struct Search<'s> {
    pub(super) spec: &'s Spec,
    pub(super) body: &'s Turning,
    /// Largest angular speed.
    fastest: f64,
    /// Acceleration of a point, over its distance from the centre.
    turning: f64,
    /// The same for points on the axis of a body of revolution.
    axial: f64,
    pub(super) until: f64,
    /// The box that the body stays in until then.
    pub(in crate::rigid) swept: Aabb,
    /// Approach in m/s that steps of lasting contact deal with, however elastic the law.
    pub(in crate::rigid) slow: f64,
    found: Option<(f64, Surface)>,
}

impl Rigid {
    /// Calls `each` for the parts that may have a point in a box, in the order in which they are listed.
    pub(super) fn for_parts(&self, around: &Aabb, mut each: impl FnMut(usize, &Part)) {
        if self.parts.len() <= FEW {
            return self.parts.iter().enumerate().for_each(|(k, part)| each(k, part));
        }
        let mut near = Vec::new();
        self.scenery.find(around, &mut near);
        near.extend(&self.endless);
        near.sort_unstable();
        near.into_iter().for_each(|k| each(k as usize, &self.parts[k as usize]));
    }

    /// First point of a body that touches a part, not after `until`.
    pub(super) fn first_touch(&self, index: usize, body: &Turning, until: f64) -> Option<(f64, Surface)> {
        if !matches!(body.phase, Phase::Flight | Phase::Leg | Phase::Step | Phase::Glide) {
            return None;
        }
        let spec = &self.specs[index];
        let free = body.turns_freely();
        let momentum = spec.inertia.momentum(body.turn, body.spin).length();
        let fastest = if free {
            (momentum / spec.inertia.moments.min_element()).min(body.spin.length() * (1.0 + spec.wobble))
        } else {
            body.spin.length()
        };
        let fastest = if spec.wobble == 0.0 || !free { body.spin.length() } else { fastest };
        let turning = fastest * fastest * if free { 1.0 + spec.wobble } else { 1.0 };
        // The axis of a top only swings: at |L|/I₁ in flight; in a step, with the body.
        let across = body.spin.reject_from_normalized(body.turn * DVec3::Z).length();
        let axial = match spec.skin {
            Skin::Revolved => across * if free { momentum / spec.inertia.moments.x } else { body.spin.length() },
            _ => turning,
        };
        let slow = LEFT * self.accuracy.settle * spec.speed;
        let until = until - body.path.t;
        let swept = body.path.bounds(0.0, until).grown(spec.reach * (1.0 + 1e-9) + spec.gap);
        let mut search = Search { spec, body, fastest, turning, axial, until, swept, slow, found: None };
        self.for_parts(&swept, |k, part| {
            let within = [0.0, search.until];
            match part {
                Part::Plane(plane) => search.flat(k as u16, Flat::of_plane(plane), within),
                Part::Table(table) => search.table(k as u16, table),
                Part::Block { .. } | Part::Solid(_) | Part::Mesh(_) => search.solid(k as u16, part, &self.stills[k]),
            }
        });
        let (time, surface) = search.found?;
        Some((body.path.t + time, surface))
    }
}

impl Search<'_> {
    /// Whether a point of the body is already in lasting contact with the part.
    #[inline]
    pub(super) fn lasts(&self, part: u16, point: usize) -> bool {
        matches!(self.body.phase, Phase::Step | Phase::Glide)
            && self.body.touching().contains(&Surface::Part { part, point: point as u16 })
    }

    pub(super) fn hit(&mut self, time: f64, part: u16, point: usize) {
        self.strikes(time, Surface::Part { part, point: point as u16 });
    }

    pub(super) fn strikes(&mut self, time: f64, surface: Surface) {
        self.until = time;
        self.found = Some((time, surface));
    }

    /// When, within `[from, until]`, the sphere around the body comes down to `level` along `normal`.
    fn approach(&self, normal: DVec3, level: f64, from: f64, until: f64) -> Option<f64> {
        let path = &self.body.path;
        let height = normal.dot(path.after(from)) - level - self.spec.reach;
        if height <= 0.0 {
            return Some(from);
        }
        let fall = [height, normal.dot(path.velocity_after(from)), 0.5 * normal.dot(path.a)];
        Some(from + fall_of_quadratic(fall, until - from)?)
    }

    /// Angular velocity after `t`, the time for which `tumble` was last asked. It changes only in free flight, and only
    /// if the moments are not all equal.
    #[inline]
    pub(super) fn spin_at(&self, tumble: &Tumble, t: f64) -> DVec3 {
        if self.spec.wobble == 0.0 || !self.body.turns_freely() {
            self.body.spin
        } else {
            tumble.spin().unwrap_or_else(|| self.body.drift_spin(self.spec, t))
        }
    }
}

/// Sine of the lean from which the lowest point of a rim is followed. Default 0.02; smaller values take more
/// advancements, larger ones see impacts a little early.
const LEANS: f64 = 0.02;
