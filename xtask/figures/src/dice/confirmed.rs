//! Solutions sampled at one accuracy and simulated again at the reference's.

use super::{ONE, Thrown};
use crate::clock::seconds;
use crate::report::table;
use crate::stats::Estimate;
use crate::stats::shown;
use crate::{Result, Work};
use plaus_dist::Seed;
use plaus_mcmc::{Chain, Goal, State, StateOf};
use plaus_scenes::dice::{Dice, Work as Memory};
use plaus_scenes::{AccuracyPreset, Scene};
use rayon::prelude::*;

/// Iterations between two solutions that are taken.
const APART: u64 = 50;
const CHAINS: usize = 10;

pub(super) fn make(work: &mut Work) -> Result<()> {
    let wanted = work.size(200, 2);
    let mut rows = Vec::new();
    let presets = [AccuracyPreset::Draft, AccuracyPreset::Standard, AccuracyPreset::Fine];
    for preset in presets.into_iter().take(work.size(3, 2)) {
        work.say(format_args!("reference accuracy: {wanted} solutions sampled at {}", preset.name()));
        let thrown = Thrown::new(ONE, |config| config.accuracy = preset)?;
        let reference =
            thrown.scene.at_accuracy(AccuracyPreset::Reference)?.ok_or("the scene has no accuracy to choose")?;
        let found = (0..CHAINS as u64).into_par_iter().map(|chain| solutions(&thrown, chain, wanted, work.quick));
        let found = found.collect::<Result<Vec<_>>>()?;
        let spent: f64 = found.iter().map(|(_, seconds, _)| seconds).sum();
        let iterations: u64 = found.iter().map(|(_, _, iterations)| iterations).sum();
        let solutions: Vec<StateOf<Dice>> = found.into_iter().flat_map(|(states, ..)| states).collect();
        let again = |solution: &StateOf<Dice>| -> Result<(bool, bool, f64)> {
            let state = State::evaluate(&reference, solution.draw.clone(), &mut Memory::default())?;
            let off = (state.outcome.trips[0].position - solution.outcome.trips[0].position).length() * 1e3;
            Ok((reference.class(state.by_ref()).is_some(), state.outcome.faces == solution.outcome.faces, off))
        };
        let again = solutions.par_iter().map(again).collect::<Result<Vec<_>>>()?;
        let share = |is: fn(&(bool, bool, f64)) -> bool| {
            let share = Estimate::of(again.iter().filter(|row| is(row)).count(), again.len());
            format!("{:.1} ± {:.1}%", 100.0 * share.value, 100.0 * share.error)
        };
        rows.push(vec![
            preset.name().to_owned(),
            again.len().to_string(),
            share(|row| row.0),
            share(|row| row.1),
            share(|row| row.2 < 1.0),
            shown(1e3 * spent / iterations as f64, 3),
        ]);
    }
    let head = [
        "sampled at",
        "solutions",
        "hold at reference accuracy",
        "the same face",
        "the same place within 1 mm",
        "ms an iteration",
    ];
    let text = table(&head, rows)
        + &format!(
            "\n`scenarios/dice-one.toml`: solutions of {CHAINS} exact chains, at least {APART} iterations apart, simulated again at reference accuracy. A die touches the table some forty times, and each contact multiplies \
             what differs, so a finer accuracy moves the share only once its errors stay small up to the last contact. `plaus sample --confirm` keeps those that hold.\n"
        );
    work.report.section("Dice: solutions at reference accuracy", &text);
    Ok(())
}

/// Solutions of one chain, with its time and iterations.
fn solutions(thrown: &Thrown, chain: u64, wanted: usize, quick: bool) -> Result<(Vec<StateOf<Dice>>, f64, u64)> {
    let each = wanted.div_ceil(CHAINS);
    let begin = seconds();
    let mut chain = Chain::start(&thrown.scene, &thrown.moves, Seed(20).chain(chain))?;
    let (mut found, mut next) = (Vec::new(), 0);
    while found.len() < each && chain.iteration() < if quick { 2 } else { 200_000 } {
        chain.step()?;
        if chain.iteration() >= next && (quick || thrown.scene.class(chain.state().by_ref()).is_some()) {
            found.push(chain.state().clone());
            next = chain.iteration() + APART;
        }
    }
    Ok((found, seconds() - begin, chain.iteration()))
}
