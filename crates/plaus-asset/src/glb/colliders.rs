//! Meshes that the colliders of `KHR_physics_rigid_bodies` take from elsewhere: from another node with all below it, in
//! the scene or not, or from an entry of the list of meshes.

use super::{AssetError, Drawn, Glb, Object, Placed, matrix};
use crate::MOST_TRIANGLES;
use glam::DMat4;
use gltf::Document;
use serde_json::Value;
use std::collections::BTreeSet;

/// Where a collider takes its mesh from.
#[derive(Debug, Clone, Copy)]
enum Source {
    Node(usize),
    Mesh(usize),
}

/// Where the collider, or the trigger, of a node takes its mesh from, if that is not its own.
fn source(json: &Value, node: usize) -> Option<Source> {
    let geometry = &json["nodes"][node]["extensions"]["KHR_physics_rigid_bodies"]["collider"]["geometry"];
    let index = |key: &str| geometry[key].as_u64().and_then(|index| usize::try_from(index).ok());
    match (index("node"), index("mesh")) {
        (Some(other), _) => (other != node).then_some(Source::Node(other)),
        (None, Some(mesh)) => (json["nodes"][node]["mesh"].as_u64() != Some(mesh as u64)).then_some(Source::Mesh(mesh)),
        (None, None) => None,
    }
}

/// Names the objects that colliders take their meshes from: `cup_collider` for that of `cup`.
pub(super) fn name_all(nodes: &mut [Placed], json: &Value, document: &Document) {
    let mut taken: BTreeSet<String> = nodes.iter().map(|node| node.name.clone()).collect();
    for placed in nodes {
        let exists = match source(json, placed.index) {
            Some(Source::Node(other)) => document.nodes().len() > other,
            Some(Source::Mesh(other)) => document.meshes().len() > other,
            None => false,
        };
        if !exists {
            continue;
        }
        let plain = format!("{}_collider", placed.name);
        let mut name = plain.clone();
        let mut count = 1;
        while !taken.insert(name.clone()) {
            count += 1;
            name = format!("{plain}_{count}");
        }
        placed.collider = Some(name);
    }
}

impl Glb {
    /// Adds the objects that colliders take their meshes from.
    pub(super) fn colliders(&self, objects: &mut Vec<Object>) -> Result<(), AssetError> {
        let mut total = 0;
        for placed in &self.nodes {
            let (Some(name), Some(source)) = (&placed.collider, source(&self.json, placed.index)) else { continue };
            let mut drawn = Drawn::default();
            match source {
                Source::Node(other) => self.below(other, &mut drawn, name)?,
                Source::Mesh(other) => {
                    if let Some(mesh) = self.document.meshes().nth(other) {
                        drawn.add(&mesh, &DMat4::IDENTITY, self, name)?;
                    }
                }
            }
            total += drawn.faces.len();
            if total > MOST_TRIANGLES {
                return Err(AssetError::TooMany { triangles: total });
            }
            objects.push(Object { is_drawn: false, ..placed.object(name, drawn)? });
        }
        Ok(())
    }

    /// The triangles of a node and of all below it, along the node's axes.
    fn below(&self, node: usize, drawn: &mut Drawn, name: &str) -> Result<(), AssetError> {
        let mut seen = BTreeSet::new();
        let mut open: Vec<_> =
            self.document.nodes().nth(node).map(|node| (node, DMat4::IDENTITY)).into_iter().collect();
        while let Some((node, by)) = open.pop() {
            if !seen.insert(node.index()) {
                continue;
            }
            if let Some(mesh) = node.mesh() {
                drawn.add(&mesh, &by, self, name)?;
            }
            open.extend(node.children().map(|child| (child.clone(), by * matrix(&child))));
        }
        Ok(())
    }
}
