//! The moves of the 2D ball, one a file.

mod aim;
mod perturb;
mod redraw;
mod roots;

pub use aim::Aim;
pub use perturb::Perturb;
pub use redraw::Redraw;
