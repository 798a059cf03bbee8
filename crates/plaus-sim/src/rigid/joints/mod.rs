//! Joints: what holds bodies together, and their part in the steps of an island.

pub(super) mod constraints;
pub(super) mod joint;
pub(super) mod suzuki4;
