//! What of a fixed part a body meets: half spaces, and what else there is of the part.

use super::facets::Flat;
use super::regions::Region;
use super::static_collider::StaticCollider;
use crate::rigid::body_state::{Pose, RigidBodyState};
use crate::rigid::static_shape::StaticShape;
use crate::rigid::{BodyDef, RigidWorld};
use crate::scenery::{ArcTrack, Plane, Surface};
use crate::special_case::SpecialCase;
use glam::DVec3;

/// What a part is to a body.
#[derive(Debug, Clone, Copy)]
pub(crate) enum StaticGeometry<'w> {
    Flat(Flat),
    Collider(&'w StaticCollider),
    /// The front of a curved track.
    Arc(&'w ArcTrack),
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

    /// What else there is of a part than its faces of a region.
    fn beside_region(region: &'w Region, part: usize, collider: &'w StaticCollider) -> Option<Self> {
        let without = region.pieces(part as u16);
        let geometry = StaticGeometry::Collider(collider);
        (without.len() < collider.pieces.len()).then_some(Self { geometry, without })
    }

    /// What else there is of a mesh than one of its faces.
    pub(crate) fn beside(collider: &'w StaticCollider, face: Flat) -> Self {
        Self { geometry: StaticGeometry::Collider(collider), without: collider.facets.pieces(face.face) }
    }
}

impl RigidWorld {
    /// What a part that is no table is to a body at a pose: a half space, and what else there is of it, but
    /// for the front of a curved track.
    #[inline]
    pub(crate) fn ground(&self, spec: &BodyDef, part: usize, pose: &Pose) -> (Option<Flat>, Option<StaticPieces<'_>>) {
        match &self.parts[part] {
            StaticShape::Plane(_) if part >= self.own_parts => {
                (self.region_below(spec, part, pose).map(Flat::of_plane), None)
            }
            StaticShape::Plane(plane) => (Some(Flat::of_plane(plane)), None),
            StaticShape::Table(_) => (None, None),
            StaticShape::Block { .. } | StaticShape::Solid(_) | StaticShape::Mesh(_) | StaticShape::Arc(_) => {
                let collider = &self.static_colliders[part];
                if let Some(rest) = self.beside_region(spec, part, pose) {
                    return (None, rest);
                }
                let is_ball_on_mesh = spec.is_ball && collider.mesh().is_some() && SpecialCase::BallOnMesh.is_on();
                match if is_ball_on_mesh || !SpecialCase::Faces.is_on() {
                    None
                } else {
                    collider.facets.below(spec, pose)
                } {
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

    /// The region that a part stands for.
    pub(crate) fn region(&self, part: usize) -> Option<&Region> {
        self.regions.get(part.checked_sub(self.own_parts)?)
    }

    /// The regions that a part has faces of.
    fn regions_of(&self, part: usize) -> impl Iterator<Item = &Region> {
        self.static_colliders[part].regions.iter().map(|&k| &self.regions[usize::from(k)])
    }

    /// If a body is over a region that a part has faces of: what else there is of the part.
    pub(super) fn beside_region(&self, spec: &BodyDef, part: usize, pose: &Pose) -> Option<Option<StaticPieces<'_>>> {
        let region = self.regions_of(part).find(|region| region.is_below(spec, pose))?;
        Some(StaticPieces::beside_region(region, part, &self.static_colliders[part]))
    }

    /// The half space of a region, if a body is over it.
    pub(super) fn region_below(&self, spec: &BodyDef, part: usize, pose: &Pose) -> Option<&Plane> {
        self.region(part).filter(|region| region.is_below(spec, pose)).map(Region::plane)
    }

    /// Until when after its clock, at most `until`, a body is over the region that a part stands for or has faces of;
    /// with what else there is of the part. Points of a lasting contact keep their names through a step.
    pub(crate) fn over_region(
        &self,
        part: usize,
        body: (&BodyDef, &RigidBodyState),
        until: f64,
    ) -> Option<(f64, Option<StaticPieces<'_>>)> {
        let (spec, state) = body;
        let lasts = |end: &f64| state.flies() || *end >= until;
        if let Some(region) = self.region(part) {
            return Some((region.until(spec, state, until).filter(lasts)?, None));
        }
        self.regions_of(part).find_map(|region| {
            let end = region.until(spec, state, until).filter(lasts)?;
            Some((end, StaticPieces::beside_region(region, part, &self.static_colliders[part])))
        })
    }

    /// Whether a contact with one part is one with the other: they are the same, or one is a region and has faces of
    /// the other.
    pub(crate) fn is_one(&self, part: u16, other: u16) -> bool {
        let has = |a: u16, b: u16| self.region(usize::from(a)).is_some_and(|region| !region.pieces(b).is_empty());
        part == other || has(part, other) || has(other, part)
    }

    /// A surface as the description of the world numbers it: flush faces have a part of their own behind those of the
    /// description, and the answer is the part of the face under the point.
    #[must_use]
    pub fn user_surface(&self, surface: Surface, x: DVec3) -> Surface {
        let (Surface::Part { part, .. } | Surface::Spot { part, .. }) = surface else { return surface };
        let own = self.region(usize::from(part)).and_then(|region| region.part_at(x)).unwrap_or(part);
        match surface {
            Surface::Part { point, .. } => Surface::Part { part: own, point },
            Surface::Spot { piece, point, .. } => Surface::Spot { part: own, piece, point },
            _ => surface,
        }
    }
}
