//! Worlds of spheres among static scenery: no orientation, no shape, exact times of first contact.

mod analytic;
mod anderson;
mod body;
mod contact_forces;
mod energy_projection;
mod island;
mod mechanics;
mod position_projection;
mod single;
mod solve;
mod step;

pub use body::{Marble, MarbleSpec, Phase, Start};
pub use island::MarbleScratch;
use solve::Ball;

use crate::accuracy::Accuracy;
use crate::error::{SurfaceId, WorldError, first_not_finite};
use crate::material::Laws;
use crate::mechanics::EARTH;
use crate::outcome::Outcome;
use crate::queue::Place;
use crate::scenery::Scenery;
use crate::simulate::{Scratch, simulate};
use crate::state::State;
use crate::trace::Observer;
use glam::DVec3;

/// An immutable world of marbles.
#[derive(Debug, Clone)]
pub struct Marbles {
    pub(crate) specs: Vec<MarbleSpec>,
    pub(crate) laws: Laws,
    pub(crate) scenery: Scenery,
    pub(crate) gravity: DVec3,
    pub(crate) strength: f64,
    /// Each marble's response to an impulse.
    balls: Vec<Ball>,
    /// For each marble, the speed in m/s after a fall over one radius, up to a factor of √2.
    scales: Vec<f64>,
    /// For each marble, the time in s between impacts within which it rattles.
    rattles: Vec<f64>,
    /// Gap over the radius at which a lasting contact ends: the height of a bounce that settles.
    pub(crate) unseen: f64,
    pub(crate) accuracy: Accuracy,
    pub(crate) duration: f64,
}

/// The parts of a world.
#[derive(Debug, Clone)]
pub struct MarbleWorld {
    /// The marbles.
    pub specs: Vec<MarbleSpec>,
    /// The laws where materials touch.
    pub laws: Laws,
    /// The scenery.
    pub scenery: Scenery,
    /// Gravity in m/s².
    pub gravity: DVec3,
    /// All tolerances.
    pub accuracy: Accuracy,
    /// The latest end of a run, in s.
    pub duration: f64,
}

/// No marbles, in nothing: gravity 9.81 m/s² down z, the default laws and accuracy, 60 s.
impl Default for MarbleWorld {
    fn default() -> Self {
        Self {
            specs: Vec::new(),
            laws: Laws::default(),
            scenery: Scenery::default(),
            gravity: EARTH,
            accuracy: Accuracy::default(),
            duration: 60.0,
        }
    }
}

impl Marbles {
    /// Checks a world.
    ///
    /// # Errors
    /// [`WorldError`] naming the body, surface or number at fault.
    pub fn new(world: MarbleWorld) -> Result<Self, WorldError> {
        let MarbleWorld { specs, laws, scenery, gravity, accuracy, duration } = world;
        accuracy.check()?;
        if let Some(value) = first_not_finite(&[gravity]) {
            return Err(WorldError::BadNumber { field: "gravity", value, expected: "finite components" });
        }
        if !(duration > 0.0 && duration.is_finite()) {
            return Err(WorldError::BadNumber {
                field: "duration",
                value: duration,
                expected: "a positive, finite time",
            });
        }
        if let Some(value) = laws.static_friction() {
            let expected = "at most the friction of sliding: marbles have one coefficient";
            return Err(WorldError::BadNumber { field: "static_friction", value, expected });
        }
        for (k, spec) in specs.iter().enumerate() {
            spec.check(k)?;
            laws.require(spec.material)?;
            if spec.radius > scenery.reach() {
                return Err(WorldError::BadBody {
                    body: k,
                    field: "radius",
                    value: spec.radius,
                    expected: "at most the scenery's reach",
                });
            }
            if let Some(d) = scenery.domes().iter().find(|d| d.hollow && d.radius <= spec.radius) {
                return Err(WorldError::BadBody {
                    body: k,
                    field: "radius",
                    value: spec.radius,
                    expected: if d.radius > 0.0 { "less than the radius of every bowl" } else { "positive" },
                });
            }
        }
        for plane in scenery.planes() {
            laws.require(plane.material)?;
        }
        for dome in scenery.domes() {
            laws.require(dome.material)?;
        }
        for face in &scenery.mesh().faces {
            laws.require(face.material)?;
        }
        let strength = gravity.length();
        // Without gravity there is no time scale, and nothing that presses.
        let rattle = |radius: f64| if strength > 0.0 { accuracy.rattle * (radius / strength).sqrt() } else { 0.0 };
        Ok(Self {
            balls: specs.iter().map(Ball::new).collect(),
            rattles: specs.iter().map(|spec| rattle(spec.radius)).collect(),
            scales: specs.iter().map(|spec| (strength * spec.radius).sqrt()).collect(),
            specs,
            laws,
            scenery,
            gravity,
            strength,
            unseen: (0.5 * accuracy.settle * accuracy.settle).max(ROUNDING),
            accuracy,
            duration,
        })
    }

    /// The marbles' specifications.
    #[must_use]
    pub fn specs(&self) -> &[MarbleSpec] {
        &self.specs
    }

    /// The scenery.
    #[must_use]
    pub fn scenery(&self) -> &Scenery {
        &self.scenery
    }

    /// Gravity in m/s².
    #[must_use]
    pub fn gravity(&self) -> DVec3 {
        self.gravity
    }

    /// All tolerances.
    #[must_use]
    pub fn accuracy(&self) -> Accuracy {
        self.accuracy
    }

    /// Moves mesh vertices (see [`crate::scenery::Mesh::move_vertices`]); states of this world stay valid only if they
    /// have not started.
    ///
    /// # Errors
    /// As [`crate::scenery::Mesh::move_vertices`].
    pub fn move_vertices(&mut self, moved: &[(u32, DVec3)]) -> Result<(), WorldError> {
        self.scenery.move_vertices(moved)
    }

    /// A state in which every marble waits for its release.
    ///
    /// # Errors
    /// [`WorldError`] naming the marble whose start is not finite, or that overlaps another one released at the same
    /// time or the scenery.
    pub fn state(&self, starts: &[Start]) -> Result<State<Marble>, WorldError> {
        if starts.len() != self.specs.len() {
            return Err(WorldError::WrongState { state: starts.len(), world: self.specs.len() });
        }
        for (k, start) in starts.iter().enumerate() {
            self.check_start(k, start)?;
            for (j, other) in starts[..k].iter().enumerate() {
                let reach = self.specs[j].radius + self.specs[k].radius;
                let depth = reach - (start.position - other.position).length();
                if start.time == other.time && depth > OVERLAP * reach {
                    return Err(WorldError::BodiesOverlap { a: j, b: k, depth });
                }
            }
        }
        Ok(State::with_places(starts.iter().map(Marble::waiting).collect(), starts.iter().map(place).collect()))
    }

    fn check_start(&self, k: usize, start: &Start) -> Result<(), WorldError> {
        start.check(k)?;
        let radius = self.specs[k].radius;
        match self.scenery.deepest_overlap(start.position, radius) {
            Some((surface, depth)) if depth > OVERLAP * radius => {
                Err(WorldError::OverlapsScenery { body: k, surface: SurfaceId::Of(surface), depth })
            }
            _ => Ok(()),
        }
    }

    /// Gives another start to a marble that is still waiting. Everything else keeps its bits, so a saved beginning can
    /// be continued in many ways.
    ///
    /// # Errors
    /// [`WorldError`] if the start is bad, or if the marble has been released or the new release lies in the
    /// state's past.
    pub fn restart(&self, state: &mut State<Marble>, index: usize, start: &Start) -> Result<(), WorldError> {
        self.check_start(index, start)?;
        let released = state.bodies()[index].phase != Phase::Waiting;
        if released || start.time < state.time() {
            return Err(WorldError::BadBody {
                body: index,
                field: "start time",
                value: start.time,
                expected: "a release still to come",
            });
        }
        state.replace_unreleased(index, Marble::waiting(start), place(start), start.time.min(self.duration));
        Ok(())
    }

    /// Runs a state until `until` seconds, the end of the world's duration, rest, or the observer's stop.
    ///
    /// # Errors
    /// None: a result, so that worlds of all kinds are run in the same way (see [`crate::rigid::RigidWorld::run`]).
    pub fn run(
        &self,
        state: &mut State<Marble>,
        scratch: &mut Scratch<MarbleScratch>,
        until: f64,
        observer: &mut dyn Observer<Self>,
    ) -> Result<Outcome, WorldError> {
        Ok(simulate(self, state, scratch, until, observer))
    }

    /// Place, velocity and spin of a marble at any time within its current motion, as
    /// [`Rigid::at`](crate::rigid::RigidWorld::at) tells of turning bodies. Before its clock it is where it begins.
    #[must_use]
    pub fn at(&self, _index: usize, body: &Marble, time: f64) -> Marble {
        let mut moved = *body;
        moved.advance(time.max(body.path.t));
        moved
    }

    /// Kinetic plus potential energy of one marble at its own clock, in J.
    #[must_use]
    pub fn energy(&self, index: usize, body: &Marble) -> f64 {
        let s = &self.specs[index];
        let turning = s.gyration * s.radius * s.radius * body.spin.length_squared();
        s.mass * (0.5 * (body.path.v.length_squared() + turning) - self.gravity.dot(body.path.x))
    }

    /// Speed in m/s after a fall over one radius, up to a factor of √2: the scale of all speeds of a marble.
    #[inline]
    pub(crate) fn speed_scale(&self, index: usize) -> f64 {
        self.scales[index]
    }
}

/// Ties are ordered by how marbles start: no two can start at the same time and place.
fn place(start: &Start) -> Place {
    Place([start.time, start.position.x, start.position.y, start.position.z])
}

/// Gap over the radius, and height of a bounce, that is never seen. Default 1e-9.
const ROUNDING: f64 = 1e-9;

/// Overlap at the start that counts as touching, over the radius. Default 1e-9; danger: larger values start bodies
/// inside each other.
const OVERLAP: f64 = 1e-9;
