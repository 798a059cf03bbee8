//! Bowling (section 5.2, appendix A): which pins are left is asked for; the ball, its delivery and the places of the
//! pins are uncertain.

mod alley;
mod animate;
mod approach;
mod config;
mod draw;
mod lane;
mod measures;
mod moves;
mod physics;
mod pool;
mod props;
mod rack;
mod release;
mod shot;
mod still;
mod verdict;

pub use alley::Alley;
pub use config::{Coefficients, Config, Rewarded, Steps};
pub use draw::Shot;
pub use moves::{Aim, BowlingMoves, mirror};
pub use rack::Rack;
pub use release::{Delivery, Quantity, Release};
pub use shot::{Entry, Fate, Rest, Work};
pub use verdict::Verdict;

/// Weights of the scene's moves.
pub type Weights = crate::Weights<BowlingMoves>;

use crate::accuracy::AccuracyPreset;
use crate::animation::{Animation, Motion, Physics, Prop};
use crate::model::{Column, Features, Scalar, columns, distinct};
use crate::require::{Cast, Leaves, Mark, Missed, Require, Stop};
use crate::rules::Rules;
use crate::scene::{ConfigError, Scene, Until};
use crate::words::listed;
use crate::world::PlainWorld;
use lane::Lane;
use plaus_dist::{Gibbs, LogDensity, LogPotential, Stream};
use plaus_mcmc::{
    Failure, Goal, Mixture, ModelError, Recipe, Simulated, SolutionClass, StateRefOf, Target, Variables, Vars, vars,
};
use plaus_sim::rigid::{RigidWorld, Start};
use shot::Pins;

/// Bowling: `p ∝ λ^(k+m) · p(ball) · Π p(pin's offset)`, where k counts the pins that end as they should, and m those
/// that stand as they should and have not moved far.
#[derive(Debug)]
pub struct Bowling {
    config: Config,
    rack: Rack,
    vars: Vars,
    lane: Lane,
}

impl Bowling {
    /// The scene of a configuration.
    ///
    /// # Errors
    ///
    /// [`ConfigError`] if there are no such pins, or the numbers are inconsistent.
    pub fn new(config: &Config) -> Result<Self, ConfigError> {
        let rack = Rack::new(config)?;
        let ln_lambda = if config.constrained.unwrap_or(true) { config.ln_lambda } else { 0.0 };
        let goal =
            Gibbs::from_ln_lambda(ln_lambda).map_err(|error| ConfigError::new("world.bowling.ln_lambda", error))?;
        let vars = draw::vars(config, rack.pins())?;
        let lane = Lane::new(config, &rack, goal).map_err(|error| ConfigError::new("world.bowling", error))?;
        Ok(Self { config: config.clone(), rack, vars, lane })
    }

    /// The configuration.
    #[must_use]
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// Which pins are set up, and which of them should be left.
    #[must_use]
    pub fn rack(&self) -> &Rack {
        &self.rack
    }

    /// The simulator's world of a draw, and how everything starts: the ball, then the pins that are set up, in
    /// ascending order of their numbers.
    ///
    /// # Errors
    /// [`ModelError`] if the draw's numbers are inconsistent.
    pub fn world(&self, draw: &Shot) -> Result<(RigidWorld, Vec<Start>), ModelError> {
        self.lane.world(draw, lane::LENGTH).map_err(ModelError::new)
    }

    /// k and m.
    #[must_use]
    pub fn counts(&self, rest: &Rest) -> (u64, u64) {
        self.lane.counts(&rest.pins)
    }

    /// The outcome of a shot whose ball starts `distance` m before the head pin's spot, in the place and with the
    /// velocities of the draw. It is for deliveries that must meet the pins in a given way.
    ///
    /// # Errors
    /// [`ModelError`] if there is no such world: the ball reaches into a pin or the lane, or a number is not finite.
    pub fn bowl_from(&self, distance: f64, draw: &Shot, work: &mut Work) -> Result<Rest, ModelError> {
        let rest = self.lane.bowl(draw, distance, work, (LogPotential::ZERO, None), &mut ())?;
        rest.ok_or_else(|| ModelError::new("a shot was stopped early although it was not hopeless: a bug"))
    }

    /// The pins that ended otherwise than they should.
    fn wrong<'a>(&'a self, rest: &'a Rest) -> impl Iterator<Item = (Wrong, usize)> + 'a {
        let far = self.config.moved_far_mm / 1000.0;
        let pins = self.rack.pins().iter().zip(&rest.pins).zip(self.rack.leave());
        pins.filter_map(move |((pin, fate), leave)| match (fate, leave) {
            (Fate::Standing(_), false) => Some((Wrong::Stands, *pin)),
            (Fate::Down, true) => Some((Wrong::Falls, *pin)),
            (Fate::Standing(way), true) if *way > far => Some((Wrong::MovesFar, *pin)),
            _ => None,
        })
    }

    /// Whether every pin ended as it should, and none that should stand has moved far.
    #[must_use]
    pub fn is_satisfied(&self, rest: &Rest) -> bool {
        rest.complete && (!self.config.constrained.unwrap_or(true) || self.wrong(rest).next().is_none())
    }
}

/// How a pin ends that does not end as it should.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Wrong {
    Stands,
    Falls,
    /// It stands, as it should, but not where it stood.
    MovesFar,
}

impl Target for Bowling {
    type Draw = Shot;
    type Outcome = Rest;
    type Scratch = Work;

    fn start(&self, stream: &mut Stream) -> Shot {
        let mut draw = Shot { ball: [0.0; 10], pins: vec![[0.0; 2]; self.rack.pins().len()] };
        self.renew_all(&mut draw, Recipe::Exact, stream);
        draw
    }

    fn log_prior(&self, draw: &Shot) -> Result<LogDensity, ModelError> {
        Ok(vars::log_prior(self, draw)?)
    }

    fn simulate(
        &self,
        draw: &Shot,
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
        Ok(self.lane.worth(&rest.pins))
    }

    fn failure(&self, rest: &Rest) -> Option<Failure> {
        rest.failed.as_deref().cloned()
    }

    fn most(&self) -> Option<LogPotential> {
        Some(self.lane.most(Pins::default()))
    }

    fn work(&self) -> u64 {
        plaus_sim::work()
    }

    fn numbers(&self, state: StateRefOf<'_, Self>) -> Vec<f64> {
        crate::scene::numbers(self, state)
    }
}

impl Variables for Bowling {
    fn vars(&self) -> &Vars {
        &self.vars
    }

    fn get<'a>(&self, draw: &'a Shot, var: usize) -> Option<&'a [f64]> {
        draw.values(var)
    }

    fn get_mut<'a>(&self, draw: &'a mut Shot, var: usize) -> Option<&'a mut [f64]> {
        draw.values_mut(var)
    }
}

impl Goal for Bowling {
    fn class(&self, state: StateRefOf<'_, Self>) -> Option<SolutionClass> {
        distinct::class(self, state, 1.0)
    }
}

/// Boards of a lane.
const BOARDS: f64 = 39.0;

/// The board over which the ball's centre was when it met the first pin, counted from the bowler's right as bowlers do;
/// 0 if it met none.
fn board(rest: &Rest) -> f64 {
    rest.entry.map_or(0.0, |entry| boards(&entry).floor() + 1.0)
}

/// How many boards to the left of the lane's right edge that was.
fn boards(entry: &Entry) -> f64 {
    (0.5 - entry.across / lane::WIDTH) * BOARDS
}

impl Scene for Bowling {
    fn moves(&self, rules: &Rules) -> Result<Mixture<Self>, ConfigError> {
        self.config.weights.mix(self.config.moves, self, moves::all(self, rules))
    }

    fn scalars(&self) -> Vec<Scalar> {
        let counts = ["k", "m", "pinfall"].map(Column::count);
        let results = [Column::result("board", ""), Column::result("angle", "°")];
        columns::scalars(counts.into_iter().chain(results).map(|column| column.of(None)).collect(), &self.vars)
    }

    /// If the ball met no pin, the board and the angle are 0.
    fn write_scalars(&self, state: StateRefOf<'_, Self>, values: &mut [f64]) {
        if let [k, m, pinfall, at, angle, ball @ ..] = values {
            let rest = &state.outcome;
            let counts = self.counts(rest);
            (*k, *m) = (counts.0 as f64, counts.1 as f64);
            *pinfall = rest.pins.iter().filter(|fate| !fate.stands()).count() as f64;
            *at = board(rest);
            *angle = rest.entry.map_or(0.0, |entry| entry.angle);
            ball.iter_mut().zip(columns::values(self, state.draw)).for_each(|(place, value)| *place = value);
        }
    }

    /// The board on which the ball met the first pin, 0 if it met none, and the pins that it struck, in order.
    fn features(&self, state: StateRefOf<'_, Self>, features: &mut Features) -> bool {
        let (rest, is_met) = (&state.outcome, self.is_satisfied(state.outcome));
        if is_met {
            features.place(rest.entry.map_or(0.0, |entry| boards(&entry) + 1.0));
            rest.struck.iter().for_each(|&pin| features.number(i64::from(pin)));
        }
        is_met
    }

    fn cast(&self) -> Cast {
        let bodies = (0..=self.rack.pins().len()).map(|body| self.lane.name(body)).collect();
        let fixed = Alley::PARTS.map(String::from).to_vec();
        Cast { bodies, fixed, longest: self.config.duration_s, view: Some(animate::view()), ..Cast::default() }
    }

    fn demands(&self) -> Vec<(String, Require)> {
        let Config { leave, moved_far_mm, ln_lambda, .. } = &self.config;
        let leaves =
            Leaves { pins: leave.clone(), moved_far_mm: *moved_far_mm, nats_each: *ln_lambda, ..Leaves::default() };
        let key = self.config.constrained.unwrap_or(true).then(|| "world.bowling.leave".to_owned());
        key.map(|key| (key, Require::Leaves(leaves))).into_iter().collect()
    }

    fn asked(&self) -> Vec<String> {
        let key = self.demands().pop().map(|(key, _)| key);
        vec![key.unwrap_or_else(|| "the shot comes to its end".into())]
    }

    fn missed(&self, _: usize, margin: f64) -> Option<Missed> {
        Some(Missed::lacking(margin, "pins"))
    }

    fn lacks(&self, _: usize, state: StateRefOf<'_, Self>) -> String {
        let kinds = [
            (Wrong::Stands, "stands", "stand"),
            (Wrong::Falls, "falls", "fall"),
            (Wrong::MovesFar, "moves far", "move far"),
        ];
        let told = kinds.into_iter().filter_map(|(kind, one, several)| {
            let pins = self.wrong(state.outcome).filter(|(wrong, _)| *wrong == kind).map(|(_, pin)| pin);
            match pins.collect::<Vec<_>>().as_slice() {
                [] => None,
                [pin] => Some(format!("pin {pin} {one}")),
                pins => Some(format!("pins {} {several}", listed(pins))),
            }
        });
        told.collect::<Vec<_>>().join(", ")
    }

    /// The margin is minus the number of pins that did not end as they should.
    fn answers(&self, state: StateRefOf<'_, Self>) -> Vec<Mark> {
        let rest = state.outcome;
        let wrong = rest.complete.then(|| self.wrong(rest).count());
        vec![Mark::of_own(self.is_satisfied(rest), wrong)]
    }

    fn animate(&self, draw: &Shot) -> Result<Animation, ModelError> {
        self.motion(draw).map(animate::animate)
    }

    fn animate_until(&self, draw: &Shot, until: Until) -> Result<Animation, ModelError> {
        let animation = animate::animate(self.lane.record(draw, &mut Work::default(), Some(until))?.film(&self.lane)?);
        Ok(if let Until::Time(end) = until { animation.until(end) } else { animation })
    }

    fn motion(&self, draw: &Shot) -> Result<Motion, ModelError> {
        self.lane.record(draw, &mut Work::default(), None)?.film(&self.lane)
    }

    fn scenery(&self, _: &Shot, _: &Motion) -> Result<Vec<Prop>, ModelError> {
        Ok(props::props())
    }

    fn physics(&self, draw: &Shot) -> Result<Option<Physics>, ModelError> {
        physics::physics(&self.lane, draw, &self.motion(draw)?).map(Some).map_err(ModelError::new)
    }

    fn simulate_watched(
        &self,
        draw: &Shot,
        _: Option<StateRefOf<'_, Self>>,
        (floor, stop): (LogPotential, Option<Stop>),
        work: &mut Work,
    ) -> Result<Simulated<Rest>, ModelError> {
        let rest = self.lane.bowl(draw, lane::LENGTH, work, (floor, stop), &mut ())?;
        Ok(rest.map_or(Simulated::CannotExceedFloor, Simulated::Complete))
    }

    fn keep_motions(&self, work: &mut Work, contacts: bool) {
        work.kept.keep(contacts);
    }

    fn motion_simulated(&self, draw: &Shot, work: &Work) -> Result<Motion, ModelError> {
        work.recorded(draw).map_or_else(|| self.motion(draw), |record| record.film(&self.lane))
    }

    fn at_accuracy(&self, accuracy: AccuracyPreset) -> Result<Option<Self>, ConfigError> {
        Self::new(&Config { accuracy, ..self.config.clone() }).map(Some)
    }

    fn world(&self) -> Result<Option<PlainWorld>, ModelError> {
        self.lane.plain_world().map(Some).map_err(ModelError::new)
    }
}
