//! Worlds that users describe: bodies, scenery and materials, any number of which may be uncertain. Only requirements
//! say what must happen.

mod acting;
mod amount;
mod angles;
mod animate;
mod apart;
mod axes;
mod bearing;
mod bump;
mod bumpy;
mod config;
mod contact_laws;
mod corners;
mod domain;
mod driven;
mod ending;
mod ends;
mod engine;
mod equal;
mod finish;
mod flight;
mod formula;
mod from_file;
mod given;
mod handles;
mod impacts;
mod inertia;
mod joints;
mod late;
mod laws;
mod linear;
mod marbles;
mod mechanics;
mod menu;
mod moves;
mod moving;
mod names;
mod physics;
mod plan;
mod quantities;
mod quantity;
mod range;
mod recast;
mod regions;
mod restless;
mod rods;
mod rope;
mod ropes;
mod scatter;
mod scattering;
mod shapes;
mod standing;
mod start_from;
mod starts;
mod strings;
mod substances;
mod surface;
mod there;
mod throws;
mod tokens;
mod toward;
mod values;
mod variables;
mod view;
mod waiting;
mod within;

pub use crate::failed::Cause;
pub use crate::uneven::Bumps;
pub use amount::{Amount, Measure};
pub use axes::{Hinge, HingeKey, HingeMotor, HingeSpring, Slider, SliderKey, SliderMotor, SliderSpring};
pub use bumpy::SurfaceBumps;
pub use config::{Body, Config, Fixed, Material, Pair};
pub use domain::Domain;
pub use driven::{At, Driven, Going};
pub use ending::{Done, Ending, Failed, Last, Overlap};
pub use finish::Finish;
pub use flight::Work;
pub use from_file::{FromFile, Up};
pub use inertia::Inertia;
pub use joints::{Bare, Joint, JointKind};
pub use late::Appears;
pub use laws::{Factor, Heading, LawOf, Several, Truncated};
pub use mechanics::Mechanics;
pub use menu::CustomMoves;
pub use quantity::Quantity;
pub use regions::Region;
pub use rope::Rope;
pub use scattering::Scattering;
pub use shapes::{
    ArcOf, Ball, Capsule, Compound, Cone, Convex, Cuboid, Cup, Cylinder, Die, Ellipsoid, Heights, Hull, HullOf, Mesh,
    Patchy, Piece, Plane, Revolution, Shape, Still, Table,
};
pub use start_from::{BodyState, StartFrom};
pub use strings::{StringJoint, Wound};
pub use values::Drawn;
pub use view::Viewpoint;
pub use within::{Within, WithinBall, WithinBox, WithinCylinder, WithinSurface};

pub(crate) use apart::apart;
pub(crate) use corners::{corners, faces, hull_volume, standing_out};
pub(crate) use physics::{Placed, placed, tensor};
pub(crate) use shapes::ellipsoid;

use crate::accuracy::AccuracyPreset;
use crate::animation::{Animation, Motion, Physics, Prop};
use crate::model::{Features, Moves, Scalar, columns, distinct};
use crate::require::{Aim, Cast, Ended, Mark, Missed, Stop};
use crate::rules::Rules;
use crate::scene::{ConfigError, Scene, Until};
use crate::world::{Physical, PlainWorld};
use bump::Bump;
use flight::fly;
use handles::Handles;
use moving::Moving;
use plan::{Plan, World};
use plaus_dist::{LogDensity, LogPotential, Stream};
use plaus_mcmc::{
    Failure, Goal, Mixture, ModelError, Recipe, Simulated, SolutionClass, StateRefOf, Target, Variables, Vars, vars,
};
use ropes::Spelled;
use std::collections::BTreeMap;
use std::sync::OnceLock;
use there::There;
use throws::Throw;
use values::{Slot, Value};

/// A world that a user describes: `p ∝ Π p(variable)`, 0 where things begin inside each other.
#[derive(Debug)]
pub struct Custom {
    config: Config,
    plan: Plan,
    vars: Vars,
    slots: Vec<Slot>,
    /// A draw with places for all values.
    empty: Drawn,
    /// Of each body, by which numbers its release can be changed.
    handles: Vec<Handles>,
    /// What is asked of bodies' ends.
    aims: Vec<Aim>,
    /// What quantities are called that requirements may name, and the formulas in requirements, each with its key.
    quantities: BTreeMap<String, Value>,
    formulas: Vec<(String, String)>,
    led: OnceLock<Led>,
}

/// What moves can lead, found when moves are first asked for: most commands need none, and it takes simulations.
#[derive(Debug)]
struct Led {
    /// The bodies that can be led to where they should end.
    throws: Vec<Throw>,
    /// Bodies that begin by the same laws.
    alike: Vec<Vec<usize>>,
}

impl Custom {
    /// The scene of a configuration.
    ///
    /// # Errors
    /// [`ConfigError`] where names are given twice or not at all, a law leaves what its number may be, a shape is none,
    /// or things begin inside each other in every draw that was tried.
    pub fn new(config: &Config) -> Result<Self, ConfigError> {
        if config.ropes.is_empty() {
            return Self::spelled(config, config);
        }
        let spelled = Spelled::new(config)?;
        Self::spelled(config, &spelled.config).map_err(|error| spelled.blamed(error))
    }

    /// The same, where `spelled` has bodies and joints for ropes.
    fn spelled(config: &Config, spelled: &Config) -> Result<Self, ConfigError> {
        config.view.check()?;
        Region::check(&config.regions)?;
        let (plan, collector) = Plan::new(spelled)?;
        plan.build(&plan.works.numbers(None)).map_err(|error| ConfigError::new("world.custom", error))?;
        let (empty, handles) = (collector.empty(), plan.handles(&collector));
        let vars =
            Vars::new(collector.vars).in_groups(collector.groups.into_iter().filter(|g| !g.is_empty()).collect());
        let (config, slots, quantities, led) = (config.clone(), collector.slots, collector.quantities, OnceLock::new());
        let (aims, formulas) = Default::default();
        let scene = Self { config, plan, vars, slots, empty, handles, aims, quantities, formulas, led };
        scene.check_starts()?;
        Ok(scene)
    }

    /// The configuration.
    #[must_use]
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// Whether bodies have an orientation.
    fn turns(&self) -> bool {
        self.config.mechanics == Mechanics::Turning
    }

    fn led(&self) -> &Led {
        self.led.get_or_init(|| Led { throws: self.throws_for(&self.aims), alike: self.alike_for(&self.aims) })
    }

    fn throws(&self) -> &[Throw] {
        &self.led().throws
    }

    fn alike(&self) -> &[Vec<usize>] {
        &self.led().alike
    }

    /// What a body, or a piece of scenery counted on, is called.
    fn name(&self, index: u32) -> &str {
        self.plan.name(index as usize)
    }
}

impl Target for Custom {
    type Draw = Drawn;
    type Outcome = Ending;
    type Scratch = Work;

    fn start(&self, stream: &mut Stream) -> Drawn {
        let mut draw = self.empty.clone();
        self.renew_all(&mut draw, Recipe::Exact, stream);
        draw
    }

    fn log_prior(&self, draw: &Drawn) -> Result<LogDensity, ModelError> {
        Ok(vars::log_prior(self, draw)?)
    }

    fn simulate(
        &self,
        draw: &Drawn,
        current: Option<StateRefOf<'_, Self>>,
        floor: LogPotential,
        work: &mut Work,
    ) -> Result<Simulated<Ending>, ModelError> {
        self.simulate_watched(draw, current, (floor, None), work)
    }

    fn log_constraint(&self, ending: &Ending) -> Result<LogPotential, ModelError> {
        Ok(if matches!(ending, Ending::Done(_)) { LogPotential::ONE } else { LogPotential::ZERO })
    }

    fn failure(&self, ending: &Ending) -> Option<Failure> {
        match ending {
            Ending::Failed(failed) => Some(failed.named(|index| self.name(index))),
            Ending::Done(_) | Ending::Overlap(_) | Ending::Folded(_) => None,
        }
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

impl Goal for Custom {
    fn class(&self, state: StateRefOf<'_, Self>) -> Option<SolutionClass> {
        distinct::class(self, state, 1.0)
    }
}

impl Scene for Custom {
    fn moves(&self, _: &Rules) -> Result<Mixture<Self>, ConfigError> {
        let all = moves::all(self).into_iter().chain(Bump::of(self)).chain(impacts::all(self)).collect();
        self.config.weights.mix(Moves::Mixed, self, all)
    }

    /// Where each body ends, then the variables. A body that is not there ends nowhere.
    fn scalars(&self) -> Vec<Scalar> {
        columns::scalars(self.ends(), &self.vars)
    }

    fn write_scalars(&self, state: StateRefOf<'_, Self>, values: &mut [f64]) {
        let variables = self.write_ends(state, values);
        variables.iter_mut().zip(columns::values(self, state.draw)).for_each(|(place, value)| *place = value);
    }

    fn features(&self, state: StateRefOf<'_, Self>, features: &mut Features) -> bool {
        let Ending::Done(done) = &state.outcome else { return false };
        let there = self.plan.there(state.draw);
        let is_ball = |body: usize| self.plan.bodies[body].is_ball();
        done.features(features, self.config.distinct_mm / 1e3, is_ball, &there);
        if let Some(present) = self.plan.present(state.draw) {
            // No body has the number −1, which ends the list of those that met.
            features.number(-1);
            present.iter().for_each(|&index| features.number(index as i64));
        }
        true
    }

    fn animate(&self, draw: &Drawn) -> Result<Animation, ModelError> {
        self.animated(draw, f64::INFINITY)
    }

    fn animate_until(&self, draw: &Drawn, until: Until) -> Result<Animation, ModelError> {
        match until {
            Until::Rest | Until::Decided => self.animate(draw),
            Until::Time(end) => Ok(self.animated(draw, end)?.until(end)),
        }
    }

    fn physics(&self, draw: &Drawn) -> Result<Option<Physics>, ModelError> {
        self.plan.physics(draw).map(Some).map_err(ModelError::new)
    }

    fn motion(&self, draw: &Drawn) -> Result<Motion, ModelError> {
        self.motion_simulated(draw, &self.simulated(draw)?)
    }

    fn scenery(&self, draw: &Drawn, motion: &Motion) -> Result<Vec<Prop>, ModelError> {
        self.scenery_around(draw, motion)
    }

    fn simulate_watched(
        &self,
        draw: &Drawn,
        _: Option<StateRefOf<'_, Self>>,
        (_, stop): (LogPotential, Option<Stop>),
        work: &mut Work,
    ) -> Result<Simulated<Ending>, ModelError> {
        Ok(fly(&self.plan, draw, stop, work)?.map_or(Simulated::CannotExceedFloor, Simulated::Complete))
    }

    fn keep_motions(&self, work: &mut Work, contacts: bool) {
        work.kept.keep(contacts);
    }

    fn motion_simulated(&self, draw: &Drawn, work: &Work) -> Result<Motion, ModelError> {
        match work.known(draw) {
            Some((record, built)) => Ok(record.film(&self.plan, built)),
            None => self.motion(draw),
        }
    }

    fn at_accuracy(&self, accuracy: AccuracyPreset) -> Result<Option<Self>, ConfigError> {
        let mut scene = Self::new(&Config { accuracy, ..self.config.clone() })?;
        scene.follow(&self.formulas)?;
        scene.aim(&self.aims);
        Ok(Some(scene))
    }

    fn cast(&self) -> Cast {
        let bodies = self.plan.bodies.iter().map(|body| body.name.clone()).collect();
        let fixed = self.plan.parts.iter().map(|part| part.name.clone()).collect();
        let may_be_missing = |body: &&Moving| body.there != There::Always || body.late.is_some();
        let optional = self.plan.bodies.iter().filter(may_be_missing).map(|body| body.name.clone()).collect();
        let joints = self.plan.joints.iter().map(|joint| joint.name.clone()).collect();
        let turns = self.turns();
        let (longest, faces) = (self.config.duration_s, self.plan.bodies.iter().any(|body| body.pips));
        let marked = self.plan.bodies.iter().filter(|body| !body.marks.is_empty());
        let marks = marked.map(|body| (body.name.clone(), body.marks.clone())).collect();
        let view = self.config.view.fixed();
        let restless = self.rolling_on();
        Cast { bodies, optional, fixed, joints, longest, turns, faces, marks, view, restless, ..Cast::default() }
    }

    fn aim(&mut self, aims: &[Aim]) {
        (self.aims, self.led) = (aims.to_vec(), OnceLock::new());
    }

    fn follow(&mut self, formulas: &[(String, String)]) -> Result<Vec<f64>, ConfigError> {
        self.formulas = formulas.to_vec();
        self.plan.follow(formulas, &self.quantities)
    }

    /// Those of the bodies themselves, and of all that met them, or met what met them.
    fn bearing(&self, state: StateRefOf<'_, Self>, bodies: &[bool]) -> Vec<bool> {
        let met: &[[u32; 2]] = if let Ending::Done(done) = state.outcome { &done.met } else { &[] };
        self.plan.bearing.upon(bodies, met, self.vars.len())
    }

    fn notes(&self) -> Vec<String> {
        let is_certain = self.vars.is_empty().then(|| {
            "nothing is uncertain: every draw is the same animation; give a number a law, for example `{ normal = [1.0, \
             0.5] }`"
                .to_owned()
        });
        let is_there = |name: &str| self.plan.free().iter().any(|body| body.name == name);
        let from = self.config.start_from.note(is_there);
        self.plan
            .notes()
            .into_iter()
            .chain(from)
            .chain(self.overlaps())
            .chain(self.enclosed())
            .chain(self.out_of_scale())
            .chain(is_certain)
            .collect()
    }

    fn ended(&self, state: StateRefOf<'_, Self>, work: &Work) -> Option<Ended> {
        self.how_it_ended(state, work)
    }

    fn asked(&self) -> Vec<String> {
        let bumps = if self.plan.random().any(|part| !part.is_endless()) { ", no bumps fold a surface" } else { "" };
        let ends = format!("the simulation comes to its end{bumps}, and nothing is crushed");
        vec!["nothing begins inside another".into(), ends]
    }

    fn missed(&self, thing: usize, margin: f64) -> Option<Missed> {
        Some(if thing == 0 { Missed::By(-margin, "mm") } else { Missed::Never })
    }

    /// Of an overlap the margin is its depth in millimetres.
    fn answers(&self, state: StateRefOf<'_, Self>) -> Vec<Mark> {
        let [depth, rest] = match &state.outcome {
            Ending::Done(_) => [0.0, 0.0],
            Ending::Overlap(overlap) => [(-1e3 * overlap.depth).min(-f64::MIN_POSITIVE), 0.0],
            Ending::Failed(_) | Ending::Folded(_) => [0.0, -crate::require::FAR],
        };
        vec![Mark::of(depth), Mark::of(rest)]
    }

    /// Of values in the middle of their laws.
    fn world(&self) -> Result<Option<PlainWorld>, ModelError> {
        let numbers = self.plan.works.numbers(None);
        let built = self.plan.build(&numbers).map_err(ModelError::new)?;
        let places =
            self.plan.starts(&numbers, &built.there, &built.shapes).iter().map(|start| start.position).collect();
        let world = match built.world {
            World::Turning(rigid) => Physical::Rigid(rigid),
            World::Marbles(marbles) => Physical::Marbles(Box::new(marbles.world)),
        };
        Ok(Some(PlainWorld { world, places }))
    }
}
