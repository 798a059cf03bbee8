//! How far from the real cube's end tosses end.

use super::published::Toss;
use super::thrown::End;
use crate::canvas::{self, Area, HPos, bold, colour, pen, px, text, write};
use crate::plot::{Axes, curve, plain};
use crate::{Result, Work};
use glam::DVec3;
use plaus_sim::Preset;
use plotters::prelude::*;

const SIZE: (u32, u32) = (1200, 560);
/// Largest distance shown, in widths.
const FAR: f64 = 1.1;

const COLOURS: [RGBColor; 4] = [colour::FAINT, colour::OURS, colour::TARGET, colour::NORMAL];

/// `found` are the ends at each preset.
pub(super) fn make(work: &mut Work, tosses: &[Toss], found: &[Vec<End>]) -> Result<()> {
    canvas::save(&work.out, "tosses", SIZE, |area| {
        write(
            area,
            "Tosses of a real cube: how far simulated ones end from it",
            &bold(20.0, colour::INK),
            HPos::Left,
            (24.0, 28.0),
        )?;
        let (_, plots) = area.split_vertically(px(50.0));
        let halves = plots.split_evenly((1, 2));
        shares(&halves[0], tosses, found)?;
        scatter(&halves[1], tosses, &found[1])
    })?;
    work.report.figure(
        "tosses",
        "Left: share of the tosses that end within a distance of the real end, at each preset. Right, at standard: \
         where each ends seen from the real end, the real toss going to the right; filled where the same face is up.",
    );
    Ok(())
}

fn shares(area: &Area<'_>, tosses: &[Toss], found: &[Vec<End>]) -> Result<()> {
    let percent = |share: &f64| plain(&(100.0 * share));
    let mut chart = Axes {
        title: "",
        x: 0.0..FAR,
        y: 0.0..1.0,
        x_label: "distance from the real end (widths)",
        y_label: "tosses within it (%)",
        ticks: (7, 6),
        x_text: &plain,
        y_text: &percent,
    }
    .draw(area)?;
    for ((preset, ends), colour) in Preset::ALL.into_iter().zip(found).zip(COLOURS) {
        let mut off: Vec<f64> = tosses.iter().zip(ends).map(|(toss, end)| end.off(toss).length()).collect();
        off.sort_by(f64::total_cmp);
        let share = |k: usize| k as f64 / off.len() as f64;
        let points: Vec<(f64, f64)> =
            off.iter().enumerate().map(|(k, d)| (*d, share(k + 1))).filter(|p| p.0 <= FAR).collect();
        curve(&mut chart, &points, pen(colour, 1.8))?;
        let y = 0.30 - 0.07 * preset as usize as f64;
        chart.draw_series([PathElement::new([(0.70, y), (0.77, y)], pen(colour, 2.5))])?;
        chart.draw_series([Text::new(preset.name(), (0.79, y + 0.02), text(14.0, colour::INK))])?;
    }
    Ok(())
}

fn scatter(area: &Area<'_>, tosses: &[Toss], ends: &[End]) -> Result<()> {
    let mut chart = Axes {
        title: "",
        x: -FAR..FAR,
        y: -FAR..FAR,
        x_label: "along the real way (widths)",
        y_label: "across it (widths)",
        ticks: (7, 7),
        x_text: &plain,
        y_text: &plain,
    }
    .draw(area)?;
    let cross = [[(-FAR, 0.0), (FAR, 0.0)], [(0.0, -FAR), (0.0, FAR)]];
    chart.draw_series(cross.map(|line| PathElement::new(line, pen(colour::FAINT, 1.0))))?;
    for (toss, end) in tosses.iter().zip(ends) {
        let ahead = (toss.end - toss.start.position).with_z(0.0).normalize_or(DVec3::X);
        let off = end.off(toss);
        let at = (off.dot(ahead), off.dot(DVec3::Z.cross(ahead)));
        if at.0.abs() > FAR || at.1.abs() > FAR {
            continue;
        }
        if end.has_the_face_of(toss) {
            chart.draw_series([Circle::new(at, px(2.5), colour::OURS.mix(0.6).filled())])?;
        } else {
            chart.draw_series([Circle::new(at, px(3.0), pen(colour::PAPER, 1.2))])?;
        }
    }
    Ok(())
}
