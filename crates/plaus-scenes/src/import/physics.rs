//! The extension `KHR_physics_rigid_bodies`, a draft whose spelling has changed: both are read.
//!
//! Shapes are in `KHR_implicit_shapes`, formerly `KHR_collision_shapes`; a collider names one by `geometry.shape`,
//! formerly `shape`.

use super::contact::{Contact, Rule};
use super::numbers::number;
use super::solids::{Solid, solid, vector};
use super::things::{Inertia, Role, Shape};
use super::write::{place, rotation};
use glam::{DQuat, DVec3, DVec4};
use plaus_asset::glb::{Glb, Node};
use serde_json::Value;
use std::f64::consts::PI;

/// The extension's name.
pub(super) const BODIES: &str = "KHR_physics_rigid_bodies";

/// Names of the extension that shapes stand in, the present one first.
pub(super) const SHAPES: [&str; 2] = ["KHR_implicit_shapes", "KHR_collision_shapes"];

/// Shapes and materials of a file.
#[derive(Debug)]
pub(super) struct Physics {
    shapes: Vec<Value>,
    materials: Vec<Value>,
}

/// What the extension says of a node.
#[derive(Debug, Clone, Default)]
pub(super) struct Said {
    /// What it does, where it moves.
    pub(super) moves: Option<Role>,
    /// Whether it can be met.
    pub(super) collides: bool,
    /// Its shape, where that is not its mesh, and how far it reaches, in m.
    pub(super) shape: Option<(Shape, f64)>,
    /// Whether its mesh stands for its convex hull.
    pub(super) is_hull: bool,
    /// In kg; infinite if the file says 0.
    pub(super) mass: Option<f64>,
    /// What it says of where the mass is; an infinite moment is infinite.
    pub(super) inertia: Inertia,
    pub(super) contact: Option<Contact>,
    /// Which of the file's filters its collider has.
    pub(super) filter: Option<usize>,
    /// In m/s and radians per second, along the world's axes, z up.
    pub(super) velocity: DVec3,
    pub(super) spin: DVec3,
    /// Keys of a body, as lines of TOML.
    pub(super) lines: Vec<String>,
}

impl Physics {
    pub(super) fn read(file: &Glb) -> Self {
        let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
        let shapes = SHAPES.iter().map(|name| list(&file.extension(name)["shapes"])).find(|shapes| !shapes.is_empty());
        let materials = list(&file.extension(BODIES)["physicsMaterials"]);
        Self { shapes: shapes.unwrap_or_default(), materials }
    }

    /// What is said of a node; `moves` tells whether it is, or is part of, something that moves.
    pub(super) fn of(&self, node: &Node, moves: bool, left_out: &mut Vec<String>) -> Said {
        let bodies = &node.extensions[BODIES];
        let mut said = Said::default();
        let mut leave = |what: String| left_out.push(format!("{}: {what}", node.name));
        if !bodies["trigger"].is_null() {
            leave("its trigger: it has no place in a scenario; `inside` can require what it would tell".into());
        }
        motion(&bodies["motion"], node, &mut said, &mut leave);
        let collider = &bodies["collider"];
        if collider.is_null() || node.scale == DVec3::ZERO {
            return said;
        }
        said.collides = true;
        said.filter = collider["collisionFilter"].as_u64().and_then(|index| usize::try_from(index).ok());
        let geometry = if collider["geometry"].is_object() { &collider["geometry"] } else { collider };
        said.is_hull = geometry["convexHull"].as_bool().unwrap_or(false);
        if let Some(index) = geometry["shape"].as_u64() {
            match usize::try_from(index).ok().and_then(|index| self.shapes.get(index)) {
                Some(shape) => self.shape(shape, node, moves, &mut said, &mut leave),
                None => leave(format!(
                    "the shape {index} of its collider: the file has {}, counted from 0; its mesh is used instead",
                    self.shapes.len()
                )),
            }
        } else if node.collider.is_none() && !node.has_mesh {
            leave("its collider: it names neither a shape, nor a node with a mesh, that the file has".into());
        }
        if let Some(index) = collider["physicsMaterial"].as_u64() {
            said.contact = Some(self.contact(index, &mut leave));
        }
        said
    }

    fn shape(&self, shape: &Value, node: &Node, moves: bool, said: &mut Said, leave: &mut impl FnMut(String)) {
        let role = if moves { Role::Body } else { Role::Fixed };
        // What single precision cannot tell from 1 scales nothing.
        let is_one = (node.scale - DVec3::ONE).abs().max_element() <= 8.0 * f64::from(f32::EPSILON);
        match solid(shape, if is_one { DVec3::ONE } else { node.scale }, role) {
            Ok(Some(Solid { shape, reach, replaced })) => {
                said.shape = Some((shape, reach));
                replaced.into_iter().for_each(leave);
            }
            Ok(None) => match shape["type"].as_str() {
                Some("convex") => said.is_hull = true,
                Some("trimesh" | "mesh") => {}
                _ => leave(format!("the shape {} of its collider: its mesh is used instead", shape["type"])),
            },
            Err(why) => leave(format!("the shape {} of its collider: {why}; its mesh is used instead", shape["type"])),
        }
    }

    fn contact(&self, index: u64, leave: &mut impl FnMut(String)) -> Contact {
        let found = usize::try_from(index).ok().and_then(|index| self.materials.get(index));
        if found.is_none() {
            let count = self.materials.len();
            leave(format!("the material {index} of its collider: the file has {count}, counted from 0"));
        }
        let material = found.unwrap_or(&Value::Null);
        let value = |key: &str, usual: f64| material[key].as_f64().unwrap_or(usual);
        // Of the draft: 0.6 both, and no restitution.
        let friction = value("dynamicFriction", 0.6);
        let grip = value("staticFriction", 0.6_f64.max(friction));
        if grip < friction {
            leave(format!(
                "its static friction, {}, which is below that of sliding, {}: the latter is used for both",
                number(grip),
                number(friction)
            ));
        }
        let rules = ["frictionCombine", "restitutionCombine"].map(|key| match material[key].as_str() {
            None => Rule::Unsaid,
            Some(name) => Rule::named(name).unwrap_or_else(|| {
                leave(format!("{key} of its material: {name:?} is none of average, minimum, maximum and multiply"));
                Rule::Unsaid
            }),
        });
        let [friction, grip] = [friction, grip.max(friction)].map(|one| one.clamp(0.0, 1e3));
        Contact { values: [friction, value("restitution", 0.0).clamp(0.0, 1.0), grip], rules }
    }
}

/// What the motion of a node says.
fn motion(motion: &Value, node: &Node, said: &mut Said, leave: &mut impl FnMut(String)) {
    let Some(motion) = motion.as_object() else { return };
    let kinematic = motion.get("isKinematic").and_then(Value::as_bool).unwrap_or(false);
    said.moves = Some(if kinematic { Role::Driven } else { Role::Body });
    // In the file no number is infinite: 0 stands for that.
    let infinite = |number: f64| if number == 0.0 { f64::INFINITY } else { number };
    said.mass = motion.get("mass").and_then(Value::as_f64).map(infinite);
    if said.mass.is_some_and(|mass| mass < 0.0) {
        leave("its mass, which is negative: it follows from shape and density".into());
        said.mass = None;
    }
    // Along the node's own axes.
    let along = |key: &str| motion.get(key).and_then(vector).map_or(DVec3::ZERO, place);
    let turn = rotation(node.turn);
    (said.velocity, said.spin) = (turn * along("linearVelocity"), turn * along("angularVelocity"));
    for (vector, key, factor) in [(said.velocity, "velocity_m_s", 1.0), (said.spin, "spin_deg_s", 180.0 / PI)] {
        if vector != DVec3::ZERO {
            let along = (vector * factor).to_array().map(number).join(", ");
            said.lines.push(format!("{key} = [{along}]"));
        }
    }
    if let Some(factor) = motion.get("gravityFactor").and_then(Value::as_f64).filter(|factor| *factor != 1.0) {
        said.lines.push(format!("gravity_scale = {}", number(factor)));
    }
    said.inertia.centre = motion.get("centerOfMass").and_then(vector).map(|at| place(at * node.scale));
    if let Some(moments) = motion.get("inertiaDiagonal").and_then(vector) {
        let turn = motion.get("inertiaOrientation").and_then(quaternion).unwrap_or(DQuat::IDENTITY);
        let moments = DVec3::new(moments.x, moments.z, moments.y);
        said.inertia.moments = Some((DVec3::from_array(moments.to_array().map(infinite)), rotation(turn)));
    }
    let known = [
        "isKinematic",
        "mass",
        "linearVelocity",
        "angularVelocity",
        "gravityFactor",
        "centerOfMass",
        "inertiaDiagonal",
        "inertiaOrientation",
    ];
    for key in motion.keys().filter(|key| !known.contains(&key.as_str())) {
        leave(format!("{key} of its motion, which is not known"));
    }
}

/// A rotation.
fn quaternion(value: &Value) -> Option<DQuat> {
    let list = value.as_array().filter(|list| list.len() == 4)?;
    let number = |k: usize| list[k].as_f64();
    let turn = DQuat::from_vec4(DVec4::new(number(0)?, number(1)?, number(2)?, number(3)?));
    (turn.length() > 1e-6).then(|| turn.normalize())
}
