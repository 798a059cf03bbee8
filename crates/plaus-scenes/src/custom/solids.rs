//! Shapes of a draw: for the simulator, and as they are drawn.

use super::die;
use super::drawn::profile;
use super::ellipsoid;
use super::forms::{self, Shape};
use super::from_file::{Loaded, opened};
use super::values::{Collector, Numbers, Owner, Value, Values, vector};
use crate::animation;
use crate::scene::ConfigError;
use crate::turns::by_angles;
use glam::{DQuat, DVec3};
use plaus_sim::WorldError;
use plaus_sim::shape::Shape as Solid;
use plaus_sim::shape::{Compound, Convex, ConvexHull, Cuboid, Frustum, MassProperties, Member, Profile, Revolution};
use std::sync::Arc;

/// Metres of a millimetre.
pub(super) const MM: f64 = 1e-3;
/// Distance of a centre of gravity from the origin, over the reach, that is rounding.
const ROUNDING: f64 = 1e-12;
/// Points of the drawn outline of a solid of revolution.
const OUTLINE: usize = 40;
/// Balls and rings that the simulator makes the skin of a solid of revolution of: between two of them it lies too deep
/// by a few hundredths of a millimetre for a bowling pin.
const STATIONS: usize = 40;

/// A shape with its numbers as values.
#[derive(Debug, Clone)]
pub(super) enum Form {
    Ball(Value),
    Box(Values, Value),
    Cylinder(Value, Value),
    Cone(Value, Value),
    Capsule(Value, Value),
    /// The lengths of its axes.
    Ellipsoid(Values),
    Hull(Vec<Values>, Value),
    /// Radius of the foot's flat, rounding of its rim, heights and radii, and the height of the top.
    Revolution([Value; 2], Vec<[Value; 2]>, Value),
    Compound(Vec<Piece>),
    /// The hull of what a file holds, and how many millimetres its unit is.
    HullOf(Arc<Loaded>, Value),
    /// A die: how many faces, its size, its rounding.
    Die(u32, Value, Value),
}

/// A piece of a compound.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    form: Form,
    at: Values,
    turn: Values,
    density: Value,
}

/// A shape of a draw.
#[derive(Debug, Clone)]
pub(super) struct Made {
    /// As the simulator has it, about its centre of gravity.
    pub(super) solid: Solid,
    /// Where that is, from the origin and along the axes that the scenario gives places in.
    pub(super) centre: DVec3,
    /// Turns the simulator's body axes into those.
    pub(super) axes: DQuat,
    /// As it is drawn: about the centre of gravity, along the scenario's axes.
    pub(super) drawn: Arc<animation::Shape>,
    /// Its moments of inertia where its density is 1, if they are not those of the solid.
    pub(super) moments: Option<DVec3>,
}

impl Form {
    /// The shape at the key `shape` of `owner`.
    pub(super) fn new(collector: &mut Collector, owner: &Owner<'_>, shape: &Shape) -> Result<Self, ConfigError> {
        Self::within(collector, owner, "shape", "", shape)
    }

    /// The same at the key `at` of `owner`; names of variables begin with `prefix`.
    fn within(
        collector: &mut Collector,
        owner: &Owner<'_>,
        at: &str,
        prefix: &str,
        shape: &Shape,
    ) -> Result<Self, ConfigError> {
        let key = |name: &str| format!("{at}.{}.{name}", shape.name());
        let short = |name: &str| format!("{prefix}{name}");
        Ok(match shape {
            Shape::Ball(ball) => {
                Self::Ball(collector.number(owner, &key("radius_mm"), &short("radius"), &ball.radius_mm)?)
            }
            Shape::Box(cuboid) => {
                let names = ["size_x", "size_y", "size_z"].map(short);
                let size = collector.three(owner, &key("size_mm"), words(&names), &cuboid.size_mm)?;
                Self::Box(size, collector.number(owner, &key("rounding_mm"), &short("rounding"), &cuboid.rounding_mm)?)
            }
            Shape::Cylinder(form) => Self::Cylinder(
                collector.number(owner, &key("radius_mm"), &short("radius"), &form.radius_mm)?,
                collector.number(owner, &key("height_mm"), &short("height"), &form.height_mm)?,
            ),
            Shape::Cone(form) => Self::Cone(
                collector.number(owner, &key("radius_mm"), &short("radius"), &form.radius_mm)?,
                collector.number(owner, &key("height_mm"), &short("height"), &form.height_mm)?,
            ),
            Shape::Capsule(form) => Self::Capsule(
                collector.number(owner, &key("radius_mm"), &short("radius"), &form.radius_mm)?,
                collector.number(owner, &key("length_mm"), &short("length"), &form.length_mm)?,
            ),
            Shape::Ellipsoid(form) => Self::Ellipsoid(ellipsoid::read(collector, owner, key, short, form)?),
            Shape::Hull(hull) => {
                let point = |(index, point)| {
                    let names = ["x", "y", "z"].map(|axis| short(&format!("point_{index}_{axis}")));
                    collector.three(owner, &key(&format!("points_mm[{index}]")), words(&names), point)
                };
                let points = hull.points_mm.iter().enumerate().map(point).collect::<Result<_, _>>()?;
                Self::Hull(points, collector.number(owner, &key("rounding_mm"), &short("rounding"), &hull.rounding_mm)?)
            }
            Shape::Revolution(form) => Self::revolution(collector, owner, [at, prefix], form)?,
            Shape::Compound(compound) => {
                let mut pieces = Vec::with_capacity(compound.pieces.len());
                for (index, piece) in compound.pieces.iter().enumerate() {
                    pieces.push(Piece::new(collector, owner, &key(&format!("pieces[{index}]")), index, piece)?);
                }
                Self::Compound(pieces)
            }
            Shape::HullOf(file) => {
                let (loaded, unit) = opened(collector, owner, &format!("{at}.hull_of"), prefix, file)?;
                Self::HullOf(loaded, unit)
            }
            Shape::Die(form) => {
                let (sides, size, rounding) = die::read(collector, owner, key, short, form)?;
                Self::Die(sides, size, rounding)
            }
        })
    }

    fn revolution(
        collector: &mut Collector,
        owner: &Owner<'_>,
        [at, prefix]: [&str; 2],
        form: &forms::Revolution,
    ) -> Result<Self, ConfigError> {
        let key = |name: &str| format!("{at}.revolution.{name}");
        let short = |name: &str| format!("{prefix}{name}");
        let foot = collector.number(owner, &key("foot_mm"), &short("foot"), &form.foot_mm)?;
        let rim = collector.number(owner, &key("rim_mm"), &short("rim"), &form.rim_mm)?;
        let mut outline = Vec::with_capacity(form.outline_mm.len());
        for (index, [height, radius]) in form.outline_mm.iter().enumerate() {
            let at = |k: u32| key(&format!("outline_mm[{index}][{k}]"));
            outline.push([
                collector.number(owner, &at(0), &short(&format!("height_{index}")), height)?,
                collector.number(owner, &at(1), &short(&format!("radius_{index}")), radius)?,
            ]);
        }
        let top = collector.number(owner, &key("top_mm"), &short("top"), &form.top_mm)?;
        Ok(Self::Revolution([foot, rim], outline, top))
    }

    /// Whether no draw changes it.
    pub(super) fn is_fixed(&self) -> bool {
        match self {
            Self::Ball(radius) => radius.is_fixed(),
            Self::Box(size, rounding) => size.iter().chain([rounding]).all(|value| value.is_fixed()),
            Self::Cylinder(a, b) | Self::Cone(a, b) | Self::Capsule(a, b) | Self::Die(_, a, b) => {
                a.is_fixed() && b.is_fixed()
            }
            Self::Ellipsoid(size) => size.iter().all(|value| value.is_fixed()),
            Self::Hull(points, rounding) => points.iter().flatten().chain([rounding]).all(|value| value.is_fixed()),
            Self::Revolution(foot, outline, top) => {
                foot.iter().chain(outline.iter().flatten()).chain([top]).all(|value| value.is_fixed())
            }
            Self::Compound(pieces) => pieces.iter().all(Piece::is_fixed),
            Self::HullOf(_, unit) => unit.is_fixed(),
        }
    }

    /// What is simulated otherwise than said or drawn, in words; `None` where that is nothing.
    pub(super) fn note(&self) -> Option<String> {
        match self {
            Self::HullOf(loaded, unit) => loaded.note(*unit),
            Self::Ellipsoid(size) => Some(ellipsoid::note(size)),
            Self::Compound(pieces) => {
                let notes: Vec<String> = pieces.iter().filter_map(|piece| piece.form.note()).collect();
                (!notes.is_empty()).then(|| notes.join("; "))
            }
            _ => None,
        }
    }

    /// Whether it may roll: it is round.
    pub(super) fn rolls(&self) -> bool {
        match self {
            Self::Ball(_) | Self::Cylinder(..) | Self::Cone(..) | Self::Capsule(..) => true,
            Self::Ellipsoid(_) | Self::Revolution(..) => true,
            Self::Box(..) | Self::Hull(..) | Self::Compound(_) | Self::HullOf(..) | Self::Die(..) => false,
        }
    }

    /// Whether its drawn triangles are all of its surface, and look the same way in every draw.
    pub(super) fn is_angular(&self) -> bool {
        match self {
            Self::Box(_, rounding) => *rounding == Value::Fixed(0.0),
            Self::Hull(_, rounding) => *rounding == Value::Fixed(0.0) && self.is_fixed(),
            _ => false,
        }
    }

    /// Whether edges of it are rounded, other than a capsule's.
    pub(super) fn is_rounded(&self, numbers: &Numbers<'_>) -> bool {
        match self {
            Self::Box(_, rounding) | Self::Hull(_, rounding) | Self::Die(.., rounding) => rounding.of(numbers) > 0.0,
            Self::Compound(pieces) => pieces.iter().any(|piece| piece.form.is_rounded(numbers)),
            _ => false,
        }
    }

    /// Edges of a box, and whether it is sharp.
    pub(super) fn sharp_box(&self, numbers: &Numbers<'_>) -> Option<DVec3> {
        match self {
            Self::Box(size, rounding) if rounding.of(numbers) == 0.0 => Some(vector(size, numbers) * MM),
            _ => None,
        }
    }

    /// The shape of a draw.
    pub(super) fn make(&self, numbers: &Numbers<'_>) -> Result<Made, WorldError> {
        let metres = |value: &Value| value.of(numbers) * MM;
        match self {
            Self::Ball(radius) => {
                let radius = metres(radius);
                Ok(Made::plain(Solid::Ball(radius), animation::Shape::ball(radius)))
            }
            Self::Box(size, rounding) => {
                let cuboid = Cuboid::new(vector(size, numbers) * MM, metres(rounding))?;
                let drawn = animation::Shape::Cuboid { half: cuboid.half(), pips: None };
                Ok(Made::plain(Solid::Cuboid(cuboid), drawn))
            }
            Self::Cylinder(radius, height) => Made::round(Frustum::cylinder(metres(radius), metres(height))?),
            Self::Cone(radius, height) => Made::round(Frustum::cone(metres(radius), metres(height))?),
            Self::Capsule(radius, length) => Made::round(Frustum::capsule(metres(radius), metres(length))?),
            Self::Ellipsoid(size) => {
                Made::hull(ConvexHull::new(&ellipsoid::corners(0.5 * MM * vector(size, numbers)), 0.0)?)
            }
            Self::Hull(points, rounding) => {
                let points: Vec<DVec3> = points.iter().map(|point| vector(point, numbers) * MM).collect();
                Made::hull(ConvexHull::new(&points, metres(rounding))?)
            }
            Self::Revolution([foot, rim], outline, top) => Made::revolution(&Profile {
                foot: metres(foot),
                rim: metres(rim),
                points: outline.iter().map(|[height, radius]| [metres(height), metres(radius)]).collect(),
                top: metres(top),
            }),
            Self::Compound(pieces) => Made::compound(pieces, numbers),
            Self::HullOf(loaded, unit) => Made::of_file(loaded, metres(unit)),
            Self::Die(sides, size, rounding) => Made::hull(die::hull(*sides, metres(size), metres(rounding))?),
        }
    }
}

impl Piece {
    fn new(
        collector: &mut Collector,
        owner: &Owner<'_>,
        key: &str,
        index: usize,
        piece: &forms::Piece,
    ) -> Result<Self, ConfigError> {
        let prefix = format!("piece_{}_", index + 1);
        let named = |names: [&str; 3]| names.map(|name| format!("{prefix}{name}"));
        let (at, turn) = (named(["x", "y", "z"]), named(["turn_x", "turn_y", "turn_z"]));
        let shape = piece.shape.clone().into();
        Ok(Self {
            form: Form::within(collector, owner, &format!("{key}.shape"), &prefix, &shape)?,
            at: collector.three(owner, &format!("{key}.at_mm"), words(&at), &piece.at_mm)?,
            turn: collector.three(owner, &format!("{key}.turn_deg"), words(&turn), &piece.turn_deg)?,
            density: collector.number(owner, &format!("{key}.density"), &format!("{prefix}density"), &piece.density)?,
        })
    }

    fn is_fixed(&self) -> bool {
        let numbers = self.at.iter().chain(&self.turn).chain([&self.density]);
        numbers.clone().all(|value| value.is_fixed()) && self.form.is_fixed()
    }
}

/// Borrows the three names.
fn words(names: &[String; 3]) -> [&str; 3] {
    [0, 1, 2].map(|k: usize| names[k].as_str())
}

impl Made {
    fn plain(solid: Solid, drawn: animation::Shape) -> Self {
        Self { solid, centre: DVec3::ZERO, axes: DQuat::IDENTITY, drawn: drawn.into(), moments: None }
    }

    /// Mass and inertia for a density in kg/m³.
    pub(super) fn mass_properties(&self, density: f64) -> MassProperties {
        let own = self.solid.mass_properties(density);
        MassProperties { inertia: self.moments.map_or(own.inertia, |moments| moments * density), ..own }
    }

    /// The origin of the scenario's places, from its centre of gravity.
    pub(super) fn origin(&self) -> DVec3 {
        if self.centre.length() <= ROUNDING * self.solid.reach() { DVec3::ZERO } else { -self.centre }
    }

    /// The same about the origin of the scenario's places, for a body that follows keys.
    pub(super) fn about_origin(self) -> Result<Self, WorldError> {
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

    fn round(frustum: Frustum) -> Result<Self, WorldError> {
        let compound = Compound::new(&[Member::new(Convex::Frustum(frustum), DVec3::ZERO)])?;
        let (centre, axes) = (compound.centre(), compound.turn());
        let profile = profile(&frustum).into_iter().map(|[r, height]| [r, height - centre.z]).collect();
        let drawn = animation::Shape::Revolution { profile, stripes: Vec::new() };
        Ok(Self { solid: compound.into(), centre, axes, drawn: drawn.into(), moments: None })
    }

    fn revolution(profile: &Profile) -> Result<Self, WorldError> {
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

    fn hull(hull: ConvexHull) -> Result<Self, WorldError> {
        let (centre, axes) = (hull.centre(), hull.turn());
        let vertices = hull.corners().iter().map(|&corner| axes * corner).collect();
        let fan = |face: &[u8]| -> Vec<[u32; 3]> {
            face.windows(2).skip(1).map(|pair| [face[0], pair[0], pair[1]].map(u32::from)).collect()
        };
        let triangles = hull.faces().flat_map(fan).collect();
        let drawn = animation::Shape::Solid { vertices, triangles };
        Ok(Self { solid: Solid::Hull(hull.into()), centre, axes, drawn: drawn.into(), moments: None })
    }

    /// The hull of what a file holds whose unit is so many metres; the file's own triangles are drawn.
    fn of_file(loaded: &Loaded, unit: f64) -> Result<Self, WorldError> {
        let points = loaded.corners.iter().flat_map(|corners| &corners.points);
        let points: Vec<DVec3> = points.map(|&point| point * unit).collect();
        let made = Self::hull(ConvexHull::new(&points, 0.0)?)?;
        let seen = &loaded.triangles;
        let vertices = seen.corners.iter().map(|&corner| corner * unit - made.centre).collect();
        let drawn = animation::Shape::Solid { vertices, triangles: seen.faces.clone() };
        Ok(Self { drawn: drawn.into(), ..made })
    }

    fn compound(pieces: &[Piece], numbers: &Numbers<'_>) -> Result<Self, WorldError> {
        let (mut members, mut vertices, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
        for piece in pieces {
            let made = piece.form.make(numbers)?;
            let at = vector(&piece.at, numbers) * MM;
            let turn = by_angles(piece.turn.map(|angle| angle.of(numbers)));
            let (corners, faces) = made.drawn.surface();
            let first = vertices.len() as u32;
            vertices.extend(corners.into_iter().map(|corner| at + turn * (corner + made.centre)));
            triangles.extend(faces.into_iter().map(|face| face.map(|corner| first + corner)));
            let density = piece.density.of(numbers);
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
    pub(super) fn members(&self) -> Vec<Member> {
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

#[cfg(test)]
mod tests;
