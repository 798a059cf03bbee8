//! Figures 6 and 7: k and log p over twenty thousand iterations of the paper's moves, as printed and exact.

use super::chains::Word;
use crate::canvas::{self, Area, HPos, bold, colour, pen, px, text, write};
use crate::lines::numbered;
use crate::plot::{Axes, curve, plain};
use crate::report::thousands;
use crate::{Result, Work};
use plaus_dist::Seed;
use plaus_mcmc::Chain;
use plaus_scenes::rules::Preset;
use plaus_scenes::spelling::Config;
use plaus_scenes::{Moves, Rules};
use plotters::prelude::*;

const SEED: u64 = 1;
const SIZE: (u32, u32) = (1200, 760);
const KINDS: [(Preset, &str, RGBColor); 2] =
    [(Preset::AsPrinted, "acceptance as printed", colour::PAPER), (Preset::Exact, "exact acceptance", colour::OURS)];

/// The paper's moves for HI.
pub(super) fn paper(preset: Preset) -> Result<Word> {
    let config = Config { moves: Moves::Paper, ..Config::default() };
    Word::with_rules(&config, &Rules { preset, ..Rules::default() })
}

/// One chain.
struct Trace {
    k: Vec<f64>,
    log_p: Vec<f64>,
    /// Iterations at which k fell by half of the word or more, and whether log p rose.
    drops: Vec<(usize, bool)>,
}

fn trace(word: &Word, iterations: u64) -> Result<Trace> {
    let mut chain = Chain::start(&word.scene, &word.moves, Seed(SEED).chain(0))?;
    let mut trace = Trace { k: Vec::new(), log_p: Vec::new(), drops: Vec::new() };
    let sharp = word.bins().div_ceil(2) as f64;
    for iteration in 0..iterations {
        let state = chain.state();
        let (k, log_p) = (word.scene.reward(&state.outcome) as f64, state.log_p().value());
        if let (Some(before), Some(then)) = (trace.k.last(), trace.log_p.last())
            && before - k >= sharp
        {
            trace.drops.push((iteration as usize, log_p > *then));
        }
        trace.k.push(k);
        trace.log_p.push(log_p);
        chain.step()?;
    }
    Ok(trace)
}

pub(super) fn make(work: &mut Work) -> Result<()> {
    let iterations = work.size(20_000, 1_000);
    work.say(format_args!(
        "figures 6 and 7: {iterations} iterations of the paper's moves, as printed and exact, seed {SEED}"
    ));
    let words = KINDS.map(|(preset, ..)| paper(preset));
    let traces = words.into_iter().map(|word| trace(&word?, iterations)).collect::<Result<Vec<_>>>()?;
    let lowest = traces.iter().flat_map(|trace| &trace.log_p).copied().fold(f64::INFINITY, f64::min);
    let highest = traces.iter().flat_map(|trace| &trace.log_p).copied().fold(f64::NEG_INFINITY, f64::max);
    let range = |low: f64, high: f64| low - 0.05 * (high - low)..high + 0.05 * (high - low);
    let figures = [
        ("figure-6", "k, the number of designated bins that are filled", "k", 0.0..10.4),
        ("figure-7", "log p(A), up to a constant", "log p (nats)", range(lowest, highest)),
    ];
    for (name, title, label, y) in figures {
        canvas::save(&work.out, name, SIZE, |area| {
            write(
                area,
                &format!("{title}, over {} iterations of HI", thousands(iterations)),
                &bold(20.0, colour::INK),
                HPos::Left,
                (24.0, 28.0),
            )?;
            let (_, plots) = area.split_vertically(px(52.0));
            for ((panel, trace), (_, kind, ink)) in plots.split_evenly((2, 1)).iter().zip(&traces).zip(KINDS) {
                let values = if name == "figure-6" { &trace.k } else { &trace.log_p };
                panel_of(panel, (kind, label), values, &trace.drops, (y.clone(), ink))?;
            }
            Ok(())
        })?;
    }
    let said = |trace: &Trace| {
        let risen = trace.drops.iter().filter(|(_, risen)| *risen).count();
        let first = trace.k.iter().position(|&k| k >= 10.0).map_or("none".to_owned(), |at| thousands(at as u64));
        format!(
            "first full word at iteration {first}, {} sharp drops, at {risen} of which log p rises",
            trace.drops.len()
        )
    };
    let (printed, exact) = (said(&traces[0]), said(&traces[1]));
    work.report.figure(
        "figure-6",
        format!(
            "As the paper's figure 6: k over the first {} iterations of a chain with the paper's five moves at λ = e⁵ (seed {SEED}, chain 0, not chosen), accepted as printed (above) and \
             exactly (below). Dashed lines mark sharp drops: k falls by five or more in one iteration. As printed: {printed}. Exact: {exact}.",
            thousands(iterations)
        ),
    );
    work.report.figure(
        "figure-7",
        "As the paper's figure 7: log p of the same two chains, with the same iterations marked. As printed, log p sinks below what fresh vertices have, until a \
         change of everything lifts it at the price of the word; exactly, it stays where the prior has its mass, and nothing is to be gained."
            .to_owned(),
    );
    Ok(())
}

fn panel_of(
    area: &Area<'_>,
    (title, label): (&str, &str),
    values: &[f64],
    drops: &[(usize, bool)],
    (y, ink): (std::ops::Range<f64>, RGBColor),
) -> Result<()> {
    let mut chart = Axes {
        title,
        x: 0.0..values.len() as f64,
        y: y.clone(),
        x_label: "iteration",
        y_label: label,
        ticks: (11, 6),
        x_text: &|x| thousands(*x as u64),
        y_text: &plain,
    }
    .draw(area)?;
    for &(at, _) in drops {
        let line = vec![(at as f64, y.start), (at as f64, y.end)];
        chart.draw_series(DashedLineSeries::new(line, px(5.0), px(4.0), pen(colour::NORMAL, 1.0)))?;
    }
    curve(&mut chart, &numbered(values), pen(ink, 0.8))?;
    if drops.is_empty() {
        write(area, "no sharp drop", &text(13.0, colour::FAINT), HPos::Right, (1180.0, 14.0))?;
    }
    Ok(())
}
