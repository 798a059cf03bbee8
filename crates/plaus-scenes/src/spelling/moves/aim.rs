//! Positions over bins that still lack a ball.

use crate::spelling::{Rest, Spelling};
use plaus_dist::stream::below;
use plaus_dist::{Stream, math};
use plaus_mcmc::library::happens;

/// The law of an aimed drop: with probability `aimed` over a designated bin that no ball other than `apart` fills, with
/// equal probability for each such bin and a uniform position over it; otherwise anywhere in the drop rectangle. Also
/// anywhere if no such bin lies under the rectangle.
pub(super) struct Aim<'a> {
    target: &'a Spelling,
    aimed: f64,
    empty: Vec<[[f64; 2]; 2]>,
}

impl<'a> Aim<'a> {
    /// The law given where balls came to rest.
    pub(super) fn new(target: &'a Spelling, aimed: f64, rest: &Rest, apart: usize) -> Self {
        let is_filled = |bin: u16| rest.bins.iter().enumerate().any(|(ball, at)| ball != apart && *at == Some(bin));
        let wanted = target.word().designated().iter().filter(|&&bin| !is_filled(bin));
        Self { target, aimed, empty: wanted.filter_map(|&bin| target.over(bin)).collect() }
    }

    pub(super) fn sample(&self, stream: &mut Stream) -> [f64; 2] {
        if self.empty.is_empty() || !happens(self.aimed, stream) {
            return self.target.rectangle().sample(stream);
        }
        let ends = self.empty[below(stream, self.empty.len())];
        ends.map(|[low, high]| {
            let x = low + (high - low) * plaus_dist::open_unit(stream);
            // Rounding may reach the upper end, which is not over the bin.
            if x < high { x } else { low }
        })
    }

    /// Log density of a position, per mm².
    pub(super) fn log_density(&self, position: [f64; 2]) -> f64 {
        let anywhere = 1.0 / self.target.rectangle().area();
        if self.empty.is_empty() {
            return math::ln(anywhere);
        }
        let is_over = |ends: &&[[f64; 2]; 2]| (0..2).all(|k| ends[k][0] <= position[k] && position[k] < ends[k][1]);
        // Bins do not overlap.
        let over = self.empty.iter().find(is_over).map_or(0.0, |ends| 1.0 / area(ends));
        math::ln(self.aimed * over / self.empty.len() as f64 + (1.0 - self.aimed) * anywhere)
    }

    /// An upper bound of the log density of any such law.
    pub(super) fn highest(target: &Spelling, aimed: f64) -> f64 {
        let areas = target.word().designated().iter().filter_map(|&bin| target.over(bin)).map(|ends| area(&ends));
        let anywhere = 1.0 / target.rectangle().area();
        let aimed = areas.map(|area| aimed / area + (1.0 - aimed) * anywhere).fold(anywhere, f64::max);
        // A bound must not be too low by a rounding error.
        math::ln(aimed) + 1e-9
    }
}

fn area([x, y]: &[[f64; 2]; 2]) -> f64 {
    (x[1] - x[0]) * (y[1] - y[0])
}
