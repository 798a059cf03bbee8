//! `plaus diagnose`

use crate::clock::ProcessorClock;
use crate::console::{self, quoted};
use crate::failure::{Failure, Outcome};
use crate::output;
use crate::table::{amount, counted, grouped};
use crate::waiting::Waiting;
use crate::{plots, report};
use plaus_mcmc::Pulse;
use plaus_run::pace::pace;
use plaus_run::{Beside, ChainPhase, Diagnosis, RunReader, Tally};
use serde_json::json;
use std::path::PathBuf;
use std::thread;
use std::time::Duration;

/// Which run.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Folder of the run
    run: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Draw traces, autocorrelations, ranks and acceptance into this folder, as SVG
    #[arg(long, value_name = "FOLDER")]
    plots: Option<PathBuf>,
    /// Replace the folder of plots, if plaus made it
    #[arg(long, requires = "plots")]
    force: bool,
}

/// How many draws each chain of a run has among which there may be solutions.
pub(super) fn draws_that_count(run: &RunReader<'_>) -> u64 {
    let looks_for_solutions = run.run().manifest().plan.solutions.is_some();
    // Draws of a warm-up without solutions are of no use where solutions are not looked for.
    let is_of_use = |phase: ChainPhase| {
        phase.is_sampling() || looks_for_solutions || Tally::of(run).is_ok_and(|tally| tally.distinct > 0)
    };
    run.counted().iter().filter(|&&phase| run.draws(phase) > 0 && is_of_use(phase)).map(|&phase| run.draws(phase)).sum()
}

/// How long a run's chains are continued to measure how fast they are here.
const TRIED: Duration = Duration::from_millis(300);

/// Continues a chain for a moment without recording anything; gives the seconds that an iteration takes.
fn seconds_each(run: &RunReader<'_>) -> Option<f64> {
    let (pulse, clock) = (Pulse::default(), ProcessorClock::start());
    let made = thread::scope(|scope| {
        scope.spawn(|| {
            thread::sleep(TRIED);
            pulse.stop();
        });
        pace(run, &pulse)
    });
    // Where no pace can be measured, none is shown.
    made.ok().flatten().filter(|&made| made > 0).map(|made| clock.seconds() / made as f64)
}

/// The number of independent solutions, and how many a minute of one processor gives here.
fn at_this_pace(run: &RunReader<'_>, diagnosis: &Diagnosis) -> String {
    let Some(found) = &diagnosis.independent else { return String::new() };
    let mut text = report::independent(diagnosis, None);
    let iterations = diagnosis.iterations as f64 * run.chains().len() as f64;
    if let Some(each) = seconds_each(run) {
        let minute = amount(60.0 * found.ess / (iterations * each));
        text.insert_str(text.find(" (").unwrap_or(text.len()), &format!(", {minute} a minute of one processor here"));
    }
    text
}

impl Args {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let run = super::opened(&self.run, false, "shows")?;
        let reader = run.reader()?;
        if reader.draws(ChainPhase::Sampling) == 0 {
            return Err(super::no_draws(&reader));
        }
        if let Some(folder) = &self.plots {
            let out = folder.display().to_string();
            let made = plots::write(&reader, folder, self.force).map_err(|error| Failure::from(error).about(&out))?;
            console::note_line(&format!("{out}: {made} plots"));
        }
        let diagnosis = Diagnosis::of(&reader, None)?;
        let manifest = run.manifest();
        let waiting = Waiting::on("comparing with draws from the prior".to_owned());
        let beside = Beside::of(&reader, &diagnosis)?;
        drop(waiting);
        let is_healthy = diagnosis.is_healthy() && beside.as_ref().is_none_or(|beside| beside.missed.is_none());
        if manifest.plan.enough().is_some_and(|wanted| diagnosis.tally.distinct >= wanted)
            && reader.iterations() < manifest.plan.end()
        {
            console::remark(&format!(
                "this run ended once it had its {}, after {} of {} iterations: too few for statistics, which need \
                 `plaus resume {} --solutions all`",
                counted(diagnosis.tally.distinct, "solution"),
                grouped(reader.iterations()),
                grouped(manifest.plan.end()),
                quoted(&self.run),
            ));
        }
        if let Some(warning) = report::warning(manifest) {
            console::note_line(&warning);
        }
        if self.json {
            let mut object = report::to_json(manifest, &diagnosis);
            object["beside_prior"] = json!(beside);
            object["healthy"] = json!(is_healthy);
            output::print_line(&object.to_string())?;
        } else {
            let solutions = report::solutions(manifest, &diagnosis)
                + &report::failures(&diagnosis.tally.failures)
                + &at_this_pace(&reader, &diagnosis)
                + &report::tempering(manifest, &diagnosis, None);
            let some = match diagnosis.stride {
                1 => String::new(),
                stride => {
                    format!("(effective draws and R-hat from one draw in {stride}, means and deviations from all)\n")
                }
            };
            let (found, unknown) = beside.as_ref().map(report::beside).unwrap_or_default();
            let findings = report::findings(&diagnosis.findings) + &found;
            let verdict = if is_healthy { "no sign of poor convergence\n" } else { "findings:\n" };
            output::print(&format!(
                "{}\n{solutions}\n{}{some}\n{}\n{}{verdict}{findings}{unknown}",
                report::headline(manifest),
                report::scalar_table(&diagnosis, usize::MAX),
                report::move_table(manifest, &diagnosis),
                report::scale_table(&diagnosis),
            ))?;
        }
        Ok(if is_healthy { Outcome::Done } else { Outcome::Unsatisfied })
    }
}
