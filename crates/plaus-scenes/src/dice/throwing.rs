//! Simulating a draw: each die alone on its own table, or all on one.

use super::draw::{Draw, Realisation, Throw};
use super::flight::{Asked, End, Looking, Trip, Watch};
use super::plan::Plan;
use super::surface::MATERIAL;
use super::{Dice, Rest};
use glam::DVec3;
use plaus_dist::LogPotential;
use plaus_mcmc::{ModelError, Simulated, StateOf};
use plaus_sim::rigid::{BodySpec, Part, Rigid, RigidScratch, RigidWorld, Start, Turning};
use plaus_sim::shape::Shape;
use plaus_sim::trace::{Observer, Trace};
use plaus_sim::{Outcome, Scratch, WorldError};

/// Standard gravity, m/s².
pub(super) const GRAVITY: f64 = 9.806_65;

/// Points of a die's skin that are looked at over bumps are this far apart, over the grid's spacing.
const SKIN: f64 = 1.0;

/// Working memory of one chain.
#[derive(Debug, Default)]
pub struct Work {
    scratch: Scratch<RigidScratch>,
    runs: u64,
}

impl Work {
    /// How many runs of the simulator it took; trips that a candidate leaves as they are take none.
    #[must_use]
    pub fn runs(&self) -> u64 {
        self.runs
    }

    pub(super) fn simulate(
        &mut self,
        scene: &Dice,
        draw: &Draw,
        current: Option<&StateOf<Dice>>,
        floor: LogPotential,
    ) -> Result<Simulated<Rest>, ModelError> {
        let plan = &scene.plan;
        let dice = draw.throws.len();
        let same = |die: usize| current.and_then(|state| known(plan, state, draw, die)).cloned();
        let mut trips: Vec<Option<Trip>> = (0..dice).map(same).collect();
        if plan.together {
            if trips.iter().any(Option::is_none) {
                let all = self.throw(plan, &draw.throws, &draw.tables[0], plan.asked.iter().collect(), plan.looking)?;
                trips = all.into_iter().map(Some).collect();
            }
        } else {
            for die in 0..dice {
                if trips[die].is_none() {
                    if cannot_exceed(plan, draw, &trips, floor)? {
                        return Ok(Simulated::CannotExceedFloor);
                    }
                    let (thrown, table) = (&draw.throws[die..=die], &draw.tables[die]);
                    trips[die] = self.throw(plan, thrown, table, vec![&plan.asked[die]], plan.looking)?.pop();
                }
            }
        }
        Ok(Simulated::Complete(scene.judge(draw, trips.into_iter().flatten().collect())))
    }

    /// Throws one die onto a table without edges, or one that is plain throughout: where it comes to rest, if it does.
    pub(super) fn try_out(
        &mut self,
        plan: &Plan,
        throw: &Throw,
        table: Option<&Realisation>,
    ) -> Result<Option<Trip>, ModelError> {
        let endless = Looking { edge: [f64::INFINITY; 2], ..plan.looking };
        let asked = Asked::default();
        let world = match table {
            Some(table) => plan.world(1, plan.surface.part(table))?,
            None => plan.world(1, plan.surface.plain())?,
        };
        let mut watch = Watch::new(&world, vec![&asked], endless, DVec3::ZERO);
        let bodies = self.run(plan, &world, std::slice::from_ref(throw), &mut watch)?;
        let trip = watch.finish(&bodies).pop();
        Ok(trip.filter(|trip| trip.end == End::AtRest))
    }

    /// Throws dice onto a table.
    fn throw(
        &mut self,
        plan: &Plan,
        throws: &[Throw],
        table: &Realisation,
        asked: Vec<&Asked>,
        looking: Looking,
    ) -> Result<Vec<Trip>, ModelError> {
        let world = plan.world(throws.len(), plan.surface.part(table))?;
        let [x, y] = table.shifted.map(|cells| f64::from(cells) * plan.surface.spacing());
        let offset = DVec3::new(x, y, 0.0);
        let mut watch = Watch::new(&world, asked, looking, offset);
        let bodies = self.run(plan, &world, throws, &mut watch)?;
        Ok(watch.finish(&bodies))
    }

    fn run(
        &mut self,
        plan: &Plan,
        world: &Rigid,
        throws: &[Throw],
        observer: &mut impl Observer<Rigid>,
    ) -> Result<Vec<Turning>, ModelError> {
        self.runs += 1;
        let start = |throw: &Throw| Start {
            position: throw.position,
            orientation: throw.orientation,
            velocity: throw.velocity,
            spin: throw.spin,
            time: 0.0,
        };
        let starts: Vec<Start> = throws.iter().map(start).collect();
        let mut state = world.state(&starts).map_err(ModelError::new)?;
        let outcome = world.run(&mut state, &mut self.scratch, plan.longest, observer).map_err(ModelError::new)?;
        if let Outcome::NotFinite { body } = outcome {
            return Err(ModelError::new(format!("die {}: its motion is no longer finite", body + 1)));
        }
        Ok(state.bodies().to_vec())
    }

    /// Simulates a draw with all motions and impacts: one recording for all dice, or one for each.
    pub(super) fn record(&mut self, plan: &Plan, draw: &Draw) -> Result<Vec<(Rigid, Trace<Turning>)>, ModelError> {
        let count = if plan.together { draw.throws.len() } else { 1 };
        let recorded = |(throws, table): (&[Throw], &Realisation)| {
            let (world, mut trace) = (plan.world(throws.len(), plan.surface.part(table))?, Trace::default());
            let bodies = self.run(plan, &world, throws, &mut trace)?;
            for (motions, last) in trace.motions.iter_mut().zip(bodies) {
                motions.push(last);
            }
            Ok((world, trace))
        };
        draw.throws.chunks(count).zip(&draw.tables).map(recorded).collect()
    }
}

impl Plan {
    /// A world of dice on a table.
    fn world(&self, dice: usize, table: Result<Part, WorldError>) -> Result<Rigid, ModelError> {
        let body = BodySpec::solid(Shape::Cuboid(self.cuboid), self.density, MATERIAL);
        let world = move || {
            Rigid::new(RigidWorld {
                bodies: vec![body; dice],
                parts: vec![table?],
                laws: self.surface.laws()?,
                gravity: DVec3::new(0.0, 0.0, -GRAVITY),
                accuracy: self.accuracy,
                skin: SKIN,
                sink: f64::NEG_INFINITY,
                duration: self.longest,
            })
        };
        world().map_err(ModelError::new)
    }
}

/// The trip of a die of the current state, where that of another draw has the same bits.
fn known<'a>(plan: &Plan, state: &'a StateOf<Dice>, draw: &Draw, die: usize) -> Option<&'a Trip> {
    let (trip, table) = (&state.outcome.trips[die], draw.table_of(die));
    let (old, new) = (&state.draw.tables[table], &draw.tables[table]);
    if !state.draw.throws[die].moves_like(&draw.throws[die]) || !old.has_points_of(new) {
        return None;
    }
    // A shift moves all there is, but for what was spilt, points that are to be passed, and the edges of the table.
    let moved = || {
        let offset = draw.offset(die, plan.surface.spacing());
        let anywhere = plan.carries() && !plan.surface.is_patched() && plan.asked[die].points.is_empty();
        anywhere && trip.end == End::AtRest && trip.stays_on(&plan.looking.edge, offset)
    };
    (old.shifted == new.shifted || moved()).then_some(trip)
}

/// Whether no outcome of the trips still to be made can lift the constraints above `floor`. Unknown terms are at most 0, and sums round monotonically.
fn cannot_exceed(plan: &Plan, draw: &Draw, trips: &[Option<Trip>], floor: LogPotential) -> Result<bool, ModelError> {
    if floor.is_zero() {
        return Ok(false);
    }
    if trips.iter().flatten().any(|trip| trip.end != End::AtRest) {
        return Ok(true);
    }
    let mark = |demand: &super::plan::Demand| {
        let pips = &plan.rotations[usize::from(draw.throws[demand.die].turn)];
        let offset = draw.offset(demand.die, plan.surface.spacing());
        trips[demand.die].as_ref().map_or(0.0, |trip| demand.mark(trip, pips, offset).log)
    };
    let most = plan.demands.iter().fold(0.0, |sum, demand| sum + mark(demand));
    Ok(LogPotential::new(most)? <= floor)
}
