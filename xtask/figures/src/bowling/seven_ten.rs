//! The seven-ten split, which the paper could not bowl: how far chains get.

use super::plan;
use super::shots::{Bowler, SEVEN_TEN, SEVEN_TEN_PAPER, Shot as Question, first_touch, is_pin};
use crate::canvas::{self, HPos, bold, colour, pen, px, write};
use crate::report::{significant, table, thousands};
use crate::{Result, Work};
use plaus_dist::Seed;
use plaus_mcmc::{Course, Decision, Goal, Mixture, Redraw, Replicas, StateOf, StateRefOf, Tempering, TopStep};
use plaus_scenes::bowling::{Bowling, Shot, Work as Memory};
use plaus_scenes::{AccuracyPreset, Scene};
use plotters::prelude::*;
use rayon::prelude::*;

const CHAINS: u32 = 4;
const RUNGS: u32 = 6;
const SWAP_EVERY: u64 = 20;
/// Iterations between two measurements of how near the pins come.
const LOOK: u64 = 50;

/// Largest number of conversions that are compared with the reference accuracy.
const CONFIRMED: usize = 20;
/// The range that the picture shows, in m, and pixels per metre.
const X: std::ops::Range<f64> = -0.9..0.9;
const Y: std::ops::Range<f64> = -0.4..1.8;
const SCALE: f64 = 240.0;

/// What chains of one kind reached.
#[derive(Debug, Default)]
struct Reached {
    /// Largest number of pins down.
    best: u64,
    /// Iterations with one pin down, and with both.
    one: u64,
    both: u64,
    /// First iteration with both.
    first: Option<u64>,
    /// Smallest distance of the pins' centres in m, and the number of examined shots in which the two touched.
    nearest: Option<f64>,
    touched: u64,
    looked: u64,
    /// Draws with both pins down, each once.
    draws: Vec<Shot>,
}

impl Reached {
    fn with(mut self, other: Self) -> Self {
        self.draws.extend(other.draws);
        Self {
            draws: self.draws,
            best: self.best.max(other.best),
            one: self.one + other.one,
            both: self.both + other.both,
            first: self.first.into_iter().chain(other.first).min(),
            nearest: self.nearest.into_iter().chain(other.nearest).reduce(f64::min),
            touched: self.touched + other.touched,
            looked: self.looked + other.looked,
        }
    }

    fn note(&mut self, bowler: &Bowler, iteration: u64, state: StateRefOf<'_, Bowling>) {
        let (k, _) = bowler.scene.counts(state.outcome);
        self.best = self.best.max(k);
        self.one += u64::from(k == 1);
        if bowler.scene.class(state).is_some() {
            self.both += 1;
            self.first.get_or_insert(iteration);
            if self.draws.last() != Some(state.draw) {
                self.draws.push(state.draw.clone());
            }
        }
    }

    /// Notes how near the two pins come in the animation of a state with one of them down.
    fn look(&mut self, bowler: &Bowler, state: StateRefOf<'_, Bowling>) -> Result<()> {
        if bowler.scene.counts(state.outcome).0 == 0 {
            return Ok(());
        }
        let animation = bowler.scene.animate(state.draw)?;
        let mut pins = plan::pins(&animation).map(|(_, track)| track);
        let (Some(seven), Some(ten)) = (pins.next(), pins.next()) else { return Ok(()) };
        let steps = (animation.motion.duration / 0.002) as u32;
        let apart = |k: u32| (seven.position(f64::from(k) * 0.002) - ten.position(f64::from(k) * 0.002)).length();
        self.nearest = self.nearest.into_iter().chain((0..=steps).map(apart)).reduce(f64::min);
        self.touched += u64::from(first_touch(&animation, "pin_7", |other| other == "pin_10").is_some());
        self.looked += 1;
        Ok(())
    }
}

fn reach(bowler: &Bowler, chain: u32, rungs: u32, warmup: u64, iterations: u64) -> Result<Reached> {
    let fresh = Mixture::of(Box::new(Redraw));
    let tempering = Tempering { rungs, swap_every: SWAP_EVERY, warmup, adapt_rungs: false };
    let course = Course { target: &bowler.scene, moves: &bowler.moves, fresh: &fresh, tempering };
    let mut replicas = Replicas::start(course, Seed(1), chain)?;
    let mut reached = Reached::default();
    while replicas.iteration() < iterations {
        let mut moved = false;
        replicas.advance(replicas.iteration() + LOOK, |chain, step| {
            moved |= !matches!(step, TopStep::Step(step) if step.decision != Decision::Accepted);
            if matches!(step, TopStep::Step(_)) {
                reached.note(bowler, chain.iteration(), chain.state().by_ref());
            }
        })?;
        if moved {
            reached.look(bowler, replicas.top().state().by_ref())?;
        }
    }
    Ok(reached)
}

pub(super) fn make(work: &mut Work) -> Result<()> {
    let (warmup, iterations) = work.size((500, 20_000), (5, 50));
    let (mut rows, mut converted) = (Vec::new(), None);
    for (shot, kind) in [(SEVEN_TEN_PAPER, "the paper's"), (SEVEN_TEN, "regulation")] {
        for rungs in [1, RUNGS] {
            work.say(format_args!("7-10, {kind} delivery, {rungs} rungs: {CHAINS} chains of {iterations} iterations"));
            let (row, found) = row(shot, kind, rungs, (work.size(CHAINS, 1), warmup, iterations))?;
            rows.push(row);
            if let (Some(draw), None) = (found, &converted) {
                converted = Some((shot, draw));
            }
        }
    }
    let head = [
        "delivery",
        "rungs",
        "most pins down",
        "iterations with one down",
        "with both (first)",
        "shots looked at",
        "least distance of the two pins' middles, mm",
        "shots in which they touch",
        "conversions that hold at the reference accuracy",
    ];
    let mut text = table(&head, rows);
    text += &format!(
        "\n{} chains of {} iterations each (seed 1), at the target; with {RUNGS} rungs each chain has as many replicas, of which that at the target is told of. Every {LOOK} iterations, where the state is another with a pin down, its animation is \
         looked at. The two stand 914 mm apart. Nothing was tuned for this shot; no iteration with both down means that it was not bowled.\n",
        work.size(CHAINS, 1),
        thousands(iterations)
    );
    work.report.section("Bowling: the seven-ten split", &text);
    if let Some((question, draw)) = converted {
        picture(work, question, &draw)?;
    }
    Ok(())
}

/// How many of the first draws that convert the split also do so at the reference accuracy.
fn held(question: Question, draws: &[Shot]) -> Result<String> {
    let some = &draws[..draws.len().min(CONFIRMED)];
    let bowler = question.bowler_with(|config| config.accuracy = AccuracyPreset::Reference)?;
    let mut count = 0;
    for draw in some {
        let state = StateOf::<Bowling>::evaluate(&bowler.scene, draw.clone(), &mut Memory::default())?;
        count += usize::from(bowler.scene.is_satisfied(&state.outcome));
    }
    Ok(if some.is_empty() { "–".into() } else { format!("{count} of {}", some.len()) })
}

/// A conversion, seen from above.
fn picture(work: &mut Work, question: Question, draw: &Shot) -> Result<()> {
    let animation = question.bowler()?.scene.animate(draw)?;
    let size = (X.end - X.start, Y.end - Y.start);
    let size = ((size.0 * SCALE + 94.0) as u32, (size.1 * SCALE + 56.0 + 54.0) as u32);
    canvas::save(&work.out, "seven-ten", size, |area| {
        write(area, "The seven-ten split, converted", &bold(20.0, colour::INK), HPos::Left, (24.0, 28.0))?;
        let (_, plot) = area.split_vertically(px(54.0));
        let mut chart = plan::deck(&plot, "", X, Y)?;
        plan::ground(&mut chart, &animation.scenery)?;
        for (number, track) in plan::pins(&animation) {
            plan::pin(&mut chart, number, plan::at(track, 0.0), SCALE, RGBColor(255, 252, 244))?;
            plan::path(&mut chart, &plan::way(track, 0.0, animation.motion.duration, 0.002), pen(colour::PAPER, 1.6))?;
        }
        for ball in animation.motion.tracks.iter().filter(|track| track.name == "ball") {
            plan::path(&mut chart, &plan::way(ball, 0.0, animation.motion.duration, 0.002), pen(colour::PATH, 1.6))?;
            let touch = first_touch(&animation, "ball", is_pin).unwrap_or(0.0);
            plan::circle(&mut chart, plan::at(ball, touch), ball.shape.reach(), SCALE, None, colour::PATH)?;
        }
        Ok(())
    })?;
    work.report.figure(
        "seven-ten",
        format!(
            "The first draw of `{}` that the table's chains found with both pins down, not chosen: ways of the middles of ball (blue) and pins (orange), and the ball where it touches the first pin.",
            question.file
        ),
    );
    Ok(())
}

fn row(
    shot: Question,
    kind: &str,
    rungs: u32,
    (chains, warmup, iterations): (u32, u64, u64),
) -> Result<(Vec<String>, Option<Shot>)> {
    let bowler = shot.bowler()?;
    let all = (0..chains).into_par_iter().map(|chain| reach(&bowler, chain, rungs, warmup, iterations));
    let all = all.collect::<Result<Vec<_>>>()?.into_iter().fold(Reached::default(), Reached::with);
    let first = all.first.map_or("never".into(), thousands);
    let row = vec![
        kind.into(),
        rungs.to_string(),
        format!("{} of 2", all.best),
        thousands(all.one),
        format!("{} ({first})", thousands(all.both)),
        thousands(all.looked),
        all.nearest.map_or("–".into(), |nearest| significant(1e3 * nearest, 3)),
        thousands(all.touched),
        held(shot, &all.draws)?,
    ];
    Ok((row, all.draws.into_iter().next()))
}
