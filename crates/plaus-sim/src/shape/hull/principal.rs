//! Principal moments and axes of a symmetric tensor, by Jacobi's rotations.
//!
//! Source: Golub & Van Loan, *Matrix Computations*, §8.5 (cyclic Jacobi). It uses only a fixed order of rotations and
//! square roots, so the bits are the same everywhere.

use glam::{DMat3, DVec3};

/// Fraction of the trace below which entries off the diagonal count as rounding. Default 1e-14.
const ROUNDING: f64 = 1e-14;

/// Difference of two moments, over the larger, below which they count as equal: the free rotation of a top then has its
/// closed form, and rounding does not turn the axes. Default 1e-12.
const EQUAL: f64 = 1e-12;

/// Sweeps over the three entries; convergence is quadratic, five or six suffice.
const SWEEPS: usize = 20;

/// Moments, and the axes as columns of a rotation. Axes that are already principal stay as they are.
pub(crate) fn principal(tensor: DMat3) -> (DVec3, DMat3) {
    let mut m: [[f64; 3]; 3] = tensor.to_cols_array_2d();
    let mut axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let tiny = ROUNDING * (m[0][0] + m[1][1] + m[2][2]);
    for _ in 0..SWEEPS {
        let mut is_done = true;
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let off = m[p][q];
            if off.abs() <= tiny {
                continue;
            }
            is_done = false;
            let slant = (m[q][q] - m[p][p]) / (2.0 * off);
            let tangent = slant.signum() / (slant.abs() + (slant * slant + 1.0).sqrt());
            let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
            let sine = tangent * cosine;
            m[p][p] -= tangent * off;
            m[q][q] += tangent * off;
            (m[p][q], m[q][p]) = (0.0, 0.0);
            let r = 3 - p - q;
            let (a, b) = (m[r][p], m[r][q]);
            let (a, b) = (cosine * a - sine * b, sine * a + cosine * b);
            (m[r][p], m[p][r], m[r][q], m[q][r]) = (a, a, b, b);
            let (e, g) = (axes[p], axes[q]);
            (axes[p], axes[q]) = (e * cosine - g * sine, e * sine + g * cosine);
        }
        if is_done {
            break;
        }
    }
    (levelled(DVec3::new(m[0][0], m[1][1], m[2][2])), DMat3::from_cols(axes[0], axes[1], axes[2]))
}

/// Makes moments that are equal except for rounding exactly equal.
fn levelled(i: DVec3) -> DVec3 {
    let near = |a: f64, b: f64| (a - b).abs() <= EQUAL * a.max(b);
    let (xy, yz, zx) = (near(i.x, i.y), near(i.y, i.z), near(i.z, i.x));
    match (xy, yz, zx) {
        (false, false, false) => i,
        (true, false, false) => {
            let mean = 0.5 * (i.x + i.y);
            DVec3::new(mean, mean, i.z)
        }
        (false, true, false) => {
            let mean = 0.5 * (i.y + i.z);
            DVec3::new(i.x, mean, mean)
        }
        (false, false, true) => {
            let mean = 0.5 * (i.z + i.x);
            DVec3::new(mean, i.y, mean)
        }
        _ => DVec3::splat((i.x + i.y + i.z) / 3.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    #[test]
    fn a_turned_tensor_is_turned_back() {
        for (turn, moments) in [
            ([0.3, -0.2, 0.5, 0.7], DVec3::new(1.0, 2.0, 2.5)),
            ([0.1, 0.8, -0.1, 0.2], DVec3::new(5.0, 5.0, 1.0)),
            ([0.0, 0.0, 0.6, 0.8], DVec3::new(3.0, 1.0, 2.5)),
        ] {
            let r = DMat3::from_quat(DQuat::from_array(turn).normalize());
            let tensor = r * DMat3::from_diagonal(moments) * r.transpose();
            let (found, axes) = principal(tensor);
            assert!((axes.determinant() - 1.0).abs() < 1e-14);
            let back = axes * DMat3::from_diagonal(found) * axes.transpose();
            // Rounding of a few products of numbers up to 5.
            assert!((0..3).all(|k| (back.col(k) - tensor.col(k)).length() < 1e-13), "{back} for {tensor}");
        }
    }

    #[test]
    fn axes_that_are_principal_stay() {
        let noise = 1e-16;
        let tensor = DMat3::from_cols(DVec3::new(2.0, noise, 0.0), DVec3::new(noise, 2.0 + 4e-16, 0.0), DVec3::Z * 3.0);
        let (moments, axes) = principal(tensor);
        assert_eq!(axes, DMat3::IDENTITY);
        assert!(moments.x == moments.y && moments.z == 3.0);
    }
}
