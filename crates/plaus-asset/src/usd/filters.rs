//! What passes through what: pairs and groups of UsdPhysics as the filters of a GLB.

use super::build::Builder;
use crate::AssetError;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// Most kinds of colliders that filters tell apart.
const MOST_KINDS: usize = 1000;

/// What filters know of a collider: the groups, and the prims of pairs, that it is in.
type Kind = (BTreeSet<usize>, BTreeSet<usize>);

/// Two of which none touches the other, the smaller first.
type Pairs = BTreeSet<(usize, usize)>;

fn pair(a: usize, b: usize) -> (usize, usize) {
    (a.min(b), a.max(b))
}

impl Builder<'_> {
    /// Gives colliders filters.
    pub(super) fn filters(&mut self) -> Result<(), AssetError> {
        let colliders: Vec<usize> =
            self.nodes.keys().copied().filter(|prim| self.physics.colliders.contains_key(prim)).collect();
        let groups = self.scene.prims.iter().filter(|prim| prim.kind == "PhysicsCollisionGroup").count();
        if groups > MOST_KINDS {
            self.left_out.push(format!("{groups} collision groups, more than {MOST_KINDS}: here all touch"));
            return Ok(());
        }
        let pairs = self.pairs()?;
        let (groups, apart) = self.groups(&colliders)?;
        let paired: BTreeSet<usize> = pairs.iter().flat_map(|&(a, b)| [a, b]).collect();
        let mut kinds: Vec<Kind> = Vec::new();
        let mut of: BTreeMap<usize, usize> = BTreeMap::new();
        for &collider in &colliders {
            let above = self.scene.above(collider).filter(|prim| paired.contains(prim)).collect();
            let kind: Kind = (groups.get(&collider).cloned().unwrap_or_default(), above);
            if kind.0.is_empty() && kind.1.is_empty() {
                continue;
            }
            let index = kinds.iter().position(|known| *known == kind).unwrap_or_else(|| {
                kinds.push(kind);
                kinds.len() - 1
            });
            if kinds.len() > MOST_KINDS {
                let what = format!("more than {MOST_KINDS} kinds of things that pass through others: here all touch");
                self.left_out.push(what);
                return Ok(());
            }
            of.insert(collider, index);
        }
        let passes = |a: &Kind, b: &Kind| {
            let any = |a: &BTreeSet<usize>, b: &BTreeSet<usize>, list: &Pairs| {
                a.iter().any(|&a| b.iter().any(|&b| list.contains(&pair(a, b))))
            };
            any(&a.0, &b.0, &apart) || any(&a.1, &b.1, &pairs)
        };
        let filter = |(index, kind): (usize, &Kind)| -> Value {
            let not: Vec<String> =
                kinds.iter().enumerate().filter(|(_, other)| passes(kind, other)).map(|(k, _)| k.to_string()).collect();
            let mut said = json!({ "collisionSystems": [index.to_string()] });
            if !not.is_empty() {
                said["notCollideWithSystems"] = not.into();
            }
            said
        };
        let all: Vec<Value> = kinds.iter().enumerate().map(filter).collect();
        for (collider, index) in of {
            if let Some(said) = self.file.nodes[self.nodes[&collider]].bodies.get_mut("collider") {
                said["collisionFilter"] = index.into();
            }
        }
        if !all.is_empty() {
            self.file.bodies.insert("collisionFilters".into(), all.into());
        }
        Ok(())
    }

    /// The prims with a list of others that nothing of theirs touches.
    fn pairs(&mut self) -> Result<Pairs, AssetError> {
        let mut pairs = Pairs::new();
        for (index, prim) in self.scene.prims.iter().enumerate() {
            if prim.has_api("PhysicsFilteredPairsAPI") {
                for path in self.scene.targets(index, "physics:filteredPairs")? {
                    match self.scene.at(&path) {
                        Some(other) => _ = pairs.insert(pair(index, other)),
                        None => self.left_out.push(format!("{}: its filter of {path}, which there is not", prim.path)),
                    }
                }
            }
        }
        Ok(pairs)
    }

    /// The groups of colliders, and which of them do not touch.
    fn groups(&self, colliders: &[usize]) -> Result<(BTreeMap<usize, BTreeSet<usize>>, Pairs), AssetError> {
        let scene = self.scene;
        let all: Vec<usize> =
            (0..scene.prims.len()).filter(|&prim| scene.prims[prim].kind == "PhysicsCollisionGroup").collect();
        // Groups with the same name to merge under are one.
        let mut first: BTreeMap<usize, usize> = BTreeMap::new();
        let mut named: BTreeMap<String, usize> = BTreeMap::new();
        for &group in &all {
            let name = scene.word(group, "physics:mergeGroup")?.filter(|name| !name.is_empty());
            first.insert(group, name.map_or(group, |name| *named.entry(name).or_insert(group)));
        }
        let (mut groups, mut apart): (BTreeMap<usize, BTreeSet<usize>>, Pairs) = Default::default();
        for &group in &all {
            let members = scene.members(group, "colliders")?;
            for &collider in colliders.iter().filter(|&&collider| members(collider)) {
                groups.entry(collider).or_default().insert(first[&group]);
            }
            let listed: BTreeSet<usize> = scene
                .targets(group, "physics:filteredGroups")?
                .iter()
                .filter_map(|path| first.get(&scene.at(path)?).copied())
                .collect();
            let is_inverted = scene.is(group, "physics:invertFilteredGroups", false)?;
            let others = first.values().filter(|other| listed.contains(other) != is_inverted);
            apart.extend(others.map(|&other| pair(first[&group], other)));
        }
        Ok((groups, apart))
    }
}
