//! Plain worlds of the shapes that the scenes have, for tests, benchmarks and the trade-off study. The scenes build their own.

mod bins;
mod watch;

pub use bins::{Bins, drops};
pub use watch::Watch;
