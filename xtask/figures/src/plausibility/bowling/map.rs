//! Strike rate over board and angle of entry.

use super::SEED;
use super::published::{BEST, OFTEN, STRAIGHT, WINDOW};
use super::roll::{Line, along, scene};
use super::window::{Boards, Row};
use crate::canvas::{self, Area, HPos, bold, colour, pen, px, write};
use crate::plot::{Axes, curve, plain};
use crate::report::{table, thousands};
use crate::{Result, Work};
use plaus_scenes::bowling::{Bowling, Coefficients};
use plotters::prelude::*;

const SIZE: (u32, u32) = (1200, 520);
/// Difference between two angles of entry, in degrees.
const STEP: f64 = 1.0;
/// Angles shown as curves, each with its own colour.
const CURVES: [(f64, RGBColor); 3] = [(0.0, colour::FAINT), (3.0, colour::PAPER), (6.0, colour::OURS)];

pub(super) fn make(work: &mut Work) -> Result<()> {
    let scene = scene(Coefficients::default())?;
    let (shots, boards) = work.size((50, Boards(15.5, 20.0, 0.25)), (1, Boards(17.0, 18.5, 0.5)));
    let angles: Vec<f64> = work.size((0..=8).map(|k| STEP * f64::from(k)).collect(), vec![0.0, 3.0, 6.0]);
    let count = angles.len() * boards.all().count();
    work.say(format_args!("bowling: strike rate on {count} lines, {shots} shots of each"));
    let row = |(k, angle): (usize, f64)| Row::of(&scene, angle, boards, shots, SEED + 1_000 + 100 * k as u64);
    let rows = angles.into_iter().enumerate().map(row).collect::<Result<Vec<_>>>()?;
    canvas::save(&work.out, "bowling-entry", SIZE, |area| draw(area, &rows, boards.2))?;
    work.report.figure(
        "bowling-entry",
        format!(
            "Strikes over the board that the ball's centre would cross in the head pin's row (20 is the middle) and its angle of entry; left as a map, right for three angles, with bars of one \
             standard error. The dot is the published best line, the bar beneath the boards where a ball at 6° is said \
             to strike nearly always. A rolling ball of 15 lb at 8 ± 0.2 m/s, pins set at \
             random as the scene has it; {shots} shots of each of {count} lines.",
        ),
    );
    windows(work, &scene, &rows, shots)
}

fn windows(work: &mut Work, scene: &Bowling, rows: &[Row], shots: u64) -> Result<()> {
    let lines = rows.iter().map(|row| {
        let best = row.strikes.iter().max_by(|a, b| a.1.share().total_cmp(&b.1.share()).then(b.0.total_cmp(&a.0)));
        let (board, strikes) = best.copied().unwrap_or_default();
        let published = match row.angle {
            0.0 => format!("at most {STRAIGHT}"),
            6.0 => format!("{:.1} ({}–{})", WINDOW.1 - WINDOW.0, WINDOW.0, WINDOW.1),
            _ => String::new(),
        };
        let ours = format!("{:.2} ({})", row.width(), row.shown_window());
        vec![row.angle.to_string(), format!("{board:.2}"), strikes.percent(), ours, published]
    });
    let head = ["angle of entry, °", "best board", "strikes there, %", "boards with nine strikes in ten", "published"];
    let mut text = table(&head, lines);
    let (at, seed) = (work.size(1_000, 2), SEED + 900);
    let best = along(scene, at, seed, |_| Line::new(BEST.0, BEST.1))?;
    text += &format!(
        "\n{shots} shots of each line. A board is where the ball's centre would cross the head pin's row on a straight way; it meets the pin some 16 cm earlier, at 6° 0.6 boards farther to the right, and \
         the publication does not say which it means.\n\nOn the published best line, board {} at {}°: {} % strikes of \
         {} (seed {seed}), left: {}. The ball itself struck pins 1, 3, 5 and 9 and no \
         other in {} %: that is what the perfect strike is said to do.\n",
        BEST.0,
        BEST.1,
        best.strikes().percent(),
        thousands(at),
        best.words(6),
        crate::plausibility::chance::Count::new(best.four, best.shots).percent(),
    );
    work.report.section("Bowling: strikes over board and angle of entry", &text);
    Ok(())
}

/// From white for no strikes to the blue of our numbers for strikes only.
fn shade(rate: f64) -> RGBColor {
    let mix = |light: u8, dark: u8| (f64::from(light) + (f64::from(dark) - f64::from(light)) * rate).round() as u8;
    let RGBColor(r, g, b) = colour::OURS;
    RGBColor(mix(255, r), mix(255, g), mix(255, b))
}

fn draw(area: &Area<'_>, rows: &[Row], every: f64) -> Result<()> {
    write(area, "Strikes over board and angle of entry", &bold(20.0, colour::INK), HPos::Left, (24.0, 28.0))?;
    let (_, plots) = area.split_vertically(px(50.0));
    let halves = plots.split_evenly((1, 2));
    let boards = |row: &Row| row.strikes.first().map_or(0.0, |s| s.0)..row.strikes.last().map_or(1.0, |s| s.0);
    let span = rows.first().map_or(0.0..1.0, boards);
    let top = rows.last().map_or(1.0, |row| row.angle);
    let mut map = Axes {
        title: "",
        x: span.start - 0.5 * every..span.end + 0.5 * every,
        y: -0.5 * STEP..top + 0.5 * STEP,
        x_label: "board in the head pin's row",
        y_label: "angle of entry (°)",
        ticks: (10, 9),
        x_text: &plain,
        y_text: &plain,
    }
    .draw(&halves[0])?;
    for row in rows {
        for (board, strikes) in &row.strikes {
            let (low, high) =
                ((board - 0.5 * every, row.angle - 0.5 * STEP), (board + 0.5 * every, row.angle + 0.5 * STEP));
            map.draw_series([Rectangle::new([low, high], shade(strikes.share()).filled())])?;
            if strikes.share() >= OFTEN {
                map.draw_series([Circle::new((*board, row.angle), px(1.5), WHITE.filled())])?;
            }
        }
    }
    map.draw_series([Circle::new(BEST, px(5.0), colour::NORMAL.filled())])?;
    map.draw_series([PathElement::new(
        [(WINDOW.0, BEST.1 - 0.4), (WINDOW.1, BEST.1 - 0.4)],
        pen(colour::NORMAL, 3.0),
    )])?;
    let mut chart = Axes {
        title: "",
        x: span,
        y: 0.0..1.0,
        x_label: "board in the head pin's row",
        y_label: "strikes (%)",
        ticks: (10, 6),
        x_text: &plain,
        y_text: &|share| plain(&(100.0 * share)),
    }
    .draw(&halves[1])?;
    curve(&mut chart, &[WINDOW.0, WINDOW.1].map(|board| (board, 0.02)), pen(colour::NORMAL, 4.0))?;
    for (k, (angle, colour)) in CURVES.into_iter().enumerate() {
        let Some(row) = rows.iter().find(|row| row.angle == angle) else { continue };
        let points: Vec<(f64, f64)> = row.strikes.iter().map(|(board, strikes)| (*board, strikes.share())).collect();
        curve(&mut chart, &points, pen(colour, 2.0))?;
        for (board, strikes) in &row.strikes {
            let (low, high) = strikes.interval();
            chart.draw_series([PathElement::new([(*board, low), (*board, high)], pen(colour, 1.2))])?;
        }
        write(&halves[1], &format!("{angle}°"), &bold(14.0, colour), HPos::Left, (84.0 + 44.0 * k as f64, 12.0))?;
    }
    Ok(())
}
