//! The seven-ten split, which the paper could not bowl: how far chains get.

use super::plan;
use super::shots::{Bowler, SEVEN_TEN, SEVEN_TEN_PAPER, Shot, first_touch};
use crate::report::{significant, table, thousands};
use crate::{Result, Work};
use plaus_dist::Seed;
use plaus_mcmc::{Course, Goal, Mixture, Redraw, Replicas, StateOf, Tempering, TopStep, Verdict};
use plaus_scenes::Scene;
use plaus_scenes::bowling::Bowling;
use rayon::prelude::*;

const CHAINS: u32 = 4;
const RUNGS: u32 = 6;
const SWAP_EVERY: u64 = 20;
/// Iterations between two looks at how near the pins come.
const LOOK: u64 = 50;

/// What chains of one kind reached.
#[derive(Debug, Clone, Copy)]
struct Reached {
    /// Pins down at most.
    best: u64,
    /// Iterations with one pin down, and with both.
    one: u64,
    both: u64,
    /// First iteration with both.
    first: Option<u64>,
    /// Least distance of the pins' middles in m, and shots looked at in which the two touched.
    nearest: f64,
    touched: u64,
    looked: u64,
}

impl Reached {
    const NOTHING: Self = Self { best: 0, one: 0, both: 0, first: None, nearest: f64::INFINITY, touched: 0, looked: 0 };

    fn with(self, other: Self) -> Self {
        Self {
            best: self.best.max(other.best),
            one: self.one + other.one,
            both: self.both + other.both,
            first: self.first.into_iter().chain(other.first).min(),
            nearest: self.nearest.min(other.nearest),
            touched: self.touched + other.touched,
            looked: self.looked + other.looked,
        }
    }

    fn note(&mut self, bowler: &Bowler, iteration: u64, state: &StateOf<Bowling>) {
        let (k, _) = bowler.scene.counts(&state.outcome);
        self.best = self.best.max(k);
        self.one += u64::from(k == 1);
        if bowler.scene.class(state).is_some() {
            self.both += 1;
            self.first.get_or_insert(iteration);
        }
    }

    /// How near the two pins come in the animation of a state with one of them down.
    fn look(&mut self, bowler: &Bowler, state: &StateOf<Bowling>) -> Result<()> {
        if bowler.scene.counts(&state.outcome).0 == 0 {
            return Ok(());
        }
        let animation = bowler.scene.animate(&state.draw)?;
        let mut pins = plan::pins(&animation).map(|(_, track)| track);
        let (Some(seven), Some(ten)) = (pins.next(), pins.next()) else { return Ok(()) };
        let steps = (animation.duration / 0.002) as u32;
        let apart = |k: u32| (seven.position(f64::from(k) * 0.002) - ten.position(f64::from(k) * 0.002)).length();
        self.nearest = (0..=steps).map(apart).fold(self.nearest, f64::min);
        self.touched += u64::from(first_touch(&animation, "pin_7", |other| other == "pin_10").is_some());
        self.looked += 1;
        Ok(())
    }
}

fn reach(bowler: &Bowler, chain: u32, rungs: u32, warmup: u64, iterations: u64) -> Result<Reached> {
    let fresh = Mixture::of(Box::new(Redraw));
    let tempering = Tempering { rungs, swap_every: SWAP_EVERY, warmup };
    let course = Course { target: &bowler.scene, moves: &bowler.moves, fresh: &fresh, tempering };
    let mut replicas = Replicas::start(course, Seed(1), chain)?;
    let mut reached = Reached::NOTHING;
    while replicas.iteration() < iterations {
        let mut moved = false;
        replicas.advance(replicas.iteration() + LOOK, |chain, step| {
            moved |= !matches!(step, TopStep::Step(step) if step.verdict != Verdict::Accepted);
            if matches!(step, TopStep::Step(_)) {
                reached.note(bowler, chain.iteration(), chain.state());
            }
        })?;
        if moved {
            reached.look(bowler, replicas.top().state())?;
        }
    }
    Ok(reached)
}

pub(super) fn make(work: &mut Work) -> Result<()> {
    let (warmup, iterations) = work.size((500, 10_000), (5, 50));
    let mut rows = Vec::new();
    for (shot, kind) in [(SEVEN_TEN_PAPER, "the paper's"), (SEVEN_TEN, "regulation")] {
        for rungs in [1, RUNGS] {
            work.say(format_args!("7-10, {kind} delivery, {rungs} rungs: {CHAINS} chains of {iterations} iterations"));
            rows.push(row(shot, kind, rungs, (work.size(CHAINS, 1), warmup, iterations))?);
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
    ];
    let mut text = table(&head, rows);
    text += &format!(
        "\n{} chains of {} iterations each (seed 1), at the target; with {RUNGS} rungs each chain has as many replicas, of which that at the target is told of. Every {LOOK} iterations, where the state is another with a pin down, its animation is \
         looked at. The two stand 914 mm apart. Nothing was tuned for this shot; no iteration with both down means that it was not bowled.\n",
        work.size(CHAINS, 1),
        thousands(iterations)
    );
    work.report.section("Bowling: the seven-ten split", &text);
    Ok(())
}

fn row(shot: Shot, kind: &str, rungs: u32, (chains, warmup, iterations): (u32, u64, u64)) -> Result<Vec<String>> {
    let bowler = shot.bowler()?;
    let all = (0..chains).into_par_iter().map(|chain| reach(&bowler, chain, rungs, warmup, iterations));
    let all = all.collect::<Result<Vec<_>>>()?.into_iter().fold(Reached::NOTHING, Reached::with);
    let first = all.first.map_or("never".into(), thousands);
    Ok(vec![
        kind.into(),
        rungs.to_string(),
        format!("{} of 2", all.best),
        thousands(all.one),
        format!("{} ({first})", thousands(all.both)),
        thousands(all.looked),
        if all.nearest.is_finite() { significant(1e3 * all.nearest, 3) } else { "–".into() },
        thousands(all.touched),
    ])
}
