//! Materials of glTF for our looks.

use super::blob::pushed;
use plaus_animation::{Colour, Look, Material};
use plaus_dist::math::exp;
use serde_json::{Value, json};

/// Materials made so far: one for each look.
#[derive(Default)]
pub(super) struct Materials {
    looks: Vec<Look>,
    pub(super) list: Vec<Value>,
}

impl Materials {
    pub(super) fn index(&mut self, look: Look) -> usize {
        if let Some(index) = self.looks.iter().position(|known| *known == look) {
            return index;
        }
        // Two colours may have one name.
        let name = unique(&look.name(), " ", |name| self.list.iter().any(|known| known["name"] == name));
        self.looks.push(look);
        pushed(&mut self.list, material(look, name))
    }
}

/// A name that is not taken: the wanted one, or else the first free one with a number, from 2 on.
pub(crate) fn unique(wanted: &str, before_number: &str, taken: impl Fn(&str) -> bool) -> String {
    let numbered = (2..).map(|number| format!("{wanted}{before_number}{number}"));
    std::iter::once(wanted.to_owned()).chain(numbered).find(|name| !taken(name)).unwrap_or_default()
}

/// Metalness, roughness and opacity.
pub(crate) fn surface(material: Material) -> (f32, f32, f32) {
    match material {
        Material::Matte => (0.0, 0.9, 1.0),
        Material::Glossy => (0.0, 0.25, 1.0),
        Material::Glass => (0.0, 0.08, 0.22),
        Material::Metal => (1.0, 0.3, 1.0),
        Material::Wood => (0.0, 0.55, 1.0),
        Material::Felt => (0.0, 1.0, 1.0),
        Material::Mark => (0.0, 0.8, 0.5),
    }
}

/// A colour with linear components, for renderers.
pub(crate) fn linear(Colour(channels): Colour) -> [f32; 3] {
    channels.map(|channel| {
        let c = f64::from(channel) / 255.0;
        let linear = if c <= 0.040_45 { c / 12.92 } else { exp(2.4 * plaus_dist::math::ln((c + 0.055) / 1.055)) };
        linear as f32
    })
}

fn material(look: Look, name: String) -> Value {
    let (metal, rough, opacity) = surface(look.material);
    let [r, g, b] = linear(look.colour);
    let surface = json!({"baseColorFactor": [r, g, b, opacity], "metallicFactor": metal, "roughnessFactor": rough});
    let mut material = json!({"name": name, "pbrMetallicRoughness": surface});
    if opacity < 1.0 {
        material["alphaMode"] = "BLEND".into();
    }
    if matches!(look.material, Material::Glass) {
        material["doubleSided"] = true.into();
    }
    material
}
