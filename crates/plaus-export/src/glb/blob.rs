//! The binary chunk, and the views and accessors that tell what is in it.

use serde_json::{Value, json};

/// Types of numbers and uses of views, as glTF numbers them.
const U16: u32 = 5123;
const U32: u32 = 5125;
const F32: u32 = 5126;
const CORNERS: u32 = 34962;
const TRIANGLES: u32 = 34963;

/// Bytes so far; every view begins at a multiple of four.
#[derive(Default)]
pub(super) struct Blob {
    pub(super) bytes: Vec<u8>,
    pub(super) views: Vec<Value>,
    pub(super) accessors: Vec<Value>,
}

impl Blob {
    /// Attributes of a mesh's corners; positions must say their range.
    pub(super) fn points(&mut self, points: &[[f32; 3]], ranged: bool) -> usize {
        let index = self.floats(points.as_flattened(), 3, Some(CORNERS));
        if ranged {
            let [low, high] = range(points);
            self.ranged(index, low.to_vec(), high.to_vec());
        }
        index
    }

    /// Texture coordinates.
    pub(super) fn uvs(&mut self, uvs: &[[f32; 2]]) -> usize {
        self.floats(uvs.as_flattened(), 2, Some(CORNERS))
    }

    /// Corners of triangles, in two bytes each if that is enough.
    pub(super) fn indices(&mut self, indices: &[u32]) -> usize {
        let short = indices.iter().all(|&index| index < u32::from(u16::MAX));
        let width = if short { 2 } else { 4 };
        let bytes = indices.iter().flat_map(|index| index.to_le_bytes().into_iter().take(width)).collect();
        self.push(bytes, if short { U16 } else { U32 }, (indices.len(), "SCALAR"), Some(TRIANGLES))
    }

    /// Times of keys, in s.
    pub(super) fn times(&mut self, times: &[f32]) -> usize {
        let index = self.floats(times, 1, None);
        if let (Some(&first), Some(&last)) = (times.first(), times.last()) {
            self.ranged(index, vec![first], vec![last]);
        }
        index
    }

    /// Values of keys: vectors of three or four.
    pub(super) fn values<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        self.floats(values.as_flattened(), N, None)
    }

    fn floats(&mut self, values: &[f32], each: usize, target: Option<u32>) -> usize {
        let bytes = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][each - 1];
        self.push(bytes, F32, (values.len() / each, kind), target)
    }

    fn push(&mut self, bytes: Vec<u8>, component: u32, (count, kind): (usize, &str), target: Option<u32>) -> usize {
        let mut view = json!({"buffer": 0, "byteLength": bytes.len(), "byteOffset": self.bytes.len()});
        if let Some(target) = target {
            view["target"] = target.into();
        }
        let accessor =
            json!({"bufferView": self.views.len(), "count": count, "componentType": component, "type": kind});
        self.bytes.extend(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(view);
        pushed(&mut self.accessors, accessor)
    }

    fn ranged(&mut self, index: usize, low: Vec<f32>, high: Vec<f32>) {
        self.accessors[index]["min"] = low.into();
        self.accessors[index]["max"] = high.into();
    }
}

/// Adds to a list, whose entries name each other by number; gives the number.
pub(super) fn pushed(list: &mut Vec<Value>, thing: Value) -> usize {
    list.push(thing);
    list.len() - 1
}

/// The smallest box along the axes that holds all points.
fn range(points: &[[f32; 3]]) -> [[f32; 3]; 2] {
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for point in points {
        for axis in 0..3 {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
    [low, high]
}
