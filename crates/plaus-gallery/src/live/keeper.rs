//! All solutions of a page.

use super::{Ends, Found, Live, Saved, World, in_words};
use crate::features::{Features, Paths};
use crate::map::{self, Maps};
use crate::models::Bytes;
use crate::pack::{self, Ranges, Shared, Shown};
use crate::words;
use plaus_export::clip::FPS;
use plaus_export::{Clip, Cut, Label, glb};
use plaus_mcmc::{Distinct, FirstOfClass, Goal, Plan, State, StateOf};
use plaus_scenes::{Animation, AnyDraw, AnyScratch, Scene, Stage};
use serde_json::{Value, json};

/// Knows all solutions of a page, and tells which of those that samplers find look clearly different from them.
pub struct Keeper {
    pub(super) stage: Stage,
    pub(super) world: World,
    until: Ends,
    plan: Plan,
    independent: bool,
    chains: Value,
    distinct: Distinct,
    /// What the page holds already.
    shared: Shared,
    paths: Vec<Paths>,
    maps: Maps,
    columns: Value,
    /// What the page had.
    shown: Vec<AnyDraw>,
    found: Vec<Found>,
}

impl Keeper {
    /// Learns the solutions that the page has.
    ///
    /// # Errors
    /// In words, if they cannot be simulated.
    pub fn new(live: Live) -> Result<Self, String> {
        let Live { world, plan, independent, until, chains, shown, .. } = live;
        let scenario = world.scenario().map_err(in_words)?;
        let stage = scenario.stage().map_err(in_words)?;
        let columns = words::columns(&stage.scalars(), &world.scenario["require"]);
        let (distinct, shared, maps) = (Distinct::apart(1.0), Shared::default(), Maps::default());
        let (paths, found) = (Vec::new(), Vec::new());
        let shown_before = shown;
        let shown = Vec::new();
        let mut keeper = Self {
            stage,
            world,
            until,
            plan,
            independent,
            chains,
            columns,
            distinct,
            shared,
            paths,
            maps,
            shown,
            found,
        };
        for draw in shown_before {
            let state = State::evaluate(&keeper.stage, draw, &mut AnyScratch::default()).map_err(in_words)?;
            keeper.note(&state, FIRST);
            let animation = keeper.animate(&state.draw)?;
            // Numbers what is shown as the page does.
            let ranges = Ranges::of(std::iter::once(&animation));
            keeper.pack(&state, &animation, &ranges, (0, 0), &mut Bytes::default());
            keeper.paths.push(Paths::of(&animation));
            keeper.shown.push(state.draw);
        }
        keeper.lay_out();
        Ok(keeper)
    }

    /// Adds a solution if it looks clearly different from all others: then what the page needs to show it, which is the
    /// length of a description, the description as JSON, and bytes.
    ///
    /// # Errors
    /// In words, if it is no solution, or cannot be simulated.
    pub fn add(&mut self, found: Found) -> Result<Option<Vec<u8>>, String> {
        let state = found.state(&self.stage)?;
        let class = self.stage.class(state.by_ref()).ok_or_else(|| format!("draw {} is no solution", found.id()))?;
        let first = FirstOfClass { iteration: found.iteration, chain: found.chain, class };
        if !self.note(&state, first) {
            return Ok(None);
        }
        let animation = self.animate(&state.draw)?;
        let known = self.shared.counts();
        let (ranges, mut bytes) = (Ranges::of(std::iter::once(&animation)), Bytes::default());
        let sample = self.pack(&state, &animation, &ranges, (found.chain, found.iteration), &mut bytes);
        self.paths.push(Paths::of(&animation));
        self.lay_out();
        let mut description = self.shared.since(known);
        if let Some(view) = animation.view {
            description["view"] = pack::view(&view);
        }
        description["sample"] = sample;
        description["ranges"] = json!({
            "low": ranges.low.to_array(), "high": ranges.high.to_array(), "velocity": ranges.velocity,
            "acceleration": ranges.acceleration, "spin": ranges.spin,
        });
        description["outcomes"] = json!(self.maps.outcomes);
        description["paths"] = json!(self.maps.paths);
        self.found.push(found);
        Ok(Some(pack::joined(&description, &bytes.0)))
    }

    /// What the page says of the scenario: names of the numbers of each solution, and the scenario itself.
    #[must_use]
    pub fn about(&self) -> Value {
        let Plan { seed, chains, .. } = self.plan;
        let scenario = &self.world.scenario;
        json!({
            "scalars": self.columns, "scenario": scenario, "seed": seed.0, "chains": chains,
            "independent": self.independent, "climbs": self.plan.climbs > 0,
        })
    }

    /// What it was made of, without solutions.
    pub(super) fn live(&self) -> Live {
        let Self { ref world, plan, independent, until, ref chains, .. } = *self;
        let (world, chains) = (world.clone(), chains.clone());
        Live { world, plan, independent, until, chains, shown: Vec::new(), known: Vec::new() }
    }

    /// The draws of all solutions, in the page's order.
    pub(super) fn draws(&self) -> impl DoubleEndedIterator<Item = &AnyDraw> + ExactSizeIterator {
        self.shown.iter().chain(self.found.iter().map(|found| &found.draw)).collect::<Vec<_>>().into_iter()
    }

    /// The draw of a solution of the page, by its number there.
    #[must_use]
    pub fn draw(&self, number: usize) -> Option<Value> {
        serde_json::to_value(self.draws().nth(number)?).ok()
    }

    /// The animation of a solution of the page, by its number there, as `plaus export --format glb` writes it. `label`
    /// is its name and its facts, as JSON.
    ///
    /// # Errors
    /// In words, if there is no such solution, or it is too long for a file.
    pub fn glb(&self, number: usize, label: &[u8]) -> Result<Vec<u8>, String> {
        let draw = self.draws().nth(number).ok_or_else(|| format!("there is no solution {number}"))?;
        let mut told: Value = serde_json::from_slice(label).map_err(in_words)?;
        let mut label = Label::new(told["name"].as_str().unwrap_or_default());
        if let Value::Object(facts) = told["facts"].take() {
            label.facts = facts;
        }
        let animation = self.animate(draw)?;
        let cut = Cut::new(FPS, None, &animation).map_err(in_words)?;
        glb::to_vec(&Clip::new(&animation, &label.timed(&cut), cut)).map_err(in_words)
    }

    /// All that was added, as a file that `plaus replay` reads.
    #[must_use]
    pub fn saved(&self) -> String {
        Saved::text(&self.world, &self.found)
    }

    fn note(&mut self, state: &StateOf<Stage>, first: FirstOfClass) -> bool {
        let class = self.stage.class(state.by_ref()).unwrap_or(first.class);
        self.distinct.note_seen(FirstOfClass { class, ..first }, self.stage.look(state.by_ref()))
    }

    fn animate(&self, draw: &AnyDraw) -> Result<Animation, String> {
        self.stage.animate_until(draw, self.until.into()).map_err(in_words)
    }

    fn pack(
        &mut self,
        state: &StateOf<Stage>,
        animation: &Animation,
        ranges: &Ranges,
        (chain, iteration): (u32, u64),
        bytes: &mut Bytes,
    ) -> Value {
        let all = self.stage.scalars();
        let mut values = vec![0.0; all.len()];
        self.stage.write_scalars(state.by_ref(), &mut values);
        let shown = Shown {
            id: format!("{chain}:{iteration}"),
            chain,
            draw: iteration,
            phase: json!("sampling"),
            iteration,
            log_p: state.log_p().value(),
            log_prior: state.log_prior.value(),
            log_constraint: state.log_constraint.value(),
            scalars: pack::without_details(&all, values.into_iter()),
            times: self.stage.times(animation),
            animation,
        };
        pack::of_one(&shown, ranges, bytes, &mut self.shared)
    }

    /// Makes the maps anew, turned as they were.
    fn lay_out(&mut self) {
        let Features { paths, outcomes } = Features::of(self.paths.clone());
        let turned = |mut new: Vec<[f64; 2]>, old: &[[f64; 2]]| {
            for axis in 0..2 {
                let along: f64 = old.iter().zip(&new).map(|(old, new)| old[axis] * new[axis]).sum();
                if along < 0.0 {
                    new.iter_mut().for_each(|place| place[axis] = -place[axis]);
                }
            }
            new
        };
        self.maps = Maps {
            outcomes: turned(map::of(&outcomes), &self.maps.outcomes),
            paths: turned(map::of(&paths), &self.maps.paths),
        };
    }
}

/// Of the page's own solutions only their looks matter.
const FIRST: FirstOfClass = FirstOfClass { iteration: 0, chain: 0, class: plaus_mcmc::SolutionClass::EMPTY };
