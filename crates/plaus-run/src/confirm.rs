//! Which of a run's distinct solutions still hold in a more exact simulation.
//!
//! Records do not change. A list beside them says how each solution fared, so nothing is lost, and exports can be
//! limited to solutions that hold.

use crate::disk::Disk;
use crate::error::{Error, RunFileError, RunFileProblem};
use crate::folder::Folder;
use crate::read::RunReader;
use crate::replay::{always_exact, at_accuracy, states};
use crate::sample_id::ChainPhase;
use crate::sample_id::SampleId;
use crate::solutions::{Solution, distinct};
use plaus_mcmc::{Goal, State, parallel};
use plaus_scenes::{AccuracyPreset, AnyScratch, Scenario, Scene, Stage};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io::ErrorKind;

/// Number of solutions simulated between two checks whether to continue.
const AT_A_TIME: usize = 64;

/// How one solution fared.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Checked {
    /// Its chain.
    pub chain: u32,
    /// Where it was recorded.
    #[serde(default, skip_serializing_if = "ChainPhase::is_sampling")]
    pub phase: ChainPhase,
    /// Its draw, as in the table of `plaus export`.
    pub draw: u64,
    /// The iteration that recorded it.
    pub iteration: u64,
    /// Whether it satisfies the constraint in the new simulation too.
    pub holds: bool,
    /// Whether it is still the same solution, by the scene's classes.
    pub same: bool,
    /// Recorded log p.
    pub log_p: f64,
    /// Log p in the new simulation; `None` if it is −∞.
    pub log_p_there: Option<f64>,
}

impl Checked {
    /// The sample.
    fn sample(&self) -> SampleId {
        SampleId { chain: self.chain, phase: self.phase, draw: self.draw }
    }
}

/// The distinct solutions of a run, simulated at another accuracy.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Confirmation {
    /// Version of plaus.
    pub plaus: String,
    /// Hash of the run's scenario.
    pub scenario_hash: String,
    /// The accuracy of the new simulations.
    pub accuracy: AccuracyPreset,
    /// Iterations of each chain that were looked at.
    pub iterations: u64,
    /// Number of solutions that hold.
    pub held: u64,
    /// Number of solutions that are not simulated yet.
    #[serde(default, skip_serializing_if = "is_none_left")]
    pub left: u64,
    /// Those that are, in order of iteration, then chain.
    pub solutions: Vec<Checked>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde wants a reference")]
fn is_none_left(left: &u64) -> bool {
    *left == 0
}

/// Whether a scenario's scene can be simulated at another accuracy.
///
/// # Errors
/// [`Error::Request`] if it has none to choose.
pub fn possible(scenario: &Scenario, accuracy: AccuracyPreset) -> Result<(), Error> {
    let none = || format!("{}, and there is nothing to confirm", always_exact(scenario.world.name()));
    scenario.stage()?.at_accuracy(accuracy)?.map(drop).ok_or_else(|| Error::Request(none()))
}

impl Confirmation {
    /// Simulates every distinct solution at `accuracy`, on `threads` threads (0: one per core). Takes over what an
    /// earlier, unfinished list of this run and version knows. Now and then calls `go_on` with the number done and the
    /// total; if it returns false, or the run's reader is [interrupted](RunReader::interrupted_by), some are
    /// [left](Self::left).
    ///
    /// # Errors
    /// [`Error`] if the scene has no accuracy to choose, the records are damaged or a simulation fails.
    pub fn of(
        run: &RunReader<'_>,
        accuracy: AccuracyPreset,
        threads: usize,
        mut go_on: impl FnMut(usize, usize) -> bool,
    ) -> Result<Self, Error> {
        let manifest = run.run().manifest();
        manifest.judges_alone()?;
        let scene = at_accuracy(run.scene(), run.run().scenario().world.name(), accuracy)?;
        let found = distinct(run)?;
        let earlier = Self::read(run).ok();
        let earlier = earlier.filter(|list| (&list.plaus, list.accuracy) == (&manifest.plaus, accuracy));
        let earlier = earlier.into_iter().flat_map(|list| list.solutions);
        let earlier: BTreeMap<SampleId, Checked> = earlier.map(|one| (one.sample(), one)).collect();
        let (mut solutions, mut unknown) = (Vec::new(), Vec::new());
        for one in &found {
            let is_same = |known: &&Checked| (known.iteration, known.log_p) == (one.iteration, one.log_p);
            match earlier.get(&one.sample).filter(is_same) {
                Some(known) => solutions.push(*known),
                None => unknown.push(*one),
            }
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.map_err(|error| Error::Sampling(format!("cannot start worker threads: {error}")))?;
        for some in unknown.chunks(AT_A_TIME) {
            if !go_on(solutions.len(), found.len()) {
                break;
            }
            solutions.extend(parallel::install(&pool, || check(run, &scene, some))?);
        }
        solutions.sort_by_key(|one| (one.iteration, one.chain));
        Ok(Self {
            plaus: manifest.plaus.clone(),
            scenario_hash: manifest.scenario.hash.clone(),
            accuracy,
            iterations: run.iterations(),
            held: solutions.iter().filter(|one| one.holds).count() as u64,
            left: (found.len() - solutions.len()) as u64,
            solutions,
        })
    }

    /// Samples of the solutions that hold.
    #[must_use]
    pub fn samples(&self) -> Vec<SampleId> {
        let held = self.solutions.iter().filter(|one| one.holds);
        held.map(Checked::sample).collect()
    }

    /// Writes the list beside the run's records, in place of an older one.
    ///
    /// # Errors
    /// [`RunFileError`] if the disk refuses; an older list is then still there.
    pub fn write(&self, folder: &Folder, disk: &dyn Disk) -> Result<(), RunFileError> {
        let path = folder.confirmed();
        let broken = |error: serde_json::Error| RunFileError::new(&path, RunFileProblem::List(error.to_string()));
        let mut json = serde_json::to_vec_pretty(self).map_err(broken)?;
        json.push(b'\n');
        let next = path.with_extension("json.next");
        let written = disk.write(&next, &json).and_then(|()| disk.rename(&next, &path));
        written.and_then(|()| disk.sync(folder.path())).map_err(RunFileError::io(&path, "write"))
    }

    /// Reads the list of a run.
    ///
    /// # Errors
    /// [`RunFileError`] if there is none, or it is damaged or another run's.
    pub fn read(run: &RunReader<'_>) -> Result<Self, RunFileError> {
        let path = run.run().folder().confirmed();
        let fail = |message: String| RunFileError::new(&path, RunFileProblem::List(message));
        let json = std::fs::read(&path).map_err(|error| match error.kind() {
            ErrorKind::NotFound => RunFileError::new(&path, RunFileProblem::Unconfirmed),
            _ => RunFileError::io(&path, "read")(error),
        })?;
        let list: Self = serde_json::from_slice(&json).map_err(|error| fail(error.to_string()))?;
        let manifest = run.run().manifest();
        if list.scenario_hash != manifest.scenario.hash {
            return Err(fail("it belongs to another run".to_owned()));
        }
        Ok(list)
    }
}

/// Simulates solutions again; those that an interrupt cut are left out.
fn check(run: &RunReader<'_>, scene: &Stage, solutions: &[Solution]) -> Result<Vec<Checked>, Error> {
    let samples: Vec<SampleId> = solutions.iter().map(|solution| solution.sample).collect();
    let found = match states(run, &samples) {
        Err(Error::Model(error)) if error.is_interruption() => return Ok(Vec::new()),
        found => found?,
    };
    let check = |(index, stored, _): &(usize, plaus_mcmc::StateOf<Stage>, bool)| -> Result<Option<Checked>, Error> {
        let Solution { sample, iteration, log_p } = solutions[*index];
        let there = match State::evaluate(scene, stored.draw.clone(), &mut AnyScratch::default()) {
            Err(error) if error.is_interruption() => return Ok(None),
            there => there?,
        };
        let class = scene.class(there.by_ref());
        let log_p_there = there.log_p().value();
        Ok(Some(Checked {
            chain: sample.chain,
            phase: sample.phase,
            draw: sample.draw,
            iteration,
            holds: class.is_some(),
            same: class.is_some() && class == run.scene().class(stored.by_ref()),
            log_p,
            log_p_there: log_p_there.is_finite().then_some(log_p_there),
        }))
    };
    Ok(parallel::try_map(found.len(), |k| check(&found[k]))?.into_iter().flatten().collect())
}
