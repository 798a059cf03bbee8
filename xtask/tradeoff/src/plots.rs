//! Cost against distance, and error over time, as SVG and PNG.

use crate::measure::{Row, times};
use crate::report::Distances;
use crate::world::{Way, World};
use plaus_dist::math::ln;
use plaus_figures::Result;
use plaus_figures::canvas::{self, HPos, colour, pen, px, text, write};
use plaus_figures::plot::{Axes, Chart, curve, power};
use plotters::prelude::*;
use std::path::Path;

const SIZE: (u32, u32) = (720, 480);
/// Smallest error that is drawn, in m: a nanometre.
const LEAST: f64 = 1e-9;

fn log10(x: f64) -> f64 {
    ln(x) / std::f64::consts::LN_10
}

fn ink(way: Way) -> RGBColor {
    if matches!(way, Way::Preset(_)) { colour::OURS } else { colour::PAPER }
}

/// Writes beside a point of the plot.
fn label(area: &canvas::Area<'_>, chart: &Chart<'_>, words: &str, at: (f64, f64), colour: RGBColor) -> Result<()> {
    let (i, j) = chart.backend_coord(&at);
    let unit = f64::from(px(1.0));
    write(area, words, &text(11.0, colour), HPos::Left, (f64::from(i) / unit + 7.0, f64::from(j) / unit - 7.0))
}

/// One point per simulator: time horizontally; vertically the distance of the outcome's law from the reference, and a
/// bar from the mean to the 95 % quantile of what sampling alone gives.
pub(crate) fn cost_and_distance(folder: &Path, world: &dyn World, rows: &[Row], distances: &[Distances]) -> Result<()> {
    canvas::save(folder, world.name(), SIZE, |area| {
        let across: Vec<f64> = rows.iter().map(|r| log10(1000.0 * r.time(0.5))).collect();
        let low = across.iter().copied().fold(f64::INFINITY, f64::min).floor();
        let high = across.iter().copied().fold(f64::NEG_INFINITY, f64::max).ceil();
        let all = || distances.iter().filter_map(|d| d.to_reference.first());
        let top = 1.2 * all().map(|d| d.found.max(d.most)).fold(1e-3, f64::max);
        let reading = format!("distance in {}", world.readings()[0].name);
        let axes = Axes {
            title: world.title(),
            x: low..high,
            y: 0.0..top,
            x_label: "milliseconds per simulation, median; bars: distance by chance, mean to 95 %",
            y_label: &reading,
            ticks: ((high - low) as usize + 1, 5),
            x_text: &power,
            y_text: &|y| format!("{y:.2}"),
        };
        let mut chart = axes.draw(area)?;
        for ((row, distance), &x) in rows.iter().zip(distances).zip(&across) {
            let ink = ink(row.way);
            let y = distance.to_reference.first().map_or(0.0, |d| d.found);
            if let Some(d) = distance.to_reference.first() {
                curve(&mut chart, &[(x, d.noise), (x, d.most)], pen(colour::FAINT, 5.0))?;
            }
            chart.draw_series([Circle::new((x, y), px(4.0), ink.filled())])?;
            label(area, &chart, &row.way.name(), (x, y), ink)?;
        }
        Ok(())
    })
}

/// Median error over time, until chaos has made the paths diverge.
pub(crate) fn growth(folder: &Path, world: &dyn World, rows: &[Row]) -> Result<()> {
    let times = times();
    canvas::save(folder, &format!("{}-error", world.name()), SIZE, |area| {
        let (low, high) = (log10(LEAST * 1000.0), 2.0);
        let axes = Axes {
            title: world.title(),
            x: 0.0..times[times.len() - 1],
            y: low..high,
            x_label: "seconds",
            y_label: "distance from the reference, mm, median",
            ticks: (7, (high - low) as usize + 1),
            x_text: &plaus_figures::plot::plain,
            y_text: &power,
        };
        let mut chart = axes.draw(area)?;
        let agreed = log10(1000.0 * world.tolerance());
        curve(&mut chart, &[(0.0, agreed), (times[times.len() - 1], agreed)], pen(colour::FAINT, 1.0))?;
        for row in rows.iter().filter(|row| !row.errors.is_empty()) {
            let points: Vec<(f64, f64)> = times
                .iter()
                .zip(&row.errors)
                .map(|(&t, &e)| (t, log10(1000.0 * e.max(LEAST)).clamp(low, high)))
                .collect();
            curve(&mut chart, &points, pen(ink(row.way), 1.5))?;
            let middle = points[points.len() / 4 * 3];
            label(area, &chart, &row.way.name(), middle, ink(row.way))?;
        }
        Ok(())
    })
}
