//! How a run's draws are made: by chains, by climbs and then chains, or as independent draws of the prior.

use plaus_mcmc::{Independent, Mixture};
use plaus_scenes::scenario::Method;
use plaus_scenes::{ConfigError, Rules, Scenario, Scene, Stage};
use serde::{Deserialize, Serialize};

/// How draws are made, and why.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Way {
    /// Whether they are independent draws of the prior, kept by rejection; otherwise chains make them.
    pub independent: bool,
    /// Whether solutions are first looked for by climbs, each from a fresh draw of the prior: these are found, not
    /// weighted. Chains go on from there.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub climbs: bool,
    /// Why, in words.
    pub why: String,
}

impl Way {
    /// The way that a scenario asks for; `None` if that is by chains, or left to a trial.
    #[must_use]
    pub fn said(scenario: &Scenario) -> Option<Self> {
        let is_independent = scenario.method() == Method::Independent;
        is_independent.then(|| Self { independent: true, climbs: false, why: "as the scenario says".to_owned() })
    }
}

/// Whether draws are independent.
pub(crate) fn is_independent(way: Option<&Way>) -> bool {
    way.is_some_and(|way| way.independent)
}

/// The moves of chains that make draws this way.
pub(crate) fn moves_of(scene: &Stage, rules: &Rules, way: Option<&Way>) -> Result<Mixture<Stage>, ConfigError> {
    if is_independent(way) { Ok(Independent::mixture()) } else { scene.moves(rules) }
}
