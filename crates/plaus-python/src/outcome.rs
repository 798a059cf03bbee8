//! The outcome of a candidate, as a function in Python sees it.

use crate::errors::RunError;
use crate::motion::Motion;
use plaus_mcmc::{Goal, ModelError, StateRef, StateRefOf};
use plaus_run::Draw;
use plaus_run::codec::{self, Kind};
use plaus_scenes::{Scene, Stage, animation};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, OnceLock};

/// Read only by a process of the same program, and never stored.
pub(crate) const KIND: Kind = Kind::new(*b"outc", 1, "an outcome");

/// What is known of a state without another simulation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Numbers {
    pub(crate) values: Vec<f64>,
    pub(crate) log_prior: f64,
    pub(crate) log_constraint: f64,
    pub(crate) satisfied: bool,
}

/// The outcome of a candidate, which a requirement judges.
///
/// Scalars are available at once; motion and impacts are made when they are first used. Once a function has used them,
/// they come from the simulation that runs anyway, if the scene keeps it, and otherwise from a further simulation.
#[pyclass(frozen, module = "plaus")]
pub(crate) struct Outcome {
    scene: Arc<Stage>,
    draw: Draw,
    names: Arc<[String]>,
    numbers: Numbers,
    motion: OnceLock<Motion>,
    /// Set when the motion is asked for.
    looks: Option<Arc<AtomicBool>>,
}

impl Outcome {
    /// What came of a state; `looks` is told when its motion is asked for, `motion` is that, where it is known.
    pub(crate) fn of(
        scene: &Arc<Stage>,
        names: &Arc<[String]>,
        state: StateRefOf<'_, Stage>,
        (looks, motion): (&Arc<AtomicBool>, Option<animation::Motion>),
    ) -> Self {
        let mut values = vec![0.0; names.len()];
        scene.write_scalars(state, &mut values);
        let StateRef { draw, log_prior, log_constraint, .. } = state;
        let (log_prior, log_constraint) = (log_prior.value(), log_constraint.value());
        let numbers = Numbers { values, log_prior, log_constraint, satisfied: scene.class(state).is_some() };
        let motion = motion.map_or_else(OnceLock::new, |motion| Motion(Arc::new(motion)).into());
        Self { motion, looks: Some(Arc::clone(looks)), ..Self::new(scene, names, numbers, draw.clone()) }
    }

    /// What another process needs to make it again.
    ///
    /// # Errors
    /// [`ModelError`] if the draw is too long.
    pub(crate) fn pack(&self) -> Result<Vec<u8>, ModelError> {
        codec::encode(KIND, &(&self.numbers, &self.draw)).map_err(ModelError::new)
    }

    /// What came of `draw`.
    pub(crate) fn new(scene: &Arc<Stage>, names: &Arc<[String]>, numbers: Numbers, draw: Draw) -> Self {
        Self { scene: Arc::clone(scene), draw, names: Arc::clone(names), numbers, motion: OnceLock::new(), looks: None }
    }
}

#[pymethods]
impl Outcome {
    /// The scene's scalars by name, as in the table of draws.
    #[getter]
    fn scalars<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let scalars = PyDict::new(py);
        self.names.iter().zip(&self.numbers.values).try_for_each(|(name, value)| scalars.set_item(name, value))?;
        Ok(scalars)
    }

    /// One of the scene's scalars: `outcome["rest_x"]`.
    fn __getitem__(&self, name: &str) -> PyResult<f64> {
        let found = self.names.iter().position(|known| known == name);
        found.map(|index| self.numbers.values[index]).ok_or_else(|| {
            let known = self.names.join(", ");
            pyo3::exceptions::PyKeyError::new_err(format!("there is no scalar `{name}`: there are {known}"))
        })
    }

    /// Log prior density of the draw, up to a constant.
    #[getter]
    fn log_prior(&self) -> f64 {
        self.numbers.log_prior
    }

    /// Log constraint of the scenario alone, up to a constant.
    #[getter]
    fn log_constraint(&self) -> f64 {
        self.numbers.log_constraint
    }

    /// Whether the scenario's own constraint is satisfied.
    #[getter]
    fn satisfied(&self) -> bool {
        self.numbers.satisfied
    }

    /// The motion of all bodies, without the scenery.
    #[getter]
    fn motion(&self, py: Python<'_>) -> PyResult<Motion> {
        if let Some(looks) = &self.looks {
            looks.store(true, Relaxed);
        }
        if let Some(motion) = self.motion.get() {
            return Ok(motion.clone());
        }
        // Other chains continue in the meantime.
        let made = py.detach(|| self.scene.motion(&self.draw)).map_err(|error| RunError::new_err(error.to_string()))?;
        Ok(self.motion.get_or_init(|| Motion(Arc::new(made))).clone())
    }

    /// Names of the bodies.
    #[getter]
    fn bodies(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        Ok(self.motion(py)?.0.tracks.iter().map(|track| track.name.clone()).collect())
    }

    /// Position of each body at the end, by name: (x, y, z) in m, y up.
    #[getter]
    fn rest<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let motion = self.motion(py)?;
        let rest = PyDict::new(py);
        for track in &motion.0.tracks {
            rest.set_item(&track.name, track.position(motion.0.duration).to_array())?;
        }
        Ok(rest)
    }

    /// Orientation of each body at the end, by name: a unit quaternion (x, y, z, w) from its axes to the world's.
    #[getter]
    fn rest_orientation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let motion = self.motion(py)?;
        let rest = PyDict::new(py);
        for track in &motion.0.tracks {
            rest.set_item(&track.name, track.orientation(motion.0.duration).to_array())?;
        }
        Ok(rest)
    }

    fn __repr__(&self) -> String {
        let numbers = self.names.iter().zip(&self.numbers.values).take(6);
        let numbers: Vec<String> = numbers.map(|(name, value)| format!("{name}={value:.4}")).collect();
        let more = if self.names.len() > 6 { ", ..." } else { "" };
        format!("<Outcome {}{more}, satisfied={}>", numbers.join(", "), self.numbers.satisfied)
    }
}
