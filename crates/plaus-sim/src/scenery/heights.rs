//! Height fields: heights at the points of a grid, as scenery of triangles.

use super::Mesh;
use crate::error::WorldError;
use crate::material::Material;
use glam::{DQuat, DVec3};

/// Heights at the points of a grid, with the middle of the grid at the origin. Below the surface it is solid; beyond
/// the grid there is nothing. Each cell is cut into two triangles along the diagonal from its corner of least x and y
/// to that of largest x and y.
///
/// ```
/// use plaus_sim::scenery::Heights;
///
/// // A ramp that falls along x, with a step of 10 mm along y.
/// let ramp = Heights::new([0.1, 0.1], &[vec![0.02, 0.01, 0.0], vec![0.03, 0.02, 0.01]])?;
/// assert!((ramp.height(0.05, 0.0).unwrap() - 0.01).abs() < 1e-15);
/// assert_eq!(ramp.height(0.2, 0.0), None);
/// # Ok::<(), plaus_sim::WorldError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Heights {
    spacing: [f64; 2],
    columns: usize,
    heights: Vec<f64>,
}

impl Heights {
    /// Heights in m: one row of points for each y, in ascending order, and in a row one height for each x. `spacing` is
    /// the distance of neighbouring points along x and y, in m.
    ///
    /// # Errors
    /// [`WorldError::BadNumber`] for a spacing that is not positive, for fewer than two rows or columns, and for rows
    /// of different lengths; [`WorldError::BadControlPoint`] with column and row of a height that is not finite.
    pub fn new(spacing: [f64; 2], rows: &[Vec<f64>]) -> Result<Self, WorldError> {
        let bad = |field, value, expected| Err(WorldError::BadNumber { field, value, expected });
        for value in spacing {
            if !(value > 0.0 && value.is_finite()) {
                return bad("spacing of a height field", value, "a positive length");
            }
        }
        let columns = rows.first().map_or(0, Vec::len);
        for (field, count) in [("rows of a height field", rows.len()), ("heights in a row", columns)] {
            if count < 2 {
                return bad(field, count as f64, "at least 2");
            }
        }
        for (j, row) in rows.iter().enumerate() {
            if row.len() != columns {
                return bad("heights in a row", row.len() as f64, "as many as in the first row");
            }
            if let Some((i, &value)) = row.iter().enumerate().find(|(_, height)| !height.is_finite()) {
                return Err(WorldError::BadControlPoint { field: "heights", i: i as i64, j: j as i64, value });
            }
        }
        Ok(Self { spacing, columns, heights: rows.concat() })
    }

    fn rows(&self) -> usize {
        self.heights.len() / self.columns
    }

    /// Half of its extent along x and y, in m.
    #[must_use]
    pub fn half(&self) -> [f64; 2] {
        [0.5 * self.spacing[0] * (self.columns - 1) as f64, 0.5 * self.spacing[1] * (self.rows() - 1) as f64]
    }

    /// Height of the surface in m; none beyond the grid.
    #[must_use]
    pub fn height(&self, x: f64, y: f64) -> Option<f64> {
        let half = self.half();
        let cell = |p: f64, axis: usize, points: usize| {
            let at = (p + half[axis]) / self.spacing[axis];
            let cell = at.floor().clamp(0.0, (points - 2) as f64);
            (p.abs() <= half[axis]).then_some((cell as usize, at - cell))
        };
        let ((i, u), (j, v)) = (cell(x, 0, self.columns)?, cell(y, 1, self.rows())?);
        let at = |i: usize, j: usize| self.heights[j * self.columns + i];
        let (low, high) = (at(i, j), at(i + 1, j + 1));
        Some(if u >= v {
            low + (at(i + 1, j) - low) * u + (high - at(i + 1, j)) * v
        } else {
            low + (at(i, j + 1) - low) * v + (high - at(i, j + 1)) * u
        })
    }

    /// Corners in m, and triangles that run anticlockwise as seen from above.
    #[must_use]
    pub fn triangles(&self) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let (half, columns, rows) = (self.half(), self.columns, self.rows());
        let corner = |(k, &height): (usize, &f64)| {
            let (i, j) = (k % columns, k / columns);
            DVec3::new(i as f64 * self.spacing[0] - half[0], j as f64 * self.spacing[1] - half[1], height)
        };
        let cells = (0..rows - 1).flat_map(|j| (0..columns - 1).map(move |i| (j * columns + i) as u32));
        let (right, up) = (1, columns as u32);
        let halves = cells.flat_map(|a| [[a, a + right, a + right + up], [a, a + right + up, a + up]]);
        (self.heights.iter().enumerate().map(corner).collect(), halves.collect())
    }

    /// The surface as a mesh of one material, turned by `turn` about the middle of the grid, which is put at `at`.
    ///
    /// # Errors
    /// As [`Mesh::new`]: a height so large that a triangle is degenerate.
    pub fn mesh(&self, at: DVec3, turn: DQuat, material: Material) -> Result<Mesh, WorldError> {
        let (corners, triangles) = self.triangles();
        let faces: Vec<_> = triangles.into_iter().map(|corners| (corners, material)).collect();
        Mesh::new(corners.into_iter().map(|corner| at + turn * corner).collect(), &faces, 0.0)
    }
}
