//! Compares chains with plain draws from the prior, made in the same process for as much processor time.

use crate::clock::ProcessorClock;
use crate::console;
use crate::failure::Failure;
use crate::interrupt;
use crate::output;
use crate::progress::Monitor;
use crate::table::{amount, grouped, short};
use plaus_mcmc::chance::{ChancePulse, Parts, count};
use plaus_mcmc::{Target, parallel, try_draws};
use plaus_run::{Diagnosis, RunReader};
use serde_json::json;

/// Draws between two checks of the clock.
const AT_A_TIME: u64 = 4;

/// Draws from the prior on one thread, for as much processor time as the chains took after their warm-up. Prints how
/// many independent solutions a minute of one processor gives, by chains and by plain draws.
pub(super) fn with_prior(
    run: &RunReader<'_>,
    diagnosis: &Diagnosis,
    monitor: &Monitor<'_>,
    as_json: bool,
) -> Result<(), Failure> {
    let share = diagnosis.share_after_warmup(monitor.done(), run.run().manifest().plan.warmup);
    let (Some(found), true) = (&diagnosis.independent, monitor.begun_at() == 0 && diagnosis.iterations > 0) else {
        console::note_line(
            "cannot compare with draws from the prior: that needs an uninterrupted run with solutions after its warm-up",
        );
        return Ok(());
    };
    let seconds = monitor.processor_seconds() * share;
    let clock = ProcessorClock::start();
    let goes_on = || clock.seconds() < seconds && !interrupt::asked();
    let (draws, hits) = parallel::alone(|| plain(run, &goes_on))?;
    let took = clock.seconds();
    let minute = |count: f64, seconds: f64| 60.0 * count / seconds;
    let (chains, prior) = (minute(found.ess, seconds), minute(hits as f64, took));
    if as_json {
        let object = json!({
            "event": "compare_prior",
            "processor_seconds": took,
            "draws": draws,
            "solutions": hits,
            "independent_a_minute": { "chains": chains, "prior": prior },
        });
        return output::print_line(&object.to_string());
    }
    let times = if hits > 0 { format!(": {} times as many", short(chains / prior)) } else { String::new() };
    console::note_line(&format!(
        "in a minute of one processor the chains make {} independent solutions, plain draws from the prior {} ({} of \
         {} draws){times}",
        amount(chains),
        amount(prior),
        grouped(hits),
        grouped(draws),
    ));
    Ok(())
}

/// Draws of the prior and solutions among them, for as long as it `goes_on`. Where the most that the constraint can be
/// is known, this is rejection, as `method = "independent"` does it: each draw is stopped as soon as it is certain not
/// to be kept, and what is kept are independent draws of what chains sample. Where it is not, draws are simulated to
/// their end, and each solution counts.
fn plain(run: &RunReader<'_>, goes_on: &(dyn Fn() -> bool + Sync)) -> Result<(u64, u64), Failure> {
    let manifest = run.run().manifest();
    manifest.judges_alone()?;
    let (pulse, scene, seed) = (ChancePulse::default(), run.scene(), manifest.plan.seed);
    let rejects = scene.most().is_some();
    let failed = |error: &dyn std::fmt::Display| Failure::Message(error.to_string());
    let mut sums = (0, 0);
    for batch in 0.. {
        if !goes_on() {
            break;
        }
        let (draws, found) = if rejects {
            let numbers = u64::from(batch) * AT_A_TIME..(u64::from(batch) + 1) * AT_A_TIME;
            let tried = match try_draws(scene, seed, numbers) {
                Err(_) if interrupt::asked() => break,
                tried => tried.map_err(|error| failed(&error))?,
            };
            (tried.draws, tried.kept)
        } else {
            let made = match count(scene, Parts::NONE, seed, batch, AT_A_TIME, &pulse) {
                Err(_) if interrupt::asked() => break,
                made => made.map_err(|error| failed(&error))?,
            };
            (made.draws, made.hits.first().copied().unwrap_or(0))
        };
        sums = (sums.0 + draws, sums.1 + found);
    }
    Ok(sums)
}
