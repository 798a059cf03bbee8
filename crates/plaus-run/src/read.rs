//! Reading a run back: lazily, chain by chain, using nothing that was not checked.

use crate::checkpoint::{self, Checkpoint};
use crate::error::{Error, RunFileError, RunFileProblem};
use crate::folder::Folder;
use crate::manifest::{Manifest, stored_scalars};
use crate::records::{self, Blocks, Extent};
use crate::sample_id::{ChainPhase, SampleId};
use crate::{Draw, Outcome};
use plaus_mcmc::{Entry, Snapshot, parallel};
use plaus_scenes::{Scenario, Stage};
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// What is said of a run without draws.
const NO_DRAWS: &str = "the run holds no draws yet; `plaus resume` continues it";

/// A run that was found on the disk.
#[derive(Debug, Clone)]
pub struct Run {
    folder: Folder,
    manifest: Manifest,
    scenario: Scenario,
    salvage: bool,
}

/// A run with its scene, ready to be read.
pub struct RunReader<'a> {
    run: &'a Run,
    scene: Stage,
    chains: Vec<ChainOf>,
}

/// Everything known about a chain without reading its records.
struct ChainOf {
    extent: Extent,
    /// Bytes of its records after the readable part.
    lost: u64,
    snapshot: Option<Snapshot<Draw, Outcome>>,
}

/// Consecutive draws of one phase at the same state.
#[derive(Debug, Clone, Copy)]
pub struct Repeats<'a> {
    /// Number of the first of them in its phase.
    pub draw: u64,
    /// How many draws.
    pub draws: u64,
    /// Proposals accepted since the recorded draw before the first of them.
    pub accepted: u32,
    /// Whether the first of them is the first of the entry too: one that spans the end of the warm-up is told twice.
    pub begins: bool,
    /// What was recorded.
    pub entry: &'a Entry<Draw, Outcome>,
}

impl Run {
    /// Opens a run.
    ///
    /// # Errors
    /// [`Error`] if there is none, or its manifest is damaged.
    pub fn open(folder: &Folder) -> Result<Self, Error> {
        let manifest = Manifest::read(folder)?;
        let scenario = manifest.scenario()?;
        Ok(Self { folder: folder.clone(), manifest, scenario, salvage: false })
    }

    /// The same run, read up to the first damage, whatever the checkpoints say.
    #[must_use]
    pub fn salvaged(self) -> Self {
        Self { salvage: true, ..self }
    }

    /// Its folder.
    #[must_use]
    pub fn folder(&self) -> &Folder {
        &self.folder
    }

    /// Its manifest.
    #[must_use]
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// The effective scenario.
    #[must_use]
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// The run with its scene, ready to be read.
    ///
    /// # Errors
    /// [`Error`] if the scene cannot be built, or is not the one of the manifest, or a checkpoint is damaged.
    pub fn reader(&self) -> Result<RunReader<'_>, Error> {
        RunReader::new(self, self.scenario.stage()?)
    }
}

impl<'a> RunReader<'a> {
    /// The same; simulations of its scene fail as [`Interrupted`](plaus_mcmc::Interrupted) once `flag` is set.
    #[must_use]
    pub fn interrupted_by(self, flag: Arc<AtomicBool>) -> Self {
        Self { scene: self.scene.interrupted_by(flag), ..self }
    }

    fn new(run: &'a Run, scene: Stage) -> Result<Self, Error> {
        if stored_scalars(&scene) != run.manifest.scalars {
            let message = "the scene's scalars are not those of the manifest".to_owned();
            return Err(RunFileError::new(run.folder.manifest(), RunFileProblem::Differs(message)).into());
        }
        let chains = run.manifest.chains();
        let chains = if run.salvage {
            chains.map(|chain| ChainOf::salvage(run, chain)).collect::<Result<_, RunFileError>>()?
        } else {
            let mut found = checkpoint::read_all(&run.folder, run.manifest.run_id(), chains.clone())?.into_iter();
            chains.map(|chain| ChainOf::of(run, chain, found.next())).collect()
        };
        Ok(Self { run, scene, chains })
    }

    /// For each chain that has any: the number of bytes at the end of its records that cannot be read. Empty unless the
    /// run is read for salvage.
    #[must_use]
    pub fn lost(&self) -> Vec<(u32, u64)> {
        self.chains().zip(&self.chains).map(|(chain, of)| (chain, of.lost)).filter(|(_, lost)| *lost > 0).collect()
    }

    /// The run.
    #[must_use]
    pub fn run(&self) -> &'a Run {
        self.run
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &Stage {
        &self.scene
    }

    /// Numbers of its chains: from 0, unless it is a piece of a run.
    #[must_use]
    pub fn chains(&self) -> Range<u32> {
        self.run.manifest.chains()
    }

    /// The results of `job` for each chain, in order, run on all threads of the current pool.
    ///
    /// # Errors
    ///
    /// The error of the first chain for which `job` fails.
    pub fn each_chain<T: Send, E: Send>(&self, job: impl Fn(u32) -> Result<T, E> + Sync) -> Result<Vec<T>, E> {
        let chains = self.chains();
        parallel::try_map(chains.len(), |k| job(chains.start + k as u32))
    }

    fn chain(&self, chain: u32) -> Option<&ChainOf> {
        self.chains.get(chain.checked_sub(self.chains().start)? as usize)
    }

    /// A chain as of its checkpoint; `None` if there is none yet, or the run is read for salvage.
    #[must_use]
    pub fn snapshot(&self, chain: u32) -> Option<&Snapshot<Draw, Outcome>> {
        self.chain(chain)?.snapshot.as_ref()
    }

    /// Iterations that every chain has done.
    #[must_use]
    pub fn iterations(&self) -> u64 {
        self.chains.iter().map(|chain| chain.extent.end_iteration).min().unwrap_or(0)
    }

    /// How many draws of a phase every chain has recorded. Draws that only some chains have are not shown.
    #[must_use]
    pub fn draws(&self, phase: ChainPhase) -> u64 {
        let range = self.range(phase);
        range.end - range.start
    }

    /// The phases in which solutions count. The warm-up is one of them for a run that looks for solutions, and for any
    /// run that has recorded nothing else yet.
    #[must_use]
    pub fn counted(&self) -> &'static [ChainPhase] {
        let from_the_start = self.run.manifest.plan.counts_from() == 0;
        if from_the_start || self.draws(ChainPhase::Sampling) == 0 {
            &[ChainPhase::Warmup, ChainPhase::Sampling]
        } else {
            &[ChainPhase::Sampling]
        }
    }

    /// The phase among all recorded draws of a chain, numbered from the start.
    fn range(&self, phase: ChainPhase) -> Range<u64> {
        let manifest = &self.run.manifest;
        let all = manifest.recorded_before(self.iterations());
        let warmup = manifest.recorded_before(manifest.plan.warmup).min(all);
        match phase {
            ChainPhase::Warmup => 0..warmup,
            ChainPhase::Sampling => warmup..all,
        }
    }

    /// The iteration a draw was recorded at.
    #[must_use]
    pub fn iteration_of(&self, phase: ChainPhase, draw: u64) -> u64 {
        (self.range(phase).start + draw) * self.run.manifest.plan.thin
    }

    /// The recorded blocks of a chain.
    ///
    /// # Errors
    /// [`RunFileError`] if the records cannot be opened.
    pub fn blocks(&self, chain: u32) -> Result<Blocks, RunFileError> {
        let extent = self.chain(chain).map(|chain| chain.extent);
        let missing = || {
            let Range { start, end } = self.chains();
            let message = format!("there is no chain {chain}: the chains are {start} to {}", end.saturating_sub(1));
            RunFileError::new(self.run.folder.path(), RunFileProblem::NoSample(message))
        };
        Blocks::open(&self.run.folder.records(chain), extent.ok_or_else(missing)?)
    }

    /// Passes the draws of a phase of one chain to `look`, in order.
    ///
    /// # Errors
    /// [`RunFileError`] if the records are damaged, or as `look` says.
    pub fn walk<E: From<RunFileError>>(
        &self,
        chain: u32,
        phase: ChainPhase,
        mut look: impl FnMut(Repeats<'_>) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut failed = None;
        self.walk_until(chain, phase, &mut |repeats| {
            failed = look(repeats).err();
            failed.is_none()
        })?;
        failed.map_or(Ok(()), Err)
    }

    /// The same, until `look` returns false. It is compiled once, not for each caller.
    fn walk_until(
        &self,
        chain: u32,
        phase: ChainPhase,
        look: &mut dyn FnMut(Repeats<'_>) -> bool,
    ) -> Result<(), RunFileError> {
        let range = self.range(phase);
        if range.is_empty() {
            return Ok(());
        }
        let mut next = 0;
        for block in self.blocks(chain)? {
            for entry in &block?.entries {
                let (first, end) = (next.max(range.start), (next + entry.draws).min(range.end));
                if first < end {
                    let (begins, draw, draws) = (first == next, first - range.start, end - first);
                    let accepted = if begins { entry.accepted } else { 0 };
                    let goes_on = look(Repeats { draw, draws, accepted, begins, entry });
                    if !goes_on {
                        return Ok(());
                    }
                }
                next += entry.draws;
            }
            if phase == ChainPhase::Warmup && next >= range.end {
                break;
            }
        }
        Ok(())
    }

    /// The entry that a draw belongs to.
    ///
    /// # Errors
    /// [`RunFileProblem::NoSample`] if there is no such draw, or [`RunFileError`] if the records are damaged.
    pub fn sample(&self, sample: SampleId) -> Result<Entry<Draw, Outcome>, RunFileError> {
        let SampleId { chain, phase, draw } = sample;
        let fail = |problem| Err(RunFileError::new(self.run.folder.path(), problem));
        let no_sample = |message| fail(RunFileProblem::NoSample(message));
        // A run that was stopped at once has no files of records.
        if [ChainPhase::Warmup, ChainPhase::Sampling].iter().all(|&phase| self.draws(phase) == 0) {
            return no_sample(NO_DRAWS.to_owned());
        }
        let blocks = self.blocks(chain)?;
        let draws = self.draws(phase);
        if draw < draws {
            let wanted = self.range(phase).start + draw;
            let mut next = 0;
            for block in blocks {
                for entry in block?.entries {
                    next += entry.draws;
                    if wanted < next {
                        return Ok(entry);
                    }
                }
            }
        }
        let id = |draw| SampleId { draw, ..sample };
        let message = match (draws.checked_sub(1), phase) {
            (Some(last), ChainPhase::Sampling) => {
                format!("there is no draw {}: the draws of each chain are 0 to {last}", id(draw))
            }
            (Some(last), ChainPhase::Warmup) => {
                format!("there is no draw {}: those of each chain's warm-up are w0 to w{last}", id(draw))
            }
            (None, ChainPhase::Sampling) => return fail(self.only_warmup(chain)),
            (None, ChainPhase::Warmup) => "the run has no warm-up".to_owned(),
        };
        no_sample(message)
    }

    /// That there are no draws after the warm-up, and what there is instead.
    fn only_warmup(&self, chain: u32) -> RunFileProblem {
        let phase = ChainPhase::Warmup;
        let Some(draw) = self.draws(phase).checked_sub(1) else {
            return RunFileProblem::NoSample(NO_DRAWS.to_owned());
        };
        let has_solutions = self.run.manifest.plan.counts_from() == 0;
        RunFileProblem::OnlyWarmup { last: SampleId { chain, phase, draw }, has_solutions }
    }
}

impl ChainOf {
    fn of(run: &Run, chain: u32, checkpoint: Option<Checkpoint>) -> Self {
        let (id, thin) = (run.manifest.run_id(), run.manifest.plan.thin);
        let (bytes, end_iteration) =
            checkpoint.as_ref().map_or((0, 0), |one: &Checkpoint| (one.records, one.snapshot.end_iteration));
        let extent = Extent { run: id, chain, thin, bytes, end_iteration };
        Self { extent, lost: 0, snapshot: checkpoint.map(|checkpoint| checkpoint.snapshot) }
    }

    /// Everything up to the first frame that is damaged or missing.
    fn salvage(run: &Run, chain: u32) -> Result<Self, RunFileError> {
        let path = run.folder.records(chain);
        let (id, thin, plan) = (run.manifest.run_id(), run.manifest.plan.thin, run.manifest.plan);
        let whole = records::length(&path)?;
        let bytes = whole;
        let mut extent = Extent { run: id, chain, thin, bytes, end_iteration: plan.end() };
        let (bytes, end_iteration) = if bytes == 0 { (0, 0) } else { Blocks::open(&path, extent)?.intact() };
        extent = Extent { bytes, end_iteration, ..extent };
        Ok(Self { extent, lost: whole - bytes, snapshot: None })
    }
}
