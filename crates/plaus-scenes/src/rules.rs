//! Acceptance rules: exact, or as printed in the paper.
//!
//! Each erratum of the paper that changes the law the chain samples has a flag of its own. With any flag on, it is
//! unknown what law the chain converges to, or whether it converges. The flags exist to reproduce what the paper shows.

use plaus_mcmc::Recipe;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A named set of flags.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// Every ratio is the true one: the chain leaves the target invariant.
    #[default]
    Exact,
    /// Every ratio is as printed in the paper, errata included.
    AsPrinted,
}

/// The acceptance rules of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Rules {
    /// Which set of flags to start from: "exact" or "as-printed".
    pub preset: Preset,
    /// Accept moves that redraw values as if they were symmetric, as the paper does (its A.2 and 5.3). The true ratio
    /// divides by the prior. Unset: decided by `preset`.
    pub symmetric_redraws: Option<bool>,
    /// Draw new offsets of points in a random direction with a Gaussian length, as the paper does (its A.2, B.1 and
    /// B.2), although its prior is Gaussian in each coordinate. Unset: decided by `preset`.
    pub radial_offsets: Option<bool>,
    /// Accept moves that add or remove some of many balls by the factor of the area alone, as the paper does (its B.2,
    /// with that factor inverted: as printed, the choice of the unit of length would empty or fill the box). The true
    /// ratio also counts the balls that the move left unchanged. Unset: decided by `preset`.
    pub incomplete_toggles: Option<bool>,
}

impl Rules {
    /// Every ratio is the true one.
    #[must_use]
    pub fn exact() -> Self {
        Self::default()
    }

    /// Whether moves that redraw values count as symmetric.
    #[must_use]
    pub fn symmetric_redraws(&self) -> bool {
        self.symmetric_redraws.unwrap_or(self.preset == Preset::AsPrinted)
    }

    /// Whether new offsets have a random direction and a Gaussian length.
    #[must_use]
    pub fn radial_offsets(&self) -> bool {
        self.radial_offsets.unwrap_or(self.preset == Preset::AsPrinted)
    }

    /// How new offsets are drawn.
    #[must_use]
    pub fn recipe(&self) -> Recipe {
        if self.radial_offsets() { Recipe::Radial } else { Recipe::Exact }
    }

    /// Whether moves that add or remove balls ignore the balls that they left unchanged.
    #[must_use]
    pub fn incomplete_toggles(&self) -> bool {
        self.incomplete_toggles.unwrap_or(self.preset == Preset::AsPrinted)
    }

    /// The flags as they stand, by name: what a run records.
    #[must_use]
    pub fn flags(&self) -> Vec<(&'static str, bool)> {
        vec![
            ("symmetric_redraws", self.symmetric_redraws()),
            ("radial_offsets", self.radial_offsets()),
            ("incomplete_toggles", self.incomplete_toggles()),
        ]
    }

    /// Whether the chain is guaranteed to leave the target invariant.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.flags().iter().all(|(_, on)| !on)
    }
}
