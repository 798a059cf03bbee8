//! What is simulated beside what was published of the real thing: `cargo xtask plausibility`.
//!
//! Plausible in the paper's own sense (section 3.3): a simulation that is drawn from the prior should be as often this
//! or that as the real thing is. Counts of either are compared, each with its error, and what is not published and had
//! to be chosen is varied in the open.

mod bowling;
mod chance;
mod dice;
mod tosses;

use crate::Make;

/// What the report begins with.
pub(crate) const HEADING: &str = "# What is simulated beside what was published of the real thing\n\n\
    Made by one command from fixed seeds; a second run of the same version gives the same bytes:\n\n    cargo xtask plausibility\n\n";

/// Scenes with published statistics.
pub(crate) const SCENES: &[(&str, Make)] =
    &[("tosses", tosses::make), ("dice", dice::make), ("bowling", bowling::make)];
