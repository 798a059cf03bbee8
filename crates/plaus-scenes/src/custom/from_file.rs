//! Shapes from files.

use super::amount::{Amount, Length};
use super::corners::{Corners, corners};
use super::names::numbered;
use super::values::Value;
use crate::files::{Asset, Files, inside};
use crate::scenario::nearest;
use crate::scene::ConfigError;
use plaus_asset::Triangles;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A file of shapes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FromFile {
    /// The file, `.glb`, `.gltf`, `.obj`, `.stl` or USD: its path from the scenario's folder, with `/` between folders.
    pub file: String,
    /// Only the object with this name, about its own origin and along its own axes. In an array, `{i}` in the name is
    /// replaced by 0 for the first and 1 for the next, and `{i+1}` by one more. Unset: everything in the file, as
    /// placed there.
    #[serde(default)]
    pub object: Option<String>,
    /// Length of the file's unit in millimetres. Unset: 1000 for `.glb`, `.gltf` and USD, which is read in metres; 1
    /// for `.obj` and `.stl`.
    #[serde(default)]
    pub unit_mm: Option<Amount<Length>>,
    /// Which axis of the file points up. Unset: y for `.glb`, `.gltf`, USD and `.obj`, z for `.stl`.
    #[serde(default)]
    pub up: Option<Up>,
    /// Whether the file may lie outside the scenario's folder.
    #[serde(default)]
    pub anywhere: bool,
    /// BLAKE3 hash of the file; a file with a different hash is refused. A run records the hash of the file it used.
    /// Unset: any content is accepted.
    #[serde(default)]
    pub hash: Option<String>,
    /// What was read; not there before.
    #[serde(skip)]
    #[schemars(skip)]
    pub(super) loaded: Option<Arc<Loaded>>,
}

/// Which axis of a file points up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Up {
    /// Its y axis, as in most programs that draw.
    Y,
    /// Its z axis, as in most programs that construct.
    Z,
}

/// What was read of a file.
#[derive(Debug)]
pub(super) struct Loaded {
    pub(super) asset: Arc<Asset>,
    /// In the file's unit, z up.
    pub(super) triangles: Triangles,
    /// The corners of its convex hull, where that is asked for.
    pub(super) corners: Option<Corners>,
    /// How many millimetres the file's unit is where the scenario does not say.
    pub(super) unit_mm: f64,
    wanted: Wanted,
}

/// What was read is the same where the file is: everything else follows from the keys.
impl PartialEq for Loaded {
    fn eq(&self, other: &Self) -> bool {
        self.asset.hash == other.asset.hash
    }
}

/// What is asked of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Wanted {
    Triangles,
    Hull,
}

/// What was read already.
#[derive(Debug, Default)]
pub(super) struct Known {
    /// Files by their paths.
    assets: BTreeMap<String, Arc<Asset>>,
    /// Hulls of a file's objects, or of all of it; which of its axes points up. They take long to find, and many bodies
    /// may have the same.
    hulls: BTreeMap<(String, Option<String>, Option<Up>), Corners>,
}

impl FromFile {
    /// A file with nothing else said.
    #[must_use]
    pub fn new(file: impl Into<String>) -> Self {
        Self { file: file.into(), object: None, unit_mm: None, up: None, anywhere: false, hash: None, loaded: None }
    }

    /// Reads it. `key` is where it stands.
    pub(super) fn load(
        &mut self,
        key: &str,
        wanted: Wanted,
        files: &dyn Files,
        known: &mut Known,
    ) -> Result<(), ConfigError> {
        let wrong = |name: &str, message: String| ConfigError::new(format!("{key}.{name}"), message);
        let in_file = |message: String| wrong("file", format!("{}: {message}", self.file));
        inside(&self.file, self.anywhere).map_err(in_file)?;
        let asset = match known.assets.get(&self.file) {
            Some(asset) => Arc::clone(asset),
            None => {
                let asset = files.asset(&self.file, self.anywhere).map_err(in_file)?;
                Arc::clone(known.assets.entry(self.file.clone()).or_insert(Arc::new(asset)))
            }
        };
        if let Some(given) = self.hash.as_ref().filter(|given| **given != asset.hash) {
            let message = format!("{} has changed: its hash is {}, not {given}", self.file, asset.hash);
            return Err(wrong("hash", message));
        }
        self.hash = Some(asset.hash.clone());
        // Which objects an array takes is known once it is counted out.
        let unit_mm = asset.content.format.unit_mm();
        let unread = Loaded { asset, triangles: Triangles::default(), corners: None, unit_mm, wanted };
        let is_counted = self.object.as_ref().is_some_and(|name| name.contains('{'));
        self.loaded = Some(Arc::new(if is_counted {
            unread
        } else {
            self.read(key, unread, self.object.as_deref(), &mut known.hulls)?
        }));
        Ok(())
    }

    /// What was read, for the shape at `key` of the `nth` of so many in an array.
    pub(super) fn loaded(&self, key: &str, nth: Option<[u32; 2]>) -> Result<Arc<Loaded>, ConfigError> {
        let loaded = self.loaded.clone().ok_or_else(|| {
            let message = format!("{} has not been read: the scenario was read without its files", self.file);
            ConfigError::new(format!("{key}.file"), message)
        })?;
        let Some(name) = self.object.as_ref().filter(|name| name.contains('{')) else { return Ok(loaded) };
        let name = numbered(name, nth).ok_or_else(|| {
            let message = format!("{name:?}: what is in brackets must be `i` or such as `i+1`, in an array (`count`)");
            ConfigError::new(format!("{key}.object"), message)
        })?;
        let Loaded { asset, unit_mm, wanted, .. } = &*loaded;
        let asset = Arc::clone(asset);
        let unread =
            Loaded { asset, triangles: Triangles::default(), corners: None, unit_mm: *unit_mm, wanted: *wanted };
        self.read(key, unread, Some(&name), &mut BTreeMap::new()).map(Arc::new)
    }

    /// With the triangles of one object of the file, or of all; and with their hull, if that is wanted.
    fn read(
        &self,
        key: &str,
        unread: Loaded,
        object: Option<&str>,
        hulls: &mut BTreeMap<(String, Option<String>, Option<Up>), Corners>,
    ) -> Result<Loaded, ConfigError> {
        let content = &unread.asset.content;
        let up = match self.up {
            Some(Up::Y) => plaus_asset::Up::Y,
            Some(Up::Z) => plaus_asset::Up::Z,
            None => content.format.up(),
        };
        let triangles = match object {
            None => content.whole(),
            Some(name) => {
                let names = || content.objects.iter().map(|object| object.name.as_str());
                let object = content.object(name).ok_or_else(|| {
                    let near = nearest(name, names()).map(|near| format!("did you mean {near:?}? "));
                    let some: Vec<&str> = names().take(MOST_NAMES).collect();
                    let more = if names().count() > MOST_NAMES { ", …" } else { "" };
                    let there = format!("known: {}{more}", some.join(", "));
                    let near = near.unwrap_or_default();
                    let message = format!("{} has no object {name:?}; {near}{there}", self.file);
                    ConfigError::new(format!("{key}.object"), message)
                })?;
                object.triangles.clone()
            }
        };
        let triangles = triangles.upright(up);
        let corners = match unread.wanted {
            Wanted::Triangles => None,
            Wanted::Hull => {
                let name = (self.file.clone(), object.map(String::from), self.up);
                let hull = match hulls.get(&name) {
                    Some(hull) => hull.clone(),
                    None => corners(&triangles.corners)
                        .map_err(|error| ConfigError::new(format!("{key}.file"), format!("{}: {error}", self.file)))?,
                };
                hulls.insert(name, hull.clone());
                Some(hull)
            }
        };
        Ok(Loaded { triangles, corners, ..unread })
    }
}

impl Loaded {
    /// What a hull fills or cuts off, in words: the unit is so many millimetres.
    pub(super) fn note(&self, unit: Value) -> Option<String> {
        let corners = self.corners.as_ref()?;
        let (count, of) = (corners.points.len(), corners.of);
        let out = match unit {
            Value::Fixed(unit) => format!("{:.3} mm", corners.out * unit),
            _ => format!("{:.3} of the file's unit", corners.out),
        };
        let cut =
            if corners.out > 0.0 { format!(", beyond which others stand out by up to {out}") } else { String::new() };
        Some(format!("a convex hull of {of} points, by {count} of them{cut}"))
    }
}

/// Names of objects that a message has at most.
const MOST_NAMES: usize = 12;
