//! How soon chains find what is required in the worlds of scenario files. For each file: the share of draws of the
//! prior in which it happens, then iterations and processor time to the first solution and to ten distinct ones.
//!
//!     cargo run --release -p plaus-scenes --example worlds -- scenarios/worlds/*.toml

#![allow(clippy::print_stdout, reason = "it is run to be read")]

mod shared;

use plaus_dist::Seed;
use plaus_mcmc::{Chain, Goal, Mixture};
use plaus_scenes::require::Tally;
use plaus_scenes::{Scenario, Scene, Stage};
use shared::seconds;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

/// Number of draws of the prior that are tried, and the seconds after which no more are tried.
const DRAWS: u64 = 200;
const LOOKS: f64 = 15.0;
/// Number of solutions that are waited for.
const WANTED: usize = 10;
/// Seconds of processor time after which a file is given up. The goals for two cores are half of this or less.
const PATIENCE: f64 = 180.0;

struct Look {
    seed: u64,
    chains: u64,
}

impl Look {
    fn at(&self, scene: &Stage) -> String {
        let begin = seconds();
        let tally = match Tally::of_prior(scene, self.seed, DRAWS, |_| seconds() - begin < LOOKS) {
            Ok(tally) => tally,
            Err(error) => return error.to_string(),
        };
        let each = (seconds() - begin) / tally.states as f64;
        let free = tally.clauses.first().map_or(0, |clause| clause.met);
        let prior = format!("{:.2} ms a draw, {free} of {} free, {} meet all", each * 1e3, tally.states, tally.all);
        let rules = plaus_scenes::Rules::default();
        let moves: Mixture<Stage> = match scene.moves(&rules) {
            Ok(moves) => moves,
            Err(error) => return error.to_string(),
        };
        let start = |chain| Chain::start(scene, &moves, Seed(self.seed).chain(chain));
        let mut chains = match (0..self.chains).map(start).collect::<Result<Vec<_>, _>>() {
            Ok(chains) => chains,
            Err(error) => return format!("{prior}; {error}"),
        };
        let (begin, mut found, mut first) = (seconds(), BTreeSet::new(), None);
        for iteration in 1.. {
            for chain in &mut chains {
                if let Err(error) = chain.step() {
                    return format!("{prior}; {error}");
                }
                let Some(class) = scene.class(chain.state().by_ref()) else { continue };
                first.get_or_insert((iteration, seconds() - begin));
                found.insert(class);
            }
            if found.len() >= WANTED || seconds() - begin > PATIENCE {
                let taken = seconds() - begin;
                let first = first.map_or("no solution".into(), |(at, s)| format!("first after {at} ({s:.1} s)"));
                return format!("{prior}; {first}; {} distinct after {iteration} ({taken:.1} s)", found.len());
            }
        }
        prior
    }
}

/// The files beside the scenario at a path.
fn beside(path: &str) -> impl Fn(&str, bool) -> Result<Arc<[u8]>, String> {
    let folder = Path::new(path).parent().map(Path::to_path_buf).unwrap_or_default();
    move |file, _| std::fs::read(folder.join(file)).map(Arc::from).map_err(|error| error.to_string())
}

fn main() {
    for path in std::env::args().skip(1) {
        let said = match std::fs::read_to_string(&path).map_err(|error| error.to_string()) {
            Ok(text) => match Scenario::read_with(&path, &text, &[], &beside(&path)) {
                Ok(scenario) => {
                    let look = Look { seed: scenario.sampler.seed, chains: scenario.sampler.chains.into() };
                    scenario.stage().map_or_else(|error| error.to_string(), |scene| look.at(&scene))
                }
                Err(error) => error.to_string(),
            },
            Err(error) => error,
        };
        println!("{path}: {said}");
    }
}
