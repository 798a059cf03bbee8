//! `plaus chance`

use super::shards;
use crate::clock::{Stopwatch, in_words, parse_duration};
use crate::console;
use crate::failure::{Failure, Outcome};
use crate::interrupt;
use crate::scenario_file;
use crate::table::{grouped, lay_out, percent, short};
use plaus_mcmc::chance::{ChancePulse, Estimate, Method};
use plaus_run::chance::{Answer, Asking, Chance, Inquiry, answers, ask, read};
use plaus_run::disk::RealDisk;
use plaus_scenes::scenario::ScenarioError;
use serde_json::json;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread;
use std::time::Duration;

/// How often it is looked whether there is something to show, or a reason to stop.
const TICK: Duration = Duration::from_millis(50);
/// Seconds between two lines of progress: first, and at most.
const EVERY: [f64; 2] = [2.0, 60.0];

/// Of what, how, and where to keep it.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Scenario file (TOML), or a file that `--out` wrote, to be shown
    scenario: PathBuf,
    /// Seed of all randomness
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    seed: Option<u64>,
    /// Set any key of the scenario, e.g. `--set sigma_d=0.05`; may be given several times
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    /// Use this method; may be given several times. Unless given: counting, and all three where few draws hit
    #[arg(long, value_name = "METHOD", value_enum)]
    method: Vec<Way>,
    /// Batches of each method: independent of each other, each as much work. Four times as many halve the error
    #[arg(long, value_name = "B", value_parser = clap::value_parser!(u32).range(2..=100_000))]
    batches: Option<u32>,
    /// Draws of the prior that a batch counts
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    draws: Option<u64>,
    /// Particles of a batch of splitting
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=10_000_000))]
    particles: Option<u32>,
    /// Steps that a copied particle makes
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    steps: Option<u64>,
    /// Rungs of a batch of stepping stones
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=256))]
    rungs: Option<u32>,
    /// Iterations of each rung, after a warm-up of a quarter as many
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000_000_000))]
    iterations: Option<u64>,
    /// File to keep the batches in. Where it holds some of this very asking, goes on with it. With `--shard`, `{shard}`
    /// as its last part stands for the number of the piece
    #[arg(long, alias = "output", value_name = "FILE.json")]
    out: Option<PathBuf>,
    /// Make only one piece of the batches, e.g. 3/16; `task/16` takes the number from HQ_TASK_ID or
    /// SLURM_ARRAY_TASK_ID. `plaus merge` puts pieces together
    #[arg(long, value_name = "PIECE/PIECES", allow_hyphen_values = true, requires = "out")]
    shard: Option<String>,
    /// Number of threads; 0: one per core. Results do not depend on it
    #[arg(long, value_name = "T", default_value_t = 0)]
    threads: usize,
    /// Stop after this time, e.g. 60s, 1.5m or 2h, with the batches that are there
    #[arg(long, value_name = "TIME", value_parser = parse_duration, allow_hyphen_values = true)]
    max_time: Option<Duration>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Show no progress
    #[arg(short, long)]
    quiet: bool,
}

/// A method, as the command line calls it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Way {
    /// Draws of the prior, counted
    Counting,
    /// Particles that climb the constraint
    Splitting,
    /// Chains on a ladder between prior and target
    Stones,
}

impl From<Way> for Method {
    fn from(way: Way) -> Self {
        match way {
            Way::Counting => Self::Counting,
            Way::Splitting => Self::Splitting,
            Way::Stones => Self::Stones,
        }
    }
}

impl Args {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        if self.scenario.extension().is_some_and(|end| end == "json") {
            let found = read(&self.scenario)?;
            let missing = || Failure::Message(format!("{}: there is no such file", self.scenario.display()));
            return self.say(&found.ok_or_else(missing)?);
        }
        interrupt::listen()?;
        let shard = self.shard.as_deref().map(shards::named).transpose()?;
        let out = self.out.as_deref().map(|out| shards::folder(out, shard));
        let mut overrides = self.overrides.clone();
        overrides.extend(self.seed.map(|seed| format!("sampler.seed={seed}")));
        let recipe = scenario_file::read(&self.scenario, overrides, None)?;
        let asking = self.asking(Asking::new(recipe.plan().seed));
        let (pulse, over) = (ChancePulse::default(), AtomicBool::new(false));
        let methods = self.method.iter().copied().map(Method::from).collect();
        let place = out.as_deref().map(|path| (path, &RealDisk as &dyn plaus_run::disk::Disk));
        let inquiry = Inquiry { recipe: &recipe, asking, methods, shard, place, threads: self.threads, pulse: &pulse };
        let (clock, standing) = (Stopwatch::start(), Mutex::new((0, 0)));
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
            let how = if out.is_some() { "the same command goes on" } else { "with `--out FILE.json` it could go on" };
            console::note_line(&format!("{done} of {due} batches are made; {how}"));
        } else if let (Some(shard), false) = (shard, self.quiet) {
            console::note_line(&format!(
                "this is piece {shard}; when all are there: plaus merge PIECES --out FILE.json"
            ));
        }
        let piece = shard.is_some() && done == due;
        Ok(if interrupt::asked() && done < due {
            Outcome::Interrupted
        } else if piece {
            Outcome::Done
        } else {
            said
        })
    }

    fn asking(&self, mut asking: Asking) -> Asking {
        let Asking { batches, draws, splitting, stones, .. } = &mut asking;
        *batches = self.batches.unwrap_or(*batches);
        *draws = self.draws.unwrap_or(*draws);
        splitting.particles = self.particles.unwrap_or(splitting.particles);
        splitting.steps = self.steps.unwrap_or(splitting.steps);
        stones.rungs = self.rungs.unwrap_or(stones.rungs);
        stones.iterations = self.iterations.unwrap_or(stones.iterations);
        stones.warmup = stones.iterations / 4;
        asking
    }

    fn look_on(&self, clock: Stopwatch, pulse: &ChancePulse, over: &AtomicBool, standing: &Mutex<(usize, usize)>) {
        let mut shown = Stopwatch::start();
        while !over.load(Relaxed) {
            if interrupt::asked() || self.max_time.is_some_and(|most| clock.elapsed() >= most) {
                pulse.stop();
            }
            let every = (0.5 * clock.seconds()).clamp(EVERY[0], EVERY[1]);
            if !self.quiet && !self.json && shown.seconds() >= every {
                shown = Stopwatch::start();
                let (done, due) = standing.lock().map_or((0, 0), |standing| *standing);
                let far = if due > 0 { format!("{done} of {due} batches  ") } else { String::new() };
                let simulations = pulse.simulations();
                let pace = short(simulations as f64 / clock.seconds());
                console::note_line(&format!("{far}{} simulations, {pace} /s", grouped(simulations)));
            }
            thread::sleep(TICK);
        }
    }

    /// Says what there is; how it ends.
    fn say(&self, chance: &Chance) -> Result<Outcome, Failure> {
        let answers = answers(chance);
        let Some(all) = answers.first() else { return Ok(Outcome::Unsatisfied) };
        if self.json {
            let (done, due) = chance.done();
            let object = json!({
                "scene": chance.scene,
                "scenario": chance.scenario.file,
                "scenario_hash": chance.scenario.hash,
                "asking": chance.asking,
                "methods": chance.methods,
                "why": chance.why,
                "batches_done": done,
                "batches_due": due,
                "answers": answers,
            });
            console::print_line(&object.to_string())?;
        } else {
            console::print(&in_words_of(chance, &answers))?;
        }
        let found = all.best.is_some_and(|best| best.probability > 0.0);
        Ok(if found && all.disagreements.is_empty() { Outcome::Done } else { Outcome::Unsatisfied })
    }
}

fn name(method: Method) -> &'static str {
    match method {
        Method::Counting => "counting",
        Method::Splitting => "splitting",
        Method::Stones => "stones",
    }
}

fn in_words_of(chance: &Chance, answers: &[Answer]) -> String {
    let Some((all, parts)) = answers.split_first() else { return String::new() };
    let mut text =
        format!("{} ({}): how likely is what is demanded, before anything is?\n", chance.scene, chance.scenario.file);
    text += &format!("{}\n\n", chance.why);
    let mut rows = vec![["method", "probability", "error", "from", "to", "simulations"].map(str::to_owned).to_vec()];
    rows.extend(all.estimates.iter().map(|one| row(format!("  {}", name(one.method)), one)));
    text += &lay_out(&rows);
    text += &verdict(all);
    if !parts.is_empty() {
        let mut rows = vec![["part", "probability", "error", "from", "to", "by"].map(str::to_owned).to_vec()];
        for part in parts {
            let Some(best) = &part.best else { continue };
            let mut cells = row(format!("  {}", part.name), best);
            cells.pop();
            let doubt = if part.disagreements.is_empty() { "" } else { ", not agreed" };
            cells.push(format!("{}{doubt}", name(best.method)));
            rows.push(cells);
        }
        text += &format!("\n{}", lay_out(&rows));
    }
    text
}

fn row(name: String, one: &Estimate) -> Vec<String> {
    let [from, to] = one.interval;
    let numbers = [one.probability, one.error, from, to].map(short);
    std::iter::once(name).chain(numbers).chain([grouped(one.simulations)]).collect()
}

/// The answer in a sentence.
fn verdict(all: &Answer) -> String {
    let Some(best) = all.best.filter(|best| best.probability > 0.0) else {
        let most = all.estimates.first().map(|one| one.interval[1]);
        let most = most.map(|most| format!(": less often than {}, if by counting", short(most))).unwrap_or_default();
        return format!("\nnothing reached it{most}\n");
    };
    let once =
        if best.probability < 0.5 { format!(", once in {}", often(1.0 / best.probability)) } else { String::new() };
    let mut text = if all.disagreements.is_empty() {
        let error =
            if best.error > 0.0 { percent(best.error / best.probability) } else { "an unknown error".to_owned() };
        let agreed = if all.estimates.len() > 1 { "; the methods agree" } else { "" };
        format!("\n{}{once}, give or take {error}{agreed}\n", short(best.probability))
    } else {
        format!("\nat least about {}{once}: the methods do not agree\n", short(best.interval[0]))
    };
    for one in &all.disagreements {
        let factor = one.factor.map_or("something where the other finds nothing".to_owned(), |factor| {
            format!("{} times as much", short(factor))
        });
        let (more, less) = (name(one.more), name(one.less));
        text += &format!(
            "  {more} finds {factor} as {less}: a way to the goal was missed, or it was not looked long enough; more \
             --batches tell\n"
        );
    }
    for &method in &all.lopsided {
        text += &format!("  more than half of what {} says rests on one batch: take more --batches\n", name(method));
    }
    text
}

/// A large number that is only known roughly.
fn often(times: f64) -> String {
    if times < 1e6 { grouped(times.round() as u64) } else { format!("{times:.1e}") }
}
