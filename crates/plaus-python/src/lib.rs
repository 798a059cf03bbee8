//! The extension module behind the Python package `plaus`: only what cannot be written in Python.
//!
//! The package itself, with its documentation, is in `python/plaus`.

mod arrays;
mod chance;
mod clock;
mod errors;
mod motion;
mod outcome;
mod parcel;
mod requirement;
mod run;
mod sampling;
mod scenario;
mod shapes;
mod sim;
mod target;
mod wait;

use pyo3::prelude::*;

/// Compiled parts of `plaus`. Use the package.
#[pymodule]
mod _plaus {
    use super::*;
    use pyo3::exceptions::PyValueError;
    use std::ffi::OsString;

    #[pymodule_export]
    use crate::chance::{chance, read_chance};
    #[pymodule_export]
    use crate::errors::{Problem, RunError, ScenarioError, WorldError};
    #[pymodule_export]
    use crate::motion::Motion;
    #[pymodule_export]
    use crate::outcome::Outcome;
    #[pymodule_export]
    use crate::parcel::Parcels;
    #[pymodule_export]
    use crate::requirement::Asked;
    #[pymodule_export]
    use crate::run::RunFolder;
    #[pymodule_export]
    use crate::sampling::sample;
    #[pymodule_export]
    use crate::scenario::{_scenario, Scenario};

    #[pymodule_export]
    use crate::shapes::{convex_pieces, recognize};
    #[pymodule_export]
    use crate::sim::SimWorld;
    #[pymodule_export]
    use crate::target::{CheckReport, Functions, Kernel, Rng, check, sample_target};

    #[pymodule_export]
    #[allow(non_upper_case_globals, reason = "the name in Python")]
    const __version__: &str = env!("CARGO_PKG_VERSION");

    /// Runs a command line, whose first word is the program's name, and returns the exit code.
    #[pyfunction]
    fn command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
        py.detach(|| plaus_cli::run(arguments))
    }

    /// Runs a command line that begins without the program's name; raises errors.
    #[pyfunction]
    fn call(py: Python<'_>, arguments: Vec<OsString>) -> PyResult<()> {
        py.detach(|| plaus_cli::call(arguments)).map_err(PyValueError::new_err)
    }
}
