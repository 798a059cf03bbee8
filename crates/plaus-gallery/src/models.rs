//! Things to draw, each stored once: models of bodies and parts of the scenery.

use plaus_export::mesh::{self, Mesh, Part};
use plaus_scenes::animation::{Form, Look, Prop, Shape, Track};
use serde_json::{Value, json};
use std::sync::Arc;

/// Bytes so far; stored data is found by its offset.
#[derive(Debug, Default)]
pub(crate) struct Bytes(pub(crate) Vec<u8>);

impl Bytes {
    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    pub(crate) fn u16s(&mut self, values: impl IntoIterator<Item = u16>) {
        self.0.extend(values.into_iter().flat_map(u16::to_le_bytes));
    }

    pub(crate) fn i16s(&mut self, values: impl IntoIterator<Item = i16>) {
        self.0.extend(values.into_iter().flat_map(i16::to_le_bytes));
    }

    pub(crate) fn f32s(&mut self, values: impl IntoIterator<Item = f64>) {
        self.0.extend(values.into_iter().flat_map(|value| (value as f32).to_le_bytes()));
    }

    /// A mesh, with corners as 16-bit shares of the box that holds it.
    fn mesh(&mut self, mesh: &Mesh) -> Value {
        let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for position in &mesh.positions {
            for axis in 0..3 {
                low[axis] = low[axis].min(position[axis]);
                high[axis] = high[axis].max(position[axis]);
            }
        }
        let at = self.len();
        for axis in 0..3 {
            let size = (high[axis] - low[axis]).max(f32::MIN_POSITIVE);
            let share = |position: &[f32; 3]| ((position[axis] - low[axis]) / size * 65535.0).round() as u16;
            self.u16s(mesh.positions.iter().map(share));
        }
        for axis in 0..3 {
            self.0.extend(mesh.normals.iter().map(|normal| (normal[axis] * 127.0).round() as i8 as u8));
        }
        if self.len() % 2 == 1 {
            self.0.push(0);
        }
        let wide = mesh.positions.len() > usize::from(u16::MAX);
        let corners = mesh.triangles.as_flattened();
        if wide {
            self.0.extend(corners.iter().flat_map(|corner| corner.to_le_bytes()));
        } else {
            self.u16s(corners.iter().map(|&corner| corner as u16));
        }
        json!({"at": at, "corners": mesh.positions.len(), "indices": corners.len(), "wide": wide, "low": low, "high": high})
    }
}

/// All models and props of a page.
#[derive(Debug, Default)]
pub(crate) struct Things {
    models: Vec<(Arc<Shape>, Look)>,
    props: Vec<Prop>,
    pub(crate) model_list: Vec<Value>,
    pub(crate) prop_list: Vec<Value>,
}

impl Things {
    /// Number of the model of a body.
    pub(crate) fn model(&mut self, bytes: &mut Bytes, track: &Track) -> usize {
        let known = self.models.iter().position(|(shape, look)| (shape, *look) == (&track.shape, track.look));
        known.unwrap_or_else(|| {
            let parts: Vec<Value> =
                mesh::of_shape(&track.shape, track.look).iter().map(|part| of_part(bytes, part)).collect();
            // A plain ball looks the same however it is turned.
            let round = matches!(*track.shape, Shape::Sphere { holes: false, .. });
            self.model_list.push(json!({"parts": parts, "reach": track.shape.reach(), "round": round}));
            self.models.push((track.shape.clone(), track.look));
            self.models.len() - 1
        })
    }

    /// Number of a part of the scenery.
    pub(crate) fn prop(&mut self, bytes: &mut Bytes, prop: &Prop) -> usize {
        self.props.iter().position(|known| known == prop).unwrap_or_else(|| {
            self.prop_list.push(match &prop.form {
                Form::Heightfield { origin, step, columns, heights } => {
                    let low = heights.iter().copied().fold(f64::INFINITY, f64::min);
                    let high = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                    let size = (high - low).max(f64::MIN_POSITIVE);
                    let at = bytes.len();
                    bytes.u16s(heights.iter().map(|height| ((height - low) / size * 65535.0).round() as u16));
                    let grid = json!({"at": at, "origin": origin.to_array(), "step": step, "columns": columns,
                        "count": heights.len(), "low": low, "high": high});
                    json!({"name": prop.name, "look": look(prop.look), "grid": grid})
                }
                form => {
                    let part = of_part(bytes, &mesh::of_form(form, prop.look));
                    json!({"name": prop.name, "look": part["look"], "mesh": part["mesh"]})
                }
            });
            self.props.push(prop.clone());
            self.props.len() - 1
        })
    }
}

fn of_part(bytes: &mut Bytes, part: &Part) -> Value {
    json!({"look": look(part.look), "mesh": bytes.mesh(&part.mesh)})
}

fn look(look: Look) -> Value {
    json!({"colour": look.colour, "material": look.material, "name": look.name()})
}
