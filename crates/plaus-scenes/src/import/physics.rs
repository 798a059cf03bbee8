//! The extension `KHR_physics_rigid_bodies`, a draft whose spelling has changed: both are read.
//!
//! Shapes are in `KHR_implicit_shapes`, formerly `KHR_collision_shapes`; a collider names one by `geometry.shape`,
//! formerly `shape`.

use super::things::{Role, Shape};
use super::write::{number, place, rotation};
use glam::DVec3;
use plaus_asset::glb::{Glb, Node};
use serde_json::Value;
use std::f64::consts::PI;

/// The extension's name.
pub(super) const BODIES: &str = "KHR_physics_rigid_bodies";

/// Names of the extension that shapes stand in, the present one first.
const SHAPES: [&str; 2] = ["KHR_implicit_shapes", "KHR_collision_shapes"];

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
    /// Its shape, where that is not its mesh.
    pub(super) shape: Option<Shape>,
    /// Whether its mesh stands for its convex hull.
    pub(super) is_hull: bool,
    /// In kg.
    pub(super) mass: Option<f64>,
    /// Friction and restitution.
    pub(super) contact: Option<[f64; 2]>,
    /// Keys of a body, as lines of TOML.
    pub(super) lines: Vec<String>,
}

impl Physics {
    pub(super) fn read(file: &Glb, left_out: &mut Vec<String>) -> Self {
        let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
        let shapes = SHAPES.iter().map(|name| list(&file.extension(name)["shapes"])).find(|shapes| !shapes.is_empty());
        let bodies = file.extension(BODIES);
        for key in ["collisionFilters", "physicsJoints"] {
            if bodies[key].as_array().is_some_and(|list| !list.is_empty()) {
                left_out.push(format!("{key} of {BODIES}"));
            }
        }
        Self { shapes: shapes.unwrap_or_default(), materials: list(&bodies["physicsMaterials"]) }
    }

    /// What is said of a node.
    pub(super) fn of(&self, node: &Node, left_out: &mut Vec<String>) -> Said {
        let bodies = &node.extensions[BODIES];
        let mut said = Said::default();
        let mut leave = |what: String| left_out.push(format!("{}: {what}", node.name));
        for key in ["joint", "trigger"] {
            if !bodies[key].is_null() {
                leave(format!("its {key}"));
            }
        }
        if let Some(motion) = bodies["motion"].as_object() {
            let kinematic = motion.get("isKinematic").and_then(Value::as_bool).unwrap_or(false);
            said.moves = Some(if kinematic { Role::Driven } else { Role::Body });
            said.mass = motion.get("mass").and_then(Value::as_f64).filter(|mass| *mass > 0.0);
            for (key, ours, factor) in
                [("linearVelocity", "velocity_m_s", 1.0), ("angularVelocity", "spin_deg_s", 180.0 / PI)]
            {
                // Along the node's own axes.
                if let Some(vector) = motion.get(key).and_then(vector).filter(|vector| *vector != DVec3::ZERO) {
                    let along = (rotation(node.turn) * place(vector) * factor).to_array().map(number).join(", ");
                    said.lines.push(format!("{ours} = [{along}]"));
                }
            }
            if let Some(factor) = motion.get("gravityFactor").and_then(Value::as_f64).filter(|factor| *factor != 1.0) {
                said.lines.push(format!("gravity_scale = {}", number(factor)));
            }
            let known = ["isKinematic", "mass", "linearVelocity", "angularVelocity", "gravityFactor"];
            for key in motion.keys().filter(|key| !known.contains(&key.as_str())) {
                leave(format!("{key} of its motion: computed from shape and density instead"));
            }
        }
        let collider = &bodies["collider"];
        if collider.is_null() {
            return said;
        }
        said.collides = true;
        if !collider["collisionFilter"].is_null() {
            leave("the filter of its collider: here everything can touch everything".into());
        }
        let geometry = if collider["geometry"].is_object() { &collider["geometry"] } else { collider };
        said.is_hull = geometry["convexHull"].as_bool().unwrap_or(false);
        if let Some(index) = geometry["shape"].as_u64() {
            match self.shapes.get(index as usize).map(|shape| (shape, solid(shape, node.scale))) {
                Some((_, Some(shape))) => said.shape = Some(shape),
                Some((shape, None)) if matches!(shape["type"].as_str(), Some("convex")) => said.is_hull = true,
                Some((shape, None)) if matches!(shape["type"].as_str(), Some("trimesh" | "mesh")) => {}
                Some((shape, None)) => {
                    leave(format!("the shape {} of its collider: its mesh is used instead", shape["type"]))
                }
                None => leave(format!("the shape {index} of its collider: the file does not contain it")),
            }
        } else if !geometry["node"].is_null() || !geometry["mesh"].is_null() {
            leave("the mesh that its collider names: its own is used instead".into());
        }
        if let Some(index) = collider["physicsMaterial"].as_u64() {
            let material = self.materials.get(index as usize).unwrap_or(&Value::Null);
            let value = |key: &str, otherwise: f64| material[key].as_f64().unwrap_or(otherwise);
            // Of the draft: 0.6 both, and no restitution.
            let friction = value("dynamicFriction", 0.6);
            said.contact = Some([friction.clamp(0.0, 1e3), value("restitution", 0.0).clamp(0.0, 1.0)]);
            if value("staticFriction", friction) != friction {
                leave("its static friction: the coefficient for sliding is used for both".into());
            }
            for key in ["frictionCombine", "restitutionCombine"] {
                if !material[key].is_null() {
                    leave(format!("{key} of its material: geometric means are used"));
                }
            }
        }
        said
    }
}

/// Three numbers.
fn vector(value: &Value) -> Option<DVec3> {
    let list = value.as_array().filter(|list| list.len() == 3)?;
    let number = |k: usize| list[k].as_f64();
    Some(DVec3::new(number(0)?, number(1)?, number(2)?))
}

/// A solid of the draft, in m and along y, as a scenario has it, along z; `None` for what is none, or is scaled
/// unevenly where it is round.
fn solid(shape: &Value, scale: DVec3) -> Option<Shape> {
    let kind = shape["type"].as_str()?;
    let size = |key: &str, otherwise: f64| shape[kind][key].as_f64().unwrap_or(otherwise);
    let mm = |metres: f64| number(metres * 1e3);
    let scale = scale.abs();
    let is_even = scale.max_element() - scale.min_element() <= 1e-4 * scale.max_element();
    if kind == "box" {
        let edges = vector(&shape[kind]["size"]).unwrap_or(DVec3::ONE) * scale;
        let said = format!("box = {{ size_mm = [{}, {}, {}] }}", mm(edges.x), mm(edges.z), mm(edges.y));
        return Some(Shape::Solid { said, volume: edges.element_product() });
    }
    let factor = scale.x;
    let radii = [size("radiusTop", 0.25), size("radiusBottom", 0.25)].map(|radius| radius * factor);
    let (height, wide) = (size("height", 0.5) * factor, radii[0].max(radii[1]));
    let is_straight = radii[0] == radii[1];
    let disc = PI * wide * wide;
    let (said, volume) = match kind {
        _ if !is_even => return None,
        "sphere" => {
            let radius = size("radius", 0.5) * factor;
            (format!("ball = {{ radius_mm = {} }}", mm(radius)), 4.0 / 3.0 * PI * radius * radius * radius)
        }
        "cylinder" if is_straight => {
            (format!("cylinder = {{ radius_mm = {}, height_mm = {} }}", mm(wide), mm(height)), disc * height)
        }
        "cylinder" if radii[0] == 0.0 => {
            (format!("cone = {{ radius_mm = {}, height_mm = {} }}", mm(wide), mm(height)), disc * height / 3.0)
        }
        "capsule" if is_straight => {
            let said = format!("capsule = {{ radius_mm = {}, length_mm = {} }}", mm(wide), mm(height));
            (said, disc * (height + 4.0 / 3.0 * wide))
        }
        _ => return None,
    };
    Some(Shape::Solid { said, volume })
}
