//! `plaus chance`

use super::asking::How;
use super::shards;
use crate::clock::{Stopwatch, in_words, parse_duration};
use crate::console;
use crate::failure::{Failure, Outcome};
use crate::interrupt;
use crate::likely;
use crate::output;
use crate::scenario_file;
use crate::table::{grouped, short};
use plaus_mcmc::chance::ChancePulse;
use plaus_run::Shard;
use plaus_run::chance::{Asking, Chance, Inquiry, answers, ask, read};
use plaus_run::disk::RealDisk;
use plaus_scenes::scenario::ScenarioError;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread;
use std::time::Duration;

/// Time between two checks whether there is something to show, or a reason to stop.
const TICK: Duration = Duration::from_millis(50);
/// Seconds between two lines of progress: first, and at most.
const EVERY: [f64; 2] = [2.0, 60.0];

/// The advice if some batches are not made yet.
pub(super) const GOES_ON: &str = "run the same command again to continue";

/// The hidden file beside `path` that says why the piece written there failed, for `plaus status`.
pub(super) fn why_file(path: &Path) -> PathBuf {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    path.with_file_name(format!(".{name}.why"))
}

/// What to estimate, how, and where to keep the result.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Scenario file (TOML); or a file that `--out` wrote, to show it
    scenario: PathBuf,
    /// Seed of all randomness
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    seed: Option<u64>,
    /// Set any key of the scenario, e.g. `--set sigma_d=0.05`; may be given several times
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    #[command(flatten)]
    how: How,
    /// Iterations of each rung, after a warm-up of a quarter as many
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000_000_000))]
    iterations: Option<u64>,
    /// File to keep the batches in. If it already holds batches of this same estimate, continue it. With `--shard`, a
    /// file name `{shard}` or `{shard}.json` gets the number of the piece
    #[arg(long, alias = "output", value_name = "FILE.json")]
    out: Option<PathBuf>,
    /// Make only one piece of the batches, e.g. 3/16; `task/16` takes the number from HQ_TASK_ID or
    /// SLURM_ARRAY_TASK_ID. `plaus merge` puts the pieces together
    #[arg(long, value_name = "PIECE/PIECES", allow_hyphen_values = true, requires = "out")]
    shard: Option<String>,
    /// Number of threads; 0: one per core. Results do not depend on it
    #[arg(long, value_name = "T", default_value_t = 0)]
    threads: usize,
    /// Stop after this time, e.g. 60s, 1.5m or 2h, with the batches made so far
    #[arg(long, value_name = "TIME", value_parser = parse_duration, allow_hyphen_values = true)]
    max_time: Option<Duration>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Show no progress
    #[arg(short, long)]
    quiet: bool,
}

impl Args {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let shard = self.shard.as_deref().map(shards::named).transpose()?;
        let out = self.out.as_deref().map(|out| shards::place(out, shard));
        let done = self.ask(shard, out.as_deref());
        let (Some(_), Some(out)) = (shard, &out) else { return done };
        let why = match &done {
            Err(failure) => failure.message(),
            Ok(Outcome::Interrupted | Outcome::Unsatisfied) => Some(GOES_ON.to_owned()),
            Ok(Outcome::Done) => None,
        };
        // Nothing depends on this file, and most pieces have none.
        let _ = match why {
            Some(why) => std::fs::write(why_file(out), why),
            None => std::fs::remove_file(why_file(out)),
        };
        done
    }

    fn ask(&self, shard: Option<Shard>, out: Option<&Path>) -> Result<Outcome, Failure> {
        if self.scenario.extension().is_some_and(|end| end == "json") {
            let found = read(&self.scenario)?;
            let missing = || Failure::Message(format!("{}: there is no such file", self.scenario.display()));
            return self.say(&found.ok_or_else(missing)?);
        }
        interrupt::listen()?;
        let mut overrides = self.overrides.clone();
        overrides.extend(self.seed.map(|seed| format!("sampler.seed={seed}")));
        let recipe = scenario_file::read(&self.scenario, overrides, None)?;
        let asking = self.how.asking(Asking::new(recipe.plan().seed), self.iterations);
        let (pulse, over) = (ChancePulse::default(), AtomicBool::new(false));
        let methods = self.how.methods();
        let place = out.map(|path| (path, &RealDisk as &dyn plaus_run::disk::Disk));
        let inquiry = Inquiry { recipe: &recipe, asking, methods, shard, place, threads: self.threads, pulse: &pulse };
        let (clock, standing) = (Stopwatch::start(), Mutex::new((0, 0)));
        self.heed(clock, &pulse);
        let asked = thread::scope(|scope| {
            scope.spawn(|| self.look_on(clock, &pulse, &over, &standing));
            let shown = |chance: &Chance| {
                if let Ok(mut standing) = standing.lock() {
                    *standing = chance.done();
                }
            };
            let asked = ask(&inquiry, &shown);
            over.store(true, Relaxed);
            asked
        });
        let chance = asked.map_err(|error| match error {
            plaus_run::Error::Config(error) => {
                ScenarioError::locate(&self.scenario.display().to_string(), &recipe.text, &error).into()
            }
            other => Failure::from(other),
        })?;
        if !self.quiet {
            let (simulations, seconds) = (pulse.simulations(), clock.seconds());
            let pace = short(simulations as f64 / seconds);
            console::note_line(&format!("{} simulations in {}, {pace} /s", grouped(simulations), in_words(seconds)));
        }
        let said = self.say(&chance)?;
        let (done, due) = chance.done();
        if done < due && !self.json {
            let how = if out.is_some() { GOES_ON } else { "use `--out FILE.json` to be able to continue later" };
            console::note_line(&format!("{done} of {due} batches are made; {how}"));
        } else if let (Some(shard), false) = (shard, self.quiet) {
            console::note_line(&format!(
                "this is piece {shard}; once you have all pieces: plaus merge PIECES --out FILE.json"
            ));
        }
        Ok(match shard {
            _ if interrupt::asked() && done < due => Outcome::Interrupted,
            Some(_) if done < due => Outcome::Unsatisfied,
            Some(_) => Outcome::Done,
            None => said,
        })
    }

    /// Stops the work if the user asked for that, or if the time is over.
    fn heed(&self, clock: Stopwatch, pulse: &ChancePulse) {
        if interrupt::asked() || self.max_time.is_some_and(|most| clock.elapsed() >= most) {
            pulse.stop();
        }
    }

    fn look_on(&self, clock: Stopwatch, pulse: &ChancePulse, over: &AtomicBool, standing: &Mutex<(usize, usize)>) {
        let mut shown = Stopwatch::start();
        // Batches that a file held already.
        let mut had = None;
        while !over.load(Relaxed) {
            self.heed(clock, pulse);
            if let (None, Ok((done, 1..))) = (had, standing.lock().as_deref()) {
                had = Some(*done);
            }
            let every = (0.5 * clock.seconds()).clamp(EVERY[0], EVERY[1]);
            if !self.quiet && !self.json && shown.seconds() >= every {
                shown = Stopwatch::start();
                let (done, due) = standing.lock().map_or((0, 0), |standing| *standing);
                let made = done - had.unwrap_or(done);
                let left = || in_words(clock.seconds() * (due - done) as f64 / made as f64);
                let left = if made > 0 { format!(", about {} left", left()) } else { String::new() };
                let far = if due > 0 { format!("{done} of {due} batches{left}; ") } else { String::new() };
                let simulations = pulse.simulations();
                let pace = short(simulations as f64 / clock.seconds());
                console::note_line(&format!("{far}{} simulations, {pace} /s", grouped(simulations)));
            }
            thread::sleep(TICK);
        }
    }

    /// Prints the result; gives the command's outcome.
    fn say(&self, chance: &Chance) -> Result<Outcome, Failure> {
        let answers = answers(chance);
        let Some(all) = answers.first() else { return Ok(Outcome::Unsatisfied) };
        if self.json {
            output::print_line(&likely::to_json(chance).to_string())?;
        } else {
            output::print(&likely::in_words(chance))?;
        }
        let found = all.verdict.best.is_some_and(|best| best.probability > 0.0);
        Ok(if found && all.verdict.is_settled() { Outcome::Done } else { Outcome::Unsatisfied })
    }
}
