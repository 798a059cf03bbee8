//! How likely a scenario's demand is under its prior: asked in batches, kept in one file, answered from all of it.
//!
//! A batch is a function of scenario, seed and number. So the file of an asking that was cut short, goes on, or was put
//! together from pieces has the bytes of one that was made at once, whatever the number of threads.

mod answer;
mod file;

pub use answer::{Answer, answers};
pub use file::{files_at, is_being_written, merge, read};

use crate::disk::Disk;
use crate::error::Error;
use crate::manifest::{Recipe, StoredScenario, VERSION};
use crate::shard::Shard;
use plaus_dist::Seed;
use plaus_mcmc::chance::{
    ChanceError, ChancePulse, Counted, Method, Parts, Split, Splitting, Stoned, Stones, count, split, stones,
};
use plaus_mcmc::{Mixture, StateRefOf, parallel};
use plaus_scenes::{Scene, Stage};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// Hits of the first batch of draws from which on counting is enough: some 6 % of error with 16 batches.
const ENOUGH: u64 = 16;

/// How it is asked.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Asking {
    /// Seed of all randomness.
    pub seed: Seed,
    /// Batches of each method, at least 2.
    pub batches: u32,
    /// Draws of the prior that a batch counts.
    pub draws: u64,
    /// How particles are split.
    pub splitting: Splitting,
    /// How stones are laid.
    pub stones: Stones,
}

impl Asking {
    /// What is asked unless somebody says otherwise.
    #[must_use]
    pub fn new(seed: Seed) -> Self {
        let splitting = Splitting { particles: 100, steps: 20, least: 1e-15 };
        let stones = Stones { rungs: 10, swap_every: 2, warmup: 400, iterations: 1600 };
        Self { seed, batches: 16, draws: 500, splitting, stones }
    }
}

/// What was asked, and what batches came to: the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Chance {
    /// Version of plaus that asked.
    pub plaus: String,
    /// The scene's name.
    pub scene: String,
    /// Which of the batches it is to hold; not there where it is all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shard: Option<Shard>,
    /// The scenario.
    pub scenario: StoredScenario,
    /// How it is asked.
    pub asking: Asking,
    /// Which methods are used, and why.
    pub methods: Vec<Method>,
    /// Why these, in words.
    pub why: String,
    /// Names of the parts of the demand.
    pub parts: Vec<String>,
    /// Batches of draws that were counted, by number.
    pub counted: BTreeMap<u32, Counted>,
    /// Batches of particles.
    pub split: BTreeMap<u32, Split>,
    /// Batches of stepping stones.
    pub stones: BTreeMap<u32, Stoned>,
}

/// A batch that is to be made.
type Task = (Method, u32);

/// What came of one.
enum Made {
    Counted(Counted),
    Split(Split),
    Stoned(Stoned),
}

impl Chance {
    /// Numbers of the batches that it is to hold.
    #[must_use]
    pub fn batches(&self) -> std::ops::Range<u32> {
        let all = self.asking.batches;
        self.shard.map_or(0..all, |shard| shard.range(all).unwrap_or_default())
    }

    /// Batches there are, and those there are to be.
    #[must_use]
    pub fn done(&self) -> (usize, usize) {
        let made = self.counted.len() + self.split.len() + self.stones.len();
        (made, self.batches().len() * self.methods.len())
    }

    fn missing(&self) -> Vec<Task> {
        let has = |&(method, batch): &Task| match method {
            Method::Counting => self.counted.contains_key(&batch),
            Method::Splitting => self.split.contains_key(&batch),
            Method::Stones => self.stones.contains_key(&batch),
        };
        let tasks = self.methods.iter().flat_map(|&method| self.batches().map(move |batch| (method, batch)));
        tasks.filter(|task| !has(task)).collect()
    }

    fn take(&mut self, batch: u32, made: Made) {
        match made {
            Made::Counted(one) => _ = self.counted.insert(batch, one),
            Made::Split(one) => _ = self.split.insert(batch, one),
            Made::Stoned(one) => _ = self.stones.insert(batch, one),
        }
    }
}

/// Who asks, beside what.
pub struct Inquiry<'a> {
    /// The scenario. Its number of solutions plays no part.
    pub recipe: &'a Recipe,
    /// How it is asked.
    pub asking: Asking,
    /// Methods to use; none: those that fit.
    pub methods: Vec<Method>,
    /// Which piece of the batches; none: all.
    pub shard: Option<Shard>,
    /// The file to keep, and the disk it is on.
    pub place: Option<(&'a Path, &'a dyn Disk)>,
    /// Threads; 0 is one a core. Never changes results.
    pub threads: usize,
    /// Who looks on, and may stop it.
    pub pulse: &'a ChancePulse,
}

/// Asks, and gives what there is when it ends or is stopped; `shown` is told after each batch. Where the file is there
/// already and holds this very asking, it goes on with it.
///
/// # Errors
/// [`Error`] where the scenario makes no scene, the file holds something else, a batch fails, or the disk refuses.
pub fn ask(inquiry: &Inquiry<'_>, shown: &(dyn Fn(&Chance) + Sync)) -> Result<Chance, Error> {
    let scenario = &inquiry.recipe.scenario;
    let scene = scenario.stage()?;
    let moves = Arc::new(scene.moves(&scenario.sampler.rules)?);
    Asked { scene, moves, inquiry }.run(shown)
}

/// An inquiry into a scene.
struct Asked<'a, 'b> {
    scene: Stage,
    moves: Arc<Mixture<Stage>>,
    inquiry: &'a Inquiry<'b>,
}

impl Asked<'_, '_> {
    fn run(&self, shown: &(dyn Fn(&Chance) + Sync)) -> Result<Chance, Error> {
        let Inquiry { asking, shard, place, threads, pulse, .. } = self.inquiry;
        if asking.batches < 2 {
            return Err(Error::Request("one batch tells no error: ask for 2 or more".to_owned()));
        }
        if let Some(shard) = shard {
            shard.range(asking.batches).map_err(|error| Error::Request(error.to_string()))?;
        }
        // Held to the end.
        let _claim = place.map(|(path, _)| file::claim(path)).transpose()?;
        let found = self.methods()?;
        let knows_methods = found.is_some();
        let (methods, why) = found.unwrap_or((vec![Method::Counting], "stopped".to_owned()));
        let begun = self.begin(methods, why)?;
        let begun = match place {
            Some((path, _)) => file::go_on(path, begun, knows_methods)?,
            None => begun,
        };
        let tasks = begun.missing();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(*threads).build();
        let pool = pool.map_err(|error| Error::Sampling(format!("cannot start worker threads: {error}")))?;
        let held = Mutex::new(begun);
        let one = |&(method, batch): &Task| -> Result<(), Error> {
            if pulse.is_stopped() {
                return Ok(());
            }
            let made = match self.make(method, batch) {
                Err(ChanceError::Stopped) => return Ok(()),
                made => made.map_err(|error| Error::Sampling(error.to_string()))?,
            };
            let mut chance = held.lock().unwrap_or_else(PoisonError::into_inner);
            chance.take(batch, made);
            if let Some((path, disk)) = place {
                file::write(path, *disk, &chance)?;
            }
            shown(&chance);
            Ok(())
        };
        let done: Vec<Result<(), Error>> = parallel::install(&pool, || {
            let guarded = |task: &Task| one(task).inspect_err(|_| pulse.stop());
            parallel::map(tasks.len(), |k| guarded(&tasks[k]))
        });
        done.into_iter().collect::<Result<(), Error>>()?;
        Ok(held.into_inner().unwrap_or_else(PoisonError::into_inner))
    }

    fn make(&self, method: Method, batch: u32) -> Result<Made, ChanceError> {
        let Asking { seed, draws, splitting, stones: plan, .. } = self.inquiry.asking;
        let (scene, moves, pulse) = (&self.scene, &self.moves, self.inquiry.pulse);
        Ok(match method {
            Method::Counting => Made::Counted(count(scene, self.parts(), seed, batch, draws, pulse)?),
            Method::Splitting => Made::Split(split((scene, moves), self.parts(), seed, batch, splitting, pulse)?),
            Method::Stones => Made::Stoned(stones(scene, &**moves, seed, batch, plan, pulse)?),
        })
    }

    /// Which methods fit, and why. Every piece finds the same: from the first batch of draws, whoever's that is.
    /// `None` where it was stopped before that is known: nothing more is made then.
    fn methods(&self) -> Result<Option<(Vec<Method>, String)>, Error> {
        let Inquiry { recipe, asking, methods, pulse, .. } = self.inquiry;
        let exact = recipe.scenario.sampler.rules.is_exact();
        if !methods.is_empty() {
            if !exact && methods.iter().any(|&method| method != Method::Counting) {
                let message = "splitting and stones rest on moves that are exact: set sampler.rules.preset = \"exact\", \
                    or count";
                return Err(Error::Request(message.to_owned()));
            }
            let mut methods = methods.clone();
            methods.sort_unstable();
            methods.dedup();
            return Ok(Some((methods, "as asked for".to_owned())));
        }
        if !exact {
            let why = "moves are not exact, so only draws of the prior count";
            return Ok(Some((vec![Method::Counting], why.to_owned())));
        }
        let pilot = match count(&self.scene, Parts::NONE, asking.seed, 0, asking.draws, pulse) {
            Err(ChanceError::Stopped) => return Ok(None),
            pilot => pilot.map_err(|error| Error::Sampling(error.to_string()))?,
        };
        let (hits, draws) = (pilot.hits.first().copied().unwrap_or(0), pilot.draws);
        let seen = format!("{hits} of the first {draws} draws of the prior reach it");
        if hits >= ENOUGH {
            return Ok(Some((vec![Method::Counting], format!("{seen}: counting is enough"))));
        }
        let all = vec![Method::Counting, Method::Splitting, Method::Stones];
        Ok(Some((all, format!("{seen}: too few to count alone"))))
    }

    /// Names of what is demanded, where it is more than one thing.
    fn names(&self) -> Vec<String> {
        let asked = self.scene.asked();
        if asked.len() > 1 { asked } else { Vec::new() }
    }

    /// What of that a state meets.
    fn parts(&self) -> Parts<'_, Stage> {
        Parts { count: self.names().len(), met: &meets }
    }

    fn begin(&self, methods: Vec<Method>, why: String) -> Result<Chance, Error> {
        let Inquiry { recipe, asking, shard, .. } = self.inquiry;
        let manifest = recipe.manifest(&self.scene)?;
        Ok(Chance {
            plaus: VERSION.to_owned(),
            scene: manifest.scene,
            shard: *shard,
            scenario: manifest.scenario,
            asking: asking.clone(),
            methods,
            why,
            parts: self.names(),
            counted: BTreeMap::new(),
            split: BTreeMap::new(),
            stones: BTreeMap::new(),
        })
    }
}

/// Says of each thing that is asked whether a state meets it.
fn meets(scene: &Stage, state: StateRefOf<'_, Stage>, met: &mut [bool]) {
    met.iter_mut().zip(scene.answers(state)).for_each(|(met, mark)| *met = mark.met());
}
