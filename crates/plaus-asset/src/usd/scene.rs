//! A composed stage as a list of prims.

use super::value::{numbers, word, words};
use crate::AssetError;
use glam::{DQuat, DVec3};
use openusd::sdf::{FieldKey, Path, Value};
use openusd::usd::{self, PrimStatus, Stage, TimeCode};
use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Display;

/// Most prims, and most of them within each other.
const MOST_PRIMS: usize = 100_000;
const DEEPEST: usize = 200;

/// Most numbers and names that are read of all prims together: references may say the same again and again.
const MOST_SAID: usize = 1 << 26;

/// A prim that is active, loaded, defined and not abstract.
pub(super) struct Prim {
    pub(super) path: String,
    pub(super) name: String,
    /// The name of its type, such as `Mesh`.
    pub(super) kind: String,
    pub(super) apis: Vec<String>,
    pub(super) parent: Option<usize>,
    handle: usd::Prim,
    properties: BTreeSet<String>,
}

impl Prim {
    pub(super) fn has_api(&self, name: &str) -> bool {
        self.apis.iter().any(|api| api == name)
    }

    /// The instances of an API that may be applied several times: `rotX` of `PhysicsDriveAPI:rotX`.
    pub(super) fn api_names<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a str> {
        self.apis.iter().filter_map(move |api| api.strip_prefix(name)?.strip_prefix(':'))
    }

    pub(super) fn has(&self, property: &str) -> bool {
        self.properties.contains(property)
    }

    pub(super) fn properties(&self) -> impl Iterator<Item = &str> {
        self.properties.iter().map(String::as_str)
    }

    /// An error here.
    pub(super) fn wrong(&self, what: impl Display) -> AssetError {
        AssetError::Broken(format!("{}: {what}", self.path))
    }
}

/// All prims of a stage, parents before their children.
pub(super) struct Scene {
    stage: Stage,
    pub(super) prims: Vec<Prim>,
    by_path: BTreeMap<String, usize>,
    /// Time codes at which it starts and ends, if it says so, and how many there are in a second.
    pub(super) start: Option<f64>,
    pub(super) end: Option<f64>,
    pub(super) per_second: f64,
    /// How many numbers and names were read.
    said: Cell<usize>,
}

fn broken(error: impl Display) -> AssetError {
    AssetError::Broken(format!("it is not valid USD: {error:#}"))
}

impl Scene {
    pub(super) fn read(stage: Stage) -> Result<Self, AssetError> {
        let said = |key: FieldKey| -> Result<Option<f64>, AssetError> {
            let value = stage.stage_metadata(key.as_str()).map_err(broken)?;
            let number = value.as_ref().and_then(numbers).and_then(|all| all.first().copied());
            match number {
                Some(number) if !number.is_finite() => {
                    Err(broken(format!("its {} is {number}, and must be finite", key.as_str())))
                }
                number => Ok(number),
            }
        };
        let (start, end) = (said(FieldKey::StartTimeCode)?, said(FieldKey::EndTimeCode)?);
        let per_second = said(FieldKey::TimeCodesPerSecond)?.or(said(FieldKey::FramesPerSecond)?).unwrap_or(24.0);
        if per_second <= 0.0 {
            return Err(broken(format!("its timeCodesPerSecond is {per_second}, and must be more than 0")));
        }
        let (prims, by_path, said) = (Vec::new(), BTreeMap::new(), Cell::new(0));
        let mut scene = Self { stage, prims, by_path, start, end, per_second, said };
        scene.walk()?;
        Ok(scene)
    }

    /// Counts numbers or names that are read.
    fn count(&self, more: usize) -> Result<(), AssetError> {
        self.said.set(self.said.get().saturating_add(more));
        if self.said.get() > MOST_SAID {
            let what = format!("together its prims say too much: more than {MOST_SAID} numbers and names");
            return Err(AssetError::Broken(what));
        }
        Ok(())
    }

    fn walk(&mut self) -> Result<(), AssetError> {
        let mut open: Vec<(Path, Option<usize>, usize)> = Vec::new();
        let roots = self.stage.prim(Path::abs_root()).child_names().map_err(broken)?;
        for name in roots.iter().rev() {
            open.extend(Path::abs_root().append_path(name.as_str()).ok().map(|path| (path, None, 1)));
        }
        let (needed, rejected) = (PrimStatus::ACTIVE | PrimStatus::LOADED | PrimStatus::DEFINED, PrimStatus::ABSTRACT);
        while let Some((path, parent, depth)) = open.pop() {
            let here = |what: &dyn Display| AssetError::Broken(format!("{path}: {what:#}"));
            if depth > DEEPEST {
                return Err(here(&format!("more than {DEEPEST} prims within each other")));
            }
            let status = self.stage.prim_status(path.clone()).map_err(|error| here(&error))?;
            if !status.contains(needed) || status.intersects(rejected) {
                continue;
            }
            if self.prims.len() >= MOST_PRIMS {
                return Err(here(&format!("it has more than {MOST_PRIMS} prims: take some out of it")));
            }
            let handle = self.stage.prim(path.clone());
            let kind = handle.type_name().map_err(|error| here(&error))?;
            let apis = handle.api_schemas().map_err(|error| here(&error))?;
            let properties = handle.property_names().map_err(|error| here(&error))?;
            let children = handle.child_names().map_err(|error| here(&error))?;
            self.count(properties.len() + children.len())?;
            let index = self.prims.len();
            for name in children.iter().rev() {
                open.extend(path.append_path(name.as_str()).ok().map(|child| (child, Some(index), depth + 1)));
            }
            let text = path.as_str().to_owned();
            self.by_path.insert(text.clone(), index);
            self.prims.push(Prim {
                name: text.rsplit('/').next().unwrap_or_default().to_owned(),
                path: text,
                kind: kind.map(|kind| kind.as_str().to_owned()).unwrap_or_default(),
                apis: apis.iter().map(|api| api.as_str().to_owned()).collect(),
                parent,
                properties: properties.iter().map(|name| name.as_str().to_owned()).collect(),
                handle,
            });
        }
        Ok(())
    }

    /// What the root layer says of the whole stage.
    pub(super) fn metadata(&self, key: &str) -> Result<Option<Value>, AssetError> {
        self.stage.stage_metadata(key).map_err(broken)
    }

    /// What could not be found or read, in words.
    pub(super) fn complaints(&self) -> Vec<String> {
        self.stage.composition_errors().iter().map(ToString::to_string).collect()
    }

    pub(super) fn at(&self, path: &str) -> Option<usize> {
        self.by_path.get(path).copied()
    }

    /// A prim and those above it, up to the root.
    pub(super) fn above(&self, prim: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(Some(prim), |&prim| self.prims[prim].parent)
    }

    /// The value of an attribute at the start, if it has one.
    pub(super) fn value(&self, prim: usize, name: &str) -> Result<Option<Value>, AssetError> {
        let prim = &self.prims[prim];
        if !prim.has(name) {
            return Ok(None);
        }
        let time = self.start.map_or(TimeCode::EARLIEST, TimeCode::new);
        let value = prim.handle.attribute(name).get_at::<Value>(time);
        value.map_err(|error| prim.wrong(format!("{name}: {error:#}")))
    }

    /// The time samples of an attribute, as rows of numbers; without those that say nothing.
    pub(super) fn samples(&self, prim: usize, name: &str) -> Result<Vec<(f64, Vec<f64>)>, AssetError> {
        let prim = &self.prims[prim];
        let attribute = prim.handle.attribute(name);
        let wrong = |error| prim.wrong(format!("{name}: {error:#}"));
        let times = attribute.time_sample_times().map_err(wrong)?;
        if times.is_empty() {
            return Ok(Vec::new());
        }
        if let Some(samples) = attribute.time_samples().map_err(wrong)? {
            let mut rows = Vec::new();
            for (time, value) in samples.iter() {
                if let Some(row) = numbers(value) {
                    self.count(row.len())?;
                    rows.push((*time, row));
                }
            }
            return Ok(rows);
        }
        // Of clips.
        let mut samples = Vec::new();
        for time in times {
            let value = attribute.get_at::<Value>(TimeCode::new(time)).map_err(wrong)?;
            let row = value.as_ref().and_then(numbers);
            self.count(row.as_ref().map_or(0, Vec::len))?;
            samples.extend(row.map(|row| (time, row)));
        }
        Ok(samples)
    }

    pub(super) fn varies(&self, prim: usize, name: &str) -> bool {
        let prim = &self.prims[prim];
        prim.has(name) && prim.handle.attribute(name).num_time_samples().is_ok_and(|count| count > 1)
    }

    pub(super) fn numbers(&self, prim: usize, name: &str) -> Result<Option<Vec<f64>>, AssetError> {
        let row = self.value(prim, name)?.as_ref().and_then(numbers);
        self.count(row.as_ref().map_or(0, Vec::len))?;
        Ok(row)
    }

    fn some<const N: usize>(&self, prim: usize, name: &str) -> Result<Option<[f64; N]>, AssetError> {
        let Some(value) = self.value(prim, name)? else { return Ok(None) };
        let found = numbers(&value).and_then(|all| <[f64; N]>::try_from(all).ok());
        let wrong = || self.prims[prim].wrong(format!("{name} is of another type than {N} numbers"));
        found.map(Some).ok_or_else(wrong)
    }

    /// A number, which may be infinite.
    pub(super) fn number(&self, prim: usize, name: &str) -> Result<Option<f64>, AssetError> {
        Ok(self.some(prim, name)?.map(|[number]| number).filter(|number: &f64| !number.is_nan()))
    }

    /// A vector, if all of it is finite.
    pub(super) fn vector(&self, prim: usize, name: &str) -> Result<Option<DVec3>, AssetError> {
        Ok(self.some(prim, name)?.map(DVec3::from_array).filter(|vector| vector.is_finite()))
    }

    /// A rotation, unless it is 0.
    pub(super) fn turn(&self, prim: usize, name: &str) -> Result<Option<DQuat>, AssetError> {
        let turn = self.some(prim, name)?.map(|[w, x, y, z]| DQuat::from_xyzw(x, y, z, w));
        Ok(turn.filter(|turn| turn.is_finite() && turn.length() > 1e-6).map(|turn| turn.normalize()))
    }

    pub(super) fn is(&self, prim: usize, name: &str, usual: bool) -> Result<bool, AssetError> {
        Ok(self.number(prim, name)?.map_or(usual, |number| number != 0.0))
    }

    pub(super) fn word(&self, prim: usize, name: &str) -> Result<Option<String>, AssetError> {
        Ok(self.value(prim, name)?.as_ref().and_then(word))
    }

    pub(super) fn words(&self, prim: usize, name: &str) -> Result<Vec<String>, AssetError> {
        Ok(self.value(prim, name)?.as_ref().and_then(words).unwrap_or_default())
    }

    /// The paths that a relationship names.
    pub(super) fn targets(&self, prim: usize, name: &str) -> Result<Vec<String>, AssetError> {
        let prim = &self.prims[prim];
        if !prim.has(name) {
            return Ok(Vec::new());
        }
        let targets = prim.handle.relationship(name).forwarded_targets();
        let targets = targets.map_err(|error| prim.wrong(format!("{name}: {error:#}")))?;
        Ok(targets.iter().map(|path| path.as_str().to_owned()).collect())
    }

    /// What an attribute takes its value from: prim and output.
    pub(super) fn connection(&self, prim: usize, name: &str) -> Option<(usize, String)> {
        let prim = &self.prims[prim];
        let path = prim.has(name).then(|| prim.handle.attribute(name).connections().ok()).flatten()?;
        let (owner, output) = path.first()?.as_str().rsplit_once('.')?;
        Some((self.at(owner)?, output.to_owned()))
    }

    /// A piece of metadata of a relationship or attribute.
    pub(super) fn said_of(&self, prim: usize, name: &str, key: &str) -> Option<String> {
        let value = self.prims[prim].handle.attribute(name).get_metadata::<Value>(key).ok().flatten();
        value.as_ref().and_then(word)
    }

    /// Tells which prims are in a collection of a prim.
    pub(super) fn members(&self, prim: usize, name: &str) -> Result<impl Fn(usize) -> bool + '_, AssetError> {
        let own = &self.prims[prim];
        let collection = usd::Collection::new(own.handle.path().clone(), name);
        let query = collection.compute_membership_query(&self.stage);
        let query = query.map_err(|error| own.wrong(format!("its collection {name}: {error:#}")))?;
        Ok(move |member: usize| query.is_path_included(self.prims[member].handle.path()))
    }

    /// Whether an expression says what is in the collection of a collision group.
    pub(super) fn is_by_expression(&self, prim: usize) -> bool {
        self.prims[prim].kind == "PhysicsCollisionGroup"
            && self.prims[prim].has("collection:colliders:membershipExpression")
    }
}
