//! Shapes as plain numbers: the simulator's shape, the judge's pieces and the text of a scenario are all made from
//! them.

use super::exact::{Core, Piece};
use crate::laws::worlds::Dice;
use glam::{DQuat, DVec2, DVec3};
use plaus_dist::math;
use plaus_sim::shape::{Compound, Convex, ConvexHull, Cuboid, Frustum, Member, Profile, Revolution, Shape};
use std::sync::Arc;

/// Balls in the skin of a solid of revolution, as in scenarios.
const STATIONS: usize = 40;

/// Points of a solid of revolution's outline that the judge sees.
const OUTLINE: usize = 48;

/// A kind of shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Ball,
    Cuboid,
    Rounded,
    Cylinder,
    Coin,
    Cone,
    Capsule,
    Frustum,
    Skittle,
    Rock,
    Prism,
    Hammer,
    Cross,
}

impl Kind {
    pub const ALL: [Self; 13] = [
        Self::Ball,
        Self::Cuboid,
        Self::Rounded,
        Self::Cylinder,
        Self::Coin,
        Self::Cone,
        Self::Capsule,
        Self::Frustum,
        Self::Skittle,
        Self::Rock,
        Self::Prism,
        Self::Hammer,
        Self::Cross,
    ];

    /// Those that stand on a flat face across their z axis.
    pub const STAND: [Self; 9] = [
        Self::Cuboid,
        Self::Rounded,
        Self::Cylinder,
        Self::Coin,
        Self::Cone,
        Self::Frustum,
        Self::Skittle,
        Self::Prism,
        Self::Cross,
    ];
}

/// A shape about its own origin, with lengths in m.
#[derive(Debug, Clone)]
pub enum Form {
    Ball(f64),
    Cuboid { edges: DVec3, rounding: f64 },
    Frustum { radii: [f64; 2], height: f64, rounding: f64 },
    Hull(Vec<DVec3>),
    Skittle(Profile),
    Compound(Vec<(Form, DVec3)>),
}

impl Form {
    /// A random shape of a kind, about `2 s` large.
    pub fn random(kind: Kind, s: f64, dice: &mut Dice) -> Self {
        let sides = DVec3::new(dice.between(0.3, 1.0), dice.between(0.3, 1.0), dice.between(0.3, 1.0)) * (2.0 * s);
        let [r, h] = [0.5 * sides.x, sides.z];
        match kind {
            Kind::Ball => Self::Ball(s),
            Kind::Cuboid => Self::Cuboid { edges: sides, rounding: 0.0 },
            Kind::Rounded => Self::Cuboid { edges: sides, rounding: sides.min_element() * dice.between(0.05, 0.3) },
            Kind::Cylinder => Self::Frustum { radii: [r; 2], height: h, rounding: 0.0 },
            Kind::Coin => Self::Frustum { radii: [s; 2], height: s * dice.between(0.1, 0.3), rounding: 0.0 },
            Kind::Cone => Self::Frustum { radii: [r, 0.0], height: h, rounding: 0.0 },
            Kind::Capsule => Self::Frustum { radii: [0.0; 2], height: h, rounding: 0.5 * r },
            Kind::Frustum => Self::Frustum { radii: [r, r * dice.between(0.3, 0.9)], height: h, rounding: 0.0 },
            Kind::Skittle => {
                let points = [[0.2, 1.05], [0.8, dice.between(0.5, 0.9)], [1.3, dice.between(0.3, 0.5)]];
                let points = points.map(|p| p.map(|x| x * r));
                let (foot, top) = (0.95 * r, points[2][0] + points[2][1]);
                Self::Skittle(Profile { foot, rim: 0.05 * r, points: points.to_vec(), top })
            }
            Kind::Rock => {
                // Points near an ellipsoid, so that all are corners.
                let point = |dice: &mut Dice| dice.in_cube().normalize() * dice.between(0.9, 1.0) * (0.5 * sides);
                let mut points: Vec<DVec3> = (0..8).map(|_| point(dice)).collect();
                points.extend([sides.with_y(0.0), -sides.with_x(0.0), DVec3::Y * sides.y].map(|p| 0.4 * p));
                Self::Hull(points)
            }
            Kind::Prism => Self::prism([3, 5, 6, 8][dice.of(&[0, 1, 2, 3])], r, h),
            Kind::Hammer => Self::Compound(vec![
                (Self::Frustum { radii: [0.3 * s; 2], height: 0.8 * s, rounding: 0.0 }, DVec3::ZERO),
                (Self::Cuboid { edges: DVec3::new(1.4, 0.25, 0.2) * s, rounding: 0.0 }, DVec3::X * (0.8 * s)),
            ]),
            Kind::Cross => Self::Compound(vec![
                (Self::Cuboid { edges: DVec3::new(2.0, 0.5, 0.4) * s, rounding: 0.0 }, DVec3::ZERO),
                (Self::Cuboid { edges: DVec3::new(0.5, 2.0, 0.4) * s, rounding: 0.0 }, DVec3::ZERO),
            ]),
        }
    }

    /// An upright prism over a regular polygon.
    pub fn prism(corners: u32, radius: f64, height: f64) -> Self {
        let corner = |k: u32, z: f64| {
            let (sin, cos) = math::sin_cos(std::f64::consts::TAU * f64::from(k) / f64::from(corners));
            DVec3::new(radius * cos, radius * sin, z)
        };
        let ends = [-0.5 * height, 0.5 * height];
        Self::Hull(ends.iter().flat_map(|&z| (0..corners).map(move |k| corner(k, z))).collect())
    }

    /// A box of eight corners.
    pub fn corners(edges: DVec3) -> Vec<DVec3> {
        let sign = |k: u32, bit: u32| if k >> bit & 1 == 0 { -0.5 } else { 0.5 };
        (0..8).map(|k| DVec3::new(sign(k, 0), sign(k, 1), sign(k, 2)) * edges).collect()
    }

    fn convex(&self) -> Option<Convex> {
        Some(match self {
            Self::Ball(r) => Convex::Ball(*r),
            Self::Cuboid { edges, rounding } => Convex::Cuboid(Cuboid::new(*edges, *rounding).expect("a cuboid")),
            Self::Frustum { radii, height, rounding } => {
                Convex::Frustum(Frustum::new(*radii, *height, *rounding).expect("a frustum"))
            }
            Self::Hull(points) => Convex::Hull(Arc::new(ConvexHull::new(points, 0.0).expect("a hull"))),
            Self::Skittle(_) | Self::Compound(_) => return None,
        })
    }

    /// The simulator's shape, and where its centre of gravity and axes are about the form's own origin.
    pub fn shape(&self) -> (Shape, DVec3, DQuat) {
        let own = |shape| (shape, DVec3::ZERO, DQuat::IDENTITY);
        match self {
            Self::Ball(r) => own(Shape::Ball(*r)),
            Self::Cuboid { edges, rounding } => own(Shape::Cuboid(Cuboid::new(*edges, *rounding).expect("a cuboid"))),
            Self::Frustum { radii, height, rounding } => {
                let shape = Shape::from(Frustum::new(*radii, *height, *rounding).expect("a frustum"));
                let Shape::Compound(made) = &shape else { return own(shape) };
                let (centre, turn) = (made.centre(), made.turn());
                (shape, centre, turn)
            }
            Self::Hull(points) => {
                let hull = ConvexHull::new(points, 0.0).expect("a hull");
                let (centre, turn) = (hull.centre(), hull.turn());
                (Shape::Hull(Arc::new(hull)), centre, turn)
            }
            Self::Skittle(profile) => {
                let made = Revolution::new(profile, STATIONS).expect("a solid of revolution");
                let centre = DVec3::Z * made.balance();
                (Shape::Revolution(Arc::new(made)), centre, DQuat::IDENTITY)
            }
            Self::Compound(pieces) => {
                let member = |(form, at): &(Self, DVec3)| Member::new(form.convex().expect("a convex piece"), *at);
                let made = Compound::new(&pieces.iter().map(member).collect::<Vec<_>>()).expect("a compound");
                let (centre, turn) = (made.centre(), made.turn());
                (Shape::from(made), centre, turn)
            }
        }
    }

    /// In a few words, with sizes in mm.
    pub fn told(&self) -> String {
        let mm = |x: f64| format!("{:.3}", 1e3 * x);
        match self {
            Self::Ball(r) => format!("ball r {}", mm(*r)),
            Self::Cuboid { edges: e, rounding: r } => {
                let rounded = if *r > 0.0 { format!(" rounded by {}", mm(*r)) } else { String::new() };
                format!("box {} x {} x {}{rounded}", mm(e.x), mm(e.y), mm(e.z))
            }
            Self::Frustum { radii: [a, b], height, rounding } => match (*a > 0.0, *b > 0.0) {
                (false, _) => format!("capsule r {} l {}", mm(*rounding), mm(*height)),
                (_, false) => format!("cone r {} h {}", mm(*a), mm(*height)),
                _ if a == b => format!("cylinder r {} h {}", mm(*a), mm(*height)),
                _ => format!("frustum r {}, {} h {}", mm(*a), mm(*b), mm(*height)),
            },
            Self::Hull(points) => {
                let far = points.iter().map(|p| p.length()).fold(0.0, f64::max);
                format!("hull of {} points, reach {}", points.len(), mm(far))
            }
            Self::Skittle(p) => format!("skittle foot {} h {}", mm(p.foot), mm(p.top)),
            Self::Compound(pieces) => {
                format!("({})", pieces.iter().map(|p| p.0.told()).collect::<Vec<_>>().join(" + "))
            }
        }
    }

    /// How far its skin in the simulator may lie inside the form, in m: that of a solid of revolution is made of balls
    /// and rings ([`Revolution::row`], [`Revolution::rings`]), which touch its outline from inside.
    pub fn rough(&self) -> f64 {
        let (Self::Skittle(profile), Shape::Revolution(made)) = (self, self.shape().0) else { return 0.0 };
        let low = made.balance();
        let balls = made.row().iter().map(|f| ([0.0, f.centre.z + low], f.radius));
        let round: Vec<_> = balls.chain(made.rings().iter().map(|r| ([r.circle, r.height + low], r.radius))).collect();
        let beyond = |p: DVec2| {
            let far = |(at, radius): &([f64; 2], f64)| (p - DVec2::from_array(*at)).length() - radius;
            round.iter().map(far).fold(f64::INFINITY, f64::min)
        };
        let outline = profile.outline(OUTLINE).expect("an outline");
        outline.iter().map(|&p| beyond(DVec2::from_array(p))).fold(0.0, f64::max)
    }

    /// How far the points of its rims that feel a table leave them out, in m: the sagitta of one in thirty-two
    /// (`RIM` in `shape/piece.rs`).
    pub fn rough_on_tables(&self) -> f64 {
        let radius = |form: &Self| match form {
            Self::Frustum { radii, .. } => radii[0].max(radii[1]),
            Self::Skittle(profile) => profile.points.iter().map(|p| p[1]).fold(profile.foot, f64::max),
            _ => 0.0,
        };
        let widest = match self {
            Self::Compound(pieces) => pieces.iter().map(|(form, _)| radius(form)).fold(0.0, f64::max),
            form => radius(form),
        };
        widest * (1.0 - math::cos(std::f64::consts::PI / 32.0))
    }

    /// Its lowest point over its own origin, if it is not turned.
    pub fn foot(&self) -> f64 {
        match self {
            Self::Ball(r) => -r,
            Self::Cuboid { edges, .. } => -0.5 * edges.z,
            Self::Frustum { height, rounding, .. } => -0.5 * height - rounding,
            Self::Hull(points) => points.iter().map(|p| p.z).fold(f64::INFINITY, f64::min),
            Self::Skittle(_) => 0.0,
            Self::Compound(pieces) => pieces.iter().map(|(f, at)| f.foot() + at.z).fold(f64::INFINITY, f64::min),
        }
    }

    /// Radius of a disc about the z axis that fits into the lower face.
    pub fn base(&self) -> f64 {
        match self {
            Self::Ball(_) => 0.0,
            Self::Cuboid { edges, rounding } => 0.5 * edges.x.min(edges.y) - rounding,
            Self::Frustum { radii, .. } => radii[0],
            Self::Hull(points) => {
                let low: Vec<DVec2> = points.iter().filter(|p| p.z <= self.foot()).map(|p| p.truncate()).collect();
                let n = low.len();
                // The corners of a prism are in order.
                (0..n).map(|k| (low[k] + low[(k + 1) % n]).length() * 0.5).fold(f64::INFINITY, f64::min)
            }
            Self::Skittle(profile) => profile.foot,
            Self::Compound(pieces) => pieces.iter().map(|(f, _)| f.base()).fold(f64::INFINITY, f64::min),
        }
    }

    /// The judge's convex pieces about the form's own origin.
    pub fn pieces(&self) -> Vec<Piece> {
        let piece = |core, rounding| vec![Piece::new(core, rounding)];
        match self {
            Self::Ball(r) => piece(Core::Point, *r),
            Self::Cuboid { edges, rounding } => piece(Core::Cuboid(0.5 * *edges - *rounding), *rounding),
            Self::Frustum { radii, height, rounding } => {
                let z = 0.5 * height;
                let all = [[0.0, -z], [radii[0], -z], [radii[1], z], [0.0, z]].map(DVec2::from);
                piece(Core::lathe(&all), *rounding)
            }
            Self::Hull(points) => piece(Core::planes(points), 0.0),
            Self::Skittle(profile) => Core::lathes(&profile.outline(OUTLINE).expect("an outline"))
                .into_iter()
                .map(|core| Piece::new(core, 0.0))
                .collect(),
            Self::Compound(pieces) => {
                let moved = |(form, at): &(Self, DVec3)| {
                    form.pieces().into_iter().map(|p| p.moved(*at, DQuat::IDENTITY)).collect::<Vec<_>>()
                };
                pieces.iter().flat_map(moved).collect()
            }
        }
    }
}
