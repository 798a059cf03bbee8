//! The other half of figure 2: what the resting position does not show.

use super::{BOTH, FIGURE_SEED, FIRST_ANGLE, REST, sampler};
use crate::canvas::{self, Area, HPos, bold, colour, pen, px, text, write};
use crate::lines::numbered;
use crate::plot::{Axes, Chart, curve, dashed, plain, power};
use crate::report::significant;
use crate::sampler::Traces;
use crate::stats::Ess;
use crate::{Result, Work};
use plaus_dist::math;
use plaus_mcmc::diagnose::autocorrelation;
use plotters::prelude::*;

const SIZE: (u32, u32) = (1200, 1130);
const SPANS: [u64; 2] = [1_000, 10_000];
const COLOURS: [RGBColor; 2] = [colour::PAPER, colour::OURS];
const NAMES: [&str; 6] = ["x", "θ₁", "θ₂", "θ₃", "θ₄", "θ₅"];
/// Largest lag shown.
const LAGS: usize = 10_000;

/// What the figure shows about one kind of moves.
struct Shown {
    first_angle: Vec<f64>,
    /// Autocorrelation of x and of θ₁.
    correlations: [Vec<(f64, f64)>; 2],
    ess: Vec<Ess>,
}

pub(super) fn make(work: &mut Work, traces: &[Traces]) -> Result<()> {
    work.say("figure 2, mixing");
    let mut shown = Vec::new();
    for ((moves, _), traces) in BOTH.into_iter().zip(traces) {
        let states = sampler(moves, |_| ())?.states(FIGURE_SEED, 0, SPANS[1])?;
        shown.push(Shown {
            first_angle: states.iter().map(|state| state.draw.0[0]).collect(),
            correlations: [correlation(&traces.columns[REST])?, correlation(&traces.columns[FIRST_ANGLE])?],
            ess: traces.columns.iter().map(|chains| Ess::per_1000(chains)).collect::<std::result::Result<_, _>>()?,
        });
    }
    canvas::save(&work.out, "figure-2-mixing", SIZE, |area| draw(area, &shown))?;
    let list = |shown: &Shown| {
        let each = NAMES.iter().zip(&shown.ess).map(|(name, ess)| format!("{name} {}", ess.shown()));
        each.collect::<Vec<_>>().join(", ")
    };
    work.report.figure(
        "figure-2-mixing",
        format!(
            "What figure 2 hides. Above: the first normal's angle over 1,000 and 10,000 iterations, with the paper's move (left; the very chain of figure 2) and with \
             the default moves (right; the same start). Below: autocorrelation and effective samples per 1,000 \
             iterations, from the long chains of the table of claims. Paper's move: {}. Default moves: {}.",
            list(&shown[0]),
            list(&shown[1]),
        ),
    );
    Ok(())
}

/// (log₁₀ lag, correlation), averaged over the chains, at lags evenly spaced on the logarithmic axis.
fn correlation(chains: &[Vec<f64>]) -> Result<Vec<(f64, f64)>> {
    let mut mean = Vec::new();
    for chain in chains {
        let one = autocorrelation(chain, LAGS.min(chain.len() / 4))?.ok_or("a scalar that never changes")?;
        mean.resize(one.len(), 0.0);
        mean.iter_mut().zip(&one).for_each(|(sum, value)| *sum += value / chains.len() as f64);
    }
    let mut lags: Vec<usize> = (0..=240).map(|i| math::powf(10.0, f64::from(i) / 60.0).round() as usize).collect();
    lags.dedup();
    Ok(lags.into_iter().filter_map(|lag| Some((math::log10(lag as f64), *mean.get(lag)?))).collect())
}

fn draw(area: &Area<'_>, shown: &[Shown]) -> Result<()> {
    write(area, "What figure 2 hides: the first bounce", &bold(22.0, colour::INK), HPos::Left, (24.0, 30.0))?;
    let (_, rest) = area.split_vertically(px(58.0));
    let (traces, numbers) = rest.split_vertically(px(2.0 * 300.0));
    for (row, (line, span)) in traces.split_evenly((2, 1)).iter().zip(SPANS).enumerate() {
        for (((panel, shown), colour), name) in
            line.split_evenly((1, 2)).iter().zip(shown).zip(COLOURS).zip(["the paper's move", "default moves"])
        {
            let title = if row == 0 { format!("θ₁, {name}") } else { String::new() };
            trace(panel, &title, &shown.first_angle[..span as usize], colour)?;
        }
    }
    let numbers = numbers.split_evenly((1, 2));
    correlations(&numbers[0], shown)?;
    bars(&numbers[1], shown)
}

fn trace(area: &Area<'_>, title: &str, angle: &[f64], colour: RGBColor) -> Result<()> {
    let mut chart = Axes {
        title,
        x: 0.0..angle.len() as f64,
        y: -45.0..45.0,
        x_label: "iteration",
        y_label: "θ₁ (degrees)",
        ticks: (6, 5),
        x_text: &|x| crate::report::thousands(*x as u64),
        y_text: &plain,
    }
    .draw(area)?;
    curve(&mut chart, &numbered(angle), pen(colour, if angle.len() > 5_000 { 0.6 } else { 1.2 }))
}

fn correlations(area: &Area<'_>, shown: &[Shown]) -> Result<()> {
    let mut chart = Axes {
        title: "Autocorrelation",
        x: 0.0..4.0,
        y: -0.05..1.0,
        x_label: "lag (iterations)",
        y_label: "correlation",
        ticks: (5, 6),
        x_text: &power,
        y_text: &plain,
    }
    .draw(area)?;
    for (shown, colour) in shown.iter().zip(COLOURS) {
        dashed(&mut chart, &shown.correlations[0], pen(colour, 2.0), 5.0, 4.0)?;
        curve(&mut chart, &shown.correlations[1], pen(colour, 2.5))?;
    }
    let style = text(13.0, colour::INK);
    let entries = [
        ("θ₁, paper's move", 0, false),
        ("x, paper's move", 0, true),
        ("θ₁, default moves", 1, false),
        ("x, default moves", 1, true),
    ];
    for (row, (words, which, dash)) in (0_u8..).zip(entries) {
        let y = 44.0 + 18.0 * f64::from(row);
        let parts: &[(f64, f64)] =
            if dash { &[(0.0, 5.0), (9.0, 14.0), (18.0, 23.0), (27.0, 30.0)] } else { &[(0.0, 30.0)] };
        for (from, to) in parts {
            let ends = [(px(414.0 + from), px(y)), (px(414.0 + to), px(y))];
            area.draw(&PathElement::new(ends, pen(COLOURS[which], 2.5)))?;
        }
        write(area, words, &style, HPos::Left, (452.0, y))?;
    }
    Ok(())
}

fn bars(area: &Area<'_>, shown: &[Shown]) -> Result<()> {
    const LOW: f64 = -3.0;
    let mut chart: Chart<'_> = Axes {
        title: "Effective samples per 1,000 iterations",
        x: -0.6..5.6,
        y: LOW..3.0,
        x_label: "variable",
        y_label: "ESS per 1,000 (log scale)",
        ticks: (13, 7),
        x_text: &|x| {
            if (x - x.round()).abs() < 1e-9 {
                NAMES.get(x.round() as usize).map_or_else(String::new, |name| (*name).to_owned())
            } else {
                String::new()
            }
        },
        y_text: &power,
    }
    .draw(area)?;
    for ((shown, colour), side) in shown.iter().zip(COLOURS).zip([-0.21, 0.21]) {
        for (place, ess) in (0_u8..).zip(&shown.ess) {
            let (middle, top) = (f64::from(place) + side, math::log10(ess.value).max(LOW));
            chart.draw_series([Rectangle::new([(middle - 0.19, LOW), (middle + 0.19, top)], colour.filled())])?;
            let label =
                text(11.0, colour).pos(plotters::style::text_anchor::Pos::new(HPos::Center, canvas::VPos::Bottom));
            chart.draw_series([Text::new(significant(ess.value, 2), (middle, top + 0.04), label)])?;
        }
    }
    let style = text(13.0, colour::INK);
    for ((words, colour), x) in ["paper's move", "default moves"].into_iter().zip(COLOURS).zip([330.0, 460.0]) {
        area.draw(&Rectangle::new([(px(x), px(50.0)), (px(x + 14.0), px(62.0))], colour.filled()))?;
        write(area, words, &style, HPos::Left, (x + 20.0, 56.0))?;
    }
    Ok(())
}
