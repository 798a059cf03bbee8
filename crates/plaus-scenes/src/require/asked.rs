//! A scene with requirements beyond its own.

use super::agree::agree;
use super::answer::{Answer, Judged};
use super::cast::Cast;
use super::ended::Ended;
use super::judge::{Judge, floor_beside};
use super::kinds::{Require, settled};
use super::missed::Missed;
use super::place::Place;
use super::probe::Probe;
use super::score::{Mark, Reach};
use super::stop::{Asks, Stop, Stops};
use super::timed::Timed;
use crate::accuracy::AccuracyPreset;
use crate::animation::{Animation, Motion, Physics, Prop};
use crate::look::Screen;
use crate::model::{Column, Features, Member, Scalar, distinct, unmet};
use crate::rules::Rules;
use crate::scene::{ConfigError, Scene, Until};
use crate::world::PlainWorld;
use plaus_dist::{LogDensity, LogPotential, Stream};
use plaus_mcmc::view::{Sees, lent};
use plaus_mcmc::{
    Failure, Goal, Interrupted, Look, Mixture, ModelError, Recipe, Simulated, SolutionClass, StateRef, StateRefOf,
    Target, Variables, Vars,
};
use plaus_sim::interruptible;
use std::cell::RefCell;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// A scene under requirements: `p ∝ p_w · p_c · Π p_r`. Its own moves propose; its own simulation still
/// stops early, and does so for the requirements too.
#[derive(Debug)]
pub struct Asked<S> {
    scene: S,
    asks: Arc<Asks>,
    /// What the caller requires further.
    further: Option<Arc<dyn Judge<S>>>,
    /// How solutions are told apart.
    screen: Screen,
    /// Once it is set, simulations end at once.
    interrupt: Option<Arc<AtomicBool>>,
}

/// The key of a requirement.
fn key(index: usize, one: &Require) -> String {
    format!("require[{index}].{}", one.name())
}

impl<S: Scene> Asked<S> {
    /// `scene` under `requirements`.
    ///
    /// # Errors
    ///
    /// [`ConfigError`] if a requirement names something that does not exist, can never be met, or contradicts another.
    pub fn new(mut scene: S, requirements: &[Require]) -> Result<Self, ConfigError> {
        let cast = scene.cast();
        let requirements = &settled(requirements, |formulas| scene.follow(formulas))?;
        let mut named = Vec::with_capacity(requirements.len());
        for (index, one) in requirements.iter().enumerate() {
            let bodies = RefCell::new(vec![false; cast.bodies.len()]);
            one.check(&Place::of_entry(index, &cast, &bodies).at(one.name()))?;
            named.push(bodies.into_inner());
        }
        let said = requirements.iter().enumerate().map(|(index, one)| (key(index, one), one.clone()));
        agree(&scene.demands().into_iter().chain(said).collect::<Vec<_>>(), &cast)?;
        scene.aim(&Require::aims_of(requirements, &cast));
        let asks = Arc::new(Asks::new(requirements, cast, named));
        Ok(Self { scene, asks, further: None, screen: Screen::of(1.0), interrupt: None })
    }

    /// An animation with marks on the spots at which something should come to rest.
    fn marked(&self, mut animation: Animation) -> Animation {
        let spots = self.requirements().iter().flat_map(Require::spots);
        animation.scenery.extend(spots.enumerate().map(|(number, spot)| spot.prop(number)));
        animation
    }

    /// The scenery of a motion, if a requirement takes notice of that; else none.
    fn noticed(&self, draw: &S::Draw, motion: &Motion) -> Result<Vec<Prop>, ModelError> {
        if self.asks.looks.scenery { self.scene.scenery(draw, motion) } else { Ok(Vec::new()) }
    }

    /// The same with solutions told apart by cells that are `distinct` times as wide.
    #[must_use]
    pub fn with_distinct(self, distinct: f64) -> Self {
        Self { screen: Screen::of(distinct), ..self }
    }

    /// The same under one more requirement, which the caller's own code judges. Its mark follows those of the others.
    #[must_use]
    pub fn judged_by(self, judge: Arc<dyn Judge<S>>) -> Self {
        Self { further: Some(judge), ..self }
    }

    /// The same with simulations that any thread can end: once `flag` is set, those that run fail after the event
    /// that they are at, as [`Interrupted`], and so do all that begin.
    #[must_use]
    pub fn interrupted_by(self, flag: Arc<AtomicBool>) -> Self {
        Self { interrupt: Some(flag), ..self }
    }

    /// The scene without the requirements.
    pub fn scene(&self) -> &S {
        &self.scene
    }

    /// The same with simulations stopped otherwise: for tests that compare with twins.
    #[doc(hidden)]
    #[must_use]
    pub fn stopping(mut self, stops: Stops) -> Self {
        Arc::make_mut(&mut self.asks).stops = stops;
        self
    }

    /// The requirements.
    #[must_use]
    pub fn requirements(&self) -> &[Require] {
        &self.asks.requirements
    }

    /// How well a motion that is known to its end, among scenery, meets each requirement.
    #[must_use]
    pub fn judge(&self, motion: &Motion, scenery: &[Prop]) -> Vec<Mark> {
        let probe = Probe::whole(motion, &self.asks.cast).among(scenery);
        self.asks.requirements.iter().map(|one| one.reach(&probe).most).collect()
    }

    /// The times that all constraints ask for, each with its constraint's key, and the times found in an animation that
    /// shows a motion to its end.
    #[must_use]
    pub fn times(&self, animation: &Animation) -> Vec<(String, Timed)> {
        let probe = Probe::whole(&animation.motion, &self.asks.cast).among(&animation.scenery);
        let of = |(key, require): (String, Require)| {
            require.times(&probe).into_iter().map(move |timed| (key.clone(), timed)).collect::<Vec<_>>()
        };
        self.demands().into_iter().flat_map(of).collect()
    }

    /// What ends a simulation that cannot exceed `floor`; `None` if no beginning can rule that out.
    #[must_use]
    pub fn stop(&self, floor: LogPotential) -> Option<Stop> {
        Stop::new(&self.asks, floor)
    }

    /// The variables that bear upon the bodies that unmet requirements name; if all are met, that any of them names.
    fn lacks(&self, state: StateRefOf<'_, Self>) -> Vec<bool> {
        let mut bodies = vec![false; self.asks.cast.bodies.len()];
        let (marks, _) = self.split(state.outcome.marks());
        let all = marks.iter().all(Mark::met);
        let unmet = self.asks.named.iter().zip(marks).filter(|(_, mark)| all || !mark.met());
        unmet.for_each(|(named, _)| bodies.iter_mut().zip(named).for_each(|(body, named)| *body |= named));
        if bodies.contains(&true) { self.scene.bearing(Self::state(state), &bodies) } else { Vec::new() }
    }

    /// [`Target::simulate`], to its end.
    fn evaluate(
        &self,
        draw: &S::Draw,
        current: Option<StateRefOf<'_, Self>>,
        floor: LogPotential,
        scratch: &mut S::Scratch,
    ) -> Result<Simulated<Answer<S::Outcome>>, ModelError> {
        let current = current.map(Self::state);
        if self.asks.requirements.is_empty() && self.further.is_none() {
            return Ok(match self.scene.simulate(draw, current, floor, scratch)? {
                Simulated::Complete(outcome) => Simulated::Complete(Answer { outcome, judged: None }),
                Simulated::CannotExceedFloor => Simulated::CannotExceedFloor,
            });
        }
        let before = self.further.as_ref().map_or(Ok(floor), |judge| judge.floor_before(floor))?;
        if self.needs_motion() {
            self.scene.keep_motions(scratch, self.asks.looks.contacts);
        }
        let own_floor = floor_beside(before, LogPotential::new(self.asks.most)?)?;
        let limits = (own_floor, self.stop(before));
        let Simulated::Complete(outcome) = self.scene.simulate_watched(draw, current, limits, scratch)? else {
            return Ok(Simulated::CannotExceedFloor);
        };
        let own = self.scene.log_constraint(&outcome)?;
        // A failure is to be counted, however low the floor.
        let has_failed = self.scene.failure(&outcome).is_some();
        if own <= own_floor && !floor.is_zero() && !has_failed {
            return Ok(Simulated::CannotExceedFloor);
        }
        if own.is_zero() {
            // A draw that the scene forbids may have no motion; its marks do not matter.
            let count = self.asks.requirements.len() + usize::from(self.further.is_some());
            let marks = vec![Reach::NEVER.most; count];
            return Ok(Simulated::Complete(Answer { outcome, judged: Some(Box::new(Judged { own, marks })) }));
        }
        let motion = self.needs_motion().then(|| self.motion_simulated(draw, scratch)).transpose()?;
        let marks = match &motion {
            Some(motion) => self.judge(motion, &self.noticed(draw, motion)?),
            None => Vec::new(),
        };
        let mut answer = Answer { outcome, judged: Some(Box::new(Judged { own, marks })) };
        let Some(judge) = &self.further else { return Ok(Simulated::Complete(answer)) };
        let log_constraint = self.log_constraint(&answer)?;
        if log_constraint <= before && !floor.is_zero() && !has_failed {
            return Ok(Simulated::CannotExceedFloor);
        }
        let log_prior = self.scene.log_prior(draw)?;
        let state = StateRef { draw, outcome: &answer, log_prior, log_constraint };
        let mark = judge.mark(state, motion.filter(|_| judge.wants_motion()))?;
        answer.judged.iter_mut().for_each(|judged| judged.marks.push(mark));
        Ok(Simulated::Complete(answer))
    }

    /// The marks of the requirements, and that of the judge.
    fn split<'a>(&self, marks: &'a [Mark]) -> (&'a [Mark], &'a [Mark]) {
        marks.split_at(self.requirements().len().min(marks.len()))
    }

    /// Whether something judges motions.
    fn needs_motion(&self) -> bool {
        !self.asks.requirements.is_empty() || self.further.as_ref().is_some_and(|judge| judge.wants_motion())
    }
}

impl<S: Scene> Target for Asked<S> {
    type Draw = S::Draw;
    type Outcome = Answer<S::Outcome>;
    type Scratch = S::Scratch;

    fn start(&self, stream: &mut Stream) -> S::Draw {
        self.scene.start(stream)
    }

    fn log_prior(&self, draw: &S::Draw) -> Result<LogDensity, ModelError> {
        self.scene.log_prior(draw)
    }

    fn simulate(
        &self,
        draw: &S::Draw,
        current: Option<StateRefOf<'_, Self>>,
        floor: LogPotential,
        scratch: &mut S::Scratch,
    ) -> Result<Simulated<Self::Outcome>, ModelError> {
        match &self.interrupt {
            None => self.evaluate(draw, current, floor, scratch),
            Some(flag) => interruptible(flag, || self.evaluate(draw, current, floor, scratch))
                .unwrap_or_else(|| Err(Interrupted.into())),
        }
    }

    fn log_constraint(&self, answer: &Self::Outcome) -> Result<LogPotential, ModelError> {
        let Some(judged) = &answer.judged else { return self.scene.log_constraint(&answer.outcome) };
        // In the order in which they are judged: the bound of a floor holds for the sum so far.
        let sum = |marks: &[Mark]| LogPotential::new(marks.iter().fold(0.0, |sum, mark| sum + mark.log));
        let (asked, further) = self.split(&judged.marks);
        Ok(judged.own + sum(asked)? + sum(further)?)
    }

    fn failure(&self, answer: &Self::Outcome) -> Option<Failure> {
        self.scene.failure(&answer.outcome)
    }

    fn most(&self) -> Option<LogPotential> {
        let further = self.further.as_ref().map_or(Some(LogPotential::ONE), |judge| judge.most())?.value();
        self.scene.most().and_then(|own| LogPotential::new(own.value() + self.asks.most + further).ok())
    }

    fn decided(&self, accepted: bool, scratch: &mut S::Scratch) {
        self.scene.decided(accepted, scratch);
    }

    fn work(&self) -> u64 {
        self.scene.work()
    }

    fn numbers(&self, state: StateRefOf<'_, Self>) -> Vec<f64> {
        crate::scene::numbers(self, state)
    }
}

impl<S: Scene> Goal for Asked<S> {
    fn class(&self, state: StateRefOf<'_, Self>) -> Option<SolutionClass> {
        let met = state.outcome.marks().iter().all(Mark::met);
        if met { distinct::class(&self.scene, Self::state(state), self.screen.scale) } else { None }
    }

    fn look(&self, state: StateRefOf<'_, Self>) -> Look {
        self.screen.look(&self.scene, Self::state(state), &self.asks.cast)
    }
}

impl<S: Scene> Sees<S> for Asked<S> {
    fn seen(&self) -> &S {
        &self.scene
    }

    fn state(state: StateRefOf<'_, Self>) -> StateRefOf<'_, S> {
        let StateRef { draw, outcome: Answer { outcome, judged }, log_prior, log_constraint } = state;
        StateRef { draw, outcome, log_prior, log_constraint: judged.as_ref().map_or(log_constraint, |own| own.own) }
    }

    fn draw_mut(draw: &mut S::Draw) -> &mut S::Draw {
        draw
    }
}

/// The scene's own.
impl<S: Scene> Variables for Asked<S> {
    fn vars(&self) -> &Vars {
        self.scene.vars()
    }

    fn get<'a>(&self, draw: &'a S::Draw, var: usize) -> Option<&'a [f64]> {
        self.scene.get(draw, var)
    }

    fn get_mut<'a>(&self, draw: &'a mut S::Draw, var: usize) -> Option<&'a mut [f64]> {
        self.scene.get_mut(draw, var)
    }

    fn set_present(&self, draw: &mut S::Draw, var: usize, present: bool) {
        self.scene.set_present(draw, var, present);
    }

    fn shift(&self, draw: &S::Draw, var: usize) -> f64 {
        self.scene.shift(draw, var)
    }

    fn renew_own(&self, draw: &mut S::Draw, var: usize, stream: &mut Stream) {
        self.scene.renew_own(draw, var, stream);
    }

    fn step_own(&self, draw: &mut S::Draw, var: usize, size: f64, stream: &mut Stream) {
        self.scene.step_own(draw, var, size, stream);
    }

    fn renew_all(&self, draw: &mut S::Draw, recipe: Recipe, stream: &mut Stream) {
        self.scene.renew_all(draw, recipe, stream);
    }

    fn renew_group(&self, draw: &mut S::Draw, group: usize, stream: &mut Stream) {
        self.scene.renew_group(draw, group, stream);
    }
}

impl<S: Scene> Scene for Asked<S> {
    fn moves(&self, rules: &Rules) -> Result<Mixture<Self>, ConfigError> {
        Ok(lent(&self.scene.moves(rules)?).with(Box::new(unmet(self, Self::lacks))))
    }

    /// The scene's own, and the margin of each requirement.
    fn scalars(&self) -> Vec<Scalar> {
        let margin = Column::result("margin", "nat");
        let numbers = 1..=self.requirements().len() as u32;
        let margins = numbers.map(|number| margin.of(Some(Member { kind: "requirement", number })));
        self.scene.scalars().into_iter().chain(margins).collect()
    }

    fn write_scalars(&self, state: StateRefOf<'_, Self>, values: &mut [f64]) {
        let marks = state.outcome.marks();
        let (marks, _) = self.split(marks);
        let (own, margins) = values.split_at_mut(values.len().saturating_sub(marks.len()));
        self.scene.write_scalars(Self::state(state), own);
        margins.iter_mut().zip(marks).for_each(|(value, mark)| *value = mark.margin);
    }

    fn features(&self, state: StateRefOf<'_, Self>, features: &mut Features) -> bool {
        state.outcome.marks().iter().all(Mark::met) && self.scene.features(Self::state(state), features)
    }

    fn animate(&self, draw: &S::Draw) -> Result<Animation, ModelError> {
        self.scene.animate(draw).map(|animation| self.marked(animation))
    }

    fn animate_until(&self, draw: &S::Draw, until: Until) -> Result<Animation, ModelError> {
        self.scene.animate_until(draw, until).map(|animation| self.marked(animation))
    }

    fn physics(&self, draw: &S::Draw) -> Result<Option<Physics>, ModelError> {
        self.scene.physics(draw)
    }

    fn motion(&self, draw: &S::Draw) -> Result<Motion, ModelError> {
        self.scene.motion(draw)
    }

    fn scenery(&self, draw: &S::Draw, motion: &Motion) -> Result<Vec<Prop>, ModelError> {
        self.scene.scenery(draw, motion)
    }

    fn keep_motions(&self, scratch: &mut S::Scratch, contacts: bool) {
        self.scene.keep_motions(scratch, contacts);
    }

    fn motion_simulated(&self, draw: &S::Draw, scratch: &S::Scratch) -> Result<Motion, ModelError> {
        self.scene.motion_simulated(draw, scratch)
    }

    fn at_accuracy(&self, accuracy: AccuracyPreset) -> Result<Option<Self>, ConfigError> {
        let (asks, screen) = (Arc::clone(&self.asks), Screen::of(self.screen.scale));
        let (further, interrupt) = (self.further.clone(), self.interrupt.clone());
        Ok(self.scene.at_accuracy(accuracy)?.map(|scene| Self { scene, asks, further, screen, interrupt }))
    }

    fn bearing(&self, state: StateRefOf<'_, Self>, bodies: &[bool]) -> Vec<bool> {
        self.scene.bearing(Self::state(state), bodies)
    }

    fn world(&self) -> Result<Option<PlainWorld>, ModelError> {
        self.scene.world()
    }

    fn cast(&self) -> Cast {
        self.asks.cast.clone()
    }

    fn demands(&self) -> Vec<(String, Require)> {
        let said = self.requirements().iter().enumerate().map(|(index, one)| (key(index, one), one.clone()));
        self.scene.demands().into_iter().chain(said).collect()
    }

    fn notes(&self) -> Vec<String> {
        self.scene.notes().into_iter().chain(self.asks.never_at_rest()).collect()
    }

    fn ended(&self, state: StateRefOf<'_, Self>, scratch: &S::Scratch) -> Option<Ended> {
        self.scene.ended(Self::state(state), scratch)
    }

    fn asked(&self) -> Vec<String> {
        let called = |(index, one): (usize, &Require)| one.own_name().map_or_else(|| key(index, one), str::to_owned);
        self.scene.asked().into_iter().chain(self.requirements().iter().enumerate().map(called)).collect()
    }

    fn missed(&self, thing: usize, margin: f64) -> Option<Missed> {
        match thing.checked_sub(self.scene.asked().len()) {
            None => self.scene.missed(thing, margin),
            Some(index) => self.requirements().get(index)?.missed(margin),
        }
    }

    fn lacks(&self, thing: usize, state: StateRefOf<'_, Self>) -> String {
        let own = thing < self.scene.asked().len();
        if own { self.scene.lacks(thing, Self::state(state)) } else { String::new() }
    }

    fn answers(&self, state: StateRefOf<'_, Self>) -> Vec<Mark> {
        let own = self.scene.answers(Self::state(state));
        own.into_iter().chain(self.split(state.outcome.marks()).0.iter().copied()).collect()
    }
}
