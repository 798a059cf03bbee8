//! Things of a file, and the text of a scenario with them.

use glam::{DQuat, DVec3};
use plaus_asset::{Content, Format, Triangles, upright, upright_turn};
use plaus_dist::math::atan2;
use plaus_sim::scenery::Mesh;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// Longest name of a thing in a scenario.
const LONGEST: usize = 40;

/// How far below the lowest thing the floor is, in a world without scenery, in mm.
const DROP: f64 = 100.0;

/// The uncertainty of places, in mm, so that there is something to sample.
const SPREAD: f64 = 5.0;

/// What a thing does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    Fixed,
    Body,
    Driven,
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
    /// Pieces about the thing's origin, in m.
    Pieces(Vec<(Shape, DVec3, DQuat)>),
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
    /// In kg, if the file gives it.
    pub(super) mass: Option<f64>,
    /// Friction and restitution, if the file gives them.
    pub(super) contact: Option<[f64; 2]>,
    /// Other keys, as lines of TOML.
    pub(super) lines: Vec<String>,
    pub(super) lifted: f64,
}

impl Thing {
    pub(super) fn new(name: &str, role: Role, shape: Shape) -> Self {
        let (at, turn) = (DVec3::ZERO, DQuat::IDENTITY);
        let (colour, mass, contact) = (None, None, None);
        Self { name: name.into(), role, shape, at, turn, colour, mass, contact, lines: Vec::new(), lifted: 0.0 }
    }
}

/// All of a file.
#[derive(Debug, Clone)]
pub(super) struct Things {
    pub(super) all: Vec<Thing>,
    pub(super) left_out: Vec<String>,
    /// Millimetres of the file's unit, and its axis that points up.
    format: Format,
}

impl Things {
    pub(super) fn new(content: &Content) -> Self {
        Self { all: Vec::new(), left_out: Vec::new(), format: content.format }
    }

    /// The bodies, in the order of the text.
    pub(super) fn bodies(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.all.len()).filter(|&index| self.all[index].role == Role::Body)
    }

    pub(super) fn lift(&mut self, index: usize, by: f64) {
        self.all[index].at.z += by;
        self.all[index].lifted += by;
    }

    /// The triangles of an object, in mm, z up, about its own origin; of all objects if none is named.
    fn triangles(&self, content: &Content, object: Option<&str>) -> Triangles {
        let found = object.and_then(|name| content.object(name));
        let triangles = found.map_or_else(|| content.whole(), |object| object.triangles.clone());
        let unit = self.format.unit_mm();
        triangles.moved(|corner| unit * upright(corner, self.format.up()))
    }

    /// Replaces scenery by its hull if the simulator does not accept its triangles, and leaves out things without a
    /// hull.
    pub(super) fn try_shapes(&mut self, content: &Content) {
        let mut kept = Vec::new();
        for mut thing in std::mem::take(&mut self.all) {
            let Err(why) = self.settle(&mut thing, content) else {
                kept.push(thing);
                continue;
            };
            self.left_out.push(format!("{}: {why}", thing.name));
        }
        self.all = kept;
    }

    fn settle(&mut self, thing: &mut Thing, content: &Content) -> Result<(), String> {
        if let (Role::Fixed, Shape::File { object }) = (thing.role, &thing.shape) {
            let triangles = self.triangles(content, object.as_deref());
            let faces: Vec<_> = triangles.faces.iter().map(|&face| (face, plaus_sim::Material(0))).collect();
            let Err(error) = Mesh::new(triangles.corners, &faces, 0.0) else { return Ok(()) };
            thing.shape = Shape::Hull { object: object.clone() };
            self.left_out.push(format!("{}: its triangles, replaced by their convex hull: {error}", thing.name));
        }
        self.volume(&thing.shape, content).map(drop)
    }

    /// The volume of what moves, in m³.
    fn volume(&self, shape: &Shape, content: &Content) -> Result<f64, String> {
        match shape {
            Shape::File { object } | Shape::Hull { object } => {
                let triangles = self.triangles(content, object.as_deref());
                let metres: Vec<DVec3> = triangles.corners.iter().map(|&corner| corner * 1e-3).collect();
                crate::custom::hull_volume(&metres).map_err(|error| error.to_string())
            }
            Shape::Solid { volume, .. } => Ok(*volume),
            Shape::Pieces(pieces) => pieces.iter().map(|piece| self.volume(&piece.0, content)).sum(),
        }
    }

    /// Gives every thing a unique name that is valid in a scenario.
    pub(super) fn name_all(&mut self) {
        let mut names = BTreeSet::from(["floor".to_owned()]);
        for thing in &mut self.all {
            let letter = |c: char| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' };
            let plain: String = thing.name.chars().map(letter).take(LONGEST - 6).collect();
            let plain = if plain.is_empty() { "thing".to_owned() } else { plain };
            let mut name = plain.clone();
            let mut count = 1;
            while !names.insert(name.clone()) {
                count += 1;
                name = format!("{plain}_{count}");
            }
            thing.name = name;
        }
    }

    /// The ends of all things, in mm: of the corners of what comes from the file.
    fn ends(&self, content: &Content) -> [DVec3; 2] {
        let unit = self.format.unit_mm();
        let corners = content.whole().corners;
        let places = corners.iter().map(|&corner| unit * upright(corner, self.format.up()));
        places.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], place| [low.min(place), high.max(place)])
    }

    /// The scenario.
    pub(super) fn text(&self, path: &str, anywhere: bool, content: &Content) -> String {
        let [low, high] = self.ends(content);
        let named = quoted(path);
        let file = if anywhere { format!("{named}, anywhere = true") } else { named };
        let mut text = format!("# A world of {path}. `plaus explain bodies[].shape`, for example, explains a key.\n");
        if !self.left_out.is_empty() {
            text += "#\n# Not taken over from the file:\n";
            self.left_out.iter().for_each(|what| text += &format!("# - {}\n", what.replace('\n', " ")));
        }
        text += "#\n# Say here what must happen, for example:\n# [[require]]\n";
        text += "# rests_at = { x_mm = 0, y_mm = 0, within_mm = 50 }\n\n[world.custom]\nduration_s = 10\n";
        let (materials, names) = self.materials(content);
        text += &materials;
        if !self.all.iter().any(|thing| thing.role == Role::Fixed) {
            let height = number(low.z - DROP);
            let _ = write!(
                text,
                "\n[[world.custom.fixed]]\nname = \"floor\"\nshape = {{ plane = {{}} }}\nat_mm = [0, 0, {height}]\n"
            );
        }
        for role in [Role::Fixed, Role::Body, Role::Driven] {
            for (index, thing) in self.all.iter().enumerate().filter(|(_, thing)| thing.role == role) {
                self.thing(&mut text, thing, names.get(&index), &file);
            }
        }
        if self.bodies().next().is_none() {
            let middle = 0.5 * (low + high);
            let radius = (0.03 * (high - low).max_element()).clamp(1.0, 1e5);
            let [x, y, z] = [middle.x, middle.y, high.z + 4.0 * radius].map(number);
            text += "\n# Nothing in the file moves. Replace this falling ball with your own body.\n[[world.custom.bodies]]\n";
            let _ = write!(text, "name = \"ball\"\nshape = {{ ball = {{ radius_mm = {} }} }}\n", number(radius));
            let _ = writeln!(text, "at_mm = [{}, {}, {z}]", uncertain(&x), uncertain(&y));
        }
        text
    }

    /// Materials of things of which the file says what they weigh or how they touch, and their names.
    fn materials(&self, content: &Content) -> (String, BTreeMap<usize, String>) {
        let (mut text, mut names) = (String::new(), BTreeMap::new());
        for (index, thing) in self.all.iter().enumerate() {
            let density = thing.mass.and_then(|mass| Some(mass / self.volume(&thing.shape, content).ok()?));
            let density = density.filter(|density| (1e-3..=1e6).contains(density));
            if density.is_none() && thing.contact.is_none() {
                continue;
            }
            let name = format!("of_{}", thing.name);
            let _ = write!(text, "\n[[world.custom.materials]]\nname = {}\n", quoted(&name));
            if let Some(density) = density {
                let _ = writeln!(text, "density = {}", number(density));
            }
            if let Some([friction, restitution]) = thing.contact {
                let _ = write!(text, "friction = {}\nrestitution = {}\n", number(friction), number(restitution));
            }
            names.insert(index, name);
        }
        (text, names)
    }

    fn thing(&self, text: &mut String, thing: &Thing, material: Option<&String>, file: &str) {
        let list = match thing.role {
            Role::Fixed => "fixed",
            Role::Body => "bodies",
            Role::Driven => "driven",
        };
        let shape = self.shape(&thing.shape, thing.role, file);
        let _ = write!(text, "\n[[world.custom.{list}]]\nname = {}\nshape = {{ {shape} }}\n", quoted(&thing.name));
        if let Some([red, green, blue]) = thing.colour {
            let _ = writeln!(text, "colour = \"#{red:02x}{green:02x}{blue:02x}\"");
        }
        if let Some(material) = material {
            let _ = writeln!(text, "material = {}", quoted(material));
        }
        let [x, y, z] = thing.at.to_array().map(number);
        let turn = angles(thing.turn);
        match thing.role {
            Role::Driven => {}
            Role::Fixed => _ = writeln!(text, "at_mm = [{x}, {y}, {z}]"),
            Role::Body => {
                let lifted = number(thing.lifted);
                let lifted =
                    if thing.lifted > 0.0 { format!(" # lifted by {lifted} mm out of others") } else { String::new() };
                let _ = writeln!(text, "at_mm = [{}, {}, {z}]{lifted}", uncertain(&x), uncertain(&y));
            }
        }
        if thing.role != Role::Driven && turn != [0.0; 3] {
            let [x, y, z] = turn.map(number);
            let _ = writeln!(text, "turn_deg = [{x}, {y}, {z}]");
        }
        thing.lines.iter().for_each(|line| *text += &format!("{line}\n"));
    }

    /// A shape as the scenario has it.
    fn shape(&self, shape: &Shape, role: Role, file: &str) -> String {
        let object = |object: &Option<String>| match object {
            Some(name) => format!(", object = {}", quoted(name)),
            None => String::new(),
        };
        match shape {
            Shape::File { object: name } if role == Role::Fixed => {
                format!("mesh = {{ file = {file}{} }}", object(name))
            }
            Shape::File { object: name } | Shape::Hull { object: name } => {
                format!("hull_of = {{ file = {file}{} }}", object(name))
            }
            Shape::Solid { said, .. } => said.clone(),
            Shape::Pieces(pieces) => {
                let piece = |(shape, at, turn): &(Shape, DVec3, DQuat)| {
                    let at = (*at * 1e3).to_array().map(number).join(", ");
                    let turn = angles(*turn).map(number).join(", ");
                    // What is one piece of something is convex, whatever it does.
                    let shape = self.shape(shape, Role::Body, file);
                    format!("    {{ shape = {{ {shape} }}, at_mm = [{at}], turn_deg = [{turn}] }},\n")
                };
                format!("compound = {{ pieces = [\n{}] }}", pieces.iter().map(piece).collect::<String>())
            }
        }
    }
}

/// A place of a GLB in m, z up.
pub(super) fn place(at: DVec3) -> DVec3 {
    upright(at, Format::Glb.up())
}

/// A rotation of a GLB, z up.
pub(super) fn rotation(turn: DQuat) -> DQuat {
    upright_turn(turn, Format::Glb.up())
}

/// Angles in degrees about the world's x, then y, then z, that give this rotation.
pub(super) fn angles(turn: DQuat) -> [f64; 3] {
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| turn * axis);
    let level = (x.x * x.x + x.y * x.y).sqrt();
    // If x points up or down, z and x turn about one axis: the whole angle is given to x.
    let radians = if level > 1e-9 {
        [atan2(y.z, z.z), atan2(-x.z, level), atan2(x.y, x.x)]
    } else {
        [atan2(-x.z.signum() * y.x, y.y), atan2(-x.z, level), 0.0]
    };
    radians.map(f64::to_degrees)
}

/// A coordinate as a law around it.
fn uncertain(place: &str) -> String {
    format!("{{ normal = [{place}, {SPREAD}] }}")
}

/// A number as a scenario has it, to a millionth.
pub(super) fn number(value: f64) -> String {
    let rounded = (value * 1e6).round() / 1e6;
    // −0 is 0; what is too large to be rounded stays.
    format!("{}", if rounded.is_finite() { rounded + 0.0 } else { value })
}

/// A text as a scenario has it.
pub(super) fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::turns::by_angles;

    #[test]
    fn angles_turn_as_the_rotation_does() {
        for said in [[0.0, 0.0, 0.0], [30.0, -50.0, 170.0], [-120.0, 80.0, 5.0], [40.0, 90.0, 0.0], [25.0, -90.0, 0.0]]
        {
            let turn = by_angles(said);
            let again = by_angles(angles(turn));
            assert!(turn.dot(again).abs() > 1.0 - 1e-12, "{said:?}: {:?}", angles(turn));
        }
    }
}
