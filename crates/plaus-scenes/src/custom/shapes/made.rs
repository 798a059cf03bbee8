//! Shapes of a draw: for the simulator, and as they are drawn.

use super::{WorldError, animation};
use glam::{DQuat, DVec3};
use plaus_dist::math;
use plaus_sim::shape::Shape as Solid;
use plaus_sim::shape::{Compound, Convex, ConvexHull, Frustum, MassProperties, Member, Profile, Revolution};
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

/// Distance of a centre of gravity from the origin, over the reach, that is rounding.
const ROUNDING: f64 = 1e-12;
/// Points of the drawn outline of a solid of revolution, and of a drawn quarter circle.
const OUTLINE: usize = 40;
const ARC: usize = 8;
/// Balls and rings that the simulator makes the skin of a solid of revolution of: between two of them it lies too deep
/// by a few hundredths of a millimetre for a bowling pin.
const STATIONS: usize = 40;

/// A shape of a draw.
#[derive(Debug, Clone)]
pub(in crate::custom) struct Made {
    /// As the simulator has it, about its centre of gravity.
    pub(in crate::custom) solid: Solid,
    /// Where that is, from the origin and along the axes that the scenario gives places in.
    pub(in crate::custom) centre: DVec3,
    /// Turns the simulator's body axes into those.
    pub(in crate::custom) axes: DQuat,
    /// As it is drawn: about the centre of gravity, along the scenario's axes.
    pub(in crate::custom) drawn: Arc<animation::Shape>,
    /// Its moments of inertia where its density is 1, if they are not those of the solid.
    pub(in crate::custom) moments: Option<DVec3>,
}

impl Made {
    pub(super) fn plain(solid: Solid, drawn: animation::Shape) -> Self {
        Self { solid, centre: DVec3::ZERO, axes: DQuat::IDENTITY, drawn: drawn.into(), moments: None }
    }

    /// Mass and inertia for a density in kg/m³.
    pub(in crate::custom) fn mass_properties(&self, density: f64) -> MassProperties {
        let own = self.solid.mass_properties(density);
        MassProperties { inertia: self.moments.map_or(own.inertia, |moments| moments * density), ..own }
    }

    /// The origin of the scenario's places, from its centre of gravity.
    pub(in crate::custom) fn origin(&self) -> DVec3 {
        if self.centre.length() <= ROUNDING * self.solid.reach() { DVec3::ZERO } else { -self.centre }
    }

    /// The same about the origin of the scenario's places, for a body that follows keys.
    pub(in crate::custom) fn about_origin(self) -> Result<Self, WorldError> {
        if self.origin() == DVec3::ZERO {
            return Ok(self);
        }
        let mut drawn = self.drawn;
        match Arc::make_mut(&mut drawn) {
            animation::Shape::Revolution { profile, .. } => {
                profile.iter_mut().for_each(|[_, height]| *height += self.centre.z);
            }
            animation::Shape::Solid { vertices, .. } => {
                vertices.iter_mut().for_each(|vertex| *vertex += self.centre);
            }
            // Its middle is its centre of gravity.
            _ => {}
        }
        let solid = self.solid.about(self.axes.conjugate() * -self.centre)?;
        Ok(Self { solid, centre: DVec3::ZERO, drawn, ..self })
    }

    pub(super) fn round(frustum: Frustum) -> Result<Self, WorldError> {
        let compound = Compound::new(&[Member::new(Convex::Frustum(frustum), DVec3::ZERO)])?;
        let (centre, axes) = (compound.centre(), compound.turn());
        let profile = profile(&frustum).into_iter().map(|[r, height]| [r, height - centre.z]).collect();
        let drawn = animation::Shape::Revolution { profile, stripes: Vec::new() };
        Ok(Self { solid: compound.into(), centre, axes, drawn: drawn.into(), moments: None })
    }

    pub(super) fn revolution(profile: &Profile) -> Result<Self, WorldError> {
        let (revolution, outline) = (Revolution::new(profile, STATIONS)?, profile.outline(OUTLINE)?);
        let balance = revolution.balance();
        let profile = outline.into_iter().map(|[radius, height]| [radius, height - balance]).collect();
        Ok(Self {
            solid: Solid::Revolution(Arc::new(revolution)),
            centre: DVec3::new(0.0, 0.0, balance),
            axes: DQuat::IDENTITY,
            drawn: animation::Shape::Revolution { profile, stripes: Vec::new() }.into(),
            moments: None,
        })
    }

    pub(super) fn hull(hull: ConvexHull) -> Result<Self, WorldError> {
        let (centre, axes) = (hull.centre(), hull.turn());
        let vertices = hull.corners().iter().map(|&corner| axes * corner).collect();
        let fan = |face: &[u8]| -> Vec<[u32; 3]> {
            face.windows(2).skip(1).map(|pair| [face[0], pair[0], pair[1]].map(u32::from)).collect()
        };
        let triangles = hull.faces().flat_map(fan).collect();
        let drawn = animation::Shape::Solid { vertices, triangles };
        Ok(Self { solid: Solid::Hull(hull.into()), centre, axes, drawn: drawn.into(), moments: None })
    }

    /// Pieces joined into one, each where it is, how it is turned, and with its relative density.
    pub(super) fn joined(pieces: Vec<(Self, DVec3, DQuat, f64)>) -> Result<Self, WorldError> {
        let (mut members, mut vertices, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
        for (made, at, turn, density) in pieces {
            let (corners, faces) = made.drawn.surface();
            let first = vertices.len() as u32;
            vertices.extend(corners.into_iter().map(|corner| at + turn * (corner + made.centre)));
            triangles.extend(faces.into_iter().map(|face| face.map(|corner| first + corner)));
            members.extend(made.members().into_iter().map(|own| Member {
                at: at + turn * own.at,
                turn: (turn * own.turn).normalize(),
                density,
                ..own
            }));
        }
        let compound = Compound::new(&members)?;
        let (centre, axes) = (compound.centre(), compound.turn());
        vertices.iter_mut().for_each(|vertex| *vertex -= centre);
        let drawn = animation::Shape::Solid { vertices, triangles };
        Ok(Self { solid: compound.into(), centre, axes, drawn: drawn.into(), moments: None })
    }

    /// The convex solids that it is made of, about its origin and along its axes.
    pub(in crate::custom) fn members(&self) -> Vec<Member> {
        let solid = match &self.solid {
            Solid::Ball(radius) => Convex::Ball(*radius),
            Solid::Cuboid(cuboid) => Convex::Cuboid(*cuboid),
            Solid::Hull(hull) => Convex::Hull(Arc::clone(hull)),
            Solid::Compound(compound) => return compound.members().to_vec(),
            // No piece of a compound is one.
            Solid::Revolution(_) => return Vec::new(),
        };
        vec![Member { turn: self.axes, ..Member::new(solid, self.centre) }]
    }
}

/// The outline of a solid of revolution, from the lowest height to the highest: its rounding as arcs.
fn profile(frustum: &Frustum) -> Vec<[f64; 2]> {
    let [[low, wide], [high, narrow]] = frustum.discs();
    let rounding = frustum.rounding();
    if rounding == 0.0 {
        return vec![[0.0, low], [wide, low], [narrow, high], [0.0, high]];
    }
    let arc = |height: f64, radius: f64, from: f64| {
        (0..=ARC).map(move |k| {
            let (sin, cos) = math::sin_cos(from + FRAC_PI_2 * k as f64 / ARC as f64);
            [radius + rounding * cos.max(0.0), height + rounding * sin]
        })
    };
    arc(low, wide, -FRAC_PI_2).chain(arc(high, narrow, 0.0)).collect()
}
