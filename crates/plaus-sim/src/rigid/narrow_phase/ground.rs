//! What of a fixed part a body meets: half spaces, and what else there is of the part.

use super::facets::Flat;
use super::static_collider::StaticCollider;
use crate::rigid::body_state::Pose;
use crate::rigid::static_shape::StaticShape;
use crate::rigid::{BodyDef, RigidWorld};

/// What a part is to a body.
#[derive(Debug, Clone, Copy)]
pub(crate) enum StaticGeometry<'w> {
    Flat(Flat),
    Collider(&'w StaticCollider),
}

/// What of a part a body's pieces meet: all of it, or all but some pieces, as the body meets these as a half space.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StaticPieces<'w> {
    pub(crate) geometry: StaticGeometry<'w>,
    /// The pieces that are left out, in ascending order.
    pub(crate) without: &'w [u32],
}

impl<'w> StaticPieces<'w> {
    pub(crate) fn all(geometry: StaticGeometry<'w>) -> Self {
        Self { geometry, without: &[] }
    }

    pub(crate) fn flat(flat: Flat) -> Self {
        Self::all(StaticGeometry::Flat(flat))
    }

    /// What else there is of a mesh than one of its faces.
    pub(crate) fn beside(collider: &'w StaticCollider, face: Flat) -> Self {
        Self { geometry: StaticGeometry::Collider(collider), without: collider.facets.pieces(face.face) }
    }
}

impl RigidWorld {
    /// What a part that is no table is to a body at a pose: a half space, and what else there is of it.
    #[inline]
    pub(crate) fn ground(&self, spec: &BodyDef, part: usize, pose: &Pose) -> (Option<Flat>, Option<StaticPieces<'_>>) {
        match &self.parts[part] {
            StaticShape::Plane(_) if part >= self.own_parts => {
                (self.region_below(spec, part, pose).map(Flat::of_plane), None)
            }
            StaticShape::Plane(plane) => (Some(Flat::of_plane(plane)), None),
            StaticShape::Table(_) => (None, None),
            StaticShape::Block { .. } | StaticShape::Solid(_) | StaticShape::Mesh(_) => {
                let collider = &self.static_colliders[part];
                if let Some(rest) = self.beside_region(spec, part, pose) {
                    return (None, rest);
                }
                let is_ball_on_mesh = spec.is_ball && collider.mesh().is_some();
                match if is_ball_on_mesh { None } else { collider.facets.below(spec, pose) } {
                    Some(flat) => (Some(flat), collider.mesh().map(|_| StaticPieces::beside(collider, flat))),
                    None => (None, Some(StaticPieces::all(StaticGeometry::Collider(collider)))),
                }
            }
        }
    }

    /// The half space that a point is over by its name.
    pub(super) fn flat(&self, part: u16, face: u8) -> Option<Flat> {
        match &self.parts[usize::from(part)] {
            StaticShape::Plane(plane) => Some(Flat::of_plane(plane)),
            _ => self.static_colliders[usize::from(part)].facets.flat(face),
        }
    }
}
