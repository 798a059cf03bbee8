//! An animation rebuilt from a stored draw.

use crate::error::{Error, RunFileError, RunFileProblem};
use crate::read::{Phase, RunOf};
use crate::tally::SampleId;
use plaus_mcmc::{State, StateOf};
use plaus_scenes::{Animation, Scene};
use serde::Serialize;

/// A draw of the sampling phase, simulated again.
#[derive(Debug, Clone, Serialize)]
pub struct Replay {
    /// Which.
    #[serde(flatten)]
    pub sample: SampleId,
    /// The iteration that recorded it.
    pub iteration: u64,
    /// `log p(A)`, equal bit for bit to the recorded one.
    pub log_p: f64,
    /// Its part from the prior.
    pub log_prior: f64,
    /// Its part from the constraint.
    pub log_constraint: f64,
    /// Whether it satisfies the constraint.
    pub satisfied: bool,
    /// The scalars of the scene.
    pub scalars: Vec<(String, f64)>,
    /// The motion.
    pub animation: Animation,
}

/// Where a body is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Pose {
    /// Seconds.
    pub t: f64,
    /// The body's name.
    pub body: String,
    /// Metres.
    pub x: f64,
    /// Metres, upwards.
    pub y: f64,
    /// Metres.
    pub z: f64,
    /// Whether the body hits something at this very time.
    pub impact: bool,
}

/// Rebuilds the animation of a draw, and makes sure that it is the one that was sampled.
///
/// # Errors
/// [`Error`] where there is no such draw, or this program makes something else of it than the one that sampled it.
pub fn replay<S: Scene>(run: &RunOf<'_, S>, sample: SampleId) -> Result<Replay, Error> {
    let SampleId { chain, draw } = sample;
    let entry = run.sample(chain, draw)?;
    let state = evaluate_again(run.scene(), &entry.state).map_err(|problem| match problem {
        Ok(problem) => RunFileError::new(run.run().folder().records(chain), problem).into(),
        Err(error) => error,
    })?;
    let names = run.scene().scalars().into_iter().map(|scalar| scalar.name);
    let mut values = vec![0.0; names.len()];
    run.scene().write_scalars(&state, &mut values);
    Ok(Replay {
        sample,
        iteration: run.iteration_of(Phase::Sampling, draw),
        log_p: state.log_p().value(),
        log_prior: state.log_prior.value(),
        log_constraint: state.log_constraint.value(),
        satisfied: entry.class.is_some(),
        scalars: names.zip(values).collect(),
        animation: run.scene().animate(&state.draw)?,
    })
}

/// Evaluates the draw of a stored state, which must give that state's bits: otherwise other code made it.
pub(crate) fn evaluate_again<S: Scene>(
    scene: &S,
    stored: &StateOf<S>,
) -> Result<StateOf<S>, Result<RunFileProblem, Error>> {
    let again =
        State::evaluate(scene, stored.draw.clone(), &mut S::Scratch::default()).map_err(|error| Err(error.into()))?;
    let bits = |state: &StateOf<S>| (state.log_prior.value().to_bits(), state.log_constraint.value().to_bits());
    if bits(&again) == bits(stored) && again.outcome == stored.outcome {
        return Ok(again);
    }
    let (was, is) = (stored.log_p().value(), again.log_p().value());
    Err(Ok(RunFileProblem::Differs(format!("a stored state has log p {was:?}, evaluated again it has {is:?}"))))
}

/// Poses of all bodies in order of time: `fps` of them a second, and one at every impact and at the end.
#[must_use]
pub fn poses(animation: &Animation, fps: f64) -> Vec<Pose> {
    let frames = (animation.duration * fps).floor().max(0.0) as u64;
    let mut poses = Vec::new();
    for track in &animation.tracks {
        let hits: Vec<f64> =
            animation.impacts.iter().filter(|hit| hit.body == track.name).map(|hit| hit.time).collect();
        let mut times: Vec<f64> = (0..=frames).map(|frame| frame as f64 / fps).collect();
        times.extend(&hits);
        times.push(animation.duration);
        times.sort_by(f64::total_cmp);
        times.dedup();
        poses.extend(times.into_iter().map(|t| {
            let place = track.position(t);
            Pose { t, body: track.name.clone(), x: place.x, y: place.y, z: place.z, impact: hits.contains(&t) }
        }));
    }
    poses.sort_by(|a, b| a.t.total_cmp(&b.t)); // stable: bodies keep their order at equal times
    poses
}

#[cfg(test)]
mod tests {
    use super::*;
    use plaus_scenes::animation::{Impact, Piece, Track};

    #[test]
    fn every_impact_has_a_pose_at_its_very_time() {
        let zero = plaus_scenes::animation::Piece {
            start: 0.0,
            position: Default::default(),
            velocity: Default::default(),
            acceleration: Default::default(),
        };
        let landed = Piece { start: 0.3, ..zero };
        let hit = |time| Impact {
            time,
            body: "a".into(),
            other: "table".into(),
            point: Default::default(),
            normal: Default::default(),
        };
        let track = |name: &str| Track { name: name.into(), pieces: vec![zero, landed] };
        let animation =
            Animation { duration: 1.0, tracks: vec![track("a"), track("b")], impacts: vec![hit(0.3), hit(0.5)] };
        let poses = poses(&animation, 4.0);
        let times = |body: &str| {
            poses.iter().filter(|pose| pose.body == body).map(|pose| (pose.t, pose.impact)).collect::<Vec<_>>()
        };
        let plain = [0.0, 0.25, 0.5, 0.75, 1.0].map(|t| (t, false));
        assert_eq!(times("b"), plain);
        assert_eq!(times("a"), [(0.0, false), (0.25, false), (0.3, true), (0.5, true), (0.75, false), (1.0, false)]);
        assert!(poses.is_sorted_by(|a, b| a.t <= b.t));
    }
}
