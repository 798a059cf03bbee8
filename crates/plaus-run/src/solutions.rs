//! The distinct solutions of a run: those that a gallery shows, and that `--all-distinct` exports.

use crate::error::RunFileError;
use crate::read::RunReader;
use crate::sample_id::SampleId;
use plaus_mcmc::SolutionClass;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

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

/// One solution of each class, ordered by iteration, then chain: the first that was recorded. If the run looks for
/// solutions, those of the warm-up are included; their samples say so.
///
/// # Errors
/// [`RunFileError`] if the records are damaged.
pub fn distinct(run: &RunReader<'_>) -> Result<Vec<Solution>, RunFileError> {
    let parts: Vec<BTreeMap<SolutionClass, Solution>> = run.each_chain(|chain| of_chain(run, chain))?;
    Ok(firsts(parts.into_iter().flatten().collect()))
}

/// The first of each class, in the order in which they were found.
fn firsts(mut all: Vec<(SolutionClass, Solution)>) -> Vec<Solution> {
    all.sort_by_key(|(class, solution)| (*class, solution.iteration, solution.sample));
    all.dedup_by_key(|(class, _)| *class);
    let mut solutions: Vec<Solution> = all.into_iter().map(|(_, solution)| solution).collect();
    solutions.sort_by_key(|solution| (solution.iteration, solution.sample));
    solutions
}

fn of_chain(run: &RunReader<'_>, chain: u32) -> Result<BTreeMap<SolutionClass, Solution>, RunFileError> {
    let mut firsts = BTreeMap::new();
    for &phase in run.counted() {
        run.walk(chain, phase, |repeats| -> Result<(), RunFileError> {
            if let Some(Entry::Vacant(place)) = repeats.entry.class.map(|class| firsts.entry(class)) {
                place.insert(Solution {
                    sample: SampleId { chain, phase, draw: repeats.draw },
                    iteration: run.iteration_of(phase, repeats.draw),
                    log_p: repeats.entry.state.log_p().value(),
                });
            }
            Ok(())
        })?;
    }
    Ok(firsts)
}
