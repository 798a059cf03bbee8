//! Checks what the GLB reader takes for granted: that a file's numbers lie within the file.

use gltf::accessor::{DataType, Dimensions};
use gltf::animation::Property;
use gltf::{Accessor, Document, Semantic};
use serde_json::Value;

/// The first attribute of a mesh that names no accessor, in words. The reader's own checks take for granted that there
/// is none.
pub(super) fn unknown_accessor(json: &Value) -> Option<String> {
    let count = json["accessors"].as_array().map_or(0, Vec::len) as u64;
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    for (index, mesh) in list(&json["meshes"]).iter().enumerate() {
        for primitive in list(&mesh["primitives"]) {
            let attributes = primitive["attributes"].as_object().cloned().unwrap_or_default();
            if let Some((name, _)) =
                attributes.iter().find(|(_, accessor)| accessor.as_u64().is_none_or(|k| k >= count))
            {
                return Some(format!("{name} of mesh {index} names none of its {count} accessors"));
            }
        }
    }
    None
}

/// Whether all numbers of an accessor lie in the file's own data. The reader divides and subtracts without checking.
pub(super) fn is_sound(accessor: &Accessor<'_>, blob: &[u8]) -> bool {
    let Some(view) = accessor.view().filter(|_| accessor.sparse().is_none()) else { return false };
    let (size, count) = (accessor.size(), accessor.count());
    let stride = view.stride().unwrap_or(size);
    let end = count
        .checked_sub(1)
        .and_then(|steps| steps.checked_mul(stride))
        .and_then(|length| length.checked_add(size))
        .and_then(|length| length.checked_add(accessor.offset()));
    let view_end = view.offset().checked_add(view.length());
    view.buffer().index() == 0
        && stride >= size
        && end.is_some_and(|end| end <= view.length())
        && view_end.is_some_and(|end| end <= blob.len())
}

/// What has numbers of a type that it cannot have, in words: corners of meshes, their faces, or keys. The reader takes
/// for granted that nothing has.
pub(super) fn wrong_type(document: &Document) -> Option<String> {
    use DataType::{F32, I8, I16, U8, U16, U32};
    let is = |accessor: &Accessor<'_>, dimensions: Dimensions, types: &[DataType]| {
        accessor.dimensions() == dimensions && types.contains(&accessor.data_type())
    };
    for mesh in document.meshes() {
        for primitive in mesh.primitives() {
            if primitive.get(&Semantic::Positions).is_some_and(|all| !is(&all, Dimensions::Vec3, &[F32])) {
                return Some(format!("corners of mesh {}, which must be three floats each", mesh.index()));
            }
            if primitive.indices().is_some_and(|all| !is(&all, Dimensions::Scalar, &[U8, U16, U32])) {
                return Some(format!("faces of mesh {}, which must be unsigned integers", mesh.index()));
            }
        }
    }
    for animation in document.animations() {
        for channel in animation.channels() {
            let (sampler, property) = (channel.sampler(), channel.target().property());
            let (dimensions, types): (_, &[DataType]) = match property {
                Property::Translation | Property::Scale => (Dimensions::Vec3, &[F32]),
                Property::Rotation => (Dimensions::Vec4, &[F32, I8, U8, I16, U16]),
                Property::MorphTargetWeights => (Dimensions::Scalar, &[F32, I8, U8, I16, U16]),
            };
            if !is(&sampler.input(), Dimensions::Scalar, &[F32]) || !is(&sampler.output(), dimensions, types) {
                return Some(format!(
                    "keys of animation {}, of which the numbers are of another type",
                    animation.index()
                ));
            }
        }
    }
    None
}
