//! Worlds of rigid bodies: balls, cuboids, bodies of revolution, convex polyhedra, cylinders, cones, capsules and
//! compounds of them among planes, boxes, tables with a spline surface, solids at any angle, triangle meshes and curved
//! tracks.
//!
//! A body in the air is on a parabola and rotates freely, both in closed form; a ball alone on a plane or on triangles
//! of a mesh, at any slope, slides and rolls in closed form where there is one, and turns over edges without loss. A
//! body touches a part when the first of its [contact spheres](crate::shape::ContactSphere) comes within half of
//! `accuracy.gap` of it. An impact at one point follows Stronge's law. Points that are struck at one instant, of one
//! body, one pair or several pairs that share bodies, are resolved at once (Moreau's law), so their order plays no
//! part. What touches without approach is struck next if an impact drives it together: so a cradle passes it on. A
//! contact lasts if its rebound would be slower than `accuracy.settle`, or no higher than `accuracy.gap`. The body,
//! with all bodies in lasting contact with it, then moves in steps whose impulses are found together, until it leaves
//! the ground or is at rest.
//!
//! At every preset, contacts without friction change no momentum along their plane, linear or angular. Friction stays
//! within Coulomb's bound, except for the velocity below `accuracy.rest_speed` that is removed at rest. Impacts make no
//! energy. Tests throw random bodies for each of these laws (`tests/laws_*.rs`), each with a wrong twin that they
//! catch.
//!
//! Some things are approximate. A body of revolution is a row of balls and rings (see [`crate::shape::Revolution`]).
//! Bumps of a table are felt at the contact spheres only ([`RigidWorldDesc::skin`]). Half way through a step of lasting
//! contact, corners may be inside what they touch; for two cuboids the overlap is about a thousandth of their size. An
//! event that interrupts the step leaves them there, and the next steps push them out. The
//! direction of a slip within an impact and the steps of lasting contact follow the preset, with an error that falls as
//! the square of the step. Within a step, energy may rise by that error: about 1e-3 of a body's weight times its size
//! at the standard preset, 1e-6 at reference. A ring is felt at its point nearest to a part, in lasting contact also at
//! three other points of the rim, and a flat foot also at the edges of a large box that cross it. Elsewhere a body of
//! revolution is felt at its balls, so between these the edge of a box may be a millimetre or two inside it.
//!
//! Islands of thirteen balls or more, with what lies among them, move in steps that take up all impacts of balls within
//! them (Moreau's law, felt at the end of a step), so there the error of an impact's time and the law of impacts at
//! several points at once depend on the preset's step. In islands of more than forty bodies, the rounds that find
//! impulses end before these are exact; the order of bodies then matters as far as that error.
//!
//! At draft and standard, groups of four or more bodies with flat faces take their impacts up in steps too. If all
//! their skins are flat or balls, and no more bodies stand on each other than the rounds carry loads through (5 at
//! draft, 14 at standard), points are looked for once a step, and bodies move in substeps in which rounds may end early
//! (`island/crowd_step.rs`): momenta are kept to rounding, friction stays within its bound, and what rounds leave makes
//! no energy, but may let bodies overlap for some substeps, by about a thousandth of their size.
//!
//! Every shape meets every other; `narrow_phase/dispatch.rs` says which algorithm serves a pair. A convex polyhedron
//! touches boxes with its faces and edges too, not only with its corners as a cuboid does. A polyhedron that is wedged
//! between boxes, so that each pushes it into the other, may find no rest. It sinks, by a fifth of its size at worst in
//! the tests, until its run has no events left.
//!
//! Convex pieces in lasting contact are examined eight times within a step for points that are not part of the contact.
//! Beside a triangle whose plane it is below, a body is examined each time it has moved a hundredth of its size. So a
//! new point may be as deep as the body moves between two looks before it is seen. Rigid bodies on meshes and in
//! corners are tested less than others: the example `shapes` throws every shape onto each kind of scenery, and counts.
//!
//! Rolling and spinning resistance act in lasting contact. On a ball that rolls on a level fixed part, or straight down
//! a slope, they act in closed form; otherwise in steps, with the distance of the point from the centre of gravity as
//! the radius. Between two bodies this is the distance in the ball, if one of them is a ball, or else the shorter one.
//! They hold what can only roll. What can tip, such as a pin on the rim of its foot, they only slow down.
//!
//! A body may be driven by keyframes ([`RigidWorld::drive`]). In contact its inverse mass is zero, no fixed part stops
//! it, and energy is not conserved in an island that it belongs to. What it presses on with no way out, because a joint
//! or scenery holds it, gives way by being overlapped, and soon ends the run ([`Crushed`](crate::Outcome::Crushed)).
//! Where a law has a static friction above that of sliding, it holds what does not slip at the start of a step or would
//! turn its slip round within it; slip up to `rest_residual` of what gravity makes in a step counts as none. Each body
//! may also have a constant force and torque, in the world's axes or in its own, damping, and more or less gravity
//! ([`RigidWorld::act_on`]), and may sleep until it is hit ([`RigidWorld::put_to_sleep`]). Between two runs, bodies may
//! be kicked, taken out and put in ([`RigidWorld::kick`], [`RigidWorld::remove`], [`RigidWorld::put`]).
//!
//! Joints hold bodies to each other or to the fixed world ([`RigidWorld::join`]): ball joints, welds, hinges and
//! sliders with limits, dry friction, springs and dampers ([`Spring`]) and motors ([`RigidWorld::power`]). Each may
//! break at an impulse. Strings ([`Joint::string`]) pull where they are taut, and may be wound on a drum of a body
//! ([`Joint::wound`]); bodies at their ends may touch each other. While nothing touches bodies on joints, and joints
//! neither rub, nor have motors, nor are at a limit, nor form a loop, nor are strings, they move in the coordinates of
//! their joints (`island/articulated_step.rs`), in steps of fifth order as long as the preset's error allows, and at
//! most a radian of a spring's oscillation, or the time in which a damper would take away all but 1/e of a speed. Then
//! joints hold to rounding between two steps; within one, bodies are on cubics, and joints are apart by a fraction of
//! the distance that the preset allows searches for a first contact, 6e-4 of a body's size at standard. Energy is
//! conserved to rounding, that of springs included, and so are the linear and angular momentum of bodies that hang on
//! nothing; where there is damping or what they hang on is driven, to the steps' error. Else bodies with joints move in
//! steps of lasting contact that are four times as short; those of a compound follow its radius of gyration, not its
//! thinnest piece. The error falls as the square of the step. Between two steps, the points of a joint are apart by
//! less than a thousandth of the gap at which bodies touch, however long a run is; half way through a step, by the
//! mid-step drift of the step's curve, at most a thousandth of the joint's arm at the standard preset. Linear and
//! angular momentum are conserved to rounding. Energy is conserved to the square of the step, up and down: it is not
//! guarded where there are joints, and it does not creep as long as steps are equal. A step that an event interrupts is
//! taken again up to the event, so that joints are together there too (`island/truncate_step.rs`). An impact is
//! resolved with all bodies that hang together, at all its points, by Newton's and Coulomb's laws; other contacts of
//! the same bodies are struck next. A body with joints cannot be put to sleep, nor put in anew.
//!
//! ```
//! use glam::DVec3;
//! use plaus_sim::worlds::DieOnTable;
//! use plaus_sim::{Outcome, Scratch, rigid::Start};
//!
//! let world = DieOnTable::default().world(|_, _| 0.0)?;
//! let start = Start { spin: DVec3::new(9.0, -4.0, 2.0), ..Start::at_rest(DVec3::new(0.0, 0.0, 0.1)) };
//! let mut state = world.state(&[start])?;
//! assert_eq!(world.run(&mut state, &mut Scratch::default(), 20.0, &mut ())?, Outcome::AllAtRest);
//! assert!((state.bodies()[0].path.x.z - 0.008).abs() < 1e-6);
//! # Ok::<(), plaus_sim::WorldError>(())
//! ```

mod body_definition;
mod body_state;
mod collision_filter;
mod forces;
mod impact;
mod island;
mod joints;
mod mechanics;
mod motion;
mod narrow_phase;
mod pose;
mod scattered;
mod scratch;
mod separation;
mod solver;
mod state_edits;
mod static_shape;
mod step_poses;
mod time_of_impact;
mod tolerances;

use body_definition::{BodyDef, RIM_POINTS, ShapeKind};
pub use body_state::{Phase, RigidBodyState};
use collision_filter::CollisionFilter;
pub use forces::Forces;
pub use joints::axis::{AxisJoint, Motor, MotorGoal, Spring};
use joints::joint::JointConstraints;
pub use joints::joint::{Frame, Joint, JointKind};
pub use joints::string::{Drum, StringJoint, Winding};
use motion::kinematic::KinematicPath;
pub use motion::kinematic::{Interpolation, Key, Keyframes, Track};
use narrow_phase::regions::Region;
use narrow_phase::static_collider::StaticCollider;
pub use pose::Start;
pub use scattered::{ImpactName, ImpactScores, Partner};
pub use scratch::RigidScratch;
pub use separation::Separation;
pub use static_shape::{Section, StaticShape, StaticSolid, Table};

use crate::accuracy::Accuracy;
use crate::broad::BoxTree;
use crate::error::{SurfaceId, WorldError};
use crate::material::{Laws, Material};
use crate::mechanics::{EARTH, Mechanics};
use crate::scenery::Aabb;
use crate::shape::{MassProperties, Shape};
use crate::simulate::{Scratch, simulate};
use crate::state::State;
use crate::trace::Observer;
use glam::DVec3;
use tolerances::START_OVERLAP;

/// One body of a world.
#[derive(Debug, Clone)]
pub struct BodySpec {
    /// Its shape about its centre of gravity; that of a driven body may be [about another point](Shape::about).
    pub shape: Shape,
    /// Its mass and inertia.
    pub mass: MassProperties,
    /// What it is made of.
    pub material: Material,
}

impl BodySpec {
    /// A body of uniform density in kg/m³.
    #[must_use]
    pub fn solid(shape: Shape, density: f64, material: Material) -> Self {
        let mass = shape.mass_properties(density);
        Self { shape, mass, material }
    }
}

/// Everything that does not change during a run.
#[derive(Debug, Clone)]
pub struct RigidWorldDesc {
    /// The bodies.
    pub bodies: Vec<BodySpec>,
    /// The fixed parts.
    pub parts: Vec<StaticShape>,
    /// Friction and restitution per pair of materials.
    pub laws: Laws,
    /// In m/s².
    pub gravity: DVec3,
    /// Tolerances.
    pub accuracy: Accuracy,
    /// Distance between points of a body's skin that are tested over a table, over the table's grid spacing. Default
    /// 0.5; usual 0.25–1. A bump between such points reaches into the body by up to about
    /// `curvature · (skin · spacing)²/8`; the cost grows as the inverse square of this distance.
    pub skin: f64,
    /// Height in m of a pit: a body is gone if, at one of its events, its centre of gravity is below it. `-∞` for none.
    pub sink: f64,
    /// When a run ends, in s.
    pub duration: f64,
}

/// Nothing: gravity 9.81 m/s² down z, the default laws and accuracy, no pit, 60 s.
impl Default for RigidWorldDesc {
    fn default() -> Self {
        Self {
            bodies: Vec::new(),
            parts: Vec::new(),
            laws: Laws::default(),
            gravity: EARTH,
            accuracy: Accuracy::default(),
            skin: 0.5,
            sink: f64::NEG_INFINITY,
            duration: 60.0,
        }
    }
}

/// A checked world, with quantities derived from it.
#[derive(Debug, Clone)]
pub struct RigidWorld {
    specs: Vec<BodyDef>,
    parts: Vec<StaticShape>,
    /// Parts as bodies meet them by their pieces.
    static_colliders: Vec<StaticCollider>,
    /// How many parts are those of the user. Behind them there is one for each region.
    own_parts: usize,
    regions: Vec<Region>,
    /// The boxes around parts that end somewhere, and the numbers of the others.
    scenery: BoxTree,
    endless: Vec<u32>,
    joints: JointConstraints,
    filter: CollisionFilter,
    scores: Option<ImpactScores>,
    laws: Laws,
    gravity: DVec3,
    gravity_magnitude: f64,
    accuracy: Accuracy,
    sink: f64,
    duration: f64,
}

impl RigidWorld {
    /// Checks a world.
    ///
    /// # Errors
    /// [`WorldError`] naming the body, law or part at fault.
    pub fn new(world: RigidWorldDesc) -> Result<Self, WorldError> {
        world.accuracy.check()?;
        if let Some(value) = not_finite(world.gravity.to_array()) {
            return Err(WorldError::BadNumber { field: "gravity", value, expected: "finite numbers" });
        }
        for (field, value) in [("duration", world.duration), ("skin", world.skin)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(WorldError::BadNumber { field, value, expected: "a positive number" });
            }
        }
        let mut spacing = f64::INFINITY;
        for (k, part) in world.parts.iter().enumerate() {
            part.check(k, &world.laws)?;
            if let StaticShape::Table(table) = part {
                spacing = spacing.min(world.skin * table.height.grid().spacing);
            }
        }
        let gravity_magnitude = world.gravity.length();
        let specs = world
            .bodies
            .iter()
            .enumerate()
            .map(|(k, b)| BodyDef::new(k, b, &world, spacing, gravity_magnitude))
            .collect::<Result<_, _>>()?;
        let (static_colliders, regions) = StaticCollider::all(&world)?;
        let boxes: Vec<Aabb> = static_colliders.iter().map(|collider| *collider.bounds()).collect();
        let is_endless = |part: &StaticShape| matches!(part, StaticShape::Plane(_) | StaticShape::Table(_));
        let endless = (0..).zip(&world.parts).filter(|(_, part)| is_endless(part)).map(|(k, _)| k).collect();
        let RigidWorldDesc { mut parts, laws, gravity, accuracy, sink, duration, .. } = world;
        if sink.is_nan() {
            return Err(WorldError::BadNumber { field: "sink", value: sink, expected: "a height, or -∞" });
        }
        let own_parts = parts.len();
        parts.extend(regions.iter().map(|region| StaticShape::Plane(*region.plane())));
        Ok(Self {
            specs,
            parts,
            static_colliders,
            own_parts,
            regions,
            scenery: BoxTree::new(&boxes),
            endless,
            joints: JointConstraints::default(),
            filter: CollisionFilter::default(),
            scores: None,
            laws,
            gravity,
            gravity_magnitude,
            accuracy,
            sink,
            duration,
        })
    }

    /// Lets keyframes drive a body from time 0 on, whatever it meets: others feel it with its velocity. Its start then
    /// has no effect, nor do its mass, gravity, and fixed parts.
    ///
    /// # Errors
    /// [`WorldError::BadKey`] naming the body and a key whose numbers are not finite, or whose time is not later than
    /// that of the key before; [`WorldError::BadNumber`] for a body that is not there.
    pub fn drive(&mut self, body: usize, keys: &Keyframes) -> Result<(), WorldError> {
        let Some(spec) = self.specs.get(body) else {
            return Err(WorldError::BadNumber {
                field: "index of a driven body",
                value: body as f64,
                expected: "one of the world's bodies",
            });
        };
        let drive = KinematicPath::new(body, spec, keys)?;
        self.specs[body].drive = Some(drive);
        Ok(())
    }

    /// A body before its release.
    fn waiting(&self, body: usize, start: &Start) -> RigidBodyState {
        let mut waiting = RigidBodyState::waiting(start);
        if let Some(drive) = &self.specs[body].drive {
            drive.follow(&mut waiting, 0.0);
            (waiting.phase, waiting.expiry) = (Phase::Waiting, 0.0);
        }
        waiting
    }

    /// A state in which every body waits for its release.
    ///
    /// # Errors
    /// [`WorldError`] naming a body whose start is not finite, or that overlaps a part or another body released at the
    /// same time.
    pub fn state(&self, starts: &[Start]) -> Result<State<RigidBodyState>, WorldError> {
        if starts.len() != self.specs.len() {
            return Err(WorldError::WrongState { state: starts.len(), world: self.specs.len() });
        }
        for (k, start) in starts.iter().enumerate().filter(|&(k, _)| !self.specs[k].is_driven()) {
            self.check_start(k, start)?;
        }
        let mut bodies: Vec<RigidBodyState> =
            starts.iter().enumerate().map(|(k, start)| self.waiting(k, start)).collect();
        for [j, k] in self.starting_together(&bodies, 0.0) {
            let depth = -self.gap([j, k], [&bodies[j], &bodies[k]]);
            if depth > START_OVERLAP * self.specs[j].size.min(self.specs[k].size) {
                return Err(WorldError::BodiesOverlap { a: j, b: k, depth });
            }
        }
        self.wind_up(&mut bodies);
        self.check_joints(&bodies)?;
        let mut state = State::new(bodies);
        for [a, b] in self.joints.pairs() {
            state.links.insert(a as u32, b as u32);
        }
        Ok(state)
    }

    fn check_start(&self, body: usize, start: &Start) -> Result<(), WorldError> {
        let bad = |field, value, expected| Err(WorldError::BadBody { body, field, value, expected });
        if self.specs[body].is_off_centre {
            let expected = "one about its centre of gravity, as nothing drives the body";
            return bad("reach of a shape about another point", self.specs[body].bounding_radius, expected);
        }
        let orientation = start.orientation.to_array();
        for (field, value) in [
            ("position", not_finite(start.position.to_array())),
            ("velocity", not_finite(start.velocity.to_array())),
            ("spin", not_finite(start.spin.to_array())),
            ("orientation", not_finite(orientation)),
        ] {
            if let Some(value) = value {
                return bad(field, value, "finite numbers");
            }
        }
        if start.orientation.length() == 0.0 {
            return bad("orientation", 0.0, "a quaternion that is not zero");
        }
        if !(start.time >= 0.0 && start.time.is_finite()) {
            return bad("start time", start.time, "a time of at least 0");
        }
        let waiting = RigidBodyState::waiting(start);
        let spec = &self.specs[body];
        if let Some((part, depth)) = self.deepest(body, &waiting)
            && depth > START_OVERLAP * spec.size
        {
            return Err(WorldError::OverlapsScenery { body, surface: SurfaceId::Part(usize::from(part)), depth });
        }
        Ok(())
    }

    /// Runs a state until `until` seconds, the end of the world's duration, rest, or the observer's stop.
    ///
    /// # Errors
    /// [`WorldError::BadControlPoint`] if a field of a table was given a value that is not finite or is out of its
    /// range; the run stops there.
    pub fn run(
        &self,
        state: &mut State<RigidBodyState>,
        scratch: &mut Scratch<RigidScratch>,
        until: f64,
        observer: &mut dyn Observer<Self>,
    ) -> Result<crate::Outcome, WorldError> {
        let outcome = simulate(self, state, scratch, until, observer);
        match self.parts.iter().find_map(StaticShape::fault) {
            Some(fault) => Err(fault),
            None => Ok(outcome),
        }
    }

    /// The fixed parts. A table's control points are asked for through them.
    #[must_use]
    pub fn parts(&self) -> &[StaticShape] {
        &self.parts[..self.own_parts]
    }

    /// The fixed parts, for moving control points. States that have started do not notice until their next event.
    pub fn parts_mut(&mut self) -> &mut [StaticShape] {
        &mut self.parts[..self.own_parts]
    }

    /// Kinetic plus potential energy of one body at its own clock, in J.
    #[must_use]
    pub fn energy(&self, index: usize, body: &RigidBodyState) -> f64 {
        let s = &self.specs[index];
        let m = body.motion_after(s, 0.0);
        0.5 * (s.mass * m.v.length_squared() + m.w.dot(s.inertia.momentum(body.turn, m.w)))
            - s.mass * s.gravity.dot(body.path.x)
    }

    /// How far apart the skins of two bodies are at their clocks, in m. Negative where they overlap; for balls, cuboids
    /// and polyhedra, it is then the shortest way out.
    #[must_use]
    pub fn gap(&self, pair: [usize; 2], bodies: [&RigidBodyState; 2]) -> f64 {
        let [a, b] = bodies.map(RigidBodyState::pose);
        let [i, j] = pair;
        let far = (a.x - b.x).length() - self.specs[i].bounding_radius - self.specs[j].bounding_radius;
        if far > 0.0 { far } else { self.pair_touch(pair, [&a, &b]).gap }
    }

    /// How deep a body is in the fixed parts at its clock, in m, according to its contact spheres; 0 if it is in none.
    #[must_use]
    pub fn depth(&self, index: usize, body: &RigidBodyState) -> f64 {
        self.deepest(index, body).map_or(0.0, |(_, depth)| depth)
    }

    /// How many bodies there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.len()
    }
}

/// The first of some numbers that is infinite or NaN.
fn not_finite(numbers: impl IntoIterator<Item = f64>) -> Option<f64> {
    numbers.into_iter().find(|x| !x.is_finite())
}
