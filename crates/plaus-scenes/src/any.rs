//! Any scene that a scenario may ask for, as one type: each method calls the same method of the scene inside.

use crate::accuracy::AccuracyPreset;
use crate::animation::Animation;
use crate::model::{Features, Scalar};
use crate::registry::{AnyDraw, AnyOutcome, AnyScene, AnyScratch, Known, with_scene};
use crate::require::{Cast, Mark, Missed, Require, Stop, Timed};
use crate::rules::Rules;
use crate::scene::{ConfigError, Scene, Until};
use crate::world::PlainWorld;
use plaus_dist::{LogDensity, LogPotential, Stream};
use plaus_mcmc::view::{Sees, lent};
use plaus_mcmc::{Goal, Mixture, ModelError, Recipe, Simulated, SolutionClass, StateRefOf, Target, Variables, Vars};

impl<S: Known> Sees<S> for AnyScene {
    fn seen(&self) -> &S {
        S::of(self)
    }

    fn state(state: StateRefOf<'_, Self>) -> StateRefOf<'_, S> {
        S::state(state)
    }

    fn draw_mut(draw: &mut AnyDraw) -> &mut S::Draw {
        S::draw_mut(draw)
    }
}

#[warn(clippy::missing_trait_methods)]
impl Target for AnyScene {
    type Draw = AnyDraw;
    type Outcome = AnyOutcome;
    type Scratch = AnyScratch;

    fn start(&self, stream: &mut Stream) -> AnyDraw {
        with_scene!(self, scene: S => S::any_draw(scene.start(stream)))
    }

    fn log_prior(&self, draw: &AnyDraw) -> Result<LogDensity, ModelError> {
        with_scene!(self, scene: S => scene.log_prior(S::draw(draw)))
    }

    fn simulate(
        &self,
        draw: &AnyDraw,
        current: Option<StateRefOf<'_, Self>>,
        floor: LogPotential,
        scratch: &mut AnyScratch,
    ) -> Result<Simulated<AnyOutcome>, ModelError> {
        with_scene!(self, scene: S => {
            let current = current.map(S::state);
            Ok(match scene.simulate(S::draw(draw), current, floor, S::scratch(scratch))? {
                Simulated::Complete(outcome) => Simulated::Complete(S::any_outcome(outcome)),
                Simulated::CannotExceedFloor => Simulated::CannotExceedFloor,
            })
        })
    }

    fn log_constraint(&self, outcome: &AnyOutcome) -> Result<LogPotential, ModelError> {
        with_scene!(self, scene: S => scene.log_constraint(S::outcome(outcome)))
    }

    fn most(&self) -> Option<LogPotential> {
        with_scene!(self, scene => scene.most())
    }

    fn decided(&self, accepted: bool, scratch: &mut AnyScratch) {
        with_scene!(self, scene: S => scene.decided(accepted, S::scratch(scratch)));
    }

    fn work(&self) -> u64 {
        with_scene!(self, scene => scene.work())
    }

    fn numbers(&self, state: StateRefOf<'_, Self>) -> Vec<f64> {
        with_scene!(self, scene: S => scene.numbers(S::state(state)))
    }
}

impl Goal for AnyScene {
    fn class(&self, state: StateRefOf<'_, Self>) -> Option<SolutionClass> {
        with_scene!(self, scene: S => scene.class(S::state(state)))
    }
}

#[warn(clippy::missing_trait_methods)]
impl Variables for AnyScene {
    fn vars(&self) -> &Vars {
        with_scene!(self, scene => scene.vars())
    }

    fn get<'a>(&self, draw: &'a AnyDraw, var: usize) -> Option<&'a [f64]> {
        with_scene!(self, scene: S => scene.get(S::draw(draw), var))
    }

    fn get_mut<'a>(&self, draw: &'a mut AnyDraw, var: usize) -> Option<&'a mut [f64]> {
        with_scene!(self, scene: S => scene.get_mut(S::draw_mut(draw), var))
    }

    fn set_present(&self, draw: &mut AnyDraw, var: usize, present: bool) {
        with_scene!(self, scene: S => scene.set_present(S::draw_mut(draw), var, present));
    }

    fn shift(&self, draw: &AnyDraw, var: usize) -> f64 {
        with_scene!(self, scene: S => scene.shift(S::draw(draw), var))
    }

    fn renew_own(&self, draw: &mut AnyDraw, var: usize, stream: &mut Stream) {
        with_scene!(self, scene: S => scene.renew_own(S::draw_mut(draw), var, stream));
    }

    fn step_own(&self, draw: &mut AnyDraw, var: usize, size: f64, stream: &mut Stream) {
        with_scene!(self, scene: S => scene.step_own(S::draw_mut(draw), var, size, stream));
    }

    fn renew_all(&self, draw: &mut AnyDraw, recipe: Recipe, stream: &mut Stream) {
        with_scene!(self, scene: S => scene.renew_all(S::draw_mut(draw), recipe, stream));
    }

    fn renew_group(&self, draw: &mut AnyDraw, group: usize, stream: &mut Stream) {
        with_scene!(self, scene: S => scene.renew_group(S::draw_mut(draw), group, stream));
    }
}

#[warn(clippy::missing_trait_methods)]
impl Scene for AnyScene {
    fn moves(&self, rules: &Rules) -> Result<Mixture<Self>, ConfigError> {
        with_scene!(self, scene => Ok(lent(&scene.moves(rules)?)))
    }

    fn scalars(&self) -> Vec<Scalar> {
        with_scene!(self, scene => scene.scalars())
    }

    fn features(&self, state: StateRefOf<'_, Self>, features: &mut Features) -> bool {
        with_scene!(self, scene: S => scene.features(S::state(state), features))
    }

    fn write_scalars(&self, state: StateRefOf<'_, Self>, values: &mut [f64]) {
        with_scene!(self, scene: S => scene.write_scalars(S::state(state), values));
    }

    fn animate(&self, draw: &AnyDraw) -> Result<Animation, ModelError> {
        with_scene!(self, scene: S => scene.animate(S::draw(draw)))
    }

    fn animate_until(&self, draw: &AnyDraw, until: Until) -> Result<Animation, ModelError> {
        with_scene!(self, scene: S => scene.animate_until(S::draw(draw), until))
    }

    fn motion(&self, draw: &AnyDraw) -> Result<Animation, ModelError> {
        with_scene!(self, scene: S => scene.motion(S::draw(draw)))
    }

    fn watch(&self, scratch: &mut AnyScratch, stop: Option<Stop>) {
        with_scene!(self, scene: S => scene.watch(S::scratch(scratch), stop));
    }

    fn motion_simulated(&self, draw: &AnyDraw, scratch: &AnyScratch) -> Result<Animation, ModelError> {
        with_scene!(self, scene: S => match S::scratch_kept(scratch) {
            Some(scratch) => scene.motion_simulated(S::draw(draw), scratch),
            None => scene.motion(S::draw(draw)),
        })
    }

    fn at_accuracy(&self, accuracy: AccuracyPreset) -> Result<Option<Self>, ConfigError> {
        with_scene!(self, scene => Ok(scene.at_accuracy(accuracy)?.map(Known::any)))
    }

    fn cast(&self) -> Cast {
        with_scene!(self, scene => scene.cast())
    }

    fn demands(&self) -> Vec<(String, Require)> {
        with_scene!(self, scene => scene.demands())
    }

    fn times(&self, motion: &Animation) -> Vec<(String, Timed)> {
        with_scene!(self, scene => scene.times(motion))
    }

    fn bearing(&self, state: StateRefOf<'_, Self>, bodies: &[bool]) -> Vec<bool> {
        with_scene!(self, scene: S => scene.bearing(S::state(state), bodies))
    }

    fn notes(&self) -> Vec<String> {
        with_scene!(self, scene => scene.notes())
    }

    fn asked(&self) -> Vec<String> {
        with_scene!(self, scene => scene.asked())
    }

    fn missed(&self, thing: usize, margin: f64) -> Option<Missed> {
        with_scene!(self, scene => scene.missed(thing, margin))
    }

    fn lacks(&self, thing: usize, state: StateRefOf<'_, Self>) -> String {
        with_scene!(self, scene: S => scene.lacks(thing, S::state(state)))
    }

    fn answers(&self, state: StateRefOf<'_, Self>) -> Vec<Mark> {
        with_scene!(self, scene: S => scene.answers(S::state(state)))
    }

    fn world(&self) -> Result<Option<PlainWorld>, ModelError> {
        with_scene!(self, scene: S => <S as Scene>::world(scene))
    }
}
