//! Simple worlds with the shapes of the scenes, for tests, benchmarks and the trade-off study. The scenes build their
//! own.

mod alley;
mod bins;
mod pool;
mod still;
mod table;
mod verdict;
mod watch;

pub use alley::Alley;
pub use bins::{Bins, drops};
pub use still::Still;
pub use table::DieOnTable;
pub use verdict::Verdict;
pub use watch::Watch;
