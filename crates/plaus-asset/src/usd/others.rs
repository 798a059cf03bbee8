//! What a stage says beyond what is read.

use super::build::Builder;
use std::collections::BTreeMap;

/// Beginnings of the names of attributes that may change how things move.
const ENGINES: [&str; 5] = ["physics:", "physx", "newton:", "mjc:", "omniphysics:"];

/// Attributes that are read, or have no bearing on motion: solver settings, for example.
const READ: [&str; 51] = [
    "physics:rigidBodyEnabled",
    "physics:kinematicEnabled",
    "physics:velocity",
    "physics:angularVelocity",
    "physics:localSpaceVelocities",
    "physics:startsAsleep",
    "physics:simulationOwner",
    "physics:collisionEnabled",
    "physics:approximation",
    "physics:mass",
    "physics:density",
    "physics:centerOfMass",
    "physics:diagonalInertia",
    "physics:principalAxes",
    "physics:staticFriction",
    "physics:dynamicFriction",
    "physics:restitution",
    "physics:gravityDirection",
    "physics:gravityMagnitude",
    "physics:body0",
    "physics:body1",
    "physics:localPos0",
    "physics:localPos1",
    "physics:localRot0",
    "physics:localRot1",
    "physics:axis",
    "physics:lowerLimit",
    "physics:upperLimit",
    "physics:coneAngle0Limit",
    "physics:coneAngle1Limit",
    "physics:minDistance",
    "physics:maxDistance",
    "physics:jointEnabled",
    "physics:breakForce",
    "physics:breakTorque",
    "physics:excludeFromArticulation",
    "physics:filteredPairs",
    "physics:filteredGroups",
    "physics:invertFilteredGroups",
    "physics:mergeGroup",
    "physxMaterial:frictionCombineMode",
    "physxMaterial:restitutionCombineMode",
    "physxMaterial:improvePatchFriction",
    "physxScene:",
    "physxArticulation:solver",
    "physxRigidBody:solver",
    "physxRigidBody:sleepThreshold",
    "physxRigidBody:stabilizationThreshold",
    "physxRigidBody:enableCCD",
    "physxCollision:contactOffset",
    "physxCookedData",
];

/// Most names in a message.
const SHOWN: usize = 4;

impl Builder<'_> {
    fn body_above(&self, prim: usize) -> Option<usize> {
        self.physics.owner(self.scene, prim)
    }

    /// What a prim says of mass that has no effect, as it is no body: of a body's collider, the mass has one.
    fn lost_mass(&self, prim: usize) -> Option<String> {
        let mass = self.physics.masses.get(&prim).filter(|_| !self.physics.bodies.contains_key(&prim))?;
        let counts = self.physics.colliders.contains_key(&prim) && self.body_above(prim).is_some();
        let list = [
            (mass.mass.is_some() && !counts, "its mass"),
            (mass.centre.is_some(), "its centre of mass"),
            (mass.moments.is_some(), "its inertia"),
        ];
        let lost: Vec<&str> = list.into_iter().filter(|(is_lost, _)| *is_lost).map(|(_, what)| what).collect();
        (!lost.is_empty()).then(|| lost.join(", "))
    }

    /// Tells what may change how things move and is not read, and what has no bearing on that.
    pub(super) fn others(&mut self) {
        let mut unread: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        let (mut harmless, mut left_out) = (Vec::new(), Vec::new());
        for (index, prim) in self.scene.prims.iter().enumerate() {
            for name in prim.properties() {
                let is_engine = ENGINES.iter().any(|begins| name.starts_with(begins));
                let is_read = READ
                    .iter()
                    .any(|known| if known.starts_with("physx") { name.starts_with(known) } else { name == *known });
                if is_engine && !is_read {
                    unread.entry(name).or_default().push(&prim.path);
                }
            }
            if prim.has("skel:skeleton") || prim.kind == "Skeleton" {
                left_out.push(format!("{}: its skin: it does not change", prim.path));
            }
            if prim.kind == "Camera" {
                harmless.push(format!("{}: its camera", prim.path));
            }
            if prim.kind.ends_with("Light") {
                harmless.push(format!("{}: its light", prim.path));
            }
            let by_collection = prim.properties().any(|name| name.starts_with("material:binding:collection"));
            if by_collection && !self.physics.colliders.is_empty() {
                left_out.push(format!("{}: materials that it binds to collections", prim.path));
            }
            if let Some(lost) = self.lost_mass(index) {
                let is_still = self.physics.colliders.contains_key(&index) && self.body_above(index).is_none();
                let list = if is_still { &mut harmless } else { &mut left_out };
                list.push(format!("{}: {lost}: it is no body", prim.path));
            }
            if self.scene.is_by_expression(index) {
                left_out.push(format!("{}: its collection, which an expression gives: it is empty", prim.path));
            }
        }
        let told = |(name, paths): (&str, Vec<&str>)| {
            let more = paths.len().saturating_sub(SHOWN);
            let more = if more > 0 { format!(" and {more} more") } else { String::new() };
            format!("{name} of {}{more}", paths[..paths.len().min(SHOWN)].join(", "))
        };
        self.left_out.extend(unread.into_iter().map(told));
        self.left_out.append(&mut left_out);
        self.harmless.append(&mut harmless);
    }
}
