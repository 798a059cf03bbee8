//! Colours of prims, and the names of their materials.

use super::physics::bound;
use super::scene::Scene;
use crate::AssetError;
use crate::glb::screen;
use std::collections::BTreeMap;

/// Most attributes that one takes its value from, one after the other.
const FARTHEST: usize = 8;

/// What prims look like: names, and colours, linear.
#[derive(Debug, Default)]
pub(super) struct Looks {
    pub(super) all: Vec<(String, [f64; 3])>,
    by_path: BTreeMap<String, Option<usize>>,
}

impl Looks {
    /// The index of what a prim looks like, if it says so: by its material, or else by itself.
    pub(super) fn of(&mut self, scene: &Scene, prim: usize) -> Result<Option<usize>, AssetError> {
        if let Some(path) = bound(scene, prim, "material:binding")? {
            let known = match self.by_path.get(&path) {
                Some(known) => *known,
                None => {
                    let found = scene.at(&path).map_or(Ok(None), |material| diffuse(scene, material))?;
                    let name = path.rsplit('/').next().unwrap_or_default().to_owned();
                    let index = found.map(|colour| self.index(name, colour));
                    self.by_path.insert(path, index);
                    index
                }
            };
            if known.is_some() {
                return Ok(known);
            }
        }
        let colour = scene.numbers(prim, "primvars:displayColor")?.unwrap_or_default();
        Ok(colour.first_chunk().filter(|colour| is_colour(colour)).map(|colour| self.index(String::new(), *colour)))
    }

    fn index(&mut self, name: String, colour: [f64; 3]) -> usize {
        let same = |known: &(String, [f64; 3])| *known == (name.clone(), colour);
        self.all.iter().position(same).unwrap_or_else(|| {
            self.all.push((name, colour));
            self.all.len() - 1
        })
    }

    /// A colour as it is shown.
    pub(super) fn shown(&self, look: usize) -> [u8; 3] {
        self.all[look].1.map(|channel| screen(channel as f32))
    }
}

fn is_colour(colour: &[f64; 3]) -> bool {
    colour.iter().all(|channel| (0.0..=1.0).contains(channel))
}

/// The colour of the surface of a material, unless a picture gives it.
fn diffuse(scene: &Scene, material: usize) -> Result<Option<[f64; 3]>, AssetError> {
    let Some((shader, _)) = scene.connection(material, "outputs:surface") else { return Ok(None) };
    let (mut prim, mut name) = (shader, "inputs:diffuseColor".to_owned());
    for _ in 0..FARTHEST {
        match scene.connection(prim, &name) {
            Some((from, output)) => (prim, name) = (from, output),
            None => {
                let value = scene.numbers(prim, &name)?.and_then(|value| <[f64; 3]>::try_from(value).ok());
                return Ok(value.filter(is_colour));
            }
        }
    }
    Ok(None)
}
