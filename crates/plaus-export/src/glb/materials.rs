//! Materials of glTF for our looks.

use gltf_json::material::{AlphaMode, PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor};
use gltf_json::validation::Checked::Valid;
use gltf_json::{Index, Root};
use plaus_dist::math::exp;
use plaus_animation::{Colour, Look, Material};

/// Materials made so far: one a look.
#[derive(Default)]
pub(super) struct Materials(Vec<(Look, Index<gltf_json::Material>)>);

impl Materials {
    pub(super) fn index(&mut self, root: &mut Root, look: Look) -> Index<gltf_json::Material> {
        if let Some((_, index)) = self.0.iter().find(|(known, _)| *known == look) {
            return *index;
        }
        let index = root.push(material(look));
        self.0.push((look, index));
        index
    }
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

/// A colour with linear components, as renderers want it.
pub(crate) fn linear(Colour(channels): Colour) -> [f32; 3] {
    channels.map(|channel| {
        let c = f64::from(channel) / 255.0;
        let linear = if c <= 0.040_45 { c / 12.92 } else { exp(2.4 * plaus_dist::math::ln((c + 0.055) / 1.055)) };
        linear as f32
    })
}

fn material(look: Look) -> gltf_json::Material {
    let (metal, rough, opacity) = surface(look.material);
    let [r, g, b] = linear(look.colour);
    let Colour([red, green, blue]) = look.colour;
    let kind = format!("{:?}", look.material).to_lowercase();
    gltf_json::Material {
        name: Some(format!("{kind}_{red:02x}{green:02x}{blue:02x}")),
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
