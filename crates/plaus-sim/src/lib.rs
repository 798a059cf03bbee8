//! Event-driven rigid-body simulator.
pub mod accuracy;
mod detect;
pub mod error;
pub mod field;
pub mod marbles;
pub mod material;
pub mod mechanics;
pub mod motion;
pub mod queue;
pub mod resolve;
pub mod rigid;
pub mod roots;
pub mod scenery;
pub mod shape;
pub mod simulate;
pub mod state;
pub mod trace;
pub mod worlds;

pub use accuracy::{Accuracy, Preset};
pub use error::WorldError;
pub use material::{Law, Laws, Material};
pub use simulate::{Outcome, Scratch};
pub use state::State;
