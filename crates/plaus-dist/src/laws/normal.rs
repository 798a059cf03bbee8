//! Draws from the standard normal law, the same bits on every platform.
//!
//! Ziggurat of 256 layers of equal area (Marsaglia & Tsang, "The ziggurat method for generating random variables", J.
//! Stat. Software 5(8), 2000), with the layer and the position taken from disjoint bits of one 64-bit number (Doornik,
//! "An improved ziggurat method to generate normal random samples", 2005: sharing them correlates). About 98.8% of
//! draws cost one generator call, a table look-up and a multiplication; wedges and tail go through [`math`]. The tables
//! are computed once, by `libm`, at first use.
//!
//! `rand_distr`'s sampler is not used because its values change with any crate that switches `num-traits` to the
//! platform's maths; in the tests it is the oracle.

use crate::math;
use crate::stream::{Stream, open_unit};
use rand::Rng;
use std::sync::LazyLock;

const LAYERS: usize = 256;
/// Where the tail begins: the root of Marsaglia and Tsang's closing condition for 256 layers.
const TAIL: f64 = 3.654_152_885_361_009;

/// Layer `i` spans |x| < `edge[i]`, heights `height[i]` to `height[i + 1]`; layer 0 is the base strip together with the
/// tail.
struct Ziggurat {
    edge: [f64; LAYERS + 1],
    height: [f64; LAYERS + 1],
}

/// Unnormalised density, 1 at its peak.
fn bell(x: f64) -> f64 {
    math::exp(-0.5 * x * x)
}

/// Area of the base strip with its tail; every other layer has the same area.
fn layer_area() -> f64 {
    let tail = math::erfc(TAIL * std::f64::consts::FRAC_1_SQRT_2) * (std::f64::consts::PI / 2.0).sqrt();
    TAIL * bell(TAIL) + tail
}

static ZIGGURAT: LazyLock<Ziggurat> = LazyLock::new(|| {
    let area = layer_area();
    let mut edge = [0.0; LAYERS + 1];
    // The base strip, widened until a rectangle of its height has the area of strip and tail.
    edge[0] = area / bell(TAIL);
    edge[1] = TAIL;
    for i in 1..LAYERS - 1 {
        edge[i + 1] = (-2.0 * math::ln(area / edge[i] + bell(edge[i]))).sqrt();
    }
    Ziggurat { edge, height: edge.map(bell) }
});

/// One draw from N(0, 1). Never exactly 0.
///
/// ```
/// use plaus_dist::{Purpose, Seed, standard_normal};
/// let mut stream = Seed(1).chain(0).at(0, Purpose::START);
/// let mean = (0..10_000).map(|_| standard_normal(&mut stream)).sum::<f64>() / 10_000.0;
/// assert!(mean.abs() < 0.05); // five standard errors of 0.01
/// ```
#[inline]
pub fn standard_normal(stream: &mut Stream) -> f64 {
    let ziggurat = &*ZIGGURAT;
    let bits = stream.next_u64();
    let layer = (bits & 0xff) as usize;
    let x = signed_unit(bits) * ziggurat.edge[layer];
    if x.abs() < ziggurat.edge[layer + 1] { x } else { edge_case(ziggurat, layer, x, stream) }
}

/// Uniform on (−1, 1) from the upper 53 bits: symmetric about 0, and never 0.
#[inline]
fn signed_unit(bits: u64) -> f64 {
    ((bits.cast_signed() >> 11) as f64 + 0.5) * (1.0 / 4_503_599_627_370_496.0)
}

/// The 1.5% that leave the inner rectangle: accepted under the curve, otherwise drawn again from the start.
#[cold]
fn edge_case(ziggurat: &Ziggurat, layer: usize, x: f64, stream: &mut Stream) -> f64 {
    let (mut layer, mut x) = (layer, x);
    loop {
        if x.abs() < ziggurat.edge[layer + 1] {
            return x;
        }
        if layer == 0 {
            return tail(stream).copysign(x);
        }
        let (low, high) = (ziggurat.height[layer], ziggurat.height[layer + 1]);
        if low + (high - low) * open_unit(stream) < bell(x) {
            return x;
        }
        let bits = stream.next_u64();
        layer = (bits & 0xff) as usize;
        x = signed_unit(bits) * ziggurat.edge[layer];
    }
}

/// |x| given |x| > [`TAIL`] (Marsaglia 1964: exponential proposal, accepted with probability exp(−excess²/2)).
fn tail(stream: &mut Stream) -> f64 {
    loop {
        let excess = -math::ln(open_unit(stream)) / TAIL;
        if -2.0 * math::ln(open_unit(stream)) > excess * excess {
            return TAIL + excess;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{KS_LIMIT, Z_LIMIT, ks, stream, z_score};
    use statrs::distribution::{ContinuousCDF, Normal};

    /// The recurrence from the tail inwards ends at the peak: the last layer, of the same area, reaches height 1. 254
    /// steps lose four digits.
    #[test]
    fn the_layers_close_at_the_peak() {
        let last = ZIGGURAT.edge[LAYERS - 1];
        let reached = layer_area() / last + bell(last);
        assert!((reached - 1.0).abs() < 1e-12, "{reached}");
        assert!(ZIGGURAT.edge.windows(2).all(|pair| pair[0] > pair[1]));
    }

    /// Standard errors by which the mean of x² misses 1 over 3·10⁶ draws; the variance of x² is 2.
    fn misfit(mut draw: impl FnMut() -> f64) -> f64 {
        z_score((0..3_000_000).map(|_| math::square(draw())), 1.0, 2_f64.sqrt())
    }

    #[test]
    fn draws_follow_the_normal_law_and_not_without_the_wedges() {
        let mut stream = stream(11);
        assert!(misfit(|| standard_normal(&mut stream)).abs() < Z_LIMIT);
        // The wrong twin: each layer's whole rectangle, as if every point of a wedge were under the curve. By summing
        // the layers its E[x²] is 1.0066, eight standard errors.
        let whole_layers = || {
            let bits = stream.next_u64();
            let layer = (bits & 0xff) as usize;
            let x = signed_unit(bits) * ZIGGURAT.edge[layer];
            if layer == 0 && x.abs() >= TAIL { tail(&mut stream).copysign(x) } else { x }
        };
        assert!(misfit(whole_layers) > Z_LIMIT);

        let x: Vec<f64> = (0..1_000_000).map(|_| standard_normal(&mut stream)).collect();
        let law = Normal::standard();
        assert!(ks(x.iter().copied(), |x| law.cdf(x)) < KS_LIMIT);
        // The variance of x⁴ is 105 − 9.
        assert!(z_score(x.iter().map(|x| math::powi(*x, 4)), 3.0, 96_f64.sqrt()).abs() < Z_LIMIT);
        assert!(z_score(x.windows(2).map(|pair| pair[0] * pair[1]), 0.0, 1.0).abs() < Z_LIMIT);
    }

    #[test]
    fn the_tail_follows_the_normal_law() {
        let mut stream = stream(12);
        let n = 4_000_000;
        let beyond: Vec<f64> = (0..n).map(|_| standard_normal(&mut stream)).filter(|x| x.abs() > TAIL).collect();
        let upper = |x: f64| math::erfc(x * std::f64::consts::FRAC_1_SQRT_2);
        let expected = f64::from(n) * upper(TAIL);
        // A Poisson count of about 1030.
        assert!((beyond.len() as f64 - expected).abs() < Z_LIMIT * expected.sqrt(), "{}", beyond.len());
        assert!(z_score(beyond.iter().map(|x| x.signum()), 0.0, 1.0).abs() < Z_LIMIT);
        let many: Vec<f64> = (0..100_000).map(|_| tail(&mut stream)).collect();
        assert!(ks(many.iter().copied(), |x| 1.0 - upper(x) / upper(TAIL)) < KS_LIMIT);
        // The wrong twin: the exponential proposal, never rejected.
        let proposed = (0..100_000).map(|_| TAIL - math::ln(open_unit(&mut stream)) / TAIL);
        assert!(ks(proposed, |x| 1.0 - upper(x) / upper(TAIL)) > KS_LIMIT);
    }

    #[test]
    fn values_are_pinned() {
        let mut stream = stream(1);
        let bits: Vec<u64> = (0..4).map(|_| standard_normal(&mut stream).to_bits()).collect();
        assert_eq!(
            bits,
            [
                4_608_503_601_310_125_455,
                4_598_394_643_146_891_493,
                4_605_814_404_881_758_774,
                13_814_384_862_670_319_178
            ]
        );
        // Through wedges and tail: the sum of bits of 10⁵ draws.
        let sum = (0..100_000).fold(0_u64, |sum, _| sum.wrapping_add(standard_normal(&mut stream).to_bits()));
        assert_eq!(sum, 3_596_075_405_992_803_118);
    }
}
