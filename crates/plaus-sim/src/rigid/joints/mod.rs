//! Joints: what holds bodies together, and their part in the steps of an island.

pub(super) mod axis;
pub(super) mod constraints;
mod dynamics;
mod joining;
pub(super) mod joint;
pub(super) mod runge_kutta;
pub(super) mod string;
pub(super) mod tree;
