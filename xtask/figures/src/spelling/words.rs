//! Words of one to eight letters: how the time to the first full word grows with the number of balls.

use super::chains::{Length, Word};
use super::hi;
use crate::canvas::{self, HPos, bold, colour, pen, px, text, write};
use crate::plot::{Axes, curve, plain, power};
use crate::report::{significant, table};
use crate::stats::shown;
use crate::{Result, Work};
use plaus_dist::math;
use plaus_scenes::spelling::usual_ln_lambda;
use plotters::prelude::*;

const WORDS: [&str; 8] = ["I", "HI", "ACM", "DICE", "HELLO", "BOUNCE", "MARBLES", "SOLUTION"];
const SIZE: (u32, u32) = (900, 560);

/// One word.
struct Row {
    text: &'static str,
    bins: usize,
    ln_lambda: f64,
    found: usize,
    /// Median and worst.
    iterations: [f64; 2],
    seconds: [f64; 2],
    /// Microseconds per iteration.
    pace: f64,
}

pub(super) fn make(work: &mut Work) -> Result<()> {
    let (seeds, limit) = (work.size(15, 1), work.size(60_000, 150));
    let words = &WORDS[..work.size(8, 3)];
    let mut rows = Vec::new();
    for text in words {
        let bins = hi(|config| config.text = Some((*text).into()))?.bins();
        let ln_lambda = usual_ln_lambda(bins);
        work.say(format_args!(
            "words: {text}, {bins} balls, ln λ = {ln_lambda:.2}: {seeds} chains until the first full word"
        ));
        let word: Word = hi(|config| config.text = Some((*text).into()))?;
        let chains = word.run(Length { seeds, iterations: limit, until_first: true })?;
        let (time, steps) = chains.0.iter().fold((0.0, 0), |sum, seen| (sum.0 + seen.seconds, sum.1 + seen.iterations));
        rows.push(Row {
            text,
            bins,
            ln_lambda,
            found: chains.found(),
            iterations: [0.5, 1.0].map(|q| chains.quantile(q, |seen| seen.first_iteration())),
            seconds: [0.5, 1.0].map(|q| chains.quantile(q, |seen| seen.first_second())),
            pace: 1e6 * time / steps as f64,
        });
    }
    rows.sort_by_key(|row| row.bins);
    canvas::save(&work.out, "words", SIZE, |area| draw(area, &rows))?;
    work.report.figure(
        "words",
        format!(
            "Processor time to the first full word against the number of balls, words of one to {} letters (short font): median and worst of {seeds} seeds. ln λ = 5 + 2.25 ln(N/10) / ln 3 for N \
             bins, the power law through the paper's choices for HI and ACM: the more bins, the more ways to miss one.",
            words.len()
        ),
    );
    let cells = rows.iter().map(|row| {
        vec![
            row.text.to_owned(),
            row.bins.to_string(),
            format!("{:.2}", row.ln_lambda),
            format!("{} of {seeds}", row.found),
            row.iterations.map(|value| shown(value, 3)).join(" / "),
            row.seconds.map(|value| shown(value, 2)).join(" / "),
            shown(row.pace, 3),
        ]
    });
    let head =
        ["word", "balls", "ln λ", "found", "first full word, iterations (median / worst)", "s", "µs an iteration"];
    let exponent = slope(&rows);
    let mut text = table(&head, cells);
    if let Some(exponent) = exponent {
        text += &format!(
            "\nFrom the second word on, the median time grows about like the power {} of the number of balls (least squares of the logarithms).\n",
            significant(exponent, 2)
        );
    }
    work.report.section("Words of one to eight letters", &text);
    Ok(())
}

/// Least squares of log time over log balls, without the first word and without words that were never found.
fn slope(rows: &[Row]) -> Option<f64> {
    let points: Vec<(f64, f64)> = rows
        .iter()
        .skip(1)
        .filter(|row| row.seconds[0].is_finite())
        .map(|row| (math::ln(row.bins as f64), math::ln(row.seconds[0])))
        .collect();
    let count = points.len() as f64;
    let mean = points.iter().fold((0.0, 0.0), |sum, p| (sum.0 + p.0 / count, sum.1 + p.1 / count));
    let (xy, xx) = points
        .iter()
        .fold((0.0, 0.0), |sum, p| (sum.0 + (p.0 - mean.0) * (p.1 - mean.1), sum.1 + math::square(p.0 - mean.0)));
    (points.len() >= 3 && xx > 0.0).then(|| xy / xx)
}

/// Where a label stands, in the units of the axes.
struct Label {
    x: [f64; 2],
    /// Its upper edge.
    y: f64,
}

/// Width of a capital letter relative to the plot's, and height of a line relative to the plot's, both with some space.
const LETTER: f64 = 0.0125;
const LINE: f64 = 0.035;

/// The room that a dot takes.
fn dot(at: (f64, f64), letter: f64, line: f64) -> Label {
    Label { x: [at.0 - 0.5 * letter, at.0 + 0.5 * letter], y: at.1 + 0.5 * line }
}

/// The upper edge of a new label: at `y`, or as much lower as necessary to be clear of the other labels.
fn clear_of(labels: &[Label], x: [f64; 2], y: f64, line: f64) -> f64 {
    // A label exactly one line away may be nearer by rounding; it does not cover the new one.
    let near = line * (1.0 - 1e-9);
    let covers = |label: &&Label, y: f64| label.x[0] < x[1] && x[0] < label.x[1] && (label.y - y).abs() < near;
    let mut y = y;
    while let Some(label) = labels.iter().find(|label| covers(label, y)) {
        y = label.y - line;
    }
    y
}

fn draw(area: &canvas::Area<'_>, rows: &[Row]) -> Result<()> {
    write(area, "Time to the first full word", &bold(20.0, colour::INK), HPos::Left, (24.0, 28.0))?;
    let (_, plot) = area.split_vertically(px(50.0));
    let most = rows.iter().map(|row| row.bins).max().unwrap_or(10) as f64;
    let finite = || rows.iter().flat_map(|row| row.seconds).filter(|s| s.is_finite() && *s > 0.0).map(math::log10);
    let (low, high) = (finite().fold(0.0, f64::min).floor(), finite().fold(0.0, f64::max).ceil().max(1.0));
    let mut chart = Axes {
        title: "",
        x: 0.0..most * 1.08,
        y: low..high,
        x_label: "balls (bins to fill)",
        y_label: "seconds of one core",
        ticks: (10, (high - low) as usize + 1),
        x_text: &plain,
        y_text: &power,
    }
    .draw(&plot)?;
    let points = |which: usize| -> Vec<(f64, f64)> {
        let found = rows.iter().filter(|row| row.seconds[which].is_finite());
        found.map(|row| (row.bins as f64, math::log10(row.seconds[which]))).collect()
    };
    curve(&mut chart, &points(1), pen(colour::FAINT, 1.5))?;
    curve(&mut chart, &points(0), pen(colour::OURS, 2.5))?;
    let (letter, line) = (LETTER * most * 1.08, LINE * (high - low));
    let mut labels: Vec<Label> = points(0).into_iter().map(|at| dot(at, letter, line)).collect();
    for row in rows.iter().filter(|row| row.seconds[0].is_finite()) {
        let at = (row.bins as f64, math::log10(row.seconds[0]));
        chart.draw_series([Circle::new(at, px(4.0), colour::OURS.filled())])?;
        let half = 0.5 * letter * row.text.len() as f64;
        let y = clear_of(&labels, [at.0 - half, at.0 + half], at.1 - line, line);
        labels.push(Label { x: [at.0 - half, at.0 + half], y });
        let style =
            text(12.0, colour::INK).pos(plotters::style::text_anchor::Pos::new(HPos::Center, canvas::VPos::Top));
        chart.draw_series([Text::new(row.text.to_owned(), (at.0, y), style)])?;
    }
    write(&plot, "median", &text(13.0, colour::OURS), HPos::Left, (90.0, 24.0))?;
    write(&plot, "worst seed", &text(13.0, colour::FAINT), HPos::Left, (90.0, 44.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_do_not_cover_each_other() {
        let mut labels: Vec<Label> = Vec::new();
        for x in [1.0, 1.5, 2.0, 9.0] {
            let y = clear_of(&labels, [x - 1.0, x + 1.0], -0.1 * x, 1.0);
            labels.push(Label { x: [x - 1.0, x + 1.0], y });
        }
        let tops: Vec<f64> = labels.iter().map(|label| label.y).collect();
        assert_eq!(tops, [-0.1, -1.1, -2.1, -0.9]);
        // A dot two units to the right lies where the first of its labels would be.
        let dots = [(0.0, 0.0), (2.0, -1.2)].map(|at| dot(at, 1.0, 1.0));
        let y = clear_of(&dots, [-3.0, 3.0], -1.0, 1.0);
        assert_eq!(y, -1.7, "below the dot, which ends there");
    }

    /// Whatever rounding does to a distance of one line, a place is found, and it is one line below.
    #[test]
    fn a_place_is_found_at_any_height() {
        let line = 0.035 * 4.0;
        for k in 0..10_000 {
            let above = Label { x: [0.0, 1.0], y: -2.0 + 3e-4 * f64::from(k) };
            let y = clear_of(std::slice::from_ref(&above), [0.0, 1.0], above.y - 0.5 * line, line);
            assert!((above.y - y - line).abs() < 1e-9, "{y} below {}", above.y);
        }
    }
}
