//! What all scenes have in common: weights of moves by name, columns from declared variables, bodies simulated group by
//! group.

pub mod columns;
pub(crate) mod groups;
mod offered;
mod row;
mod unmet;
pub mod weights;

pub use columns::{Column, Member, Role, Scalar};
pub(crate) use unmet::unmet;
pub use weights::{Menu, Moves, Printed, Row, Weights};

/// The least size of steps of all scales.
const FINEST: f64 = 1e-3;
