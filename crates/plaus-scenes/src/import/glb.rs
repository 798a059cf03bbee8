//! What the nodes of a GLB become in a world.

use super::ImportError;
use super::choice::Choice;
use super::contact::Contact;
use super::filters::{Colliders, Filters};
use super::from_usd::{Weight, colour, told, weigh};
use super::limits::{Owners, joints};
use super::numbers::{number, shortest};
use super::physics::{Physics, Said};
use super::things::{Piece, Role, Shape, Thing, Things};
use super::write::{DURATION, angles, place, rotation};
use crate::turns::by_angles;
use glam::{DQuat, DVec3};
use plaus_asset::Content;
use plaus_asset::glb::{Between, FROM_USD, Glb, Node};
use plaus_dist::math::sin_cos;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Half the distance from 1 to the next number in single precision, in which a file has its numbers.
const SINGLE: f64 = 1.0 / (1 << 24) as f64;

/// How far the origin of what turns steadily may be from where it is between keys, in m, and most keys of it.
const OFF: f64 = 5e-5;
const MOST_KEYS: f64 = 5000.0;

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

/// Extensions of nodes, by the beginnings of their names, that have no bearing on motion.
const HARMLESS: [&str; 8] =
    ["KHR_lights", "EXT_lights", "KHR_node_", "KHR_audio", "KHR_xmp", "KHR_materials", "KHR_texture", "EXT_texture"];

/// Nodes with what they say.
struct Nodes<'a> {
    by_index: BTreeMap<usize, &'a Node>,
    said: BTreeMap<usize, Said>,
    parts: BTreeMap<usize, Part>,
    /// What was said of some.
    chosen: BTreeMap<usize, Role>,
}

impl<'a> Nodes<'a> {
    fn read(
        nodes: &'a [Node],
        physics: &Physics,
        choice: &Choice,
        left_out: &mut Vec<String>,
    ) -> Result<Self, ImportError> {
        let by_index: BTreeMap<usize, &Node> = nodes.iter().map(|node| (node.index, node)).collect();
        let above = |node: &'a Node| std::iter::successors(Some(node), |node| by_index.get(&node.parent?).copied());
        let shaped = |node: &Node| node.has_mesh || node.collider.is_some();
        let named: BTreeSet<usize> =
            nodes.iter().filter(|node| shaped(node)).flat_map(|node| above(node).map(|node| node.index)).collect();
        let names = nodes.iter().filter(|node| named.contains(&node.index)).map(|node| node.name.as_str());
        choice.check(&names.collect::<Vec<_>>())?;
        // What is said of a node without a mesh holds for all below it.
        let chosen = |node: &'a Node| {
            let role = choice.of(&node.name)?;
            let is_part = above(node).skip(1).any(|above| choice.of(&above.name) == Some(role) && !shaped(above));
            (!is_part && named.contains(&node.index)).then_some(role)
        };
        let chosen: BTreeMap<usize, Role> = nodes.iter().filter_map(|node| Some((node.index, chosen(node)?))).collect();
        let still = |node: &&Node| chosen.get(&node.index) == Some(&Role::Driven) && node.keys.is_empty();
        if let Some(node) = nodes.iter().find(still) {
            return Err(ImportError::Choice(format!("{} has no keyframes to follow", node.name)));
        }
        let frees = |node: &&Node| chosen.get(&node.index) == Some(&Role::Body) && !node.keys.is_empty();
        let freed = nodes.iter().filter(frees).map(|node| format!("{}: its keyframes: it moves freely", node.name));
        left_out.extend(freed);
        let moves = |node: &'a Node| {
            let says = |node: &Node| {
                let asked = node.extras.get("plaus").and_then(Value::as_str);
                let motion = node.extensions[super::physics::BODIES]["motion"].is_object();
                motion
                    || !node.keys.is_empty()
                    || matches!(asked, Some("body" | "driven"))
                    || matches!(chosen.get(&node.index), Some(Role::Body | Role::Driven))
            };
            above(node).any(says)
        };
        let said: BTreeMap<usize, Said> =
            nodes.iter().map(|node| (node.index, physics.of(node, moves(node), left_out))).collect();
        let mut part = |node: &Node| match chosen.get(&node.index) {
            Some(Role::Gone) => Part::Ignored,
            Some(role) => Part::Own(*role),
            None => part(node, &said[&node.index], left_out),
        };
        let parts = nodes.iter().map(|node| (node.index, part(node))).collect();
        Ok(Self { by_index, said, parts, chosen })
    }

    /// The node that decides what becomes of one: itself or the nearest above it that is no mere part, if any.
    fn owner(&self, node: &'a Node) -> Option<(&'a Node, Part)> {
        let mut owner = Some(node);
        while let Some(above) = owner.filter(|above| self.parts[&above.index] == Part::Plain) {
            owner = above.parent.and_then(|parent| self.by_index.get(&parent).copied());
        }
        owner.map(|owner| (owner, self.parts[&owner.index]))
    }
}

/// The pieces of what moves, with what their colliders say.
#[derive(Default)]
struct Collected {
    pieces: Vec<Piece>,
    contacts: Vec<Option<Contact>>,
    filters: Vec<Option<usize>>,
    weights: Vec<Weight>,
}

/// The things of a file.
pub(super) fn things<'a>(
    file: String,
    content: &'a Content,
    bytes: &[u8],
    choice: &Choice,
) -> Result<Things<'a>, ImportError> {
    let mut things = Things::of_shapes(file, content, 1e3);
    things.passes = true;
    let file = Glb::read(bytes)?;
    required(&file, &mut things);
    told(&file, &mut things);
    let all = file.nodes();
    let nodes = Nodes::read(&all, &Physics::read(&file), choice, &mut things.left_out)?;
    let has_colliders = nodes.said.values().any(|said| said.collides);
    // Below these there are colliders that stand for what they show.
    let above = |node| std::iter::successors(Some(node), |node: &&Node| nodes.by_index.get(&node.parent?).copied());
    let colliding = all.iter().filter(|node| nodes.said[&node.index].collides);
    let covered: BTreeSet<usize> = colliding.flat_map(|node| above(node).skip(1).map(|node| node.index)).collect();
    let mut collected: BTreeMap<usize, Collected> = BTreeMap::new();
    let mut colliders = Colliders::new();
    // The things of nodes that move, and that stand still.
    let (mut made, mut standing): (BTreeMap<usize, usize>, BTreeMap<usize, usize>) = Default::default();
    for node in &all {
        let said = &nodes.said[&node.index];
        others(node, &file, &mut things);
        let has_colliders = has_colliders && !nodes.chosen.contains_key(&node.index);
        if has_colliders && !said.collides && covered.contains(&node.index) {
            continue;
        }
        let Some(shape) = shape(node, said, has_colliders, &mut things.left_out) else { continue };
        if let Some((_, reach)) = said.shape {
            let at = place(node.at) * 1e3;
            things.ends = [things.ends[0].min(at - reach * 1e3), things.ends[1].max(at + reach * 1e3)];
        }
        match nodes.owner(node) {
            Some((_, Part::Ignored)) => {}
            Some((owner, Part::Own(Role::Body | Role::Driven))) => {
                let back = owner.turn.inverse();
                let (at, turn) = (back * (node.at - owner.at), back * node.turn);
                let at = decimal(place(at), node.at.length().max(owner.at.length()));
                let own = collected.entry(owner.index).or_default();
                own.pieces.push(Piece { shape, at, turn: turned(turn), density: 1.0 });
                own.contacts.push(said.contact);
                own.filters.push(said.filter);
                own.weights.push(Weight::of(node));
            }
            _ => {
                standing.insert(node.index, things.all.len());
                colliders.insert(things.all.len(), vec![said.filter]);
                let contact = said.contact;
                things.all.push(Thing { contact, ..thing(node, Role::Fixed, shape, Some(content)) });
            }
        }
    }
    for node in &all {
        let Part::Own(role @ (Role::Body | Role::Driven)) = nodes.parts[&node.index] else { continue };
        let Some(own) = collected.remove(&node.index) else {
            things.left_out.push(format!("{}: it should move, but has no shape", node.name));
            continue;
        };
        let filters = own.filters.clone();
        let moving = moving(node, role, &nodes.said[&node.index], own, &mut things);
        made.insert(node.index, things.all.len());
        colliders.insert(things.all.len(), filters);
        things.all.push(moving);
    }
    things.ends = if things.ends[0].is_finite() && things.ends[1].is_finite() {
        things.ends.map(|end| decimal(end, end.length()))
    } else {
        [DVec3::splat(-100.0), DVec3::splat(100.0)]
    };
    let owner_of = |node: &Node| match nodes.owner(node) {
        Some((owner, Part::Own(Role::Body | Role::Driven))) => made.get(&owner.index).map(|&thing| Some(thing)),
        Some((_, Part::Ignored)) => None,
        _ => Some(None),
    };
    let owners: Owners = all.iter().filter_map(|node| Some((node.index, owner_of(node)?))).collect();
    let stands = |node: &Node| {
        let above = std::iter::successors(Some(node), |node| nodes.by_index.get(&node.parent?).copied());
        above.into_iter().find_map(|node| standing.get(&node.index).copied())
    };
    let standing: BTreeMap<usize, usize> = all.iter().filter_map(|node| Some((node.index, stands(node)?))).collect();
    joints(&file, &all, (&owners, &standing), &mut things);
    Filters::read(&file).apply(&mut things, &colliders);
    Ok(things)
}

/// What moves, with all its pieces.
fn moving(node: &Node, role: Role, said: &Said, mut own: Collected, things: &mut Things<'_>) -> Thing {
    let weighed = weigh(things, &mut own.pieces, &own.weights);
    let content = things.content;
    let mut moving = thing(node, role, Shape::of_pieces(own.pieces), content);
    moving.mass = said.mass.or(weighed).filter(|_| role == Role::Body);
    moving.cuts = own.weights.iter().any(|weight| weight.cuts);
    moving.contact = one_contact(&own.contacts, node, &mut things.left_out);
    moving.inertia = if role == Role::Body { said.inertia } else { moving.inertia };
    moving.lines.extend(if role == Role::Driven { keys(node, said) } else { said.lines.clone() });
    things.left_out.extend(node.left_out.iter().map(|what| format!("{}: {what}", node.name)));
    moving
}

/// What a file requires its readers to know, where that is not read.
fn required(file: &Glb, things: &mut Things<'_>) {
    for name in file.required() {
        if name == super::physics::BODIES || super::physics::SHAPES.contains(&name) {
            continue;
        }
        let is_harmless = HARMLESS.iter().any(|known| name.starts_with(known));
        let list = if is_harmless { &mut things.harmless } else { &mut things.left_out };
        list.push(format!("the extension {name}, which the file requires"));
    }
}

fn thing(node: &Node, role: Role, shape: Shape, content: Option<&Content>) -> Thing {
    let object = content.and_then(|content| content.object(&node.name));
    let colour = object.and_then(|object| object.colour).or_else(|| colour(node));
    let material = object.and_then(|object| object.material.clone());
    let at = if role == Role::Driven { DVec3::ZERO } else { decimal(place(node.at), node.at.length()) * 1e3 };
    Thing { at, turn: turned(node.turn), colour, material, ..Thing::new(&node.name, role, shape) }
}

/// Friction and restitution of something with several colliders: those of the first that has any.
fn one_contact(contacts: &[Option<Contact>], node: &Node, left_out: &mut Vec<String>) -> Option<Contact> {
    let first = contacts.iter().flatten().next().copied()?;
    if contacts.iter().any(|contact| *contact != Some(first)) {
        let [friction, restitution, _] = first.values.map(number);
        left_out.push(format!(
            "{}: the material of each collider: all have friction {friction} and restitution {restitution}",
            node.name
        ));
    }
    Some(first)
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
        Some(Role::Driven) if node.keys.is_empty() && said.velocity == DVec3::ZERO && said.spin == DVec3::ZERO => {
            Part::Own(Role::Fixed)
        }
        Some(role) => Part::Own(role),
        None if !node.keys.is_empty() => Part::Own(Role::Driven),
        None => Part::Plain,
    }
}

/// The shape of a node alone, if it has one.
fn shape(node: &Node, said: &Said, has_colliders: bool, left_out: &mut Vec<String>) -> Option<Shape> {
    if let Some((shape, _)) = &said.shape {
        return Some(shape.clone());
    }
    if !node.has_mesh && node.collider.is_none() {
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
    let object = Some(node.collider.clone().filter(|_| said.collides).unwrap_or_else(|| node.name.clone()));
    Some(if said.is_hull { Shape::Hull { object } } else { Shape::File { object } })
}

/// The keys of a body that follows keyframes, or moves on and turns at the same rate.
fn keys(node: &Node, said: &Said) -> Vec<String> {
    if node.keys.is_empty() {
        return steady(node, said);
    }
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

/// The keys of something that nothing but its own velocity moves, until the scenario ends.
fn steady(node: &Node, said: &Said) -> Vec<String> {
    let centre = said.inertia.centre.unwrap_or(DVec3::ZERO);
    let (at, turn) = (place(node.at), rotation(node.turn));
    // Where its origin goes round its centre of mass, it does so in straight parts, off by less than a tenth of the
    // distance times the angle squared.
    let (rate, arm) = (said.spin.length(), centre.length());
    let most = if arm > 0.0 { (10.0 * OFF / arm).sqrt().min(1.0) } else { 2.0 };
    let parts = (rate * DURATION / most).ceil().clamp(1.0, MOST_KEYS);
    let key = |k: u32| {
        let time = DURATION * f64::from(k) / parts;
        let (sin, cos) = sin_cos(0.5 * rate * time);
        let axis = said.spin.normalize_or_zero() * sin;
        let now = (DQuat::from_xyzw(axis.x, axis.y, axis.z, cos) * turn).normalize();
        let at = at + turn * centre + said.velocity * time - now * centre;
        let (at, turn) = ((at * 1e3).to_array().map(number).join(", "), angles(now).map(number).join(", "));
        format!("    {{ at_s = {}, at_mm = [{at}], turn_deg = [{turn}] }},\n", number(time))
    };
    let keys: String = (0..=parts as u32).map(key).collect();
    vec!["between = \"linear\"".into(), format!("keys = [\n{keys}]")]
}

/// Whether the extras of a node are the label of a motion that Plaus wrote, which says where it comes from.
fn is_label(node: &Node) -> bool {
    ["plaus", "scene", "scenario_hash"].iter().all(|key| node.extras.get(key).is_some())
}

/// Other properties of a node that a scenario cannot express.
fn others(node: &Node, file: &Glb, things: &mut Things<'_>) {
    let said = file.said("nodes", node.index);
    for (key, what) in [("skin", "its skin: it does not change"), ("weights", "its morph targets")] {
        if !said[key].is_null() {
            things.left_out.push(format!("{}: {what}", node.name));
        }
    }
    if !said["camera"].is_null() {
        things.harmless.push(format!("{}: its camera", node.name));
    }
    let extensions = node.extensions.as_object().into_iter().flatten();
    for (name, _) in extensions.filter(|(name, _)| ![super::physics::BODIES, FROM_USD].contains(&name.as_str())) {
        let is_harmless = HARMLESS.iter().any(|known| name.starts_with(known));
        let list = if is_harmless { &mut things.harmless } else { &mut things.left_out };
        list.push(format!("{}: its extension {name}", node.name));
    }
    if let Value::Object(extras) = &node.extras
        && !is_label(node)
    {
        let more = extras.keys().filter(|name| !["plaus", "origin"].contains(&name.as_str()));
        things.harmless.extend(more.map(|name| format!("{}: {name} of its extras", node.name)));
    }
}
