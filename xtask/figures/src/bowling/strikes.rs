//! Three different strikes: paths of the ball and of the pins, from above.

use super::plan::{self, Place};
use super::shots::{Bowler, STRIKE, Until, by_chain, first_touch, is_pin};
use crate::canvas::{self, Area, HPos, bold, colour, pen, px, text, write};
use crate::{Result, Work};
use plaus_mcmc::{Goal, StateOf};
use plaus_scenes::bowling::Bowling;
use plaus_scenes::{Animation, Scene};
use plotters::prelude::*;

const SEED: u64 = 1;
/// The range shown, in m, and pixels per metre.
const X: std::ops::Range<f64> = -0.85..0.85;
const Y: std::ops::Range<f64> = -0.75..1.75;
const SCALE: f64 = 200.0;
/// How long after the ball's first touch of a pin paths are drawn, in s.
const SHOWN: f64 = 0.9;
const PALE: RGBColor = RGBColor(255, 252, 244);

/// Three very different solutions: the first one; the one that differs most from it; and the one that differs most from
/// both, by [`distance`].
fn choose(bowler: &Bowler, most: u64) -> Result<Vec<StateOf<Bowling>>> {
    let mut found: Vec<StateOf<Bowling>> = Vec::new();
    by_chain(bowler, SEED, Until::Draws(most), |state| {
        if found.iter().all(|known| bowler.scene.class(known.by_ref()) != bowler.scene.class(state.by_ref())) {
            found.push(state.clone());
        }
        Ok(())
    })?;
    let mut chosen = Vec::new();
    while chosen.len() < 3 && !found.is_empty() {
        let apart = |state: &StateOf<Bowling>| chosen.iter().map(|other| distance(state, other)).fold(9.0, f64::min);
        let order = |(i, a): &(usize, &StateOf<Bowling>), (j, b): &(usize, &StateOf<Bowling>)| {
            apart(a).total_cmp(&apart(b)).then(j.cmp(i))
        };
        let Some((index, _)) = found.iter().enumerate().max_by(order) else { break };
        chosen.push(found.swap_remove(index));
    }
    Ok(chosen)
}

/// How different two shots are: the number of pins that the ball struck in only one of them, and where it met the first
/// pin, in widths of the ball.
fn distance(a: &StateOf<Bowling>, b: &StateOf<Bowling>) -> f64 {
    let [p, q] = [a, b].map(|state| &state.outcome.struck);
    let only = p.iter().filter(|pin| !q.contains(pin)).count() + q.iter().filter(|pin| !p.contains(pin)).count();
    let [x, y] = [a, b].map(|state| state.outcome.entry.map_or(0.0, |entry| entry.across));
    only as f64 + (x - y).abs() / 0.2
}

pub(super) fn make(work: &mut Work) -> Result<()> {
    let iterations = work.size(2_000, 12);
    work.say(format_args!("three strikes: {iterations} iterations of one chain, seed {SEED}"));
    let bowler = STRIKE.bowler()?;
    let chosen = choose(&bowler, iterations)?;
    let animations = chosen.iter().map(|state| Ok(bowler.scene.animate(&state.draw)?)).collect::<Result<Vec<_>>>()?;
    let panel = ((X.end - X.start) * SCALE + 62.0 + 32.0, (Y.end - Y.start) * SCALE + 44.0 + 34.0);
    let size = ((3.0 * panel.0) as u32, (panel.1 + 54.0 + 40.0) as u32);
    canvas::save(&work.out, "strikes", size, |area| {
        write(area, "Three different strikes", &bold(20.0, colour::INK), HPos::Left, (24.0, 28.0))?;
        let (_, rest) = area.split_vertically(px(54.0));
        for ((panel, animation), state) in rest.split_evenly((1, 3)).iter().zip(&animations).zip(&chosen) {
            let (plot, notes) = panel.split_vertically(px((Y.end - Y.start) * SCALE + 44.0 + 34.0));
            one(&plot, animation)?;
            let struck: Vec<String> = state.outcome.struck.iter().map(ToString::to_string).collect();
            let angle = state.outcome.entry.map_or(0.0, |entry| entry.angle);
            let side = if angle < 0.0 { "left" } else { "right" };
            let words = format!("ball strikes {}, comes in {:.1}° to the {side}", struck.join(", "), angle.abs());
            write(&notes, &words, &text(13.0, colour::INK), HPos::Left, (62.0, 10.0))?;
        }
        Ok(())
    })?;
    work.report.figure(
        "strikes",
        format!(
            "Strikes of one chain (seed {SEED}, {iterations} iterations, `{}`) that differ most: in which pins the ball itself strikes, and where it meets the first. Ways of the middles of ball \
             (blue) and pins (orange) until {SHOWN} s after the ball touches the first pin; circles: where pins are set up and how large ball and pins are; dots: where they are then.",
            STRIKE.file
        ),
    );
    Ok(())
}

fn one(area: &Area<'_>, animation: &Animation) -> Result<()> {
    let mut chart = plan::deck(area, "", X, Y)?;
    plan::ground(&mut chart, &animation.scenery)?;
    let touch = first_touch(animation, "ball", is_pin).unwrap_or(0.0);
    let until = (touch + SHOWN).min(animation.motion.duration);
    for (number, track) in plan::pins(animation) {
        plan::pin(&mut chart, number, plan::at(track, 0.0), SCALE, PALE)?;
    }
    let ends = |chart: &mut _, way: &[Place], ink: RGBColor| -> Result<()> {
        plan::path(chart, way, pen(ink, 1.6))?;
        let seen = way.iter().rev().find(|p| X.contains(&p.0) && Y.contains(&p.1));
        if let Some(end) = seen {
            plan::circle(chart, *end, 3.0 / SCALE, SCALE, Some(ink), ink)?;
        }
        Ok(())
    };
    for (_, track) in plan::pins(animation) {
        ends(&mut chart, &plan::way(track, 0.0, until, 0.002), colour::PAPER)?;
    }
    if let Some(ball) = animation.motion.tracks.iter().find(|track| track.name == "ball") {
        plan::circle(&mut chart, plan::at(ball, touch), ball.shape.reach(), SCALE, None, colour::PATH)?;
        ends(&mut chart, &plan::way(ball, 0.0, until, 0.002), colour::PATH)?;
    }
    Ok(())
}
