//! Scenario files: TOML that says which world to sample, and how.

mod bounds;
mod check;
mod keys;
mod nearest;
mod overrides;
mod problem;
mod said;
mod schema;
mod shape;
mod tree;
mod value;
mod varying;

pub use keys::{KeyDoc, explain, keys, kinds_with, namesakes, starter, template};
pub use nearest::{nearest, no_scene};
pub use overrides::NoKey;
pub use problem::{Problem, SHOWN, ScenarioError, Source};
#[cfg(feature = "schema")]
pub use schema::made_schema;
pub use schema::{SCHEMA_FILE, SCHEMA_ID, give_schema, published_schema, schema};
pub(crate) use value::split_unit;

use crate::Stage;
use crate::files::{Files, NoFiles};
use crate::registry::World;
use crate::require::{Asked, Require, agree};
use crate::rules::Rules;
use crate::scene::{ConfigError, Scene};
use crate::settings::settings;
use plaus_mcmc::Plan;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use tree::Tree;

/// A scenario: a world and how to sample it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// How to sample.
    #[serde(default)]
    pub sampler: Sampler,
    /// Requirements beyond those of the world itself: a list of tables, each with one requirement. The further an
    /// animation is from meeting one, the less likely a chain keeps it; one that meets all of them is a solution.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 256), extend("default" = []))]
    pub require: Vec<Require>,
    /// What to sample: exactly one table `[world.SCENE]`.
    pub world: World,
}

settings! {
    /// How to sample.
    pub struct Sampler {
        /// Seed of all randomness. The same scenario, seed and version give the same bits. The largest seed is 2⁶³ − 1,
        /// the largest integer that every TOML reader supports.
        seed: u64 = 1;
        /// Number of independent chains.
        chains: u32 = 4, 1..=100_000;
        /// Iterations before sampling begins; they are recorded, but tables and diagnostics leave them out. Where moves
        /// learn, this is the longest time: see `settle`. Independent draws need none.
        warmup: u64 = 1000, 0..=1_000_000_000_000_u64;
        /// Iterations of each chain after the warm-up.
        iterations: u64 = 20_000, 1..=1_000_000_000_000_u64;
        /// Record every `thin`-th iteration.
        thin: u64 = 1, 1..=1_000_000_000_u64;
        /// Most iterations between two points at which a run can be stopped and resumed. At first there are fewer:
        /// about an eighth of those done.
        checkpoint_every: u64 = 20_000, 1..=1_000_000_000_u64;
        /// Whether moves learn in the warm-up: step sizes are adapted until a good share of each move's proposals is
        /// accepted, `aim` in bowling learns where strikes come from; both are then kept. Unset: whichever measured
        /// better for the scene (bowling, dice and spelling: yes; ball2d and custom: no). Without a warm-up, or for
        /// moves that are rarely tried in it, the configured sizes stay.
        adapt: Option<bool>;
        /// Whether the warm-up also learns how often to make each move, from how far it leads for its cost. This
        /// replaces part of the configured weights and is then kept. A move that was never accepted is hardly made any
        /// more. It turns `adapt` on where that is unset. Unset: no.
        adapt_weights: Option<bool>;
        /// Whether a chain's warm-up ends as soon as what its moves learn has settled: after a sixteenth, an eighth, a
        /// quarter or half of `warmup`, if step sizes and what else is learnt hardly differ from those at half that
        /// time, and the first solution was found by then. The chain stands still for the rest of `warmup`, which costs
        /// nothing. Unset: yes.
        settle: Option<bool>;
        /// How many times as far apart solutions must be to count as different: a factor on the widths of the cells by
        /// which the world tells them apart. What is counted, such as pins or faces, stays. Unset: 1.
        #[serde(skip_serializing_if = "Option::is_none")]
        #[schemars(extend("default" = null, "x-example" = 2.0))]
        distinct_scale: Option<f64>, 1e-3..=1e3;
        /// How draws are made. Every method samples the same law. Unset: `auto`, but `chain` if the file says how
        /// chains should work: by `adapt`, `adapt_weights`, `rules` or `tempering`.
        method: Option<Method>;
        /// Whether a run that looks for a number of solutions counts only sampled ones: those after the warm-up, by
        /// chains or draws of the prior, which come up as often as they are plausible. Otherwise it also takes what it
        /// merely finds. Unset: no.
        #[serde(skip_serializing_if = "Option::is_none")]
        #[schemars(extend("default" = null))]
        sampled_only: Option<bool>;
        /// Exact acceptance, or the paper's as printed.
        rules: Rules;
        /// Restarts from fresh draws that keep the chain exact.
        tempering: Tempering;
    }
}

/// How draws are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Chains that walk from state to state with the scene's moves.
    Chain,
    /// Plain draws from the prior, each kept with the probability that its constraint gives it, so that solutions are
    /// independent of each other. An iteration is one draw from the prior; between kept draws a chain stands still.
    /// Best if the prior reaches the goal now and then.
    Independent,
    /// Decided by a trial before the run begins: draws from the prior if they give independent solutions for less work
    /// than chains do, else chains. A run that looks for a number of solutions makes draws from the prior if these find
    /// some soon; else each solution gets a climb of its own from a fresh draw, and chains follow. Work is simulated
    /// events, not seconds, so that one seed decides alike on every machine; the run says what was decided, and why.
    Auto,
}

settings! {
    /// Parallel tempering: each chain moves along a ladder of constraints that count less and less, down to none, where
    /// everything is drawn anew. What comes back up shares nothing with what went down, and the chain remains exact.
    #[derive(Copy, Eq)]
    pub struct Tempering {
        /// Rungs of the ladder, each of which takes as much work as a chain; 1: no tempering. About twice the barrier
        /// that a run reports, plus one, works best. The rungs are spaced during the warm-up, and then stay.
        rungs: u32 = 1, 1..=256;
        /// Whether the warm-up also chooses the number of rungs, from the barrier that it sees. `rungs` is then the
        /// number to begin with, or 2 if it is 1. Unset: no.
        adapt_rungs: Option<bool>;
        /// Iterations between two swaps of neighbouring rungs.
        swap_every: u64 = 20, 1..=1_000_000;
    }
}

impl Tempering {
    /// The number of rungs that a chain begins with.
    #[must_use]
    pub fn first_rungs(&self) -> u32 {
        if self.adapts_rungs() { self.rungs.max(2) } else { self.rungs }
    }

    /// Whether the warm-up chooses another number.
    #[must_use]
    pub fn adapts_rungs(&self) -> bool {
        self.adapt_rungs.unwrap_or(false)
    }
}

impl Scenario {
    /// Reads a scenario: the text of a file called `name`, and `key=value` strings that override it, in order.
    ///
    /// The key of an override is a full dotted name (`world.ball2d.sigma_d`), or an ending of it that no other key of
    /// the file's world has (`sigma_d`, `weights.aim`). Indices into lists count from 0: `constraints[0].rest_at.x_mm`.
    /// If only one table of the list has the key, the index may be left out: `rest_at.x_mm`. The value is TOML, or else
    /// a bare string: `moves=paper`. Missing tables are created.
    ///
    /// # Errors
    ///
    /// [`ScenarioError`] with everything that is wrong, each in its place. There are two exceptions. If the text is not
    /// TOML, nothing else is checked. Errors that involve several keys (weights that are all zero) are found only if
    /// each key by itself is right.
    pub fn read(name: &str, text: &str, overrides: &[String]) -> Result<Self, ScenarioError> {
        Self::read_with(name, text, overrides, &NoFiles)
    }

    /// The same for a scenario that may name files of its own, such as shapes.
    ///
    /// # Errors
    ///
    /// Those of [`Scenario::read`]; also if a file cannot be read, or is not what the scenario says.
    pub fn read_with(name: &str, text: &str, overrides: &[String], files: &dyn Files) -> Result<Self, ScenarioError> {
        Self::read_and(name, text, overrides, files, Self::try_building).map(|(scenario, ())| scenario)
    }

    /// The same for a text alone, with the values that it gives: [`Scenario::of_value`] makes the same of them.
    /// A program that reads scenarios only so has no code for overrides, nor for writing scenarios.
    ///
    /// # Errors
    ///
    /// Those of [`Scenario::read_with`].
    pub fn read_text(name: &str, text: &str, files: &dyn Files) -> Result<(Self, Value), ScenarioError> {
        let read = Self::read_changed(name, text, |_| Vec::new(), files, Self::try_building);
        read.map(|(scenario, (), value)| (scenario, value))
    }

    /// Reads a scenario and its files, and does something with it, in place of trying whether it makes a world.
    pub(crate) fn read_and<T>(
        name: &str,
        text: &str,
        overrides: &[String],
        files: &dyn Files,
        then: impl FnOnce(&Self) -> Result<T, ConfigError>,
    ) -> Result<(Self, T), ScenarioError> {
        let change = |tree: &mut Tree| {
            let applied = overrides.iter().map(|said| overrides::apply(said, shape::scenario(), tree));
            applied.filter_map(|done| done.err().map(|problem| *problem)).collect()
        };
        Self::read_changed(name, text, change, files, then).map(|(scenario, done, _)| (scenario, done))
    }

    /// Reads a scenario whose tree is changed first, which may have problems of its own.
    fn read_changed<T>(
        name: &str,
        text: &str,
        change: impl FnOnce(&mut Tree) -> Vec<Problem>,
        files: &dyn Files,
        then: impl FnOnce(&Self) -> Result<T, ConfigError>,
    ) -> Result<(Self, T, Value), ScenarioError> {
        let (mut tree, syntax) = Tree::parse(text);
        let read = if syntax.is_empty() {
            let problems = change(&mut tree);
            Self::of_tree(&tree, problems, files, then)
        } else {
            Err(check::syntax_problems(text, &tree, &syntax))
        };
        read.map_err(|problems| ScenarioError::new(name, text, problems))
    }

    /// The scenario that a tree gives, if it has no problems, with its files; and the tree's values.
    fn of_tree<T>(
        tree: &Tree,
        mut problems: Vec<Problem>,
        files: &dyn Files,
        then: impl FnOnce(&Self) -> Result<T, ConfigError>,
    ) -> Result<(Self, T, Value), Vec<Problem>> {
        let (value, mut found) = check::check(shape::scenario(), tree);
        if tree.first_key().is_none() {
            for help in found.iter_mut().filter_map(|problem| problem.help.as_mut()) {
                *help += "; `plaus new custom FILE.toml` writes a file to begin with";
            }
        }
        problems.extend(found);
        if !problems.is_empty() {
            return Err(problems);
        }
        let mut value = value.ok_or_else(|| vec![Problem::new("", "no scenario")])?;
        let mut scenario: Self =
            serde_json::from_value(value.clone()).map_err(|error| vec![Problem::new("", error.to_string())])?;
        varying::unwrapped(&mut value);
        match scenario.load(files).and_then(|()| then(&scenario)) {
            Ok(done) => Ok((scenario, done, value)),
            Err(error) => Err(vec![tree::located(tree, &error)]),
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
        self.sampler.adapt.unwrap_or_else(|| self.world.adapts() || self.sampler.adapt_weights == Some(true))
    }

    /// Whether moves' weights are learnt in the warm-up too.
    #[must_use]
    pub fn weighs(&self) -> bool {
        self.adapts() && self.sampler.adapt_weights.unwrap_or(false)
    }

    /// How draws are made, or that a trial is to decide it: if the scenario does not say, and nothing in it is about
    /// chains alone.
    #[must_use]
    pub fn method(&self) -> Method {
        let Sampler { method, adapt, adapt_weights, rules, tempering, .. } = &self.sampler;
        let is_open = adapt.or(*adapt_weights).is_none() && rules.is_exact() && tempering.first_rungs() == 1;
        method.unwrap_or(if is_open { Method::Auto } else { Method::Chain })
    }

    /// The scene, under what is required besides.
    ///
    /// # Errors
    ///
    /// [`ConfigError`] if the settings are invalid, or a requirement has no meaning in it.
    pub fn stage(&self) -> Result<Stage, ConfigError> {
        let stage = Asked::new(self.world.scene()?, &self.require)?;
        Ok(stage.with_distinct(self.sampler.distinct_scale.unwrap_or(1.0)))
    }

    /// Whether the scene can be built and sampled.
    fn try_building(&self) -> Result<(), ConfigError> {
        if self.sampler.adapt_weights == Some(true) && !self.adapts() {
            let message = "weights are learnt only where scales are adapted: set sampler.adapt = true";
            return Err(ConfigError::new("sampler.adapt_weights", message));
        }
        let rungs = self.sampler.tempering.first_rungs();
        if rungs > 1 && !self.sampler.rules.is_exact() {
            let message = "tempering needs exact acceptance, because its swaps use the law of every rung: set sampler.rules.preset = \"exact\", or rungs = 1";
            return Err(ConfigError::new("sampler.tempering.rungs", message));
        }
        if rungs > 1 && self.method() != Method::Chain {
            let message = "tempering is only for chains: set sampler.method = \"chain\", or rungs = 1";
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
        // Goes through a tree of values, because `toml` would compile the code of every setting eight times. Tables,
        // numbers, booleans and strings can all be written, so this cannot fail; an empty text would be refused when
        // read.
        toml::to_string(&self.to_value()).unwrap_or_default()
    }

    /// The same as a tree of values.
    #[must_use]
    pub fn to_value(&self) -> Value {
        let mut tree = serde_json::to_value(self).unwrap_or_default();
        varying::unwrapped(&mut tree);
        leave_out_unset(&mut tree);
        tree
    }

    /// Reads what [`Scenario::to_value`] wrote, perhaps changed since, and the files that it names: for programs that
    /// receive scenarios which were read before, as a page does.
    ///
    /// # Errors
    ///
    /// Those of [`Scenario::read_with`], without places in a text.
    pub fn of_value(value: &Value, files: &dyn Files) -> Result<Self, ScenarioError> {
        let read = Self::of_tree(&Tree::of_value(value), Vec::new(), files, Self::try_building);
        read.map(|(scenario, ..)| scenario).map_err(|problems| ScenarioError::new("scenario", "", problems))
    }

    /// The plan of chains that work as the scenario says, for all of its iterations.
    #[must_use]
    pub fn plan(&self) -> Plan {
        let Sampler { seed, chains, warmup, iterations, thin, checkpoint_every, settle, tempering, .. } = self.sampler;
        Plan {
            seed: plaus_dist::Seed(seed),
            chains,
            warmup,
            iterations,
            thin,
            block: checkpoint_every,
            solutions: None,
            rungs: tempering.first_rungs(),
            swap_every: tempering.swap_every,
            adapt_rungs: tempering.adapts_rungs(),
            adapt: self.adapts(),
            weigh: self.weighs(),
            settle: settle.unwrap_or(true),
            climbs: 0,
            sampled: self.sampler.sampled_only.unwrap_or(false),
        }
    }

    /// The scenario of a scene with all settings at their defaults; `None` if there is no such scene.
    #[must_use]
    pub fn default_of(scene: &str) -> Option<Self> {
        World::default_of(scene).map(|world| Self { sampler: Sampler::default(), require: Vec::new(), world })
    }
}

/// Settings without a value are not written.
fn leave_out_unset(tree: &mut Value) {
    match tree {
        Value::Object(entries) => {
            entries.retain(|_, value| !value.is_null());
            entries.values_mut().for_each(leave_out_unset);
        }
        Value::Array(items) => items.iter_mut().for_each(leave_out_unset),
        _ => {}
    }
}
