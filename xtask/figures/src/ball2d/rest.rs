//! Figure 2: where the ball rests in the first thousand samples of a chain.

use super::{FIGURE_SEED, sampler};
use crate::canvas::{self, Area, HPos, bold, colour, pen, text, write};
use crate::lines::numbered;
use crate::plot::{Axes, band, curve, plain};
use crate::{Result, Work};
use plaus_scenes::Moves;

const SAMPLES: u64 = 1000;
const SIZE: (u32, u32) = (1200, 520);
const RANGE: (f64, f64) = (0.4, 1.6);

pub(super) fn make(work: &mut Work) -> Result<()> {
    work.say(format_args!("figure 2: {SAMPLES} iterations of one chain with the paper's move, seed {FIGURE_SEED}"));
    let sampler = sampler(Moves::Paper, |_| ())?;
    let rest: Vec<f64> = sampler.states(FIGURE_SEED, 0, SAMPLES)?.iter().filter_map(|state| state.outcome.x).collect();
    let near = |x: &f64| (x - 1.0).abs() < 0.1;
    let arrives = rest.iter().position(near);
    let arrival = arrives.map_or("never".to_owned(), |iteration| format!("at iteration {iteration}"));
    let share = rest.iter().filter(|x| near(x)).count();
    let note = format!(
        "starts at x = {:.2} D{}, first within 0.1 D of the target {arrival}; {share} of {SAMPLES} samples are within 0.1 D",
        rest[0],
        if rest[0] < RANGE.0 || rest[0] > RANGE.1 { " (off the graph)" } else { "" },
    )
    .replace('-', "−");
    canvas::save(&work.out, "figure-2", SIZE, |area| draw(area, &rest, &note))?;
    work.report.figure(
        "figure-2",
        format!(
            "The resting position of the first {SAMPLES} samples of a chain with the paper's move (seed {FIGURE_SEED}, chain 0: not chosen for its looks), \
             as the paper's figure 2. It {note}. What it does not show is in the next figure."
        ),
    );
    Ok(())
}

fn draw(area: &Area<'_>, rest: &[f64], note: &str) -> Result<()> {
    write(
        area,
        "Resting position over the first 1,000 iterations, the paper's move",
        &bold(20.0, colour::INK),
        HPos::Left,
        (24.0, 28.0),
    )?;
    write(area, note, &text(14.0, colour::INK), HPos::Left, (24.0, 54.0))?;
    let (_, plot) = area.split_vertically(canvas::px(66.0));
    let mut chart = Axes {
        title: "",
        x: 0.0..rest.len() as f64,
        y: RANGE.0..RANGE.1,
        x_label: "iteration",
        y_label: "resting position x (ball diameters D)",
        ticks: (11, 7),
        x_text: &plain,
        y_text: &plain,
    }
    .draw(&plot)?;
    band(&mut chart, 0.9, 1.1, colour::TARGET)?;
    curve(&mut chart, &[(0.0, 1.0), (rest.len() as f64, 1.0)], pen(colour::TARGET, 1.5))?;
    curve(&mut chart, &numbered(rest), pen(colour::PAPER, 1.2))?;
    let label = text(13.0, colour::TARGET);
    write(&plot, "target ± 0.1 D", &label, HPos::Right, (1180.0, 16.0))
}
