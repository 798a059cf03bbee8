//! Dice on a random table (section 5.4): their resting places and faces are asked for; how they are thrown and the
//! table's height, restitution and friction are uncertain.
//!
//! **A table of any size.** Control points are made only where a die comes near them. The value of a point that no move
//! has changed is a pure function of its address: the table's key (from the seed, the chain and the iteration that drew
//! it), the field and the indices. So it does not matter when the point is looked at, or whether it is. The target's
//! density is taken with respect to the law of the whole table. So a point that no die touches drops out of every
//! ratio, and a chain that held all points from the start would have the same states.
//!
//! **When two solutions are distinct.** Every tenth of a second, each die is observed: in which square of 20 mm it is,
//! and which face is uppermost. If these agree at all times, two solutions count as one.

mod animate;
mod config;
mod constraint;
mod draw;
mod fall;
mod flight;
mod moves;
mod physics;
mod plan;
mod prior;
mod props;
mod reuse;
mod surface;
mod symmetry;
mod throwing;

pub use config::{Config, Die, MOST_DICE, Spilt, Steps, Table, Throwing};
pub use constraint::{Constraint, FaceUp, FirstImpact, Mark, Passes, PoseAt, RestAt};
pub use draw::{Draw, Field, LARGEST_SCORE, NUMBERS, Realisation, Site, Throw};
pub use flight::{End, Frame, Trip};
pub use moves::{DiceMoves, Pick, Point, Recast, Shift, component, turn};
pub use prior::Prior;
pub use symmetry::Rotation;
pub use throwing::Work;

/// Weights of the scene's moves.
pub type Weights = crate::Weights<DiceMoves>;

use crate::accuracy::AccuracyPreset;
use crate::animation::{Animation, Motion, Physics};
use crate::model::{Column, Features, Member, Scalar, columns, distinct};
use crate::require::{self as required, Cast, FAR, Missed, Require, Stop};
use crate::rules::Rules;
use crate::scene::{ConfigError, Scene};
use crate::turns::{any_orientation, turned_a_little};
use crate::words::listed;
use crate::world::PlainWorld;
use draw::{EACH, ORIENTATION};
use fall::{Recorded, Seen};
use plan::{Demand, Plan};
use plaus_dist::stream::below;
use plaus_dist::{LogDensity, LogPotential, Stream};
use plaus_mcmc::{
    Failure, Goal, Mixture, ModelError, Recipe, Simulated, SolutionClass, StateRefOf, Target, Variables, Vars,
};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use surface::Touched;

/// Dice: `p ∝ Π constraints · Π priors of the throws`, with respect to the law of the tables.
#[derive(Debug)]
pub struct Dice {
    config: Config,
    plan: Plan,
    prior: Prior,
    vars: Vars,
}

/// The outcome of a draw.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Rest {
    /// The path of each die.
    pub trips: Vec<Trip>,
    /// The face that each die shows; 0 if it does not lie at rest on the table.
    pub faces: Vec<u8>,
    /// How well each constraint is met.
    pub marks: Vec<Mark>,
}

impl Rest {
    /// Whether every die lies at rest on the table. If one does not, the draw has probability 0.
    #[must_use]
    pub fn complete(&self) -> bool {
        self.trips.iter().all(|trip| trip.end == End::AtRest)
    }

    /// Whether that is so and, in addition, every constraint is met.
    #[must_use]
    pub fn satisfied(&self) -> bool {
        self.complete() && self.marks.iter().all(|mark| mark.met)
    }
}

impl Dice {
    /// The scene of a configuration.
    ///
    /// # Errors
    ///
    /// [`ConfigError`] if a constraint asks for something off the table or about a die that does not exist, or if the
    /// numbers are inconsistent.
    pub fn new(config: &Config) -> Result<Self, ConfigError> {
        let plan = Plan::new(config)?;
        let prior = plan.prior(config)?;
        Ok(Self { config: config.clone(), plan, vars: prior.vars(), prior })
    }

    /// The configuration.
    #[must_use]
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// The law of a draw without the constraints.
    #[must_use]
    pub fn prior(&self) -> &Prior {
        &self.prior
    }

    /// Which dice are simulated together, because they come near each other.
    ///
    /// # Errors
    /// [`ModelError`] if the simulation fails.
    pub fn groups(&self, draw: &Draw) -> Result<Vec<Vec<usize>>, ModelError> {
        if self.plan.together {
            Work::default().groups(self, draw)
        } else {
            Ok((0..draw.throws.len()).map(|die| vec![die]).collect())
        }
    }

    /// By how much a die's place is shifted from what its trip says, in m.
    #[must_use]
    pub fn offset(&self, draw: &Draw, die: usize) -> glam::DVec3 {
        draw.offset(die, self.plan.surface.spacing())
    }

    /// The fields of the table that are random.
    #[must_use]
    pub fn fields(&self) -> &[Field] {
        &self.plan.surface.random
    }

    /// The value of a control point: metres for heights, else a pure number.
    #[must_use]
    pub fn value(&self, table: &Realisation, site: Site) -> f64 {
        self.plan.surface.value(table.shifted, site, table.score(site))
    }

    /// How many control points the dice of a draw came near, over all tables and fields, and the memory in bytes of all
    /// points that were made for that.
    ///
    /// # Errors
    /// [`ModelError`] if the simulation fails.
    pub fn touched(&self, draw: &Draw) -> Result<(usize, usize), ModelError> {
        let (mut sites, mut bytes) = (BTreeSet::new(), 0);
        for members in self.groups(draw)? {
            let (run, mut world) = Work::default().record_group(&self.plan, draw, members, self.plan.longest)?;
            bytes += surface::bytes(world.parts_mut());
            let table = run.members.first().map(|&die| draw.table_of(die));
            sites.extend(Touched::take(world.parts_mut()).sites().map(|site| (table, site)));
        }
        Ok((sites.len(), bytes))
    }

    /// The same scene with a move [`Turn`] that takes every die for a cube. This is wrong for any other cuboid: the
    /// move then no longer leaves the target invariant. It is for tests that must detect this.
    #[doc(hidden)]
    #[must_use]
    pub fn taken_for_cubes(mut self) -> Self {
        self.plan.rotations = Rotation::of_cuboid(glam::DVec3::ONE);
        self
    }

    /// The dice alone, as they were recorded.
    fn film<'a>(&self, draw: &Draw, recorded: impl IntoIterator<Item = &'a Recorded>) -> Result<Motion, ModelError> {
        let seen: Vec<Seen<'_>> = recorded.into_iter().map(Recorded::seen).collect();
        Ok(animate::film(self, draw, &seen, f64::INFINITY)?.motion)
    }

    /// The outcome that follows from the paths of all dice: faces, and how well each constraint is met.
    ///
    /// # Panics
    ///
    /// If there are fewer trips than dice.
    #[must_use]
    pub fn judge(&self, draw: &Draw, trips: Vec<Trip>) -> Rest {
        let pips = |die: usize| &self.plan.rotations[usize::from(draw.throws[die].turn)];
        let face = |(die, trip): (usize, &Trip)| match trip.end {
            End::AtRest => pips(die).uppermost(trip.orientation).0,
            _ => 0,
        };
        let faces = trips.iter().enumerate().map(face).collect();
        let mark = |demand: &Demand| demand.mark(&trips[demand.die], pips(demand.die), self.offset(draw, demand.die));
        let marks = self.plan.demands.iter().map(mark).collect();
        Rest { trips, faces, marks }
    }
}

impl Target for Dice {
    type Draw = Draw;
    type Outcome = Rest;
    type Scratch = Work;

    fn start(&self, stream: &mut Stream) -> Draw {
        self.prior.sample(stream)
    }

    fn log_prior(&self, draw: &Draw) -> Result<LogDensity, ModelError> {
        Ok(self.prior.log_density(draw)?)
    }

    fn simulate(
        &self,
        draw: &Draw,
        current: Option<StateRefOf<'_, Self>>,
        floor: LogPotential,
        work: &mut Work,
    ) -> Result<Simulated<Rest>, ModelError> {
        self.simulate_watched(draw, current, (floor, None), work)
    }

    fn decided(&self, accepted: bool, work: &mut Work) {
        work.decided(accepted);
    }

    fn log_constraint(&self, rest: &Rest) -> Result<LogPotential, ModelError> {
        if !rest.complete() {
            return Ok(LogPotential::ZERO);
        }
        // Summed in the order of the constraints, like the bound.
        Ok(LogPotential::new(rest.marks.iter().fold(0.0, |sum, mark| sum + mark.log))?)
    }

    fn failure(&self, rest: &Rest) -> Option<Failure> {
        rest.trips.iter().find_map(|trip| trip.failed.as_deref().cloned())
    }

    fn most(&self) -> Option<LogPotential> {
        Some(LogPotential::ONE)
    }

    fn work(&self) -> u64 {
        plaus_sim::work()
    }

    fn numbers(&self, state: StateRefOf<'_, Self>) -> Vec<f64> {
        crate::scene::numbers(self, state)
    }
}

impl Goal for Dice {
    fn class(&self, state: StateRefOf<'_, Self>) -> Option<SolutionClass> {
        distinct::class(self, state, 1.0)
    }
}

impl Variables for Dice {
    fn vars(&self) -> &Vars {
        &self.vars
    }

    fn get<'a>(&self, draw: &'a Draw, var: usize) -> Option<&'a [f64]> {
        let number = Some(var % EACH).filter(|&number| number < NUMBERS)?;
        draw.throws.get(var / EACH).map(|throw| std::slice::from_ref(draw::number(throw, number)))
    }

    fn get_mut<'a>(&self, draw: &'a mut Draw, var: usize) -> Option<&'a mut [f64]> {
        let number = Some(var % EACH).filter(|&number| number < NUMBERS)?;
        draw.throws.get_mut(var / EACH).map(|throw| std::slice::from_mut(draw::number_mut(throw, number)))
    }

    /// A die's place is shifted with its table.
    fn shift(&self, draw: &Draw, var: usize) -> f64 {
        if var % EACH < 2 && var / EACH < draw.throws.len() { self.offset(draw, var / EACH)[var % EACH] } else { 0.0 }
    }

    fn renew_own(&self, draw: &mut Draw, var: usize, stream: &mut Stream) {
        match (var % EACH, draw.throws.get_mut(var / EACH)) {
            (ORIENTATION, Some(throw)) => throw.orientation = any_orientation(stream),
            (_, Some(throw)) => throw.turn = below(stream, self.plan.rotations.len()) as u8,
            _ => draw.tables[var - EACH * draw.throws.len()].renew(stream),
        }
    }

    fn step_own(&self, draw: &mut Draw, var: usize, size: f64, stream: &mut Stream) {
        match (var % EACH, draw.throws.get_mut(var / EACH)) {
            (ORIENTATION, Some(throw)) => {
                throw.orientation = turned_a_little(throw.orientation, size, stream);
            }
            _ => self.renew_own(draw, var, stream),
        }
    }

    fn renew_all(&self, draw: &mut Draw, _: Recipe, stream: &mut Stream) {
        for (die, throw) in draw.throws.iter_mut().enumerate() {
            *throw = self.prior.throw(die, stream);
        }
        draw.tables.iter_mut().for_each(|table| table.renew(stream));
    }

    /// A die's throw, and its table if it has its own.
    fn renew_group(&self, draw: &mut Draw, die: usize, stream: &mut Stream) {
        draw.throws[die] = self.prior.throw(die, stream);
        if draw.tables.len() == draw.throws.len() {
            draw.tables[die].renew(stream);
        }
    }
}

/// A die's outcomes: where it lies, what it shows, and how often it touched the table.
const RESULTS: [Column; 4] =
    [Column::result("rest_x", "mm"), Column::result("rest_y", "mm"), Column::count("face"), Column::count("impacts")];

/// One more if dice are thrown onto one table: 1 if a die touched another one, else 0. Chains hardly go from one to the
/// other, because neither of two dice that met comes to its place without the other: this shows it.
const MET: Column = Column::count("met");

impl Dice {
    /// The columns of a die's outcomes.
    fn results(&self) -> impl Iterator<Item = Column> {
        RESULTS.into_iter().chain(self.plan.together.then_some(MET))
    }
}

impl Scene for Dice {
    fn moves(&self, rules: &Rules) -> Result<Mixture<Self>, ConfigError> {
        self.config.weights.mix(self.config.moves, self, moves::all(self, rules))
    }

    fn scalars(&self) -> Vec<Scalar> {
        let of = |number| self.results().map(move |column| column.of(Some(Member { kind: "die", number })));
        columns::scalars((1..=self.config.dice).flat_map(of).collect(), &self.vars)
    }

    fn write_scalars(&self, state: StateRefOf<'_, Self>, values: &mut [f64]) {
        let mut variables = columns::values(self, state.draw);
        let each = state.outcome.trips.iter().zip(&state.outcome.faces);
        let results = self.results().count();
        for (die, ((trip, face), values)) in each.zip(values.chunks_exact_mut(results + NUMBERS)).enumerate() {
            let (rest, thrown) = values.split_at_mut(results);
            let at = (trip.position + self.offset(state.draw, die)) * 1e3;
            let found = [at.x, at.y, f64::from(*face), trip.impacts.len() as f64, f64::from(u8::from(trip.met))];
            rest.copy_from_slice(&found[..results]);
            thrown.iter_mut().zip(&mut variables).for_each(|(place, value)| *place = value);
        }
    }

    /// The cell of each die and its uppermost face, at regular times.
    fn features(&self, state: StateRefOf<'_, Self>, features: &mut Features) -> bool {
        let rest = &state.outcome;
        if rest.satisfied() {
            for (die, trip) in rest.trips.iter().enumerate() {
                let pips = &self.plan.rotations[usize::from(state.draw.throws[die].turn)];
                trip.features(features, pips, self.plan.looking.cell, self.offset(state.draw, die));
            }
        }
        rest.satisfied()
    }

    fn cast(&self) -> Cast {
        let bodies = (1..=self.config.dice).map(|die| format!("die_{die}")).collect();
        let fixed = vec!["table".into()];
        Cast { bodies, fixed, longest: self.config.longest_s, faces: true, ..Cast::default() }
    }

    fn demands(&self) -> Vec<(String, Require)> {
        let key = |(index, one): (usize, &Constraint)| {
            Some((format!("world.dice.constraints[{index}].{}", one.name()), one.as_requirement()?))
        };
        self.config.constraints.iter().enumerate().filter_map(key).collect()
    }

    /// Each constraint, and that all dice come to rest.
    fn asked(&self) -> Vec<String> {
        let name = |one: &Constraint| format!("{} of die {}", one.name(), one.die());
        self.config.constraints.iter().map(name).chain(["all dice come to rest".to_owned()]).collect()
    }

    fn missed(&self, thing: usize, margin: f64) -> Option<Missed> {
        self.config.constraints.get(thing).map_or(Some(Missed::Never), |one| one.missed(margin))
    }

    fn lacks(&self, thing: usize, state: StateRefOf<'_, Self>) -> String {
        let rest = state.outcome;
        let Some(demand) = self.plan.demands.get(thing) else {
            let on_its_way = rest.trips.iter().enumerate().filter(|(_, trip)| trip.end != End::AtRest);
            let dice: Vec<usize> = on_its_way.map(|(die, _)| die + 1).collect();
            return format!("not {}", listed(&dice));
        };
        let pips = &self.plan.rotations[usize::from(state.draw.throws[demand.die].turn)];
        demand.lacks(&rest.trips[demand.die], pips, self.offset(state.draw, demand.die))
    }

    fn answers(&self, state: StateRefOf<'_, Self>) -> Vec<required::Mark> {
        let rest = &state.outcome;
        let margin = |met: bool, log: f64| if met { 0.0 } else { log.min(-f64::MIN_POSITIVE) };
        let marks = rest.marks.iter().map(|mark| margin(mark.met, mark.log));
        marks.chain([margin(rest.complete(), -FAR)]).map(required::Mark::of).collect()
    }

    fn animate(&self, draw: &Draw) -> Result<Animation, ModelError> {
        animate::animate(self, draw, &Work::default().record(self, draw, self.plan.longest)?)
    }

    fn motion(&self, draw: &Draw) -> Result<Motion, ModelError> {
        self.film(draw, &Work::default().record(self, draw, self.plan.longest)?)
    }

    fn physics(&self, draw: &Draw) -> Result<Option<Physics>, ModelError> {
        physics::physics(self, &self.motion(draw)?).map(Some).map_err(ModelError::new)
    }

    fn simulate_watched(
        &self,
        draw: &Draw,
        current: Option<StateRefOf<'_, Self>>,
        (floor, stop): (LogPotential, Option<Stop>),
        work: &mut Work,
    ) -> Result<Simulated<Rest>, ModelError> {
        work.simulate(self, draw, current, (floor, stop))
    }

    fn keep_motions(&self, work: &mut Work, contacts: bool) {
        work.kept.keep(contacts);
    }

    fn motion_simulated(&self, draw: &Draw, work: &Work) -> Result<Motion, ModelError> {
        match work.recorded(draw) {
            Some(recorded) => self.film(draw, recorded),
            None => self.motion(draw),
        }
    }

    fn at_accuracy(&self, accuracy: AccuracyPreset) -> Result<Option<Self>, ConfigError> {
        Self::new(&Config { accuracy, ..self.config.clone() }).map(Some)
    }

    fn world(&self) -> Result<Option<PlainWorld>, ModelError> {
        self.plan.plain_world(self.config.dice as usize).map(Some)
    }
}
