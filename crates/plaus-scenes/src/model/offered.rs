//! Moves of the library that every scene offers, with weights that a scenario may set: one row for each move.

use super::row::Row;
use super::unmet::FINEST;
use plaus_mcmc::library::{Learned, RedrawOne, Sizes, Step, StepAll};
use plaus_mcmc::{Move, Variables, Vars};

/// A row, and the move for a target.
pub(super) type Offer<S> = (Row, fn(&S) -> Box<dyn Move<S>>);

/// What is offered for any target.
pub(super) trait Offered: Variables + 'static {
    /// One row for each move; none has a weight if a scenario does not give one.
    const ROWS: &'static [Offer<Self>];
}

/// All variables that are uncertain.
fn all(vars: &Vars) -> Vec<usize> {
    vars.which(|_| true)
}

impl<S: Variables + 'static> Offered for S {
    const ROWS: &'static [Offer<Self>] = &[
        (Row::own("redraw_any", 0.0, "Draw one random variable anew from its law."), |scene| {
            Box::new(RedrawOne { name: "redraw_any", among: all(scene.vars()), symmetric: false })
        }),
        (
            Row::own(
                "step_any",
                0.0,
                "Change one random variable by a step that preserves its law, of a size from a thousandth of its spread \
             up to all of it.",
            ),
            |scene| Box::new(Step::of("step_any", &all(scene.vars()), Sizes::new(FINEST, 1.0))),
        ),
        (Row::own("step_all", 0.0, "Change all random variables at once by such a step, of one size."), |scene| {
            let sizes = Sizes::new(FINEST, 1.0);
            Box::new(StepAll { name: "step_all", among: all(scene.vars()), sizes })
        }),
        (
            Row::own(
                "learned",
                0.0,
                "Draw all random numbers that tables show anew from a density learnt in the warm-up. All else stays. \
                 It learns only if `adapt` of the sampler is true; otherwise they are drawn from their laws.",
            ),
            |scene| Box::new(Learned::of("learned", scene.vars())),
        ),
        (
            Row::own(
                "learned_some",
                0.0,
                "The same for some of these numbers of one body, each with probability one half, given the others.",
            ),
            |scene| Box::new(Learned::some_of("learned_some", scene.vars())),
        ),
    ];
}
