//! Scenario files: TOML that says which world to sample, and how.

mod bounds;
mod check;
mod keys;
mod nearest;
mod overrides;
mod problem;
mod schema;
mod shape;
mod tree;
mod value;

pub use keys::{KeyDoc, explain, keys, template};
pub use nearest::nearest;
pub use overrides::NoKey;
pub use problem::{Problem, SHOWN, ScenarioError, Source};
pub use schema::{SCHEMA_FILE, SCHEMA_ID, published_schema, schema};

use crate::Stage;
use crate::files::{Files, NoFiles};
use crate::registry::World;
use crate::require::{Asked, Require, agree};
use crate::rules::Rules;
use crate::scene::{ConfigError, Scene};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tree::Tree;

/// A scenario: a world and how to sample it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// How to sample.
    #[serde(default)]
    pub sampler: Sampler,
    /// What is required besides what the world demands itself: a list of tables, each with one requirement. What a
    /// state lacks of one it loses in log density; an animation is a solution where all are met.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 256), extend("default" = []))]
    pub require: Vec<Require>,
    /// What to sample: exactly one table `[world.SCENE]`.
    pub world: World,
}

/// How to sample.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Sampler {
    /// Seed of all randomness. The same scenario, seed and version give the same bits.
    /// Seeds end at 2⁶³ − 1, the largest integer that TOML promises to hold.
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
    /// Record every `thin`-th iteration.
    #[schemars(range(min = 1, max = 1_000_000_000_u64))]
    pub thin: u64,
    /// Most iterations between two points at which a run can be stopped and gone on with; it begins with fewer, about
    /// an eighth of those done.
    #[schemars(range(min = 1, max = 1_000_000_000_u64))]
    pub checkpoint_every: u64,
    /// Whether the sizes of moves' steps are adapted in the warm-up, each until a good share of its proposals is
    /// accepted, and kept from then on. Unset: as measurement says is better for the scene (dice: yes; others: no).
    /// Without a warm-up, and where steps are hardly tried in it, they are as configured.
    pub adapt: Option<bool>,
    /// How draws are made; unset: as `chain`. The law of what comes out is the same whichever it is.
    pub method: Option<Method>,
    /// Exact acceptance, or the paper's as printed.
    pub rules: Rules,
    /// Restarts from fresh draws that keep the chain exact.
    pub tempering: Tempering,
}

/// How draws are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// By chains that walk from state to state with the scene's moves.
    #[default]
    Chain,
    /// By plain draws of the prior, of which each is kept with the probability that its constraint gives it, so that
    /// solutions are independent of each other. An iteration is one draw of the prior, and in between a chain stands
    /// still. Best where the prior reaches the goal now and then.
    Independent,
    /// As a trial finds out before the run begins: by draws of the prior where these make independent solutions faster
    /// than chains do, else by chains. The trial counts simulations, not seconds, so that the same seed decides alike
    /// on every machine; the run says what was decided, and why.
    Auto,
}

/// Parallel tempering: each chain climbs and descends a ladder of constraints that count less and less, down to none,
/// where everything is drawn anew. What comes up again shares nothing with what went down, and the chain stays exact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Tempering {
    /// Rungs of the ladder, each as much work as a chain; 1: no tempering. About twice the barrier that a run reports,
    /// and one more, serve best. The rungs are spaced during the warm-up, and stay from then on.
    #[schemars(range(min = 1, max = 256))]
    pub rungs: u32,
    /// Iterations between two swaps of neighbouring rungs.
    #[schemars(range(min = 1, max = 1_000_000))]
    pub swap_every: u64,
}

impl Default for Tempering {
    fn default() -> Self {
        Self { rungs: 1, swap_every: 20 }
    }
}

impl Default for Sampler {
    fn default() -> Self {
        Self {
            seed: 1,
            chains: 4,
            warmup: 1000,
            iterations: 20_000,
            thin: 1,
            checkpoint_every: 20_000,
            adapt: None,
            method: None,
            rules: Rules::default(),
            tempering: Tempering::default(),
        }
    }
}

impl Scenario {
    /// Reads a scenario: a file called `name` with the contents `text`, and `key=value` strings that override it, in
    /// order.
    ///
    /// An override's key is a full dotted name (`world.ball2d.sigma_d`) or an end of it that no other key of the file's
    /// world has (`sigma_d`, `weights.aim`). Places in lists are counted from 0: `constraints[0].rest_at.x_mm`; where
    /// only one table of the list has the key, the place may be left out: `rest_at.x_mm`. The value is TOML, else a
    /// bare string: `moves=paper`. Tables that the file lacks are made.
    ///
    /// # Errors
    /// [`ScenarioError`] with all that is wrong, each in its place. Only where the text is no TOML is nothing else
    /// looked at, and what one key alone does not show (weights that are all zero) is found where each key by itself is
    /// right.
    pub fn read(name: &str, text: &str, overrides: &[String]) -> Result<Self, ScenarioError> {
        Self::read_with(name, text, overrides, &NoFiles)
    }

    /// The same of a scenario that may name files: shapes of its own.
    ///
    /// # Errors
    /// As [`Scenario::read`], and where a file cannot be read, or is not what the scenario says.
    pub fn read_with(name: &str, text: &str, overrides: &[String], files: &dyn Files) -> Result<Self, ScenarioError> {
        let fail = |problems| Err(ScenarioError::new(name, text, problems));
        let (mut tree, syntax) = Tree::parse(text);
        if !syntax.is_empty() {
            return fail(check::syntax_problems(text, &syntax));
        }
        let shape = shape::scenario();
        let mut problems = Vec::new();
        for said in overrides {
            problems.extend(overrides::apply(said, shape, &mut tree).err().map(|problem| *problem));
        }
        let (value, found) = check::check(shape, &tree);
        problems.extend(found);
        if !problems.is_empty() {
            return fail(problems);
        }
        let Some(value) = value else { return fail(vec![Problem::new("", "no scenario")]) };
        let mut scenario: Self = match value.try_into() {
            Ok(scenario) => scenario,
            Err(error) => return fail(vec![Problem::new("", error.message())]),
        };
        match scenario.load(files).and_then(|()| scenario.try_building()) {
            Ok(()) => Ok(scenario),
            Err(error) => fail(vec![tree::located(&tree, &error)]),
        }
    }

    /// Reads the files that it names.
    fn load(&mut self, files: &dyn Files) -> Result<(), ConfigError> {
        self.world.load(files)?;
        let mut required = self.require.iter_mut().enumerate();
        required.try_for_each(|(index, one)| one.load(&format!("require[{index}]"), files))
    }

    /// Whether moves' scales are adapted in the warm-up.
    #[must_use]
    pub fn adapts(&self) -> bool {
        self.sampler.adapt.unwrap_or_else(|| self.world.adapts())
    }

    /// How draws are made, or that a trial is to find out.
    #[must_use]
    pub fn method(&self) -> Method {
        self.sampler.method.unwrap_or_default()
    }

    /// The scene, under what is required besides.
    ///
    /// # Errors
    /// [`ConfigError`] where the settings make no scene, or a requirement can mean nothing in it.
    pub fn stage(&self) -> Result<Stage, ConfigError> {
        Asked::new(self.world.scene()?, &self.require)
    }

    /// Whether the scene can be built and sampled.
    fn try_building(&self) -> Result<(), ConfigError> {
        if self.sampler.tempering.rungs > 1 && !self.sampler.rules.is_exact() {
            let message = "tempering needs exact acceptance, as its swaps rest on the law of every rung: set sampler.rules.preset = \"exact\", or rungs = 1";
            return Err(ConfigError::new("sampler.tempering.rungs", message));
        }
        if self.sampler.tempering.rungs > 1 && self.method() != Method::Chain {
            let message = "tempering is for chains: set sampler.method = \"chain\", or rungs = 1";
            return Err(ConfigError::new("sampler.tempering.rungs", message));
        }
        let scene = self.stage()?;
        agree(&scene.demands(), &scene.cast())?;
        scene.moves(&self.sampler.rules).map(drop)
    }

    /// The whole effective scenario as TOML: every key that is set, in full precision. Reading it back gives an equal
    /// scenario.
    #[must_use]
    pub fn to_toml(&self) -> String {
        // Tables, numbers, booleans and strings can all be written, so this cannot fail; an empty text would be refused
        // when read.
        toml::to_string(self).unwrap_or_default()
    }

    /// The scenario of a scene with all settings at their defaults; `None` where there is no such scene.
    #[must_use]
    pub fn default_of(scene: &str) -> Option<Self> {
        World::default_of(scene).map(|world| Self { sampler: Sampler::default(), require: Vec::new(), world })
    }
}
