//! Random bumps on meshes, boxes, and ground by its heights.
//!
//! The surface is cut into triangles with edges of at most half a spacing. Each of their corners is moved along its
//! normal by the value there of a random field in space: a uniform cubic b-spline over control points on a cubic grid
//! along the shape's axes, whose point (0, 0, 0) is the shape's origin. So the field is the same smooth one from
//! whatever side a surface passes through it, and what it is does not depend on how a file cuts its surface.

use super::amount::{Amount, Length, Rounding};
use super::values::{Collector, Numbers, Owner, Value};
use crate::scene::ConfigError;
use crate::uneven::{Field, LARGEST_SCORE, Site};
use glam::DVec3;
use plaus_dist::math;
use plaus_sim::WorldError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::f64::consts::SQRT_2;
use std::sync::Arc;

/// Random bumps on a mesh, a box without rounding, or ground by its heights. The surface is cut into triangles with
/// edges of at most half of `spacing_mm`, and each of their corners is moved along its normal by the value there of a
/// smooth random field in space: a uniform cubic b-spline over control points on a cubic grid along the shape's axes,
/// through its origin. All points are independent of each other. A draw in which bumps turn a triangle over has
/// probability 0.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SurfaceBumps {
    /// Standard deviation of a control point's value. Values beyond six of them count as six.
    pub sd_mm: Amount<Rounding>,
    /// Distance between neighbouring control points.
    pub spacing_mm: Amount<Length>,
}

/// Corners in m, and triangles.
pub(super) type Surface = (Vec<DVec3>, Vec<[u32; 3]>);

/// Gives a surface without bumps, for which no edge needs to be longer than so many m.
pub(super) trait Plain: FnOnce(f64) -> Result<Surface, WorldError> {}

impl<F: FnOnce(f64) -> Result<Surface, WorldError>> Plain for F {}

/// The longest edge of a triangle, over the spacing: straight edges are then off the field by less than a tenth of its
/// standard deviation, in the mean.
const FINEST: f64 = 0.5;
/// Most triangles of a surface with bumps: a draw with so many takes a second.
const MOST_TRIANGLES: usize = 1 << 18;
/// Most control points of the box around a surface.
const MOST_POINTS: usize = 1 << 22;
/// Indices of control points along the second and the third axis are from −SIDE to SIDE − 1.
const SIDE: i64 = 1 << 10;

/// Bumps of a scenario.
#[derive(Debug, Clone)]
pub(super) struct Bumpy {
    sd: Value,
    spacing: Value,
    /// Their place among the tables of a draw.
    index: usize,
    /// The surface without them, where no draw changes it.
    kept: Option<Arc<Skin>>,
}

/// A surface cut into small triangles, with a normal at each corner.
#[derive(Debug)]
struct Skin {
    corners: Vec<DVec3>,
    normals: Vec<DVec3>,
    faces: Vec<[u32; 3]>,
}

impl Bumpy {
    pub(super) fn new(collector: &mut Collector, owner: &Owner<'_>, said: &SurfaceBumps) -> Result<Self, ConfigError> {
        Ok(Self {
            sd: collector.number(owner, "bumps.sd_mm", "bumps_sd", &said.sd_mm)?,
            spacing: collector.number(owner, "bumps.spacing_mm", "bumps_spacing", &said.spacing_mm)?,
            index: collector.table(format!("{}.bumps", owner.name)),
            kept: None,
        })
    }

    /// Distance of control points in m.
    pub(super) fn spacing(&self, numbers: &Numbers<'_>) -> f64 {
        self.spacing.metres(numbers)
    }

    /// Keeps the surface without bumps, which no draw changes; `plain` gives it.
    pub(super) fn keep(&mut self, plain: impl Plain, numbers: &Numbers<'_>) -> Result<(), WorldError> {
        if self.spacing.is_fixed() {
            self.kept = Some(Arc::new(Skin::new(plain, FINEST * self.spacing(numbers))?));
        }
        Ok(())
    }

    /// The surface with its bumps; the second is whether they turn a triangle over.
    pub(super) fn surface(&self, plain: impl Plain, numbers: &Numbers<'_>) -> Result<(Surface, bool), WorldError> {
        let spacing = self.spacing(numbers);
        let skin = match &self.kept {
            Some(kept) => Arc::clone(kept),
            None => Arc::new(Skin::new(plain, FINEST * spacing)?),
        };
        let score = numbers.table(self.index).source();
        let mut field = Grid::around(&skin.corners, spacing)?;
        let sd = self.sd.metres(numbers);
        let moved = |(&corner, &normal): (&DVec3, &DVec3)| {
            let height = field.at(corner / spacing, |point| lattice(point).map_or(0.0, &score));
            corner + normal * (sd * height)
        };
        let corners: Vec<DVec3> = skin.corners.iter().zip(&skin.normals).map(moved).collect();
        let turns = |face: &[u32; 3]| across(&corners, *face).dot(across(&skin.corners, *face)) <= 0.0;
        let is_folded = skin.faces.iter().any(turns);
        Ok(((corners, skin.faces.clone()), is_folded))
    }
}

/// The normal of a triangle, as long as twice its area.
fn across(corners: &[DVec3], face: [u32; 3]) -> DVec3 {
    let [a, b, c] = face.map(|corner| corners[corner as usize]);
    (b - a).cross(c - a)
}

/// A control point of space as one of a table: its second and third index are one.
pub(super) fn lattice([i, j, k]: [i64; 3]) -> Option<Site> {
    let is_near = (-SIDE..SIDE).contains(&j) && (-SIDE..SIDE).contains(&k);
    let [i, j] = [i, j + 2 * SIDE * k].map(i32::try_from);
    is_near.then_some(Site { field: Field::Height, i: i.ok()?, j: j.ok()? })
}

/// What [`lattice`] made.
pub(super) fn indices(site: Site) -> [i64; 3] {
    let j = (i64::from(site.j) + SIDE).rem_euclid(2 * SIDE) - SIDE;
    [i64::from(site.i), j, (i64::from(site.j) - j) / (2 * SIDE)]
}

/// The control points in the box around a surface. Their scores are made when they are first needed.
struct Grid {
    low: [i64; 3],
    count: [usize; 3],
    scores: Vec<f64>,
}

impl Grid {
    fn around(corners: &[DVec3], spacing: f64) -> Result<Self, WorldError> {
        let least = corners.iter().fold(DVec3::INFINITY, |low, corner| low.min(*corner)) / spacing;
        let most = corners.iter().fold(DVec3::NEG_INFINITY, |high, corner| high.max(*corner)) / spacing;
        let far = least.abs().max(most.abs()).max_element();
        if far.is_nan() || far >= (SIDE - 4) as f64 {
            let value = far * spacing;
            let expected = "less than 1,000 spacings of its bumps";
            return Err(WorldError::BadNumber { field: "reach of a surface with bumps in m", value, expected });
        }
        let low = least.to_array().map(|low| low.floor() as i64 - 1);
        let high = most.to_array().map(|high| high.floor() as i64 + 2);
        let count = [0, 1, 2].map(|axis| (high[axis] - low[axis] + 1) as usize);
        let points: usize = count.iter().product();
        if points > MOST_POINTS {
            let expected = "at most 4,194,304: a larger spacing";
            return Err(WorldError::BadNumber { field: "control points of bumps", value: points as f64, expected });
        }
        Ok(Self { low, count, scores: vec![f64::NAN; points] })
    }

    /// The field at a place in cells; `score` gives the control points.
    fn at(&mut self, place: DVec3, score: impl Fn([i64; 3]) -> f64) -> f64 {
        let cell = place.floor();
        let [u, v, w] = (place - cell).to_array().map(basis);
        let first = [0, 1, 2].map(|axis| cell[axis] as i64 - 1);
        let mut sum = 0.0;
        for (a, along_x) in u.iter().enumerate() {
            for (b, along_y) in v.iter().enumerate() {
                for (c, along_z) in w.iter().enumerate() {
                    let point = [first[0] + a as i64, first[1] + b as i64, first[2] + c as i64];
                    let [i, j, k] = [0, 1, 2].map(|axis| (point[axis] - self.low[axis]) as usize);
                    let here = &mut self.scores[(i * self.count[1] + j) * self.count[2] + k];
                    if here.is_nan() {
                        *here = score(point).clamp(-LARGEST_SCORE, LARGEST_SCORE);
                    }
                    sum += along_x * along_y * along_z * *here;
                }
            }
        }
        sum
    }
}

/// The uniform cubic b-spline's weights of four control points.
fn basis(u: f64) -> [f64; 4] {
    let (v, square, cube) = (1.0 - u, u * u, u * u * u);
    [v * v * v, 3.0 * cube - 6.0 * square + 4.0, -3.0 * cube + 3.0 * square + 3.0 * u + 1.0, cube].map(|b| b / 6.0)
}

impl Skin {
    fn new(plain: impl Plain, longest: f64) -> Result<Self, WorldError> {
        let (mut corners, mut faces) = plain(longest)?;
        while let Some(cut) = cut(&mut corners, &faces, longest) {
            faces = cut;
            if faces.len() > MOST_TRIANGLES {
                let expected = "at most 262,144: a larger spacing";
                let value = faces.len() as f64;
                return Err(WorldError::BadNumber { field: "triangles of a surface with bumps", value, expected });
            }
        }
        // Normals of faces, each by its angle at the corner: so they do not depend on how a face is cut.
        let mut normals = vec![DVec3::ZERO; corners.len()];
        for face in &faces {
            let normal = across(&corners, *face).normalize_or_zero();
            for side in 0..3 {
                let [at, next, last] = [0, 1, 2].map(|k| corners[face[(side + k) % 3] as usize]);
                let cos = (next - at).normalize_or_zero().dot((last - at).normalize_or_zero());
                normals[face[side] as usize] += normal * math::acos(cos.clamp(-1.0, 1.0));
            }
        }
        normals.iter_mut().for_each(|normal| *normal = normal.normalize_or_zero());
        Ok(Self { corners, normals, faces })
    }
}

/// A box about its middle, cut into rectangles, and these along their diagonals: a cut along the diagonal of a whole
/// side would leave slivers.
pub(super) fn block(edges: DVec3, longest: f64) -> Surface {
    let most = (MOST_TRIANGLES as f64).sqrt();
    let counts = [0, 1, 2].map(|axis| (edges[axis] / longest * SQRT_2).ceil().clamp(1.0, most) as u32);
    let (mut known, mut corners, mut faces) = (BTreeMap::new(), Vec::new(), Vec::new());
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for (end, i, j) in (0..2).flat_map(|end| (0..counts[u]).map(move |i| (end, i))).flat_map(|(end, i)| {
            let across = counts[v];
            (0..across).map(move |j| (end, i, j))
        }) {
            let mut corner = |right: u32, up: u32| {
                let mut place = [0; 3];
                (place[axis], place[u], place[v]) = (end * counts[axis], i + right, j + up);
                *known.entry(place).or_insert_with(|| {
                    let share = [0, 1, 2].map(|k| f64::from(place[k]) / f64::from(counts[k]) - 0.5);
                    corners.push(edges * DVec3::from_array(share));
                    corners.len() as u32 - 1
                })
            };
            let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
            faces.extend(if end == 1 { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
        }
    }
    (corners, faces)
}

/// Triangles with all edges halved that are longer than a length in m, or `None` if there are none: both triangles of
/// an edge are cut at the same corner.
fn cut(corners: &mut Vec<DVec3>, faces: &[[u32; 3]], longest: f64) -> Option<Vec<[u32; 3]>> {
    let mut halves: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    let mut all = Vec::with_capacity(faces.len());
    for &face in faces {
        let mut half = |side: usize| {
            let (a, b) = (face[side], face[(side + 1) % 3]);
            let ends = [a, b].map(|corner| corners[corner as usize]);
            (ends[0].distance(ends[1]) > longest).then(|| {
                *halves.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                    corners.push(0.5 * (ends[0] + ends[1]));
                    corners.len() as u32 - 1
                })
            })
        };
        let halved = [half(0), half(1), half(2)];
        // Turned so that the first edges are those that are cut.
        let first = match halved {
            [None, Some(_), _] => 1,
            [_, None, Some(_)] => 2,
            _ => 0,
        };
        let [a, b, c] = [0, 1, 2].map(|k| face[(first + k) % 3]);
        match [0, 1, 2].map(|k| halved[(first + k) % 3]) {
            [Some(ab), Some(bc), Some(ca)] => all.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]),
            [Some(ab), Some(bc), None] => all.extend([[ab, b, bc], [a, ab, bc], [a, bc, c]]),
            [Some(ab), ..] => all.extend([[a, ab, c], [ab, b, c]]),
            _ => all.push(face),
        }
    }
    (!halves.is_empty()).then_some(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_space_are_those_of_a_table() {
        for point in [[0, 0, 0], [-5, 3, -2], [7, -1024, 1023], [400, 1023, -1024]] {
            assert_eq!(lattice(point).map(indices), Some(point));
        }
        assert_eq!(lattice([0, 1024, 0]), None);
    }

    /// A tetrahedron and a box: their areas, and that each edge belongs to two triangles, stay as they are.
    #[test]
    fn cutting_leaves_the_surface_as_it_was() {
        let area = |corners: &[DVec3], faces: &[[u32; 3]]| -> f64 {
            faces.iter().map(|face| 0.5 * across(corners, *face).length()).sum()
        };
        let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y * 0.3, DVec3::Z * 2.0];
        let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
        let whole = area(&corners, &faces);
        let edges = DVec3::new(0.4, 0.3, 0.05);
        for (skin, whole, inside) in [
            (Skin::new(|_| Ok((corners, faces)), 0.07), whole, DVec3::new(0.1, 0.05, 0.3)),
            (Skin::new(|longest| Ok(block(edges, longest)), 0.07), 0.24 + 0.07, DVec3::ZERO),
        ] {
            let skin = skin.unwrap();
            assert!((area(&skin.corners, &skin.faces) - whole).abs() < 1e-12);
            let mut edges: BTreeMap<[u32; 2], i32> = BTreeMap::new();
            for face in &skin.faces {
                for side in 0..3 {
                    let (a, b) = (face[side], face[(side + 1) % 3]);
                    assert!(skin.corners[a as usize].distance(skin.corners[b as usize]) <= 0.07);
                    *edges.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
                }
            }
            assert!(edges.values().all(|sum| *sum == 0), "an edge without its other side");
            let out = |k: usize| skin.normals[k].dot(skin.corners[k] - inside) > 0.0;
            assert!((0..skin.corners.len()).all(out));
        }
    }

    /// The weights sum to 1, and a field whose control values are a linear function is that function.
    #[test]
    fn the_field_repeats_linear_functions() {
        let corners = [DVec3::new(-0.3, 0.2, 0.1), DVec3::new(0.5, 0.9, 0.7)];
        let mut grid = Grid::around(&corners, 0.1).unwrap();
        for place in [DVec3::new(-2.3, 4.1, 3.9), DVec3::new(4.9, 8.9, 1.0)] {
            let value = grid.at(place, |[i, j, k]| 0.1 * (i as f64) - 0.2 * (j as f64) + 0.3 * (k as f64));
            assert!((value - place.dot(DVec3::new(0.1, -0.2, 0.3))).abs() < 1e-12, "{value}");
        }
    }
}
