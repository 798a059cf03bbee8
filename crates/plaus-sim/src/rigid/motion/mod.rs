//! How one body moves while nothing changes its motion: free rotation, keyframes, damping. All in closed form.

mod asymmetric_top;
pub(super) mod between_ends;
pub(super) mod damping;
mod elliptic;
pub(super) mod free_rotation;
mod inertia;
mod keyed_rotation;
pub(super) mod kinematic;
mod series;
