//! Joints of UsdPhysics as those of a GLB: two frames, and what holds one in the other.

use super::axes::rigid;
use super::build::Builder;
use super::write::Node;
use crate::AssetError;
use glam::{DMat3, DMat4, DQuat, DVec3};
use serde_json::{Map, Value, json};

/// Kinds of joints, each with what it holds: of which axes, and what is free.
const KINDS: [&str; 6] = [
    "PhysicsFixedJoint",
    "PhysicsRevoluteJoint",
    "PhysicsPrismaticJoint",
    "PhysicsSphericalJoint",
    "PhysicsDistanceJoint",
    "PhysicsJoint",
];

/// Six axes, by the names that limits and drives have.
const AXES: [(&str, bool, usize); 6] = [
    ("transX", false, 0),
    ("transY", false, 1),
    ("transZ", false, 2),
    ("rotX", true, 0),
    ("rotY", true, 1),
    ("rotZ", true, 2),
];

/// A limit of some axes, in m or radians.
fn limit(turns: bool, axes: &[usize], [low, high]: [f64; 2]) -> Option<Value> {
    let mut said = Map::new();
    said.insert(if turns { "angularAxes" } else { "linearAxes" }.into(), json!(axes));
    for (key, end) in [("min", low), ("max", high)] {
        if end.is_finite() {
            said.insert(key.into(), end.into());
        }
    }
    (said.len() > 1).then(|| said.into())
}

impl Builder<'_> {
    /// Adds the joints.
    pub(super) fn joints(&mut self) -> Result<(), AssetError> {
        let mut all = Vec::new();
        for prim in 0..self.scene.prims.len() {
            if KINDS.contains(&self.scene.prims[prim].kind.as_str()) {
                self.joint(prim, &mut all)?;
            }
        }
        self.file.bodies.insert("physicsJoints".into(), all.into());
        Ok(())
    }

    fn joint(&mut self, prim: usize, all: &mut Vec<Value>) -> Result<(), AssetError> {
        let (scene, own) = (self.scene, &self.scene.prims[prim]);
        if !scene.is(prim, "physics:jointEnabled", true)? {
            self.harmless.push(format!("{}: its joint, which is not enabled", own.path));
            return Ok(());
        }
        for (name, what) in [("physics:breakForce", "force"), ("physics:breakTorque", "torque")] {
            if let Some(most) = scene.number(prim, name)?.filter(|most| most.is_finite()) {
                let text = format!("{}: that a {what} of more than {most} breaks it: it never breaks", own.path);
                self.left_out.push(text);
            }
        }
        let mut frames = Vec::new();
        for end in ["0", "1"] {
            match self.frame(prim, end)? {
                Some(frame) => frames.push(frame),
                None => return Ok(()),
            }
        }
        let limits = self.limits(prim)?;
        let drives = self.drives(prim)?;
        let first = self.file.nodes.len();
        for (nth, (parent, at, turn)) in frames.into_iter().enumerate() {
            let name = if nth == 0 { own.name.clone() } else { format!("{}_to", own.name) };
            self.file.nodes.push(Node { name, parent, at, turn, scale: DVec3::ONE, ..Node::default() });
        }
        let touches = scene.is(prim, "physics:collisionEnabled", false)?;
        let said = json!({ "connectedNode": first + 1, "joint": all.len(), "enableCollision": touches });
        self.file.nodes[first].bodies.insert("joint".into(), said);
        all.push(json!({ "limits": limits, "drives": drives }));
        Ok(())
    }

    /// The frame at an end of a joint: the node that it belongs to, where it is, and how it is turned: its axes are
    /// those that the joint names. None, which is told, if it belongs to nothing that there is.
    fn frame(&mut self, prim: usize, end: &str) -> Result<Option<(Option<usize>, DVec3, DQuat)>, AssetError> {
        let scene = self.scene;
        let body = scene.targets(prim, &format!("physics:body{end}"))?.into_iter().next();
        let (world, parent) = match body {
            None => (DMat4::IDENTITY, None),
            Some(path) => {
                let Some(at) = scene.at(&path) else {
                    let own = &scene.prims[prim].path;
                    self.left_out.push(format!("{own}: its joint: there is no {path}: it holds nothing"));
                    return Ok(None);
                };
                let parent = scene.above(at).find_map(|above| self.nodes.get(&above).copied());
                (self.places.world(at, self.places.start), parent)
            }
        };
        let at = scene.vector(prim, &format!("physics:localPos{end}"))?.unwrap_or(DVec3::ZERO);
        let turn = scene.turn(prim, &format!("physics:localRot{end}"))?.unwrap_or(DQuat::IDENTITY);
        let columns = DVec3::AXES.map(|axis| self.axes.direction(axis));
        let upright = DQuat::from_mat3(&DMat3::from_cols(columns[0], columns[1], columns[2]));
        let turn = (upright * rigid(&world).1 * turn).normalize();
        Ok(Some((parent, self.axes.place(world.transform_point3(at)), turn)))
    }

    fn limits(&self, prim: usize) -> Result<Vec<Value>, AssetError> {
        let scene = self.scene;
        let length = self.axes.length;
        let axis = self.named_axis(prim)?;
        let others: Vec<usize> = (0..3).filter(|&other| other != axis).collect();
        let range = |turns: bool, low: &str, high: &str| -> Result<[f64; 2], AssetError> {
            let unit = if turns { 1_f64.to_radians() } else { length };
            let low = scene.number(prim, low)?.unwrap_or(f64::NEG_INFINITY) * unit;
            let high = scene.number(prim, high)?.unwrap_or(f64::INFINITY) * unit;
            // What is below and above nothing is locked.
            Ok(if low > high { [0.0; 2] } else { [low, high] })
        };
        let held = |turns: bool, axes: &[usize]| limit(turns, axes, [0.0; 2]);
        let own = |turns: bool| {
            let ends = range(turns, "physics:lowerLimit", "physics:upperLimit")?;
            Ok::<_, AssetError>(limit(turns, &[axis], ends))
        };
        let mut all = Vec::new();
        match scene.prims[prim].kind.as_str() {
            "PhysicsFixedJoint" => all.extend([held(false, &[0, 1, 2]), held(true, &[0, 1, 2])]),
            "PhysicsRevoluteJoint" => all.extend([held(false, &[0, 1, 2]), held(true, &others), own(true)?]),
            "PhysicsPrismaticJoint" => all.extend([held(false, &others), held(true, &[0, 1, 2]), own(false)?]),
            "PhysicsSphericalJoint" => {
                all.push(held(false, &[0, 1, 2]));
                // The first tilts it towards the next axis, and so turns about the one after.
                let cone = [("physics:coneAngle0Limit", (axis + 2) % 3), ("physics:coneAngle1Limit", (axis + 1) % 3)];
                for (name, other) in cone {
                    let most = scene.number(prim, name)?.filter(|most| *most >= 0.0 && most.is_finite());
                    all.push(most.and_then(|most| limit(true, &[other], [-most.to_radians(), most.to_radians()])));
                }
            }
            "PhysicsDistanceJoint" => {
                let end = |name: &str, usual: f64| -> Result<f64, AssetError> {
                    Ok(scene.number(prim, name)?.filter(|end| *end >= 0.0).map_or(usual, |end| end * length))
                };
                let ends = [end("physics:minDistance", f64::NEG_INFINITY)?, end("physics:maxDistance", f64::INFINITY)?];
                all.push(limit(false, &[0, 1, 2], ends));
            }
            _ => {}
        }
        for name in scene.prims[prim].api_names("PhysicsLimitAPI") {
            let known = AXES.iter().find(|(known, ..)| *known == name);
            let turns = known.is_some_and(|(_, turns, _)| *turns);
            let ends = range(turns, &format!("limit:{name}:physics:low"), &format!("limit:{name}:physics:high"))?;
            match (known, name) {
                (Some((_, turns, axis)), _) => all.push(limit(*turns, &[*axis], ends)),
                (None, "distance") => all.push(limit(false, &[0, 1, 2], ends)),
                _ => {}
            }
        }
        Ok(all.into_iter().flatten().collect())
    }

    fn named_axis(&self, prim: usize) -> Result<usize, AssetError> {
        let axis = self.scene.word(prim, "physics:axis")?.unwrap_or_else(|| "X".into());
        let found = ["X", "Y", "Z"].iter().position(|known| *known == axis);
        found.ok_or_else(|| self.scene.prims[prim].wrong(format!("physics:axis is {axis:?}: X, Y or Z is needed")))
    }

    fn drives(&self, prim: usize) -> Result<Vec<Value>, AssetError> {
        let (scene, own) = (self.scene, &self.scene.prims[prim]);
        let mut all = Vec::new();
        for name in own.api_names("PhysicsDriveAPI") {
            let (turns, axis) = match AXES.iter().find(|(known, ..)| *known == name) {
                Some((_, turns, axis)) => (*turns, Some(*axis)),
                None => (name == "angular", Some(self.named_axis(prim)?).filter(|_| name != "distance")),
            };
            let number = |what: &str| -> Result<Option<f64>, AssetError> {
                Ok(scene.number(prim, &format!("drive:{name}:physics:{what}"))?.filter(|number| number.is_finite()))
            };
            let is_acceleration =
                scene.word(prim, &format!("drive:{name}:physics:type"))?.as_deref() == Some("acceleration");
            // Of a force, or a torque; per degree it is per so many radians.
            let whole = self.axes.mass * if turns { self.axes.length * self.axes.length } else { 1.0 };
            let force = if is_acceleration { 1.0 } else { whole };
            let unit = if turns { 1_f64.to_radians() } else { 1.0 };
            let way = if turns { unit } else { self.axes.length };
            let mut said = json!({ "type": if turns { "angular" } else { "linear" } });
            said["mode"] = if is_acceleration { "acceleration" } else { "force" }.into();
            if let Some(axis) = axis {
                said["axis"] = axis.into();
            }
            let most = if turns { whole } else { whole * self.axes.length };
            let list = [
                ("stiffness", "stiffness", force / unit),
                ("damping", "damping", force / unit),
                ("targetPosition", "positionTarget", way),
                ("targetVelocity", "velocityTarget", way),
                ("maxForce", "maxForce", most),
            ];
            let mut acts = false;
            for (what, key, factor) in list {
                if let Some(value) = number(what)? {
                    said[key] = (value * factor).into();
                    acts |= value != 0.0 && matches!(key, "stiffness" | "damping");
                }
            }
            if acts {
                all.push(said);
            }
        }
        Ok(all)
    }
}
