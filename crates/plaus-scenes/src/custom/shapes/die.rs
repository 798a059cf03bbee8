//! Dice with 4, 8, 10, 12 and 20 faces: their shapes and numbers.

use super::{
    Amount, ConfigError, Deserialize, Form, JsonSchema, Length, Made, Reader, Round, Rounding, Said, Serialize,
    WorldError,
};
use glam::{DMat3, DVec3};
use plaus_dist::math;
use plaus_sim::shape::ConvexHull;
use std::f64::consts::PI;

/// A die: a regular solid, or with 10 faces a solid of kites. Opposite faces add up to one more than there are. With 4
/// faces the one below counts, otherwise the one on top.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Die {
    /// Its number of faces: 4, 8, 10, 12 or 20. With 6, it is a box with `pips`.
    #[schemars(range(min = 4, max = 20))]
    pub sides: u32,
    /// Distance between opposite faces; with 4 faces, from a face to the opposite corner of the sharp die.
    pub size_mm: Amount<Length>,
    /// Radius of its edges and corners; 0 is sharp. The faces do not move.
    #[serde(default)]
    pub rounding_mm: Amount<Rounding>,
}

/// Numbers of faces.
const SIDES: [u32; 5] = [4, 8, 10, 12, 20];

/// How far apart corners are, over half the size, that are one: rounding.
const SAME: f64 = 1e-9;

/// Outward normals of the faces of a die, in order of their numbers. Opposite faces add up to one more than there are;
/// of a tetrahedron no faces are opposite.
fn normals(sides: u32) -> Vec<DVec3> {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let turned = |v: DVec3| [v, DVec3::new(v.y, v.z, v.x), DVec3::new(v.z, v.x, v.y)];
    let cube = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].map(|[x, y]| DVec3::new(x, y, 1.0));
    let signs = [1.0, -1.0];
    // One of each two opposite ones.
    let half: Vec<DVec3> = match sides {
        4 => {
            let all = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
            return all.map(|corner| DVec3::from_array(corner).normalize()).to_vec();
        }
        8 => cube.to_vec(),
        // Kites that lean by half a right angle; those below lie opposite.
        10 => (0..5)
            .map(|k| {
                let (sin, cos) = math::sin_cos(0.4 * PI * f64::from(k));
                DVec3::new(cos, sin, 1.0)
            })
            .collect(),
        12 => signs.into_iter().flat_map(|sign| turned(DVec3::new(0.0, sign, golden))).collect(),
        _ => {
            let inner = signs.into_iter().flat_map(|sign| turned(DVec3::new(sign / golden, 0.0, golden)));
            cube.into_iter().chain(inner).collect()
        }
    };
    // Small numbers lie on all sides.
    let first = half.iter().zip(signs.into_iter().cycle()).map(|(normal, sign)| normal.normalize() * sign);
    let first: Vec<DVec3> = first.collect();
    first.iter().copied().chain(first.iter().rev().map(|normal| -*normal)).collect()
}

impl Said for Die {
    fn read(&self, reader: &mut Reader<'_>) -> Result<Form, ConfigError> {
        let sides = self.sides;
        if !SIDES.contains(&sides) {
            let message = "a die has 4, 8, 10, 12 or 20 faces; with 6 it is a box with `pips = true`";
            return Err(reader.wrong("sides", message));
        }
        let size = reader.number("size_mm", "size", &self.size_mm)?;
        let rounding = reader.number("rounding_mm", "rounding", &self.rounding_mm)?;
        let form = reader
            .form(Round::Not, move |numbers| Made::hull(hull(sides, size.metres(numbers), rounding.metres(numbers))?));
        // Numbers are read on top, of a tetrahedron below.
        let up = if sides == 4 { -1.0 } else { 1.0 };
        let marks = normals(sides).into_iter().map(|normal| normal * up).collect();
        Ok(Form { roundings: vec![rounding], marks, ..form })
    }
}

/// The solid of a die of a size, in m: the distance between opposite faces, or of a tetrahedron from a face to the
/// opposite corner.
///
/// # Errors
/// [`WorldError`] if nothing is left within its rounding.
fn hull(sides: u32, size: f64, rounding: f64) -> Result<ConvexHull, WorldError> {
    let inner = size / if sides == 4 { 4.0 } else { 2.0 } - rounding;
    if inner <= 0.0 {
        let expected = "less than the distance from its middle to its faces";
        return Err(WorldError::BadNumber { field: "rounding", value: rounding, expected });
    }
    ConvexHull::new(&corners(sides, inner), rounding)
}

/// The corners of a die whose faces are so far from its middle: where three planes of faces meet, and no other cuts
/// them off.
fn corners(sides: u32, inner: f64) -> Vec<DVec3> {
    let normals = normals(sides);
    let mut corners: Vec<DVec3> = Vec::new();
    for (i, a) in normals.iter().enumerate() {
        for (j, b) in normals[..i].iter().enumerate() {
            for c in &normals[..j] {
                let planes = DMat3::from_cols(*a, *b, *c).transpose();
                if planes.determinant().abs() < SAME {
                    continue;
                }
                let corner = planes.inverse() * DVec3::ONE;
                let is_inside = normals.iter().all(|normal| normal.dot(corner) <= 1.0 + SAME);
                if is_inside && corners.iter().all(|other| other.distance(corner) > SAME) {
                    corners.push(corner);
                }
            }
        }
    }
    corners.into_iter().map(|corner| corner * inner).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Faces, corners and edges obey Euler's formula; each face is a polygon with as many corners as such dice have,
    /// and opposite faces add up.
    #[test]
    fn dice_are_the_solids_that_they_are_called_after() {
        for (sides, count, of_face) in [(4, 4, 3), (8, 6, 3), (10, 12, 4), (12, 20, 5), (20, 12, 3)] {
            let (normals, corners) = (normals(sides), corners(sides, 2.0));
            assert_eq!((normals.len(), corners.len()), (sides as usize, count));
            for (nth, normal) in normals.iter().enumerate() {
                let on = corners.iter().filter(|corner| (normal.dot(**corner) - 2.0).abs() < 1e-9).count();
                assert_eq!(on, of_face, "d{sides}, face {}", nth + 1);
                let opposite = normals[sides as usize - 1 - nth];
                assert!(sides == 4 || (*normal + opposite).length() < 1e-15);
            }
            assert_eq!(normals.len() * of_face / 2 + 2, count + normals.len());
        }
    }
}
