//! Cost against distance, as SVG and PNG.

use crate::measure::Row;
use crate::world::Way;
use plaus_dist::math::ln;
use plaus_figures::Result;
use plaus_figures::canvas::{self, HPos, colour, pen, px, text, write};
use plaus_figures::plot::{Axes, dashed, power};
use plotters::prelude::*;
use std::path::Path;

const SIZE: (u32, u32) = (720, 480);

/// One point per simulator: time across, distance of the outcome's law from the reference up, with the noise of sampling dashed.
pub(crate) fn cost_and_distance(folder: &Path, name: &str, title: &str, rows: &[Row]) -> Result<()> {
    canvas::save(folder, name, SIZE, |area| {
        let across: Vec<f64> = rows.iter().map(|r| ln(1000.0 * r.seconds) / std::f64::consts::LN_10).collect();
        let low = across.iter().copied().fold(f64::INFINITY, f64::min).floor();
        let high = across.iter().copied().fold(f64::NEG_INFINITY, f64::max).ceil();
        let top = 1.2 * rows.iter().map(|r| r.distance).fold(rows[0].noise, f64::max);
        let axes = Axes {
            title,
            x: low..high,
            y: 0.0..top,
            x_label: "milliseconds per simulation",
            y_label: "distance of the outcome's law",
            ticks: ((high - low) as usize + 1, 5),
            x_text: &power,
            y_text: &|y| format!("{y:.2}"),
        };
        let mut chart = axes.draw(area)?;
        dashed(&mut chart, &[(low, rows[0].noise), (high, rows[0].noise)], pen(colour::FAINT, 1.0), 4.0, 4.0)?;
        for (row, &x) in rows.iter().zip(&across) {
            let ink = if matches!(row.way, Way::Preset(_)) { colour::OURS } else { colour::PAPER };
            chart.draw_series([Circle::new((x, row.distance), px(4.0), ink.filled())])?;
            let (i, j) = chart.backend_coord(&(x, row.distance));
            let unit = f64::from(px(1.0));
            write(
                area,
                &row.way.name(),
                &text(11.0, ink),
                HPos::Left,
                (f64::from(i) / unit + 7.0, f64::from(j) / unit - 7.0),
            )?;
        }
        Ok(())
    })
}
