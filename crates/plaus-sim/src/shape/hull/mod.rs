//! Convex polyhedra from points, sharp or rounded.

mod integrals;
mod polyhedron;
mod principal;
mod solid;
mod wrap;

#[cfg(test)]
mod tests;

pub(crate) use polyhedron::{Edge, Face, MOST_CORNERS, MOST_EDGES, MOST_FACES, On, Polyhedron, farthest};
pub use solid::Solid;

use super::MassProperties;
use crate::error::WorldError;
use glam::{DMat3, DQuat, DVec3};
use integrals::Moments;
pub(super) use integrals::outer;
pub(super) use principal::principal;
use std::collections::BTreeMap;

/// Maximum number of corners of one face: enough to keep all points at which a body stands on flat ground
/// (`MOST_TOUCHES` of a body), and some of a wall beside it.
const MOST_CORNERS_OF_A_FACE: usize = 12;

/// Maximum number of points that a hull is made from: the time to find its first face grows with up to the cube of
/// their number.
const MOST_POINTS: usize = 1000;

/// The convex hull of points, or all that is within a radius of it, about its centre of gravity and along its principal
/// axes.
///
/// The points may be given along any axes about any origin. [`centre`](Self::centre) and [`turn`](Self::turn) tell
/// where the body is among them, so that a drawing fits: a given point `p` is at `turn⁻¹ (p − centre)` of the body.
///
/// ```
/// use plaus_sim::shape::{ConvexHull, Shape, Solid};
///
/// let d20 = ConvexHull::new(&Solid::Icosahedron.corners(0.01), 0.0)?;
/// assert_eq!(d20.faces().count(), 20);
/// let mass = Shape::Hull(d20.into()).mass_properties(1200.0);
/// // 5 (3 + √5)/12 of the edge's cube.
/// assert!((mass.mass - 1200.0 * 2.181_694_990_624_912e-6).abs() < 1e-15);
/// # Ok::<(), plaus_sim::WorldError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ConvexHull {
    pub(crate) core: Polyhedron,
    rounding: f64,
    volume: f64,
    /// Of unit density.
    moments: DVec3,
    centre: DVec3,
    turn: DQuat,
    indices: Vec<usize>,
}

impl ConvexHull {
    /// The hull of `points` in m, grown by `rounding` in m (0: sharp). Points inside the hull, on its faces or twice in
    /// the same place do no harm. A point counts as in a plane if it is within 1e-9 of the points' extent.
    ///
    /// # Errors
    /// [`WorldError::BadPoint`] for a point that is not finite, [`WorldError::FewPoints`] for fewer than four distinct
    /// ones, [`WorldError::FlatHull`] if all are in a plane, [`WorldError::LargeHull`] for more than 1000 points, 64
    /// corners or 12 corners of one face, [`WorldError::UnclearHull`] if points are so nearly in a plane that
    /// rounding decides on the faces, [`WorldError::BadNumber`] for a rounding that is negative or not finite.
    pub fn new(points: &[DVec3], rounding: f64) -> Result<Self, WorldError> {
        if let Some((point, &at)) = points.iter().enumerate().find(|(_, p)| !p.is_finite()) {
            return Err(WorldError::BadPoint { point, at });
        }
        if !(rounding >= 0.0 && rounding.is_finite()) {
            return Err(WorldError::BadNumber {
                field: "rounding",
                value: rounding,
                expected: "at least 0, and finite",
            });
        }
        if points.len() < 4 {
            return Err(WorldError::FewPoints { points: points.len() });
        }
        let too_large = |what, count, most| Err(WorldError::LargeHull { what, count, most });
        if points.len() > MOST_POINTS {
            return too_large("points", points.len(), MOST_POINTS);
        }
        let loops = wrap::faces(points)?;
        // Corners in the order in which they were given.
        let mut names: BTreeMap<usize, usize> = loops.iter().flatten().map(|&k| (k, 0)).collect();
        for (name, value) in names.values_mut().enumerate() {
            *value = name;
        }
        let widest = loops.iter().map(Vec::len).max().unwrap_or(0);
        if names.len() > MOST_CORNERS {
            return too_large("corners", names.len(), MOST_CORNERS);
        }
        if widest > MOST_CORNERS_OF_A_FACE {
            return too_large("corners of a face", widest, MOST_CORNERS_OF_A_FACE);
        }
        let loops: Vec<Vec<usize>> = loops.iter().map(|f| f.iter().map(|k| names[k]).collect()).collect();
        let from: Vec<usize> = names.into_keys().collect();
        let at = |place: DVec3, turned: DMat3| {
            Polyhedron::new(from.iter().map(|&k| turned * (points[k] - place)).collect(), &loops)
        };
        let middle = from.iter().fold(DVec3::ZERO, |sum, &k| sum + points[k]) / from.len() as f64;
        let raw = Moments::of(&at(middle, DMat3::IDENTITY), rounding);
        let (off, tensor) = raw.central();
        let (moments, axes) = principal(tensor);
        let (centre, turn) = (middle + off, DQuat::from_mat3(&axes).normalize());
        let core = at(centre, DMat3::from_quat(turn).transpose());
        Ok(Self { core, rounding, volume: raw.volume, moments, centre, turn, indices: from })
    }

    /// Corners in m (of the core, for a rounded hull), in the body's axes about its centre of gravity.
    #[must_use]
    pub fn corners(&self) -> &[DVec3] {
        &self.core.corners
    }

    /// For each corner, the index of the given point.
    #[must_use]
    pub fn indices(&self) -> &[usize] {
        &self.indices
    }

    /// The faces: corners of each, anticlockwise as seen from outside.
    pub fn faces(&self) -> impl Iterator<Item = &[u8]> {
        self.core.faces.iter().map(|f| f.corners.as_slice())
    }

    /// The corners at the ends of each edge.
    pub fn edges(&self) -> impl Iterator<Item = [u8; 2]> {
        self.core.edges.iter().map(|e| e.ends)
    }

    /// Unit normal of a face out of the body, in its axes.
    #[must_use]
    pub fn normal(&self, face: usize) -> Option<DVec3> {
        self.core.faces.get(face).map(|f| f.normal)
    }

    /// How far the body reaches beyond the hull of the points, in m.
    #[must_use]
    pub fn rounding(&self) -> f64 {
        self.rounding
    }

    /// In m³, including the rounding.
    #[must_use]
    pub fn volume(&self) -> f64 {
        self.volume
    }

    /// The centre of gravity, along the axes and about the origin of the given points.
    #[must_use]
    pub fn centre(&self) -> DVec3 {
        self.centre
    }

    /// Turns the body's axes into those of the given points.
    #[must_use]
    pub fn turn(&self) -> DQuat {
        self.turn
    }

    /// Mass and inertia for a uniform density in kg/m³.
    #[must_use]
    pub fn mass_properties(&self, density: f64) -> MassProperties {
        MassProperties { mass: density * self.volume, inertia: self.moments * density }
    }

    /// Distance of the nearest face from the centre of gravity, in m.
    pub(crate) fn size(&self) -> f64 {
        self.core.faces.iter().map(|f| f.offset).fold(f64::INFINITY, f64::min) + self.rounding
    }

    pub(crate) fn reach(&self) -> f64 {
        self.core.bounding_radius + self.rounding
    }
}
