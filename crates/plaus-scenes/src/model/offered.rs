//! Moves of the library that every scene offers, of any weight that a scenario gives them: one row a move.

use super::row::Row;
use plaus_mcmc::library::{Learned, RedrawOne, Sizes, Step, StepAll};
use plaus_mcmc::{Move, Variables, Vars};

/// A row, and the move for a target.
pub(super) type Offer<S> = (Row, fn(&S) -> Box<dyn Move<S>>);

/// What is offered for any target.
pub(super) trait Offered: Variables + 'static {
    /// One row a move; none has a weight where a scenario does not say.
    const ROWS: &'static [Offer<Self>];
}

/// The least size of steps of all scales.
const FINEST: f64 = 1e-3;

/// All variables that are uncertain.
fn all(vars: &Vars) -> Vec<usize> {
    vars.which(|_| true)
}

impl<S: Variables + 'static> Offered for S {
    const ROWS: &'static [Offer<Self>] = &[
        (Row::own("redraw_any", 0.0, "Any one random variable is drawn anew from its law."), |scene| {
            Box::new(RedrawOne { name: "redraw_any", among: all(scene.vars()), symmetric: false })
        }),
        (
            Row::own(
                "step_any",
                0.0,
                "Any one random variable makes a step that leaves its law as it is, of a size from a thousandth of \
                 its spread up to all of it.",
            ),
            |scene| Box::new(Step::of("step_any", &all(scene.vars()), Sizes::new(FINEST, 1.0))),
        ),
        (Row::own("step_all", 0.0, "All random variables make such a step at once, of one size."), |scene| {
            let sizes = Sizes::new(FINEST, 1.0);
            Box::new(StepAll { name: "step_all", among: all(scene.vars()), sizes })
        }),
        (
            Row::own(
                "learned",
                0.0,
                "Everything is drawn anew, numbers that tables show from a density that the chain has learnt in its \
                 warm-up. It learns only where `adapt` of the sampler is true; else all is drawn from its law.",
            ),
            |scene| Box::new(Learned::of("learned", scene.vars())),
        ),
    ];
}
