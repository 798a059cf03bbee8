//! Other scenarios than the run's: a text that someone wrote, or the page's own with other values.

use super::file::{File, Shapes};
use super::{Ends, Keeper, Live, World, in_words};
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::{Plan, State, Target, Variables};
use plaus_scenes::scenario::{Method, ScenarioError};
use plaus_scenes::{AnyDraw, AnyScratch, Scenario, Stage};
use serde::Deserialize;
use serde_json::{Value, json};

/// A value of a scenario that is to be another.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Edit {
    /// Where it is: a JSON pointer, such as `/world/dice/constraints/0/rest_at/x_mm`.
    at: String,
    value: Value,
}

/// Draws of a page that are tried in another scenario, and most that chains begin at.
const TRIED: usize = 24;
const KNOWN: usize = 4;

/// What is wrong with a scenario, for a page: a list of keys, places in the text if it has one, and words.
#[must_use]
pub fn problems(error: &ScenarioError) -> Value {
    let one = |problem: &plaus_scenes::scenario::Problem| {
        let message = match &problem.help {
            Some(help) => format!("{}; {help}", problem.message),
            None => problem.message.clone(),
        };
        json!({"key": problem.key, "line": problem.line, "column": problem.column, "message": message})
    };
    error.problems.iter().take(plaus_scenes::scenario::SHOWN).map(one).collect()
}

/// What a page needs to sample a scenario without a run: chains as it says, which begin with fresh draws. Where the
/// scenario leaves open how draws are made, each solution is looked for by a climb of its own.
///
/// # Errors
/// All that is wrong with the text.
pub fn begun(name: &str, text: &str, files: Vec<File>) -> Result<Live, ScenarioError> {
    let (scenario, value) = Scenario::read_text(name, text, &Shapes(&files))?;
    let method = scenario.method();
    let endless = Plan { thin: 1, iterations: Plan::ENDLESS, ..scenario.plan() };
    let plan = match method {
        Method::Auto => Plan { climbs: Plan::ENDLESS, warmup: Plan::ENDLESS, settle: false, ..endless },
        Method::Chain | Method::Independent => endless,
    };
    Ok(Live {
        world: World { scenario: value, files },
        plan,
        independent: method == Method::Independent,
        until: Ends::usual(scenario.world.name()),
        chains: json!([]),
        shown: Vec::new(),
        known: Vec::new(),
    })
}

impl Keeper {
    /// What a page needs to sample its scenario with other values. Its chains begin at those of the page's solutions
    /// that are most likely in it.
    ///
    /// # Errors
    /// All that is wrong with the new values.
    pub fn edited(&self, edits: Vec<Edit>) -> Result<Live, ScenarioError> {
        let mut world = self.world.clone();
        for Edit { at, value } in edits {
            if let Some(place) = world.scenario.pointer_mut(&at) {
                *place = value;
            }
        }
        let scenario = world.scenario()?;
        let stage = scenario.stage().map_err(|error| ScenarioError::locate("scenario", "", &error))?;
        let all: Vec<&AnyDraw> = self.draws().collect();
        let step = all.len().div_ceil(TRIED).max(1);
        // The newest ones first.
        let tried = all.into_iter().rev().step_by(step).map(|draw| carried(&self.stage, draw, &stage));
        let mut states: Vec<_> = tried
            .filter_map(|draw| State::evaluate(&stage, draw, &mut AnyScratch::default()).ok())
            .filter(|state| state.log_p().value().is_finite())
            .collect();
        states.sort_by(|a, b| b.log_p().value().total_cmp(&a.log_p().value()));
        states.truncate(KNOWN);
        let known = states.into_iter().map(|state| state.draw).collect();
        Ok(Live { world, shown: Vec::new(), known, ..self.live() })
    }
}

/// The draw of one scenario in another: itself if both have the same variables, else a fresh one with the values of
/// those variables that both have.
fn carried(from: &Stage, draw: &AnyDraw, to: &Stage) -> AnyDraw {
    let name = |stage: &Stage, k: usize| (stage.vars().get(k).name.clone(), stage.vars().get(k).member);
    let (old, new) = (from.vars().len(), to.vars().len());
    if old == new && (0..new).all(|k| name(from, k) == name(to, k)) {
        return draw.clone();
    }
    let mut fresh = to.start(&mut Seed(0).chain(0).at(0, Purpose::START));
    for k in 0..new {
        let Some(same) = (0..old).find(|&one| name(from, one) == name(to, k)) else { continue };
        let values = from.get(draw, same);
        if to.vars().get(k).optional {
            to.set_present(&mut fresh, k, values.is_some());
        }
        if let (Some(place), Some(values)) = (to.get_mut(&mut fresh, k), values)
            && place.len() == values.len()
        {
            place.copy_from_slice(values);
        }
    }
    fresh
}

impl Edit {
    /// Reads a list of them.
    ///
    /// # Errors
    /// In words, if it is something else.
    pub fn read(text: &[u8]) -> Result<Vec<Self>, String> {
        // By way of a tree, so that the module has one reader of each type.
        let tree: Value = serde_json::from_slice(text).map_err(in_words)?;
        serde_json::from_value(tree).map_err(in_words)
    }
}
