//! Why nothing was found: how often each requirement was met, by draws from the prior or by the states of a run.

use crate::clock::ProcessorClock;
use crate::report;
use crate::table::{grouped, lay_out, percent, short};
use crate::waiting;
use plaus_mcmc::{ModelError, State, StateRefOf, Target};
use plaus_run::{ChainPhase, RunFileError, RunReader};
use plaus_scenes::require::{Clause, Ended, Missed, Tally, each_of_prior};
use plaus_scenes::{Scene, Stage};
use serde_json::{Value, json};

/// Seconds of the processor after which [`some_of_prior`] makes no further draw.
const PATIENCE: f64 = 0.5;

/// As many draws from the prior as a moment allows, at most `draws`.
pub(crate) fn some_of_prior(scene: &Stage, seed: u64, draws: u64) -> Result<Tally, ModelError> {
    let clock = ProcessorClock::start();
    Tally::of_prior(scene, seed, draws, |_| clock.seconds() < PATIENCE)
}

/// So many draws from the prior of a scene, each of which is also shown to `look`.
pub(crate) fn of_prior(
    scene: &Stage,
    seed: u64,
    draws: u64,
    mut look: impl FnMut(StateRefOf<'_, Stage>),
) -> Result<Tally, ModelError> {
    let mut tally = Tally::new(scene.asked());
    each_of_prior(scene, seed, draws, |nth, state, scratch| {
        tally.add(scene, state);
        tally.ended(scene, state, scratch);
        look(state);
        // A hundred times in all.
        if (nth + 1) % draws.div_ceil(100) == 0 {
            waiting::far(nth + 1, draws, "draws");
        }
        true
    })?;
    Ok(tally)
}

/// Most states of a run that are simulated again, to see how they end, and seconds of the processor for that.
const AGAIN: usize = 100;
const AGAIN_FOR: f64 = 2.0;

/// All recorded states of a run, including those of the warm-up; some of them, spread evenly, are simulated again.
pub(crate) fn of_run(run: &RunReader<'_>) -> Result<Tally, RunFileError> {
    let scene = run.scene();
    let (mut tally, mut some, mut every) = (Tally::new(scene.asked()), Vec::new(), 1);
    for chain in run.chains() {
        for phase in [ChainPhase::Warmup, ChainPhase::Sampling] {
            run.walk(chain, phase, |repeats| -> Result<(), RunFileError> {
                if tally.states % every == 0 {
                    some.push(repeats.entry.state.draw.clone());
                }
                if some.len() > AGAIN {
                    // Every second of those: they lie at multiples of twice as much.
                    (some, every) = (some.drain(..).step_by(2).collect(), 2 * every);
                }
                tally.add(scene, repeats.entry.state.by_ref());
                Ok(())
            })?;
        }
    }
    let (clock, mut scratch) = (ProcessorClock::start(), <Stage as Target>::Scratch::default());
    for draw in some {
        if clock.seconds() > AGAIN_FOR {
            break;
        }
        // What cannot be simulated is no state of a run that can be read.
        let Ok(state) = State::evaluate(scene, draw, &mut scratch) else { break };
        tally.ended(scene, state.by_ref(), &scratch);
    }
    Ok(tally)
}

/// How draws ended, in one line; empty if all came to rest, or the scene does not tell.
fn ends(tally: &Tally) -> String {
    let ends = &tally.ends;
    if ends.all_rest() {
        return String::new();
    }
    let ways = ends.ways().into_iter().map(|(how, count, body)| {
        let cause = body.map(|body| format!(" ({body})")).unwrap_or_default();
        format!("{how}{cause}: {}", percent(count as f64 / ends.draws as f64))
    });
    let never = if ends.ways().iter().any(|(how, ..)| *how == Ended::REST) { "" } else { "never came to rest; " };
    let of = if ends.draws < tally.states {
        format!(" (of {} simulated again)", grouped(ends.draws))
    } else {
        String::new()
    };
    format!("how they ended{of}: {never}{}\n", ways.collect::<Vec<_>>().join("; "))
}

/// Why something never came to rest, if the ends of draws tell: nothing stops what spins. (What rolls without end is
/// told by the notes on the world.)
fn never_rests(tally: &Tally) -> Option<String> {
    let spins = tally.ends.ways().into_iter().find(|(how, ..)| how.starts_with(Ended::SPINS));
    spins.map(|(.., body)| {
        let body = body.unwrap_or("a body");
        format!("{body} spins on the spot for ever unless a material sets `rolling` or `spinning`, such as 0.01")
    })
}

/// Whether no state came anywhere near what is asked for.
fn never_happened(scene: &Stage, thing: usize, clause: &Clause) -> bool {
    clause.met == 0 && clause.lacks.is_empty() && matches!(scene.missed(thing, clause.best), Some(Missed::Never))
}

/// Whether something should come to rest.
fn is_of_rest(clause: &Clause) -> bool {
    clause.name.contains("rests_at")
}

/// How near to being met the best of all states came, if none met it.
fn nearest(scene: &Stage, thing: usize, clause: &Clause) -> String {
    let lacks = &clause.lacks;
    match scene.missed(thing, clause.best) {
        _ if clause.met > 0 => String::new(),
        Some(Missed::By(by, unit)) if lacks.is_empty() => format!("missed by {}", amount(by, unit)),
        Some(Missed::By(by, unit)) => format!("missed by {}: {lacks}", amount(by, unit)),
        _ if !lacks.is_empty() => lacks.clone(),
        Some(Missed::Never) => "never happened".to_owned(),
        // It says no more than that it is not met.
        None if clause.best > -1e-9 => String::new(),
        None => format!("{} nat (`plaus explain nat`)", short(clause.best)),
    }
}

/// A number with its unit: "1 pin", "2 pins".
fn amount(by: f64, unit: &str) -> String {
    let is_word = unit.len() > 3 && unit.chars().all(char::is_alphabetic);
    let number = if is_word && by.fract() == 0.0 { grouped(by as u64) } else { short(by) };
    let one = unit.strip_suffix('s').filter(|_| is_word && number == "1");
    format!("{number} {}", one.unwrap_or(unit))
}

/// Those requirements that no state met, each with how near the best came.
pub(crate) fn never_met(scene: &Stage, tally: &Tally) -> Vec<String> {
    let unmet = tally.clauses.iter().enumerate().filter(|(_, clause)| clause.met == 0);
    let told = |(thing, clause): (usize, &Clause)| match nearest(scene, thing, clause) {
        how if how.is_empty() => clause.name.clone(),
        how if never_happened(scene, thing, clause) => {
            let hint = if is_of_rest(clause) { never_rests(tally) } else { None };
            let hint = hint.map(|hint| format!("; {hint}")).unwrap_or_default();
            format!("{}: it {how}{hint}", clause.name)
        }
        how => format!("{} (the nearest: {how})", clause.name),
    };
    unmet.map(told).collect()
}

/// A table of how often each requirement was met, with the pairs that were never met together.
pub(crate) fn in_words(scene: &Stage, tally: &Tally, states: &str) -> String {
    let head = ["requirement".to_owned(), format!("met by {states}"), String::new(), "nearest, if none".to_owned()];
    let row = |(thing, clause): (usize, &Clause)| {
        let share = percent(clause.met as f64 / tally.states as f64);
        vec![clause.name.clone(), grouped(clause.met), share, nearest(scene, thing, clause)]
    };
    let all = (tally.clauses.len() > 1).then(|| {
        let share = percent(tally.all as f64 / tally.states as f64);
        vec!["all of them".to_owned(), grouped(tally.all), share]
    });
    let rows: Vec<Vec<String>> =
        std::iter::once(head.to_vec()).chain(tally.clauses.iter().enumerate().map(row)).chain(all).collect();
    let mut text = format!("of {} {states}:\n{}", grouped(tally.states), lay_out(&rows));
    let mut clauses = tally.clauses.iter().enumerate();
    let rests_never = clauses.any(|(thing, clause)| is_of_rest(clause) && never_happened(scene, thing, clause));
    if rests_never && let Some(hint) = never_rests(tally) {
        text += &format!("it never came to rest: {hint}\n");
    }
    text += &ends(tally);
    text += &report::failures(&tally.failures);
    for [one, other] in tally.never_together() {
        text += &format!("never met together: {one}; {other}\n");
    }
    text
}

/// What `plaus check --draws N --json` prints.
#[must_use]
pub fn to_json(scene: &Stage, tally: &Tally) -> Value {
    let clause = |(thing, clause): (usize, &Clause)| {
        let best = Some(clause.best).filter(|best| best.is_finite());
        let missed = match best.filter(|best| *best < 0.0).and_then(|best| scene.missed(thing, best)) {
            Some(Missed::By(by, unit)) => Some(json!({ "by": by, "unit": unit })),
            Some(Missed::Never) | None => None,
        };
        let lacks = Some(&clause.lacks).filter(|_| clause.met == 0);
        json!({ "asked": clause.name, "met": clause.met, "best_margin": best, "missed": missed, "lacks": lacks })
    };
    let clauses: Vec<Value> = tally.clauses.iter().enumerate().map(clause).collect();
    let end = |(how, count, body)| json!({ "how": how, "count": count, "body": body });
    let ends: Vec<Value> = tally.ends.ways().into_iter().map(end).collect();
    json!({
        "states": tally.states,
        "all": tally.all,
        "clauses": clauses,
        "never_together": tally.never_together(),
        "ends": ends,
        "failures": report::failures_to_json(&tally.failures),
    })
}
