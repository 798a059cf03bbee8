//! Sampling into a run folder, and going on with one.

use crate::checkpoint::{self, Checkpoint};
use crate::disk::{Disk, RealDisk};
use crate::drive::{Alone, Drive, Journey};
use crate::error::{Error, RunFileError, RunFileProblem};
use crate::folder::Folder;
use crate::gauge::{Gauge, Mixing};
use crate::manifest::{Manifest, Recipe, VERSION, stored_scalars};
use crate::records::{self, Extent};
use crate::replay::evaluate_again;
use crate::sink::{FolderSink, Place};
use plaus_mcmc::{Control, Distinct, Ending, Progress, Pulse, RunError, Start, Target};
use plaus_scenes::{Scenario, Scene, Visitor};
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::Arc;

/// What is said of a requirement that is not given.
const BY_ITS_MAKER: &str = "go on with it from the program that gave it";

/// Where the chains of a scene go on from.
pub(crate) type Starts<S> = Vec<Start<<S as Target>::Draw, <S as Target>::Outcome>>;

/// Looks on while a run is sampled, and may stop it.
pub trait Watch {
    /// Called before the first round; `done` iterations of each chain are done already.
    fn begin(&mut self, _manifest: &Manifest, _done: u64) {}

    /// Called after each round; says whether to go on.
    fn round(&mut self, progress: &Progress<'_>) -> Control;

    /// Whether what was sampled since the last checkpoint is worth writing one. The final bytes do not depend on the answers; what
    /// a killed process loses does.
    fn checkpoint_due(&mut self) -> bool {
        true
    }

    /// Called after a checkpoint was written.
    fn checkpoint_done(&mut self) {}

    /// What the chains report to while they are at work, and are stopped by.
    fn pulse(&self) -> Arc<Pulse> {
        Arc::default()
    }

    /// Whether to keep, in memory, what [`Watch::mixing`] takes.
    fn looks_at_mixing(&self) -> bool {
        false
    }

    /// Whether to find out now how well the outcomes mix; asked after each round where [`Watch::looks_at_mixing`] says so.
    fn mixing_due(&mut self) -> bool {
        false
    }

    /// Called with what was found; `None` where there is too little to tell.
    fn mixing(&mut self, _mixing: Option<Mixing>) {}
}

/// Watches nothing: runs to the end, with a checkpoint after every round.
#[derive(Debug, Clone, Copy, Default)]
pub struct Unwatched;

impl Watch for Unwatched {
    fn round(&mut self, _: &Progress<'_>) -> Control {
        Control::Continue
    }
}

/// How to sample, beside what.
pub struct Sampling<'a> {
    /// Threads; 0 is one a core. Never changes results.
    pub threads: usize,
    /// Where to write.
    pub disk: &'a dyn Disk,
    /// Who looks on.
    pub watch: &'a mut dyn Watch,
}

impl<'a> Sampling<'a> {
    /// On the operating system's disk.
    pub fn new(threads: usize, watch: &'a mut dyn Watch) -> Self {
        Self { threads, disk: &RealDisk, watch }
    }

    fn pool(&self) -> Result<ThreadPool, Error> {
        let built = ThreadPoolBuilder::new().num_threads(self.threads).build();
        built.map_err(|error| Error::Sampling(format!("cannot start worker threads: {error}")))
    }
}

/// Samples a new run into `folder`.
///
/// # Errors
/// [`Error`] where the folder exists, the scenario makes no scene, a chain fails or the disk refuses.
pub fn sample(folder: &Folder, recipe: &Recipe, sampling: Sampling<'_>) -> Result<Ending, Error> {
    sample_by(folder, recipe, sampling, &Alone)
}

/// As [`sample`], with the chains driven by `drive`: under a requirement, say.
///
/// # Errors
/// As [`sample`], and as `drive` says.
pub fn sample_by<D: Drive>(
    folder: &Folder,
    recipe: &Recipe,
    sampling: Sampling<'_>,
    drive: &D,
) -> Result<Ending, Error> {
    struct Begin<'a, 'b, D>(&'a Folder, &'a Recipe, Sampling<'b>, &'a D);
    impl<D: Drive> Visitor for Begin<'_, '_, D> {
        type Output = Result<Ending, Error>;
        fn visit<S: Scene>(self, scene: S) -> Self::Output {
            let Self(folder, recipe, sampling, drive) = self;
            let manifest = Manifest { requirement: drive.requirement(), ..recipe.manifest(&scene)? };
            let json = manifest.to_json().map_err(|problem| RunFileError::new(folder.path(), problem))?;
            folder.create(sampling.disk, &json)?;
            let _claim = folder.claim()?;
            go_on(folder, &manifest, &Arc::new(scene), Vec::new(), sampling, drive)
        }
    }
    recipe.scenario.world.visit(Begin(folder, recipe, sampling, drive))?
}

/// What a run is asked for beyond its plan.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct More {
    /// Iterations of the sampling phase, in all.
    pub iterations: Option<u64>,
    /// Distinct solutions, in all, after which to stop.
    pub solutions: Option<u64>,
}

/// Goes on with a run from its last checkpoint, to its planned end or as far as `more` says.
///
/// # Errors
/// [`Error`] where the run is damaged, made by another version or being written, `more` is less than planned, or as [`sample`].
pub fn resume(folder: &Folder, more: More, sampling: Sampling<'_>) -> Result<Ending, Error> {
    resume_by(folder, more, sampling, &Alone)
}

/// As [`resume`], with the chains driven as they were by [`sample_by`].
///
/// # Errors
/// As [`resume`], and where `drive` is another one than the run's.
pub fn resume_by<D: Drive>(folder: &Folder, more: More, sampling: Sampling<'_>, drive: &D) -> Result<Ending, Error> {
    struct GoOn<'a, 'b, D>(&'a Folder, Manifest, Sampling<'b>, &'a D);
    impl<D: Drive> Visitor for GoOn<'_, '_, D> {
        type Output = Result<Ending, Error>;
        fn visit<S: Scene>(self, scene: S) -> Self::Output {
            let Self(folder, manifest, sampling, drive) = self;
            let starts = restore(folder, &manifest, &scene, &sampling)?;
            go_on(folder, &manifest, &Arc::new(scene), starts, sampling, drive)
        }
    }
    Manifest::read(folder)?; // what is no run gets no lock file
    let _claim = folder.claim()?;
    let mut manifest = Manifest::read(folder)?; // nobody else changes it from here on
    if manifest.plaus != VERSION {
        let problem = RunFileProblem::OtherVersion { made: manifest.plaus, present: VERSION };
        return Err(RunFileError::new(folder.path(), problem).into());
    }
    if manifest.requirement != drive.requirement() {
        return Err(Error::Request(match &manifest.requirement {
            Some(name) => format!("this run has a requirement, {name}, that its folder does not hold: {BY_ITS_MAKER}"),
            None => "this run has no requirement: it goes on without one".to_owned(),
        }));
    }
    Manifest::clear(folder, sampling.disk);
    let scenario = manifest.scenario()?;
    if extend(&mut manifest, &scenario, more)? {
        manifest.replace(folder, sampling.disk)?;
    }
    scenario.world.visit(GoOn(folder, manifest, sampling, drive))?
}

/// Writes `more` into the plan; says whether that changes it.
fn extend(manifest: &mut Manifest, scenario: &Scenario, more: More) -> Result<bool, Error> {
    let before = manifest.plan;
    if let Some(wanted) = more.iterations.filter(|&wanted| wanted != before.iterations) {
        let planned = before.iterations;
        if wanted < planned {
            let message = format!(
                "{planned} iterations are planned already: a run can be made longer, not shorter than {planned}"
            );
            return Err(Error::Request(message));
        }
        Scenario::read(&manifest.scenario.file, &scenario.to_toml(), &[format!("sampler.iterations={wanted}")])
            .map_err(|error| {
                let why = error.problems.first().map(|problem| problem.message.as_str()).unwrap_or_default();
                Error::Request(format!("a run cannot have that many iterations: {why}"))
            })?;
        manifest.extended_from.push(planned);
        manifest.plan.iterations = wanted;
    }
    if let Some(wanted) = more.solutions {
        if let Some(planned) = before.solutions.filter(|&planned| wanted < planned) {
            let message = format!("{planned} distinct solutions are looked for already: ask for {planned} or more");
            return Err(Error::Request(message));
        }
        manifest.plan.solutions = Some(wanted);
    }
    Ok(manifest.plan != before)
}

/// The states to go on from. Cuts off what was written after the last checkpoint.
fn restore<S: Scene>(
    folder: &Folder,
    manifest: &Manifest,
    scene: &S,
    sampling: &Sampling<'_>,
) -> Result<Starts<S>, Error> {
    let disk = sampling.disk;
    if stored_scalars(scene) != manifest.scalars {
        let message = "the scene's scalars are not those of the manifest".to_owned();
        return Err(RunFileError::new(folder.manifest(), RunFileProblem::Differs(message)).into());
    }
    let (run, chains) = (manifest.run_id(), manifest.plan.chains);
    let checkpoints = checkpoint::settle::<S::Draw, S::Outcome>(folder, disk, run, chains)?;
    if checkpoints.is_empty() {
        (0..chains).try_for_each(|chain| cut(folder, disk, chain, 0))?;
    }
    let restore = |checkpoint| restore_chain(folder, manifest, scene, disk, checkpoint);
    sampling.pool()?.install(|| checkpoints.into_par_iter().map(restore).collect())
}

fn restore_chain<S: Scene>(
    folder: &Folder,
    manifest: &Manifest,
    scene: &S,
    disk: &dyn Disk,
    checkpoint: Checkpoint<S::Draw, S::Outcome>,
) -> Result<Start<S::Draw, S::Outcome>, Error> {
    let Checkpoint { chain, records, snapshot, .. } = checkpoint;
    let states = snapshot.replicas.iter().flat_map(|replicas| &replicas.states).chain([&snapshot.state]);
    for state in states {
        evaluate_again(scene, state, manifest.requirement.is_some()).map_err(|problem| match problem {
            Ok(problem) => RunFileError::new(folder.checkpoint(chain), problem).into(),
            Err(error) => error,
        })?;
    }
    let path = folder.records(chain);
    let end_iteration = snapshot.end_iteration;
    let extent = Extent { run: manifest.run_id(), chain, thin: manifest.plan.thin, bytes: records, end_iteration };
    let distinct: Distinct = records::distinct::<S::Draw, S::Outcome>(&path, extent, manifest.plan.warmup)?;
    if snapshot.counts.len() != manifest.moves.len() {
        let message = format!("{} moves are counted, the scene has {}", snapshot.counts.len(), manifest.moves.len());
        return Err(RunFileError::new(folder.checkpoint(chain), RunFileProblem::Mixed(message)).into());
    }
    let kernels = scene.moves(&manifest.scenario()?.sampler.rules)?;
    let tempered = snapshot.replicas.iter().flat_map(|replicas| replicas.scales.iter().flatten());
    if !snapshot.scales.iter().chain(tempered).all(|scales| scales.fit(&kernels)) {
        let message = "its scales are not those of the scene's moves".to_owned();
        return Err(RunFileError::new(folder.checkpoint(chain), RunFileProblem::Mixed(message)).into());
    }
    let (rungs, moves) = (manifest.plan.rungs, manifest.moves.len());
    if snapshot.replicas.as_ref().map_or(rungs != 1, |replicas| !replicas.fits(rungs, moves)) {
        let message = format!("the checkpoint is not one of {rungs} rungs");
        return Err(RunFileError::new(folder.checkpoint(chain), RunFileProblem::Mixed(message)).into());
    }
    cut(folder, disk, chain, records)?;
    Ok(Start { snapshot, distinct })
}

fn cut(folder: &Folder, disk: &dyn Disk, chain: u32, bytes: u64) -> Result<(), RunFileError> {
    let path = folder.records(chain);
    if records::length(&path)? > bytes {
        disk.truncate(&path, bytes).map_err(RunFileError::io(&path, "cut"))?;
    }
    Ok(())
}

fn go_on<S: Scene, D: Drive>(
    folder: &Folder,
    manifest: &Manifest,
    scene: &Arc<S>,
    starts: Starts<S>,
    sampling: Sampling<'_>,
    drive: &D,
) -> Result<Ending, Error> {
    let moves = scene.moves(&manifest.scenario()?.sampler.rules)?;
    let done = starts.first().map_or(0, |start| start.snapshot.end_iteration);
    let lengths = (0..manifest.plan.chains)
        .map(|chain| records::length(&folder.records(chain)))
        .collect::<Result<Vec<_>, _>>()?;
    let pool = sampling.pool()?;
    let Sampling { threads, disk, watch } = sampling;
    watch.begin(manifest, done);
    let (plan, pulse, run) = (manifest.plan, watch.pulse(), manifest.run_id());
    let looks = watch.looks_at_mixing();
    let gauge = if looks { Some(gauge(folder, &**scene, manifest, &lengths, done)?) } else { None };
    let mut sink = FolderSink::new(Place { folder, disk, run, pool }, watch, gauge, lengths, done);
    let ended = drive.drive(scene, &moves, Journey { plan, starts, threads, pulse: &pulse }, &mut sink);
    let finished = if matches!(ended, Err(RunError::Sink(_))) { Ok(()) } else { sink.checkpoint() };
    let safe = sink.safe();
    let ending = ended.map_err(|error| Error::of_run(error, safe))?;
    finished.map_err(|error| Error::of_run(RunError::Sink(error), safe))?;
    Ok(ending)
}

/// A gauge that has seen what is recorded already.
fn gauge<'a, S: Scene>(
    folder: &Folder,
    scene: &'a S,
    manifest: &Manifest,
    lengths: &[u64],
    end_iteration: u64,
) -> Result<Gauge<'a, S>, RunFileError> {
    let mut gauge = Gauge::new(scene, &manifest.plan);
    for (chain, &bytes) in (0..).zip(lengths).filter(|_| end_iteration > manifest.plan.warmup) {
        let extent = Extent { run: manifest.run_id(), chain, thin: manifest.plan.thin, bytes, end_iteration };
        gauge.read(&folder.records(chain), extent)?;
    }
    Ok(gauge)
}
