//! Real roots of small polynomials on an interval: all simple ones.
//!
//! Between neighbouring roots of its derivative a polynomial is monotone. There a change of sign brackets exactly one
//! root, which a safeguarded Newton iteration finds to the last bits. No root is chosen by the size of its imaginary
//! part. A double root, which touches zero without crossing, may be missed.

/// Up to four roots, in increasing order.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Roots {
    values: [f64; 4],
    count: usize,
}

impl Roots {
    fn push(&mut self, root: f64) {
        self.values[self.count] = root;
        self.count += 1;
    }

    pub(super) fn as_slice(&self) -> &[f64] {
        &self.values[..self.count]
    }
}

/// Value and slope at `t` of Σ coefficients\[k\]·t^k.
#[inline]
fn value_and_slope<const N: usize>(coefficients: &[f64; N], t: f64) -> (f64, f64) {
    let (mut value, mut slope) = (0.0, 0.0);
    for &c in coefficients.iter().rev() {
        slope = slope * t + value;
        value = value * t + c;
    }
    (value, slope)
}

/// Newton steps shorter than this, relative to 1 + |t|, are the last: the next step would be of the order of its
/// square.
const LAST_STEP: f64 = 1e-8;

/// The root in a bracket over which the polynomial goes from `at_low` to `at_high`, of different signs.
fn refine<const N: usize>(coefficients: &[f64; N], mut low: f64, mut high: f64, at_low: f64, at_high: f64) -> f64 {
    let rising = at_high >= 0.0;
    let mut t = low + (high - low) * (at_low / (at_low - at_high));
    // A step either is Newton's or halves the bracket; 128 are never needed, but bound the loop.
    for _ in 0..128 {
        let (value, slope) = value_and_slope(coefficients, t);
        if (value >= 0.0) == rising {
            high = t;
        } else {
            low = t;
        }
        let step = value / slope;
        let newton = t - step;
        if newton >= low && newton <= high {
            t = newton;
            if step.abs() <= LAST_STEP * (1.0 + t.abs()) {
                return t;
            }
        } else {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return t;
            }
            t = middle;
        }
    }
    t
}

/// Roots of the polynomial of degree N − 1 in [`low`, `high`], between the turning points `turns` (increasing, inside).
fn between<const N: usize>(coefficients: &[f64; N], turns: &[f64], low: f64, high: f64) -> Roots {
    let mut roots = Roots::default();
    let mut left = low;
    let mut at_left = value_and_slope(coefficients, left).0;
    for &right in turns.iter().chain(std::iter::once(&high)) {
        let at_right = value_and_slope(coefficients, right).0;
        if (at_left < 0.0) != (at_right < 0.0) {
            roots.push(refine(coefficients, left, right, at_left, at_right));
        }
        (left, at_left) = (right, at_right);
    }
    roots
}

/// Simple roots of Σ c\[k\]·t^k, degree at most 4, in [`low`, `high`].
pub(super) fn quartic(c: &[f64; 5], low: f64, high: f64) -> Roots {
    let cubic = [c[1], 2.0 * c[2], 3.0 * c[3], 4.0 * c[4]];
    let quadratic = [cubic[1], 2.0 * cubic[2], 3.0 * cubic[3]];
    let inflections = self::quadratic(&quadratic, low, high);
    let turns = between(&cubic, inflections.as_slice(), low, high);
    between(c, turns.as_slice(), low, high)
}

/// Roots of c0 + c1·t + c2·t² in (`low`, `high`), by the form that does not cancel.
fn quadratic(c: &[f64; 3], low: f64, high: f64) -> Roots {
    let mut roots = Roots::default();
    let discriminant = c[1] * c[1] - 4.0 * c[2] * c[0];
    if discriminant > 0.0 {
        let q = -0.5 * (c[1] + discriminant.sqrt().copysign(c[1]));
        let (a, b) = (q / c[2], c[0] / q);
        let inside = |t: f64| t > low && t < high;
        for t in [a.min(b), a.max(b)] {
            if inside(t) {
                roots.push(t);
            }
        }
    }
    roots
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn expand(roots: [f64; 4]) -> [f64; 5] {
        let mut c = [1.0, 0.0, 0.0, 0.0, 0.0];
        for (degree, root) in roots.into_iter().enumerate() {
            for k in (0..=degree).rev() {
                c[k + 1] += c[k];
                c[k] *= -root;
            }
        }
        c
    }

    #[test]
    fn lower_degrees_are_no_special_case() {
        assert_eq!(quartic(&[-6.0, 2.0, 0.0, 0.0, 0.0], -10.0, 10.0).as_slice(), [3.0]);
        assert_eq!(quartic(&[-4.0, 0.0, 1.0, 0.0, 0.0], -10.0, 10.0).as_slice(), [-2.0, 2.0]);
        assert!(quartic(&[1.0, 0.0, 1.0, 0.0, 0.0], -10.0, 10.0).as_slice().is_empty());
        assert!(quartic(&[0.0; 5], -10.0, 10.0).as_slice().is_empty());
    }

    proptest! {
        /// Four roots at least 0.05 apart are found to 1e-9: the coefficients' rounding, 1e-16 of up to 10⁴, over a
        /// slope of at least 0.05³.
        #[test]
        fn planted_roots_are_found(gaps in prop::array::uniform4(0.05_f64..3.0), start in -5.0_f64..0.0) {
            let mut at = start;
            let planted = gaps.map(|gap| { at += gap; at });
            let roots = quartic(&expand(planted), -20.0, 20.0);
            prop_assert_eq!(roots.as_slice().len(), 4);
            for (found, planted) in roots.as_slice().iter().zip(planted) {
                prop_assert!((found - planted).abs() < 1e-7, "{} {}", found, planted);
            }
        }
    }
}
