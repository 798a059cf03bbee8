//! Motions as arrays: poses, which are exact at any time, and impacts.

use crate::arrays::frozen;
use crate::errors::{RunError, room, volume};
use plaus_scenes::animation::{self, Impact};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Arc;

/// The most poses, over all bodies, in one answer: 1.1 GB.
const MOST_POSES: usize = 20_000_000;

/// The motion of all bodies of one sample.
#[pyclass(frozen, module = "plaus._plaus")]
#[derive(Debug, Clone)]
pub(crate) struct Motion(pub(crate) Arc<animation::Motion>);

/// Times of frames, from 0 to the end.
fn frames(duration: f64, fps: f64) -> PyResult<Vec<f64>> {
    if !(fps > 0.0 && fps.is_finite()) {
        return Err(PyValueError::new_err(format!("fps is {fps}, but must be a number above 0")));
    }
    let last = (duration * fps).floor();
    if last >= MOST_POSES as f64 {
        return Err(PyValueError::new_err(format!(
            "fps is {fps}: {last} frames are more than the limit of {MOST_POSES}"
        )));
    }
    Ok((0..=last as u64).map(|frame| frame as f64 / fps).collect())
}

impl Motion {
    /// Positions and orientations of all bodies at each of these times.
    fn at(&self, times: &[f64]) -> PyResult<(Vec<f64>, Vec<f64>)> {
        let tracks = &self.0.tracks;
        let poses = volume(&[times.len(), tracks.len()])?;
        if poses > MOST_POSES {
            return Err(PyValueError::new_err(format!("{poses} poses are more than the limit of {MOST_POSES}")));
        }
        let (mut positions, mut orientations) = (room(0.0, 3 * poses)?, room(0.0, 4 * poses)?);
        let of_body = times.iter().flat_map(|&time| tracks.iter().map(move |track| (track, time)));
        let rooms = positions.chunks_exact_mut(3).zip(orientations.chunks_exact_mut(4));
        for ((track, time), (position, orientation)) in of_body.zip(rooms) {
            if track.is_there(time) {
                position.copy_from_slice(&track.position(time).to_array());
                orientation.copy_from_slice(&track.orientation(time).to_array());
            } else {
                position.fill(f64::NAN);
                orientation.fill(f64::NAN);
            }
        }
        Ok((positions, orientations))
    }
}

#[pymethods]
impl Motion {
    /// Seconds.
    #[getter]
    fn duration(&self) -> f64 {
        self.0.duration
    }

    /// Names of the bodies.
    #[getter]
    fn bodies(&self) -> Vec<String> {
        self.0.tracks.iter().map(|track| track.name.clone()).collect()
    }

    /// Times (s), positions (time, body, xyz; m, y up) and unit quaternions (time, body, xyzw) at `times`, or at `fps`
    /// frames a second. NaN where a body has not appeared.
    #[pyo3(signature = (fps = 60.0, times = None))]
    fn poses<'py>(&self, py: Python<'py>, fps: f64, times: Option<Vec<f64>>) -> PyResult<[Bound<'py, PyAny>; 3]> {
        let times = match times {
            Some(times) => times,
            None => frames(self.0.duration, fps)?,
        };
        if let Some(wrong) = times.iter().find(|time| !time.is_finite()) {
            return Err(PyValueError::new_err(format!("{wrong} is not a time: times are finite numbers of seconds")));
        }
        let (positions, orientations) = py.detach(|| self.at(&times))?;
        let (frames, bodies) = (times.len(), self.0.tracks.len());
        Ok([
            frozen(py, [frames], times)?,
            frozen(py, [frames, bodies, 3], positions)?,
            frozen(py, [frames, bodies, 4], orientations)?,
        ])
    }

    /// Impacts in order of time, as columns.
    #[getter]
    fn events<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let impacts = &self.0.impacts;
        let numbers = |number: fn(&Impact) -> f64| frozen(py, [impacts.len()], impacts.iter().map(number).collect());
        let vectors = |vector: fn(&Impact) -> [f64; 3]| {
            frozen(py, [impacts.len(), 3], impacts.iter().flat_map(vector).collect::<Vec<f64>>())
        };
        let events = PyDict::new(py);
        events.set_item("t", numbers(|hit| hit.time)?)?;
        events.set_item("body", impacts.iter().map(|hit| hit.body.as_str()).collect::<Vec<_>>())?;
        events.set_item("other", impacts.iter().map(|hit| hit.other.as_str()).collect::<Vec<_>>())?;
        events.set_item("point", vectors(|hit| hit.point.to_array())?)?;
        events.set_item("normal", vectors(|hit| hit.normal.to_array())?)?;
        events.set_item("speed", numbers(|hit| hit.speed)?)?;
        events.set_item("impulse", numbers(|hit| hit.impulse)?)?;
        Ok(events)
    }

    /// The whole motion, in closed-form pieces, as JSON.
    fn to_json(&self) -> PyResult<String> {
        serde_json::to_string(&*self.0).map_err(|error| RunError::new_err(error.to_string()))
    }
}
