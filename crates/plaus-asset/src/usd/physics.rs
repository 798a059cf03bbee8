//! What UsdPhysics says of prims: bodies, colliders, masses and materials.

use super::axes::Axes;
use super::forms;
use super::scene::Scene;
use crate::AssetError;
use glam::{DQuat, DVec3};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// In m/s²; the value of a gravity that is not said.
const GRAVITY: f64 = 9.81;

/// A body that moves by itself.
#[derive(Debug, Clone, Default)]
pub(super) struct Body {
    pub(super) is_kinematic: bool,
    /// In m/s and radians per second, y up, along the axes of the file, or its own.
    pub(super) velocity: DVec3,
    pub(super) spin: DVec3,
    pub(super) is_local: bool,
}

/// What says where mass is, of a body or a collider.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Mass {
    /// In kg, and in kg/m³.
    pub(super) mass: Option<f64>,
    pub(super) density: Option<f64>,
    /// Along the prim's own axes, without its scale.
    pub(super) centre: Option<DVec3>,
    /// Principal moments, and how their axes are turned, in kg m².
    pub(super) moments: Option<(DVec3, DQuat)>,
}

/// All of a stage.
#[derive(Debug)]
pub(super) struct Physics {
    axes: Axes,
    pub(super) bodies: BTreeMap<usize, Body>,
    pub(super) masses: BTreeMap<usize, Mass>,
    /// The colliders, each with its approximation.
    pub(super) colliders: BTreeMap<usize, String>,
    /// Physics materials as a GLB has them, and their densities.
    pub(super) materials: Vec<Value>,
    densities: Vec<Option<f64>>,
    by_path: BTreeMap<String, usize>,
    pub(super) gravity: Option<DVec3>,
    pub(super) left_out: Vec<String>,
}

impl Physics {
    pub(super) fn read(scene: &Scene, axes: &Axes) -> Result<Self, AssetError> {
        let mut all = Self {
            axes: *axes,
            bodies: BTreeMap::new(),
            masses: BTreeMap::new(),
            colliders: BTreeMap::new(),
            materials: Vec::new(),
            densities: Vec::new(),
            by_path: BTreeMap::new(),
            gravity: None,
            left_out: Vec::new(),
        };
        for (index, prim) in scene.prims.iter().enumerate() {
            if prim.kind == "PhysicsScene" {
                all.scene(scene, index, axes)?;
            }
            if prim.has_api("PhysicsRigidBodyAPI") && scene.is(index, "physics:rigidBodyEnabled", true)? {
                all.body(scene, index, axes)?;
            }
            if prim.has_api("PhysicsMassAPI") {
                all.masses.insert(index, mass(scene, index, axes)?);
            }
            if prim.has_api("PhysicsCollisionAPI") && scene.is(index, "physics:collisionEnabled", true)? {
                if forms::is_form(&prim.kind) {
                    let approximation = scene.word(index, "physics:approximation")?;
                    all.colliders.insert(index, approximation.unwrap_or_else(|| "none".into()));
                } else {
                    let kind = if prim.kind.is_empty() { "prim without a type" } else { &prim.kind };
                    all.left_out.push(format!("{}: its collider: a {kind} has no shape that is read", prim.path));
                }
            }
        }
        Ok(all)
    }

    fn scene(&mut self, scene: &Scene, prim: usize, axes: &Axes) -> Result<(), AssetError> {
        if self.gravity.is_some() {
            let path = &scene.prims[prim].path;
            self.left_out.push(format!("{path}: a second physics scene: the first has the gravity of all"));
            return Ok(());
        }
        let down = scene.vector(prim, "physics:gravityDirection")?.and_then(DVec3::try_normalize);
        let magnitude = scene.number(prim, "physics:gravityMagnitude")?;
        let usual = |said: &f64| said.is_finite() && *said >= 0.0;
        let magnitude = magnitude.filter(usual).map_or(GRAVITY, |said| said * axes.length);
        self.gravity = Some(magnitude * axes.direction(down.unwrap_or(-axes.up())));
        Ok(())
    }

    fn body(&mut self, scene: &Scene, prim: usize, axes: &Axes) -> Result<(), AssetError> {
        let vector = |name: &str| Ok::<_, AssetError>(scene.vector(prim, name)?.unwrap_or(DVec3::ZERO));
        let velocity = axes.place(vector("physics:velocity")?);
        let spin = axes.direction(vector("physics:angularVelocity")?) * 1_f64.to_radians();
        let is_local = scene.is(prim, "physics:localSpaceVelocities", false)?;
        let is_kinematic = scene.is(prim, "physics:kinematicEnabled", false)?;
        if scene.is(prim, "physics:startsAsleep", false)? {
            self.left_out.push(format!("{}: that it starts asleep: it is awake", scene.prims[prim].path));
        }
        self.bodies.insert(prim, Body { is_kinematic, velocity, spin, is_local });
        Ok(())
    }

    /// The body that moves a prim: the nearest of itself and those above it.
    pub(super) fn owner(&self, scene: &Scene, prim: usize) -> Option<usize> {
        scene.above(prim).find(|above| self.bodies.contains_key(above))
    }

    /// What a collider weighs: its mass in kg, or its density in kg/m³; nothing if both are as usual.
    pub(super) fn weight(&mut self, scene: &Scene, prim: usize) -> Result<Map<String, Value>, AssetError> {
        let Some(body) = self.owner(scene, prim) else { return Ok(Map::new()) };
        let mass = self.masses.get(&prim).and_then(|own| own.mass).filter(|_| prim != body);
        let inside = scene.above(prim).take_while(|&at| at != body).chain([body]);
        let said = inside.filter_map(|at| self.masses.get(&at)?.density).next();
        let density = match said {
            Some(density) => Some(density),
            None => self.material(scene, prim)?.and_then(|material| self.densities[material]),
        };
        let mut weight = Map::new();
        if let Some(mass) = mass {
            weight.insert("mass".into(), mass.into());
        } else if let Some(density) = density {
            weight.insert("density".into(), density.into());
        }
        Ok(weight)
    }

    /// The index of the physics material of a collider, if it has one: of those bound for physics before all others.
    pub(super) fn material(&mut self, scene: &Scene, prim: usize) -> Result<Option<usize>, AssetError> {
        for purpose in ["material:binding:physics", "material:binding"] {
            let Some(path) = bound(scene, prim, purpose)? else { continue };
            if let Some(known) = self.by_path.get(&path) {
                return Ok(Some(*known));
            }
            if let Some(found) = scene.at(&path).filter(|&at| scene.prims[at].has_api("PhysicsMaterialAPI")) {
                let index = self.materials.len();
                let (material, density) = material(scene, found, &self.axes)?;
                self.materials.push(material);
                self.densities.push(density);
                self.by_path.insert(path, index);
                return Ok(Some(index));
            }
        }
        Ok(None)
    }
}

/// The path of what is bound to a prim for a purpose: by the nearest of itself and those above it, or the topmost that
/// binds more strongly than those below it.
pub(super) fn bound(scene: &Scene, prim: usize, purpose: &str) -> Result<Option<String>, AssetError> {
    let mut found = None;
    for above in scene.above(prim) {
        let Some(path) = scene.targets(above, purpose)?.into_iter().next() else { continue };
        let strength = scene.said_of(above, purpose, "bindMaterialAs");
        if found.is_none() || strength.as_deref() == Some("strongerThanDescendants") {
            found = Some(path);
        }
    }
    Ok(found)
}

fn material(scene: &Scene, prim: usize, axes: &Axes) -> Result<(Value, Option<f64>), AssetError> {
    let amount = |name: &str| {
        let said = scene.number(prim, name)?.unwrap_or(0.0);
        if said.is_finite() && said >= 0.0 {
            Ok(said)
        } else {
            Err(scene.prims[prim].wrong(format!("{name} is {said}, and must be 0 or more")))
        }
    };
    let mut said = json!({
        "staticFriction": amount("physics:staticFriction")?,
        "dynamicFriction": amount("physics:dynamicFriction")?,
        "restitution": amount("physics:restitution")?,
    });
    // Of the extension of PhysX, which has a word for it.
    let combine = [
        ("frictionCombine", "physxMaterial:frictionCombineMode"),
        ("restitutionCombine", "physxMaterial:restitutionCombineMode"),
    ];
    for (key, name) in combine {
        let rule = match scene.word(prim, name)?.as_deref() {
            Some("average") => "average",
            Some("min") => "minimum",
            Some("max") => "maximum",
            Some("multiply") => "multiply",
            _ => continue,
        };
        said[key] = rule.into();
    }
    let density = amount("physics:density")? * axes.mass / axes.length / axes.length / axes.length;
    Ok((said, Some(density).filter(|density| *density > 0.0)))
}

fn mass(scene: &Scene, prim: usize, axes: &Axes) -> Result<Mass, AssetError> {
    let amount = |name: &str| -> Result<Option<f64>, AssetError> {
        match scene.number(prim, name)? {
            Some(said) if said < 0.0 || said.is_infinite() => {
                Err(scene.prims[prim].wrong(format!("{name} is {said}, and must be 0 or more")))
            }
            said => Ok(said.filter(|said| *said > 0.0)),
        }
    };
    let area = axes.length * axes.length;
    let moments = scene.vector(prim, "physics:diagonalInertia")?.filter(|moments| *moments != DVec3::ZERO);
    let turn = axes.turn(scene.turn(prim, "physics:principalAxes")?.unwrap_or(DQuat::IDENTITY));
    Ok(Mass {
        mass: amount("physics:mass")?.map(|mass| mass * axes.mass),
        density: amount("physics:density")?.map(|density| density * axes.mass / (area * axes.length)),
        centre: scene.vector(prim, "physics:centerOfMass")?.map(|at| axes.place(at)),
        moments: moments.map(|moments| (axes.sizes(moments) * axes.mass * area, turn)),
    })
}
