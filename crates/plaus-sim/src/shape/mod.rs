//! Shapes of rigid bodies, their mass properties, and the points and balls that make up their skin.
//!
//! The simulator sees a shape as **contact spheres**: balls fixed in the body. Their union has the shape's surface
//! wherever it can touch something. A sharp corner is a ball of radius 0, a rounded one has its rounding radius, a
//! sphere is a single ball, and a body of revolution is a row of balls along its axis and the rounded rim of its foot.
//! Two bodies with flat faces are compared by faces, edges and corners.

mod compound;
pub(crate) mod convex_pair;
mod cuboid;
mod frustum;
mod hull;
pub(crate) mod hull_pair;
mod mass;
pub(crate) mod piece;
mod revolution;

pub use compound::{Compound, Convex, Member};
pub use cuboid::Cuboid;
pub use frustum::Frustum;
pub(crate) use frustum::SLOTS;
pub use hull::{ConvexHull, Solid};
pub(crate) use hull::{Face as PolyhedronFace, On, Polyhedron};
pub use mass::MassProperties;
pub use revolution::{Profile, Revolution, Ring};

use crate::error::WorldError;
use glam::{DMat3, DVec3};
use piece::{Core, Piece};
use std::sync::Arc;

/// A ball fixed in a body: centre in m from the centre of gravity along the body's axes, and radius in m.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ContactSphere {
    /// Centre.
    pub centre: DVec3,
    /// Radius; 0 for a sharp corner.
    pub radius: f64,
}

/// Which points of two bodies are asked for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Within {
    /// Largest gap in m.
    pub(crate) gap: f64,
    /// Largest gap in m of points that do not approach; of others it is larger by their approach in `span` seconds.
    pub(crate) still: f64,
    pub(crate) span: f64,
    /// How far beyond an edge a corner may be and still count as over the face beside it, in m.
    pub(crate) beside: f64,
}

impl From<f64> for Within {
    fn from(gap: f64) -> Self {
        Self { gap, still: gap, span: 0.0, beside: gap }
    }
}

/// The shape of a rigid body about its centre of gravity, with the body's axes along its principal axes.
#[derive(Debug, Clone)]
pub enum Shape {
    /// A sphere of this radius in m.
    Ball(f64),
    /// A cuboid.
    Cuboid(Cuboid),
    /// A body of revolution about its z axis.
    Revolution(Arc<Revolution>),
    /// A convex polyhedron.
    Hull(Arc<ConvexHull>),
    /// One or several convex solids, each with a pose: cylinders, cones and capsules among them.
    Compound(Arc<Compound>),
}

impl Shape {
    /// Radius of the sphere around the centre of gravity that holds the shape, in m.
    #[must_use]
    pub fn reach(&self) -> f64 {
        match self {
            Self::Ball(radius) => *radius,
            Self::Cuboid(c) => (c.half() - c.rounding()).length() + c.rounding(),
            Self::Revolution(r) => r.reach(),
            Self::Hull(h) => h.reach(),
            Self::Compound(c) => c.reach(),
        }
    }

    /// The unit of length for tolerances: the shape's least half width, in m.
    #[must_use]
    pub fn size(&self) -> f64 {
        match self {
            Self::Ball(radius) => *radius,
            Self::Cuboid(c) => c.half().min_element(),
            Self::Revolution(r) => r.rings()[0].circle,
            Self::Hull(h) => h.size(),
            Self::Compound(c) => c.size(),
        }
    }

    /// The balls whose hull is the shape: enough for flat ground.
    #[must_use]
    pub fn contact_spheres(&self) -> Vec<ContactSphere> {
        match self {
            Self::Ball(radius) => vec![ContactSphere { centre: DVec3::ZERO, radius: *radius }],
            Self::Cuboid(c) => {
                c.corners().into_iter().map(|centre| ContactSphere { centre, radius: c.rounding() }).collect()
            }
            Self::Revolution(r) => r.row().to_vec(),
            Self::Hull(h) => h.corners().iter().map(|&centre| ContactSphere { centre, radius: h.rounding() }).collect(),
            Self::Compound(c) => c.pieces.iter().flat_map(Piece::contact_spheres).collect(),
        }
    }

    /// More balls between those of [`contact_spheres`](Self::contact_spheres), so that no point of the skin is farther
    /// than about `spacing` from a ball: for uneven ground.
    #[must_use]
    pub fn contact_spheres_between(&self, spacing: f64) -> Vec<ContactSphere> {
        match self {
            Self::Ball(_) => Vec::new(),
            Self::Revolution(r) => r.contact_spheres_between(spacing),
            Self::Compound(c) => c.pieces.iter().flat_map(|p| p.contact_spheres_between(spacing)).collect(),
            Self::Cuboid(c) => {
                c.between(spacing).into_iter().map(|centre| ContactSphere { centre, radius: c.rounding() }).collect()
            }
            Self::Hull(h) => h
                .core
                .between(spacing)
                .into_iter()
                .map(|centre| ContactSphere { centre, radius: h.rounding() })
                .collect(),
        }
    }

    /// The same shape about another of its points, along the same axes: for a driven body, whose keys then say where
    /// that point is, so that it turns about it. All that is said about a centre of gravity then holds for that point,
    /// but the mass properties. A world refuses such a body where nothing drives it.
    ///
    /// # Errors
    /// [`WorldError::BadNumber`] for a point that is not finite, or one beside the axis of a body of revolution.
    pub fn about(&self, point: DVec3) -> Result<Self, WorldError> {
        if let Some(value) = point.to_array().into_iter().find(|x| !x.is_finite()) {
            return Err(WorldError::BadNumber { field: "origin of a shape", value, expected: "finite numbers" });
        }
        if point == DVec3::ZERO {
            return Ok(self.clone());
        }
        let solid = match self {
            Self::Ball(radius) => Convex::Ball(*radius),
            Self::Cuboid(cuboid) => Convex::Cuboid(*cuboid),
            Self::Hull(hull) => Convex::Hull(Arc::clone(hull)),
            Self::Compound(compound) => return Ok(compound.about(point).into()),
            Self::Revolution(body) => return Ok(Self::Revolution(Arc::new(body.about(point)?))),
        };
        Ok(Compound::of(solid).about(point).into())
    }

    /// Whether it is about another point than its centre of gravity.
    pub(crate) fn is_off_centre(&self) -> bool {
        match self {
            Self::Revolution(body) => body.is_off_centre(),
            Self::Compound(compound) => compound.is_off_centre(),
            Self::Ball(_) | Self::Cuboid(_) | Self::Hull(_) => false,
        }
    }

    /// Mass, and moments of inertia about the centre of gravity along the body's axes, for a uniform density in kg/m³.
    #[must_use]
    pub fn mass_properties(&self, density: f64) -> MassProperties {
        match self {
            Self::Ball(radius) => MassProperties::ball(*radius, density),
            Self::Cuboid(c) => c.mass_properties(density),
            Self::Revolution(r) => r.mass_properties(density),
            Self::Hull(h) => h.mass_properties(density),
            Self::Compound(c) => c.mass_properties(density),
        }
    }

    /// The convex pieces that make up the body. For a body of revolution, they are the balls on its axis and the discs
    /// within its rings.
    pub(crate) fn pieces(&self) -> Vec<Piece> {
        match self {
            Self::Ball(radius) => vec![Piece::ball(*radius, DVec3::ZERO)],
            Self::Cuboid(c) => vec![Convex::Cuboid(*c).piece(DVec3::ZERO, DMat3::IDENTITY)],
            Self::Hull(h) => vec![Convex::Hull(h.clone()).piece(DVec3::ZERO, DMat3::IDENTITY)],
            Self::Revolution(r) => {
                let balls = r.row().iter().map(|f| Piece::ball(f.radius, f.centre));
                let discs = r.rings().iter().map(|ring| {
                    let core = Core::Discs(frustum::Discs::new([0.0; 2], [ring.circle; 2]));
                    Piece::new(core, ring.radius, DVec3::new(0.0, 0.0, ring.height), DMat3::IDENTITY)
                });
                balls.chain(discs).collect()
            }
            Self::Compound(c) => c.pieces.clone(),
        }
    }
}
