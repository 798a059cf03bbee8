//! How well chains of one die mix: R-hat and effective sample sizes of where it rests and how it was thrown.

use super::ONE;
use crate::clock::seconds;
use crate::report::{significant, table};
use crate::sampler::{Length, Sampler};
use crate::stats::Ess;
use crate::stats::shown;
use crate::{Result, Work};
use plaus_mcmc::diagnose::rhat;
use plaus_scenes::Scene;
use plaus_scenes::dice::Weights;
use plaus_scenes::model::Role;

pub(super) fn make(work: &mut Work) -> Result<()> {
    let length = Length { seed: 5, chains: 4, warmup: work.size(2000, 2), iterations: work.size(10_000, 12) };
    work.say(format_args!("mixing: 4 chains of {} iterations, with and without recasts", length.iterations));
    let mut rows = Vec::new();
    for (name, weights) in
        [("all moves", Weights::default()), ("without `recast`", Weights::default().with("recast", 0.0))]
    {
        let thrown = super::Thrown::new(ONE, |config| config.weights = weights)?;
        let sampler = Sampler::new(thrown.scene)?;
        let scalars = sampler.scene.scalars();
        let all: Vec<usize> = (0..scalars.len()).collect();
        let begin = seconds();
        let traces = rayon::ThreadPoolBuilder::new()
            .num_threads(1)
            .build()?
            .install(|| sampler.traces(length, &all).map(|traces| (traces, seconds())));
        let (traces, end) = traces?;
        let of = |index: usize| rhat(&traces.columns[index]).ok().flatten().unwrap_or(f64::NAN);
        let named = |name: &str| scalars.iter().position(|scalar| scalar.name == name).unwrap_or(0);
        let worst = (0..scalars.len()).filter(|&k| scalars[k].role == Role::Draw).map(of).fold(f64::NAN, f64::max);
        let ess = |name: &str| Ess::per_1000(&traces.columns[named(name)]).map_or("–".to_owned(), Ess::shown);
        rows.push(vec![
            name.to_owned(),
            format!("{} / {}", shown(of(named("rest_x_1")), 4), shown(of(named("rest_y_1")), 4)),
            shown(of(named("face_1")), 4),
            shown(worst, 4),
            format!("{} / {}", ess("rest_x_1"), ess("vx_1")),
            significant(traces.acceptance, 2),
            shown(if begin < end { end - begin } else { f64::NAN }, 3),
        ]);
    }
    let head = [
        "moves",
        "R-hat of the resting place, x / y",
        "of the face",
        "largest of the initial conditions",
        "effective draws per 1,000 iterations: rest x / velocity x",
        "accepted",
        "s of one core",
    ];
    let text = table(&head, rows)
        + &format!(
            "\n`scenarios/dice-one.toml`, 4 chains (seed 5) of {} iterations after {} of warm-up; R-hat is the rank-normalised split one (Vehtari et al. 2021). The goal was below 1.05 for the resting place \
             within two minutes.\n",
            length.iterations, length.warmup
        );
    work.report.section("Dice: mixing", &text);
    Ok(())
}
