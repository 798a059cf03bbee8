//! Where bodies touch each other and the fixed parts at one moment: points, normals, gaps, and what identifies them.
//! `dispatch.rs` says which algorithm serves which pair of shapes.

pub(super) mod arc;
pub(super) mod capsules;
pub(super) mod contact_id;
mod contact_law;
pub(super) mod contact_point;
pub(super) mod convex_contacts;
mod dispatch;
pub(super) mod facets;
pub(super) mod foot;
pub(super) mod ground;
pub(super) mod regions;
mod revolution;
pub(super) mod seams;
pub(super) mod sphere_mesh;
mod spheres;
pub(super) mod static_collider;
mod static_contacts;
