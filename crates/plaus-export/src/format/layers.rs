//! Scenes for programs that draw: glTF and USD.

use super::{Collection, Exporter, Row};
use crate::clip::{Clip, ExportError};
use crate::{glb, ours, usda};
use std::io::Write;
use std::path::Path;

/// Clips of one file, which take up to 0.3 MB (GLB) or 0.5 MB (USD) of memory each.
const MOST: usize = 2000;

pub(super) struct Gltf;
pub(super) struct Usd;

impl Exporter for Gltf {
    fn row(&self) -> &'static Row {
        &Row {
            name: "glb",
            ending: "glb",
            about: "animated glTF 2.0: Blender, Godot, Unity, Unreal, browsers",
            help: "Straight lines between keys, right to 0.2 mm and 0.03 degrees in every program; with --keys exact \
                cubic splines, which programs that follow glTF play exactly, and Blender does not. A key at every \
                impact. Beside it PATH.import, which has Godot sample it densely enough. With --into, one clip a \
                sample.",
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
        self.0.add(clip)
    }

    fn finish(self: Box<Self>, out: &mut dyn Write) -> Result<(), ExportError> {
        Ok(out.write_all(&self.0.finish()?)?)
    }
}

impl Exporter for Usd {
    fn row(&self) -> &'static Row {
        &Row {
            name: "usda",
            ending: "usda",
            about: "USD as text: usdview, Houdini, Omniverse, Maya, Blender",
            help: "An animated Xform a body, meshes with materials, and physics' collision attributes on what stands still. \
                24 time codes a second, so that Blender, whose scenes have 24 frames a second and which takes a time \
                code for a frame, plays it in the right time; for a scene of 60, --time-codes 60. With --into, one \
                variant of the variant set `solution` a sample.",
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
