//! Steps of random walks that moves of several scenes make.

use plaus_dist::{Stream, math, standard_normal};

/// How far the sizes of an adapted step reach to either side of its scale, in their logarithm: a factor e.
pub(crate) const NARROW: f64 = 1.0;

/// Share of an adapted step's sizes that still come from the whole range: where a target has several hills, or one that
/// narrows, another size serves elsewhere.
pub(crate) const WIDE_SHARE: f64 = 0.2;

/// A shift in a uniformly random direction by a length N(0, `sd`). As likely as its opposite.
pub(crate) fn shift<const D: usize>(sd: f64, stream: &mut Stream) -> [f64; D] {
    // Independent normal components have a uniform direction; they are never all 0.
    let direction: [f64; D] = std::array::from_fn(|_| standard_normal(stream));
    let norm = direction.iter().map(|x| math::square(*x)).sum::<f64>().sqrt();
    let length = sd * standard_normal(stream);
    direction.map(|x| x / norm * length)
}
