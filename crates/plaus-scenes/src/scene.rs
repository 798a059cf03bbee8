//! What a scene is: a target with a goal, moves, and animations.

use crate::accuracy::AccuracyPreset;
use crate::animation::{Animation, Motion, Physics, Prop};
use crate::model::{Features, Role, Scalar};
use crate::require::{Aim, Cast, Ended, FAR, Mark, Missed, Require, Stop};
use crate::rules::Rules;
use crate::world::PlainWorld;
use plaus_dist::LogPotential;
use plaus_mcmc::{Goal, Mixture, ModelError, Simulated, StateRefOf, Variables};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// A world whose animations are sampled.
///
/// Adding a scene takes its own folder, one line in [`crate::registry`] and a scenario file.
pub trait Scene:
    Goal<Draw: Serialize + DeserializeOwned, Outcome: Serialize + DeserializeOwned + PartialEq>
    + Variables
    + Sized
    + Send
    + 'static
{
    /// The moves that this scene is sampled with, under `rules`.
    ///
    /// # Errors
    /// [`ConfigError`] if the configured weights make no mixture.
    fn moves(&self, rules: &Rules) -> Result<Mixture<Self>, ConfigError>;

    /// The scalars of every state, in the order of [`Scene::write_scalars`]; the same for all states of one
    /// configuration.
    fn scalars(&self) -> Vec<Scalar>;

    /// Writes the values of [`Scene::scalars`] for `state`; `values` has as many places.
    fn write_scalars(&self, state: StateRefOf<'_, Self>, values: &mut [f64]);

    /// Whether a state is a solution, and if so, its features: what makes it different from others. [`Goal::class`] is
    /// made of these.
    fn features(&self, state: StateRefOf<'_, Self>, features: &mut Features) -> bool;

    /// The animation of a draw, rebuilt by simulation.
    ///
    /// # Errors
    /// [`ModelError`] if the simulation fails.
    fn animate(&self, draw: &Self::Draw) -> Result<Animation, ModelError>;

    /// The same, ending as asked. A scene whose simulations may end before everything is at rest overrides this for
    /// [`Until::Rest`]; one that knows when a draw is decided overrides it for [`Until::Decided`].
    ///
    /// # Errors
    /// [`ModelError`] if the simulation fails.
    fn animate_until(&self, draw: &Self::Draw, until: Until) -> Result<Animation, ModelError> {
        match until {
            Until::Rest | Until::Decided => self.animate(draw),
            Until::Time(end) => Ok(self.animate_until(draw, Until::Rest)?.until(end)),
        }
    }

    /// The world at the start of the motion of a draw, for other simulators. `None` if the scene does not tell it. A
    /// scene that does overrides this.
    ///
    /// # Errors
    /// [`ModelError`] if the draw makes no world.
    fn physics(&self, _draw: &Self::Draw) -> Result<Option<Physics>, ModelError> {
        Ok(None)
    }

    /// The motion of [`Scene::animate`], for callers that do not need the scenery. A scene whose scenery is expensive
    /// to build overrides this.
    ///
    /// # Errors
    /// As [`Scene::animate`].
    fn motion(&self, draw: &Self::Draw) -> Result<Motion, ModelError> {
        Ok(self.animate(draw)?.motion)
    }

    /// The scenery of a draw whose [`Scene::motion`] this is. A scene whose scenery can be built without a simulation
    /// overrides this.
    ///
    /// # Errors
    /// As [`Scene::animate`].
    fn scenery(&self, draw: &Self::Draw, _motion: &Motion) -> Result<Vec<Prop>, ModelError> {
        Ok(self.animate(draw)?.scenery)
    }

    /// [`Target::simulate`](plaus_mcmc::Target::simulate) that shows `stop` its motion as it goes on, and ends when that
    /// says so too. A scene with a simulator overrides this.
    ///
    /// # Errors
    /// [`ModelError`] if the simulation fails.
    fn simulate_watched(
        &self,
        draw: &Self::Draw,
        current: Option<StateRefOf<'_, Self>>,
        (floor, _stop): (LogPotential, Option<Stop>),
        scratch: &mut Self::Scratch,
    ) -> Result<Simulated<Self::Outcome>, ModelError> {
        self.simulate(draw, current, floor, scratch)
    }

    /// From now on, this memory keeps the motions of what it simulates, for [`Scene::motion_simulated`], with lasting
    /// contacts if `contacts` asks for them; without, motions may leave them out. A scene with a simulator overrides
    /// this.
    fn keep_motions(&self, _scratch: &mut Self::Scratch, _contacts: bool) {}

    /// [`Scene::motion`] of the draw that was last simulated with this memory. A scene that keeps its simulation need
    /// not run it again, and overrides this.
    ///
    /// # Errors
    /// As [`Scene::animate`].
    fn motion_simulated(&self, draw: &Self::Draw, _scratch: &Self::Scratch) -> Result<Motion, ModelError> {
        self.motion(draw)
    }

    /// The same world simulated at another accuracy: draws mean the same, but their outcomes may differ. `None` if
    /// motion has a closed form, which is exact, so that there is nothing to choose. A scene with a simulator overrides
    /// this.
    ///
    /// # Errors
    /// [`ConfigError`] if the configuration is invalid at that accuracy.
    fn at_accuracy(&self, _accuracy: AccuracyPreset) -> Result<Option<Self>, ConfigError> {
        Ok(None)
    }

    /// The cast: bodies by their names in animations, scenery, and the latest end. Requirements refer to these.
    fn cast(&self) -> Cast {
        Cast::default()
    }

    /// The scene's own constraints, as far as requirements can express them, each with its key. Contradictions to them
    /// are refused.
    fn demands(&self) -> Vec<(String, Require)> {
        Vec::new()
    }

    /// Whether each variable bears upon what becomes of some bodies in a state, for moves that favour such variables;
    /// `bodies` has a flag for each body of the cast. Empty if the scene cannot tell.
    fn bearing(&self, _state: StateRefOf<'_, Self>, _bodies: &[bool]) -> Vec<bool> {
        Vec::new()
    }

    /// Learns what is asked of bodies' ends, so that its moves can lead them there. `aims` name each body by its name
    /// in the cast.
    fn aim(&mut self, _aims: &[Aim]) {}

    /// Learns formulas over its quantities, each with its key, whose values its motions are to carry
    /// ([`Motion::numbers`]). Gives them of values in the middle of their laws. A scene with quantities overrides
    /// this.
    ///
    /// # Errors
    /// [`ConfigError`] if a formula is none, or names what is no quantity.
    fn follow(&mut self, formulas: &[(String, String)]) -> Result<Vec<f64>, ConfigError> {
        let none = "write a number: only a world of your own has quantities";
        formulas.iter().map(|(key, _)| Err(ConfigError::new(key, none))).collect()
    }

    /// What a user should know of the world that the scenario does not say, such as how far a hull departs from its
    /// file. One sentence each, without a full stop.
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }

    /// How the simulation of a state ended, which is the last of this memory. `None` if the scene does not tell: its
    /// simulations end as soon as they are decided.
    fn ended(&self, _state: StateRefOf<'_, Self>, _scratch: &Self::Scratch) -> Option<Ended> {
        None
    }

    /// What is asked of a state, each thing in a few words, in the order of [`Scene::answers`].
    fn asked(&self) -> Vec<String>;

    /// By how much one of these things is missed at a margin below 0, in a unit that the scenario uses. `None` if its
    /// margin has no such unit.
    fn missed(&self, _thing: usize, margin: f64) -> Option<Missed> {
        (margin <= -FAR).then_some(Missed::Never)
    }

    /// What a state that misses one of these things lacks: "pins 7 and 10 stand". Empty if there is no more to say
    /// than [`Scene::missed`] does.
    fn lacks(&self, _thing: usize, _state: StateRefOf<'_, Self>) -> String {
        String::new()
    }

    /// How well a state meets each thing that is asked. What a margin of the scene's own constraints measures is told
    /// by [`Scene::missed`].
    fn answers(&self, state: StateRefOf<'_, Self>) -> Vec<Mark>;

    /// The world for the simulator alone, without randomness: for example a level table with mean friction and
    /// restitution. `None` if motion has a closed form, so that there is no simulator. A scene with one overrides this.
    ///
    /// # Errors
    /// [`ModelError`] if the configuration makes no such world.
    fn world(&self) -> Result<Option<PlainWorld>, ModelError> {
        Ok(None)
    }
}

/// Where an animation ends.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Until {
    /// When everything is at rest, or after half a minute.
    #[default]
    Rest,
    /// As soon as it is certain whether the draw satisfies the constraint.
    Decided,
    /// After this many seconds, more than 0, whatever is moving; bodies that came to rest before stay as they are.
    Time(f64),
}

/// A configuration that is invalid, although every single key is in range.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{key}: {message}")]
pub struct ConfigError {
    /// The key at fault, from the root of the scenario, e.g. `world.ball2d.weights`.
    pub key: String,
    /// What is wrong and what would be right.
    pub message: String,
}

impl ConfigError {
    /// Blames `key`.
    pub fn new(key: impl Into<String>, message: impl ToString) -> Self {
        Self { key: key.into(), message: message.to_string() }
    }
}

/// The scalars of a state, by which moves are weighted.
pub(crate) fn numbers<S: Scene>(scene: &S, state: StateRefOf<'_, S>) -> Vec<f64> {
    let scalars = scene.scalars();
    let mut values = vec![0.0; scalars.len()];
    scene.write_scalars(state, &mut values);
    values.into_iter().zip(scalars).filter(|(_, scalar)| scalar.role != Role::Detail).map(|(value, _)| value).collect()
}
