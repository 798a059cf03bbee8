//! `plaus sample`, and what it shares with `plaus resume`.

use super::compare;
use super::confirm::{self, ACCURACY};
use super::is_undecided;
use super::shards;
use super::summary::{is_exhausted, longer, or_frame, sample_again, smaller, summary};
use super::wanted::Wanted;
use crate::clock::parse_duration;
use crate::console::{self, quoted};
use crate::failure::{Failure, Outcome};
use crate::interrupt;
use crate::output;
use crate::progress::{Monitor, Rounds, Stop, Style};
use crate::report;
use crate::scenario_file;
use crate::table::grouped;
use crate::waiting::Waiting;
use crate::why;
use plaus_mcmc::Ending;
use plaus_run::{Confirmation, Diagnosis, Folder, Manifest, Run, RunReader, Sampling, solutions};
use serde_json::{Value, json};
use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// The closing summary looks at this many draws of all chains together; `plaus diagnose` looks at all.
const SUMMARISED: u64 = 400_000;

/// How an override of the length of the warm-up begins.
const WARMUP: &str = "sampler.warmup";

/// What to sample, and how.
#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    wanted: Wanted,
    /// Folder to make for the run; must not exist. With `--shard`, a last part `{shard}` becomes the number of the
    /// piece
    #[arg(long, alias = "output", value_name = "RUN")]
    out: PathBuf,
    /// Sample only one piece of the run's chains, e.g. 3/16; `task/16` takes the number from HQ_TASK_ID or
    /// SLURM_ARRAY_TASK_ID. `plaus merge` puts the pieces together
    #[arg(long, value_name = "PIECE/PIECES", allow_hyphen_values = true)]
    shard: Option<String>,
    /// If the folder already holds this run, continue it; if another process writes it, wait
    #[arg(long = "continue")]
    go_on: bool,
    /// Replace the run that the folder holds
    #[arg(long, conflicts_with_all = ["go_on", "shard"])]
    force: bool,
    #[command(flatten)]
    watching: Watching,
}

/// The run that is watched.
pub(super) struct Watched<'a> {
    /// Its folder.
    pub(super) folder: &'a Folder,
    /// Whether to wait for another process that writes it.
    pub(super) waits: bool,
    /// The scenario file it was begun with, if it was begun by this command.
    pub(super) scenario: Option<&'a Path>,
    /// What else it was asked for, which a run that is not decided yet does not keep: words for `plaus resume`.
    pub(super) more: String,
}

impl Watched<'_> {
    /// Whether this command begins it, and never continues one that is there.
    fn is_new(&self) -> bool {
        self.scenario.is_some() && !self.waits
    }
}

/// What became of a run.
pub(super) enum Sampled<'a> {
    /// It was sampled.
    Run(Box<Monitor<'a>>, Ending),
    /// It was stopped before it was decided how it is sampled.
    Nothing(Box<Monitor<'a>>, Stop),
}

/// How progress is shown, and when the run stops.
#[derive(clap::Args)]
pub(crate) struct Watching {
    /// Number of threads; 0: one per core. Never more than there are cores or chains. Results do not depend on it
    #[arg(long, value_name = "T", default_value_t = 0, allow_negative_numbers = true)]
    threads: usize,
    /// Stop after this time, e.g. 60s, 1.5m or 2h; the run can be resumed. With `--solutions`, the
    /// iteration limit applies only to shards
    #[arg(long, value_name = "TIME", value_parser = parse_duration, allow_hyphen_values = true)]
    max_time: Option<Duration>,
    /// Print progress and the summary as JSON lines
    #[arg(long)]
    json: bool,
    /// Show no progress
    #[arg(short, long, conflicts_with = "verbose")]
    quiet: bool,
    /// Also show iterations, rates and each chain's acceptance
    #[arg(short, long)]
    verbose: bool,
    /// At the end, simulate every distinct solution again at reference accuracy, and list those that hold. It may take
    /// another `--max-time`
    #[arg(long)]
    confirm: bool,
    /// At the end, draw from the prior for as much processor time as the chains took after their warm-up, and count the
    /// solutions
    #[arg(long)]
    compare_prior: bool,
}

impl Args {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let Wanted { scenario, .. } = &self.wanted;
        let scenario = scenario.clone();
        let recipe = self.wanted.recipe(self.watching.max_time.is_some() && self.shard.is_none())?;
        if self.watching.confirm {
            plaus_run::confirm::possible(&recipe.scenario, ACCURACY)?;
        }
        let shard = self.shard.as_deref().map(shards::named).transpose()?;
        let folder = Folder::new(shards::place(&self.out, shard));
        let folder = if self.force { folder.replacing() } else { folder };
        let sample = if self.go_on { plaus_run::sample_or_go_on } else { plaus_run::sample_shard };
        let watched = Watched { folder: &folder, waits: self.go_on, scenario: Some(&scenario), more: String::new() };
        self.watching.watch(watched, |sampling| {
            sample(&folder, &recipe, shard, sampling).map_err(|error| scenario_file::located(error, &scenario, &recipe))
        })
    }
}

impl Watching {
    fn style(&self) -> Style {
        match (self.json, self.quiet) {
            (true, _) => Style::Json,
            (_, true) => Style::Silent,
            _ if console::is_live() => Style::Live,
            _ => Style::Plain,
        }
    }

    /// With everything as usual, for so long.
    pub(super) fn for_a_while(most: Duration, threads: usize) -> Self {
        Self {
            threads,
            max_time: Some(most),
            json: false,
            quiet: false,
            verbose: false,
            confirm: false,
            compare_prior: false,
        }
    }

    /// Runs `sampling`, shows its progress, and sums up.
    pub(super) fn watch(
        &self,
        watched: Watched<'_>,
        sampling: impl FnOnce(Sampling<'_>) -> Result<Ending, Failure>,
    ) -> Result<Outcome, Failure> {
        interrupt::listen()?;
        match self.sampled(&watched, &|| false, sampling)? {
            Sampled::Run(monitor, ending) => self.sum_up(&watched, &monitor, ending),
            Sampled::Nothing(monitor, stop) => {
                let (why, ending, outcome) = match stop {
                    Stop::OutOfTime => ("out of time", "stopped", Outcome::Unsatisfied),
                    Stop::Interrupted => ("interrupted", "interrupted", Outcome::Interrupted),
                };
                if self.json {
                    let end = json!({ "event": "end", "ending": ending, "iteration": 0 });
                    output::print_line(&end.to_string())?;
                }
                let left = match is_undecided(watched.folder)? {
                    true => format!(
                        "continue with: plaus resume {}{}{}\n(`--set sampler.method=chain` begins a new run at once)",
                        quoted(watched.folder.path()),
                        watched.more,
                        monitor.as_long_again()
                    ),
                    false => "the run that it was to replace is as it was".to_owned(),
                };
                console::note_line(&format!("{why} while choosing how to sample; {left}"));
                Ok(outcome)
            }
        }
    }

    /// Runs `sampling` and shows its progress, until `is_over` at the latest.
    pub(super) fn sampled<'a>(
        &self,
        watched: &Watched<'_>,
        is_over: &'a (dyn Fn() -> bool + Sync),
        sampling: impl FnOnce(Sampling<'_>) -> Result<Ending, Failure>,
    ) -> Result<Sampled<'a>, Failure> {
        let monitor = Monitor::new(self.style(), self.verbose, self.max_time, watched.folder, is_over);
        let chooses = || watched.is_new() || is_undecided(watched.folder).unwrap_or(false);
        let may_choose = !self.json && !self.quiet && chooses();
        let waiting =
            Cell::new(may_choose.then(|| Waiting::on("choosing how to sample (`plaus explain method`)".into())));
        let opening = |manifest: &Manifest, done| {
            drop(waiting.take());
            self.open(watched, manifest, done);
        };
        let mut rounds = Rounds::new(&monitor, &opening, watched.waits);
        let ended = monitor.over(|| sampling(Sampling::new(self.threads(), &mut rounds)));
        drop(waiting);
        monitor.signal_end(ended.as_ref());
        let ended = ended?;
        if let (Ending::Stopped, Some(stop), false) = (ended, monitor.stop(), monitor.has_begun())
            && (watched.is_new() || is_undecided(watched.folder)?)
        {
            return Ok(Sampled::Nothing(Box::new(monitor), stop));
        }
        Ok(Sampled::Run(Box::new(monitor), ended))
    }

    /// The number of threads asked for, limited by the number of cores.
    fn threads(&self) -> usize {
        self.threads.min(cores())
    }

    /// Whether to confirm solutions.
    pub(super) fn confirms(&self) -> bool {
        self.confirm
    }

    fn open(&self, watched: &Watched<'_>, manifest: &Manifest, done: u64) {
        let folder = watched.folder;
        if watched.scenario.is_none() {
            scenario_file::tell_edited(manifest, folder.path());
        }
        if self.json {
            let begin = json!({
                "event": "begin",
                "run": folder.path().display().to_string(),
                "plaus": manifest.plaus,
                "scene": manifest.scene,
                "seed": manifest.plan.seed,
                "scenario_hash": manifest.scenario.hash,
                "exact_acceptance": manifest.exact,
                "plan": manifest.plan,
                "way": manifest.way,
                "iteration": done,
            });
            // If the reader has gone, the end of the run will report it.
            let _ = output::print_line(&begin.to_string());
        } else if self.quiet {
            console::note_line(&format!("seed {}", manifest.plan.seed));
        } else {
            console::note_line(&report::headline(manifest));
            if let Some(way) = report::way(manifest) {
                console::note_line(&way);
            }
            if done > 0 {
                console::note_line(&format!("continuing from iteration {}", grouped(done)));
            }
            let plan = &manifest.plan;
            if done == 0 && plan.enough().is_none() && plan.warmup > plan.iterations {
                let (warmup, iterations) = (grouped(plan.warmup), grouped(plan.iterations));
                console::remark(&format!(
                    "a warm-up of {warmup} iterations comes first. It is longer than the {iterations} iterations asked \
                     for, and statistics leave it out. To shorten it: --warmup {}",
                    plan.iterations
                ));
            }
            if done == 0 && manifest.is_independent() && manifest.overrides.iter().any(|set| set.starts_with(WARMUP)) {
                console::remark("independent draws need no warm-up, so there is none");
            }
        }
        let useful = plaus_mcmc::useful_threads(self.threads(), &manifest.plan, &manifest.chains());
        if useful < self.threads && !self.json && !self.quiet {
            let why = if useful < self.threads() { "chains" } else { "cores" };
            let (asked, used) = (grouped(self.threads as u64), grouped(useful as u64));
            console::remark(&format!("using {used} of {asked} threads, because there are no more {why}"));
        }
        if let Some(warning) = report::warning(manifest) {
            console::note_line(&warning);
        }
    }

    fn sum_up(&self, watched: &Watched<'_>, monitor: &Monitor<'_>, ending: Ending) -> Result<Outcome, Failure> {
        let folder = watched.folder;
        let path = quoted(folder.path());
        if monitor.stop() == Some(Stop::Interrupted) && ending == Ending::Stopped {
            return self.interrupted(&path, monitor);
        }
        let run = Run::open(folder)?;
        let reader = run.reader()?.interrupted_by(interrupt::flag());
        let diagnosis = Diagnosis::of(&reader, Some(SUMMARISED / run.manifest().chains().len().max(1) as u64))?;
        let confirmed = if self.confirm {
            let flag = interrupt::flag_within(self.max_time);
            let timed = run.reader()?.interrupted_by(Arc::clone(&flag));
            let list = confirm::confirm(&timed, &flag, self.threads(), !self.json && !self.quiet)?;
            if list.left > 0 {
                console::note_line(&confirm::cut_in_words(&run, &list));
                return Ok(Outcome::Interrupted);
            }
            Some(list)
        } else {
            None
        };
        if self.json {
            let end = end_as_json(&reader, &diagnosis, monitor, ending, confirmed.as_ref())?;
            output::print_line(&end.to_string())?;
        } else if !self.quiet {
            output::print(&summary(&reader, watched.scenario, &diagnosis, monitor, ending))?;
        }
        if self.compare_prior {
            compare::with_prior(&reader, &diagnosis, monitor, self.json)?;
        }
        if run.manifest().shard.is_some() {
            return self.end_of_piece(&run, ending);
        }
        let is_satisfied = self.tell_what_is_missing(&reader, watched.scenario, &diagnosis, monitor, ending)?;
        if is_empty(&diagnosis, ending) {
            return Ok(Outcome::Unsatisfied); // the summary says why
        }
        if let Some(list) = confirmed.as_ref().filter(|_| !self.json) {
            console::note_line(&confirm::in_words(&run, list));
        }
        let holds = confirmed.is_none_or(|list| list.held > 0);
        Ok(if is_satisfied && holds { Outcome::Done } else { Outcome::Unsatisfied })
    }

    fn interrupted(&self, path: &str, monitor: &Monitor<'_>) -> Result<Outcome, Failure> {
        if self.json {
            let end = json!({ "event": "end", "ending": "interrupted", "iteration": monitor.done() });
            output::print_line(&end.to_string())?;
        }
        let left = match monitor.done() {
            _ if !monitor.has_begun() => "before it went on".to_owned(),
            0 => "before all chains had started, so nothing is kept".to_owned(),
            done => format!("after iteration {}, with a checkpoint", grouped(done)),
        };
        console::note_line(&format!("interrupted {left}; continue with: plaus resume {path}"));
        Ok(Outcome::Interrupted)
    }

    /// Whether the run found what it was asked for. If it did not, says what is missing and how to continue.
    fn tell_what_is_missing(
        &self,
        run: &RunReader<'_>,
        scenario: Option<&Path>,
        diagnosis: &Diagnosis,
        monitor: &Monitor<'_>,
        ending: Ending,
    ) -> Result<bool, Failure> {
        let (plan, tally, path) = (run.run().manifest().plan, &diagnosis.tally, quoted(run.run().folder().path()));
        let missing = plan.enough().filter(|&wanted| tally.distinct < wanted);
        let has_none = !tally.is_satisfied() && !is_empty(diagnosis, ending);
        if let Some(wanted) = missing.filter(|_| !has_none) {
            let found = tally.distinct;
            let newest = solutions::distinct(run)?.last().map_or(0, |solution| solution.iteration);
            let has_all = found > 0 && ending == Ending::Complete && is_exhausted(newest, monitor.done());
            let advice = if has_all {
                let again = sample_again(run.run(), scenario, wanted, smaller(found, wanted));
                let (newest, done) = (grouped(newest), grouped(monitor.done()));
                format!(
                    ", the last of them at iteration {newest} of {done}. There are hardly any more that differ as \
                     much. To count smaller differences (`plaus explain distinct`): {again}{}",
                    or_frame(run.run())
                )
            } else {
                let more = if ending == Ending::Complete { longer(&plan) } else { String::new() };
                format!("; continue with: plaus resume {path}{more}{}", monitor.as_long_again())
            };
            console::note_line(&format!("only {found} of the {wanted} distinct solutions were found{advice}"));
        }
        if !has_none {
            return Ok(missing.is_none());
        }
        let tally = why::of_run(run)?;
        if !self.json && !self.quiet && tally.states > 0 {
            console::note_line(&why::in_words(run.scene(), &tally, "recorded states"));
        }
        if monitor.done() <= plan.warmup && ending == Ending::Stopped {
            let phase = if plan.warmup > 0 { "still in the warm-up, and no" } else { "no" };
            console::note_line(&format!(
                "{phase} iteration has satisfied the constraint yet; continue with: plaus resume {path}{}",
                monitor.as_long_again()
            ));
            return Ok(false);
        }
        console::note_line(&format!(
            "no sample satisfies the constraint: ask for less (`plaus check SCENARIO --draws 100` counts how often each \
             requirement is met by chance), or go on with: plaus resume {path}{}{}",
            if ending == Ending::Complete { longer(&plan) } else { String::new() },
            monitor.as_long_again()
        ));
        Ok(false)
    }
}

/// Whether a run came to its end without recording anything that can be diagnosed.
fn is_empty(diagnosis: &Diagnosis, ending: Ending) -> bool {
    diagnosis.draws == 0 && ending == Ending::Complete
}

/// The last line of `--json`.
fn end_as_json(
    run: &RunReader<'_>,
    diagnosis: &Diagnosis,
    monitor: &Monitor<'_>,
    ending: Ending,
    confirmed: Option<&Confirmation>,
) -> Result<Value, Failure> {
    let mut end = report::to_json(run.run().manifest(), diagnosis);
    end["event"] = json!("end");
    end["ending"] = json!(ending_in_words(ending));
    end["seconds"] = json!(monitor.seconds());
    end["iterations_per_second"] = json!(monitor.rate());
    if !diagnosis.tally.is_satisfied() {
        end["asked"] = why::to_json(run.scene(), &why::of_run(run)?);
    }
    if let Some(list) = confirmed {
        let (held, checked) = (list.held, list.solutions.len());
        end["confirmed"] = json!({ "accuracy": list.accuracy.name(), "checked": checked, "held": held });
    }
    Ok(end)
}

impl Watching {
    /// A piece that came to its end is as it should be, whatever it found: only the whole run is asked for results.
    fn end_of_piece(&self, run: &Run, ending: Ending) -> Result<Outcome, Failure> {
        let path = quoted(run.folder().path());
        if ending == Ending::Stopped {
            console::note_line(&format!("this piece is not finished; continue with: plaus resume {path}"));
            return Ok(Outcome::Unsatisfied);
        }
        if !self.quiet {
            console::note_line("this is one piece; once you have all pieces: plaus merge PIECES --out RUN");
        }
        Ok(Outcome::Done)
    }
}

fn ending_in_words(ending: Ending) -> &'static str {
    match ending {
        Ending::Complete => "complete",
        Ending::EnoughSolutions => "enough_solutions",
        Ending::Stopped => "stopped",
    }
}

/// Cores that this process may use.
fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}
