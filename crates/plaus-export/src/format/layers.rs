//! Scenes for programs that draw: glTF and USD.

use super::{Collection, Exporter, Row};
use crate::clip::{Clip, ExportError};
use crate::{glb, ours, usda};
use std::io::Write;
use std::path::Path;

/// Most clips in one file; each takes up to 0.3 MB (GLB) or 0.5 MB (USD) of memory.
const MOST: usize = 2000;

pub(super) struct Gltf;
pub(super) struct Usd;

impl Exporter for Gltf {
    fn row(&self) -> &'static Row {
        &Row {
            name: "glb",
            endings: &["glb"],
            about: "animated glTF 2.0: Blender, Godot, Unity, Unreal, browsers",
            help: "Straight lines between keys, right to 0.2 mm and 0.03 degrees in every program. With --keys exact, \
                   cubic splines: programs that follow glTF play them exactly, but Blender does not. There is a key \
                   at every impact. PATH.import beside it makes Godot sample it densely enough. With --into, each \
                   sample is a clip.",
        }
    }

    fn begin(&self, _path: &Path) -> Box<dyn Collection> {
        Box::new(Binary(glb::Writer::default()))
    }

    fn most(&self) -> usize {
        MOST
    }

    fn is_ours(&self, path: &Path) -> bool {
        ours::is_glb(path)
    }

    fn beside(&self, file: &str) -> Option<(&'static str, String)> {
        Some(("import", glb::godot_import(file)))
    }
}

struct Binary(glb::Writer);

impl Collection for Binary {
    fn add(&mut self, clip: &Clip<'_>, _out: &mut dyn Write) -> Result<(), ExportError> {
        self.0.add(clip)?;
        #[cfg(feature = "physics")]
        if let Some(world) = clip.physics {
            self.0.add_physics(world);
        }
        Ok(())
    }

    fn finish(self: Box<Self>, out: &mut dyn Write) -> Result<(), ExportError> {
        Ok(out.write_all(&self.0.finish()?)?)
    }
}

impl Exporter for Usd {
    fn row(&self) -> &'static Row {
        &Row {
            name: "usda",
            endings: &["usda"],
            about: "USD as text: usdview, Houdini, Omniverse, Maya, Blender",
            help: "An animated Xform for each body, meshes with materials, and collision attributes of physics on the \
                   scenery. 24 time codes per second, because Blender's scenes have 24 frames per second and it \
                   takes one time code as one frame; for a scene of 60, --time-codes 60. With --into, each sample is \
                   a variant of the variant set `solution`.",
        }
    }

    fn begin(&self, _path: &Path) -> Box<dyn Collection> {
        Box::new(Layer(usda::Writer::default()))
    }

    fn most(&self) -> usize {
        MOST
    }

    fn is_ours(&self, path: &Path) -> bool {
        ours::is_usda(path)
    }
}

struct Layer(usda::Writer);

impl Collection for Layer {
    fn add(&mut self, clip: &Clip<'_>, _out: &mut dyn Write) -> Result<(), ExportError> {
        self.0.add(clip);
        Ok(())
    }

    fn finish(self: Box<Self>, out: &mut dyn Write) -> Result<(), ExportError> {
        Ok(out.write_all(self.0.finish().as_bytes())?)
    }
}
