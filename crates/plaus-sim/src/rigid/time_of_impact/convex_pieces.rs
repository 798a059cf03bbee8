//! When bodies that meet others by their convex pieces first touch: each other, and fixed parts.

use super::convex::{ImpactTarget, TimeOfImpact};
use super::static_search::StaticTimeOfImpact;
use crate::rigid::RigidWorld;
use crate::rigid::body_state::{Phase, RigidBodyState};
use crate::rigid::narrow_phase::facets::Flat;
use crate::rigid::narrow_phase::ground::{StaticGeometry, StaticPieces};
use crate::rigid::narrow_phase::static_collider::StaticCollider;
use crate::rigid::static_shape::StaticShape;
use crate::scenery::Surface;

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
            if let Some(mesh) = collider.mesh() {
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
        match collider.facets.until(spec, body, end) {
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
