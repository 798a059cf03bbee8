//! Materials of glTF for our looks.

use gltf_json::material::{AlphaMode, PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor};
use gltf_json::validation::Checked::Valid;
use gltf_json::{Index, Root};
use plaus_animation::{Colour, Look, Material};
use plaus_dist::math::exp;

/// Materials made so far: one for each look.
#[derive(Default)]
pub(super) struct Materials(Vec<(Look, Index<gltf_json::Material>)>);

impl Materials {
    pub(super) fn index(&mut self, root: &mut Root, look: Look) -> Index<gltf_json::Material> {
        if let Some((_, index)) = self.0.iter().find(|(known, _)| *known == look) {
            return *index;
        }
        // Two colours may have one name.
        let name =
            unique(&look.name(), " ", |name| root.materials.iter().any(|known| known.name.as_deref() == Some(name)));
        let index = root.push(material(look, name));
        self.0.push((look, index));
        index
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

fn material(look: Look, name: String) -> gltf_json::Material {
    let (metal, rough, opacity) = surface(look.material);
    let [r, g, b] = linear(look.colour);
    gltf_json::Material {
        name: Some(name),
        alpha_mode: Valid(if opacity < 1.0 { AlphaMode::Blend } else { AlphaMode::Opaque }),
        double_sided: matches!(look.material, Material::Glass),
        pbr_metallic_roughness: PbrMetallicRoughness {
            base_color_factor: PbrBaseColorFactor([r, g, b, opacity]),
            metallic_factor: StrengthFactor(metal),
            roughness_factor: StrengthFactor(rough),
            ..PbrMetallicRoughness::default()
        },
        ..gltf_json::Material::default()
    }
}
