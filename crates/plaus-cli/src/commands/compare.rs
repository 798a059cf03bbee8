//! Compares chains with plain draws from the prior, made in the same process for as much processor time.

use crate::clock::ProcessorClock;
use crate::console;
use crate::failure::Failure;
use crate::interrupt;
use crate::output;
use crate::progress::Monitor;
use crate::table::{amount, grouped, short};
use plaus_mcmc::chance::{ChancePulse, Parts, count};
use plaus_run::{Diagnosis, RunReader};
use serde_json::json;

/// Draws between two checks of the clock.
const AT_A_TIME: u64 = 4;

/// Draws from the prior on one thread, for as much processor time as the chains took after their warm-up. Prints how
/// many independent solutions a minute of one processor gives, by chains and by plain draws.
pub(super) fn with_prior(
    run: &RunReader<'_>,
    diagnosis: &Diagnosis,
    monitor: &Monitor,
    as_json: bool,
) -> Result<(), Failure> {
    let share = diagnosis.iterations as f64 / monitor.done().saturating_sub(monitor.begun_at()).max(1) as f64;
    let (Some(found), true) = (&diagnosis.independent, share <= 1.0) else {
        console::note_line(
            "cannot compare with draws from the prior: that needs an uninterrupted run with solutions after its warm-up",
        );
        return Ok(());
    };
    let seconds = monitor.processor_seconds() * share;
    let clock = ProcessorClock::start();
    let (draws, hits) = plain(run, &|| clock.seconds() < seconds && !interrupt::asked())?;
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

/// Draws of the prior and hits among them, for as long as it `goes_on`.
fn plain(run: &RunReader<'_>, goes_on: &dyn Fn() -> bool) -> Result<(u64, u64), Failure> {
    let manifest = run.run().manifest();
    manifest.judges_alone()?;
    let (pulse, mut sums) = (ChancePulse::default(), (0, 0));
    for batch in 0.. {
        if !goes_on() {
            break;
        }
        let made = count(run.scene(), Parts::NONE, manifest.plan.seed, batch, AT_A_TIME, &pulse);
        let made = made.map_err(|error| Failure::Message(error.to_string()))?;
        sums = (sums.0 + made.draws, sums.1 + made.hits.first().copied().unwrap_or(0));
    }
    Ok(sums)
}
