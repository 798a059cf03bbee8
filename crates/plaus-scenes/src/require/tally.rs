//! Why nothing was found: how often each requirement was met, and which were never met together.

use super::ended::Ends;
use super::score::Mark;
use crate::scene::Scene;
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::{Failures, ModelError, State, StateRefOf};

/// How often to try for a draw that the prior allows.
const TRIES: u64 = 1000;

/// Counts for one thing that is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Clause {
    /// Its name.
    pub name: String,
    /// How many states met it.
    pub met: u64,
    /// The best of all margins; −∞ if there was no state.
    pub best: f64,
    /// What the first of the states with that margin lacks ([`Scene::lacks`]).
    pub lacks: String,
}

/// Counts for everything that is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Tally {
    /// Number of states.
    pub states: u64,
    /// Number of states that met everything.
    pub all: u64,
    /// One clause for each thing that is asked for.
    pub clauses: Vec<Clause>,
    /// Which of the states are those of simulations that failed.
    pub failures: Failures,
    /// How the simulations of states ended, as far as the scene tells; of a run's states, those that were simulated
    /// again.
    pub ends: Ends,
    /// How many states met both of two clauses; the pair `a < b` is at `b (b − 1) / 2 + a`.
    both: Vec<u64>,
}

impl Tally {
    /// An empty tally for clauses with these names.
    #[must_use]
    pub fn new(names: Vec<String>) -> Self {
        let clauses: Vec<Clause> = names
            .into_iter()
            .map(|name| Clause { name, met: 0, best: f64::NEG_INFINITY, lacks: String::new() })
            .collect();
        let pairs = clauses.len() * clauses.len().saturating_sub(1) / 2;
        Self { states: 0, all: 0, clauses, failures: Failures::default(), ends: Ends::default(), both: vec![0; pairs] }
    }

    /// Tallies draws from a scene's prior: `draws` of those that the prior allows, from streams of `seed`. `go_on` gets
    /// the number done so far, and says whether to continue.
    ///
    /// # Errors
    /// [`ModelError`] if a simulation fails.
    pub fn of_prior<S: Scene>(
        scene: &S,
        seed: u64,
        draws: u64,
        mut go_on: impl FnMut(u64) -> bool,
    ) -> Result<Self, ModelError> {
        let mut tally = Self::new(scene.asked());
        each_of_prior(scene, seed, draws, |nth, state, scratch| {
            tally.add(scene, state);
            tally.ended(scene, state, scratch);
            go_on(nth + 1)
        })?;
        Ok(tally)
    }

    /// Adds a state.
    pub fn add<S: Scene>(&mut self, scene: &S, state: StateRefOf<'_, S>) {
        self.failures.note((self.states, 0), scene.failure(state.outcome));
        let marks = scene.answers(state);
        for thing in self.count(&marks) {
            self.clauses[thing].lacks = scene.lacks(thing, state);
        }
    }

    /// Adds how a state's simulation ended, which is the last of this memory.
    pub fn ended<S: Scene>(&mut self, scene: &S, state: StateRefOf<'_, S>, scratch: &S::Scratch) {
        scene.ended(state, scratch).into_iter().for_each(|ended| self.ends.add(ended));
    }

    /// Counts a state, given a mark for each thing that is asked for. Gives those which no state had met so far, and
    /// which this one misses least.
    fn count(&mut self, marks: &[Mark]) -> Vec<usize> {
        let mut nearest = Vec::new();
        self.states += 1;
        self.all += u64::from(marks.iter().all(Mark::met));
        for (b, (clause, mark)) in self.clauses.iter_mut().zip(marks).enumerate() {
            clause.met += u64::from(mark.met());
            if mark.margin > clause.best {
                clause.best = mark.margin;
                nearest.extend((!mark.met()).then_some(b));
            }
            for a in (0..b).filter(|&a| mark.met() && marks[a].met()) {
                self.both[b * (b - 1) / 2 + a] += 1;
            }
        }
        nearest
    }

    /// Pairs whose members were each met, but never in one state.
    #[must_use]
    pub fn never_together(&self) -> Vec<[&str; 2]> {
        let pairs = (1..self.clauses.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
        let apart = pairs.filter(|&(a, b)| {
            self.clauses[a].met > 0 && self.clauses[b].met > 0 && self.both[b * (b - 1) / 2 + a] == 0
        });
        apart.map(|(a, b)| [self.clauses[a].name.as_str(), self.clauses[b].name.as_str()]).collect()
    }
}

/// Passes the states of up to so many draws from the prior to `look`, with their numbers and the memory in which they
/// were simulated, until it returns false.
///
/// # Errors
/// [`ModelError`] if a draw cannot be simulated.
pub fn each_of_prior<S: Scene>(
    scene: &S,
    seed: u64,
    draws: u64,
    mut look: impl FnMut(u64, StateRefOf<'_, S>, &S::Scratch) -> bool,
) -> Result<(), ModelError> {
    let (streams, mut scratch) = (Seed(seed).chain(0), S::Scratch::default());
    for nth in 0..draws {
        let mut stream = streams.at(nth, Purpose::START);
        for _ in 0..TRIES {
            let draw = scene.start(&mut stream);
            if !scene.log_prior(&draw)?.is_zero() {
                let state = State::evaluate(scene, draw, &mut scratch)?;
                if !look(nth, state.by_ref(), &scratch) {
                    return Ok(());
                }
                break;
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requirements_never_met_together_are_found() {
        let mut tally = Tally::new(["a", "b", "c", "d"].map(String::from).to_vec());
        for margins in [[1.0, -1.0, 0.0, -3.0], [-1.0, 2.0, 1.0, -2.0]] {
            tally.count(&margins.map(Mark::of));
        }
        assert_eq!((tally.states, tally.all), (2, 0));
        assert_eq!(tally.clauses.iter().map(|clause| clause.met).collect::<Vec<_>>(), [1, 1, 2, 0]);
        assert_eq!(tally.clauses[3].best, -2.0);
        assert_eq!(tally.never_together(), [["a", "b"]]);
    }
}
