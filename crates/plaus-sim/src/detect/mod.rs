//! When a ball next touches something: detection, which changes nothing and never calls resolution.

mod pair;
mod sphere;
mod walk;

pub(crate) use pair::sphere_pair;
pub(crate) use sphere::{Stretch, sphere_on_mesh};
pub(crate) use walk::next_surface;
