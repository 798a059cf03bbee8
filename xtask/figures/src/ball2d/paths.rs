//! Figure 1: three sample paths.

use super::{FIGURE_SEED, sampler};
use crate::canvas::{self, Area, HPos, bold, colour, pen, px, text, write};
use crate::plot::{Axes, Chart, plain};
use crate::{Result, Work};
use plaus_dist::{Purpose, Seed, stream};
use plaus_mcmc::{Goal, StateOf};
use plaus_scenes::ball2d::Ball2d;
use plaus_scenes::{Moves, Scene};
use plotters::prelude::*;

/// Seed for the choice among the satisfying samples.
const CHOICE_SEED: u64 = 2;
/// Number of samples, as many as the paper's chain has.
const SAMPLES: u64 = 1000;
const SIZE: (u32, u32) = (1200, 800);
const ARROW: f64 = 0.62;

/// A satisfying sample with its iteration.
type Sample = (usize, StateOf<Ball2d>);

pub(super) fn make(work: &mut Work) -> Result<()> {
    work.say(format_args!(
        "figure 1: {SAMPLES} iterations of one chain, seed {FIGURE_SEED}; choice by seed {CHOICE_SEED}"
    ));
    let sampler = sampler(Moves::Mixed, |_| ())?;
    let ball = &sampler.scene;
    let states = sampler.states(FIGURE_SEED, 0, SAMPLES)?;
    let satisfying: Vec<Sample> =
        states.into_iter().enumerate().filter(|(_, state)| ball.class(state.by_ref()).is_some()).collect();
    let chosen = choose(ball, &satisfying)?;
    canvas::save(&work.out, "figure-1", SIZE, |area| draw(area, ball, &chosen))?;
    let iterations: Vec<String> = chosen.iter().map(|(iteration, _)| iteration.to_string()).collect();
    work.report.figure(
        "figure-1",
        format!(
            "Three sample paths of the ball's centre, with the table's normals at the bounces (red) and the target (green), as the paper's figure 1. \
             Iterations {} of one chain of {SAMPLES} samples with the default moves (seed {FIGURE_SEED}), drawn at \
             random (seed {CHOICE_SEED}) from its {} satisfying samples; a sample that bounces in the same cells of \
             0.5 D as one drawn before was passed over.",
            iterations.join(", "),
            satisfying.len(),
        ),
    );
    Ok(())
}

/// Three of the samples, drawn at random, of different classes.
fn choose<'a>(ball: &Ball2d, samples: &'a [Sample]) -> Result<Vec<&'a Sample>> {
    let mut random = Seed(CHOICE_SEED).chain(0).at(0, Purpose::START);
    let mut chosen: Vec<&Sample> = Vec::new();
    for _ in 0..100_000 {
        let candidate = &samples[stream::below(&mut random, samples.len())];
        if chosen.iter().all(|sample| ball.class(sample.1.by_ref()) != ball.class(candidate.1.by_ref())) {
            chosen.push(candidate);
        }
        if chosen.len() == 3 {
            return Ok(chosen);
        }
    }
    Err("the chain of figure 1 has fewer than three different solutions".into())
}

/// The centre's path in D: x, and height above where it touches the table.
fn path(ball: &Ball2d, sample: &Sample) -> Result<Vec<(f64, f64)>> {
    const POINTS: usize = 600;
    let animation = ball.animate(&sample.1.draw)?;
    let track = animation.motion.tracks.first().ok_or("the ball has no track")?;
    let size = ball.config().diameter_m;
    let mut times: Vec<f64> = (0..=POINTS).map(|i| animation.motion.duration * i as f64 / POINTS as f64).collect();
    // The bounces themselves are points of the path; otherwise its corners would be cut.
    times.extend(animation.motion.impacts.iter().map(|impact| impact.time));
    times.sort_by(f64::total_cmp);
    Ok(times.into_iter().map(|time| track.position(time) / size).map(|p| (p.x, p.y.max(0.0))).collect())
}

fn draw(area: &Area<'_>, ball: &Ball2d, chosen: &[&Sample]) -> Result<()> {
    let paths = chosen.iter().map(|sample| path(ball, sample)).collect::<Result<Vec<_>>>()?;
    write(area, "Three sample paths of the 2D ball", &bold(22.0, colour::INK), HPos::Left, (24.0, 30.0))?;
    legend(area)?;
    let (_, rest) = area.split_vertically(px(64.0));
    let panels = rest.split_evenly((1, 3));
    // Equal scales along x and y: the panel's plot is 324 by 600 pixels.
    let (low, high) = (-0.75, 5.05);
    let half = 0.5 * (high - low) * 324.0 / 600.0;
    let ends = paths.iter().flatten().fold((0.0_f64, 1.0_f64), |(low, high), p| (low.min(p.0), high.max(p.0)));
    let middle = 0.5 * (ends.0 + ends.1);
    for ((panel, path), (number, sample)) in panels.iter().zip(&paths).zip((1..).zip(chosen)) {
        let (plot, notes) = panel.split_vertically(px(600.0 + 56.0 + 30.0));
        let title = format!("{number}: iteration {}", sample.0);
        let mut chart = Axes {
            title: &title,
            x: middle - half..middle + half,
            y: low..high,
            x_label: "x (ball diameters D)",
            y_label: if number == 1 { "height above the table (D)" } else { "" },
            ticks: (5, 7),
            x_text: &plain,
            y_text: &|y| if *y < -1e-9 { String::new() } else { plain(y) },
        }
        .draw(&plot)?;
        one(&mut chart, ball, path, sample)?;
        annotate(&notes, sample)?;
    }
    Ok(())
}

fn legend(area: &Area<'_>) -> Result<()> {
    let style = text(14.0, colour::INK);
    let line = |x: f64, colour: RGBColor| {
        area.draw(&PathElement::new([(px(x), px(30.0)), (px(x + 30.0), px(30.0))], pen(colour, 3.0)))
    };
    line(560.0, colour::PATH)?;
    write(area, "path of the centre", &style, HPos::Left, (600.0, 30.0))?;
    line(770.0, colour::NORMAL)?;
    write(area, "normal at a bounce", &style, HPos::Left, (810.0, 30.0))?;
    area.draw(&Circle::new((px(1000.0), px(30.0)), px(8.0), pen(colour::TARGET, 2.5)))?;
    area.draw(&Circle::new((px(1000.0), px(30.0)), px(2.5), colour::TARGET.filled()))?;
    write(area, "target, ± 0.1 D", &style, HPos::Left, (1016.0, 30.0))
}

fn one(chart: &mut Chart<'_>, ball: &Ball2d, path: &[(f64, f64)], sample: &Sample) -> Result<()> {
    let (x, y) = (chart.x_range(), chart.y_range());
    chart.draw_series([Rectangle::new([(x.start, y.start), (x.end, 0.0)], colour::GROUND.filled())])?;
    chart.draw_series([PathElement::new([(x.start, 0.0), (x.end, 0.0)], pen(colour::FAINT, 1.5))])?;
    let config = ball.config();
    let (left, right) = (config.target - config.tolerance, config.target + config.tolerance);
    chart.draw_series([Rectangle::new([(left, -0.16), (right, 0.0)], colour::TARGET.filled())])?;
    chart.draw_series([
        Circle::new((config.target, 0.0), px(20.0), pen(colour::TARGET, 2.0)),
        Circle::new((config.target, 0.0), px(30.0), pen(colour::TARGET, 1.5)),
    ])?;
    chart.draw_series([PathElement::new(path.to_vec(), pen(colour::PATH, 2.5))])?;
    for (number, (&place, &degrees)) in (1..).zip(ball.path(&sample.1.draw).iter().zip(&sample.1.draw.0)) {
        arrow(chart, place, degrees.to_radians())?;
        let label =
            text(11.0, colour::NORMAL).pos(plotters::style::text_anchor::Pos::new(HPos::Center, canvas::VPos::Top));
        // Labels of neighbours are placed lower and lower, so that close bounces stay readable.
        let depth = -0.2 - 0.13 * f64::from((number - 1) % 4);
        chart.draw_series([Text::new(number.to_string(), (place, depth), label)])?;
    }
    if let (Some(&start), Some(&end)) = (path.first(), path.last()) {
        chart.draw_series([Circle::new(start, px(5.0), pen(colour::PATH, 2.0))])?;
        chart.draw_series([Circle::new(end, px(5.0), colour::PATH.filled())])?;
    }
    Ok(())
}

/// An arrow from a bounce along the normal; the axes have equal scales.
fn arrow(chart: &mut Chart<'_>, place: f64, angle: f64) -> Result<()> {
    let (sin, cos) = plaus_dist::math::sin_cos(angle);
    let at = |along: f64, across: f64| (place + along * sin + across * cos, along * cos - across * sin);
    chart.draw_series([PathElement::new([at(0.0, 0.0), at(ARROW - 0.1, 0.0)], pen(colour::NORMAL, 2.2))])?;
    let head = vec![at(ARROW, 0.0), at(ARROW - 0.17, 0.06), at(ARROW - 0.17, -0.06)];
    chart.draw_series([Polygon::new(head, colour::NORMAL.filled())])?;
    Ok(())
}

fn annotate(area: &Area<'_>, sample: &Sample) -> Result<()> {
    let angles: Vec<String> = sample.1.draw.0.iter().map(|degrees| format!("{degrees:.0}°")).collect();
    let angles = format!("normals lean by {}", angles.join(", ")).replace('-', "−").replace("−0°", "0°");
    let rest = format!("rests at x = {:.3} D", sample.1.outcome.x.unwrap_or(f64::NAN));
    let style = text(13.0, colour::INK);
    write(area, &angles, &style, HPos::Center, (224.0, 8.0))?;
    write(area, &rest, &style, HPos::Center, (224.0, 28.0))
}
