//! Axes and curves in the style of all figures.

use crate::Result;
use crate::canvas::{Area, bold, colour, pen, px, text};
use crate::lines::inside;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use std::ops::Range;

/// A plot with axes.
pub type Chart<'a> = ChartContext<'a, SVGBackend<'a>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// The contents of axes.
pub struct Axes<'a> {
    pub title: &'a str,
    pub x: Range<f64>,
    pub y: Range<f64>,
    pub x_label: &'a str,
    pub y_label: &'a str,
    /// Approximate number of labels along x and y.
    pub ticks: (usize, usize),
    pub x_text: &'a dyn Fn(&f64) -> String,
    pub y_text: &'a dyn Fn(&f64) -> String,
}

/// A tick's number, without decimals if it is whole, with a true minus sign.
pub fn plain(value: &f64) -> String {
    let number =
        if (value - value.round()).abs() < 1e-9 { format!("{:.0}", value + 0.0) } else { format!("{value:.1}") };
    let number = if number == "-0" { "0".to_owned() } else { number };
    number.replace('-', "−")
}

/// A tick on an axis of logarithms to base 10.
pub fn power(value: &f64) -> String {
    let whole = value.round();
    if (value - whole).abs() > 1e-9 {
        return String::new();
    }
    if whole >= 0.0 {
        crate::report::thousands(plaus_dist::math::powi(10.0, whole as i32) as u64)
    } else {
        format!("{:.1$}", plaus_dist::math::powi(10.0, whole as i32), (-whole) as usize)
    }
}

impl Axes<'_> {
    /// Draws the axes on `area`.
    pub fn draw<'a>(&self, area: &Area<'a>) -> Result<Chart<'a>> {
        let mut builder = ChartBuilder::on(area);
        builder.margin_right(px(28.0)).margin_top(px(8.0)).margin_bottom(px(4.0)).margin_left(px(4.0));
        builder.set_label_area_size(LabelAreaPosition::Left, px(58.0));
        builder.set_label_area_size(LabelAreaPosition::Bottom, px(44.0));
        if !self.title.is_empty() {
            builder.caption(self.title, bold(15.0, colour::INK));
        }
        let mut chart = builder.build_cartesian_2d(self.x.clone(), self.y.clone())?;
        chart
            .configure_mesh()
            .bold_line_style(pen(colour::GRID, 1.0))
            .light_line_style(TRANSPARENT)
            .axis_style(pen(colour::FAINT, 1.0))
            .set_all_tick_mark_size(px(4.0))
            .x_labels(self.ticks.0)
            .y_labels(self.ticks.1)
            .x_label_formatter(&self.x_text)
            .y_label_formatter(&self.y_text)
            .label_style(text(13.0, colour::INK))
            .axis_desc_style(text(14.0, colour::INK))
            .x_desc(self.x_label)
            .y_desc(self.y_label)
            .draw()?;
        Ok(chart)
    }
}

/// Draws a curve, as far as it is inside the plot.
pub fn curve(chart: &mut Chart<'_>, points: &[(f64, f64)], style: ShapeStyle) -> Result<()> {
    let y = chart.y_range();
    for part in inside(points, y.start, y.end) {
        chart.draw_series([PathElement::new(part, style)])?;
    }
    Ok(())
}

/// Draws a dashed curve: `on` and `off` in pixels.
pub fn dashed(chart: &mut Chart<'_>, points: &[(f64, f64)], style: ShapeStyle, on: f64, off: f64) -> Result<()> {
    let y = chart.y_range();
    for part in inside(points, y.start, y.end) {
        chart.draw_series(DashedLineSeries::new(part, px(on), px(off), style))?;
    }
    Ok(())
}

/// Shades a band across the whole plot.
pub fn band(chart: &mut Chart<'_>, low: f64, high: f64, colour: RGBColor) -> Result<()> {
    let x = chart.x_range();
    chart.draw_series([Rectangle::new([(x.start, low), (x.end, high)], colour.mix(0.22).filled())])?;
    Ok(())
}
