//! Solids that meshes are, and convex pieces.

use crate::arrays::{frozen, given};
use numpy::ndarray::Dim;
use plaus_asset::Triangles;
use plaus_asset::recognise::{Solid, recognised};
use plaus_scenes::import::cut;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Kind, sizes, middle, axes as columns, and the two deviations.
type Found<'py> = (&'static str, Vec<f64>, Bound<'py, PyAny>, Bound<'py, PyAny>, f64, f64);

/// Corners of the pieces, and how far these stand out of the mesh, and it out of them.
type Pieces<'py> = (Vec<Bound<'py, PyAny>>, f64, f64);

/// The triangles that arguments are.
fn mesh(py: Python<'_>, vertices: &Bound<'_, PyAny>, triangles: &Bound<'_, PyAny>) -> PyResult<Triangles> {
    let (numbers, [_, three]) = given::<2>(py, "vertices", vertices)?;
    let (indices, [_, corners]) = given::<2>(py, "triangles", triangles)?;
    if three != 3 || corners != 3 {
        return Err(PyValueError::new_err("vertices and triangles: three numbers in each row are expected"));
    }
    let places: Vec<glam::DVec3> = numbers.chunks_exact(3).map(glam::DVec3::from_slice).collect();
    let index = |number: &f64| {
        let is_index = number.fract() == 0.0 && (0.0..places.len() as f64).contains(number);
        is_index.then_some(*number as u32).ok_or_else(|| {
            PyValueError::new_err(format!("triangles: {number} is not the index of one of {} vertices", places.len()))
        })
    };
    let indices = indices.iter().map(index).collect::<PyResult<Vec<u32>>>()?;
    let faces: Vec<[u32; 3]> = indices.chunks_exact(3).map(|face| [face[0], face[1], face[2]]).collect();
    Triangles::new("mesh", &places, &faces).map_err(|error| PyValueError::new_err(error.to_string()))
}

/// The convex pieces of a hollow mesh, if it is one.
#[pyfunction]
pub(crate) fn convex_pieces<'py>(
    py: Python<'py>,
    vertices: &Bound<'py, PyAny>,
    triangles: &Bound<'py, PyAny>,
) -> PyResult<Option<Pieces<'py>>> {
    let mut mesh = mesh(py, vertices, triangles)?;
    if mesh.volume() < 0.0 {
        mesh.faces.iter_mut().for_each(|face| face.reverse());
    }
    let Some(found) = py.detach(|| cut(&mesh)) else { return Ok(None) };
    let flat = |points: &Vec<glam::DVec3>| points.iter().flat_map(|point| point.to_array()).collect::<Vec<f64>>();
    let arrays = found.pieces.iter().map(|points| frozen(py, Dim([points.len(), 3]), flat(points)));
    Ok(Some((arrays.collect::<PyResult<_>>()?, found.out, found.lacks)))
}

/// The solid that a mesh is, if it is one.
#[pyfunction]
pub(crate) fn recognize<'py>(
    py: Python<'py>,
    vertices: &Bound<'py, PyAny>,
    triangles: &Bound<'py, PyAny>,
    tolerance: f64,
) -> PyResult<Option<Found<'py>>> {
    if !(tolerance >= 0.0 && tolerance.is_finite()) {
        return Err(PyValueError::new_err(format!("tolerance: a number from 0 up is expected, not {tolerance}")));
    }
    let mesh = mesh(py, vertices, triangles)?;
    let Some(found) = py.detach(|| recognised(&mesh, tolerance)) else { return Ok(None) };
    let size = match found.solid {
        Solid::Ball { radius } => vec![radius],
        Solid::Box { size } => size.to_array().to_vec(),
        Solid::Cylinder { radius, height } | Solid::Cone { radius, height } => vec![radius, height],
        Solid::Capsule { radius, length } => vec![radius, length],
    };
    let axes = glam::DMat3::from_quat(found.turn).transpose().to_cols_array().to_vec();
    let (at, axes) = (frozen(py, Dim([3]), found.at.to_array().to_vec())?, frozen(py, Dim([3, 3]), axes)?);
    Ok(Some((found.solid.name(), size, at, axes, found.off, found.gap)))
}
