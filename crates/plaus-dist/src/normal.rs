//! Draws from the standard normal law, the same bits on every platform.
//!
//! Ziggurat of 256 layers of equal area (Marsaglia & Tsang, "The ziggurat method for generating random variables", J. Stat.
//! Software 5(8), 2000), with the layer and the position taken from disjoint bits of one 64-bit number (Doornik, "An improved ziggurat
//! method to generate normal random samples", 2005: sharing them correlates). About 98.8% of draws cost one generator call, a table
//! look-up and a multiplication; wedges and tail go through [`math`]. The tables are computed once, by `libm`, at first use.
//!
//! `rand_distr`'s sampler is not used because its values change with any crate that switches `num-traits` to the platform's maths; in the tests it is the oracle.

use crate::math;
use crate::stream::{Stream, open_unit};
use rand::Rng;
use std::sync::LazyLock;

const LAYERS: usize = 256;
/// Where the tail begins: the root of Marsaglia and Tsang's closing condition for 256 layers.
const TAIL: f64 = 3.654_152_885_361_009;

/// Layer `i` spans |x| < `edge[i]`, heights `height[i]` to `height[i + 1]`; layer 0 is the base strip together with the tail.
struct Ziggurat {
    edge: [f64; LAYERS + 1],
    height: [f64; LAYERS + 1],
}

/// Unnormalised density, 1 at its peak.
fn bell(x: f64) -> f64 {
    math::exp(-0.5 * x * x)
}

/// Area of the base strip with its tail, which every other layer equals.
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

/// Uniform on (−1, 1) from the upper 53 bits: symmetric about 0, which it never is.
#[inline]
fn signed_unit(bits: u64) -> f64 {
    ((bits.cast_signed() >> 11) as f64 + 0.5) * (1.0 / 4_503_599_627_370_496.0)
}

/// The 1.2% that leave the inner rectangle: accepted under the curve, else drawn again from the start.
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
