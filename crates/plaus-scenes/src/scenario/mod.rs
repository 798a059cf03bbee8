//! Scenario files: TOML that says which world to sample, and how.

mod keys;
mod problem;

pub use keys::{KeyDoc, explain, keys, schema, template};
pub use problem::{Problem, ScenarioError, Source};

use crate::registry::World;
use crate::rules::Rules;
use crate::scene::ConfigError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A scenario: a world and how to sample it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// How to sample.
    #[serde(default)]
    pub sampler: Sampler,
    /// What to sample: exactly one table `[world.SCENE]`.
    pub world: World,
}

/// How to sample.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Sampler {
    /// Seed of all randomness. The same scenario, seed and version give the same bits.
    pub seed: u64,
    /// Number of independent chains.
    #[schemars(range(min = 1, max = 100_000))]
    pub chains: u32,
    /// Iterations before sampling begins: recorded, but kept out of tables and diagnostics.
    #[schemars(range(min = 0, max = 1_000_000_000_000_u64))]
    pub warmup: u64,
    /// Iterations of each chain after the warm-up.
    #[schemars(range(min = 1, max = 1_000_000_000_000_u64))]
    pub iterations: u64,
    /// Record every so-manieth iteration.
    #[schemars(range(min = 1, max = 1_000_000_000_u64))]
    pub thin: u64,
    /// Iterations between two checkpoints of a chain.
    #[schemars(range(min = 1, max = 1_000_000_000_u64))]
    pub checkpoint_every: u64,
    /// Exact acceptance, or the paper's as printed.
    pub rules: Rules,
}

impl Default for Sampler {
    fn default() -> Self {
        Self {
            seed: 1,
            chains: 4,
            warmup: 1000,
            iterations: 10_000,
            thin: 1,
            checkpoint_every: 20_000,
            rules: Rules::default(),
        }
    }
}

impl Scenario {
    /// Reads a scenario.
    ///
    /// # Errors
    /// [`ScenarioError`] with all problems.
    pub fn read(name: &str, text: &str, overrides: &[String]) -> Result<Self, ScenarioError> {
        let _ = overrides;
        toml::from_str(text).map_err(|error| {
            let problem = Problem::new("", error.message()).at(&Source::File, error.span());
            ScenarioError::new(name, text, vec![problem])
        })
    }

    /// The whole effective scenario as TOML; reading it back gives an equal scenario.
    #[must_use]
    pub fn to_toml(&self) -> String {
        toml::to_string(self).unwrap_or_default()
    }

    /// The scenario of a scene with all settings at their defaults.
    #[must_use]
    pub fn default_of(scene: &str) -> Option<Self> {
        World::default_of(scene).map(|world| Self { sampler: Sampler::default(), world })
    }
}

impl ScenarioError {
    /// An error found later by the scene, blamed on its key's place in the file.
    #[must_use]
    pub fn locate(name: &str, text: &str, error: &ConfigError) -> Self {
        Self::new(name, text, vec![Problem::new(error.key.clone(), error.message.clone()).with_help(None)])
    }
}
