//! The binary chunk and the accessors into it.

use gltf_json::accessor::{Accessor, ComponentType, GenericComponentType, Type};
use gltf_json::buffer::{Buffer, Target, View};
use gltf_json::validation::Checked::Valid;
use gltf_json::validation::USize64;
use gltf_json::{Index, Root};
use serde_json::Value;

/// Bytes so far; every view begins at a multiple of four.
#[derive(Default)]
pub(super) struct Blob(Vec<u8>);

/// What is stored in a view.
struct Content {
    component: ComponentType,
    type_: Type,
    count: usize,
    target: Option<Target>,
    range: Option<(Value, Value)>,
}

impl Blob {
    /// Attributes of a mesh's corners; positions must say their range.
    pub(super) fn points(&mut self, root: &mut Root, points: &[[f32; 3]], ranged: bool) -> Index<Accessor> {
        let target = Some(Target::ArrayBuffer);
        let range = ranged.then(|| range(points));
        let content = Content { component: ComponentType::F32, type_: Type::Vec3, count: points.len(), target, range };
        self.push(root, floats(points.as_flattened()), content)
    }

    /// Texture coordinates.
    pub(super) fn uvs(&mut self, root: &mut Root, uvs: &[[f32; 2]]) -> Index<Accessor> {
        let target = Some(Target::ArrayBuffer);
        let content =
            Content { component: ComponentType::F32, type_: Type::Vec2, count: uvs.len(), target, range: None };
        self.push(root, floats(uvs.as_flattened()), content)
    }

    /// Corners of triangles, in two bytes each if that is enough.
    pub(super) fn indices(&mut self, root: &mut Root, indices: &[u32]) -> Index<Accessor> {
        let short: Option<Vec<u16>> =
            indices.iter().map(|&i| u16::try_from(i).ok().filter(|&i| i < u16::MAX)).collect();
        let (component, bytes): (_, Vec<u8>) = match short {
            Some(short) => (ComponentType::U16, short.iter().flat_map(|i| i.to_le_bytes()).collect()),
            None => (ComponentType::U32, indices.iter().flat_map(|i| i.to_le_bytes()).collect()),
        };
        let target = Some(Target::ElementArrayBuffer);
        let content = Content { component, type_: Type::Scalar, count: indices.len(), target, range: None };
        self.push(root, bytes, content)
    }

    /// Times of keys, in s.
    pub(super) fn times(&mut self, root: &mut Root, times: &[f32]) -> Index<Accessor> {
        let ends = times.first().zip(times.last());
        let range = ends.map(|(&first, &last)| (Value::from(vec![first]), Value::from(vec![last])));
        let content =
            Content { component: ComponentType::F32, type_: Type::Scalar, count: times.len(), target: None, range };
        self.push(root, floats(times), content)
    }

    /// Values of keys: vectors of three or four.
    pub(super) fn values<const N: usize>(&mut self, root: &mut Root, values: &[[f32; N]]) -> Index<Accessor> {
        let type_ = if N == 3 { Type::Vec3 } else { Type::Vec4 };
        let content = Content { component: ComponentType::F32, type_, count: values.len(), target: None, range: None };
        self.push(root, floats(values.as_flattened()), content)
    }

    fn push(&mut self, root: &mut Root, bytes: Vec<u8>, content: Content) -> Index<Accessor> {
        let view = root.push(View {
            buffer: Index::new(0),
            byte_length: USize64::from(bytes.len()),
            byte_offset: Some(USize64::from(self.0.len())),
            byte_stride: None,
            name: None,
            target: content.target.map(Valid),
            extensions: None,
            extras: None,
        });
        self.0.extend(bytes);
        self.0.resize(self.0.len().next_multiple_of(4), 0);
        let (min, max) = content.range.unzip();
        root.push(Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: USize64::from(content.count),
            component_type: Valid(GenericComponentType(content.component)),
            extensions: None,
            extras: None,
            type_: Valid(content.type_),
            min,
            max,
            name: None,
            normalized: false,
            sparse: None,
        })
    }

    /// Declares the buffer; gives its bytes.
    pub(super) fn finish(self, root: &mut Root) -> Vec<u8> {
        if !self.0.is_empty() {
            let byte_length = USize64::from(self.0.len());
            root.push(Buffer { byte_length, name: None, uri: None, extensions: None, extras: None });
        }
        self.0
    }
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// The smallest box along the axes that holds all points.
fn range(points: &[[f32; 3]]) -> (Value, Value) {
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for point in points {
        for axis in 0..3 {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
    (Value::from(low.to_vec()), Value::from(high.to_vec()))
}
