//! First contact of a rigid body with a fixed part, by conservative advancement of second order.
//!
//! Each contact sphere's gap `f` obeys `f(t + τ) ≥ f + f′ τ − M τ²/2`, where `M` bounds its acceleration towards the
//! part: gravity, rotation, and the surface's curvature times speed squared. The body is advanced by the first root of
//! these parabolas over all contact spheres, which cannot overshoot and converges quadratically, until a gap is below
//! half of the one at which bodies touch, and closing. A gap that is small but opening is no event (rule of
//! `crate::roots`); the search goes on from where it can close again.

use super::convex::{ImpactTarget, TimeOfImpact};
use crate::rigid::body_state::{Phase, Pose, RigidBodyState};
use crate::rigid::motion::free_rotation::FreeRotation;
use crate::rigid::narrow_phase::facets::Flat;
use crate::rigid::narrow_phase::ground::{StaticGeometry, StaticPieces};
use crate::rigid::narrow_phase::static_collider::StaticCollider;
use crate::rigid::static_shape::StaticShape;
use crate::rigid::tolerances::{FLUSH_WITH_ARC, UNSTRUCK_APPROACH};
use crate::rigid::{BodyDef, RigidWorld, ShapeKind};
use crate::roots::fall_of_quadratic;
use crate::scenery::{Aabb, Surface};
use crate::special_case::SpecialCase;
use glam::DVec3;

/// Up to this many parts, all are asked: 8.
const FEW: usize = 8;

/// A search for the first contact of one body.
pub(crate) struct StaticTimeOfImpact<'s> {
    pub(super) world: &'s RigidWorld,
    pub(crate) spec: &'s BodyDef,
    pub(crate) body: &'s RigidBodyState,
    /// Largest angular speed.
    pub(crate) fastest: f64,
    /// Acceleration of a point, over its distance from the centre.
    pub(crate) turning: f64,
    /// The same for points on the axis of a body of revolution.
    pub(super) axial: f64,
    pub(crate) until: f64,
    /// The box that the body stays in until then.
    pub(crate) swept: Aabb,
    /// Approach in m/s that steps of lasting contact deal with, however elastic the law.
    pub(crate) slow: f64,
    pub(crate) found: Option<(f64, Surface)>,
}

impl RigidWorld {
    /// Calls `each` for the parts that may have a point in a box, in the order in which they are listed.
    pub(crate) fn for_parts(&self, around: &Aabb, mut each: impl FnMut(usize, &StaticShape)) {
        if self.parts.len() <= FEW && SpecialCase::FewParts.is_on() {
            return self.parts.iter().enumerate().for_each(|(k, part)| each(k, part));
        }
        let mut near = Vec::new();
        self.scenery.find(around, &mut near);
        near.extend(&self.endless);
        near.sort_unstable();
        near.into_iter().for_each(|k| each(k as usize, &self.parts[k as usize]));
    }

    /// First point of a body that touches a part, not after `until`.
    pub(crate) fn first_touch(&self, index: usize, body: &RigidBodyState, until: f64) -> Option<(f64, Surface)> {
        let moves = matches!(body.phase, Phase::Flight | Phase::Leg | Phase::Step | Phase::Articulated | Phase::Glide);
        if !moves || self.parts.is_empty() {
            return None;
        }
        let spec = &self.specs[index];
        let free = body.turns_freely();
        let momentum = spec.inertia.momentum(body.turn, body.spin).length();
        let fastest = if free {
            (momentum / spec.inertia.moments.min_element()).min(body.spin.length() * (1.0 + spec.anisotropy))
        } else {
            body.spin.length()
        };
        let fastest = if body.is_keyed() {
            body.fastest(spec, until)
        } else if spec.anisotropy == 0.0 || !free {
            body.spin.length()
        } else {
            fastest
        };
        let turning = fastest * fastest * if free { 1.0 + spec.anisotropy } else { 1.0 };
        // The axis of a top only swings: at |L|/I₁ in flight; in a step, with the body.
        let across = body.spin.reject_from_normalized(body.turn * DVec3::Z).length();
        let axial = match spec.skin {
            ShapeKind::Revolved => across * if free { momentum / spec.inertia.moments.x } else { body.spin.length() },
            _ => turning,
        };
        let axial = if body.is_keyed() { turning } else { axial };
        let slow = UNSTRUCK_APPROACH * self.accuracy.settle * spec.speed;
        let until = until - body.path.t;
        let swept = body.path.bounds(0.0, until).grown(spec.bounding_radius * (1.0 + 1e-9) + spec.gap);
        let world = self;
        let mut search =
            StaticTimeOfImpact { world, spec, body, fastest, turning, axial, until, swept, slow, found: None };
        self.for_parts(&swept, |k, part| {
            let within = [0.0, search.until];
            match part {
                StaticShape::Plane(plane) if k < self.own_parts => {
                    search.flat(k as u16, Flat::of_plane(plane), within);
                }
                StaticShape::Plane(plane) => {
                    if let Some((until, _)) = self.over_region(k, (spec, body), search.until) {
                        search.flat(k as u16, Flat::of_plane(plane), [0.0, until]);
                    }
                }
                StaticShape::Table(table) => search.table(k as u16, table),
                StaticShape::Arc(arc) => search.arc(k as u16, (part, arc), &self.static_colliders[k]),
                StaticShape::Block { .. } | StaticShape::Solid(_) | StaticShape::Mesh(_) => {
                    let before = (search.until, search.found);
                    search.solid(k as u16, part, &self.static_colliders[k]);
                    if search.found != before.1 && self.is_flush_with_arc(index, body, search.found) {
                        (search.until, search.found) = before;
                    }
                }
            }
        });
        let (time, surface) = search.found?;
        Some((body.path.t + time, surface))
    }
}

impl RigidWorld {
    /// Whether a ball that rolls or slides on a curved track finds something along the track's own normal, and does not
    /// overlap it: what the track leads on to.
    fn is_flush_with_arc(&self, index: usize, body: &RigidBodyState, found: Option<(f64, Surface)>) -> bool {
        let spec = &self.specs[index];
        let (true, Phase::Step, Some((time, surface))) = (spec.is_ball, body.phase, found) else { return false };
        let Some(arc) = body.touching().iter().find_map(|&held| self.front(held)) else { return false };
        let pose = Pose { x: body.path.after(time), ..body.pose() };
        let touch = self.touch(index, &pose, surface);
        touch.gap > 0.5 * spec.gap && (touch.normal - arc.normal(pose.x).0).length() <= FLUSH_WITH_ARC
    }
}

impl StaticTimeOfImpact<'_> {
    /// Whether a point of the body is already in lasting contact with the part.
    #[inline]
    pub(crate) fn lasts(&self, part: u16, point: usize) -> bool {
        matches!(self.body.phase, Phase::Step | Phase::Glide)
            && self.body.touching().iter().any(|surface| match *surface {
                Surface::Part { part: p, point: k } => usize::from(k) == point && self.world.is_one(p, part),
                _ => false,
            })
    }

    pub(super) fn hit(&mut self, time: f64, part: u16, point: usize) {
        self.strikes(time, Surface::Part { part, point: point as u16 });
    }

    pub(crate) fn strikes(&mut self, time: f64, surface: Surface) {
        self.until = time;
        self.found = Some((time, surface));
    }

    /// When, within `[from, until]`, the sphere around the body comes down to `level` along `normal`.
    pub(crate) fn approach(&self, normal: DVec3, level: f64, from: f64, until: f64) -> Option<f64> {
        let path = &self.body.path;
        let height = normal.dot(path.after(from)) - level - self.spec.bounding_radius;
        if height <= 0.0 {
            return Some(from);
        }
        let fall = [height, normal.dot(path.velocity_after(from)), 0.5 * normal.dot(path.a)];
        Some(from + fall_of_quadratic(fall, until - from)?)
    }

    /// Angular velocity after `t`, the time for which `free_rotation` was last asked. It changes only in free flight,
    /// and only if the moments are not all equal.
    #[inline]
    pub(super) fn spin_at(&self, free_rotation: &FreeRotation, t: f64) -> DVec3 {
        if self.body.is_keyed() {
            self.body.keyed_spin(self.spec, t)
        } else if self.spec.anisotropy == 0.0 || !self.body.turns_freely() {
            self.body.spin
        } else {
            free_rotation.spin().unwrap_or_else(|| self.body.drift_spin(self.spec, t))
        }
    }
}

impl RigidWorld {
    /// First time in `[from, until]` at which pieces of two bodies touch while approaching. For bodies in lasting
    /// contact (`linked`), only points that are not yet part of it count.
    pub(crate) fn first_of_pieces(
        &self,
        [i, j]: [usize; 2],
        bodies: [&RigidBodyState; 2],
        [from, until]: [f64; 2],
        linked: bool,
    ) -> Option<f64> {
        // The same search whichever is listed first, and however the world is turned: it ends within the gap, not at a
        // root.
        let key = |k: usize, b: &RigidBodyState| {
            let (spec, velocity) = (&self.specs[k], b.path.velocity_after(from - b.path.t));
            let height = self.gravity.dot(b.path.at(from));
            [spec.bounding_radius, spec.mass, height, velocity.length_squared(), b.spin.length_squared()]
        };
        let keys = [key(i, bodies[0]), key(j, bodies[1])];
        let is_first = (0..5).map(|k| keys[0][k].total_cmp(&keys[1][k])).find(|o| o.is_ne()).is_none_or(|o| o.is_lt());
        let ([i, j], bodies) = if is_first { ([i, j], bodies) } else { ([j, i], [bodies[1], bodies[0]]) };
        let target = ImpactTarget::Body(&self.specs[j], bodies[1]);
        let level = self.pair_gap([i, j]);
        let (spec, body, skip) = (&self.specs[i], bodies[0], &[][..]);
        let query = TimeOfImpact { spec, body, target, level, from, until, linked, skip };
        query.first().map(|found| found.0)
    }
}

impl StaticTimeOfImpact<'_> {
    /// Whether the body is in lasting contact with a part.
    fn is_linked(&self, part: u16) -> bool {
        let of_part = |s: &Surface| match s {
            Surface::Part { part: p, .. } | Surface::Spot { part: p, .. } => self.world.is_one(*p, part),
            _ => false,
        };
        matches!(self.body.phase, Phase::Step | Phase::Glide) && self.body.touching().iter().any(of_part)
    }

    /// First contact of a body with a fixed solid or mesh. While the body is over the inside of a flat face, the solid
    /// is the half space behind that face.
    pub(crate) fn solid(&mut self, part: u16, whole: &StaticShape, collider: &StaticCollider) {
        let (spec, body) = (self.spec, self.body);
        if !collider.bounds().meets(&self.swept) {
            return;
        }
        if spec.is_ball {
            if let Some(mesh) = collider.mesh().filter(|_| SpecialCase::BallOnMesh.is_on()) {
                return self.ball(part, collider, mesh);
            }
            if collider.pieces.len() == 1 && self.is_linked(part) {
                // A ball touches a convex solid at one point only; when it leaves is an event of its motion.
                return;
            }
        }
        let end = self.until;
        if let Some((until, rest)) = self.world.over_region(usize::from(part), (spec, body), end) {
            if let Some(rest) = rest {
                self.pieces(part, rest, [0.0, until]);
            }
            if until < end && self.until == end {
                self.convex(part, whole, collider, [until, end]);
            }
            return;
        }
        match collider.facets.until(spec, body, end).filter(|_| SpecialCase::Faces.is_on()) {
            // Points of a lasting contact keep their names through a step.
            Some((flat, until)) if body.flies() || until >= end => {
                if collider.mesh().is_some() {
                    self.pieces(part, StaticPieces::flat(flat), [0.0, until]);
                    // What else there is of the mesh.
                    self.pieces(part, StaticPieces::beside(collider, flat), [0.0, until.min(self.until)]);
                } else {
                    self.flat(part, flat, [0.0, until]);
                }
                if until < end && self.until == end {
                    self.convex(part, whole, collider, [until, end]);
                }
            }
            _ => self.convex(part, whole, collider, [0.0, end]),
        }
    }

    /// First contact of a body with a fixed solid, wherever it is.
    fn convex(&mut self, part: u16, whole: &StaticShape, collider: &StaticCollider, within: [f64; 2]) {
        if self.spec.meets_by_rings(whole) {
            self.block(part, whole, within);
        } else {
            self.pieces(part, StaticPieces::all(StaticGeometry::Collider(collider)), within);
        }
    }

    /// First contact of a body with a half space.
    pub(crate) fn flat(&mut self, part: u16, flat: Flat, within: [f64; 2]) {
        if self.spec.is_compound() {
            self.pieces(part, StaticPieces::flat(flat), within);
        } else if let Some((time, point)) = self.half_space(part, (flat.normal, flat.offset), within) {
            self.hit(time, part, point);
        }
    }

    /// First contact of a body's pieces with a part.
    pub(crate) fn pieces(&mut self, part: u16, ground: StaticPieces, [from, until]: [f64; 2]) {
        let (spec, body) = (self.spec, self.body);
        let linked = self.is_linked(part);
        let start = body.path.t;
        let (from, until) = (start + from, start + until);
        let query = TimeOfImpact {
            spec,
            body,
            target: ImpactTarget::Ground(ground.geometry),
            level: spec.gap,
            from,
            until,
            linked,
            skip: ground.without,
        };
        if let Some((time, id)) = query.first() {
            self.strikes(time - start, id.surface(part));
        }
    }
}
