//! Materials, spheres and meshes.

use super::Text;
use crate::glb::{linear, surface};
use crate::mesh::{self, Mesh, Part};
use plaus_animation::{Animation, Colour, Form, Look, Shape};

/// All looks of an animation, each a material.
pub(super) struct Looks(Vec<Look>);

impl Looks {
    pub(super) fn of(animation: &Animation) -> Self {
        let bodies = animation.tracks.iter().flat_map(|track| {
            mesh::of_shape(&track.shape, track.look).into_iter().map(|part| part.look).collect::<Vec<_>>()
        });
        let mut looks: Vec<Look> = bodies.chain(animation.scenery.iter().map(|prop| prop.look)).collect();
        looks.sort();
        looks.dedup();
        Self(looks)
    }

    fn name(look: Look) -> String {
        let Colour([r, g, b]) = look.colour;
        format!("{:?}_{r:02x}{g:02x}{b:02x}", look.material)
    }

    pub(super) fn write(&self, text: &mut Text) {
        text.line(1, "def Scope \"Looks\"\n    {");
        for &look in &self.0 {
            let name = Self::name(look);
            let (metal, rough, opacity) = surface(look.material);
            let [r, g, b] = linear(look.colour);
            text.line(2, &format!("def Material \"{name}\"\n        {{"));
            text.line(3, &format!("token outputs:surface.connect = </plaus/Looks/{name}/surface.outputs:surface>"));
            text.line(3, "def Shader \"surface\"\n            {");
            text.line(4, "uniform token info:id = \"UsdPreviewSurface\"");
            text.line(4, &format!("color3f inputs:diffuseColor = ({r}, {g}, {b})"));
            text.line(4, &format!("float inputs:metallic = {metal}"));
            text.line(4, &format!("float inputs:roughness = {rough}"));
            text.line(4, &format!("float inputs:opacity = {opacity}"));
            text.line(4, "token outputs:surface");
            text.line(3, "}");
            text.line(2, "}");
        }
        text.line(1, "}");
    }
}

/// A body's geometry: `NAME_shape`, and `NAME_shape_1` and so on for its other parts.
pub(super) fn shape(text: &mut Text, name: &str, shape: &Shape, look: Look, looks: &Looks) {
    for (number, part) in mesh::of_shape(shape, look).iter().enumerate() {
        let name = if number == 0 { format!("{name}_shape") } else { format!("{name}_shape_{number}") };
        match shape {
            Shape::Sphere { radius, .. } if number == 0 => sphere(text, &name, *radius, look),
            _ => triangles(text, &name, part),
        }
    }
    debug_assert!(looks.0.contains(&look));
}

/// A part of the scenery: `NAME_shape`.
pub(super) fn form(text: &mut Text, name: &str, form: &Form, look: Look, looks: &Looks) {
    triangles(text, &format!("{name}_shape"), &mesh::of_form(form, look));
    debug_assert!(looks.0.contains(&look));
}

/// Opens a prim that is drawn with a look.
fn begin(text: &mut Text, kind: &str, name: &str, look: Look) {
    text.line(2, &format!("def {kind} \"{name}\" ("));
    text.line(3, "prepend apiSchemas = [\"MaterialBindingAPI\"]");
    text.line(2, ")\n        {");
    text.line(3, &format!("rel material:binding = </plaus/Looks/{}>", Looks::name(look)));
    let [r, g, b] = linear(look.colour);
    text.line(3, &format!("color3f[] primvars:displayColor = [({r}, {g}, {b})]"));
}

fn sphere(text: &mut Text, name: &str, radius: f64, look: Look) {
    begin(text, "Sphere", name, look);
    text.line(3, &format!("double radius = {radius}"));
    text.line(3, &format!("float3[] extent = [({0}, {0}, {0}), ({1}, {1}, {1})]", -radius as f32, radius as f32));
    text.line(2, "}");
}

fn triangles(text: &mut Text, name: &str, part: &Part) {
    let Mesh { positions, normals, triangles } = &part.mesh;
    if triangles.is_empty() {
        return;
    }
    let vectors = |vectors: &[[f32; 3]]| -> String {
        let each = vectors.iter().map(|[x, y, z]| format!("({x}, {y}, {z})"));
        each.collect::<Vec<_>>().join(", ")
    };
    let list = |numbers: &mut dyn Iterator<Item = u32>| -> String {
        numbers.map(|number| number.to_string()).collect::<Vec<_>>().join(", ")
    };
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for position in positions {
        for axis in 0..3 {
            low[axis] = low[axis].min(position[axis]);
            high[axis] = high[axis].max(position[axis]);
        }
    }
    begin(text, "Mesh", name, part.look);
    text.line(3, "uniform token subdivisionScheme = \"none\"");
    text.line(3, &format!("float3[] extent = [{}]", vectors(&[low, high])));
    text.line(3, &format!("point3f[] points = [{}]", vectors(positions)));
    text.line(
        3,
        &format!(
            "normal3f[] normals = [{}] (\n                interpolation = \"vertex\"\n            )",
            vectors(normals)
        ),
    );
    text.line(3, &format!("int[] faceVertexCounts = [{}]", list(&mut triangles.iter().map(|_| 3))));
    text.line(3, &format!("int[] faceVertexIndices = [{}]", list(&mut triangles.as_flattened().iter().copied())));
    text.line(2, "}");
}
