//! The text of a scenario with the things of a file.

use super::numbers::{number, quoted, shortest};
use super::things::{Held, Piece, Role, Shape, Sway, Thing, Things};
use glam::{DQuat, DVec3};
use plaus_asset::{Format, upright, upright_turn};
use plaus_dist::math::atan2;
use std::collections::BTreeSet;
use std::fmt::Write;

/// How far below the lowest thing the floor is, in a world without scenery, in mm.
pub(super) const DROP: f64 = 100.0;

/// How long a scenario's motions last at most, in s.
pub(super) const DURATION: f64 = 10.0;

impl Things<'_> {
    /// The scenario.
    pub(super) fn text(&self, path: &str) -> String {
        let [low, high] = self.ends;
        let mut text = format!("# A world of {path}. `plaus explain bodies[].shape`, for example, explains a key.\n");
        self.notes.iter().for_each(|note| text += &format!("#\n# {}\n", note.replace('\n', " ")));
        for (what, left_out) in [("", &self.left_out), (", and has no bearing on motion", &self.harmless)] {
            if !left_out.is_empty() {
                let _ = writeln!(text, "#\n# Not taken over from the file{what}:");
                left_out.iter().for_each(|what| text += &format!("# - {}\n", what.replace('\n', " ")));
            }
        }
        text += "#\n# Say here what must happen, for example:\n# [[require]]\n";
        let first = self.all.iter().find(|thing| thing.role == Role::Body);
        let body = first.map(|body| format!("body = {:?}, ", body.name)).unwrap_or_default();
        let _ = writeln!(text, "# rests_at = {{ {body}x_mm = 0, y_mm = 0, within_mm = 50 }}\n\n[world.custom]");
        let _ = writeln!(text, "duration_s = {DURATION}");
        self.world.iter().for_each(|line| text += &format!("{line}\n"));
        let stands = self.all.iter().any(|thing| thing.role == Role::Fixed);
        // Where the file has scenery that is left out here, or driven, it has no floor either.
        let gets_floor = self.content.is_some() && !self.all.iter().any(|thing| thing.stands);
        if !stands && !gets_floor {
            text += "fixed = []\n";
        }
        self.quantities(&mut text);
        let (materials, names, ground) = self.materials();
        text += &materials;
        if let Some(height) = self.floor.or((!stands && gets_floor).then_some(low.z - DROP)) {
            text += "\n[[world.custom.fixed]]\nname = \"floor\"\nshape = { plane = {} }\n";
            ground.iter().for_each(|name| text += &format!("material = {}\n", quoted(name)));
            let _ = writeln!(text, "at_mm = [0, 0, {}]", number(height));
        }
        for role in [Role::Fixed, Role::Body, Role::Driven] {
            for (index, thing) in self.all.iter().enumerate().filter(|(_, thing)| thing.role == role) {
                self.thing(&mut text, thing, names.get(&index));
            }
        }
        if self.bodies().next().is_none() {
            let middle = 0.5 * (low + high);
            let radius = (0.03 * (high - low).max_element()).clamp(1.0, 1e5);
            let [x, y, z] = [middle.x, middle.y, high.z + 4.0 * radius].map(number);
            text += "\n# Nothing in the file moves. Replace this falling ball with your own body.\n[[world.custom.bodies]]\n";
            let is_free = |name: &String| self.all.iter().all(|thing| thing.name != *name);
            let more = (2..).map(|k| format!("ball_{k}"));
            let name = std::iter::once("ball".to_owned()).chain(more).find(is_free).unwrap_or_default();
            let _ =
                write!(text, "name = {}\nshape = {{ ball = {{ radius_mm = {} }} }}\n", quoted(&name), number(radius));
            let _ = writeln!(
                text,
                "at_mm = [{}, {}, {z}]",
                Sway::Own.of(&x, "x", self.spread),
                Sway::Own.of(&y, "y", self.spread)
            );
        }
        self.joints.iter().for_each(|held| self.joint(&mut text, held));
        if self.bodies().next().is_some() && self.bodies().all(|index| self.all[index].sway == Sway::Nothing) {
            text += "\n# Nothing here is uncertain yet: write a law in place of a number, `{ normal = [5, 1] }` for example.\n";
        }
        text
    }

    /// Uncertain places that several things share.
    fn quantities(&self, text: &mut String) {
        let shared: BTreeSet<&String> = self
            .all
            .iter()
            .filter_map(|thing| if let Sway::With(name) = &thing.sway { Some(name) } else { None })
            .collect();
        for (name, axis) in shared.into_iter().flat_map(|name| [(name, "x"), (name, "y")]) {
            let _ = write!(text, "\n[[world.custom.quantities]]\nname = \"{name}_{axis}\"\n");
            let _ = writeln!(text, "value = {{ normal = [0, {}] }}", self.spread);
        }
    }

    /// A joint as the scenario has it.
    fn joint(&self, text: &mut String, held: &Held) {
        let [x, y, z] = held.at.to_array().map(number);
        let sway = match &self.all[held.body].sway {
            Sway::Own => &Sway::Nothing,
            sway => sway,
        };
        let _ = write!(text, "\n[[world.custom.joints]]\nname = {}\n", quoted(&held.name));
        let _ = writeln!(text, "body = {}", quoted(&self.all[held.body].name));
        if let Some(to) = held.to {
            let _ = writeln!(text, "to = {}", quoted(&self.all[to].name));
        }
        let _ = writeln!(
            text,
            "at_mm = [{}, {}, {z}]\nkind = {}",
            sway.of(&x, "x", self.spread),
            sway.of(&y, "y", self.spread),
            held.kind
        );
    }

    fn thing(&self, text: &mut String, thing: &Thing, material: Option<&String>) {
        let list = match thing.role {
            Role::Fixed => "fixed",
            Role::Body => "bodies",
            Role::Driven => "driven",
            Role::Gone => return,
        };
        let shape = self.shape(&thing.shape, thing.role);
        let remark = thing.remark.iter().map(|remark| format!(" # {remark}")).collect::<String>();
        let _ =
            write!(text, "\n[[world.custom.{list}]]\nname = {}\nshape = {{ {shape} }}{remark}\n", quoted(&thing.name));
        if let Some([red, green, blue]) = thing.colour {
            let _ = writeln!(text, "colour = \"#{red:02x}{green:02x}{blue:02x}\"");
        }
        if let Some(material) = material {
            let _ = writeln!(text, "material = {}", quoted(material));
        }
        if !thing.no_contact.is_empty() && thing.role != Role::Fixed {
            let groups: Vec<String> = thing.no_contact.iter().map(|group| quoted(group)).collect();
            let _ = writeln!(text, "no_contact = [{}]", groups.join(", "));
        }
        let [x, y, z] = thing.at.to_array().map(number);
        let turn = angles(thing.turn);
        match thing.role {
            Role::Driven | Role::Gone => {}
            Role::Fixed => _ = writeln!(text, "at_mm = [{x}, {y}, {z}]"),
            Role::Body => {
                let [dx, dy, dz] = thing.moved.to_array().map(|mm| number(shortest(mm, 1e-4)));
                let moved = match thing.moved == DVec3::ZERO {
                    true => String::new(),
                    false => format!(" # moved by [{dx}, {dy}, {dz}] mm out of others"),
                };
                let (x, y) = (thing.sway.of(&x, "x", self.spread), thing.sway.of(&y, "y", self.spread));
                let _ = writeln!(text, "at_mm = [{x}, {y}, {z}]{moved}");
            }
        }
        if thing.role != Role::Driven && turn != [0.0; 3] {
            let [x, y, z] = turn.map(number);
            let _ = writeln!(text, "turn_deg = [{x}, {y}, {z}]");
        }
        thing.mass_line().iter().chain(&thing.lines).for_each(|line| *text += &format!("{line}\n"));
    }

    /// A shape as the scenario has it.
    fn shape(&self, shape: &Shape, role: Role) -> String {
        let file = &self.file;
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
                let piece = |piece: &Piece| {
                    let at = (piece.at * 1e3).to_array().map(number).join(", ");
                    let turn = angles(piece.turn).map(number).join(", ");
                    // What is one piece of something is convex, whatever it does.
                    let shape = self.shape(&piece.shape, Role::Body);
                    let density = match number(piece.density) {
                        one if one == "1" => String::new(),
                        other => format!(", density = {other}"),
                    };
                    format!("    {{ shape = {{ {shape} }}, at_mm = [{at}], turn_deg = [{turn}]{density} }},\n")
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

impl Sway {
    /// A coordinate, with what is uncertain about it.
    fn of(&self, place: &str, axis: &str, spread: f64) -> String {
        match self {
            Self::Own => format!("{{ normal = [{place}, {spread}] }}"),
            Self::With(name) => match (place, place.strip_prefix('-')) {
                ("0", _) => format!("\"{name}_{axis}\""),
                (_, Some(away)) => format!("\"{name}_{axis} - {away}\""),
                _ => format!("\"{name}_{axis} + {place}\""),
            },
            Self::Nothing => place.to_owned(),
        }
    }
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
