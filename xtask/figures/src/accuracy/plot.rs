//! One row for each case, one dot for each preset, on a logarithmic scale.

use super::Row;
use crate::canvas::{self, Area, HPos, bold, colour, pen, px, text, write};
use crate::{Result, Work};
use plaus_dist::math;
use plaus_sim::Preset;
use plotters::prelude::*;

/// Widths in pixels: of the figure, of the names, and of the margin at the right.
const WIDTH: f64 = 1200.0;
const NAMES: f64 = 400.0;
const RIGHT: f64 = 110.0;
/// Heights in pixels: above the rows, of a row, and below the rows.
const TOP: f64 = 84.0;
const LINE: f64 = 26.0;
const BOTTOM: f64 = 52.0;

/// Powers of ten at the ends of the scale; smaller values, and 0, are drawn at its left end.
const LEAST: f64 = -14.0;
const MOST: f64 = 1.0;

const COLOURS: [RGBColor; 4] = [colour::FAINT, colour::OURS, colour::TARGET, colour::NORMAL];

pub(super) fn make(work: &mut Work, rows: &[Row]) -> Result<()> {
    let height = TOP + LINE * rows.len() as f64 + BOTTOM;
    canvas::save(&work.out, "accuracy", (WIDTH as u32, height as u32), |area| draw(area, rows))?;
    work.report.figure(
        "accuracy",
        "How far each preset is from the truth: what is measured stands in the table below. Dots at the left end: \
         exact, to rounding. Grey bars: what is not known of the truth, where it is an integrator in small steps. \
         A cross at the right: cut off before its end.",
    );
    Ok(())
}

fn across(off: f64) -> f64 {
    let power = math::log10(off.max(1e-300)).clamp(LEAST, MOST);
    NAMES + (power - LEAST) / (MOST - LEAST) * (WIDTH - NAMES - RIGHT)
}

fn line(area: &Area<'_>, from: (f64, f64), to: (f64, f64), style: ShapeStyle) -> Result<()> {
    Ok(area.draw(&PathElement::new([(px(from.0), px(from.1)), (px(to.0), px(to.1))], style))?)
}

fn draw(area: &Area<'_>, rows: &[Row]) -> Result<()> {
    write(area, "How far contact is from the truth", &bold(20.0, colour::INK), HPos::Left, (24.0, 28.0))?;
    let bottom = TOP + LINE * rows.len() as f64;
    for power in (LEAST as i32..=MOST as i32).filter(|power| power % 2 == 0) {
        let x = across(math::powi(10.0, power));
        line(area, (x, TOP - 8.0), (x, bottom), pen(colour::GRID, 1.0))?;
        let words = if power == 0 { "1".to_owned() } else { format!("1e{power}").replace('-', "−") };
        write(area, &words, &text(13.0, colour::INK), HPos::Center, (x, bottom + 14.0))?;
    }
    let middle = (across(0.0) + across(1e9)) / 2.0;
    write(area, "error, in the unit of the case", &text(14.0, colour::INK), HPos::Center, (middle, bottom + 36.0))?;
    for (k, (preset, colour)) in Preset::ALL.into_iter().zip(COLOURS).enumerate() {
        let x = NAMES + 130.0 * k as f64;
        dot(area, (x, 58.0), k, colour)?;
        write(area, preset.name(), &text(14.0, colour::INK), HPos::Left, (x + 12.0, 58.0))?;
    }
    for (k, row) in rows.iter().enumerate() {
        let y = TOP + LINE * (k as f64 + 0.5);
        // The fonts have no µ.
        write(area, &row.name.replace('µ', "friction"), &text(13.0, colour::INK), HPos::Right, (NAMES - 18.0, y))?;
        one(area, row, y)?;
    }
    Ok(())
}

fn one(area: &Area<'_>, row: &Row, y: f64) -> Result<()> {
    line(area, (across(0.0), y), (across(1e9), y), pen(colour::GRID, 1.0))?;
    if row.unknown > 0.0 {
        let x = across(row.unknown);
        line(area, (x, y - 8.0), (x, y + 8.0), pen(colour::FAINT, 3.0))?;
    }
    let known: Vec<f64> = row.off.iter().copied().filter(|off| !off.is_nan()).map(across).collect();
    for pair in known.windows(2) {
        line(area, (pair[0], y), (pair[1], y), pen(colour::FAINT, 1.0))?;
    }
    for (k, (&off, colour)) in row.off.iter().zip(COLOURS).enumerate() {
        if off.is_nan() {
            let x = across(1e9) + 18.0 + 18.0 * k as f64;
            line(area, (x - 4.0, y - 4.0), (x + 4.0, y + 4.0), pen(colour, 1.8))?;
            line(area, (x - 4.0, y + 4.0), (x + 4.0, y - 4.0), pen(colour, 1.8))?;
        } else {
            dot(area, (across(off), y), k, colour)?;
        }
    }
    Ok(())
}

/// The finer the preset, the smaller the dot, so that dots on top of each other can all be seen.
fn dot(area: &Area<'_>, at: (f64, f64), k: usize, colour: RGBColor) -> Result<()> {
    let radius = 7.0 - 1.4 * k as f64;
    Ok(area.draw(&Circle::new((px(at.0), px(at.1)), px(radius), colour.filled()))?)
}
