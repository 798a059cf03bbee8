//! The moves of the 2D ball, one a file.

mod aim;
mod landing;
mod perturb;
mod redraw;
mod roots;

pub use aim::Aim;
pub(super) use aim::reach;
pub use perturb::Perturb;
pub use redraw::Redraw;
