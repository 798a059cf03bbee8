//! How likely it is that a scenario's requirements are met under its prior: estimated in batches, kept in one file,
//! answered from all of them.
//!
//! A batch is a function of scenario, seed and number. So a file that was interrupted and continued, or merged from
//! pieces, has the same bytes as one made in one go, whatever the number of threads.

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
    ChanceError, ChancePulse, Counted, Method, Parts, Split, Splitting, Stoned, Stones, Weighted, count, importance,
    split, spreadable, stones,
};
use plaus_mcmc::{Mixture, StateRefOf, parallel};
use plaus_scenes::{Scene, Stage};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// If the first batch of draws has this many hits, counting is enough: with 16 batches its error is about 6 %.
const ENOUGH: u64 = 16;

/// How to estimate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Asking {
    /// Seed of all randomness.
    pub seed: Seed,
    /// Batches of each method, at least 2.
    pub batches: u32,
    /// Draws from the prior in each batch of counting.
    pub draws: u64,
    /// Settings of splitting.
    pub splitting: Splitting,
    /// Settings of stepping stones.
    pub stones: Stones,
}

impl Asking {
    /// The default settings.
    #[must_use]
    pub fn new(seed: Seed) -> Self {
        let splitting = Splitting { particles: 100, steps: 20, least: 1e-15 };
        let stones = Stones { rungs: 10, swap_every: 2, warmup: 400, iterations: 1600 };
        Self { seed, batches: 16, draws: 500, splitting, stones }
    }
}

/// The question, and the results of batches: the content of the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Chance {
    /// Version of plaus that made it.
    pub plaus: String,
    /// The scene's name.
    pub scene: String,
    /// The piece of the batches that it is to hold; absent if it holds all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shard: Option<Shard>,
    /// The scenario.
    pub scenario: StoredScenario,
    /// How to estimate.
    pub asking: Asking,
    /// The methods that are used.
    pub methods: Vec<Method>,
    /// Why these methods, in words.
    pub why: String,
    /// Names of the parts of the requirements.
    pub parts: Vec<String>,
    /// Batches of draws that were counted, by number.
    pub counted: BTreeMap<u32, Counted>,
    /// Batches of particles.
    pub split: BTreeMap<u32, Split>,
    /// Batches of stepping stones.
    pub stones: BTreeMap<u32, Stoned>,
    /// Batches of importance sampling; files made before there was such a method have none.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub weighted: BTreeMap<u32, Weighted>,
}

/// A batch to make.
type Task = (Method, u32);

/// Methods, why these, and the first batch of counting if it was made to choose them.
type Chosen = (Vec<Method>, String, Option<Counted>);

/// The result of a batch.
enum Made {
    Counted(Counted),
    Split(Split),
    Stoned(Stoned),
    Weighted(Weighted),
}

impl Chance {
    /// Numbers of the batches that it is to hold.
    #[must_use]
    pub fn batches(&self) -> std::ops::Range<u32> {
        let all = self.asking.batches;
        self.shard.map_or(0..all, |shard| shard.range(all).unwrap_or_default())
    }

    /// Numbers of batches made, and of batches planned.
    #[must_use]
    pub fn done(&self) -> (usize, usize) {
        let made = self.counted.len() + self.split.len() + self.stones.len() + self.weighted.len();
        (made, self.batches().len() * self.methods.len())
    }

    fn missing(&self) -> Vec<Task> {
        let has = |&(method, batch): &Task| match method {
            Method::Counting => self.counted.contains_key(&batch),
            Method::Splitting => self.split.contains_key(&batch),
            Method::Stones => self.stones.contains_key(&batch),
            Method::Importance => self.weighted.contains_key(&batch),
        };
        let tasks = self.methods.iter().flat_map(|&method| self.batches().map(move |batch| (method, batch)));
        tasks.filter(|task| !has(task)).collect()
    }

    fn take(&mut self, batch: u32, made: Made) {
        match made {
            Made::Counted(one) => _ = self.counted.insert(batch, one),
            Made::Split(one) => _ = self.split.insert(batch, one),
            Made::Stoned(one) => _ = self.stones.insert(batch, one),
            Made::Weighted(one) => _ = self.weighted.insert(batch, one),
        }
    }
}

/// What to estimate, and where.
pub struct Inquiry<'a> {
    /// The scenario. Its number of solutions does not matter.
    pub recipe: &'a Recipe,
    /// How to estimate.
    pub asking: Asking,
    /// Methods to use; if empty, those that fit.
    pub methods: Vec<Method>,
    /// Which piece of the batches; `None` for all.
    pub shard: Option<Shard>,
    /// The file to keep, and the disk it is on.
    pub place: Option<(&'a Path, &'a dyn Disk)>,
    /// Threads; 0 means one per core. Never changes results.
    pub threads: usize,
    /// Shows progress to others, who may stop it.
    pub pulse: &'a ChancePulse,
}

/// Estimates, and returns the result so far when it ends or is stopped; `shown` is called after each batch. If the file
/// already holds this same question, continues it.
///
/// # Errors
/// [`Error`] if the scenario is invalid, the file holds something else, a batch fails, or the disk refuses.
pub fn ask(inquiry: &Inquiry<'_>, shown: &(dyn Fn(&Chance) + Sync)) -> Result<Chance, Error> {
    let scenario = &inquiry.recipe.scenario;
    let scene = scenario.stage()?.interrupted_by(inquiry.pulse.flag());
    let moves = Arc::new(scene.moves(&scenario.sampler.rules)?);
    Asked { scene, moves, inquiry }.run(shown)
}

/// An estimate for a known scene.
struct Asked<'a, 'b> {
    scene: Stage,
    moves: Arc<Mixture<Stage>>,
    inquiry: &'a Inquiry<'b>,
}

impl Asked<'_, '_> {
    fn run(&self, shown: &(dyn Fn(&Chance) + Sync)) -> Result<Chance, Error> {
        let Inquiry { asking, shard, place, threads, pulse, .. } = self.inquiry;
        if asking.batches < 2 {
            return Err(Error::Request("one batch gives no error estimate: ask for 2 or more".to_owned()));
        }
        if let Some(shard) = shard {
            shard.range(asking.batches).map_err(|error| Error::Request(error.to_string()))?;
        }
        // Held until the end of this function.
        let _claim = place.map(|(path, _)| file::claim(path)).transpose()?;
        let found = self.methods()?;
        let knows_methods = found.is_some();
        let (methods, why, pilot) = found.unwrap_or((vec![Method::Counting], "stopped".to_owned(), None));
        let begun = self.begin(methods, why)?;
        let mut begun = match place {
            Some((path, _)) => file::go_on(path, begun, knows_methods)?,
            None => begun,
        };
        if let (Some(pilot), Some(0)) = (pilot, begun.batches().next()) {
            begun.take(0, Made::Counted(pilot));
            if let Some((path, disk)) = place {
                file::write(path, *disk, &begun)?;
            }
            shown(&begun);
        }
        let tasks = begun.missing();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(*threads).build();
        let pool = pool.map_err(|error| Error::Sampling(format!("cannot start worker threads: {error}")))?;
        let held = Mutex::new(begun);
        let one = |&(method, batch): &Task| -> Result<(), Error> {
            if pulse.is_stopped() {
                return Ok(());
            }
            let made = match self.make(method, batch) {
                Err(_) if pulse.is_stopped() => return Ok(()),
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
            Method::Importance => Made::Weighted(importance(scene, self.parts(), seed, batch, draws, pulse)?),
        })
    }

    /// The methods that fit, and why. Every piece comes to the same result, from the first batch of draws, even if that
    /// belongs to another piece; that batch is part of the result. `None` if it was stopped before that; then nothing
    /// more is made.
    fn methods(&self) -> Result<Option<Chosen>, Error> {
        let Inquiry { recipe, asking, methods, pulse, .. } = self.inquiry;
        let exact = recipe.scenario.sampler.rules.is_exact();
        if !methods.is_empty() {
            let walks = |&method: &Method| matches!(method, Method::Splitting | Method::Stones);
            if !exact && methods.iter().any(walks) {
                let message =
                    "splitting and stones need exact moves: set sampler.rules.preset = \"exact\", or use counting";
                return Err(Error::Request(message.to_owned()));
            }
            let mut methods = methods.clone();
            methods.sort_unstable();
            methods.dedup();
            return Ok(Some((methods, "as asked for".to_owned(), None)));
        }
        if !exact {
            let why = "moves are not exact, so only counting is possible";
            return Ok(Some((vec![Method::Counting], why.to_owned(), None)));
        }
        let pilot = match count(&self.scene, self.parts(), asking.seed, 0, asking.draws, pulse) {
            Err(_) if pulse.is_stopped() => return Ok(None),
            pilot => pilot.map_err(|error| Error::Sampling(error.to_string()))?,
        };
        let (hits, draws) = (pilot.hits.first().copied().unwrap_or(0), pilot.draws);
        let seen = format!("{hits} of the first {draws} draws from the prior hit");
        if hits >= ENOUGH {
            return Ok(Some((vec![Method::Counting], format!("{seen}: counting is enough"), Some(pilot))));
        }
        let mut all = vec![Method::Counting, Method::Splitting, Method::Stones];
        if !spreadable(&self.scene).is_empty() {
            all.push(Method::Importance);
        }
        Ok(Some((all, format!("{seen}: too few to count alone"), Some(pilot))))
    }

    /// Names of the things asked for, if there is more than one.
    fn names(&self) -> Vec<String> {
        let asked = self.scene.asked();
        if asked.len() > 1 { asked } else { Vec::new() }
    }

    /// Which of the things that are asked for a state meets.
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
            weighted: BTreeMap::new(),
        })
    }
}

/// Sets, for each thing that is asked for, whether a state meets it.
fn meets(scene: &Stage, state: StateRefOf<'_, Stage>, met: &mut [bool]) {
    met.iter_mut().zip(scene.answers(state)).for_each(|(met, mark)| *met = mark.met());
}
