//! Bodies of one or several convex solids, each with a pose: cylinders, cones, capsules, dumbbells, mugs, unbalanced
//! balls.

use super::frustum::Frustum;
use super::hull::{outer, principal};
use super::piece::{Core, Piece};
use super::{ConvexHull, Cuboid, MassProperties, Polyhedron, Shape};
use crate::error::WorldError;
use glam::{DMat3, DQuat, DVec3};
use std::sync::Arc;

/// A convex solid about its own origin.
#[derive(Debug, Clone, PartialEq)]
pub enum Convex {
    /// A ball of this radius in m.
    Ball(f64),
    /// A cuboid.
    Cuboid(Cuboid),
    /// A cylinder, cone, capsule or frustum.
    Frustum(Frustum),
    /// A convex polyhedron.
    Hull(Arc<ConvexHull>),
}

/// A solid within a compound.
#[derive(Debug, Clone, PartialEq)]
pub struct Member {
    /// The solid.
    pub solid: Convex,
    /// Where its origin is, in m.
    pub at: DVec3,
    /// Turns its axes into those of the compound.
    pub turn: DQuat,
    /// Its density over that of the compound. Default 1.
    pub density: f64,
}

impl Member {
    /// A solid at a place, upright.
    #[must_use]
    pub fn new(solid: Convex, at: DVec3) -> Self {
        Self { solid, at, turn: DQuat::IDENTITY, density: 1.0 }
    }
}

/// One or several convex solids that form one body, about its centre of gravity and along its principal axes.
///
/// The solids may be given along any axes about any origin. [`centre`](Self::centre) and [`turn`](Self::turn) tell
/// where the body is among them: a point `p` of theirs is at `turn⁻¹ (p − centre)` of the body. Where solids overlap,
/// their masses add up.
///
/// ```
/// use glam::DVec3;
/// use plaus_sim::shape::{Compound, Convex, Frustum, Member, Shape};
///
/// let coin = Shape::from(Frustum::cylinder(0.012, 0.002)?);
/// assert!((coin.mass_properties(8000.0).mass - 8000.0 * 0.002 * 0.012 * 0.012 * std::f64::consts::PI).abs() < 1e-12);
/// let head = Convex::Frustum(Frustum::cylinder(0.02, 0.06)?);
/// let hammer = Compound::new(&[
///     Member { density: 8.0, ..Member::new(head, DVec3::ZERO) },
///     Member::new(Convex::Frustum(Frustum::cylinder(0.01, 0.3)?), DVec3::new(0.0, 0.0, 0.18)),
/// ])?;
/// assert!(hammer.centre().z < 0.06);
/// # Ok::<(), plaus_sim::WorldError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Compound {
    pub(crate) pieces: Vec<Piece>,
    /// Of unit density.
    volume: f64,
    moments: DVec3,
    centre: DVec3,
    turn: DQuat,
    bounding_radius: f64,
    size: f64,
    is_round: bool,
    is_off_centre: bool,
    members: Vec<Member>,
}

/// Maximum number of solids of one compound: names of points of contact count them.
const MOST_MEMBERS: usize = 256;

/// Range of a solid's density over the compound's: 1e-6 to 1e6.
const DENSITIES: [f64; 2] = [1e-6, 1e6];

impl Compound {
    /// Puts solids together.
    ///
    /// # Errors
    /// [`WorldError::BadMember`] with the index of a solid whose numbers are not finite or are out of range,
    /// [`WorldError::BadNumber`] for no solids or more than 256.
    pub fn new(members: &[Member]) -> Result<Self, WorldError> {
        if members.is_empty() || members.len() > MOST_MEMBERS {
            let expected = "from 1 to 256";
            return Err(WorldError::BadNumber { field: "solids of a compound", value: members.len() as f64, expected });
        }
        let (mut mass, mut first, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
        for (member, m) in members.iter().enumerate() {
            m.check().map_err(|(field, value, expected)| WorldError::BadMember { member, field, value, expected })?;
            let own = m.solid.mass_properties(m.density);
            let axes = DMat3::from_quat(m.turn.normalize());
            let at = m.at + axes * m.solid.balance();
            let tensor = axes * DMat3::from_diagonal(own.inertia) * axes.transpose();
            let trace = own.inertia.element_sum();
            mass += own.mass;
            first += at * own.mass;
            // The second moments `∫ x xᵀ`, from the inertia.
            second += DMat3::from_diagonal(DVec3::splat(0.5 * trace)) - tensor + outer(at, at) * own.mass;
        }
        let centre = first / mass;
        let about = second - outer(centre, centre) * mass;
        let trace = about.x_axis.x + about.y_axis.y + about.z_axis.z;
        let (moments, axes) = principal(DMat3::from_diagonal(DVec3::splat(trace)) - about);
        let back = axes.transpose();
        let pieces: Vec<Piece> = members
            .iter()
            .map(|m| m.solid.piece(back * (m.at - centre), back * DMat3::from_quat(m.turn.normalize())))
            .collect();
        let bounding_radius = pieces.iter().map(Piece::reach_from_body).fold(0.0, f64::max);
        let size = members.iter().map(|m| m.solid.size()).fold(f64::INFINITY, f64::min);
        let is_round = matches!(members, [Member { solid: Convex::Frustum(_) | Convex::Ball(_), .. }]);
        let turn = DQuat::from_mat3(&axes).normalize();
        let (is_off_centre, members) = (false, members.to_vec());
        Ok(Self {
            pieces,
            volume: mass,
            moments,
            centre,
            turn,
            bounding_radius,
            size,
            is_round,
            is_off_centre,
            members,
        })
    }

    /// A body of only this solid, about its centre of gravity and along its own axes.
    pub(super) fn of(solid: Convex) -> Self {
        let balance = solid.balance();
        let MassProperties { mass, inertia } = solid.mass_properties(1.0);
        let piece = solid.piece(-balance, DMat3::IDENTITY);
        Self {
            volume: mass,
            moments: inertia,
            centre: balance,
            turn: DQuat::IDENTITY,
            bounding_radius: piece.reach_from_body(),
            size: solid.size(),
            is_round: matches!(solid, Convex::Frustum(_) | Convex::Ball(_)),
            is_off_centre: false,
            members: vec![Member::new(solid, DVec3::ZERO)],
            pieces: vec![piece],
        }
    }

    /// The same about another of its points.
    pub(super) fn about(&self, point: DVec3) -> Self {
        let pieces: Vec<Piece> = self.pieces.iter().map(|p| Piece { at: p.at - point, ..p.clone() }).collect();
        let bounding_radius = pieces.iter().map(Piece::reach_from_body).fold(0.0, f64::max);
        Self { pieces, bounding_radius, centre: self.centre + self.turn * point, is_off_centre: true, ..self.clone() }
    }

    /// A ball whose centre of gravity is `offset` m below its middle (at `−offset` along z as seen from the middle),
    /// with the moments of inertia that a uniform ball has about its middle: a tumbler toy, a bowl on a green.
    ///
    /// # Errors
    /// [`WorldError::BadNumber`] for a radius that is not positive or an offset of more than half of it.
    pub fn weighted_ball(radius: f64, offset: f64) -> Result<Self, WorldError> {
        let ball = Self::new(&[Member::new(Convex::Ball(radius), DVec3::ZERO)])?;
        if !(offset >= 0.0 && offset <= 0.5 * radius) {
            let expected = "from 0 to half the radius";
            return Err(WorldError::BadNumber { field: "offset of the centre of gravity", value: offset, expected });
        }
        let (shift, moments) = (ball.volume * offset * offset, ball.moments);
        ball.weighted(DVec3::NEG_Z * offset, DQuat::IDENTITY, moments - DVec3::new(shift, shift, 0.0))
    }

    /// The same solids with their mass elsewhere: about the centre of gravity `centre`, along principal axes that
    /// `turn` turns into those of the given solids, with these moments of inertia about them where the density is 1.
    /// What is wrong with moments, a world says that has such a body.
    ///
    /// # Errors
    /// [`WorldError::BadNumber`] for a place that is not finite or a turn that is none.
    pub fn weighted(self, centre: DVec3, turn: DQuat, moments: DVec3) -> Result<Self, WorldError> {
        if !(centre.is_finite() && turn.length() > 0.0 && turn.is_finite()) {
            let (field, expected) = ("centre of gravity", "a place, and axes that are turned");
            return Err(WorldError::BadNumber { field, value: centre.length(), expected });
        }
        let turn = turn.normalize();
        let back = DMat3::from_quat(turn).transpose();
        let piece = |m: &Member| m.solid.piece(back * (m.at - centre), back * DMat3::from_quat(m.turn.normalize()));
        let pieces: Vec<Piece> = self.members.iter().map(piece).collect();
        let bounding_radius = pieces.iter().map(Piece::reach_from_body).fold(0.0, f64::max);
        Ok(Self { pieces, moments, centre, turn, bounding_radius, ..self })
    }

    /// The solids as they were given.
    #[must_use]
    pub fn members(&self) -> &[Member] {
        &self.members
    }

    /// The centre of gravity, or what the shape is [about](Shape::about) instead, along the axes and about the origin
    /// of the given solids.
    #[must_use]
    pub fn centre(&self) -> DVec3 {
        self.centre
    }

    /// Turns the body's axes into those of the given solids.
    #[must_use]
    pub fn turn(&self) -> DQuat {
        self.turn
    }

    /// Mass and inertia, if solids with density 1 have this density in kg/m³.
    #[must_use]
    pub fn mass_properties(&self, density: f64) -> MassProperties {
        MassProperties { mass: density * self.volume, inertia: self.moments * density }
    }

    pub(crate) fn reach(&self) -> f64 {
        self.bounding_radius
    }

    pub(crate) fn size(&self) -> f64 {
        self.size
    }

    pub(super) fn is_off_centre(&self) -> bool {
        self.is_off_centre
    }

    /// Whether it can roll on one line of its skin.
    pub(crate) fn is_round(&self) -> bool {
        self.is_round
    }
}

impl Member {
    fn check(&self) -> Result<(), (&'static str, f64, &'static str)> {
        let number =
            |field, value: f64| if value.is_finite() { Ok(()) } else { Err((field, value, "a finite number")) };
        for value in self.at.to_array() {
            number("place", value)?;
        }
        for value in self.turn.to_array() {
            number("turn", value)?;
        }
        if self.turn.length() == 0.0 {
            return Err(("turn", 0.0, "a quaternion that is not zero"));
        }
        if !(self.density >= DENSITIES[0] && self.density <= DENSITIES[1]) {
            return Err(("density", self.density, "from 1e-6 to 1e6 of the compound's"));
        }
        match self.solid {
            Convex::Ball(r) if !(r > 0.0 && r.is_finite()) => Err(("radius", r, "a positive length")),
            _ => Ok(()),
        }
    }
}

impl Convex {
    /// Mass and inertia about the centre of gravity, along the solid's axes.
    #[must_use]
    pub fn mass_properties(&self, density: f64) -> MassProperties {
        match self {
            Self::Ball(radius) => MassProperties::ball(*radius, density),
            Self::Cuboid(c) => c.mass_properties(density),
            Self::Frustum(f) => f.mass_properties(density),
            Self::Hull(h) => h.mass_properties(density),
        }
    }

    /// The centre of gravity about the solid's origin.
    fn balance(&self) -> DVec3 {
        match self {
            Self::Frustum(f) => DVec3::new(0.0, 0.0, f.balance()),
            _ => DVec3::ZERO,
        }
    }

    fn size(&self) -> f64 {
        match self {
            Self::Ball(radius) => *radius,
            Self::Cuboid(c) => c.half().min_element(),
            Self::Frustum(f) => f.size(),
            Self::Hull(h) => h.size(),
        }
    }

    pub(crate) fn piece(&self, at: DVec3, turn: DMat3) -> Piece {
        match self {
            Self::Ball(radius) => Piece::ball(*radius, at),
            Self::Cuboid(c) => {
                let core = Arc::new(Polyhedron::cuboid(c.half() - c.rounding()));
                Piece::new(Core::Polyhedron(core), c.rounding(), at, turn)
            }
            Self::Frustum(f) => Piece::new(Core::Discs(f.core), f.rounding(), at, turn),
            Self::Hull(h) => Piece::new(Core::Polyhedron(Arc::new(h.core.clone())), h.rounding(), at, turn),
        }
    }
}

impl From<Frustum> for Shape {
    /// A body of only this solid, about its centre of gravity and along its own axes.
    fn from(frustum: Frustum) -> Self {
        Compound::of(Convex::Frustum(frustum)).into()
    }
}

impl From<Compound> for Shape {
    fn from(compound: Compound) -> Self {
        Self::Compound(Arc::new(compound))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box cut in three, turned and moved, is still the box.
    #[test]
    fn a_box_in_parts_is_the_box() {
        let edges = DVec3::new(0.3, 0.2, 0.1);
        let whole = Cuboid::new(edges, 0.0).unwrap().mass_properties(700.0);
        let turn = DQuat::from_xyzw(0.1, 0.7, -0.2, 0.4).normalize();
        let place = DVec3::new(1.0, -2.0, 0.5);
        let part = |from: f64, to: f64| {
            let cuboid = Cuboid::new(DVec3::new(to - from, edges.y, edges.z), 0.0).unwrap();
            let at = place + turn * DVec3::new(0.5 * (from + to) - 0.15, 0.0, 0.0);
            Member { solid: Convex::Cuboid(cuboid), at, turn, density: 1.0 }
        };
        let parts = Compound::new(&[part(0.0, 0.05), part(0.05, 0.2), part(0.2, 0.3)]).unwrap();
        let mass = parts.mass_properties(700.0);
        assert!((mass.mass / whole.mass - 1.0).abs() < 1e-14);
        let sorted = |v: DVec3| {
            let mut v = v.to_array();
            v.sort_by(f64::total_cmp);
            DVec3::from_array(v)
        };
        assert!((sorted(mass.inertia) - sorted(whole.inertia)).length() < 1e-12 * whole.inertia.length());
        assert!((parts.centre() - place).length() < 1e-14);
        let corner = (edges * 0.5).length();
        assert!((parts.reach() / corner - 1.0).abs() < 1e-14);
    }

    #[test]
    fn bad_members_are_named() {
        let good = Member::new(Convex::Ball(0.1), DVec3::ZERO);
        let bad = Member { at: DVec3::new(0.0, f64::NAN, 0.0), ..good.clone() };
        let error = Compound::new(&[good.clone(), bad]).unwrap_err();
        assert!(matches!(error, WorldError::BadMember { member: 1, field: "place", .. }), "{error}");
        assert!(Compound::new(&[]).is_err());
        assert!(Compound::new(&[Member { density: 0.0, ..good.clone() }]).is_err());
        assert!(Compound::new(&[Member { solid: Convex::Ball(-1.0), ..good }]).is_err());
        assert!(Compound::weighted_ball(0.1, 0.06).is_err());
    }

    #[test]
    fn a_weighted_ball_keeps_its_moment_about_the_middle() {
        let body = Compound::weighted_ball(0.1, 0.03).unwrap();
        let m = body.mass_properties(1000.0);
        let ball = MassProperties::ball(0.1, 1000.0);
        assert!((m.inertia.x + m.mass * 0.03 * 0.03 - ball.inertia.x).abs() < 1e-15);
        assert!((body.pieces[0].at.z - 0.03).abs() < 1e-18 && m.mass == ball.mass);
    }
}
