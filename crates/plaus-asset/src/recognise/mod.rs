//! Recognises meshes that are balls, boxes, cylinders, cones or capsules.
//!
//! A shape that the simulator has a closed form for is faster and more exact than a mesh with many faces, and a ball
//! that is a ball rolls. A mesh is taken for a solid if
//!
//! - each of its corners is within the tolerance of the solid's surface,
//! - its faces lie no deeper below a round surface than those of a prism of 8 sides or a ball of 8 by 4 faces, and
//! - there is a mesh wherever the solid has a corner, an edge, a tip or the middle of a face.

mod axes;
mod solid;

pub use solid::Solid;

use super::Triangles;
use glam::{DMat3, DQuat, DVec2, DVec3};
use parry3d_f64::query::PointQuery;
use parry3d_f64::shape::TriMesh;

/// How far a corner may be from the surface of the solid that a mesh is taken for, as a share of the solid's least
/// extent: about the deviation that ISO 2768-1 allows a part made with ordinary care (class m: 0.3 mm of 30 to 120 mm).
pub const TOLERANCE: f64 = 0.005;

/// A mesh is flat if the least extent of the solid around it is below this share of its largest.
const FLAT: f64 = 1e-5;
/// Axes this near to those of the mesh itself are these, in radians: files have 7 digits.
const SNAP: f64 = 1e-6;
/// A capsule is longer than a ball by at least this share of its radius.
const LONGER: f64 = 0.01;
/// Corners this far out, as a share of the farthest, are those that a circle is laid through; step by step.
const OUT: [f64; 3] = [0.9, 0.97, 0.995];
/// Corners on edges that are looked at.
const RIMS: usize = 32;

/// A solid that a mesh was taken for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recognised {
    /// The solid about its own middle.
    pub solid: Solid,
    /// Where its middle is in the mesh.
    pub at: DVec3,
    /// Turns its axes into those of the mesh.
    pub turn: DQuat,
    /// Largest distance of a corner of the mesh from its surface.
    pub off: f64,
    /// Largest distance of its surface from the mesh, where that was looked at: the more faces a round mesh has, the
    /// less.
    pub gap: f64,
}

impl Recognised {
    /// A place in the mesh, along the solid's axes about its middle.
    fn inside(&self, place: DVec3) -> DVec3 {
        self.turn.inverse() * (place - self.at)
    }

    /// Measures how far the corners are off, as far as that is no more than the tolerance.
    fn measured(mut self, mesh: &Triangles, size: f64, tolerance: f64) -> Option<Self> {
        let least = self.solid.least();
        if !(least.is_finite() && least > FLAT * size) {
            return None;
        }
        let back = DMat3::from_quat(self.turn).transpose();
        for &corner in &mesh.corners {
            let off = self.solid.distance(back * (corner - self.at)).abs();
            if off.is_nan() || off > tolerance * least {
                return None;
            }
            self.off = self.off.max(off);
        }
        Some(self)
    }

    /// Whether faces lie where the surface is, and the surface where faces are.
    fn fits(&mut self, mesh: &Triangles, tolerance: f64) -> bool {
        let tolerance = tolerance * self.solid.least();
        let depth = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|corner| mesh.corners[corner as usize]);
            let middles = [(a + b + c) / 3.0, 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)];
            middles.into_iter().map(|middle| -self.solid.distance(self.inside(middle))).fold(0.0, f64::max)
        };
        if mesh.faces.iter().any(|face| depth(face) > self.solid.chord() + tolerance) {
            return false;
        }
        let rims: Vec<DVec3> = match self.solid {
            Solid::Cylinder { radius, .. } | Solid::Cone { radius, .. } => {
                let level = mesh.corners.iter().map(|&corner| self.inside(corner) * DVec3::new(1.0, 1.0, 0.0));
                let rims: Vec<DVec3> = level.filter(|at| at.length() >= radius - tolerance).collect();
                rims.iter().step_by(rims.len().div_ceil(RIMS).max(1)).map(|at| at.normalize()).collect()
            }
            _ => Vec::new(),
        };
        let Ok(surface) = TriMesh::new(mesh.corners.clone(), mesh.faces.clone()) else { return false };
        for (point, off) in self.solid.samples(&rims, tolerance) {
            let place = self.at + self.turn * point;
            let gap = surface.project_local_point(place, false).point.distance(place);
            if gap > off {
                return false;
            }
            self.gap = self.gap.max(gap);
        }
        true
    }
}

/// The solid that a mesh is, if it is one: with corners no farther from its surface than `tolerance`, usually
/// [`TOLERANCE`], times the solid's least extent.
///
/// ```
/// use glam::DVec3;
/// use plaus_asset::recognise::{Solid, TOLERANCE, recognised};
///
/// let obj = b"v 0 0 0\nv 1 0 0\nv 1 2 0\nv 0 2 0\nv 0 0 3\nv 1 0 3\nv 1 2 3\nv 0 2 3\n\
///             f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
/// let content = plaus_asset::read("crate.obj", obj)?;
/// let found = recognised(&content.objects[0].triangles, TOLERANCE).expect("it is a box");
/// assert_eq!((found.solid, found.at), (Solid::Box { size: DVec3::new(1.0, 2.0, 3.0) }, DVec3::new(0.5, 1.0, 1.5)));
/// # Ok::<(), plaus_asset::AssetError>(())
/// ```
#[must_use]
pub fn recognised(mesh: &Triangles, tolerance: f64) -> Option<Recognised> {
    let [low, high] = mesh.ends();
    let size = (high - low).max_element();
    if mesh.faces.len() < 4 || !(size.is_finite() && size > 0.0) {
        return None;
    }
    let centre = axes::centre(mesh);
    let turns = axes::axes(mesh, centre);
    let mut candidates: Vec<Recognised> = ball(mesh, 0.5 * (low + high), size).into_iter().collect();
    candidates.extend(turns.iter().map(|turn| boxed(mesh, turn)));
    for axis in turns.iter().flat_map(|turn| [2, 0, 1].map(|k| snapped(turn.col(k)))) {
        candidates.extend(round(mesh, axis, centre, size));
    }
    let measured = candidates.into_iter().filter_map(|candidate| candidate.measured(mesh, size, tolerance));
    let mut fitting: Vec<Recognised> = measured.collect();
    fitting.sort_by(|a, b| a.off.total_cmp(&b.off));
    fitting.into_iter().find_map(|mut candidate| candidate.fits(mesh, tolerance).then_some(candidate))
}

fn placed(solid: Solid, at: DVec3, turn: DQuat) -> Recognised {
    Recognised { solid, at, turn, off: 0.0, gap: 0.0 }
}

/// The ball through the corners, by least squares.
fn ball(mesh: &Triangles, middle: DVec3, size: f64) -> Option<Recognised> {
    // |p|² = 2 c·p + d for all p relative to the middle; without the mean of each, that is 2 (p − m)·c = |p|² − n.
    let all = || mesh.corners.iter().map(|&corner| (corner - middle) / size);
    let count = mesh.corners.len() as f64;
    let mean = all().sum::<DVec3>() / count;
    let square = all().map(DVec3::length_squared).sum::<f64>() / count;
    let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for point in all() {
        let off = point - mean;
        matrix += DMat3::from_cols(off * off.x, off * off.y, off * off.z);
        right += 0.5 * (point.length_squared() - square) * off;
    }
    let centre = solved(matrix, right)?;
    let radius = (square - 2.0 * mean.dot(centre) + centre.length_squared()).max(0.0).sqrt();
    Some(placed(Solid::Ball { radius: radius * size }, middle + size * centre, DQuat::IDENTITY))
}

fn solved(matrix: DMat3, right: DVec3) -> Option<DVec3> {
    // Relative to what it would be if all columns were across each other.
    let whole: f64 = [0, 1, 2].map(|k| matrix.col(k).length()).iter().product();
    (matrix.determinant().abs() > 1e-9 * whole).then(|| matrix.inverse() * right).filter(|at| at.is_finite())
}

/// The box around the corners along these axes, which are taken in the order and with the signs that turn it least.
fn boxed(mesh: &Triangles, turn: &DMat3) -> Recognised {
    let columns = [0, 1, 2].map(|k| snapped(turn.col(k)));
    let mut best = (f64::NEG_INFINITY, DMat3::IDENTITY);
    for [i, j, k] in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]] {
        let signed = [(i, 0), (j, 1), (k, 2)].map(|(of, axis)| {
            let column: DVec3 = columns[of];
            if column[axis] < 0.0 { -column } else { column }
        });
        let made = DMat3::from_cols(signed[0], signed[1], signed[2]);
        let along = made.x_axis.x + made.y_axis.y + made.z_axis.z;
        if made.determinant() > 0.0 && along > best.0 + 1e-9 {
            best = (along, made);
        }
    }
    let turn = best.1;
    let back = turn.transpose();
    let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let [low, high] = mesh.corners.iter().fold(none, |[low, high], &corner| {
        let there = back * corner;
        [low.min(there), high.max(there)]
    });
    placed(Solid::Box { size: high - low }, turn * (0.5 * (low + high)), DQuat::from_mat3(&turn).normalize())
}

/// A direction, as an axis of the mesh where it is one.
fn snapped(axis: DVec3) -> DVec3 {
    let near = axis.round();
    if (axis - near).abs().max_element() <= SNAP && near.length_squared() == 1.0 { near } else { axis }
}

/// The cylinder, the cones and the capsule about an axis in this direction.
fn round(mesh: &Triangles, axis: DVec3, centre: DVec3, size: f64) -> Vec<Recognised> {
    let across = axis.any_orthonormal_vector();
    let other = axis.cross(across);
    let level = |corner: DVec3| DVec2::new(across.dot(corner - centre), other.dot(corner - centre));
    let points: Vec<DVec2> = mesh.corners.iter().map(|&corner| level(corner)).collect();
    let Some((middle, radius)) = circle(&points, size) else { return Vec::new() };
    let ends = mesh.corners.iter().map(|&corner| axis.dot(corner - centre));
    let [low, high] = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], z| [low.min(z), high.max(z)]);
    let at = centre + middle.x * across + middle.y * other + 0.5 * (low + high) * axis;
    let height = high - low;
    // Of the two directions that mean the same, that which points up.
    let points_up = axis.z > SNAP || (axis.z > -SNAP && (axis.y > SNAP || (axis.y > -SNAP && axis.x > 0.0)));
    let upward = if points_up { axis } else { -axis };
    let turn = |axis: DVec3| DQuat::from_rotation_arc(DVec3::Z, axis);
    let mut made = vec![
        placed(Solid::Cylinder { radius, height }, at, turn(upward)),
        placed(Solid::Cone { radius, height }, at, turn(upward)),
        placed(Solid::Cone { radius, height }, at, turn(-upward)),
    ];
    if height > (2.0 + LONGER) * radius {
        made.push(placed(Solid::Capsule { radius, length: height - 2.0 * radius }, at, turn(upward)));
    }
    made
}

/// The circle through the outermost of some points, by least squares.
fn circle(points: &[DVec2], size: f64) -> Option<(DVec2, f64)> {
    let mut middle = DVec2::ZERO;
    for share in OUT {
        let far = points.iter().map(|point| point.distance(middle)).fold(0.0, f64::max);
        if far <= FLAT * size {
            return None;
        }
        let outer = points.iter().map(|&point| (point - middle) / far).filter(|point| point.length() >= share);
        // |p|² = 2 c·p + d.
        let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
        for point in outer {
            let row = DVec3::new(2.0 * point.x, 2.0 * point.y, 1.0);
            matrix += DMat3::from_cols(row * row.x, row * row.y, row * row.z);
            right += point.length_squared() * row;
        }
        let found = solved(matrix, right)?;
        middle += far * DVec2::new(found.x, found.y);
    }
    let radius = points.iter().map(|point| point.distance(middle)).fold(0.0, f64::max);
    Some((middle, radius))
}
