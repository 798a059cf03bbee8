//! Plain worlds of the shapes that the scenes have, for tests, benchmarks and the trade-off study. The scenes build their own.

mod bins;
mod table;

pub use bins::{Bins, drops};
pub use table::DieOnTable;
