//! The alley seen from above, in metres: across to the right, along the lane upwards.

use crate::Result;
use crate::canvas::{Area, HPos, VPos, colour, pen, px, text};
use crate::plot::{Axes, Chart, plain};
use plaus_scenes::Animation;
use plaus_scenes::animation::{Form, Prop, Track};
use plotters::prelude::*;
use plotters::style::text_anchor::Pos;

/// Radius of a pin's belly in m.
const PIN: f64 = 0.0605;

const WOOD: RGBColor = RGBColor(246, 231, 205);
const GUTTER: RGBColor = RGBColor(205, 205, 210);
const PIT: RGBColor = RGBColor(178, 180, 188);
const WALL: RGBColor = RGBColor(120, 120, 126);

/// A place from above: across, along.
pub(super) type Place = (f64, f64);

/// A chart of the deck and the lane before it, with equal scales; `title` is above.
pub(super) fn deck<'a>(
    area: &Area<'a>,
    title: &str,
    x: std::ops::Range<f64>,
    y: std::ops::Range<f64>,
) -> Result<Chart<'a>> {
    let axes = Axes {
        title,
        x,
        y,
        x_label: "across the lane (m)",
        y_label: "beyond the head pin (m)",
        ticks: (5, 7),
        x_text: &plain,
        y_text: &plain,
    };
    axes.draw(area)
}

/// Draws the scenery, as far as the chart shows it.
pub(super) fn ground(chart: &mut Chart<'_>, scenery: &[Prop]) -> Result<()> {
    let (x, y) = (chart.x_range(), chart.y_range());
    let ink = |name: &str| match name {
        "lane" => Some(WOOD),
        "pit" => Some(PIT),
        _ if name.contains("gutter") => Some(GUTTER),
        _ if name.starts_with("kickback") || name == "cushion" => Some(WALL),
        _ => None,
    };
    for prop in scenery {
        let (Some(ink), Form::Block { centre, half, .. }) = (ink(&prop.name), &prop.form) else { continue };
        let low = ((centre.x - half.x).max(x.start), (-centre.z - half.z).max(y.start));
        let high = ((centre.x + half.x).min(x.end), (-centre.z + half.z).min(y.end));
        if low.0 < high.0 && low.1 < high.1 {
            chart.draw_series([Rectangle::new([low, high], ink.filled())])?;
        }
    }
    Ok(())
}

/// The path of a body's centre between two times, as far as it is before `most` along the lane.
pub(super) fn way(track: &Track, from: f64, until: f64, step: f64) -> Vec<Place> {
    let count = ((until - from) / step).ceil().max(1.0) as u32;
    let at = |k: u32| track.position((from + f64::from(k) * step).min(until));
    (0..=count).map(at).map(|p| (p.x, -p.z)).collect()
}

/// A curve without the parts outside the chart.
pub(super) fn path(chart: &mut Chart<'_>, points: &[Place], style: ShapeStyle) -> Result<()> {
    let (x, y) = (chart.x_range(), chart.y_range());
    let is_seen = |p: &&Place| x.contains(&p.0) && y.contains(&p.1);
    for part in points.split(|p| !is_seen(&p)).filter(|part| part.len() > 1) {
        chart.draw_series([PathElement::new(part.to_vec(), style)])?;
    }
    Ok(())
}

/// A circle of a radius in metres, for a chart with `scale` pixels per metre.
pub(super) fn circle(
    chart: &mut Chart<'_>,
    at: Place,
    radius: f64,
    scale: f64,
    fill: Option<RGBColor>,
    line: RGBColor,
) -> Result<()> {
    if let Some(fill) = fill {
        chart.draw_series([Circle::new(at, px(radius * scale), fill.filled())])?;
    }
    chart.draw_series([Circle::new(at, px(radius * scale), pen(line, 1.2))])?;
    Ok(())
}

/// A pin with its number, where it is set up.
pub(super) fn pin(chart: &mut Chart<'_>, number: &str, at: Place, scale: f64, fill: RGBColor) -> Result<()> {
    circle(chart, at, PIN, scale, Some(fill), colour::INK)?;
    let style = text((PIN * scale * 1.1).clamp(9.0, 16.0), colour::INK).pos(Pos::new(HPos::Center, VPos::Center));
    chart.draw_series([Text::new(number.to_owned(), at, style)])?;
    Ok(())
}

/// The pins of an animation with their numbers and where they start.
pub(super) fn pins(animation: &Animation) -> impl Iterator<Item = (&str, &Track)> {
    animation.motion.tracks.iter().filter_map(|track| Some((track.name.strip_prefix("pin_")?, track)))
}

/// A body's place at a time.
pub(super) fn at(track: &Track, time: f64) -> Place {
    let p = track.position(time);
    (p.x, -p.z)
}
