//! The nodes of a stage: what is seen and touched of it, where it is, and how it moves.

use super::axes::{Axes, rigid};
use super::forms::{Form, Mesh, around, ends, form, is_form, is_other_form};
use super::looks::Looks;
use super::physics::Physics;
use super::place::Places;
use super::scene::Scene;
use super::write::{File, Node};
use crate::glb::{Key, OFF, straight};
use crate::{AssetError, MOST_TRIANGLES};
use glam::{DQuat, DVec3};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// The least height of a box, as a share of its largest edge, that is not flat.
const FLAT: f64 = 1e-6;

/// A stage on its way to a file.
pub(super) struct Builder<'a> {
    pub(super) scene: &'a Scene,
    pub(super) axes: &'a Axes,
    pub(super) places: &'a Places,
    pub(super) physics: Physics,
    looks: Looks,
    /// The shapes that are read.
    forms: BTreeMap<usize, Form>,
    /// What follows keyframes.
    keyed: BTreeMap<usize, Vec<Key>>,
    /// The node of each prim that has one.
    pub(super) nodes: BTreeMap<usize, usize>,
    pub(super) file: File,
    pub(super) left_out: Vec<String>,
    pub(super) harmless: Vec<String>,
}

impl<'a> Builder<'a> {
    pub(super) fn new(scene: &'a Scene, axes: &'a Axes, places: &'a Places) -> Result<Self, AssetError> {
        let mut physics = Physics::read(scene, axes)?;
        let left_out = std::mem::take(&mut physics.left_out);
        Ok(Self {
            scene,
            axes,
            places,
            physics,
            looks: Looks::default(),
            forms: BTreeMap::new(),
            keyed: BTreeMap::new(),
            nodes: BTreeMap::new(),
            file: File::default(),
            left_out,
            harmless: Vec::new(),
        })
    }

    fn leave(&mut self, prim: usize, what: impl std::fmt::Display) {
        self.left_out.push(format!("{}: {what}", self.scene.prims[prim].path));
    }

    /// Reads the shapes: colliders, and what is seen if nothing is a body.
    pub(super) fn shapes(&mut self) -> Result<(), AssetError> {
        let is_simulated = !self.physics.bodies.is_empty() && !self.physics.colliders.is_empty();
        let (mut unseen, mut seen, mut triangles) = (0, 0, 0);
        for prim in 0..self.scene.prims.len() {
            let own = &self.scene.prims[prim];
            let collides = self.physics.colliders.contains_key(&prim);
            if is_other_form(&own.kind) {
                let what = format!("its shape, a {}", own.kind);
                match is_simulated {
                    true => self.harmless.push(format!("{}: {what}, which nothing can touch", own.path)),
                    false => self.leave(prim, what),
                }
            }
            if !is_form(&own.kind) {
                continue;
            }
            if !collides && is_simulated {
                seen += 1;
                continue;
            }
            if !collides && !self.is_seen(prim)? {
                unseen += 1;
                continue;
            }
            if own.kind == "Mesh" && self.scene.varies(prim, "points") {
                self.leave(prim, "that its points move: they stay as they begin");
            }
            let (_, _, rest) = rigid(&self.axes.matrix(&self.places.world(prim, self.places.start)));
            // What moves is no endless plane.
            let is_solid = collides && (own.kind != "Plane" || self.physics.owner(self.scene, prim).is_none());
            match form(self.scene, prim, self.axes, &rest, is_solid)? {
                None => self.leave(prim, "its shape, which is empty, or has a scale of 0"),
                Some(form) => {
                    let size = |(corners, faces): &Mesh| faces.len().max(corners.len() / 3);
                    triangles += form.mesh.as_ref().map_or(0, size);
                    if triangles > MOST_TRIANGLES {
                        return Err(AssetError::TooMany { triangles });
                    }
                    let form = self.approximated(prim, form);
                    self.forms.insert(prim, form);
                }
            }
        }
        for (count, what) in [(seen, "that nothing can touch"), (unseen, "that are invisible, guides or proxies")] {
            if count > 0 {
                self.harmless.push(format!("{count} shape{} {what}", if count == 1 { "" } else { "s" }));
            }
        }
        Ok(())
    }

    /// The shape of a collider as its approximation has it.
    fn approximated(&mut self, prim: usize, form: Form) -> Form {
        let Some(mesh) = &form.mesh else { return form };
        match self.physics.colliders.get(&prim).map(String::as_str) {
            Some("boundingCube") => {
                let (low, high) = ends(mesh);
                if (high - low).min_element() > FLAT * (high - low).max_element() {
                    return around(mesh, false);
                }
                self.leave(prim, "the box around its mesh, which is flat: its own triangles are used");
                form
            }
            Some("boundingSphere") => around(mesh, true),
            Some("meshSimplification") => {
                self.leave(prim, "the simplification of its mesh: its own triangles are used");
                form
            }
            None | Some("none" | "convexHull" | "convexDecomposition" | "sdf") => form,
            Some(other) => {
                let what = format!("its approximation {other:?}, which is not known: its own triangles are used");
                self.leave(prim, what);
                form
            }
        }
    }

    /// Whether something is drawn in a final picture.
    fn is_seen(&self, prim: usize) -> Result<bool, AssetError> {
        let mut purpose = None;
        for above in self.scene.above(prim) {
            if self.scene.word(above, "visibility")?.as_deref() == Some("invisible") {
                return Ok(false);
            }
            purpose = match purpose {
                None => self.scene.word(above, "purpose")?,
                said => said,
            };
        }
        Ok(!matches!(purpose.as_deref(), Some("guide" | "proxy")))
    }

    /// What moves a shape: a body, or the nearest that follows time samples.
    fn mover(&self, prim: usize) -> Option<usize> {
        self.scene.above(prim).find(|&at| self.physics.bodies.contains_key(&at) || self.places.moves_itself(at))
    }

    /// Reads what follows time samples.
    pub(super) fn motions(&mut self) -> Result<(), AssetError> {
        // How far what each moves reaches from its place.
        let mut reach: BTreeMap<usize, f64> = BTreeMap::new();
        let at = |prim: usize| self.axes.place(self.places.world(prim, self.places.start).w_axis.truncate());
        for (&prim, form) in &self.forms {
            if let Some(mover) = self.mover(prim) {
                let far = at(prim).distance(at(mover)) + form.reach;
                let known = reach.entry(mover).or_default();
                *known = known.max(far);
            }
        }
        let bodies: Vec<usize> = self.physics.bodies.keys().copied().collect();
        for (mover, reach) in reach {
            let body = self.physics.owner(self.scene, mover);
            let is_free = body.is_some_and(|body| !self.physics.bodies[&body].is_kinematic);
            if !self.places.moves(mover) {
                continue;
            }
            match body {
                Some(body) if is_free && body != mover => {
                    self.leave(mover, "its time samples: it is part of a body, which moves freely");
                }
                _ if is_free => self.leave(mover, "its time samples: it moves freely, from where it starts"),
                _ => self.follow(mover, reach)?,
            }
        }
        for prim in bodies.into_iter().chain(self.forms.keys().copied().collect::<Vec<_>>()) {
            if self.scene.varies(prim, "visibility") {
                self.leave(prim, "that it becomes visible, or invisible: it is there from start to end");
            }
        }
        Ok(())
    }

    fn follow(&mut self, prim: usize, reach: f64) -> Result<(), AssetError> {
        let (start, per_second) = (self.places.start, self.scene.per_second);
        let end = self.scene.end.filter(|end| *end > start).unwrap_or(f64::INFINITY);
        let mut times = self.places.times(prim);
        times.retain(|&time| time > start && time < end);
        let last = self.places.times(prim).last().copied().unwrap_or(start).min(end);
        let codes: Vec<f64> = [start].into_iter().chain(times).chain((last > start).then_some(last)).collect();
        let (axes, places) = (self.axes, self.places);
        let form = self.forms.get(&prim).map_or((DVec3::ZERO, DQuat::IDENTITY), |form| (form.at, form.turn));
        let key = |seconds: f64| {
            let (at, turn, _) = rigid(&axes.matrix(&places.world(prim, start + seconds * per_second)));
            Key { time: seconds, at: at + turn * form.0, turn: (turn * form.1).normalize() }
        };
        let mut keys: Vec<Key> = codes.iter().map(|code| key((code - start) / per_second)).collect();
        keys.dedup_by(|b, a| b.time <= a.time);
        let (keys, off) = straight(&key, &keys, reach);
        if keys.iter().any(|key| !key.at.is_finite() || !key.turn.is_finite()) {
            return Err(self.scene.prims[prim].wrong("its time samples place it nowhere: a number is not finite"));
        }
        if off > OFF {
            let off = (off * 1e5).ceil() / 1e2;
            self.leave(prim, format!("its motion between time samples, by up to {off} mm: it is too fast, or jumps"));
        }
        let world = |time: f64| rigid(&axes.matrix(&places.world(prim, time))).2;
        let (first, far) = (world(start), reach.max(1e-3));
        let is_scaled = |time: &f64| {
            let change = world(*time) - first;
            change.to_cols_array().iter().any(|x| x.abs() * far > OFF)
        };
        if codes.iter().any(is_scaled) {
            self.leave(prim, "that its scale changes: shapes do not");
        }
        self.keyed.insert(prim, keys);
        Ok(())
    }

    /// Makes the nodes: of shapes and bodies, and of all above them.
    pub(super) fn build(&mut self) -> Result<(), AssetError> {
        let mut needed = vec![false; self.scene.prims.len()];
        let mut ends: Vec<usize> = self.forms.keys().copied().collect();
        ends.extend(self.physics.bodies.keys());
        for prim in ends {
            for above in self.scene.above(prim) {
                if std::mem::replace(&mut needed[above], true) {
                    break;
                }
            }
        }
        for prim in (0..needed.len()).filter(|&prim| needed[prim]) {
            let node = self.node(prim)?;
            self.nodes.insert(prim, self.file.nodes.len());
            self.file.nodes.push(node);
        }
        for prim in self.forms.keys().copied().collect::<Vec<_>>() {
            let Some(body) = self.physics.owner(self.scene, prim).and_then(|body| self.nodes.get(&body)) else {
                continue;
            };
            let look = self.file.nodes[self.nodes[&prim]].ours.get("colour").cloned();
            if let (Some(look), false) = (look, self.file.nodes[*body].ours.contains_key("colour")) {
                self.file.nodes[*body].ours.insert("colour".into(), look);
            }
        }
        self.file.looks = self.looks.all.clone();
        Ok(())
    }

    fn node(&mut self, prim: usize) -> Result<Node, AssetError> {
        let (at, turn, _) = rigid(&self.axes.matrix(&self.places.world(prim, self.places.start)));
        let own = &self.scene.prims[prim];
        let parent = own.parent.and_then(|parent| self.nodes.get(&parent).copied());
        let mut node = Node { name: own.name.clone(), parent, at, turn, scale: DVec3::ONE, ..Node::default() };
        if let Some(keys) = self.keyed.remove(&prim) {
            (node.parent, node.keys) = (None, keys);
        }
        let mut own_turn = DQuat::IDENTITY;
        let mut own_at = DVec3::ZERO;
        if let Some(form) = self.forms.get_mut(&prim) {
            (own_at, own_turn) = (form.at, form.turn);
            (node.at, node.turn, node.scale) = (at + turn * form.at, (turn * form.turn).normalize(), form.scale);
            node.mesh = form.mesh.take();
            let solid = form.solid.take();
            self.collider(prim, solid, &mut node)?;
            let look = self.looks.of(self.scene, prim)?;
            if let Some(look) = look {
                node.ours.insert("colour".into(), json!(self.looks.shown(look)));
            }
            node.look = look;
        }
        if let Some(body) = self.physics.bodies.get(&prim).cloned() {
            let said = if body.is_kinematic {
                json!({ "isKinematic": true })
            } else {
                let back = if body.is_local { own_turn.inverse() } else { node.turn.inverse() * self.turn_above(prim) };
                let mut said = self.motion(prim, own_at, own_turn);
                for (key, vector) in [("linearVelocity", body.velocity), ("angularVelocity", body.spin)] {
                    if vector != DVec3::ZERO {
                        said.insert(key.into(), json!((back * vector).to_array()));
                    }
                }
                said.into()
            };
            node.bodies.insert("motion".into(), said);
        }
        Ok(node)
    }

    /// How the axes are turned in which a prim's own place is said.
    fn turn_above(&self, prim: usize) -> DQuat {
        let above = self.scene.prims[prim].parent.filter(|_| !self.places.resets(prim));
        above.map_or(DQuat::IDENTITY, |above| rigid(&self.axes.matrix(&self.places.world(above, self.places.start))).1)
    }

    /// Mass and inertia of a body, seen from a place and along axes of its own.
    fn motion(&self, prim: usize, at: DVec3, turn: DQuat) -> Map<String, Value> {
        let mut said = Map::new();
        let Some(mass) = self.physics.masses.get(&prim) else { return said };
        if let Some(mass) = mass.mass {
            said.insert("mass".into(), mass.into());
        }
        let back = turn.inverse();
        let (_, _, rest) = rigid(&self.axes.matrix(&self.places.world(prim, self.places.start)));
        if let Some(centre) = mass.centre {
            let scale = self.forms.get(&prim).map_or(DVec3::ONE, |form| form.scale);
            let centre = back * (rest.transform_vector3(centre) - at) / scale;
            said.insert("centerOfMass".into(), json!(centre.to_array()));
        }
        if let Some((moments, axes)) = mass.moments {
            said.insert("inertiaDiagonal".into(), json!(moments.to_array()));
            said.insert("inertiaOrientation".into(), json!((back * axes).normalize().to_array()));
        }
        said
    }

    fn collider(&mut self, prim: usize, solid: Option<Value>, node: &mut Node) -> Result<(), AssetError> {
        let approximation = self.physics.colliders.get(&prim).cloned();
        // Where nothing is a body, what follows time samples can be touched even if it is only seen.
        let is_moved = self.mover(prim).is_some() && !self.physics.colliders.is_empty();
        if approximation.is_none() && !is_moved {
            return Ok(());
        }
        let approximation = approximation.unwrap_or_else(|| "none".into());
        let geometry = match solid {
            Some(solid) => {
                self.file.shapes.push(solid);
                json!({ "shape": self.file.shapes.len() - 1 })
            }
            None => json!({ "convexHull": approximation == "convexHull" }),
        };
        let mut collider = json!({ "geometry": geometry });
        if let Some(material) = self.physics.material(self.scene, prim)? {
            collider["physicsMaterial"] = material.into();
        }
        node.bodies.insert("collider".into(), collider);
        node.ours.extend(self.physics.weight(self.scene, prim)?);
        if approximation == "convexDecomposition" {
            node.ours.insert("pieces".into(), true.into());
        }
        Ok(())
    }
}
