//! What the nodes of a GLB become in a world.

use super::physics::{Physics, Said};
use super::things::{Piece, Role, Shape, Thing, Things};
use super::write::{angles, number, place, rotation, shortest};
use crate::turns::by_angles;
use glam::{DQuat, DVec3};
use plaus_asset::glb::{Between, Glb, Node};
use plaus_asset::{AssetError, Content};
use serde_json::Value;
use std::collections::BTreeMap;

/// Half the distance from 1 to the next number in single precision, in which a file has its numbers.
const SINGLE: f64 = 1.0 / (1 << 24) as f64;

/// A place with the fewest digits that single precision cannot tell from it. It was computed from places no farther
/// than `far` from the file's origin.
fn decimal(at: DVec3, far: f64) -> DVec3 {
    DVec3::from_array(at.to_array().map(|x| shortest(x, SINGLE * far)))
}

/// A rotation, z up, with the fewest digits of its angles that single precision cannot tell from it: each of the four
/// numbers of a quaternion is off by up to half of [`SINGLE`], and an angle by twice their sum's root.
fn turned(turn: DQuat) -> DQuat {
    by_angles(angles(rotation(turn)).map(|angle| shortest(angle, (2.0 * SINGLE).to_degrees())))
}

/// What a node becomes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    /// A thing of its own, with everything attached to it.
    Own(Role),
    /// Scenery, or a piece of the thing it is attached to.
    Plain,
    Ignored,
}

/// The things of a file.
pub(super) fn things<'a>(file: String, content: &'a Content, bytes: &[u8]) -> Result<Things<'a>, AssetError> {
    let mut things = Things::of_shapes(file, content, 1e3);
    things.ends = things.ends.map(|end| decimal(end, end.length()));
    let file = Glb::read(bytes)?;
    let nodes = file.nodes();
    let physics = Physics::read(&file, &mut things.left_out);
    let said: BTreeMap<usize, Said> =
        nodes.iter().map(|node| (node.index, physics.of(node, &mut things.left_out))).collect();
    let parts: BTreeMap<usize, Part> =
        nodes.iter().map(|node| (node.index, part(node, &said[&node.index], &mut things.left_out))).collect();
    let by_index: BTreeMap<usize, &Node> = nodes.iter().map(|node| (node.index, node)).collect();
    let has_colliders = said.values().any(|said| said.collides);
    let mut pieces: BTreeMap<usize, Vec<Piece>> = BTreeMap::new();
    for node in &nodes {
        others(node, &file, &mut things.left_out);
        let Some(shape) = shape(node, &said[&node.index], has_colliders, &mut things.left_out) else {
            continue;
        };
        let mut owner = Some(node);
        while let Some(above) = owner.filter(|above| parts[&above.index] == Part::Plain) {
            owner = above.parent.and_then(|parent| by_index.get(&parent).copied());
        }
        match owner.map(|owner| (owner, parts[&owner.index])) {
            Some((_, Part::Ignored)) => {}
            Some((owner, Part::Own(Role::Body | Role::Driven))) => {
                let back = owner.turn.inverse();
                let (at, turn) = (back * (node.at - owner.at), back * node.turn);
                let at = decimal(place(at), node.at.length().max(owner.at.length()));
                let piece = Piece { shape, at, turn: turned(turn), density: 1.0 };
                pieces.entry(owner.index).or_default().push(piece);
            }
            _ => things.all.push(thing(node, &node.name, Role::Fixed, shape, content, &said[&node.index])),
        }
    }
    for node in &nodes {
        let Part::Own(role @ (Role::Body | Role::Driven)) = parts[&node.index] else { continue };
        let Some(pieces) = pieces.remove(&node.index) else {
            things.left_out.push(format!("{}: it should move, but has no shape", node.name));
            continue;
        };
        let shape = Shape::of_pieces(pieces);
        let said = &said[&node.index];
        let mut own = thing(node, &node.name, role, shape, content, said);
        own.lines.extend(if role == Role::Driven { keys(node) } else { said.lines.clone() });
        things.left_out.extend(node.left_out.iter().map(|what| format!("{}: {what}", node.name)));
        things.all.push(own);
    }
    Ok(things)
}

fn thing(node: &Node, name: &str, role: Role, shape: Shape, content: &Content, said: &Said) -> Thing {
    let colour = content.object(&node.name).and_then(|object| object.colour);
    let at = if role == Role::Driven { DVec3::ZERO } else { decimal(place(node.at), node.at.length()) * 1e3 };
    let (mass, contact) = (said.mass.filter(|_| role == Role::Body), said.contact);
    Thing { at, turn: turned(node.turn), colour, mass, contact, ..Thing::new(name, role, shape) }
}

/// What a node becomes: according to its `extras`, or else the extension, or else its keys.
fn part(node: &Node, said: &Said, left_out: &mut Vec<String>) -> Part {
    let asked = node.extras.get("plaus").filter(|_| !is_label(node)).map(|asked| (asked, asked.as_str()));
    match asked {
        Some((_, Some("body"))) => return Part::Own(Role::Body),
        Some((_, Some("driven"))) if !node.keys.is_empty() => return Part::Own(Role::Driven),
        Some((_, Some("fixed"))) => return Part::Own(Role::Fixed),
        Some((_, Some("ignore"))) => return Part::Ignored,
        Some((other, _)) => {
            let why = "`plaus` may be body, fixed, ignore or, if there are keys, driven";
            left_out.push(format!("{}: its extras: {other} is unknown: {why}", node.name));
        }
        None => {}
    }
    match said.moves {
        Some(Role::Driven) if node.keys.is_empty() => Part::Own(Role::Fixed),
        Some(role) => Part::Own(role),
        None if !node.keys.is_empty() => Part::Own(Role::Driven),
        None => Part::Plain,
    }
}

/// The shape of a node alone, if it has one.
fn shape(node: &Node, said: &Said, has_colliders: bool, left_out: &mut Vec<String>) -> Option<Shape> {
    if let Some(shape) = &said.shape {
        return Some(shape.clone());
    }
    if !node.has_mesh {
        return None;
    }
    if has_colliders && !said.collides && node.extras.get("plaus").is_none() {
        left_out.push(format!("{}: it has a mesh but no collider, so nothing can touch it", node.name));
        return None;
    }
    if node.scale == DVec3::ZERO {
        left_out.push(format!("{}: its shape, as its scale is 0", node.name));
        return None;
    }
    let object = Some(node.name.clone());
    Some(if said.is_hull { Shape::Hull { object } } else { Shape::File { object } })
}

/// The keys of a body that follows keyframes.
fn keys(node: &Node) -> Vec<String> {
    let between = match node.between {
        Between::Step => "step",
        Between::Linear => "linear",
        Between::Cubic => "smooth",
    };
    let key = |key: &plaus_asset::glb::Key| {
        let at = (decimal(place(key.at), key.at.length()) * 1e3).to_array().map(number).join(", ");
        let turn = angles(turned(key.turn)).map(number).join(", ");
        let time = number(shortest(key.time, SINGLE * key.time.abs()));
        format!("    {{ at_s = {time}, at_mm = [{at}], turn_deg = [{turn}] }},\n")
    };
    let keys: String = node.keys.iter().map(key).collect();
    vec![format!("between = \"{between}\""), format!("keys = [\n{keys}]")]
}

/// Whether the extras of a node are the label of a motion that Plaus wrote, which says where it comes from.
fn is_label(node: &Node) -> bool {
    ["plaus", "scene", "scenario_hash"].iter().all(|key| node.extras.get(key).is_some())
}

/// Other properties of a node that a scenario cannot express.
fn others(node: &Node, file: &Glb, left_out: &mut Vec<String>) {
    let said = file.said("nodes", node.index);
    for (key, what) in
        [("camera", "its camera"), ("skin", "its skin: it does not change"), ("weights", "its morph targets")]
    {
        if !said[key].is_null() {
            left_out.push(format!("{}: {what}", node.name));
        }
    }
    let extensions = node.extensions.as_object().into_iter().flatten();
    for (name, _) in extensions.filter(|(name, _)| name.as_str() != super::physics::BODIES) {
        left_out.push(format!("{}: its extension {name}", node.name));
    }
    if let Value::Object(extras) = &node.extras
        && !is_label(node)
    {
        for name in extras.keys().filter(|name| name.as_str() != "plaus") {
            left_out.push(format!("{}: {name} of its extras", node.name));
        }
    }
}
