//! Things of a file.

use super::contact::Contact;
use super::numbers::{number, plain_name, shortest};
use glam::{DQuat, DVec3};
use plaus_asset::{Content, Triangles, upright};
use plaus_sim::scenery::Mesh;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

/// Standard deviation of what is uncertain about places, in mm, so that there is something to sample; and smaller ones,
/// for things that lie close together.
const SPREAD: f64 = 5.0;
pub(super) const NARROWER: [f64; 3] = [1.0, 0.2, 0.04];

/// Densities that a scenario can have, in kg/m³.
const DENSITIES: [f64; 2] = [1e-3, 1e6];

/// If a mesh that moves encloses less of its hull by more than this share, that is told.
pub(super) const HOLLOW: f64 = 0.01;

/// Where the mass of a body is, along its own axes.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Inertia {
    /// Its centre of gravity from its origin, in m.
    pub(super) centre: Option<DVec3>,
    /// Principal moments in kg m², and the rotation of their axes.
    pub(super) moments: Option<(DVec3, DQuat)>,
}

/// What a thing does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    Fixed,
    Body,
    Driven,
    /// It is left out.
    Gone,
}

/// The shape of a thing, or of a piece of it.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Shape {
    /// The file's triangles; for things that move, their convex hull.
    File { object: Option<String> },
    /// The same, always as a convex hull.
    Hull { object: Option<String> },
    /// A solid as written in a scenario, with its volume in m³.
    Solid { said: String, volume: f64 },
    /// Pieces about the thing's origin.
    Pieces(Vec<Piece>),
}

impl Shape {
    /// Of pieces; of one that is where the thing is, that piece's own.
    pub(super) fn of_pieces(mut pieces: Vec<Piece>) -> Self {
        match &pieces[..] {
            [one] if one.at == DVec3::ZERO && one.turn.w.abs() > 1.0 - 1e-12 => pieces.remove(0).shape,
            _ => Self::Pieces(pieces),
        }
    }
}

/// A piece of a thing.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Piece {
    pub(super) shape: Shape,
    /// Where it is, in m.
    pub(super) at: DVec3,
    pub(super) turn: DQuat,
    /// Its density, relative to that of the thing.
    pub(super) density: f64,
}

/// What is uncertain about where a body starts.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) enum Sway {
    /// Its own place.
    #[default]
    Own,
    /// The place of all that has this name, as joints hold it together.
    With(String),
    /// Nothing: a joint holds it to what stands still.
    Nothing,
}

/// A joint of a thing.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Held {
    pub(super) name: String,
    /// The indices of the thing that it holds, and of what it holds it to, unless that stands still.
    pub(super) body: usize,
    pub(super) to: Option<usize>,
    /// Where it is, in mm.
    pub(super) at: DVec3,
    /// As a scenario has it.
    pub(super) kind: String,
}

/// Something in a file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Thing {
    pub(super) name: String,
    pub(super) role: Role,
    pub(super) shape: Shape,
    /// Where it is, in mm, z up, and how it is turned.
    pub(super) at: DVec3,
    pub(super) turn: DQuat,
    pub(super) colour: Option<[u8; 3]>,
    /// The name of its material in the file.
    pub(super) material: Option<String>,
    /// What is to be said of its shape.
    pub(super) remark: Option<String>,
    /// In kg, if the file gives it.
    pub(super) mass: Option<f64>,
    /// Where its mass is, if the file gives that.
    pub(super) inertia: Inertia,
    /// Friction and restitution, if the file gives them.
    pub(super) contact: Option<Contact>,
    /// Groups in which it passes through others.
    pub(super) no_contact: Vec<String>,
    /// Other keys, as lines of TOML.
    pub(super) lines: Vec<String>,
    /// How far it was moved out of others, in mm.
    pub(super) moved: DVec3,
    pub(super) sway: Sway,
    /// Whether it is scenery in the file, and here a driven body that stands still, or left out.
    pub(super) stands: bool,
    /// Whether it is cut into convex pieces if it is hollow.
    pub(super) cuts: bool,
}

impl Thing {
    pub(super) fn new(name: &str, role: Role, shape: Shape) -> Self {
        let (at, turn) = (DVec3::ZERO, DQuat::IDENTITY);
        let (colour, mass, contact) = (None, None, None);
        Self {
            name: name.into(),
            role,
            shape,
            at,
            turn,
            colour,
            material: None,
            remark: None,
            mass,
            inertia: Inertia::default(),
            contact,
            no_contact: Vec::new(),
            lines: Vec::new(),
            moved: DVec3::ZERO,
            sway: Sway::Own,
            stands: false,
            cuts: false,
        }
    }
}

/// How many meshes became which shape, and the one that is farthest off.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Count {
    pub(super) kinds: BTreeMap<&'static str, usize>,
    pub(super) farthest: Option<(f64, String)>,
}

/// All of a file.
#[derive(Debug, Clone)]
pub(super) struct Things<'a> {
    pub(super) all: Vec<Thing>,
    pub(super) joints: Vec<Held>,
    /// What could not be taken over although it changes motion, or may.
    pub(super) left_out: Vec<String>,
    /// What was not taken over, as it has no bearing on motion.
    pub(super) harmless: Vec<String>,
    /// Whether its file may say that things pass through each other.
    pub(super) passes: bool,
    /// What was assumed or changed.
    pub(super) notes: Vec<String>,
    /// Lines about the whole world.
    pub(super) world: Vec<String>,
    /// The file that shapes refer to by their objects' names, as a scenario names it.
    pub(super) file: String,
    pub(super) content: Option<&'a Content>,
    /// The volumes of hulls of objects that were asked for, in m³.
    hulls: RefCell<BTreeMap<Option<String>, Result<f64, String>>>,
    /// The length of its unit, in mm.
    unit: f64,
    /// Standard deviation of what is uncertain about places, in mm.
    pub(super) spread: f64,
    /// Whether what moves and is hollow is cut into pieces.
    pub(super) splits: bool,
    /// The height of a floor that the file does not have, in mm.
    pub(super) floor: Option<f64>,
    /// What meshes were recognised.
    pub(super) recognised: Count,
    /// The ends of all that has any, in mm.
    pub(super) ends: [DVec3; 2],
}

impl<'a> Things<'a> {
    /// Of a file of shapes, as a scenario names it, with a unit of this many mm.
    pub(super) fn of_shapes(file: String, content: &'a Content, unit: f64) -> Self {
        let ends = content.whole().upright(content.format.up()).ends().map(|end| unit * end);
        Self { file, content: Some(content), unit, ends, ..Self::empty() }
    }

    /// Nothing yet.
    pub(super) fn empty() -> Self {
        Self {
            all: Vec::new(),
            joints: Vec::new(),
            left_out: Vec::new(),
            harmless: Vec::new(),
            passes: false,
            notes: Vec::new(),
            world: Vec::new(),
            file: String::new(),
            content: None,
            hulls: RefCell::default(),
            unit: 1.0,
            spread: SPREAD,
            splits: false,
            floor: None,
            recognised: Count::default(),
            ends: [DVec3::splat(-100.0), DVec3::splat(100.0)],
        }
    }

    /// The bodies, in the order of the text.
    pub(super) fn bodies(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.all.len()).filter(|&index| self.all[index].role == Role::Body)
    }

    /// For each body, in the order of the text, those that move together, counted on; `None` if a joint holds it to
    /// what stands still.
    pub(super) fn groups(&self) -> Vec<Option<usize>> {
        let (mut count, mut named) = (0, BTreeMap::new());
        let mut next = || {
            count += 1;
            count - 1
        };
        let group = |index: usize| match &self.all[index].sway {
            Sway::Own => Some(next()),
            Sway::With(name) => Some(*named.entry(name).or_insert_with(&mut next)),
            Sway::Nothing => None,
        };
        self.bodies().map(group).collect()
    }

    /// Moves these bodies by what their groups are moved, in m, with their joints. Returns the names of those that
    /// moved, and how far one did at most, in mm.
    pub(super) fn shift(&mut self, bodies: &[usize], groups: &[Option<usize>], by: &[DVec3]) -> (Vec<String>, f64) {
        let mut names = Vec::new();
        let mut farthest: f64 = 0.0;
        for (&body, group) in bodies.iter().zip(groups) {
            let by = group.map_or(DVec3::ZERO, |group| by[group] * 1e3);
            if by == DVec3::ZERO {
                continue;
            }
            let thing = &mut self.all[body];
            (thing.at, thing.moved) = (thing.at + by, by);
            self.joints.iter_mut().filter(|held| held.body == body).for_each(|held| held.at += by);
            names.push(self.all[body].name.clone());
            farthest = farthest.max(by.length());
        }
        (names, farthest)
    }

    /// Makes bodies share what is uncertain about their places if they touch at their sides. It is nothing for those
    /// that touch what stands still.
    pub(super) fn join_sides(&mut self, sides: &[(usize, Option<usize>)]) {
        // Each body's first in its pile.
        let mut first: Vec<usize> = (0..self.all.len()).collect();
        let same = |a: &Sway, b: &Sway| matches!((a, b), (Sway::With(a), Sway::With(b)) if a == b);
        let bodies: Vec<usize> = self.bodies().collect();
        let held = bodies.iter().flat_map(|&a| bodies.iter().map(move |&b| (a, b)));
        let held: Vec<(usize, usize)> =
            held.filter(|&(a, b)| a < b && same(&self.all[a].sway, &self.all[b].sway)).collect();
        for (a, b) in sides.iter().filter_map(|&(a, b)| Some((a, b?))).chain(held) {
            let (low, high) = (first[a].min(first[b]), first[a].max(first[b]));
            first.iter_mut().filter(|first| **first == high).for_each(|first| *first = low);
        }
        let stands = |&(body, other): &(usize, Option<usize>)| {
            let is_still = |index: usize| self.all[index].sway == Sway::Nothing;
            let still = other.is_none_or(is_still) || is_still(body);
            still.then(|| [Some(first[body]), other.map(|other| first[other])])
        };
        let still: BTreeSet<usize> = sides.iter().filter_map(stands).flatten().flatten().collect();
        let mut piles = BTreeMap::new();
        bodies.iter().for_each(|&body| *piles.entry(first[body]).or_insert(0_usize) += 1);
        for body in bodies {
            if still.contains(&first[body]) {
                self.all[body].sway = Sway::Nothing;
            } else if piles[&first[body]] > 1 {
                self.all[body].sway = Sway::With(format!("pile_{}", first[body] + 1));
            }
        }
    }

    /// The triangles of an object, in mm, z up, about its own origin; of all objects if none is named.
    pub(super) fn triangles(&self, object: Option<&str>) -> Triangles {
        let Some(content) = self.content else { return Triangles::default() };
        let found = object.and_then(|name| content.object(name));
        let triangles = found.map_or_else(|| content.whole(), |object| object.triangles.clone());
        let up = content.format.up();
        triangles.moved(|corner| self.unit * upright(corner, up))
    }

    /// Replaces meshes by the solids that they are, hollow ones that move by convex pieces, and scenery by its hull if
    /// the simulator does not accept its triangles; leaves out things without a hull.
    pub(super) fn try_shapes(&mut self) {
        for index in 0..self.all.len() {
            let mut thing = self.all[index].clone();
            if let Err(why) = self.try_shape(&mut thing) {
                self.left_out.push(format!("{}: {why}", thing.name));
                thing.role = Role::Gone;
            }
            self.all[index] = thing;
        }
        self.tell_recognised();
        let is_gone = |thing: usize| self.all[thing].role == Role::Gone;
        let (gone, kept) = std::mem::take(&mut self.joints)
            .into_iter()
            .partition(|held| is_gone(held.body) || held.to.is_some_and(is_gone));
        self.joints = kept;
        let gone: Vec<Held> = gone;
        self.left_out.extend(gone.iter().map(|held| format!("{}: what it holds is left out", held.name)));
    }

    fn try_shape(&mut self, thing: &mut Thing) -> Result<(), String> {
        if thing.role != Role::Gone {
            self.recognise(thing);
        }
        if let (Role::Fixed, Shape::File { object }) = (thing.role, &thing.shape) {
            let triangles = self.triangles(object.as_deref());
            let faces: Vec<_> = triangles.faces.iter().map(|&face| (face, plaus_sim::Material(0))).collect();
            let Err(error) = Mesh::new(triangles.corners, &faces, 0.0) else { return Ok(()) };
            thing.shape = Shape::Hull { object: object.clone() };
            self.left_out.push(format!("{}: its triangles, replaced by their convex hull: {error}", thing.name));
        }
        let volume = self.volume(&thing.shape)?;
        if matches!(thing.role, Role::Body | Role::Driven) {
            let own = self.enclosed(&thing.shape).abs();
            if own < (1.0 - HOLLOW) * volume && !((self.splits || thing.cuts) && self.split(thing, own, volume)) {
                let (own, all) = (number(shortest(1e6 * own, 1e3 * own)), number(shortest(1e6 * volume, 1e3 * volume)));
                let text = format!("its mesh encloses {own} cm³: what moves is its convex hull, of {all} cm³");
                self.left_out.push(format!("{}: {text}", thing.name));
            }
        }
        Ok(())
    }

    /// The volume that a shape encloses, of meshes that of their triangles, in m³.
    pub(super) fn enclosed(&self, shape: &Shape) -> f64 {
        match shape {
            Shape::File { object } => 1e-9 * self.triangles(object.as_deref()).volume(),
            Shape::Pieces(pieces) => pieces.iter().map(|piece| piece.density * self.enclosed(&piece.shape).abs()).sum(),
            Shape::Hull { .. } | Shape::Solid { .. } => self.volume(shape).unwrap_or(0.0),
        }
    }

    /// The density that a thing's mass gives it, in kg/m³, as near as a scenario allows.
    pub(super) fn density(&self, thing: &Thing) -> Option<f64> {
        let [least, most] = DENSITIES;
        Some((thing.mass? / self.volume(&thing.shape).ok()?).clamp(least, most)).filter(|density| !density.is_nan())
    }

    /// Tells which masses a scenario cannot have.
    pub(super) fn check_masses(&mut self) {
        let [least, most] = DENSITIES;
        let mut told = Vec::new();
        for thing in self.all.iter().filter(|thing| thing.role == Role::Body) {
            let (Some(mass), Ok(volume)) = (thing.mass, self.volume(&thing.shape)) else { continue };
            let density = mass / volume;
            // A millionth more or less is the rounding of sizes.
            if !(least * (1.0 - 1e-6)..=most * (1.0 + 1e-6)).contains(&density) {
                let (end, said) = if density < least { (least, number(mass)) } else { (most, number(mass)) };
                let said = if mass.is_finite() { format!("{said} kg") } else { "infinite".into() };
                let (name, now) = (&thing.name, number(end * volume));
                told.push(format!("{name}: its mass, {said}: it has {now} kg, with a density of {end} kg/m³"));
            }
        }
        self.left_out.extend(told);
    }

    /// The volume of what moves, in m³; each piece counts by its density.
    pub(super) fn volume(&self, shape: &Shape) -> Result<f64, String> {
        match shape {
            Shape::File { object } | Shape::Hull { object } => {
                let hull = || {
                    let triangles = self.triangles(object.as_deref());
                    let metres: Vec<DVec3> = triangles.corners.iter().map(|&corner| corner * 1e-3).collect();
                    crate::custom::hull_volume(&metres).map_err(|error| error.to_string())
                };
                self.hulls.borrow_mut().entry(object.clone()).or_insert_with(hull).clone()
            }
            Shape::Solid { volume, .. } => Ok(*volume),
            Shape::Pieces(pieces) => pieces.iter().map(|piece| Ok(piece.density * self.volume(&piece.shape)?)).sum(),
        }
    }

    /// Gives every thing a unique name that is valid in a scenario.
    pub(super) fn name_all(&mut self) {
        let mut changed = Vec::new();
        // A file of shapes in which nothing stands still gets a floor.
        let gets_floor = self.floor.is_some() || !self.all.iter().any(|thing| thing.role == Role::Fixed);
        let floor = self.content.filter(|_| gets_floor).map(|_| "floor".to_owned());
        let mut names: BTreeSet<String> = floor.into_iter().collect();
        let things = self.all.iter_mut().map(|thing| &mut thing.name);
        for own in things.chain(self.joints.iter_mut().map(|held| &mut held.name)) {
            let plain = plain_name(own);
            let mut name = plain.clone();
            let mut count = 1;
            while !names.insert(name.clone()) {
                count += 1;
                name = format!("{plain}_{count}");
            }
            if name != *own {
                changed.push(format!("{own} is {name}"));
            }
            *own = name;
        }
        if let Some((first, others)) = changed.split_first() {
            let more = if others.is_empty() { String::new() } else { format!(", and {} more", others.len()) };
            self.notes.push(format!("names have only letters, digits, - and _, and each is there once: {first}{more}"));
        }
    }
}
