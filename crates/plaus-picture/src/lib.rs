//! Pictures and videos of animations: rays traced on the processor, the same pixels on every machine.
//!
//! ```
//! use glam::DVec3;
//! use plaus_animation::{Animation, Look, Piece, Shape, Track};
//! use plaus_picture::{Camera, Quality, Renderer};
//!
//! let fall = Piece::ballistic(0.0, DVec3::Y, DVec3::ZERO, DVec3::new(0.0, -9.81, 0.0));
//! let animation = Animation::new(0.4, vec![Track::new("ball_0", Shape::ball(0.05), Look::nth(0), vec![fall])], vec![]);
//! let camera = Camera::of(&animation, [0.0, 0.4], 16.0 / 9.0);
//! let image = Renderer::new(&animation, camera, Quality { width: 64, height: 36, rays: 1 }).at(0.2);
//! assert_eq!(image.bytes().len(), 3 * 64 * 36);
//! ```
//!
//! [`ALL`] lists the formats: PNG, GIF, and MP4 if the program `ffmpeg` is installed.

mod bvh;
mod camera;
mod changes;
mod drawing;
mod format;
mod image;
mod noise;
mod render;
mod shade;

pub use camera::Camera;
pub use format::ALL;
pub use image::Image;
pub use render::{Film, Quality, Renderer};
