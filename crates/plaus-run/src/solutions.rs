//! The distinct solutions of a run: those that a gallery shows, and that `--all-distinct` exports; and those among them
//! that differ most.

use crate::error::RunFileError;
use crate::noted::note;
use crate::read::RunReader;
use crate::sample_id::SampleId;
use crate::{Draw, Outcome};
use plaus_mcmc::{Distinct, FirstOfClass, Goal, Look, State};
use rayon::prelude::*;
use std::sync::Arc;

/// The first recorded satisfying draw of its class, in the phases in which solutions count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution {
    /// The sample.
    pub sample: SampleId,
    /// The iteration that recorded it.
    pub iteration: u64,
    /// Its `log p(A)`.
    pub log_p: f64,
}

/// The distinct solutions, ordered by iteration, then chain. In a run that looks for a number of them, each differs
/// clearly from all before it, as a viewer sees them; in any other run each is the first of its class. If the run looks
/// for solutions, those of the warm-up are included; their samples say so.
///
/// # Errors
/// [`RunFileError`] if the records are damaged.
pub fn distinct(run: &RunReader<'_>) -> Result<Vec<Solution>, RunFileError> {
    Ok(seen(run, false)?.into_iter().map(|one| one.solution).collect())
}

/// Number of solutions that are compared to find those that differ most: a run may have very many.
const COMPARED: usize = 2000;

/// Solutions that differ most.
#[derive(Debug, Clone, PartialEq)]
pub struct MostDifferent {
    /// First the likeliest, then always the one that differs most, as a viewer sees it, from those before.
    pub solutions: Vec<Solution>,
    /// Number of distinct solutions among which these were chosen: of very many an even choice.
    pub compared: usize,
    /// Number of distinct solutions.
    pub distinct: usize,
}

/// Up to `count` of the distinct solutions that differ most.
///
/// # Errors
/// [`RunFileError`] if the records are damaged.
pub fn most_different(run: &RunReader<'_>, count: usize) -> Result<MostDifferent, RunFileError> {
    let mut all = seen(run, true)?;
    let distinct = all.len();
    if run.run().manifest().plan.enough().is_none() {
        let compared = distinct.min(COMPARED);
        all = (0..compared).map(|k| all[k * distinct / compared].clone()).collect();
        let look = |one: &mut Found| {
            if let Some(state) = &one.state {
                one.look = Arc::new(run.scene().look(state.by_ref()));
            }
        };
        all.par_iter_mut().for_each(look);
    }
    let likeliest = all.iter().enumerate().max_by(|(_, a), (_, b)| a.solution.log_p.total_cmp(&b.solution.log_p));
    let first = likeliest.map_or(0, |(index, _)| index);
    let order = farthest_first(all.len(), first, count, |a, b| all[a].look.distance(&all[b].look));
    let solutions = order.into_iter().map(|index| all[index].solution).collect();
    Ok(MostDifferent { solutions, compared: all.len(), distinct })
}

/// Up to `count` of the numbers below `all`, in order of choice: first `first`, then always the one farthest from all
/// chosen so far (Gonzalez 1985). So any that is left out is at most twice as far from a chosen one as it would be in
/// the best choice of that many. What is at distance 0 from a chosen one comes last.
pub fn farthest_first(
    all: usize,
    first: usize,
    count: usize,
    distance: impl Fn(usize, usize) -> f64 + Sync,
) -> Vec<usize> {
    let (mut chosen, mut next) = (Vec::new(), first);
    let mut distances = vec![f64::INFINITY; all];
    while chosen.len() < count.min(all) {
        chosen.push(next);
        distances.par_iter_mut().enumerate().for_each(|(index, least)| *least = least.min(distance(index, next)));
        distances[next] = -1.0;
        let farthest = distances.iter().enumerate().reduce(|a, b| if b.1 > a.1 { b } else { a });
        let Some((index, _)) = farthest else { break };
        next = index;
    }
    chosen
}

/// The distinct solutions. With `states`, each has its state where the run tells nothing of looks.
fn seen(run: &RunReader<'_>, states: bool) -> Result<Vec<Found>, RunFileError> {
    let states = states && run.run().manifest().plan.enough().is_none();
    let parts: Vec<Vec<Found>> = run.each_chain(|chain| of_chain(run, chain, states))?;
    let mut all: Vec<Found> = parts.into_iter().flatten().collect();
    all.sort_by_key(|one| one.first);
    let mut distinct = Distinct::apart(1.0);
    all.retain(|one| distinct.note_seen(one.first, Arc::clone(&one.look)));
    Ok(all)
}

/// A solution that is new to its chain.
#[derive(Clone)]
struct Found {
    first: FirstOfClass,
    solution: Solution,
    /// Empty where the run does not look for a number of solutions.
    look: Arc<Look>,
    state: Option<State<Draw, Outcome>>,
}

fn of_chain(run: &RunReader<'_>, chain: u32, states: bool) -> Result<Vec<Found>, RunFileError> {
    let (plan, mut firsts, mut all) = (run.run().manifest().plan, Distinct::apart(1.0), Vec::new());
    for &phase in run.counted() {
        run.walk(chain, phase, |repeats| -> Result<(), RunFileError> {
            let (state, iteration) = (&repeats.entry.state, run.iteration_of(phase, repeats.draw));
            let Some(class) = repeats.entry.class else { return Ok(()) };
            // Where the warm-up counts too, an entry was noted once, at its beginning.
            if !repeats.begins && plan.counts_from() == 0 {
                return Ok(());
            }
            let first = FirstOfClass { iteration, chain, class };
            if let Some(look) = note(&mut firsts, first, state, plan, run.scene()) {
                let sample = SampleId { chain, phase, draw: repeats.draw };
                let solution = Solution { sample, iteration, log_p: state.log_p().value() };
                all.push(Found { first, solution, look, state: states.then(|| state.clone()) });
            }
            Ok(())
        })?;
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::farthest_first;

    #[test]
    fn each_is_the_farthest_from_those_before() {
        let places = [0.0_f64, 1.0, 9.0, 10.0, 4.0];
        let order = |count| farthest_first(5, 0, count, |a, b| (places[a] - places[b]).abs());
        assert_eq!(order(3), [0, 3, 4]);
        assert_eq!(order(9).len(), 5);
        let mut all = farthest_first(4, 2, 4, |_, _| 0.0);
        all.sort_unstable();
        assert_eq!(all, [0, 1, 2, 3]);
    }
}
