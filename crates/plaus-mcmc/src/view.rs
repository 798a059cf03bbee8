//! Other views of a target: the same draws and outcomes, with another weight or another way to simulate.

use crate::failures::Failure;
use crate::fit::Fit;
use crate::moves::{At, Mixture, MixtureError, Move, Path, Proposal, Transition};
use crate::scale::Scale;
use crate::target::{ModelError, Simulated, StateRefOf, Target};
use plaus_dist::{LogDensity, LogPotential, LogRatio, Stream};
use std::sync::Arc;

/// A target that shows another one under a different constraint, or simulates it in a different way, over the same
/// draws and outcomes. The other one's moves can propose for the view unchanged: see [`lend`].
///
/// The `log_constraint` in a view's states is the view's own, even when such a state is passed to the target seen or to
/// its moves.
pub trait View: Target {
    /// The target seen.
    type Seen: Target<Draw = Self::Draw, Outcome = Self::Outcome> + 'static;

    /// The target seen.
    fn seen(&self) -> &Self::Seen;
}

/// A view with a constraint of its own, that simulates as the target seen does.
pub trait Reweighed: Sync {
    /// The target seen.
    type Seen: Target;

    /// The target seen.
    fn seen(&self) -> &Self::Seen;

    /// The floor for the constraint of the target seen: this constraint can exceed `floor` only if that one exceeds the
    /// result. `None` if no constraint can.
    fn floor_seen(&self, floor: LogPotential) -> Option<LogPotential>;

    /// The constraint of an outcome.
    ///
    /// # Errors
    /// [`ModelError`] if the target seen fails, or the constraint is not a number.
    fn weigh(&self, outcome: &<Self::Seen as Target>::Outcome) -> Result<LogPotential, ModelError>;
}

impl<W: Reweighed> Target for W {
    type Draw = <W::Seen as Target>::Draw;
    type Outcome = <W::Seen as Target>::Outcome;
    type Scratch = <W::Seen as Target>::Scratch;

    fn start(&self, stream: &mut Stream) -> Self::Draw {
        Reweighed::seen(self).start(stream)
    }

    fn log_prior(&self, draw: &Self::Draw) -> Result<LogDensity, ModelError> {
        Reweighed::seen(self).log_prior(draw)
    }

    fn simulate(
        &self,
        draw: &Self::Draw,
        current: Option<StateRefOf<'_, Self>>,
        floor: LogPotential,
        scratch: &mut Self::Scratch,
    ) -> Result<Simulated<Self::Outcome>, ModelError> {
        match self.floor_seen(floor) {
            Some(floor) => Reweighed::seen(self).simulate(draw, current, floor, scratch),
            None => Ok(Simulated::CannotExceedFloor),
        }
    }

    fn log_constraint(&self, outcome: &Self::Outcome) -> Result<LogPotential, ModelError> {
        self.weigh(outcome)
    }

    fn failure(&self, outcome: &Self::Outcome) -> Option<Failure> {
        Reweighed::seen(self).failure(outcome)
    }

    fn decided(&self, accepted: bool, scratch: &mut Self::Scratch) {
        Reweighed::seen(self).decided(accepted, scratch);
    }

    fn work(&self) -> u64 {
        Reweighed::seen(self).work()
    }

    fn numbers(&self, state: StateRefOf<'_, Self>) -> Vec<f64> {
        Reweighed::seen(self).numbers(state)
    }
}

impl<W: Reweighed> View for W
where
    W::Seen: 'static,
{
    type Seen = W::Seen;

    fn seen(&self) -> &W::Seen {
        Reweighed::seen(self)
    }
}

/// The moves of a target, with their probabilities, for a view of it. Many views can share them through one [`Arc`].
///
/// # Errors
/// [`MixtureError`] is not expected: the weights are those of a mixture already.
pub fn lend<V: View>(moves: impl Into<Arc<Mixture<V::Seen>>>) -> Result<Mixture<V>, MixtureError> {
    let moves = moves.into();
    let lent = moves.shared().map(|(weight, kernel)| -> (f64, Box<dyn Move<V>>) { (weight, Box::new(Lent(kernel))) });
    Mixture::new(lent.collect())
}

/// A target whose states contain a state of another target, and perhaps more. The other target's moves propose for it:
/// see [`lent`].
pub trait Sees<S: Target>: Target {
    /// The target seen.
    fn seen(&self) -> &S;

    /// The other target's state within one of this target's.
    fn state(state: StateRefOf<'_, Self>) -> StateRefOf<'_, S>;

    /// The other target's draw within one of this target's.
    fn draw_mut(draw: &mut Self::Draw) -> &mut S::Draw;
}

impl<V: View> Sees<V::Seen> for V {
    fn seen(&self) -> &V::Seen {
        View::seen(self)
    }

    fn state(state: StateRefOf<'_, V>) -> StateRefOf<'_, V::Seen> {
        state
    }

    fn draw_mut(draw: &mut V::Draw) -> &mut V::Draw {
        draw
    }
}

/// The moves of a target, with their probabilities, for one that sees its states.
#[must_use]
pub fn lent<S: Target + 'static, V: Sees<S>>(moves: &Mixture<S>) -> Mixture<V> {
    moves.map_all(|kernel| Box::new(Lent(kernel)))
}

/// One move of a shared mixture.
pub(crate) struct Lent<T: Target>(pub(crate) Arc<dyn Move<T>>);

impl<T: Target> Lent<T> {
    fn kernel(&self) -> &dyn Move<T> {
        self.0.as_ref()
    }
}

/// Where the move starts, as the target it was made for sees it.
fn seen_at<S: Target, V: Sees<S>>(at: At<'_, V>) -> At<'_, S> {
    At { target: at.target.seen(), state: V::state(at.state) }
}

/// The step as the target of the move sees it.
fn seen_step<S: Target, V: Sees<S>>(step: Transition<'_, V>) -> Transition<'_, S> {
    let Transition { target, from, to, path } = step;
    Transition { target: target.seen(), from: V::state(from), to: V::state(to), path }
}

impl<S: Target + 'static, V: Sees<S>> Move<V> for Lent<S> {
    fn name(&self) -> &str {
        self.kernel().name()
    }

    fn propose(&self, at: At<'_, V>, candidate: &mut V::Draw, stream: &mut Stream) -> Result<Proposal, ModelError> {
        self.kernel().propose(seen_at(at), V::draw_mut(candidate), stream)
    }

    fn log_ratio(&self, step: Transition<'_, V>) -> Result<LogRatio, ModelError> {
        self.kernel().log_ratio(seen_step(step))
    }

    fn reverse(&self, path: Path) -> Path {
        self.kernel().reverse(path)
    }

    fn log_ratio_after(&self, step: Transition<'_, V>) -> Result<LogRatio, ModelError> {
        self.kernel().log_ratio_after(seen_step(step))
    }

    fn scales(&self) -> Vec<Scale> {
        self.kernel().scales()
    }

    fn at_scales(&self, values: &[Option<f64>]) -> Option<Box<dyn Move<V>>> {
        Some(Box::new(Lent(Arc::from(self.kernel().at_scales(values)?))))
    }

    fn scale_of(&self, path: Path) -> Option<usize> {
        self.kernel().scale_of(path)
    }

    fn learns(&self) -> Vec<usize> {
        self.kernel().learns()
    }

    fn learn_from(&self, target: &V, state: StateRefOf<'_, V>) -> Vec<f64> {
        self.kernel().learn_from(target.seen(), V::state(state))
    }

    fn merit(&self, target: &V, state: StateRefOf<'_, V>) -> f64 {
        self.kernel().merit(target.seen(), V::state(state))
    }

    fn at_fits(&self, fits: &[Option<Fit>]) -> Option<Box<dyn Move<V>>> {
        Some(Box::new(Lent(Arc::from(self.kernel().at_fits(fits)?))))
    }
}
