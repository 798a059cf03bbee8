//! Along which axes a mesh may be a solid.

use crate::Triangles;
use glam::{DMat3, DVec3};

/// Two faces lie in parallel planes if the cosine of the angle between them is this near to 1.
const PARALLEL: f64 = 1e-8;
/// Two faces are at right angles, or nearly, if the cosine is below this.
const ACROSS: f64 = 0.05;
/// Rotations of eigenvectors into each other, at most; a matrix of three rows needs about ten.
const SWEEPS: u32 = 64;

/// Twice the area of a face, times its normal.
fn normal(mesh: &Triangles, face: &[u32; 3]) -> DVec3 {
    let [a, b, c] = face.map(|corner| mesh.corners[corner as usize]);
    (b - a).cross(c - a)
}

/// The centre of a mesh's surface.
pub(super) fn centre(mesh: &Triangles) -> DVec3 {
    let mut sum = (DVec3::ZERO, 0.0);
    for face in &mesh.faces {
        let [a, b, c] = face.map(|corner| mesh.corners[corner as usize]);
        let area = normal(mesh, face).length();
        sum = (sum.0 + area / 3.0 * (a + b + c), sum.1 + area);
    }
    if sum.1 > 0.0 { sum.0 / sum.1 } else { DVec3::ZERO }
}

/// Rotations whose columns a solid's axes may be: those of the mesh itself, those of its largest face and the largest
/// one across it, and the principal axes of its normals and of its surface. However a surface is cut into triangles,
/// these are the same.
pub(super) fn axes(mesh: &Triangles, centre: DVec3) -> Vec<DMat3> {
    let normals: Vec<DVec3> = mesh.faces.iter().map(|face| normal(mesh, face)).collect();
    let mut all = vec![DMat3::IDENTITY];
    all.extend(of_faces(&normals));
    let outer = |a: DVec3| DMat3::from_cols(a * a.x, a * a.y, a * a.z);
    let (mut facing, mut spread) = (DMat3::ZERO, DMat3::ZERO);
    for (face, normal) in mesh.faces.iter().zip(&normals) {
        let area = normal.length();
        if area == 0.0 {
            continue;
        }
        facing += outer(*normal) * (1.0 / area);
        let [a, b, c] = face.map(|corner| mesh.corners[corner as usize] - centre);
        // The integral of what is quadratic: 1/12 of its sum over the corners and over three times the middle.
        let all = outer(a) + outer(b) + outer(c) + outer(a + b + c);
        spread += all * (area / 12.0);
    }
    all.extend([facing, spread].into_iter().map(principal));
    all
}

fn of_faces(normals: &[DVec3]) -> Option<DMat3> {
    let largest = |of: &dyn Fn(DVec3) -> bool| {
        let fitting = normals.iter().copied().filter(|&normal| normal != DVec3::ZERO && of(normal.normalize()));
        let one = fitting.max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))?.normalize();
        // The mean of all that lie in planes parallel to it is more exact than one.
        let parallel = normals.iter().filter(|normal| normal.dot(one).abs() >= (1.0 - PARALLEL) * normal.length());
        parallel.map(|normal| *normal * normal.dot(one).signum()).sum::<DVec3>().try_normalize()
    };
    let first = largest(&|_| true)?;
    let second = largest(&|normal| normal.dot(first).abs() < ACROSS)?;
    let second = second.reject_from_normalized(first).try_normalize()?;
    Some(DMat3::from_cols(first, second, first.cross(second)))
}

/// The eigenvectors of a symmetric matrix, as a rotation (Jacobi's method).
fn principal(mut matrix: DMat3) -> DMat3 {
    let mut turn = DMat3::IDENTITY;
    let least = 1e-32 * matrix.to_cols_array().iter().map(|x| x * x).sum::<f64>();
    for _ in 0..SWEEPS {
        let off = |(i, j): (usize, usize)| matrix.col(j)[i];
        let Some((p, q)) = [(0, 1), (0, 2), (1, 2)].into_iter().max_by(|&a, &b| off(a).abs().total_cmp(&off(b).abs()))
        else {
            break;
        };
        let between = off((p, q));
        if between * between <= least {
            break;
        }
        let theta = (matrix.col(q)[q] - matrix.col(p)[p]) / (2.0 * between);
        let sign = if theta < 0.0 { -1.0 } else { 1.0 };
        let tan = sign / (theta.abs() + (theta * theta + 1.0).sqrt());
        let cos = 1.0 / (tan * tan + 1.0).sqrt();
        let sin = tan * cos;
        let mut by = DMat3::IDENTITY;
        by.col_mut(p)[p] = cos;
        by.col_mut(q)[q] = cos;
        by.col_mut(q)[p] = sin;
        by.col_mut(p)[q] = -sin;
        matrix = by.transpose() * matrix * by;
        turn *= by;
    }
    turn
}
