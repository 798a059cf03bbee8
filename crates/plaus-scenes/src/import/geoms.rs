//! Shapes of a model as a scenario has them.

use super::numbers::{joined, named, number, shortest};
use super::things::{HOLLOW, Shape};
use crate::custom::{corners, ellipsoid, hull_volume};
use glam::{DQuat, DVec3};
use plaus_asset::model::{Corners, Geom, Mesh, Model, Solid};
use plaus_asset::{AssetError, Format};
use std::f64::consts::PI;

/// A shape of a body.
#[derive(Debug, Clone)]
pub(super) struct Shaped {
    pub(super) name: Option<String>,
    pub(super) shape: Shape,
    /// Where it is in the world, in m.
    pub(super) at: DVec3,
    pub(super) turn: DQuat,
    /// In kg/m³.
    pub(super) density: f64,
    pub(super) friction: Option<f64>,
    pub(super) colour: Option<[u8; 3]>,
    collides: bool,
    /// In kg.
    mass: f64,
    /// How far it reaches from its place, in m; infinite for a plane.
    pub(super) reach: f64,
}

impl Shaped {
    /// A ball that stands for a body without a shape.
    pub(super) fn ball(radius: f64, at: DVec3) -> Self {
        let (said, volume) = ball(radius);
        Self {
            name: None,
            shape: Shape::Solid { said, volume },
            at,
            turn: DQuat::IDENTITY,
            density: 1.0,
            friction: None,
            colour: None,
            collides: true,
            mass: 0.0,
            reach: radius,
        }
    }
}

/// The shapes of all bodies.
#[derive(Debug)]
pub(super) struct Geoms<'a> {
    model: &'a Model,
    /// Of each body.
    all: Vec<Vec<Shaped>>,
    left_out: Vec<String>,
}

/// A mesh as a scenario has it: its shape, what it reaches, and the pose of its own axes in those of its geom.
struct Meshed {
    shape: Shape,
    reach: f64,
    at: DVec3,
    turn: DQuat,
}

/// Reads a file by its path from the model's folder.
type Open<'a> = &'a dyn Fn(&str) -> Result<Vec<u8>, String>;

impl<'a> Geoms<'a> {
    /// All shapes; `open` reads the files of meshes, from `folder` as scenarios name it.
    pub(super) fn new(model: &'a Model, folder: &str, anywhere: bool, open: Open<'_>) -> Result<Self, AssetError> {
        let mut geoms = Self { model, all: Vec::new(), left_out: Vec::new() };
        let mut meshes = Vec::new();
        for (index, mesh) in model.meshes.iter().enumerate() {
            let is_used = model.bodies.iter().flat_map(|body| &body.geoms).any(|geom| geom.solid == Solid::Mesh(index));
            meshes.push(if is_used { geoms.mesh(mesh, folder, anywhere, open)? } else { None });
        }
        for body in &model.bodies {
            let mut own = Vec::new();
            for geom in &body.geoms {
                let name = geom.name.as_ref().unwrap_or(&body.name);
                geoms.left_out.extend(geom.left_out.iter().map(|what| format!("{name}: {what}")));
                own.extend(geoms.shaped(geom, name, &meshes));
            }
            geoms.all.push(own);
        }
        Ok(geoms)
    }

    /// The shapes of a body that can touch something.
    pub(super) fn of(&self, body: usize) -> impl Iterator<Item = &Shaped> {
        self.all[body].iter().filter(|shaped| shaped.collides)
    }

    /// Those that can touch nothing.
    pub(super) fn untouchable(&self, body: usize) -> impl Iterator<Item = &Shaped> {
        self.all[body].iter().filter(|shaped| !shaped.collides && shaped.reach.is_finite())
    }

    /// Whether a body with these parts can become a thing that moves.
    pub(super) fn has_shape(&self, parts: &[usize]) -> bool {
        let is_heavy = |part: usize| self.model.bodies[part].mass.is_some_and(|own| own.mass > 0.0);
        parts.iter().any(|&part| is_heavy(part) || self.all[part].iter().any(|one| one.reach.is_finite()))
    }

    /// The mass of a body without what belongs to it, in kg.
    pub(super) fn mass(&self, body: usize) -> f64 {
        let given = self.model.bodies[body].mass.map(|own| own.mass);
        given.unwrap_or_else(|| self.all[body].iter().map(|shaped| shaped.mass).sum())
    }

    /// What could not be taken over.
    pub(super) fn left_out(&self) -> Vec<String> {
        let mut left_out = self.left_out.clone();
        let names = self.model.bodies.iter().zip(&self.all);
        let hidden = names.filter(|(_, all)| all.iter().any(|one| !one.collides) && all.iter().any(|one| one.collides));
        let hidden: Vec<&str> = hidden.map(|(body, _)| body.name.as_str()).collect();
        if !hidden.is_empty() {
            left_out.push(format!("shapes that touch nothing, but for their mass, of {}", hidden.join(", ")));
        }
        left_out
    }

    /// The ends of all that has any, in mm.
    pub(super) fn ends(&self) -> Option<[DVec3; 2]> {
        let ends = self.all.iter().flatten().filter(|one| one.reach.is_finite());
        ends.map(|one| [one.at - one.reach, one.at + one.reach].map(|end| end * 1e3))
            .reduce(|[low, high], [down, up]| [low.min(down), high.max(up)])
    }

    fn shaped(&mut self, geom: &Geom, name: &str, meshes: &[Option<Meshed>]) -> Option<Shaped> {
        let (mut at, mut turn) = (geom.at, geom.turn);
        let (shape, reach) = match &geom.solid {
            Solid::Other(kind) => {
                self.left_out.push(format!("{name}: its shape, {kind}"));
                return None;
            }
            Solid::Mesh(index) => {
                let Some(mesh) = &meshes[*index] else {
                    self.left_out.push(format!("{name}: its mesh"));
                    return None;
                };
                (at, turn) = (geom.at + geom.turn * mesh.at, (geom.turn * mesh.turn).normalize());
                (mesh.shape.clone(), mesh.reach)
            }
            solid => self.solid(solid, name)?,
        };
        let Shape::Solid { volume, .. } = shape else { return None };
        let mass = geom.mass.unwrap_or(geom.density * volume);
        let density = if volume > 0.0 { mass / volume } else { 0.0 };
        let (name, friction, colour, collides) = (geom.name.clone(), geom.friction, geom.colour, geom.collides);
        Some(Shaped { name, shape, at, turn, density, friction, colour, collides, mass, reach })
    }

    /// A solid as a scenario has it, and how far it reaches.
    fn solid(&mut self, solid: &Solid, name: &str) -> Option<(Shape, f64)> {
        let mm = |metres: f64| number(metres * 1e3);
        let ((said, volume), reach) = match *solid {
            Solid::Plane => (("plane = {}".to_owned(), 0.0), f64::INFINITY),
            Solid::Ball(radius) => (ball(radius), radius),
            Solid::Ellipsoid(half) if half.min_element() == half.max_element() => (ball(half.x), half.x),
            Solid::Box(half) => {
                let edges = (2.0 * half).to_array().map(mm).join(", ");
                ((format!("box = {{ size_mm = [{edges}] }}"), 8.0 * half.element_product()), half.length())
            }
            Solid::Cylinder(radius, half) => {
                let said = format!("cylinder = {{ radius_mm = {}, height_mm = {} }}", mm(radius), mm(2.0 * half));
                ((said, 2.0 * PI * radius * radius * half), radius + half)
            }
            Solid::Capsule(radius, half) => {
                let said = format!("capsule = {{ radius_mm = {}, length_mm = {} }}", mm(radius), mm(2.0 * half));
                ((said, PI * radius * radius * (2.0 * half + 4.0 / 3.0 * radius)), radius + half)
            }
            Solid::Ellipsoid(half) => {
                let (said, replaced) = egg(half);
                self.left_out.push(format!("{name}: {replaced}"));
                ((said, 4.0 / 3.0 * PI * half.element_product()), half.max_element())
            }
            Solid::Mesh(_) | Solid::Other(_) => return None,
        };
        Some((Shape::Solid { said, volume }, reach))
    }

    /// A mesh: a file by its path where its scale allows, or else its corners.
    fn mesh(
        &mut self,
        mesh: &Mesh,
        folder: &str,
        anywhere: bool,
        open: Open<'_>,
    ) -> Result<Option<Meshed>, AssetError> {
        let wrong = |file: &str, why: &dyn std::fmt::Display| AssetError::Broken(format!("{file}: {why}"));
        // The volume that its triangles enclose, in its own unit.
        let mut enclosed = f64::INFINITY;
        let (file, all) = match &mesh.from {
            Corners::Unread => {
                self.left_out.push(format!("mesh {:?}: it gives neither a file nor corners", mesh.name));
                return Ok(None);
            }
            Corners::Said(corners) => (None, corners.clone()),
            Corners::File(file) if !matches!(Format::of(file), Ok(Format::Obj | Format::Stl)) => {
                self.left_out.push(format!("mesh {:?}: {file} is not an OBJ or STL file", mesh.name));
                return Ok(None);
            }
            Corners::File(file) => {
                let bytes = open(file).map_err(|why| wrong(file, &why))?;
                match plaus_asset::read(file, &bytes) {
                    Ok(content) => {
                        let whole = content.whole();
                        enclosed = whole.volume().abs();
                        (Some(file), whole.corners)
                    }
                    // Corners alone are enough for a hull.
                    Err(AssetError::Empty) if Format::of(file) == Ok(Format::Obj) => {
                        (None, plaus_asset::obj_corners(&bytes))
                    }
                    Err(error) => return Err(wrong(file, &error)),
                }
            }
        };
        let placed: Vec<DVec3> = all.iter().map(|&corner| mesh.place(corner)).collect();
        let volume = match hull_volume(&placed) {
            Ok(volume) => volume,
            Err(error) => {
                self.left_out.push(format!("mesh {:?}: {error}", mesh.name));
                return Ok(None);
            }
        };
        let enclosed = enclosed * mesh.scale.element_product().abs();
        if !self.model.are_hulls && enclosed < (1.0 - HOLLOW) * volume {
            let [own, all] = [enclosed, volume].map(|of| number(shortest(1e6 * of, 1e3 * of)));
            let what = format!("its mesh encloses {own} cm³: its convex hull stands for it, of {all} cm³");
            self.left_out.push(format!("mesh {:?}: {what}", mesh.name));
        }
        let reach = placed.iter().map(|corner| corner.length()).fold(0.0, f64::max);
        let unit = mesh.scale.x;
        if let Some(file) = file.filter(|_| mesh.scale == DVec3::splat(unit) && unit > 0.0) {
            let file = named(&joined(folder, file), anywhere);
            let said = format!("hull_of = {{ file = {file}, unit_mm = {}, up = \"z\" }}", number(1e3 * unit));
            let (at, turn) = (mesh.place(DVec3::ZERO), mesh.turn.inverse());
            return Ok(Some(Meshed { shape: Shape::Solid { said, volume }, reach, at, turn }));
        }
        let Ok(kept) = corners(&placed) else { return Ok(None) };
        if kept.out > 0.0 {
            let out = number(1e3 * kept.out);
            let count = kept.points.len();
            self.left_out
                .push(format!("mesh {:?}: corners beyond {count}, which stand out by up to {out} mm", mesh.name));
        }
        let shape = Shape::Solid { said: hull(&kept.points), volume };
        Ok(Some(Meshed { shape, reach, at: DVec3::ZERO, turn: DQuat::IDENTITY }))
    }
}

fn ball(radius: f64) -> (String, f64) {
    (format!("ball = {{ radius_mm = {} }}", number(1e3 * radius)), 4.0 / 3.0 * PI * radius * radius * radius)
}

/// The hull of corners in m.
pub(super) fn hull(points: &[DVec3]) -> String {
    let reads_back = |fine: &f64| points.iter().flat_map(|p| p.to_array()).all(|at| at == 1e-3 * to(1e3 * at, *fine));
    let fine = FINE.into_iter().find(reads_back).unwrap_or(FINE[0]);
    let point = |point: &DVec3| {
        let numbers = (*point * 1e3).to_array().map(|at| format!("{}", to(at, fine) + 0.0));
        format!("[{}]", numbers.join(", "))
    };
    format!("hull = {{ points_mm = [{}] }}", points.iter().map(point).collect::<Vec<_>>().join(", "))
}

/// Parts of a millimetre that corners are written to: the first, unless they were rounded to a finer one.
pub(super) const FINE: [f64; 3] = [1e6, 1e8, 1e10];

/// A number in mm to parts of a millimetre.
pub(super) fn to(mm: f64, fine: f64) -> f64 {
    (mm * fine).round() / fine
}

/// An ellipsoid as a scenario has it, of half its axes in m, and what is told of that.
pub(super) fn egg(half: DVec3) -> (String, String) {
    let size = (2e3 * half).to_array().map(number).join(", ");
    let replaced = format!(
        "its ellipsoid, replaced by a hull of 42 corners with its volume, which stand out by up to {} mm",
        number(1e3 * ellipsoid::error(half))
    );
    (format!("ellipsoid = {{ size_mm = [{size}] }}"), replaced)
}
