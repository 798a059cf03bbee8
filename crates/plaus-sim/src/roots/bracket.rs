//! Newton's method that never leaves its bracket.

/// Maximum number of iterations of [`refine`]; bisection alone would need about 60 from any bracket whose ends differ
/// by less than a factor of 256.
const MOST_ITERATIONS: usize = 128;

/// The root of a function that changes its sign once between `low` and `high`.
///
/// `eval` returns value and derivative. Newton steps that leave the bracket, or that shrink it too slowly, become
/// bisections. It stops where two neighbouring iterates agree to the last bit or two, which is relative to the root,
/// not absolute.
#[inline]
pub fn refine(eval: impl Fn(f64) -> (f64, f64), mut low: f64, mut high: f64, low_is_positive: bool) -> f64 {
    let mut t = 0.5 * (low + high);
    let mut last_width = high - low;
    for _ in 0..MOST_ITERATIONS {
        let (value, slope) = eval(t);
        if value == 0.0 {
            return t;
        }
        if (value > 0.0) == low_is_positive {
            low = t;
        } else {
            high = t;
        }
        let newton = t - value / slope;
        let step_is_fine = newton > low && newton < high && (newton - t).abs() <= 0.5 * last_width;
        last_width = (newton - t).abs();
        let next = if step_is_fine {
            newton
        } else {
            last_width = high - low;
            0.5 * (low + high)
        };
        if (next - t).abs() <= f64::EPSILON * next.abs() || next <= low || next >= high {
            return next;
        }
        t = next;
    }
    t
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_a_root_to_the_last_bit() {
        let root = refine(|t| (t * t - 2.0, 2.0 * t), 0.0, 2.0, false);
        assert!((root - std::f64::consts::SQRT_2).abs() <= 2.0 * f64::EPSILON);
    }

    #[test]
    fn survives_a_flat_start() {
        // Newton from the middle of [0, 8] would leave the bracket at once.
        let root = refine(|t| ((t - 1.0) * (t - 1.0) * (t - 1.0), 3.0 * (t - 1.0) * (t - 1.0)), 0.0, 8.0, false);
        assert!((root - 1.0).abs() < 1e-5);
    }
}
