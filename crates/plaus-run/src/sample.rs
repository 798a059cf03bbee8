//! Sampling into a run folder, and continuing a run.

use crate::checkpoint::{self, Checkpoint};
use crate::disk::{Disk, RealDisk};
use crate::error::{Error, RunFileError, RunFileProblem};
use crate::folder::Folder;
use crate::gauge::Gauge;
use crate::manifest::{Manifest, Recipe, VERSION, stored_scalars};
use crate::records::{self, Extent};
use crate::replay::evaluate_again;
use crate::shard::Shard;
use crate::siblings::Siblings;
use crate::sink::{FolderSink, Hunt, Place};
use crate::trail;
use crate::trial;
use crate::watch::Watch;
use crate::way::Way;
use crate::{Draw, Outcome};
use plaus_mcmc::{Distinct, Ending, RunError, Start, parallel, run_some};
use plaus_scenes::require::Judge;
use plaus_scenes::{AnyScene, Scenario, Scene, Stage};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::path::Path;
use std::sync::Arc;

/// Message about a requirement that is missing.
const BY_ITS_MAKER: &str = "continue it from the program that defined it";

/// Where the chains of a scene continue.
type Starts = Vec<Start<Draw, Outcome>>;

/// What is required beyond a scenario.
#[derive(Debug, Clone)]
pub struct Further {
    /// A name, for the manifest.
    pub name: String,
    /// Judges the states of the scenario's scene.
    pub judge: Arc<dyn Judge<AnyScene>>,
}

/// How to sample.
pub struct Sampling<'a> {
    /// Threads; 0 means one per core. No more are started than there are replicas of chains. Never changes results.
    pub threads: usize,
    /// Where to write.
    pub disk: &'a dyn Disk,
    /// Watches the run, and may stop it.
    pub watch: &'a mut dyn Watch,
    /// What is required beyond the scenario, if anything. A run goes on only with what it was made with.
    pub further: Option<Further>,
}

impl<'a> Sampling<'a> {
    /// On the operating system's disk.
    pub fn new(threads: usize, watch: &'a mut dyn Watch) -> Self {
        Self { threads, disk: &RealDisk, watch, further: None }
    }

    /// The name of what is required beyond the scenario.
    fn requirement(&self) -> Option<String> {
        self.further.as_ref().map(|further| further.name.clone())
    }

    /// The scene that is sampled.
    fn stage(&self, scenario: &Scenario) -> Result<Stage, Error> {
        let scene = scenario.stage()?.interrupted_by(self.watch.pulse().flag());
        Ok(match &self.further {
            None => scene,
            Some(further) => scene.judged_by(Arc::clone(&further.judge)),
        })
    }

    fn pool(&self, manifest: &Manifest) -> Result<ThreadPool, Error> {
        let threads = plaus_mcmc::useful_threads(self.threads, &manifest.plan, &manifest.chains());
        let built = ThreadPoolBuilder::new().num_threads(threads).build();
        built.map_err(|error| Error::Sampling(format!("cannot start worker threads: {error}")))
    }
}

/// Samples a new run into `folder`. If it is stopped before it is decided how draws are made, the folder holds no
/// draws, and [`resume`] decides then; a run that it was to replace stays.
///
/// # Errors
/// [`Error`] if the folder exists, the scenario is invalid, a chain fails or the disk refuses.
pub fn sample(folder: &Folder, recipe: &Recipe, sampling: Sampling<'_>) -> Result<Ending, Error> {
    sample_shard(folder, recipe, None, sampling)
}

/// Like [`sample()`], but for the chains of one piece only; `None` samples all.
///
/// # Errors
/// As [`sample()`], and if there are fewer chains than pieces.
pub fn sample_shard(
    folder: &Folder,
    recipe: &Recipe,
    shard: Option<Shard>,
    sampling: Sampling<'_>,
) -> Result<Ending, Error> {
    folder.refuse_to_replace()?;
    let scene = sampling.stage(&recipe.scenario)?;
    sampling.watch.noted(&scene.notes());
    let manifest = Manifest { requirement: sampling.requirement(), ..piece(recipe, &scene, shard)? };
    let manifest = decided(manifest, &recipe.scenario, &scene, &sampling)?;
    let is_undecided = is_undecided(&manifest, &recipe.scenario);
    if is_undecided && folder.manifest().exists() {
        return Ok(Ending::Stopped); // the run that it would replace is worth more
    }
    let json = manifest.to_json().map_err(|problem| RunFileError::new(folder.path(), problem))?;
    folder.create(sampling.disk, &json, &manifest.contents)?;
    let _claim = folder.claim()?;
    if is_undecided {
        return Ok(Ending::Stopped);
    }
    go_on(folder, &manifest, &scene, Vec::new(), sampling)
}

/// Samples a new run, or a piece of one, into `folder`; if the folder already holds this same run, continues it. So a
/// job that is started again and again reaches its end.
///
/// # Errors
/// As [`sample_shard`] and [`resume`], and if the folder holds another run.
pub fn sample_or_go_on(
    folder: &Folder,
    recipe: &Recipe,
    shard: Option<Shard>,
    mut sampling: Sampling<'_>,
) -> Result<Ending, Error> {
    if !folder.manifest().exists() {
        let Sampling { threads, disk, ref mut watch, ref further } = sampling;
        let again = Sampling { threads, disk, watch: &mut **watch, further: further.clone() };
        let begun = sample_shard(folder, recipe, shard, again);
        // If two processes begin at once, one makes the run, and the other continues it.
        let too_late = |problem: &RunFileProblem| {
            matches!(problem, RunFileProblem::Exists | RunFileProblem::Taken | RunFileProblem::Locked)
        };
        match begun {
            Err(Error::File(error)) if too_late(&error.problem) && folder.manifest().exists() => {}
            begun => return begun,
        }
    }
    let found = Manifest::read(folder)?;
    let piece = piece(recipe, &recipe.scenario.stage()?, shard)?;
    let mut expected = Manifest { requirement: sampling.requirement(), ..piece };
    if let Some(way) = found.way.clone().filter(|_| trial::decides(&recipe.scenario)) {
        // A trial always has the same result.
        expected = expected.made(way, &recipe.scenario.stage()?, &recipe.scenario)?;
    }
    match found.differs_from(&expected) {
        Some(difference) => Err(RunFileError::new(folder.path(), RunFileProblem::OtherRun(difference)).into()),
        None => resume(folder, More::default(), sampling),
    }
}

/// Whether a trial has yet to decide how a run's draws are made: the run was stopped before. `scenario` is the run's.
#[must_use]
pub fn is_undecided(manifest: &Manifest, scenario: &Scenario) -> bool {
    let asks = scenario.sampler.method.is_some() || trial::looks_for_some(&manifest.plan);
    manifest.way.is_none() && trial::decides(scenario) && (manifest.requirement.is_none() || asks)
}

/// The manifest of a run, once it is decided how its draws are made; the same if it is stopped before.
fn decided(manifest: Manifest, scenario: &Scenario, scene: &Stage, sampling: &Sampling<'_>) -> Result<Manifest, Error> {
    if !is_undecided(&manifest, scenario) {
        return Ok(manifest);
    }
    let (plan, pulse) = (manifest.plan, sampling.watch.pulse());
    if manifest.requirement.is_some() {
        let why = "a trial does not ask a requirement written in a program".to_owned();
        return manifest.made(Way { independent: false, climbs: trial::looks_for_some(&plan), why }, scene, scenario);
    }
    let tried = || trial::tried(scenario, plan, scene, &pulse);
    match parallel::install(&sampling.pool(&manifest)?, tried) {
        Err(_) if pulse.is_stopped() => Ok(manifest),
        tried => manifest.made(tried?, scene, scenario),
    }
}

fn piece(recipe: &Recipe, scene: &Stage, shard: Option<Shard>) -> Result<Manifest, Error> {
    let manifest = Manifest { shard, ..recipe.manifest(scene)? };
    if let Some(shard) = shard {
        shard.range(manifest.plan.chains).map_err(|error| Error::Request(error.to_string()))?;
    }
    Ok(manifest)
}

/// A request beyond a run's plan.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct More {
    /// Total iterations of the sampling phase.
    pub iterations: Option<u64>,
    /// Total number of distinct solutions after which to stop.
    pub solutions: Option<u64>,
}

/// Continues a run from its last checkpoint, to its planned end or as far as `more` says. If it is not decided yet how
/// its draws are made, that comes first; `more` is only kept once it is.
///
/// # Errors
///
/// [`Error`] if the run is damaged, made by another version or being written, if `more` is less than planned, or for
/// the reasons of [`sample`]; also if the run was made with another further requirement.
pub fn resume(folder: &Folder, more: More, sampling: Sampling<'_>) -> Result<Ending, Error> {
    folder.open_manifest()?; // a folder that is not a run gets no lock file
    let _claim = loop {
        match folder.claim() {
            Err(error) if matches!(error.problem, RunFileProblem::Locked) && sampling.watch.locked(folder) => {}
            claim => break claim?,
        }
    };
    let mut manifest = Manifest::read(folder)?; // from here on nobody else changes it
    if manifest.plaus != VERSION {
        let problem = RunFileProblem::OtherVersion { made: manifest.plaus, present: VERSION };
        return Err(RunFileError::new(folder.path(), problem).into());
    }
    if manifest.requirement != sampling.requirement() {
        return Err(Error::Request(match &manifest.requirement {
            Some(name) => format!("this run has a requirement, {name}, that its folder does not hold: {BY_ITS_MAKER}"),
            None => "this run has no requirement: continue it without one".to_owned(),
        }));
    }
    Manifest::clear(folder, sampling.disk);
    let scenario = manifest.scenario()?;
    let scene = sampling.stage(&scenario)?;
    if is_undecided(&manifest, &scenario) {
        extend(&mut manifest.clone(), &scenario, more)?; // what cannot be is refused before the trial
        manifest = decided(manifest, &scenario, &scene, &sampling)?;
        if is_undecided(&manifest, &scenario) {
            return Ok(Ending::Stopped);
        }
        manifest.replace(folder, sampling.disk)?;
    }
    if extend(&mut manifest, &scenario, more)? {
        manifest.replace(folder, sampling.disk)?;
    }
    let starts = match restore(folder, &manifest, &scene, &sampling) {
        Err(Error::Model(error)) if error.is_interruption() => return Ok(Ending::Stopped),
        restored => restored?,
    };
    go_on(folder, &manifest, &scene, starts, sampling)
}

/// Writes `more` into the plan; says whether that changes it.
fn extend(manifest: &mut Manifest, scenario: &Scenario, more: More) -> Result<bool, Error> {
    let before = manifest.plan;
    if let Some(wanted) = more.iterations.filter(|&wanted| wanted != before.iterations) {
        let planned = before.iterations;
        if wanted < planned {
            let message =
                format!("{planned} iterations are already planned: a run can be made longer, but not shorter");
            return Err(Error::Request(message));
        }
        let said = [format!("sampler.iterations={wanted}")];
        Scenario::read_with(&manifest.scenario.file, &scenario.to_toml(), &said, &manifest.contents).map_err(
            |error| {
                let why = error.problems.first().map(|problem| problem.message.as_str()).unwrap_or_default();
                Error::Request(format!("a run cannot have that many iterations: {why}"))
            },
        )?;
        manifest.extended_from.push(planned);
        manifest.plan.iterations = wanted;
    }
    if let Some(wanted) = more.solutions {
        if manifest.shard.is_some() && before.solutions.is_none() {
            let message = "a piece that was begun without `--solutions` cannot look for them, because pieces must note from \
                       their first iteration where they could be cut; sample the pieces again";
            return Err(Error::Request(message.to_owned()));
        }
        if let Some(planned) = before.solutions.filter(|&planned| wanted < planned) {
            let message = format!("{planned} distinct solutions are already asked for: ask for {planned} or more");
            return Err(Error::Request(message));
        }
        manifest.plan.solutions = Some(wanted);
    }
    Ok(manifest.plan != before)
}

/// The states to continue from. Cuts off anything written after the last checkpoint.
fn restore(folder: &Folder, manifest: &Manifest, scene: &Stage, sampling: &Sampling<'_>) -> Result<Starts, Error> {
    let disk = sampling.disk;
    if stored_scalars(scene) != manifest.scalars {
        let message = "the scene's scalars are not those of the manifest".to_owned();
        return Err(RunFileError::new(folder.manifest(), RunFileProblem::Differs(message)).into());
    }
    let (run, chains) = (manifest.run_id(), manifest.chains());
    let checkpoints = checkpoint::read_all(folder, run, chains.clone())?;
    checkpoint::clear(folder, disk)?;
    if checkpoints.is_empty() {
        chains.into_iter().try_for_each(|chain| cut(&folder.records(chain), disk, 0))?;
    }
    let done = checkpoints.first().map_or(0, |checkpoint| checkpoint.snapshot.end_iteration);
    cut(&folder.trail(), disk, trail::length_until(&folder.trail(), run, done)?)?;
    let mut checkpoints: Vec<_> = checkpoints.into_iter().map(Some).collect();
    let restored = parallel::install(&sampling.pool(manifest)?, || {
        parallel::map_mut(&mut checkpoints, |_, checkpoint| {
            checkpoint.take().map(|checkpoint| restore_chain(folder, manifest, scene, disk, checkpoint))
        })
    });
    restored.into_iter().flatten().collect()
}

fn restore_chain(
    folder: &Folder,
    manifest: &Manifest,
    scene: &Stage,
    disk: &dyn Disk,
    checkpoint: Checkpoint,
) -> Result<Start<Draw, Outcome>, Error> {
    let Checkpoint { chain, records, snapshot, .. } = checkpoint;
    let states = snapshot.replicas.iter().flat_map(|replicas| &replicas.states).chain([&snapshot.state]);
    for state in states {
        evaluate_again(scene, state, manifest.requirement.is_some()).map_err(|problem| match problem {
            Ok(RunFileProblem::Differs(message)) if manifest.requirement.is_some() => Error::Request(format!(
                "{message}: does the requirement answer as before, and does it depend on the outcome alone?"
            )),
            Ok(problem) => RunFileError::new(folder.checkpoints(), problem).into(),
            Err(error) => error,
        })?;
    }
    let path = folder.records(chain);
    let end_iteration = snapshot.end_iteration;
    let extent = Extent { run: manifest.run_id(), chain, thin: manifest.plan.thin, bytes: records, end_iteration };
    let distinct: Distinct = records::distinct(&path, extent, manifest.plan, scene)?;
    if snapshot.counts.len() != manifest.moves.len() {
        let message =
            format!("{} moves are counted, but the scene has {}", snapshot.counts.len(), manifest.moves.len());
        return Err(RunFileError::new(folder.checkpoints(), RunFileProblem::Mixed(message)).into());
    }
    let kernels = manifest.mixture(scene)?;
    let tempered = snapshot.replicas.iter().flat_map(|replicas| replicas.scales.iter().flatten());
    if !snapshot.scales.iter().chain(tempered).all(|scales| scales.fit(&kernels)) {
        let message = "its scales are not those of the scene's moves".to_owned();
        return Err(RunFileError::new(folder.checkpoints(), RunFileProblem::Mixed(message)).into());
    }
    let (plan, moves) = (&manifest.plan, manifest.moves.len());
    let found = snapshot.replicas.as_ref().map(|replicas| replicas.climb().ladder().betas().len() as u32);
    let rungs = if plan.adapt_rungs { found.unwrap_or(plan.rungs) } else { plan.rungs };
    if snapshot.replicas.as_ref().map_or(rungs != 1, |replicas| !replicas.fits(rungs, moves)) {
        let message = format!("the checkpoint is not for {rungs} rungs");
        return Err(RunFileError::new(folder.checkpoints(), RunFileProblem::Mixed(message)).into());
    }
    cut(&path, disk, records)?;
    Ok(Start { snapshot, distinct })
}

fn cut(path: &Path, disk: &dyn Disk, bytes: u64) -> Result<(), RunFileError> {
    if records::length(path)? > bytes {
        disk.truncate(path, bytes).map_err(RunFileError::io(path, "cut"))?;
    }
    Ok(())
}

fn go_on(
    folder: &Folder,
    manifest: &Manifest,
    scene: &Stage,
    starts: Starts,
    sampling: Sampling<'_>,
) -> Result<Ending, Error> {
    let moves = manifest.mixture(scene)?;
    let done = starts.first().map_or(0, |start| start.snapshot.end_iteration);
    let lengths =
        manifest.chains().map(|chain| records::length(&folder.records(chain))).collect::<Result<Vec<_>, _>>()?;
    let pool = sampling.pool(manifest)?;
    let Sampling { threads, disk, watch, .. } = sampling;
    watch.begin(manifest, done);
    let (plan, pulse, run) = (manifest.plan, watch.pulse(), manifest.run_id());
    let looks = watch.looks_at_mixing();
    let gauge = if looks { Some(gauge(folder, scene, manifest, &lengths, done)?) } else { None };
    let chains = manifest.chains();
    let place = Place { folder, disk, run, pool, first: chains.start };
    let hunt = plan.solutions.filter(|_| manifest.shard.is_some());
    let mut hunt = hunt.map(|wanted| Hunt { siblings: Siblings::new(folder, run, plan.chains), wanted, over: false });
    if let Some(hunt) = &mut hunt {
        hunt.siblings.note(starts.iter().flat_map(|start| start.distinct.sightings()), chains.clone(), done);
        if hunt.is_over(done) {
            return Ok(Ending::EnoughSolutions);
        }
    }
    let mut sink = FolderSink::new(place, watch, gauge, lengths, done, hunt);
    let ended = run_some(scene, &moves, plan, chains, starts, threads, &mut sink, &pulse);
    let finished = if matches!(ended, Err(RunError::Sink(_))) { Ok(()) } else { sink.checkpoint() };
    let safe = sink.safe();
    let ending = ended.map_err(|error| Error::of_run(error, safe))?;
    finished.map_err(|error| Error::of_run(RunError::Sink(error), safe))?;
    Ok(if sink.is_past_the_end() { Ending::EnoughSolutions } else { ending })
}

/// A gauge with everything that is already recorded.
fn gauge<'a>(
    folder: &Folder,
    scene: &'a Stage,
    manifest: &Manifest,
    lengths: &[u64],
    end_iteration: u64,
) -> Result<Gauge<'a>, RunFileError> {
    let mut gauge = Gauge::new(scene, &manifest.plan, manifest.chains());
    for (chain, &bytes) in manifest.chains().zip(lengths).filter(|_| end_iteration > manifest.plan.warmup) {
        let extent = Extent { run: manifest.run_id(), chain, thin: manifest.plan.thin, bytes, end_iteration };
        gauge.read(&folder.records(chain), extent)?;
    }
    Ok(gauge)
}
