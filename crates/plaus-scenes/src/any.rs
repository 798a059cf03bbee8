//! Any scene that a scenario may ask for, as one type: each method calls the same method of the scene inside.

use crate::accuracy::AccuracyPreset;
use crate::animation::{Animation, Motion, Physics, Prop};
use crate::model::{Features, Scalar};
use crate::registry::{AnyDraw, AnyOutcome, AnyScene, AnyScratch, Known, with_scene};
use crate::require::{Aim, Cast, Ended, Mark, Missed, Require, Stop};
use crate::rules::Rules;
use crate::scene::{ConfigError, Scene, Until};
use crate::world::PlainWorld;
use plaus_dist::{LogDensity, LogPotential, Stream};
use plaus_mcmc::view::{Sees, lent};
use plaus_mcmc::{
    Failure, Goal, Look, Mixture, ModelError, Recipe, Simulated, SolutionClass, StateRefOf, Target, Variables, Vars,
};

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

/// Methods of the trait named first, each of which calls the same method of the scene inside. Arguments with these
/// names become the scene's own: `draw`, `changed` (a draw, to change), `outcome`, `state`, `scratch`.
macro_rules! each_of_the_scene {
    (@own $scene:ident draw $given:ident) => { $scene::draw($given) };
    (@own $scene:ident changed $given:ident) => { $scene::draw_mut($given) };
    (@own $scene:ident outcome $given:ident) => { $scene::outcome($given) };
    (@own $scene:ident state $given:ident) => { $scene::state($given) };
    (@own $scene:ident scratch $given:ident) => { $scene::scratch($given) };
    (@own $scene:ident $other:ident $given:ident) => { $given };
    ($from:ident: $(fn $name:ident$(<$a:lifetime>)?(&self $(, $given:ident: $kind:ty)*) $(-> $out:ty)?;)+) => {$(
        fn $name$(<$a>)?(&self $(, $given: $kind)*) $(-> $out)? {
            with_scene!(self, scene: S => <S as $from>::$name(scene $(, each_of_the_scene!(@own S $given $given))*))
        }
    )+};
}

#[warn(clippy::missing_trait_methods)]
impl Target for AnyScene {
    type Draw = AnyDraw;
    type Outcome = AnyOutcome;
    type Scratch = AnyScratch;

    fn start(&self, stream: &mut Stream) -> AnyDraw {
        with_scene!(self, scene: S => S::any_draw(scene.start(stream)))
    }

    fn simulate(
        &self,
        draw: &AnyDraw,
        current: Option<StateRefOf<'_, Self>>,
        floor: LogPotential,
        scratch: &mut AnyScratch,
    ) -> Result<Simulated<AnyOutcome>, ModelError> {
        self.simulate_watched(draw, current, (floor, None), scratch)
    }

    each_of_the_scene! {
        Target:
        fn log_prior(&self, draw: &AnyDraw) -> Result<LogDensity, ModelError>;
        fn log_constraint(&self, outcome: &AnyOutcome) -> Result<LogPotential, ModelError>;
        fn failure(&self, outcome: &AnyOutcome) -> Option<Failure>;
        fn most(&self) -> Option<LogPotential>;
        fn decided(&self, accepted: bool, scratch: &mut AnyScratch);
        fn work(&self) -> u64;
        fn numbers(&self, state: StateRefOf<'_, Self>) -> Vec<f64>;
    }
}

impl Goal for AnyScene {
    each_of_the_scene! {
        Goal:
        fn class(&self, state: StateRefOf<'_, Self>) -> Option<SolutionClass>;
        fn look(&self, state: StateRefOf<'_, Self>) -> Look;
    }
}

#[warn(clippy::missing_trait_methods)]
impl Variables for AnyScene {
    each_of_the_scene! {
        Variables:
        fn vars(&self) -> &Vars;
        fn get<'a>(&self, draw: &'a AnyDraw, var: usize) -> Option<&'a [f64]>;
        fn get_mut<'a>(&self, changed: &'a mut AnyDraw, var: usize) -> Option<&'a mut [f64]>;
        fn set_present(&self, changed: &mut AnyDraw, var: usize, present: bool);
        fn shift(&self, draw: &AnyDraw, var: usize) -> f64;
        fn renew_own(&self, changed: &mut AnyDraw, var: usize, stream: &mut Stream);
        fn step_own(&self, changed: &mut AnyDraw, var: usize, size: f64, stream: &mut Stream);
        fn renew_all(&self, changed: &mut AnyDraw, recipe: Recipe, stream: &mut Stream);
        fn renew_group(&self, changed: &mut AnyDraw, group: usize, stream: &mut Stream);
    }
}

#[warn(clippy::missing_trait_methods)]
impl Scene for AnyScene {
    fn moves(&self, rules: &Rules) -> Result<Mixture<Self>, ConfigError> {
        with_scene!(self, scene => Ok(lent(&scene.moves(rules)?)))
    }

    fn aim(&mut self, aims: &[Aim]) {
        with_scene!(self, scene => scene.aim(aims));
    }

    fn follow(&mut self, formulas: &[(String, String)]) -> Result<Vec<f64>, ConfigError> {
        with_scene!(self, scene => scene.follow(formulas))
    }

    fn simulate_watched(
        &self,
        draw: &AnyDraw,
        current: Option<StateRefOf<'_, Self>>,
        limits: (LogPotential, Option<Stop>),
        scratch: &mut AnyScratch,
    ) -> Result<Simulated<AnyOutcome>, ModelError> {
        with_scene!(self, scene: S => {
            let current = current.map(S::state);
            Ok(match scene.simulate_watched(S::draw(draw), current, limits, S::scratch(scratch))? {
                Simulated::Complete(outcome) => Simulated::Complete(S::any_outcome(outcome)),
                Simulated::CannotExceedFloor => Simulated::CannotExceedFloor,
            })
        })
    }

    fn motion_simulated(&self, draw: &AnyDraw, scratch: &AnyScratch) -> Result<Motion, ModelError> {
        with_scene!(self, scene: S => match S::scratch_kept(scratch) {
            Some(scratch) => scene.motion_simulated(S::draw(draw), scratch),
            None => scene.motion(S::draw(draw)),
        })
    }

    fn ended(&self, state: StateRefOf<'_, Self>, scratch: &AnyScratch) -> Option<Ended> {
        with_scene!(self, scene: S => scene.ended(S::state(state), S::scratch_kept(scratch)?))
    }

    fn at_accuracy(&self, accuracy: AccuracyPreset) -> Result<Option<Self>, ConfigError> {
        with_scene!(self, scene => Ok(scene.at_accuracy(accuracy)?.map(Known::any)))
    }

    each_of_the_scene! {
        Scene:
        fn scalars(&self) -> Vec<Scalar>;
        fn features(&self, state: StateRefOf<'_, Self>, features: &mut Features) -> bool;
        fn write_scalars(&self, state: StateRefOf<'_, Self>, values: &mut [f64]);
        fn animate(&self, draw: &AnyDraw) -> Result<Animation, ModelError>;
        fn animate_until(&self, draw: &AnyDraw, until: Until) -> Result<Animation, ModelError>;
        fn physics(&self, draw: &AnyDraw) -> Result<Option<Physics>, ModelError>;
        fn motion(&self, draw: &AnyDraw) -> Result<Motion, ModelError>;
        fn scenery(&self, draw: &AnyDraw, motion: &Motion) -> Result<Vec<Prop>, ModelError>;
        fn keep_motions(&self, scratch: &mut AnyScratch, contacts: bool);
        fn cast(&self) -> Cast;
        fn demands(&self) -> Vec<(String, Require)>;
        fn bearing(&self, state: StateRefOf<'_, Self>, bodies: &[bool]) -> Vec<bool>;
        fn notes(&self) -> Vec<String>;
        fn asked(&self) -> Vec<String>;
        fn missed(&self, thing: usize, margin: f64) -> Option<Missed>;
        fn lacks(&self, thing: usize, state: StateRefOf<'_, Self>) -> String;
        fn answers(&self, state: StateRefOf<'_, Self>) -> Vec<Mark>;
        fn world(&self) -> Result<Option<PlainWorld>, ModelError>;
    }
}
