//! Two bins, two balls, real physics: chains compared with weighted draws of the prior, which need no chain.

use super::straight::{Letters, scene};
use plaus_dist::{Purpose, Seed, math};
use plaus_mcmc::{Chain, State, Target, diagnose};
use plaus_scenes::spelling::{Spelling, Vertices, Work};
use plaus_scenes::{Moves, Rules, Scene};

const PRIOR_DRAWS: usize = 40_000;
const CHAINS: u64 = 4;
const ITERATIONS: usize = 12_000;

/// Of three bins only the outer two should be filled, so that there is a wrong one.
fn world(ln_lambda: f64, moves: Moves) -> Spelling {
    scene(|config| {
        config.bitmap = "#.#".into();
        (config.columns, config.rows) = (3, 1);
        config.vertices = Vertices::Crossings;
        (config.ln_lambda, config.moves) = (Some(ln_lambda), moves);
        config.sigma_mm = 0.4;
    })
}

type Value = (&'static str, fn(&Spelling, &Letters) -> f64);

fn flag(holds: bool) -> f64 {
    f64::from(u8::from(holds))
}

/// Every marginal: how many balls are dropped, how many bins are filled and by which balls, where balls are dropped,
/// and offsets with their squares.
const VALUES: [Value; 13] = [
    ("no ball", |_, state| flag(state.draw.active() == 0)),
    ("one ball", |_, state| flag(state.draw.active() == 1)),
    ("k = 0", |scene, state| flag(scene.filled(&state.outcome) == 0)),
    ("k = 1", |scene, state| flag(scene.filled(&state.outcome) == 1)),
    ("ball 0 in bin 0", |_, state| flag(state.outcome.bins[0] == Some(0))),
    ("ball 1 in bin 0", |_, state| flag(state.outcome.bins[1] == Some(0))),
    ("ball 1 in bin 1", |_, state| flag(state.outcome.bins[1] == Some(1))),
    ("ball 0 over bin 0", |_, state| flag(state.draw.balls[0].is_some_and(|at| at[0] < 20.0))),
    ("ball 0 over bin 1", |_, state| flag(state.draw.balls[0].is_some_and(|at| (20.0..40.0).contains(&at[0])))),
    ("ball 1's y", |_, state| state.draw.balls[1].map_or(0.0, |at| at[1] - 10.0)),
    ("an offset", |_, state| state.draw.offsets[1][0]),
    ("another's square", |_, state| math::square(state.draw.offsets[2][2])),
    ("all squares", |_, state| state.draw.offsets.iter().flatten().map(|x| x * x).sum()),
];

/// Mean of each value under the target, by importance sampling, with its standard error (delta method for a ratio of
/// means).
fn by_weights(scene: &Spelling, draws: &[Letters]) -> Vec<(f64, f64)> {
    let weights: Vec<f64> =
        draws.iter().map(|state| math::exp(scene.ln_lambda() * scene.filled(&state.outcome) as f64)).collect();
    let total: f64 = weights.iter().sum();
    let mean = |value: fn(&Spelling, &Letters) -> f64| {
        let mean = draws.iter().zip(&weights).map(|(state, weight)| weight * value(scene, state)).sum::<f64>() / total;
        let squares =
            draws.iter().zip(&weights).map(|(state, w)| math::square(w * (value(scene, state) - mean))).sum::<f64>();
        (mean, squares.sqrt() / total)
    };
    VALUES.iter().map(|(_, value)| mean(*value)).collect()
}

fn by_chains(scene: &Spelling) -> Vec<(f64, f64)> {
    let moves = scene.moves(&Rules::exact()).unwrap();
    let mut columns = vec![vec![Vec::with_capacity(ITERATIONS); CHAINS as usize]; VALUES.len()];
    for index in 0..CHAINS {
        let mut chain = Chain::start(scene, &moves, Seed(17).chain(index)).unwrap();
        (0..500).for_each(|_| {
            chain.step().unwrap();
        });
        for _ in 0..ITERATIONS {
            chain.step().unwrap();
            for (column, (_, value)) in columns.iter_mut().zip(VALUES) {
                column[index as usize].push(value(scene, chain.state()));
            }
        }
    }
    let summary = |chains: &Vec<Vec<f64>>| {
        let summary = diagnose::summarize(chains).unwrap();
        (summary.mean, summary.mcse_mean)
    };
    columns.iter().map(summary).collect()
}

#[test]
fn chains_agree_with_weighted_draws_in_every_marginal() {
    let free = world(0.0, Moves::Mixed);
    let (mut stream, mut work) = (Seed(5).chain(0).at(0, Purpose::START), Work::default());
    let draws: Vec<Letters> =
        (0..PRIOR_DRAWS).map(|_| State::evaluate(&free, free.start(&mut stream), &mut work).unwrap()).collect();
    for ln_lambda in [1.0, 3.0] {
        let weighted = by_weights(&world(ln_lambda, Moves::Mixed), &draws);
        for moves in [Moves::Mixed, Moves::Paper] {
            let chains = by_chains(&world(ln_lambda, moves));
            for ((name, _), (a, b)) in VALUES.iter().zip(weighted.iter().zip(&chains)) {
                let error = math::hypot(a.1, b.1);
                // 52 comparisons at 5.3 standard errors; the chains' errors are themselves known only to a few per
                // cent.
                let z = (a.0 - b.0) / error;
                assert!(z.abs() < 5.3, "{name}, ln λ = {ln_lambda}, {moves:?}: {a:?} by weights, {b:?} by chains");
            }
        }
    }
}
