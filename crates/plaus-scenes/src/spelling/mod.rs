//! Balls that spell a word (section 5.3, appendix B): the bins to fill are asked for; the shape of the partitions and
//! the drops are uncertain.

mod animate;
mod arena;
mod bins;
mod config;
mod draw;
mod fall;
mod font;
mod moves;
mod physics;
pub(crate) mod picture;
mod props;
mod reuse;
mod word;

pub use bins::{Bins, drops};
pub use config::{
    Coefficients, Config, Count, Dimensions, MOST_COLUMNS, MOST_ROWS, Order, Steps, Vertices, usual_ln_lambda,
};
pub use draw::Drops;
pub use font::Letters;
pub use moves::{BirthDeath, Redrop, SpellingMoves};
pub use picture::Grid;
pub use reuse::{Savings, Work};
pub use word::Word;

/// Weights of the scene's moves.
pub type Weights = crate::Weights<SpellingMoves>;

use crate::accuracy::AccuracyPreset;
use crate::animation::{Animation, Motion, Physics, Prop};
use crate::model::{Column, Features, Member, Scalar, columns, distinct};
use crate::require::{Cast, Mark, Missed, Require, Spells, Stop};
use crate::rules::Rules;
use crate::scene::{ConfigError, Scene};
use crate::world::PlainWorld;
use arena::Arena;
use plaus_dist::{Gibbs, LogDensity, LogPotential, Stream, math};
use plaus_mcmc::{
    Failure, Goal, Mixture, ModelError, Offset, Recipe, Rectangle, Simulated, SolutionClass, StateRefOf, Target,
    Variables, Vars, vars,
};
use serde::{Deserialize, Serialize};

/// The balls that spell: `p ∝ λ^k · Π exp(−½‖offset‖²/σ²) · Π 1/a`, with the first product over vertices and the second
/// over the balls that are dropped.
#[derive(Debug)]
pub struct Spelling {
    config: Config,
    word: Word,
    vars: Vars,
    rectangle: Rectangle,
    balls: usize,
    goal: Gibbs,
    arena: Arena,
    savings: Savings,
}

/// Where the balls came to rest.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Rest {
    /// Each ball's bin; `None` if it was not dropped, lies on a partition or on another ball above it, or still
    /// moves.
    pub bins: Vec<Option<u16>>,
    /// Whether the simulation came to its end. If it did not, the draw has probability 0.
    pub complete: bool,
    /// Why it did not; no state of a chain has such an outcome.
    #[serde(skip)]
    pub failed: Option<Box<Failure>>,
}

impl Spelling {
    /// The scene of a configuration.
    ///
    /// # Errors
    ///
    /// [`ConfigError`] if the word does not fit its box, the balls do not fit their bins, or the numbers are
    /// inconsistent.
    pub fn new(config: &Config) -> Result<Self, ConfigError> {
        let blame = |key: &'static str| {
            move |error: &dyn std::error::Error| ConfigError::new(format!("world.spelling.{key}"), error)
        };
        let word = Word::new(config)?;
        let balls = arena::balls(config, &word)?;
        let arena = Arena::new(config, &word, balls)?;
        let usual = || usual_ln_lambda(word.designated().len());
        let ln_lambda = if config.constrained.unwrap_or(true) { config.ln_lambda.unwrap_or_else(usual) } else { 0.0 };
        let goal = Gibbs::from_ln_lambda(ln_lambda).map_err(|error| blame("ln_lambda")(&error))?;
        let offset = Offset::new(config.sigma_mm, arena::longest_offset(config));
        let offset = offset.map_err(|error| blame("sigma_mm")(&error))?;
        let rectangle = Rectangle::new(arena::rectangle(config, &word)?);
        let rectangle = rectangle.map_err(|error| blame("drop_inset_mm")(&error))?;
        let vars = draw::vars(arena.vertices.len(), &offset, balls, &rectangle);
        let savings = Savings::ALL;
        Ok(Self { config: config.clone(), word, vars, rectangle, balls, goal, arena, savings })
    }

    /// The same scene with some optimisations of its simulation switched off or on. They have no influence on any
    /// state.
    #[must_use]
    pub fn with_savings(mut self, savings: Savings) -> Self {
        self.savings = savings;
        self
    }

    /// The configuration.
    #[must_use]
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// ln λ: the configuration's, or the usual value for this many bins.
    #[must_use]
    pub fn ln_lambda(&self) -> f64 {
        self.goal.ln_lambda()
    }

    /// Which bins are to be filled.
    #[must_use]
    pub fn word(&self) -> &Word {
        &self.word
    }

    /// The rectangle over which balls are dropped, in mm.
    #[must_use]
    pub fn rectangle(&self) -> &Rectangle {
        &self.rectangle
    }

    /// The largest number of balls.
    #[must_use]
    pub fn balls(&self) -> usize {
        self.balls
    }

    /// Lower and upper ends, along x and y, of the part of the drop rectangle that lies over a bin, in mm; `None` if no
    /// part does.
    #[must_use]
    pub fn over(&self, bin: u16) -> Option<[[f64; 2]; 2]> {
        let side = self.config.dimensions.bin_mm;
        let (row, column) = (usize::from(bin) / self.word.columns(), usize::from(bin) % self.word.columns());
        let low = [column, self.word.rows() - 1 - row].map(|index| index as f64 * side);
        let ends = std::array::from_fn(|axis| {
            let whole = &self.rectangle.sides()[axis];
            [low[axis].max(whole.low()), (low[axis] + side).min(whole.high())]
        });
        ends.iter().all(|[low, high]| low < high).then_some(ends)
    }

    /// k: the number that λ rewards.
    #[must_use]
    pub fn reward(&self, rest: &Rest) -> u64 {
        let wanted = rest.bins.iter().flatten().filter(|&&bin| self.word.wants(bin));
        match self.config.count {
            Count::Balls => wanted.count() as u64,
            Count::Bins => self.filled(rest) as u64,
        }
    }

    /// The largest log constraint with so many balls.
    fn most_of(&self, balls: usize) -> LogPotential {
        // Each ball fills at most one bin.
        let most = balls.min(match self.config.count {
            Count::Bins => self.word.designated().len(),
            Count::Balls => usize::MAX,
        });
        self.goal.log_potential(most as u64)
    }

    /// Whether all is as asked for: each designated bin holds a ball at rest.
    fn is_satisfied(&self, rest: &Rest) -> bool {
        rest.complete && (!self.config.constrained.unwrap_or(true) || self.filled(rest) == self.word.designated().len())
    }

    /// How many designated bins hold a ball at rest.
    #[must_use]
    pub fn filled(&self, rest: &Rest) -> usize {
        self.word.designated().iter().filter(|bin| rest.bins.contains(&Some(**bin))).count()
    }
}

impl Target for Spelling {
    type Draw = Drops;
    type Outcome = Rest;
    type Scratch = Work;

    fn start(&self, stream: &mut Stream) -> Drops {
        let mut draw = Drops { offsets: vec![[0.0; 3]; self.arena.vertices.len()], balls: vec![None; self.balls] };
        self.renew_all(&mut draw, Recipe::Exact, stream);
        draw
    }

    fn log_prior(&self, draw: &Drops) -> Result<LogDensity, ModelError> {
        Ok(vars::log_prior(self, draw)?)
    }

    fn simulate(
        &self,
        draw: &Drops,
        current: Option<StateRefOf<'_, Self>>,
        floor: LogPotential,
        work: &mut Work,
    ) -> Result<Simulated<Rest>, ModelError> {
        self.simulate_watched(draw, current, (floor, None), work)
    }

    fn log_constraint(&self, rest: &Rest) -> Result<LogPotential, ModelError> {
        if !rest.complete {
            return Ok(LogPotential::ZERO);
        }
        Ok(self.goal.log_potential(self.reward(rest)))
    }

    fn failure(&self, rest: &Rest) -> Option<Failure> {
        rest.failed.as_deref().cloned()
    }

    fn most(&self) -> Option<LogPotential> {
        Some(self.most_of(self.balls))
    }

    fn decided(&self, accepted: bool, work: &mut Work) {
        work.decided(accepted);
    }

    fn work(&self) -> u64 {
        plaus_sim::work()
    }

    fn numbers(&self, state: StateRefOf<'_, Self>) -> Vec<f64> {
        crate::scene::numbers(self, state)
    }
}

impl Goal for Spelling {
    fn class(&self, state: StateRefOf<'_, Self>) -> Option<SolutionClass> {
        distinct::class(self, state, 1.0)
    }
}

impl Scene for Spelling {
    fn moves(&self, rules: &Rules) -> Result<Mixture<Self>, ConfigError> {
        self.config.weights.mix(self.config.moves, self, moves::all(self, rules))
    }

    fn scalars(&self) -> Vec<Scalar> {
        let bin = |number| Column::count("bin").of(Some(Member { kind: "ball", number }));
        let active = Column::count("active").of_the_draw();
        let offset = Column::result("offset_rms", "mm").of_the_draw();
        let all = [Column::count("k"), active, offset].map(|column| column.of(None));
        columns::scalars(all.into_iter().chain((0..self.balls as u32).map(bin)).collect(), &self.vars)
    }

    /// A ball in no bin has bin −1.
    fn write_scalars(&self, state: StateRefOf<'_, Self>, values: &mut [f64]) {
        if let [k, active, rms, bins @ ..] = values {
            *k = self.reward(state.outcome) as f64;
            *active = state.draw.active() as f64;
            let squares: f64 = state.draw.offsets.iter().flatten().map(|x| math::square(*x)).sum();
            *rms = (squares / (3 * state.draw.offsets.len()).max(1) as f64).sqrt();
            for (value, bin) in bins.iter_mut().zip(&state.outcome.bins) {
                *value = bin.map_or(-1.0, f64::from);
            }
        }
    }

    /// The bin of each ball.
    fn features(&self, state: StateRefOf<'_, Self>, features: &mut Features) -> bool {
        let rest = &state.outcome;
        let is_met = self.is_satisfied(rest);
        if is_met {
            rest.bins.iter().for_each(|bin| features.number(bin.map_or(-1, i64::from)));
        }
        is_met
    }

    fn cast(&self) -> Cast {
        let bodies = (0..self.balls).map(|ball| format!("ball_{ball}")).collect();
        let fixed = animate::FIXED.map(String::from).to_vec();
        let last = self.config.drop_interval_s * f64::from(self.balls as u32);
        let bins = Some(Grid { bins: self.arena.bins, letters: self.config.letters });
        Cast { bodies, fixed, longest: last + self.config.settle_s, turns: false, bins, ..Cast::default() }
    }

    fn demands(&self) -> Vec<(String, Require)> {
        let text = self.config.text.clone().unwrap_or_else(|| "HI".into());
        let (key, text) = if self.config.bitmap.is_empty() { ("text", text) } else { ("bitmap", String::new()) };
        let spells = Spells::of(text, self.config.bitmap.clone(), self.ln_lambda());
        let key = self.config.constrained.unwrap_or(true).then(|| format!("world.spelling.{key}"));
        key.map(|key| (key, Require::Spells(spells))).into_iter().collect()
    }

    fn asked(&self) -> Vec<String> {
        let key = self.demands().pop().map(|(key, _)| key);
        vec![key.unwrap_or_else(|| "the simulation comes to its end".into())]
    }

    fn missed(&self, _: usize, margin: f64) -> Option<Missed> {
        Some(Missed::lacking(margin, "bins"))
    }

    fn lacks(&self, _: usize, state: StateRefOf<'_, Self>) -> String {
        const TOLD: usize = 4;
        let full = &state.outcome.bins;
        let empty =
            self.word.designated().iter().map(|bin| usize::from(*bin)).filter(|bin| !full.contains(&Some(*bin as u16)));
        let place =
            |bin: usize| format!("row {}, column {}", bin / self.word.columns() + 1, bin % self.word.columns() + 1);
        let places: Vec<String> = empty.map(place).collect();
        let more = if places.len() > TOLD { " and others" } else { "" };
        if places.is_empty() {
            return String::new();
        }
        format!("no ball in {}{more}", places[..places.len().min(TOLD)].join("; "))
    }

    /// The margin is minus the number of designated bins without a ball at rest.
    fn answers(&self, state: StateRefOf<'_, Self>) -> Vec<Mark> {
        let rest = state.outcome;
        let empty = rest.complete.then(|| self.word.designated().len() - self.filled(rest));
        vec![Mark::of_own(self.is_satisfied(rest), empty)]
    }

    fn animate(&self, draw: &Drops) -> Result<Animation, ModelError> {
        animate::animate(&self.arena, &self.word, draw, self.motion(draw)?)
    }

    fn motion(&self, draw: &Drops) -> Result<Motion, ModelError> {
        let mut work = Work::default();
        work.kept.keep(false);
        work.simulate(self, draw, None, None)?;
        let balls = work.recorded(draw).ok_or_else(|| ModelError::new("nothing was recorded: a bug"))?;
        Ok(animate::film(&self.arena, balls, f64::INFINITY).motion)
    }

    fn scenery(&self, draw: &Drops, _: &Motion) -> Result<Vec<Prop>, ModelError> {
        props::props(&self.arena, &self.word, draw).map_err(ModelError::new)
    }

    fn physics(&self, draw: &Drops) -> Result<Option<Physics>, ModelError> {
        physics::physics(&self.arena, draw, &self.motion(draw)?).map(Some).map_err(ModelError::new)
    }

    fn simulate_watched(
        &self,
        draw: &Drops,
        current: Option<StateRefOf<'_, Self>>,
        (floor, stop): (LogPotential, Option<Stop>),
        work: &mut Work,
    ) -> Result<Simulated<Rest>, ModelError> {
        if self.savings.bound && self.most_of(draw.active()) <= floor {
            work.skip();
            return Ok(Simulated::CannotExceedFloor);
        }
        let known = current.map(|state| state.draw).filter(|_| self.savings.reuse);
        let rest = work.simulate(self, draw, known, stop)?;
        Ok(rest.map_or(Simulated::CannotExceedFloor, Simulated::Complete))
    }

    fn keep_motions(&self, work: &mut Work, contacts: bool) {
        work.kept.keep(contacts);
    }

    fn motion_simulated(&self, draw: &Drops, work: &Work) -> Result<Motion, ModelError> {
        match work.recorded(draw) {
            Some(balls) => Ok(animate::film(&self.arena, balls, f64::INFINITY).motion),
            None => self.motion(draw),
        }
    }

    fn at_accuracy(&self, accuracy: AccuracyPreset) -> Result<Option<Self>, ConfigError> {
        Self::new(&Config { accuracy, ..self.config.clone() }).map(|scene| Some(scene.with_savings(self.savings)))
    }

    fn world(&self) -> Result<Option<PlainWorld>, ModelError> {
        let balls = arena::balls(&self.config, &self.word).map_err(ModelError::new)?;
        self.arena.plain_world(balls).map(Some).map_err(ModelError::new)
    }
}
