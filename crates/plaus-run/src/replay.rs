//! An animation rebuilt from a stored draw.

use crate::error::{Error, RunFileError, RunFileProblem};
use crate::read::RunReader;
use crate::sample_id::SampleId;
use plaus_mcmc::{Goal, ModelError, State, StateOf, Target, parallel};
use plaus_scenes::animation::Physics;
use plaus_scenes::{AccuracyPreset, Animation, AnyScratch, Scene, Stage, Until};
use serde::Serialize;

/// A recorded draw, simulated again.
#[derive(Debug, Clone, Serialize)]
pub struct Replay {
    /// The sample.
    #[serde(flatten)]
    pub sample: SampleId,
    /// The iteration that recorded it.
    pub iteration: u64,
    /// `log p(A)`, equal bit for bit to the recorded one.
    pub log_p: f64,
    /// The log prior.
    pub log_prior: f64,
    /// The log constraint.
    pub log_constraint: f64,
    /// Whether it satisfies the constraint.
    pub satisfied: bool,
    /// The scalars of the scene.
    pub scalars: Vec<(String, f64)>,
    /// The motion.
    pub animation: Animation,
    /// What was recorded, if this is another simulation of the same draw.
    pub recorded: Option<Recorded>,
}

/// What a run recorded of a draw that was simulated again at another accuracy.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Recorded {
    /// The accuracy of the new simulation.
    pub accuracy: AccuracyPreset,
    /// The recorded `log p(A)`.
    pub log_p: f64,
    /// Whether the recorded state satisfies the constraint.
    pub satisfied: bool,
}

/// Rebuilds the animation of a draw, and makes sure that it is the one that was sampled.
///
/// # Errors
/// [`Error`] if there is no such draw, or if this program makes a different state from it than the one that was
/// recorded.
pub fn replay(run: &RunReader<'_>, sample: SampleId) -> Result<Replay, Error> {
    let entry = run.sample(sample)?;
    rebuild(run, sample, &entry.state, entry.class.is_some(), Until::Rest)
}

/// The world at the start of a draw's motion, for other simulators; `None` if its scene does not tell it.
///
/// # Errors
/// [`Error`] if there is no such draw.
pub fn physics(run: &RunReader<'_>, sample: SampleId) -> Result<Option<Physics>, Error> {
    Ok(run.scene().physics(&run.sample(sample)?.state.draw)?)
}

/// Simulates a recorded draw at another accuracy. First checks that this program reproduces the recorded state at the
/// run's own accuracy.
///
/// # Errors
/// As [`replay`], and if the scene has no accuracy to choose.
pub fn replay_at(run: &RunReader<'_>, sample: SampleId, accuracy: AccuracyPreset) -> Result<Replay, Error> {
    let entry = run.sample(sample)?;
    run.run().manifest().judges_alone()?;
    same(run, sample, &entry.state)?;
    let scene = at_accuracy(run.scene(), run.run().scenario().world.name(), accuracy)?;
    let state = State::evaluate(&scene, entry.state.draw.clone(), &mut AnyScratch::default())?;
    let satisfied = scene.class(state.by_ref()).is_some();
    let recorded = Recorded { accuracy, log_p: entry.state.log_p().value(), satisfied: entry.class.is_some() };
    Ok(Replay { recorded: Some(recorded), ..shown(run, &scene, (sample, satisfied), &state, Until::Rest)? })
}

/// A scene at another accuracy, or why there is none.
pub(crate) fn at_accuracy(scene: &Stage, name: &str, accuracy: AccuracyPreset) -> Result<Stage, Error> {
    scene.at_accuracy(accuracy)?.ok_or_else(|| Error::Request(always_exact(name)))
}

/// Why the scene `name` has no other accuracy.
pub(crate) fn always_exact(name: &str) -> String {
    format!("{name} moves in closed form, which is always exact: there is no accuracy to choose")
}

/// Rebuilds many draws, reading each chain's records once, and passes each to `make`, on all threads. Gives the results
/// in the order of `samples`.
///
/// # Errors
/// As [`replay`].
pub fn replay_each<T: Send>(
    run: &RunReader<'_>,
    samples: &[SampleId],
    make: impl Fn(Replay) -> T + Sync,
) -> Result<Vec<T>, Error> {
    replay_each_until(run, samples, Until::Rest, make)
}

/// The same, with animations that end as asked.
///
/// # Errors
/// As [`replay`].
pub fn replay_each_until<T: Send>(
    run: &RunReader<'_>,
    samples: &[SampleId],
    until: Until,
    make: impl Fn(Replay) -> T + Sync,
) -> Result<Vec<T>, Error> {
    let states = states(run, samples)?;
    parallel::try_map(states.len(), |k| {
        let (index, state, satisfied) = &states[k];
        rebuild(run, samples[*index], state, *satisfied, until).map(&make)
    })
}

/// A recorded state with its place in a list, and whether it satisfies the constraint.
pub(crate) type Found = (usize, StateOf<Stage>, bool);

/// The recorded states of many draws, in order, reading each chain's records once.
pub(crate) fn states(run: &RunReader<'_>, samples: &[SampleId]) -> Result<Vec<Found>, Error> {
    let order = in_order(samples);
    let mut states: Vec<Option<Found>> = samples.iter().map(|_| None).collect();
    let part = |index: usize| (samples[index].chain, samples[index].phase);
    for wanted in order.chunk_by(|&a, &b| part(a) == part(b)) {
        let mut wanted = wanted.iter().copied().peekable();
        let Some((chain, phase)) = wanted.peek().map(|&index| part(index)) else { continue };
        run.walk(chain, phase, |repeats| -> Result<(), Error> {
            while let Some(index) = wanted.next_if(|&index| samples[index].draw < repeats.draw + repeats.draws) {
                states[index] = Some((index, repeats.entry.state.clone(), repeats.entry.class.is_some()));
            }
            Ok(())
        })?;
        if let Some(missing) = wanted.next() {
            // This says which draws exist.
            run.sample(samples[missing])?;
        }
    }
    Ok(states.into_iter().flatten().collect())
}

/// Places of samples in the order in which they were recorded.
fn in_order(samples: &[SampleId]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..samples.len()).collect();
    order.sort_by_key(|&index| samples[index]);
    order
}

fn rebuild(
    run: &RunReader<'_>,
    sample: SampleId,
    stored: &StateOf<Stage>,
    satisfied: bool,
    until: Until,
) -> Result<Replay, Error> {
    let state = same(run, sample, stored)?;
    shown(run, run.scene(), (sample, satisfied), &state, until)
}

/// The state evaluated again, which must have the stored bits.
fn same(run: &RunReader<'_>, sample: SampleId, stored: &StateOf<Stage>) -> Result<StateOf<Stage>, Error> {
    evaluate_again(run.scene(), stored, run.run().manifest().requirement.is_some()).map_err(|problem| match problem {
        Ok(problem) => RunFileError::new(run.run().folder().records(sample.chain), problem).into(),
        Err(error) => error,
    })
}

/// A state in the form that `scene` shows.
fn shown(
    run: &RunReader<'_>,
    scene: &Stage,
    (sample, satisfied): (SampleId, bool),
    state: &StateOf<Stage>,
    until: Until,
) -> Result<Replay, Error> {
    let names = scene.scalars().into_iter().map(|scalar| scalar.name);
    let mut values = vec![0.0; names.len()];
    scene.write_scalars(state.by_ref(), &mut values);
    Ok(Replay {
        sample,
        iteration: run.iteration_of(sample.phase, sample.draw),
        log_p: state.log_p().value(),
        log_prior: state.log_prior.value(),
        log_constraint: state.log_constraint.value(),
        satisfied,
        scalars: names.zip(values).collect(),
        animation: scene.animate_until(&state.draw, until)?,
        recorded: None,
    })
}

/// Evaluates the draw of a stored state again, which must give the same bits: if not, other code made it. Where the run
/// has a requirement that its folder does not hold, its mark is taken as stored, unless `scene` asks it.
pub(crate) fn evaluate_again(
    scene: &Stage,
    stored: &StateOf<Stage>,
    is_required: bool,
) -> Result<StateOf<Stage>, Result<RunFileProblem, Error>> {
    let failed = |error: ModelError| Err(error.into());
    let again = State::evaluate(scene, stored.draw.clone(), &mut AnyScratch::default()).map_err(failed)?;
    let again = match is_required {
        false => again,
        true => {
            let outcome = again.outcome.completed_by(&stored.outcome, again.log_constraint);
            let log_constraint = scene.log_constraint(&outcome).map_err(failed)?;
            State { outcome, log_constraint, ..again }
        }
    };
    let bits = |state: &StateOf<Stage>| (state.log_prior.value().to_bits(), state.log_constraint.value().to_bits());
    if bits(&again) == bits(stored) && again.outcome == stored.outcome {
        return Ok(again);
    }
    let (was, is) = (stored.log_p().value(), again.log_p().value());
    Err(Ok(RunFileProblem::Differs(format!("a stored state has log p {was:?}, but evaluated again it has {is:?}"))))
}
