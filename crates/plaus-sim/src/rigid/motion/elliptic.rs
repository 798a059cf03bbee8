//! Elliptic integrals.

/// The common limit of the arithmetic and the geometric mean of two numbers that are not negative.
pub(super) fn arithmetic_geometric_mean(x: f64, y: f64) -> f64 {
    let (mut x, mut y) = (x, y);
    // The distance is squared in each round, after a few in which it halves for each factor of 4 between the two.
    for _ in 0..64 {
        if (x - y).abs() <= f64::EPSILON * x {
            break;
        }
        (x, y) = (0.5 * (x + y), (x * y).sqrt());
    }
    0.5 * (x + y)
}

/// Carlson's integral of the first kind, `½ ∫₀^∞ dt / √((t + x) (t + y) (t + z))`, of numbers that are not negative, of
/// which at most one is 0 (Carlson, Numer. Algorithms 10 (1995)).
pub(super) fn carlson_rf(x: f64, y: f64, z: f64) -> f64 {
    /// `(3 ε)^(1/8)`: from then on, the series' first term left out is below rounding.
    const NEAR: f64 = 0.012;
    let [mut x, mut y, mut z] = [x, y, z];
    let mut mean = (x + y + z) / 3.0;
    for _ in 0..512 {
        if (mean - x).abs().max((mean - y).abs()).max((mean - z).abs()) < NEAR * mean {
            break;
        }
        let [a, b, c] = [x.sqrt(), y.sqrt(), z.sqrt()];
        let shift = a * b + b * c + c * a;
        [x, y, z] = [x, y, z].map(|v| 0.25 * (v + shift));
        mean = 0.25 * (mean + shift);
    }
    let [x, y] = [1.0 - x / mean, 1.0 - y / mean];
    let z = -x - y;
    let (two, three) = (x * y - z * z, x * y * z);
    let far = two * two * (1.0 / 24.0 - two * (5.0 / 208.0)) + three * (two * two / 16.0 + three * (3.0 / 104.0));
    (1.0 - two / 10.0 + three / 14.0 - two * three * (3.0 / 44.0) + far) / mean.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use plaus_dist::math;
    use std::f64::consts::FRAC_PI_2;

    /// Complete integrals by both means, and incomplete ones that are elementary: of parameter 0 an angle, of
    /// parameter 1 the inverse hyperbolic sine of its tangent. Rounding of some ten operations.
    #[test]
    fn integrals_agree_with_each_other_and_with_elementary_ones() {
        for complement in [1e-15, 1e-9, 0.01, 0.3, 0.9, 1.0 - 1e-9, 1.0_f64] {
            let quarter = FRAC_PI_2 / arithmetic_geometric_mean(1.0, complement.sqrt());
            assert!((carlson_rf(0.0, complement, 1.0) / quarter - 1.0).abs() < 2e-15, "{complement}");
        }
        for angle in [1e-9, 0.1, 0.8, 1.5, FRAC_PI_2 - 1e-9] {
            let (sin, cos) = math::sin_cos(angle);
            let square = cos * cos;
            assert!((sin * carlson_rf(square, 1.0, 1.0) / angle - 1.0).abs() < 2e-15, "{angle}");
            let tangent = sin / cos;
            let elementary = math::ln_1p(tangent + tangent * tangent / (1.0 + (1.0 + tangent * tangent).sqrt()));
            assert!((sin * carlson_rf(square, square, 1.0) / elementary - 1.0).abs() < 2e-15, "{angle}");
        }
    }
}
