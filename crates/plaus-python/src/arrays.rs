//! Numbers as numpy arrays: handed over without a copy, and read-only.

use crate::errors::RunError;
use numpy::ndarray::{Array, Dimension, IntoDimension};
use numpy::{Element, PyArray, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;

/// An array of these numbers, which takes over their memory.
pub(crate) fn frozen<'py, T: Element, D: Dimension>(
    py: Python<'py>,
    shape: impl IntoDimension<Dim = D>,
    numbers: Vec<T>,
) -> PyResult<Bound<'py, PyAny>> {
    let shaped = Array::from_shape_vec(shape.into_dimension(), numbers);
    let shaped = shaped.map_err(|error| RunError::new_err(format!("an array of another shape: {error}")))?;
    let array = PyArray::from_owned_array(py, shaped);
    array.readwrite().make_nonwriteable();
    Ok(array.into_any())
}

/// A float array of `N` dimensions from an argument: lists and other kinds of numbers are converted.
pub(crate) fn given<'py, const N: usize>(
    py: Python<'py>,
    name: &str,
    value: &Bound<'py, PyAny>,
) -> PyResult<(Vec<f64>, [usize; N])> {
    let numpy = py.import("numpy")?;
    let array = numpy.call_method1("ascontiguousarray", (value, "float64")).map_err(|error| {
        let what = pyo3::exceptions::PyTypeError::new_err(format!("{name}: not an array of numbers"));
        what.set_cause(py, Some(error));
        what
    })?;
    let array = array.cast_into::<numpy::PyArrayDyn<f64>>()?;
    let shape: [usize; N] = array.shape().try_into().map_err(|_| {
        pyo3::exceptions::PyValueError::new_err(format!(
            "{name}: an array of {N} dimensions is expected, but this one has shape {:?}",
            array.shape()
        ))
    })?;
    Ok((array.readonly().as_slice()?.to_vec(), shape))
}
