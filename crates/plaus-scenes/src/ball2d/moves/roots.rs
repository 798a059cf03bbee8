//! Real roots of quartics on an interval about 0: all simple ones.
//!
//! In Bernstein's basis the changes of sign bound the number of roots (Descartes' rule): none if there are none, one if
//! there is one. Intervals with more are halved. Where there is one root, an iteration of third order finds it to the
//! last bits. No root is chosen by the size of its imaginary part. Roots that are nearly one may be missed. Which are
//! found follows from the coefficients alone.

/// Up to four roots, in increasing order.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Roots {
    values: [f64; 4],
    count: usize,
}

impl Roots {
    fn push(&mut self, root: f64) {
        if let Some(value) = self.values.get_mut(self.count) {
            *value = root;
            self.count += 1;
        }
    }

    pub(super) fn as_slice(&self) -> &[f64] {
        &self.values[..self.count]
    }
}

/// Halvings of the interval, at most: roots that are nearer to each other than 2⁻²⁶ of it may be missed. Only pairs of
/// roots that nearly merge need more than a few.
const HALVINGS: usize = 26;

/// Steps shorter than this, over the interval that holds one root, are the last: what is left is of the order of the
/// cube of it, over the square of the distance from other roots.
const LAST_STEP: f64 = 1e-6;

/// Steps after which bisection takes over. Default 8; from a good guess three are enough.
const STEPS: usize = 8;

/// Simple roots of Σ c\[k\]·t^k, degree at most 4, in ±`reach`.
pub(super) fn quartic(c: &[f64; 5], reach: f64) -> Roots {
    let mut roots = Roots::default();
    isolate(c, control(c, reach), [-reach, reach], HALVINGS, &mut roots);
    roots
}

/// Finds the roots in an interval over which the polynomial has these control points.
fn isolate(c: &[f64; 5], heights: [f64; 5], [low, high]: [f64; 2], halvings: usize, roots: &mut Roots) {
    match heights.windows(2).filter(|pair| (pair[0] < 0.0) != (pair[1] < 0.0)).count() {
        0 => {}
        1 => roots.push(only(c, &heights, [low, high])),
        _ if halvings > 0 => {
            let ([left, right], middle) = (halves(heights), 0.5 * (low + high));
            isolate(c, left, [low, middle], halvings - 1, roots);
            isolate(c, right, [middle, high], halvings - 1, roots);
        }
        _ => {}
    }
}

/// Σ c\[k\]·t^k over ±`reach` in Bernstein's basis: the heights of its control points, which are evenly spaced.
fn control(c: &[f64; 5], reach: f64) -> [f64; 5] {
    let square = reach * reach;
    let [p0, p1, p2, p3, p4] = [c[0], c[1] * reach, c[2] * square, c[3] * square * reach, c[4] * square * square];
    let (even, odd) = (p0 + p2 + p4, p1 + p3);
    let (inner, lean) = (p0 - p4, 0.5 * (p1 - p3));
    [even - odd, inner - lean, p0 - p2 / 3.0 + p4, inner + lean, even + odd]
}

/// The control points over the two halves of the interval (de Casteljau).
fn halves([a, b, c, d, e]: [f64; 5]) -> [[f64; 5]; 2] {
    let mean = |x: f64, y: f64| 0.5 * (x + y);
    let (ab, bc, cd, de) = (mean(a, b), mean(b, c), mean(c, d), mean(d, e));
    let (abc, bcd, cde) = (mean(ab, bc), mean(bc, cd), mean(cd, de));
    let (abcd, bcde) = (mean(abc, bcd), mean(bcd, cde));
    let middle = mean(abcd, bcde);
    [[a, ab, abc, abcd, middle], [middle, bcde, cde, de, e]]
}

/// The only root in an interval whose control points change their sign once: by Halley's iteration, from where the line
/// through the control points is 0.
fn only(c: &[f64; 5], heights: &[f64; 5], [low, high]: [f64; 2]) -> f64 {
    let k = (0..3).find(|&k| (heights[k] < 0.0) != (heights[k + 1] < 0.0)).unwrap_or(3);
    let place = k as f64 + heights[k] / (heights[k] - heights[k + 1]);
    let mut t = low + 0.25 * (high - low) * place;
    for _ in 0..STEPS {
        let value = c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * c[4])));
        let slope = c[1] + t * (2.0 * c[2] + t * (3.0 * c[3] + t * (4.0 * c[4])));
        let bend = c[2] + t * (3.0 * c[3] + t * (6.0 * c[4]));
        let step = value * slope / (slope * slope - value * bend);
        t -= step;
        if step.abs() <= LAST_STEP * (high - low) && t >= low && t <= high {
            return t;
        }
    }
    bisect(c, [low, high], heights[4] >= 0.0)
}

/// The root by bisection, for a polynomial that is not negative at the upper end if it is `rising`.
fn bisect(c: &[f64; 5], [mut low, mut high]: [f64; 2], rising: bool) -> f64 {
    loop {
        let t = 0.5 * (low + high);
        if t <= low || t >= high {
            return t;
        }
        let value = c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * c[4])));
        if (value >= 0.0) == rising {
            high = t;
        } else {
            low = t;
        }
    }
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
        assert_eq!(quartic(&[-6.0, 2.0, 0.0, 0.0, 0.0], 10.0).as_slice(), [3.0]);
        assert_eq!(quartic(&[-4.0, 0.0, 1.0, 0.0, 0.0], 10.0).as_slice(), [-2.0, 2.0]);
        assert!(quartic(&[1.0, 0.0, 1.0, 0.0, 0.0], 10.0).as_slice().is_empty());
        assert!(quartic(&[0.0; 5], 10.0).as_slice().is_empty());
    }

    /// Two roots that nearly merge are told apart, and a pair that has merged and parted again is none.
    #[test]
    fn roots_that_nearly_merge_are_found() {
        for (k, gap) in [1e-3, 1e-4, 1e-5, 1e-6].into_iter().enumerate() {
            let at = 0.3 + 0.01 * k as f64;
            let [low, high] = [at, at + gap];
            let found = quartic(&[low * high, -low - high, 1.0, 0.0, 0.0], 2.0);
            assert_eq!(found.as_slice().len(), 2, "{gap}");
            // The coefficients' rounding, 1e-16, over a slope of `gap`.
            assert!(found.as_slice().iter().zip([low, high]).all(|(a, b)| (a - b).abs() < 1e-15 / gap), "{found:?}");
            assert!(quartic(&[at * at + gap * gap, -2.0 * at, 1.0, 0.0, 0.0], 2.0).as_slice().is_empty());
        }
    }

    proptest! {
        /// Four roots at least 0.05 apart are found to 1e-9: the coefficients' rounding, 1e-16 of up to 10⁴, over a
        /// slope of at least 0.05³.
        #[test]
        fn planted_roots_are_found(gaps in prop::array::uniform4(0.05_f64..3.0), start in -5.0_f64..0.0) {
            let mut at = start;
            let planted = gaps.map(|gap| { at += gap; at });
            let roots = quartic(&expand(planted), 20.0);
            prop_assert_eq!(roots.as_slice().len(), 4);
            for (found, planted) in roots.as_slice().iter().zip(planted) {
                prop_assert!((found - planted).abs() < 1e-7, "{} {}", found, planted);
            }
        }
    }
}
