//! What a simulation tells its listener: impacts, new motions, and a question after each event. The calls are virtual,
//! so that the event loop is compiled once, and cost nothing beside the events.

use crate::mechanics::{Impact, Island, Mechanics};
use crate::state::State;

/// A listener. Every method has an empty default.
pub trait Observer<M: Mechanics> {
    /// An impact was resolved.
    #[inline]
    fn impact(&mut self, _impact: &Impact) {}
    /// A body has a new closed form, valid from its clock on.
    #[inline]
    fn motion(&mut self, _index: usize, _body: &M::Body) {}
    /// Bodies in lasting contact with each other have settled: [`Mechanics::contact_forces`] says what bears on what.
    #[inline]
    fn settled(&mut self, _mechanics: &M, _island: &Island<'_, M>) {}
    /// Whether to go on, asked after each event. The state is consistent; each body stands at its own clock.
    #[inline]
    fn proceed(&mut self, _state: &State<M::Body>) -> bool {
        true
    }
}

/// Nobody listens.
impl<M: Mechanics> Observer<M> for () {}

/// Early exit: stops when the predicate on the evolving state says false.
pub struct While<F>(pub F);

impl<M: Mechanics, F: FnMut(&State<M::Body>) -> bool> Observer<M> for While<F> {
    #[inline]
    fn proceed(&mut self, state: &State<M::Body>) -> bool {
        (self.0)(state)
    }
}

/// A recording: every closed form of every body and every impact. Any frame rate can be drawn from it exactly.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Trace<B> {
    /// Per body, its motions in order of their clocks.
    pub motions: Vec<Vec<B>>,
    /// All impacts in the order in which they were resolved.
    pub impacts: Vec<Impact>,
}

impl<B> Default for Trace<B> {
    fn default() -> Self {
        Self { motions: Vec::new(), impacts: Vec::new() }
    }
}

impl<B: Clone> Trace<B> {
    /// Adds the next motion of a body.
    pub fn record(&mut self, index: usize, body: &B) {
        if self.motions.len() <= index {
            self.motions.resize_with(index + 1, Vec::new);
        }
        self.motions[index].push(body.clone());
    }

    /// The motion of a body that is valid at `time`, if it has been recorded. `clock` gives the clock of a motion.
    pub fn motion_at(&self, index: usize, time: f64, clock: impl Fn(&B) -> f64) -> Option<&B> {
        let motions = self.motions.get(index)?;
        let after = motions.partition_point(|b| clock(b) <= time);
        motions.get(after.checked_sub(1)?)
    }

    /// The body moved along its recorded motion to `time`.
    pub fn body_at<M: Mechanics<Body = B>>(&self, mechanics: &M, index: usize, time: f64) -> Option<B> {
        let mut body = self.motion_at(index, time, |b| mechanics.clock(b))?.clone();
        mechanics.advance(index, &mut body, time);
        Some(body)
    }
}

impl<M: Mechanics> Observer<M> for Trace<M::Body> {
    fn impact(&mut self, impact: &Impact) {
        self.impacts.push(*impact);
    }

    fn motion(&mut self, index: usize, body: &M::Body) {
        self.record(index, body);
    }
}

/// Two listeners at once.
impl<M: Mechanics, A: Observer<M>, B: Observer<M>> Observer<M> for (A, B) {
    fn impact(&mut self, impact: &Impact) {
        self.0.impact(impact);
        self.1.impact(impact);
    }

    fn motion(&mut self, index: usize, body: &M::Body) {
        self.0.motion(index, body);
        self.1.motion(index, body);
    }

    fn settled(&mut self, mechanics: &M, island: &Island<'_, M>) {
        self.0.settled(mechanics, island);
        self.1.settled(mechanics, island);
    }

    fn proceed(&mut self, state: &State<M::Body>) -> bool {
        self.0.proceed(state) && self.1.proceed(state)
    }
}

/// One listener, or nobody, decided at run time.
impl<M: Mechanics, O: Observer<M>> Observer<M> for Option<O> {
    fn impact(&mut self, impact: &Impact) {
        if let Some(listener) = self {
            listener.impact(impact);
        }
    }

    fn motion(&mut self, index: usize, body: &M::Body) {
        if let Some(listener) = self {
            listener.motion(index, body);
        }
    }

    fn settled(&mut self, mechanics: &M, island: &Island<'_, M>) {
        if let Some(listener) = self {
            listener.settled(mechanics, island);
        }
    }

    fn proceed(&mut self, state: &State<M::Body>) -> bool {
        self.as_mut().is_none_or(|listener| listener.proceed(state))
    }
}

/// A borrowed listener.
impl<M: Mechanics, O: Observer<M>> Observer<M> for &mut O {
    fn impact(&mut self, impact: &Impact) {
        (**self).impact(impact);
    }

    fn motion(&mut self, index: usize, body: &M::Body) {
        (**self).motion(index, body);
    }

    fn settled(&mut self, mechanics: &M, island: &Island<'_, M>) {
        (**self).settled(mechanics, island);
    }

    fn proceed(&mut self, state: &State<M::Body>) -> bool {
        (**self).proceed(state)
    }
}
