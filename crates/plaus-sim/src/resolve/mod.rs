//! Impact laws: velocities before to velocities after, and nothing else. They know no time, no shape and no queue.

mod path;
mod sphere;
mod stronge;

pub use sphere::{Impulse, Touch, sphere_impact};
pub use stronge::{ContactMatrix, stronge_impulse};
