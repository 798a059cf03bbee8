//! What all scenes have in common: weights of moves by name, columns from declared variables, bodies simulated group by
//! group, what makes solutions different.

pub mod columns;
pub(crate) mod distinct;
pub(crate) mod groups;
mod offered;
mod row;
mod unmet;
pub mod weights;

pub use columns::{Column, Member, Role, Scalar};
pub use distinct::Features;
pub(crate) use unmet::unmet;
pub use weights::{Menu, Moves, Printed, Row, Weights};
