//! Simulating a draw: each die alone on its own table, or groups of dice on one.

use super::animate::film;
use super::draw::{Draw, Realisation, Throw};
use super::fall::{Fall, Recorded, Seen};
use super::flight::{Asked, End, Looking, Trip, Watch};
use super::plan::Plan;
use super::surface::{MATERIAL, Touched};
use super::{Dice, Rest};
use crate::failed::{Cause, failure};
use crate::film::Reel;
use crate::model::groups::Memory;
use crate::require::{Kept, Stop};
use crate::world::{Physical, PlainWorld};
use glam::DVec3;
use plaus_dist::LogPotential;
use plaus_mcmc::{Failure, ModelError, Simulated, StateRefOf};
use plaus_sim::mechanics::{Impact, Other};
use plaus_sim::rigid::{BodySpec, RigidBodyState, RigidScratch, RigidWorld, RigidWorldDesc, Start, StaticShape};
use plaus_sim::scenery::Plane;
use plaus_sim::shape::Shape;
use plaus_sim::trace::{Observer, Trace};
use plaus_sim::{Scratch, State, WorldError};
use std::sync::Arc;

/// Standard gravity, m/s².
pub(super) const GRAVITY: f64 = 9.806_65;

/// Height in m of the throwing hand.
const HAND: f64 = 0.1;

/// Distance of the points of a die's skin that are checked over bumps, relative to the grid's spacing.
const SKIN: f64 = 1.0;

/// Working memory of one chain.
#[derive(Debug, Default)]
pub struct Work {
    scratch: Scratch<RigidScratch>,
    runs: u64,
    dice: u64,
    /// For dice thrown onto one table: what is known about the chain's state, and about the candidate simulated last.
    pub(super) memory: Memory<Draw, Fall>,
    pub(super) kept: Kept,
    /// For dice thrown onto tables of their own: the draw simulated last and the chain's state, with their motions.
    last: Option<OfDraw>,
    current: Option<OfDraw>,
}

/// A draw with the motions of its dice, in order.
type OfDraw = (Draw, Vec<Arc<Recorded>>);

impl Work {
    /// How many runs of the simulator were made; trips that a candidate does not change take none.
    #[must_use]
    pub fn runs(&self) -> u64 {
        self.runs
    }

    /// How many dice were simulated in those runs.
    #[must_use]
    pub fn dice(&self) -> u64 {
        self.dice
    }

    pub(super) fn simulate(
        &mut self,
        scene: &Dice,
        draw: &Draw,
        current: Option<StateRefOf<'_, Dice>>,
        (floor, stop): (LogPotential, Option<Stop>),
    ) -> Result<Simulated<Rest>, ModelError> {
        if scene.plan.together {
            let trips = self.throw_together(scene, (draw, stop), current.map(|state| state.draw))?;
            return Ok(
                trips.map_or(Simulated::CannotExceedFloor, |trips| Simulated::Complete(scene.judge(draw, trips)))
            );
        }
        self.throw_apart(scene, (draw, stop), current, floor)
    }

    /// Simulates dice that have tables of their own, one after another.
    fn throw_apart(
        &mut self,
        scene: &Dice,
        (draw, stop): (&Draw, Option<Stop>),
        current: Option<StateRefOf<'_, Dice>>,
        floor: LogPotential,
    ) -> Result<Simulated<Rest>, ModelError> {
        let (plan, dice) = (&scene.plan, draw.throws.len());
        self.last = None;
        let mut trips: Vec<Option<Trip>> =
            (0..dice).map(|die| current.and_then(|state| known(plan, state, draw, die)).cloned()).collect();
        // A trip that is known has the motions of the chain's state, if they were kept.
        let kept = self.current.as_ref().filter(|(of, _)| current.is_some_and(|state| state.draw == of));
        let kept =
            |(die, trip): (usize, &Option<Trip>)| kept.filter(|_| trip.is_some()).map(|(_, all)| Arc::clone(&all[die]));
        let mut recorded: Vec<Option<Arc<Recorded>>> = trips.iter().enumerate().map(kept).collect();
        for die in 0..dice {
            if trips[die].is_some() {
                continue;
            }
            if cannot_exceed(plan, draw, &trips, floor)? {
                return Ok(Simulated::CannotExceedFloor);
            }
            // As long as others are unknown, nothing can be said of the motion of all.
            let others: Vec<Arc<Recorded>> = recorded.iter().flatten().cloned().collect();
            let stop = stop.clone().filter(|_| others.len() + 1 == dice);
            let Some(mut fall) = self.fall((scene, draw), vec![die], (&others, stop))? else {
                return Ok(Simulated::CannotExceedFloor);
            };
            trips[die] = fall.trips.pop();
            recorded[die] = fall.recorded;
        }
        let recorded: Option<Vec<Arc<Recorded>>> = recorded.into_iter().collect();
        self.last = recorded.map(|recorded| (draw.clone(), recorded));
        Ok(Simulated::Complete(scene.judge(draw, trips.into_iter().flatten().collect())))
    }

    /// Keeps what is known about the candidate simulated last if it became the current state.
    pub(super) fn decided(&mut self, accepted: bool) {
        self.memory.decided(accepted);
        if accepted {
            self.current = self.last.take();
        }
    }

    /// The motions of a draw, if they are kept.
    pub(super) fn recorded(&self, draw: &Draw) -> Option<Vec<&Recorded>> {
        let together = &self.memory.candidate;
        if together.draw.as_ref() == Some(draw) {
            return together.last.iter().map(|fall| fall.recorded.as_deref()).collect();
        }
        let (_, alone) = self.last.as_ref().filter(|(known, _)| known == draw)?;
        Some(alone.iter().map(Arc::as_ref).collect())
    }

    /// Throws one die onto a table without edges, or onto a plain one; returns where it comes to rest, if it does.
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
        let (bodies, failed) = self.run((&world, plan.longest), (&[0], std::slice::from_ref(throw)), &mut watch)?;
        let trip = if failed.is_some() { None } else { watch.finish(&bodies, plan.longest).0.pop() };
        Ok(trip.filter(|trip| trip.end == End::AtRest))
    }

    /// Throws some dice onto their table, by themselves; `None` if `stop` ends it, which sees them beside `others`.
    pub(super) fn fall(
        &mut self,
        (scene, draw): (&Dice, &Draw),
        members: Vec<usize>,
        (others, stop): (&[Arc<Recorded>], Option<Stop>),
    ) -> Result<Option<Fall>, ModelError> {
        let plan = &scene.plan;
        let first = members.first().copied().unwrap_or(0);
        let mut world = plan.world(members.len(), plan.surface.part(&draw.tables[draw.table_of(first)]))?;
        let throws: Vec<Throw> = members.iter().map(|&die| draw.throws[die]).collect();
        let asked = members.iter().map(|&die| &plan.asked[die]).collect();
        let mut watch = Watch::new(&world, asked, plan.looking, draw.offset(first, plan.surface.spacing()));
        let camera =
            self.kept.motions.then(|| Camera { scene, draw, members: &members, others, reel: Reel::new(stop) });
        let mut listeners = (&mut watch, camera);
        let (bodies, failed) = self.run((&world, plan.longest), (&members, &throws), &mut listeners)?;
        let reel = listeners.1.map(|camera| camera.reel);
        if reel.as_ref().is_some_and(|reel| reel.is_hopeless) {
            return Ok(None);
        }
        let is_full = reel.as_ref().is_some_and(Reel::is_full);
        let last = bodies.iter().map(|body| body.path.t).fold(0.0, f64::max);
        let failed = failed.or_else(|| is_full.then(|| Cause::TooLong.failure("the simulation", None, last)));
        let (trips, ways) = match failed {
            Some(failure) => watch.fail(&failure, plan.longest),
            None => watch.finish(&bodies, plan.longest),
        };
        let touched = Touched::take(world.parts_mut());
        // If a die leaves the table, its run ends early.
        let recorded = reel
            .filter(|_| trips.iter().all(|trip| trip.end == End::AtRest))
            .map(|reel| Arc::new(Recorded::new(members.clone(), reel.trace, bodies)));
        Ok(Some(Fall { members, trips, ways, touched, recorded }))
    }

    /// Runs a world of some dice for at most this many seconds; also says why it failed, if it did.
    fn run(
        &mut self,
        (world, longest): (&RigidWorld, f64),
        (members, throws): (&[usize], &[Throw]),
        listener: &mut impl Observer<RigidWorld>,
    ) -> Result<(Vec<RigidBodyState>, Option<Failure>), ModelError> {
        self.runs += 1;
        self.dice += throws.len() as u64;
        let start = |throw: &Throw| Start {
            position: throw.position,
            orientation: throw.orientation,
            velocity: throw.velocity,
            spin: throw.spin,
            time: 0.0,
        };
        let starts: Vec<Start> = throws.iter().map(start).collect();
        let mut state = world.state(&starts).map_err(ModelError::new)?;
        let outcome = world.run(&mut state, &mut self.scratch, longest, listener).map_err(ModelError::new)?;
        let name = |other: Other| match other {
            Other::Body(die) => format!("die_{}", members[die] + 1),
            Other::Surface(_) => "table".to_owned(),
        };
        Ok((state.bodies().to_vec(), failure(outcome, state.time(), name)))
    }

    /// Simulates a draw with all motions and impacts, group by group, for at most this many seconds.
    pub(super) fn record(&mut self, scene: &Dice, draw: &Draw, longest: f64) -> Result<Vec<Recorded>, ModelError> {
        let alone = || (0..draw.throws.len()).map(|die| vec![die]).collect();
        let groups = if scene.plan.together { self.groups(scene, draw)? } else { alone() };
        let plan = &scene.plan;
        groups.into_iter().map(|members| self.record_group(plan, draw, members, longest).map(|(run, _)| run)).collect()
    }

    /// Simulates some dice by themselves with all motions and impacts, and gives the world they were in.
    pub(super) fn record_group(
        &mut self,
        plan: &Plan,
        draw: &Draw,
        members: Vec<usize>,
        longest: f64,
    ) -> Result<(Recorded, RigidWorld), ModelError> {
        let throws: Vec<Throw> = members.iter().map(|&die| draw.throws[die]).collect();
        let table = draw.table_of(members.first().copied().unwrap_or(0));
        let world = plan.world(members.len(), plan.surface.part(&draw.tables[table]))?;
        let mut trace = Trace::default();
        let (bodies, failed) = self.run((&world, longest), (&members, &throws), &mut trace)?;
        if let Some(failure) = failed {
            return Err(ModelError::new(failure.to_string()));
        }
        Ok((Recorded::new(members, trace, bodies), world))
    }
}

/// Records the dice of a run, and shows them beside others.
struct Camera<'a> {
    scene: &'a Dice,
    draw: &'a Draw,
    members: &'a [usize],
    others: &'a [Arc<Recorded>],
    reel: Reel,
}

impl Observer<RigidWorld> for Camera<'_> {
    fn impact(&mut self, impact: &Impact) {
        self.reel.impact(impact);
    }

    fn motion(&mut self, index: usize, body: &RigidBodyState) {
        self.reel.motion(index, body.recorded());
    }

    fn proceed(&mut self, state: &State<RigidBodyState>) -> bool {
        let begun = |trace: &Trace<RigidBodyState>| {
            let others = self.others.iter().map(|other| other.seen());
            let all: Vec<Seen<'_>> = others.chain([(self.members, trace)]).collect();
            film(self.scene, self.draw, &all, state.time()).ok()
        };
        !self.reel.is_full() && self.reel.goes_on(state.time(), LogPotential::ONE, begun)
    }
}

impl Plan {
    /// The dice above a level table of mean friction and restitution.
    pub(super) fn plain_world(&self, dice: usize) -> Result<PlainWorld, ModelError> {
        let table = Plane::new(DVec3::ZERO, DVec3::Z, MATERIAL).map(StaticShape::Plane);
        let world = Physical::Rigid(Box::new(self.world(dice, table)?));
        // Farther apart than they are long, however they are turned.
        let apart = 2.5 * self.cuboid.half().length();
        Ok(PlainWorld { world, places: (0..dice).map(|die| DVec3::new(apart * die as f64, 0.0, HAND)).collect() })
    }

    /// A world of one die, for its motion between impacts.
    pub(super) fn free_world(&self) -> Result<RigidWorld, ModelError> {
        self.world(1, self.surface.plain())
    }

    /// A world of dice on a table.
    fn world(&self, dice: usize, table: Result<StaticShape, WorldError>) -> Result<RigidWorld, ModelError> {
        let body = BodySpec::solid(Shape::Cuboid(self.cuboid), self.density, MATERIAL);
        let world = move || {
            RigidWorld::new(RigidWorldDesc {
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

/// The trip of a die of the current state, if that of another draw has the same bits.
fn known<'a>(plan: &Plan, state: StateRefOf<'a, Dice>, draw: &Draw, die: usize) -> Option<&'a Trip> {
    let (trip, table) = (&state.outcome.trips[die], draw.table_of(die));
    let (old, new) = (&state.draw.tables[table], &draw.tables[table]);
    if !state.draw.throws[die].moves_like(&draw.throws[die]) || !old.has_points_of(new) {
        return None;
    }
    // A shift moves everything, except for the spill, points to be passed, and the edges of the table.
    let moved = || {
        let offset = draw.offset(die, plan.surface.spacing());
        let anywhere = plan.carries() && !plan.surface.is_patched() && plan.asked[die].points.is_empty();
        anywhere && trip.end == End::AtRest && trip.stays_on(&plan.looking.edge, offset)
    };
    (old.shifted == new.shifted || moved()).then_some(trip)
}

/// Whether the outcomes of the remaining trips cannot lift the constraints above `floor`. Unknown terms are at most 0,
/// and sums round monotonically.
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
