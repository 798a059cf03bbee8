//! Solutions simulated again at the reference accuracy: how many still spell their word.

use super::chains::Word;
use super::{acm, hi};
use crate::report::table;
use crate::stats::shown;
use crate::{Result, Work};
use plaus_dist::Seed;
use plaus_mcmc::{Chain, Goal, State};
use plaus_scenes::spelling::{Spelling, Work as Memory};
use plaus_scenes::{AccuracyPreset, Scene};
use rayon::prelude::*;

/// Iterations between two solutions that are taken.
const APART: u64 = 500;

pub(super) fn make(work: &mut Work) -> Result<()> {
    let wanted = work.size(100, 3);
    let mut rows = Vec::new();
    for (name, word) in [("HI", hi(|_| ())?), ("ACM", acm(|_| ())?)] {
        work.say(format_args!("reference accuracy: {wanted} full words of {name}"));
        let solutions = solutions(&word, wanted, work.size(APART, 5))?;
        for accuracy in [AccuracyPreset::Draft, AccuracyPreset::Fine, AccuracyPreset::Reference] {
            let scene = word.scene.at_accuracy(accuracy)?.ok_or("the scene has no accuracy to choose")?;
            let again = |solution: &plaus_mcmc::StateOf<Spelling>| -> Result<[f64; 4]> {
                let state = State::evaluate(&scene, solution.draw.clone(), &mut Memory::default())?;
                let filled = scene.filled(&state.outcome);
                let balls = solution.outcome.bins.iter().zip(&state.outcome.bins);
                let same = balls.filter(|(a, b)| a == b).count() as f64 / state.outcome.bins.len() as f64;
                let class = scene.class(state.by_ref());
                let holds = f64::from(u8::from(class.is_some()));
                let whole = f64::from(u8::from(class.is_some() && class == word.scene.class(solution.by_ref())));
                let missing = word.bins() - filled;
                Ok([holds, whole, same, f64::from(u8::from(missing > 1))])
            };
            let found = solutions.par_iter().map(again).collect::<Result<Vec<_>>>()?;
            let sum = |k: usize| found.iter().map(|row| row[k]).sum::<f64>();
            rows.push(vec![
                name.to_owned(),
                accuracy.name().to_owned(),
                format!("{} of {}", sum(0), solutions.len()),
                format!("{}", sum(1)),
                shown(100.0 * sum(2) / solutions.len() as f64, 3) + "%",
                format!("{}", sum(3)),
            ]);
        }
    }
    let head = [
        "word",
        "simulated again at",
        "still full",
        "every ball in the same bin",
        "balls in the same bin",
        "two bins or more empty",
    ];
    let text = table(&head, rows)
        + &format!(
            "\nFull words of exact chains at standard accuracy (seeds 0, 1, …; at least {APART} iterations apart). Their last bounces depend on the size of the steps in which lasting \
             contact is solved, and balls that hit each other amplify any difference, so some draws spell only as they \
             were simulated. `plaus sample --confirm` makes this check for all \
             distinct solutions of a run and lists those that hold; to sample at a finer accuracy, set `accuracy`.\n"
        );
    work.report.section("Solutions at reference accuracy", &text);
    Ok(())
}

/// Full words of several chains, far apart in each.
fn solutions(word: &Word, wanted: usize, apart: u64) -> Result<Vec<plaus_mcmc::StateOf<Spelling>>> {
    const CHAINS: usize = 10;
    let each = wanted.div_ceil(CHAINS);
    let of_chain = |seed: u64| -> Result<Vec<_>> {
        let mut chain = Chain::start(&word.scene, &word.moves, Seed(seed).chain(0))?;
        let (mut found, mut next) = (Vec::new(), 0);
        while found.len() < each && chain.iteration() < 1_000_000 {
            chain.step()?;
            if chain.iteration() >= next && word.scene.class(chain.state().by_ref()).is_some() {
                found.push(chain.state().clone());
                next = chain.iteration() + apart;
            }
        }
        Ok(found)
    };
    let chains = wanted.min(CHAINS) as u64;
    let found = (0..chains).into_par_iter().map(of_chain).collect::<Result<Vec<_>>>()?;
    Ok(found.into_iter().flatten().take(wanted).collect())
}
