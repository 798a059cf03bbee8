//! What holds for a whole model: units, classes, gravity, and what shapes refer to.

use super::words::{Angles, Classes};
use crate::AssetError;
use crate::model::{Corners, Mesh};
use crate::xml::{Element, Words};
use glam::DVec3;
use std::collections::BTreeMap;

/// All of it.
#[derive(Debug)]
pub(super) struct Settings {
    pub(super) angles: Angles,
    pub(super) classes: Classes,
    pub(super) gravity: DVec3,
    /// Whether a joint with a range is limited.
    pub(super) auto_limits: bool,
    /// Whether masses that are given are ignored.
    pub(super) mass_from_shapes: bool,
    pub(super) meshes: Vec<Mesh>,
    pub(super) colours: BTreeMap<String, [u8; 3]>,
}

impl Settings {
    pub(super) fn read(root: &Element) -> Result<Self, AssetError> {
        let mut all = Self {
            angles: Angles { unit: 1.0_f64.to_radians(), sequence: ['x', 'y', 'z'] },
            classes: Classes::read(root)?,
            gravity: DVec3::new(0.0, 0.0, -9.81),
            auto_limits: true,
            mass_from_shapes: false,
            meshes: Vec::new(),
            colours: BTreeMap::new(),
        };
        let (mut folder, mut keeps_folders) = (String::new(), true);
        for said in root.all("compiler") {
            let words = all.classes.words(said, None)?;
            if let Some(unit) = words.one_of("angle", &["degree", "radian"])? {
                all.angles.unit = if unit == "radian" { 1.0 } else { 1.0_f64.to_radians() };
            }
            if let Some(letters) = words.get("eulerseq") {
                let axes: Vec<char> = letters.chars().filter(|letter| "xyzXYZ".contains(*letter)).collect();
                all.angles.sequence = <[char; 3]>::try_from(axes)
                    .ok()
                    .filter(|_| letters.len() == 3)
                    .ok_or_else(|| words.wrong("eulerseq", "three letters of xyzXYZ are needed"))?;
            }
            if words.one_of("coordinate", &["local", "global"])? == Some("global") {
                return Err(
                    words.wrong("coordinate", "global coordinates are not read: save the model with local ones")
                );
            }
            let yes = |name: &str| words.one_of(name, &["true", "false"]).map(|said| said.map(|said| said == "true"));
            all.auto_limits = yes("autolimits")?.unwrap_or(all.auto_limits);
            keeps_folders = yes("strippath")?.map_or(keeps_folders, |strips| !strips);
            let from_shapes = words.one_of("inertiafromgeom", &["true", "false", "auto"])?;
            all.mass_from_shapes = from_shapes.map_or(all.mass_from_shapes, |said| said == "true");
            for name in ["assetdir", "meshdir"] {
                folder = words.get(name).map_or(folder, String::from);
            }
        }
        let mut acts = true;
        for said in root.all("option") {
            all.gravity = all.classes.words(said, None)?.vector("gravity")?.unwrap_or(all.gravity);
            for said in said.all("flag") {
                let gravity = all.classes.words(said, None)?.one_of("gravity", &["enable", "disable"])?;
                acts = gravity.map_or(acts, |said| said == "enable");
            }
        }
        if !acts {
            all.gravity = DVec3::ZERO;
        }
        for section in root.all("asset") {
            for said in section.all("material") {
                let words = all.classes.words(said, None)?;
                if let (Some(name), Some(colour)) = (words.get("name"), colour(&words)?) {
                    all.colours.insert(name.to_owned(), colour);
                }
            }
            for said in section.all("mesh") {
                let words = all.classes.words(said, None)?;
                let path = words.get("file").map(|file| path(&folder, file, keeps_folders));
                all.meshes.push(mesh(&words, path)?);
            }
        }
        Ok(all)
    }
}

/// The path of a file from the model's folder.
fn path(folder: &str, file: &str, keeps_folders: bool) -> String {
    let file = file.replace('\\', "/");
    let file = if keeps_folders { &file[..] } else { file.rsplit('/').next().unwrap_or_default() };
    let folder = folder.replace('\\', "/");
    match folder.trim_end_matches('/') {
        "" | "." => file.to_owned(),
        _ if file.starts_with('/') => file.to_owned(),
        folder => format!("{folder}/{file}"),
    }
}

fn mesh(words: &Words<'_>, path: Option<String>) -> Result<Mesh, AssetError> {
    let stem = |path: &String| {
        let name = path.rsplit('/').next().unwrap_or_default();
        name.rsplit_once('.').map_or(name, |(stem, _)| stem).to_owned()
    };
    let name = words.get("name").map(String::from).or_else(|| path.as_ref().map(stem)).unwrap_or_default();
    let numbers = words.numbers("vertex", 0..=usize::MAX)?;
    let from = match (path, numbers) {
        (Some(path), _) => Corners::File(path),
        (None, Some(numbers)) if numbers.len() >= 12 && numbers.len() % 3 == 0 => {
            Corners::Said(numbers.chunks_exact(3).map(DVec3::from_slice).collect())
        }
        (None, Some(_)) => return Err(words.wrong("vertex", "three numbers for each of at least four corners")),
        (None, None) => Corners::Unread,
    };
    let turn = words.numbers("refquat", 4..=4)?.unwrap_or_else(|| vec![1.0, 0.0, 0.0, 0.0]);
    let turn = glam::DQuat::from_xyzw(turn[1], turn[2], turn[3], turn[0]);
    if turn.length() < 1e-12 {
        return Err(words.wrong("refquat", "it has no direction"));
    }
    Ok(Mesh {
        name,
        from,
        origin: words.vector("refpos")?.unwrap_or(DVec3::ZERO),
        turn: turn.normalize(),
        scale: words.vector("scale")?.unwrap_or(DVec3::ONE),
    })
}

/// What `rgba` says.
pub(super) fn colour(words: &Words<'_>) -> Result<Option<[u8; 3]>, AssetError> {
    let channel = |share: f64| (255.0 * share.clamp(0.0, 1.0)).round() as u8;
    Ok(words.numbers("rgba", 3..=4)?.map(|rgba| [0, 1, 2].map(|k| channel(rgba[k]))))
}
