//! When bodies first touch each other or a fixed part: conservative advancement, and closed forms where there are some.

mod advancement;
mod arc;
mod block;
pub(super) mod capsules;
mod contact_spheres;
pub(super) mod convex;
mod half_space;
mod new_contacts;
mod rim;
mod sphere_mesh;
mod static_search;
mod table;
