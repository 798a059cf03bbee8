//! Materials, spheres and meshes.

use super::text::{MATERIALS, Text, identifier};
use crate::glb::{linear, surface, unique};
use crate::mesh::{self, Mesh, Part};
use plaus_animation::{Form, Look, Shape};

/// All looks of a layer, each a material.
#[derive(Default)]
pub(super) struct Looks(Vec<(Look, String)>);

impl Looks {
    pub(super) fn add(&mut self, look: Look) {
        if !self.0.iter().any(|(known, _)| *known == look) {
            let wanted = identifier(&look.name());
            let name = unique(&wanted, "_", |name| self.0.iter().any(|(_, known)| known == name));
            self.0.push((look, name));
        }
    }

    pub(super) fn add_shape(&mut self, shape: &Shape, look: Look) {
        mesh::of_shape(shape, look).iter().for_each(|part| self.add(part.look));
    }

    fn name(&self, look: Look) -> &str {
        self.0.iter().find(|(known, _)| *known == look).map_or("", |(_, name)| name)
    }

    pub(super) fn write(&self, text: &mut Text) {
        text.line(1, &format!("def Scope \"{MATERIALS}\"\n    {{"));
        for (look, name) in &self.0 {
            let (metal, rough, opacity) = surface(look.material);
            let [r, g, b] = linear(look.colour);
            text.line(2, &format!("def Material \"{name}\"\n        {{"));
            text.line(
                3,
                &format!("token outputs:surface.connect = </plaus/{MATERIALS}/{name}/surface.outputs:surface>"),
            );
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
        triangles(text, &name, part, false, looks);
    }
}

/// A part of the scenery: `NAME_shape`. If it is solid, other things can collide with it.
pub(super) fn form(text: &mut Text, name: &str, form: &Form, look: Look, solid: bool, looks: &Looks) {
    triangles(text, &format!("{name}_shape"), &mesh::of_form(form, look), solid, looks);
}

/// Opens a mesh that is drawn with a look.
fn begin(text: &mut Text, name: &str, look: Look, solid: bool, looks: &Looks) {
    text.line(2, &format!("def Mesh \"{name}\" ("));
    let solid_too = if solid { ", \"PhysicsCollisionAPI\", \"PhysicsMeshCollisionAPI\"" } else { "" };
    text.line(3, &format!("prepend apiSchemas = [\"MaterialBindingAPI\"{solid_too}]"));
    text.line(2, ")\n        {");
    text.line(3, &format!("rel material:binding = </plaus/{MATERIALS}/{}>", looks.name(look)));
    let [r, g, b] = linear(look.colour);
    text.line(3, &format!("color3f[] primvars:displayColor = [({r}, {g}, {b})]"));
    if solid {
        text.line(3, "uniform token physics:approximation = \"none\"");
    }
}

fn triangles(text: &mut Text, name: &str, part: &Part, solid: bool, looks: &Looks) {
    let Mesh { positions, normals, uvs, triangles } = &part.mesh;
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
    begin(text, name, part.look, solid, looks);
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
    // USD's textures begin at the lower left.
    let pairs = uvs.iter().map(|[u, v]| format!("({u}, {})", 1.0 - v)).collect::<Vec<_>>().join(", ");
    let uvs =
        format!("texCoord2f[] primvars:st = [{pairs}] (\n                interpolation = \"vertex\"\n            )");
    text.line(3, &uvs);
    text.line(3, &format!("int[] faceVertexCounts = [{}]", list(&mut triangles.iter().map(|_| 3))));
    text.line(3, &format!("int[] faceVertexIndices = [{}]", list(&mut triangles.as_flattened().iter().copied())));
    text.line(2, "}");
}
