//! Models in MJCF, the XML format of MuJoCo.

mod known;
mod settings;
mod tree;
pub(super) mod words;

use super::AssetError;
use super::model::Model;
use super::unread::unread;
use super::xml::Element;

/// The model with this root.
pub(super) fn model(root: &Element) -> Result<Model, AssetError> {
    let settings = settings::Settings::read(root)?;
    let bodies = tree::bodies(root, &settings)?;
    let [left_out, harmless] = unread(root, &known::KNOWN);
    Ok(Model {
        gravity: settings.gravity,
        bodies,
        meshes: settings.meshes,
        are_hulls: true,
        passes_itself: false,
        left_out,
        harmless,
    })
}
