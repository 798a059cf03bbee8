//! Where convex pieces touch: those of two bodies, or of a body and a fixed part.

use super::contact_id::ContactId;
use super::contact_point::{ContactPoint, PairContactPoint};
use super::ground::{StaticGeometry, StaticPieces};
use super::seams::are_real;
use super::spheres::balls;
use super::static_collider::StaticCollider;
use crate::rigid::body_state::Pose;
use crate::rigid::{BodyDef, RigidWorld};
use crate::scenery::Surface;
use crate::shape::Within;
use crate::shape::convex_pair::{Both, Mark, Meeting, nearest};
use crate::shape::piece::{Core, Piece};
use crate::special_case::SpecialCase;
use glam::DVec3;

impl RigidWorld {
    /// Pieces of two bodies in their places, about the first body's centre of gravity.
    fn both<'w>(&'w self, [i, j]: [usize; 2], [a, b]: [&Pose; 2], own: usize, other: usize) -> Both<'w> {
        let [first, second] = [(i, own), (j, other)].map(|(body, k)| &self.specs[body].pieces[k]);
        Both { first: first.placed(&a.r, DVec3::ZERO), second: second.placed(&b.r, b.x - a.x) }
    }

    /// Calls `each` for all pairs of pieces of two bodies with a gap of at most `within`, and for some others too.
    fn for_near_pieces(
        &self,
        pair: [usize; 2],
        poses: [&Pose; 2],
        within: impl Fn() -> f64,
        mut each: impl FnMut(usize, usize, &Both),
    ) {
        let ([s, t], [a, b]) = (pair.map(|k| &self.specs[k]), poses);
        let shift = b.x - a.x;
        for (own, first) in s.pieces.iter().enumerate() {
            let centre = a.r * first.at;
            // The second body as a whole.
            let away = (centre - shift).length() - first.bounding_radius;
            if away - t.bounding_radius > within() {
                continue;
            }
            for (other, second) in t.pieces.iter().enumerate() {
                let away = (centre - (shift + b.r * second.at)).length();
                if away - first.bounding_radius - second.bounding_radius <= within() {
                    each(own, other, &self.both(pair, poses, own, other));
                }
            }
        }
    }

    /// The nearest points of two bodies by their pieces.
    pub(super) fn nearest_pieces(&self, pair: [usize; 2], poses: [&Pose; 2]) -> PairContactPoint {
        let shift = poses[1].x - poses[0].x;
        let least = std::cell::Cell::new(f64::INFINITY);
        let mut best = None;
        self.for_near_pieces(
            pair,
            poses,
            || least.get(),
            |own, other, both| {
                let m = nearest(both);
                if m.gap < least.get() {
                    least.set(m.gap);
                    best = Some(pair_touch(&m, own, other, shift));
                }
            },
        );
        let [s, t] = pair.map(|k| &self.specs[k]);
        best.unwrap_or_else(|| balls(-shift, [DVec3::ZERO; 2], [s.bounding_radius, t.bounding_radius]))
    }

    /// Whether the axes of pieces leave it open if two bodies are within a gap.
    pub(super) fn pieces_may_be_within(&self, pair: [usize; 2], poses: [&Pose; 2], within: f64) -> bool {
        let is_found = std::cell::Cell::new(false);
        self.for_near_pieces(
            pair,
            poses,
            || if is_found.get() { f64::NEG_INFINITY } else { within },
            |_, _, both| is_found.set(is_found.get() || both.may_be_within(within)),
        );
        is_found.get()
    }

    /// Calls `each` for the points at which pieces of two bodies touch.
    pub(super) fn for_touching_pieces(
        &self,
        pair: [usize; 2],
        poses: [&Pose; 2],
        within: Within,
        mut each: impl FnMut(PairContactPoint),
    ) {
        let (shift, specs) = (poses[1].x - poses[0].x, pair.map(|k| &self.specs[k]));
        self.for_near_pieces(
            pair,
            poses,
            || within.gap,
            |own, other, both| {
                if both.are_beyond(within.gap) {
                    return;
                }
                let nearest = nearest(both);
                // No point comes nearer faster than along the line that keeps the pieces apart.
                if nearest.gap > within.between(nearest.normal, poses, specs.map(|s| s.bounding_radius)).gap {
                    return;
                }
                both.touching(&nearest, within, |m| {
                    if are_real(specs, poses, [own, other], &m) {
                        each(pair_touch(&m, own, other, shift));
                    }
                });
            },
        );
    }

    /// The same point of contact at other poses.
    pub(super) fn pieces_again(
        &self,
        pair: [usize; 2],
        poses: [&Pose; 2],
        id: ContactId,
        towards: DVec3,
    ) -> PairContactPoint {
        let (own, other) = (usize::from(id.own), id.other as usize);
        let both = self.both(pair, poses, own, other);
        // A ball on a convex piece has one point of contact, which moves smoothly from a face over an edge.
        let is_ball = pair.iter().any(|&k| self.specs[k].is_ball);
        let m = if is_ball { nearest(&both) } else { both.again(id.mark, towards) };
        pair_touch(&Meeting { mark: id.mark, ..m }, own, other, poses[1].x - poses[0].x)
    }

    /// If a point belongs to a rim whose lowest point runs around as the body turns: the axis of that rim, in the
    /// body's axes. A rim that crosses an edge touches at that crossing, which is not its lowest point.
    #[inline]
    pub(crate) fn rim_axis(&self, body: usize, t: &ContactPoint) -> Option<DVec3> {
        let spec = &self.specs[body];
        match t.surface {
            Surface::Spot { piece, point, .. } => {
                let id = ContactId::of_surface(piece, point);
                let piece = &spec.pieces[usize::from(id.own)];
                id.mark.own_rim(&piece.core).filter(|&(_, slot)| slot == 0)?;
                let other = self.static_colliders[usize::from(t.part)].pieces.get(id.other as usize);
                let is_on_edge = !matches!(id.mark, Mark::Over { .. })
                    && other.is_some_and(|p| p.is_at_edge(p.turn.transpose() * t.normal));
                (!is_on_edge).then_some(piece.turn.z_axis)
            }
            _ => self.ring_at(body, t.part, t.point()?).map(|_| DVec3::Z),
        }
    }

    /// A point of a body on a part, wherever it is.
    pub(super) fn contact_of_id(&self, index: usize, pose: &Pose, part: u16, id: ContactId) -> ContactPoint {
        let face = if let Mark::Over { face, .. } = id.mark { self.flat(part, face) } else { None };
        let front = self.front(id.surface(part)).map(StaticGeometry::Arc);
        let collider = || StaticGeometry::Collider(&self.static_colliders[usize::from(part)]);
        let geometry = front.or(face.map(StaticGeometry::Flat)).unwrap_or_else(collider);
        touch(part, id, &geometry.again(&self.specs[index], pose, id))
    }

    /// Calls `each` for the points of a body's pieces with a gap of at most `within` to a part.
    pub(super) fn for_piece_contacts(
        &self,
        spec: &BodyDef,
        pose: &Pose,
        (part, StaticPieces { geometry, without }): (usize, StaticPieces),
        all: Within,
        each: &mut dyn FnMut(ContactPoint),
    ) {
        let within = all.gap;
        match geometry {
            StaticGeometry::Flat(plane) => {
                let height = plane.distance(pose.x);
                if height > spec.bounding_radius + within {
                    return;
                }
                for (own, piece) in spec.pieces.iter().enumerate() {
                    let first = piece.placed(&pose.r, DVec3::ZERO);
                    let down = first.axes.transpose() * -plane.normal;
                    for_elements(piece, plane.face, down, |mark, at| {
                        let m = on_plane(first.centre + first.axes * at, piece.rounding, plane.normal, height, mark);
                        if m.gap <= within {
                            each(touch(part as u16, ContactId { own: own as u8, other: plane.piece, mark }, &m));
                        }
                    });
                }
            }
            StaticGeometry::Arc(arc) => Self::for_arc_contacts(spec, pose, (part as u16, arc), within, each),
            StaticGeometry::Collider(collider) => {
                let (mut found, mut near) = (Vec::<ContactPoint>::new(), Vec::new());
                collider.near(pose.x, spec.bounding_radius + within, &mut near);
                let is_new = |found: &[ContactPoint], m: &Meeting| {
                    found.iter().all(|t| !t.is_same(m.points[0], m.normal, spec.size))
                };
                for &other in near.iter().filter(|other| without.binary_search(other).is_err()) {
                    if spec.is_ball && collider.mesh().is_some() && SpecialCase::BallOnMesh.is_on() {
                        let m = collider.under_ball(other, pose.x, spec.bounding_radius, within);
                        if let Some(m) = m.filter(|m| is_new(&found, m)) {
                            found.push(touch(part as u16, ContactId { own: 0, other, mark: m.mark }, &m));
                        }
                        continue;
                    }
                    let here = collider.hollow_facet(other).map_or(all, |n| all.along(n, pose, spec.bounding_radius));
                    for (own, piece) in spec.pieces.iter().enumerate() {
                        let (middle, most) = (pose.x + pose.r * piece.at, piece.bounding_radius + here.gap);
                        if collider.is_far(other, middle, most) {
                            continue;
                        }
                        let both = collider.both(piece, other, pose);
                        collider.for_touching(other, &both, pose.x, here, |m| {
                            if is_new(&found, m) {
                                found.push(touch(part as u16, ContactId { own: own as u8, other, mark: m.mark }, m));
                            }
                        });
                    }
                }
                found.into_iter().for_each(each);
            }
        }
    }
}

impl StaticGeometry<'_> {
    /// The point of a body with that name, wherever it is.
    pub(crate) fn again(&self, spec: &BodyDef, pose: &Pose, id: ContactId) -> Meeting {
        let piece = &spec.pieces[usize::from(id.own)];
        match self {
            Self::Arc(arc) => RigidWorld::arc_again(arc, pose, piece, id.mark),
            Self::Flat(plane) => {
                let first = piece.placed(&pose.r, DVec3::ZERO);
                let down = first.axes.transpose() * -plane.normal;
                let at = element(piece, id.mark, down).unwrap_or_else(|| piece.core.farthest(down));
                let p = first.centre + first.axes * at;
                on_plane(p, piece.rounding, plane.normal, plane.distance(pose.x), id.mark)
            }
            Self::Collider(collider) => {
                let is_ball_on_mesh = spec.is_ball && SpecialCase::BallOnMesh.is_on();
                let ball = || collider.ball_again(id, pose.x, spec.bounding_radius);
                is_ball_on_mesh.then(ball).flatten().unwrap_or_else(|| {
                    let both = collider.both(piece, id.other, pose);
                    let rim = collider.rim_again(id.other, &both, pose.x, id.mark);
                    rim.unwrap_or_else(|| both.again(id.mark, collider.towards(&both, id.other)))
                })
            }
        }
    }
}

impl StaticCollider {
    /// A piece of a body and one of a fixed part, about the body's centre of gravity.
    pub(crate) fn both<'p>(&'p self, piece: &'p Piece, other: u32, pose: &Pose) -> Both<'p> {
        let second = self.pieces[other as usize].about(pose.x);
        Both { first: piece.placed(&pose.r, DVec3::ZERO), second }
    }

    /// The outward normal of a triangle whose edges no body can touch: what touches it does so along this normal.
    fn hollow_facet(&self, piece: u32) -> Option<DVec3> {
        self.facet(piece).filter(|_| self.is_hollow(piece))
    }

    /// A direction towards the body for names that need one.
    fn towards(&self, both: &Both, other: u32) -> DVec3 {
        self.facet(other).unwrap_or_else(|| both.second.project(both.first.centre).0)
    }
}

impl Within {
    /// The same for points along one normal of a body within `reach` of its centre of gravity.
    fn along(&self, normal: DVec3, pose: &Pose, reach: f64) -> Self {
        self.coming(pose.w.cross(normal).length() * reach - pose.v.dot(normal))
    }

    /// The same between two bodies, along the normal towards the first.
    fn between(&self, normal: DVec3, [a, b]: [&Pose; 2], reach: [f64; 2]) -> Self {
        let turning = a.w.cross(normal).length() * reach[0] + b.w.cross(normal).length() * reach[1];
        self.coming(turning - (a.v - b.v).dot(normal))
    }

    /// The same for points that come no nearer than at this speed in m/s.
    fn coming(&self, approach: f64) -> Self {
        Self { gap: self.gap.min(self.still + approach.max(0.0) * self.span), ..*self }
    }
}

/// A point of contact of a body's skin.
fn touch(part: u16, id: ContactId, m: &Meeting) -> ContactPoint {
    ContactPoint { surface: id.surface(part), part, arm: m.points[0], normal: m.normal, gap: m.gap }
}

fn pair_touch(m: &Meeting, own: usize, other: usize, shift: DVec3) -> PairContactPoint {
    let id = ContactId { own: own as u8, other: other as u32, mark: m.mark };
    let arms = [m.points[0], m.points[1] - shift];
    PairContactPoint { normal: m.normal, arms, gap: m.gap, id: Some(id) }
}

/// Calls `each` for the corners and rim points of a piece over a face, in its own axes.
pub(crate) fn for_elements(piece: &Piece, face: u8, down: DVec3, mut each: impl FnMut(Mark, DVec3)) {
    match &piece.core {
        Core::Polyhedron(core) => {
            for (k, &c) in core.corners.iter().enumerate() {
                each(Mark::Over { element: k as u8, slot: 0, face }, c);
            }
        }
        Core::Discs(discs) => {
            for (ring, slot) in (0..2_u8).flat_map(|ring| (0..crate::shape::SLOTS).map(move |slot| (ring, slot))) {
                if let Some(p) = discs.rim(usize::from(ring), slot, down) {
                    each(Mark::Over { element: ring, slot, face }, p);
                }
            }
        }
    }
}

/// The corner or rim point with that name, in the piece's axes.
fn element(piece: &Piece, mark: Mark, down: DVec3) -> Option<DVec3> {
    let Mark::Over { element, slot, .. } = mark else { return None };
    match &piece.core {
        Core::Polyhedron(core) => core.corners.get(usize::from(element)).copied(),
        // A rim that lies flat has no lowest point: any will do.
        Core::Discs(discs) => {
            discs.rim(usize::from(element), slot, down).or_else(|| discs.rim(usize::from(element), 1, down))
        }
    }
}

/// The meeting of a core point with a plane; the origin is at `height` over the plane.
fn on_plane(p: DVec3, rounding: f64, normal: DVec3, height: f64, mark: Mark) -> Meeting {
    let distance = height + normal.dot(p);
    let arm = p - normal * rounding;
    Meeting { normal, points: [arm, p - normal * distance], gap: distance - rounding, mark }
}
