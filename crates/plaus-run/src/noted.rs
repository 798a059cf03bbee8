//! Which solutions a run takes, told again from what its chains recorded.

use crate::{Draw, Outcome};
use plaus_mcmc::{Distinct, FirstOfClass, Goal, Look, Plan, Sighting, State};
use plaus_scenes::Stage;
use std::sync::Arc;

/// Notes a solution of a chain, as the run did; its look if it is new.
pub(crate) fn note(
    firsts: &mut Distinct,
    first: FirstOfClass,
    state: &State<Draw, Outcome>,
    plan: Plan,
    scene: &Stage,
) -> Option<Arc<Look>> {
    firsts.note_with(first, plan.enough().map(|_| || scene.look(state.by_ref())))
}

/// The distinct solutions among what chains saw.
pub(crate) fn taken(mut all: Vec<Sighting>) -> Distinct {
    all.sort_by_key(|one| one.first);
    let mut distinct = Distinct::apart(1.0);
    for Sighting { first, look } in all {
        distinct.note_seen(first, look);
    }
    distinct
}
