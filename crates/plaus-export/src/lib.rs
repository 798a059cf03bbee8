//! Animations for other programs: animated glTF, USD, tables of poses and impacts.
//!
//! ```
//! use glam::DVec3;
//! use plaus_export::{Clip, Cut, Label, glb};
//! use plaus_animation::{Animation, Look, Piece, Shape, Track};
//!
//! let fall = Piece::ballistic(0.0, DVec3::Y, DVec3::ZERO, DVec3::new(0.0, -9.81, 0.0));
//! let animation = Animation::new(0.4, vec![Track::new("ball_0", Shape::ball(0.05), Look::nth(0), vec![fall])], vec![]);
//! let cut = Cut::new(60.0, None, &animation)?;
//! let bytes = glb::to_vec(&Clip::new(&animation, &Label::new("falling"), cut))?;
//! assert_eq!(&bytes[..4], b"glTF");
//! # Ok::<(), plaus_export::ExportError>(())
//! ```
//!
//! | module | writes |
//! | --- | --- |
//! | [`glb`] | animated glTF 2.0 in one binary file, of one clip or of several; [`glb::godot_import`] goes beside it |
//! | [`usda`] | USD as text: an animated `Xform` for each body, with uniquely named geometry under it; several clips are variants |
//! | [`table`] | poses and impacts, one in each row |
//! | [`mesh`] | triangles of shapes, which all of them use |
//!
//! [`thin`] chooses the keys of GLB and USDA: straight lines between them are right to 0.2 mm and 0.03°, in every
//! program. Tables have a key at every frame, at the start of every piece of the motion, and at every impact. Times
//! count from the start of the [`Cut`].

pub mod clip;
pub mod format;
pub mod glb;
pub mod keys;
pub mod mesh;
pub mod ours;
pub mod sound;
pub mod table;
pub mod thin;
pub mod usda;

pub use clip::{Between, Clip, Cut, Engines, ExportError, Label, Style, Up};
pub use format::Exporter;
