//! What is simulated, compared with what was published about real things: `cargo xtask plausibility`.
//!
//! Plausible has the paper's meaning (section 3.3): simulations that are drawn from the prior should give each outcome
//! as often as the real thing does. Both counts are compared, each with its error. Properties that are not published,
//! and had to be chosen, are varied in the open.

mod bowling;
mod chance;
mod dice;
mod tosses;

use crate::Make;

/// The beginning of the report.
pub(crate) const HEADING: &str = "# What is simulated beside what was published of the real thing\n\n\
    Made by one command from fixed seeds; a second run of the same version gives the same bytes:\n\n    cargo xtask plausibility\n\n";

/// Scenes with published statistics.
pub(crate) const SCENES: &[(&str, Make)] =
    &[("tosses", tosses::make), ("dice", dice::make), ("bowling", bowling::make)];
