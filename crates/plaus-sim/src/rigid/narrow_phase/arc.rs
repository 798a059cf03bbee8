//! The front of a curved track as bodies see it. Distance from its axis is a convex function, so what of a convex piece
//! is nearest to the front is a corner, or a point of a rim.

use super::contact_id::ContactId;
use super::contact_point::ContactPoint;
use crate::rigid::body_state::Pose;
use crate::rigid::static_shape::StaticShape;
use crate::rigid::tolerances::RIM_SAMPLES;
use crate::rigid::{BodyDef, RigidWorld};
use crate::roots::refine;
use crate::scenery::{ArcTrack, Surface};
use crate::shape::convex_pair::{Mark, Meeting};
use crate::shape::piece::{Core, Piece, Placed};
use glam::DVec3;
use plaus_dist::math;
use std::f64::consts::TAU;

/// The number of the front among the pieces of a part: behind it are the pieces of the back.
pub(crate) const FRONT: u32 = u32::MAX;

/// The points of a rim that are farthest from the axis of a track, two at most.
struct Farthest([Option<DVec3>; 2]);

impl Farthest {
    /// Of the rim about `centre` with these two arms.
    fn on_rim(arc: &ArcTrack, centre: DVec3, [u, v]: [DVec3; 2]) -> Self {
        let (m, a, b) = (arc.place(centre).with_y(0.0), arc.way(u).with_y(0.0), arc.way(v).with_y(0.0));
        // Half of the square's derivatives.
        let rates = |angle: f64| {
            let (s, c) = math::sin_cos(angle);
            let (p, along) = (m + a * c + b * s, b * c - a * s);
            (p.dot(along), along.length_squared() - p.dot(a * c + b * s))
        };
        let angles: [f64; RIM_SAMPLES] = std::array::from_fn(|k| TAU * (k as f64 / RIM_SAMPLES as f64));
        let far = angles.map(|angle| {
            let (s, c) = math::sin_cos(angle);
            (m + a * c + b * s).length_squared()
        });
        let step = TAU / RIM_SAMPLES as f64;
        let place = |angle: f64| {
            let (s, c) = math::sin_cos(angle);
            centre + u * c + v * s
        };
        let mut found = [None; 2];
        for k in 0..RIM_SAMPLES {
            let (before, after) = (far[(k + RIM_SAMPLES - 1) % RIM_SAMPLES], far[(k + 1) % RIM_SAMPLES]);
            if far[k] < before || far[k] <= after {
                continue;
            }
            let low = if rates(angles[k]).0 > 0.0 { angles[k] } else { angles[k] - step };
            let is_bracket = rates(low).0 > 0.0 && rates(low + step).0 < 0.0;
            let angle = if is_bracket { refine(rates, low, low + step, true) } else { angles[k] };
            if let Some(free) = found.iter_mut().find(|f| f.is_none()) {
                *free = Some(place(angle));
            }
        }
        // A rim about the axis has none: any point will do.
        Self([found[0].or(Some(place(0.0))), found[1]])
    }

    /// The points with the slots of their names: 0 for one alone, 1 and 2 for those on either side of the rim's middle.
    fn named(&self, arc: &ArcTrack, centre: DVec3) -> impl Iterator<Item = (u8, DVec3)> {
        let side = |p: DVec3| {
            let (m, p) = (arc.place(centre), arc.place(p));
            if m.x * p.z - m.z * p.x > 0.0 { 1 } else { 2 }
        };
        let (is_one, first) = (self.0[1].is_none(), self.0[0].map(side));
        let name = move |(k, p): (usize, DVec3)| match (is_one, first) {
            (true, _) => (0, p),
            (_, Some(first)) if k == 1 => (3 - first, p),
            _ => (first.unwrap_or(1), p),
        };
        self.0.into_iter().flatten().enumerate().map(name)
    }

    /// The point with that name: if there is none, the one that is farther from the axis.
    fn again(&self, arc: &ArcTrack, centre: DVec3, slot: u8) -> Option<DVec3> {
        let named = self.named(arc, centre).find(|(name, _)| *name == slot).map(|(_, p)| p);
        let out = |p: &DVec3| arc.normal(*p).1;
        named.or_else(|| self.0.into_iter().flatten().max_by(|p, q| out(p).total_cmp(&out(q))))
    }
}

/// Calls `each` for what of a piece may touch the front: its name, its place from `x`, and whether it moves on the
/// skin. The piece is about `x`.
pub(crate) fn for_arc_elements(arc: &ArcTrack, x: DVec3, first: &Placed, mut each: impl FnMut(Mark, DVec3, bool)) {
    let mark = |element: u8, slot: u8| Mark::Over { element, slot, face: Mark::PLANE };
    match first.core {
        Core::Polyhedron(core) => {
            for (k, &c) in core.corners.iter().enumerate() {
                each(mark(k as u8, 0), first.centre + first.axes * c, false);
            }
        }
        Core::Discs(discs) => {
            let is_flat = discs.heights[0] == discs.heights[1] && discs.radii[0] == discs.radii[1];
            for ring in 0..if is_flat { 1 } else { 2 } {
                let (centre, r) = (first.centre + first.axes.z_axis * discs.heights[ring], discs.radii[ring]);
                if r == 0.0 {
                    each(mark(ring as u8, 0), centre, false);
                    continue;
                }
                let arms = [first.axes.x_axis * r, first.axes.y_axis * r];
                let farthest = Farthest::on_rim(arc, x + centre, arms);
                farthest.named(arc, x + centre).for_each(|(slot, p)| each(mark(ring as u8, slot), p - x, true));
            }
        }
    }
}

/// The place of an element with this name, likewise.
fn element(arc: &ArcTrack, x: DVec3, first: &Placed, mark: Mark) -> Option<DVec3> {
    let Mark::Over { element, slot, .. } = mark else { return None };
    match first.core {
        Core::Polyhedron(core) => core.corners.get(usize::from(element)).map(|&c| first.centre + first.axes * c),
        Core::Discs(discs) => {
            let ring = usize::from(element).min(1);
            let (centre, r) = (first.centre + first.axes.z_axis * discs.heights[ring], discs.radii[ring]);
            let arms = [first.axes.x_axis * r, first.axes.y_axis * r];
            Farthest::on_rim(arc, x + centre, arms).again(arc, x + centre, slot).map(|p| p - x)
        }
    }
}

/// The meeting of a core point at `p` from `x` with the front.
pub(crate) fn on_arc(arc: &ArcTrack, x: DVec3, p: DVec3, rounding: f64, mark: Mark) -> Meeting {
    let (normal, out) = arc.normal(x + p);
    let distance = arc.form().radius - out;
    Meeting { normal, points: [p - normal * rounding, p - normal * distance], gap: distance - rounding, mark }
}

impl RigidWorld {
    /// The curved track whose front a surface is.
    #[inline]
    pub(crate) fn front(&self, surface: Surface) -> Option<&ArcTrack> {
        let (Surface::Part { part, .. } | Surface::Spot { part, piece: FRONT, .. }) = surface else { return None };
        match &self.parts[usize::from(part)] {
            StaticShape::Arc(arc) => Some(arc),
            _ => None,
        }
    }

    /// Calls `each` for the points of a body with a gap of at most `within` to the front of a track.
    pub(super) fn for_arc_contacts(
        spec: &BodyDef,
        pose: &Pose,
        (part, arc): (u16, &ArcTrack),
        within: f64,
        each: &mut dyn FnMut(ContactPoint),
    ) {
        let form = arc.form();
        if spec.is_ball {
            let (normal, out) = arc.normal(pose.x);
            let gap = form.radius - out - spec.bounding_radius;
            let is_in = form.radius > spec.bounding_radius && gap <= within;
            if is_in && arc.is_on((pose.x, pose.v), gap, spec.gap) {
                each(ContactPoint::of_point(part, 0, normal * -spec.bounding_radius, normal, gap));
            }
            return;
        }
        for (own, piece) in spec.pieces.iter().enumerate().filter(|(_, piece)| piece.rounding < form.radius) {
            let (middle, reach) = (pose.x + pose.r * piece.at, piece.bounding_radius + within);
            if arc.normal(middle).1 + reach < form.radius {
                continue;
            }
            for_arc_elements(arc, pose.x, &piece.placed(&pose.r, DVec3::ZERO), |mark, p, _| {
                let m = on_arc(arc, pose.x, p, piece.rounding, mark);
                if m.gap <= within && arc.is_on((pose.x + p, pose.velocity(p)), m.gap, spec.gap) {
                    each(touch(part, own as u8, &m));
                }
            });
        }
    }

    /// A point of a body's piece on the front of a track, wherever it is.
    pub(super) fn arc_again(arc: &ArcTrack, pose: &Pose, piece: &Piece, mark: Mark) -> Meeting {
        let first = piece.placed(&pose.r, DVec3::ZERO);
        let p = element(arc, pose.x, &first, mark).unwrap_or(first.centre);
        on_arc(arc, pose.x, p, piece.rounding, mark)
    }
}

fn touch(part: u16, own: u8, m: &Meeting) -> ContactPoint {
    let id = ContactId { own, other: FRONT, mark: m.mark };
    ContactPoint { surface: id.surface(part), part, arm: m.points[0], normal: m.normal, gap: m.gap }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Material;
    use crate::scenery::ArcForm;
    use glam::DQuat;

    /// Compared with points all around the rim.
    #[test]
    fn the_farthest_points_of_a_rim_are_found() {
        let form = ArcForm { radius: 1.0, angles: [0.0, TAU], width: 9.0, pitch: 0.0, thickness: 0.1, walls: 0.0 };
        let turn = DQuat::from_rotation_x(0.7) * DQuat::from_rotation_z(0.4);
        let arc = ArcTrack::new(form, DVec3::new(0.1, 0.2, 0.3), turn, Material(0)).unwrap();
        let mut seed = 5_u64;
        let mut next = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let mut counts = [0; 2];
        for _ in 0..500 {
            let centre = DVec3::new(next(), next(), next());
            let z = DVec3::new(next(), next(), next()).normalize();
            let u = z.any_orthonormal_vector() * 0.4;
            let v = z.cross(u);
            let found = Farthest::on_rim(&arc, centre, [u, v]);
            let out = |p: DVec3| arc.normal(p).1;
            let best = found.0.into_iter().flatten().map(out).fold(0.0, f64::max);
            let around = (0..3000).map(|k| {
                let (s, c) = math::sin_cos(TAU * f64::from(k) / 3000.0);
                out(centre + u * c + v * s)
            });
            let truth = around.fold(0.0, f64::max);
            // A chord of a 3000th of a turn of a circle of 0.4: 0.4 · 0.001²/2.
            assert!(best >= truth - 1e-14 && best < truth + 1e-6, "{best} {truth}");
            counts[usize::from(found.0[1].is_some())] += 1;
            for (slot, p) in found.named(&arc, centre) {
                assert_eq!(found.again(&arc, centre, slot), Some(p));
            }
        }
        assert!(counts[0] > 50 && counts[1] > 50, "{counts:?}");
    }
}
