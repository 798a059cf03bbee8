//! Checks what the GLB reader takes for granted: that a file's numbers lie within the file.

use gltf::Accessor;

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
