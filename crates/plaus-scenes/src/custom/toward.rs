//! Choices that a recast makes: which body, and by which angle its throw is turned.

use super::Custom;
use super::angles::{Angles, EACH, Turn, angle_of};
use super::handles::{Course, Handle};
use super::throws::{Throw, Trial};
use super::values::{Drawn, Numbers};
use plaus_dist::{Stream, math};
use plaus_mcmc::StateRefOf;
use plaus_mcmc::library::one_of;

/// How many times as often as another one a body is chosen that ends otherwise than asked.
const BY: f64 = 8.0;

impl Handle {
    /// Log density of a number under its law.
    fn log_law(&self, world: &Custom, number: f64) -> f64 {
        let log = world.vars.get(self.var).law.log_density(f64::NAN, &[number]);
        log.map_or(f64::NEG_INFINITY, |log| log.value())
    }
}

impl Course {
    /// Log density under their laws of the numbers that turn with the course, if it is turned.
    pub(super) fn log_law(&self, world: &Custom, draw: &Drawn, numbers: &Numbers<'_>, turn: Turn) -> f64 {
        self.turned((world, draw), numbers, turn).map(|(handle, number)| handle.log_law(world, number)).sum()
    }
}

impl Throw {
    /// The largest log probability of an angle.
    pub(super) fn log_most(&self) -> f64 {
        self.span.map_or(0.0, |_| -math::ln(EACH as f64))
    }

    /// An angle by its number.
    pub(super) fn angle(&self, angle: u64) -> f64 {
        self.span.map_or(0.0, |span| angle_of(span, angle))
    }

    /// For each cell something of the turn in its middle.
    fn each(&self, of: impl Fn(Turn) -> f64) -> Vec<f64> {
        self.turns.iter().map(|&turn| of(turn)).collect()
    }

    /// By which angles a throw may have been turned before it came to be that of a draw: by how likely its laws make
    /// what it was before.
    pub(super) fn angles_before(&self, world: &Custom, draw: &Drawn) -> Angles {
        let Some(course) = self.handles.course.as_ref().filter(|_| self.span.is_some()) else { return Angles::NONE };
        let numbers = world.plan.works.numbers(Some(draw));
        Angles::new(&self.each(|turn| course.log_law(world, draw, &numbers, turn.back())))
    }

    /// By which angles to turn the throw of a trial: by how likely its laws make what comes of it, and a place from
    /// which it ends in the middle of a zone; or by how well it ends, from where it starts.
    pub(super) fn angles_after(&self, world: &Custom, trial: &Trial) -> Angles {
        let Some(course) = self.handles.course.as_ref().filter(|_| self.span.is_some()) else { return Angles::NONE };
        let draw = &trial.begun;
        let numbers = world.plan.works.numbers(Some(draw));
        let start = self.start(world, draw);
        let log = |turn: Turn| {
            let end = (start + trial.turned(turn)).to_array();
            let ways = if self.zones.is_empty() { &self.all } else { &self.zones };
            let logs = ways.iter().map(|zone| {
                if self.zones.is_empty() {
                    return zone.log_density(end);
                }
                let along = zone.middle().into_iter().zip(end).zip(&self.handles.place);
                let along = along.filter_map(|((middle, end), handle)| Some((middle? - end, (*handle)?)));
                let log = |(by, handle): (f64, Handle)| {
                    handle.log_law(world, draw.numbers[handle.number] + by / handle.factor)
                };
                along.map(log).sum::<f64>()
            });
            let most = logs.fold(f64::NEG_INFINITY, f64::max);
            course.log_law(world, draw, &numbers, turn) + most
        };
        Angles::new(&self.each(log))
    }
}

impl Custom {
    /// How often each throw is chosen in a state, relative to one that ends as asked.
    fn weights_of_throws(&self, state: StateRefOf<'_, Self>) -> Vec<f64> {
        let weight = |throw: &Throw| if throw.misses(self, state.draw, state.outcome) { BY } else { 1.0 };
        self.throws().iter().map(weight).collect()
    }

    /// One of the throws, rather one that ends otherwise than asked.
    pub(super) fn choose_throw(&self, state: StateRefOf<'_, Self>, stream: &mut Stream) -> usize {
        let weights = self.weights_of_throws(state);
        one_of(weights.iter().copied(), stream).unwrap_or(weights.len() - 1)
    }

    /// Log probability of choosing a throw in a state.
    pub(super) fn log_chosen(&self, state: StateRefOf<'_, Self>, throw: usize) -> f64 {
        let weights = self.weights_of_throws(state);
        math::ln(weights[throw] / weights.iter().sum::<f64>())
    }

    /// The largest log probability of choosing a throw.
    pub(super) fn log_most_chosen(&self) -> f64 {
        math::ln(BY / (BY + self.throws().len() as f64 - 1.0))
    }
}
