//! The sampler in a page. A page may go on sampling where its run ended: it holds what a [`Live`] has, as text,
//! and a module of WebAssembly that is made of this one.
//!
//! A [`Sampler`] is one chain; each worker of the page has one. A [`Keeper`] has all solutions of the page: it says
//! which of those that samplers find look clearly different from all others, and makes them into what the page shows.
//! Both give the same bits as on any other machine.

mod change;
mod file;
mod keeper;
mod sampler;
mod saved;

pub use change::{Edit, begun, problems};
pub use file::File;
pub use keeper::Keeper;
pub use sampler::Sampler;
pub use saved::Saved;

use file::Shapes;
use plaus_mcmc::{Plan, State, StateOf, Target};
use plaus_scenes::scenario::ScenarioError;
use plaus_scenes::{AnyDraw, AnyScratch, Scenario, Stage, Until};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// The outcome of a draw.
pub(crate) type Outcome = <Stage as Target>::Outcome;

/// What a page knows of its run, to go on from it.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Live {
    /// The scenario with the files that it names.
    pub world: World,
    /// Length, recording interval and seed of the run.
    pub plan: Plan,
    /// Whether draws are independent draws of the prior; otherwise chains make them.
    pub independent: bool,
    /// Where animations end.
    pub until: Ends,
    /// Where the run's chains are: a list of `Snapshot<AnyDraw, ()>`, whose states have no outcomes because these
    /// follow from the draws. Only samplers read them.
    pub chains: Value,
    /// The solutions on the page, in its order.
    pub shown: Vec<AnyDraw>,
    /// Draws that chains begin at in place of where the run's are, each at another, the most likely first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub known: Vec<AnyDraw>,
}

/// A scenario that was read before, with its files.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct World {
    /// The keys that are set; others have their defaults.
    pub scenario: Value,
    /// The files of shapes that it names.
    pub files: Vec<File>,
}

/// A solution that a sampler found.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Found {
    /// Number of the chain: those of the run come before it.
    pub chain: u32,
    /// The iteration that found it.
    pub iteration: u64,
    /// Its log prior.
    pub log_prior: f64,
    /// Its log constraint.
    pub log_constraint: f64,
    /// The draw.
    pub draw: AnyDraw,
}

impl Found {
    /// Its name.
    #[must_use]
    pub fn id(&self) -> String {
        format!("{}:{}", self.chain, self.iteration)
    }

    /// One that a chain is at or was at.
    fn of(chain: u32, iteration: u64, state: &State<AnyDraw, impl Sized>) -> Self {
        let (log_prior, log_constraint) = (state.log_prior.value(), state.log_constraint.value());
        Self { chain, iteration, log_prior, log_constraint, draw: state.draw.clone() }
    }

    /// Simulates it again.
    ///
    /// # Errors
    /// In words, if that fails or does not give the same bits.
    pub fn state(&self, stage: &Stage) -> Result<StateOf<Stage>, String> {
        let state = State::evaluate(stage, self.draw.clone(), &mut AnyScratch::default()).map_err(in_words)?;
        let bits = |prior: f64, constraint: f64| [prior.to_bits(), constraint.to_bits()];
        let found = bits(state.log_prior.value(), state.log_constraint.value());
        match found == bits(self.log_prior, self.log_constraint) {
            true => Ok(state),
            false => Err(format!("draw {} gives another state when it is simulated again", self.id())),
        }
    }
}

impl World {
    /// A scenario with its files.
    ///
    /// # Errors
    /// In words, if a file has no shapes.
    pub fn of(scenario: &Scenario) -> Result<Self, String> {
        let assets = scenario.world.assets();
        let files = assets.iter().map(|(path, bytes)| File::read(path, bytes)).collect::<Result<_, _>>()?;
        Ok(Self { scenario: scenario.to_value(), files })
    }

    /// Reads it.
    ///
    /// # Errors
    /// All that is wrong with it.
    pub fn scenario(&self) -> Result<Scenario, ScenarioError> {
        Scenario::of_value(&self.scenario, &Shapes(&self.files))
    }
}

impl Live {
    /// Reads what a page holds.
    ///
    /// # Errors
    /// In words, if it is something else.
    pub fn read(text: &[u8]) -> Result<Self, String> {
        let tree: Value = serde_json::from_slice(text).map_err(in_words)?;
        serde_json::from_value(tree).map_err(in_words)
    }
}

/// Where animations end: an [`Until`] as a page holds it.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ends {
    /// When everything is at rest.
    Rest,
    /// Once it is certain whether it is a solution.
    Decided,
    /// After so many seconds.
    Time(f64),
}

impl Ends {
    /// Where animations of a scene usually end: in bowling when it is decided which pins stand, because the ball may
    /// roll on for half a minute.
    #[must_use]
    pub fn usual(scene: &str) -> Self {
        if scene == "bowling" { Self::Decided } else { Self::Rest }
    }
}

impl From<Until> for Ends {
    fn from(until: Until) -> Self {
        match until {
            Until::Rest => Self::Rest,
            Until::Decided => Self::Decided,
            Until::Time(seconds) => Self::Time(seconds),
        }
    }
}

impl From<Ends> for Until {
    fn from(ends: Ends) -> Self {
        match ends {
            Ends::Rest => Self::Rest,
            Ends::Decided => Self::Decided,
            Ends::Time(seconds) => Self::Time(seconds),
        }
    }
}

fn in_words(error: impl std::fmt::Display) -> String {
    error.to_string()
}
