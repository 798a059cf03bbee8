//! How bodies in lasting contact move: an island is all bodies that touch each other, and takes its steps together.

mod arc_step;
mod articulated_step;
mod contact_forces;
mod contacts;
pub(super) mod crowd;
mod crowd_points;
mod crowd_step;
mod energy;
mod gather_ahead;
mod level_rolling;
mod pivot;
mod rattle_step;
mod rolling;
mod rolling_resistance;
mod sleep;
pub(super) mod step;
mod step_error;
mod time_stepping;
pub(super) mod truncate_step;
