//! The moves of the dice, one a file. The first three are the paper's (its section 5.4).
//!
//! Ratios are taken with respect to the law of the tables, as the prior's density is: a change of a control point that leaves its law as it is has ratio 1.

mod component;
mod everything;
mod near;
mod point;
mod recast;
mod rethrow;
mod shift;
mod turn;

pub use component::Component;
pub use everything::Everything;
pub use near::Near;
pub use point::Point;
pub use recast::Recast;
pub use rethrow::Rethrow;
pub use shift::Shift;
pub use turn::Turn;

use super::config::Moves;
use super::draw::{Field, LARGEST_SCORE, Site};
use super::{Dice, Draw};
use crate::rules::Rules;
use plaus_dist::{Stream, math, open_unit, standard_normal};
use plaus_mcmc::{Move, Path};

/// All moves with their weights.
pub(super) fn all(scene: &Dice, rules: &Rules) -> Vec<(f64, Box<dyn Move<Dice>>)> {
    let (config, steps) = (&scene.config, scene.config.steps);
    let weights = if config.moves == Moves::Paper { config.weights.paper() } else { config.weights };
    let has_fields = !scene.fields().is_empty();
    // A table without anything random has no points to change.
    let if_fields = |weight: f64| if has_fields { weight } else { 0.0 };
    let if_places = |weight: f64| if scene.plan.places.iter().any(Option::is_some) { weight } else { 0.0 };
    let scale = Scale::new(steps.point_least, steps.point_most);
    vec![
        (weights.everything, Box::new(Everything { symmetric: rules.symmetric_redraws() })),
        (weights.component, Box::new(Component { scale: Scale::new(steps.component_least, steps.component_most) })),
        (if_fields(weights.point), Box::new(Point { scale })),
        (if_fields(weights.near), Box::new(Near { scale })),
        (weights.rethrow, Box::new(Rethrow)),
        (if_places(weights.recast), Box::new(Recast { sd: steps.recast_sd_mm * 1e-3 })),
        (weights.turn, Box::new(Turn)),
        (if_places(weights.shift), Box::new(Shift { sd: steps.shift_sd_mm * 1e-3 })),
    ]
}

/// Sizes of steps: uniform in their logarithm between two ends within (0, 1]. Steps of all sizes are tried all the time, so that none has to be tuned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    low: f64,
    high: f64,
}

impl Scale {
    /// Between two ends, in either order.
    #[must_use]
    pub fn new(a: f64, b: f64) -> Self {
        Self { low: math::ln(a.min(b)), high: math::ln(a.max(b)) }
    }

    fn sample(self, stream: &mut Stream) -> f64 {
        math::exp(self.low + (self.high - self.low) * open_unit(stream)).min(1.0)
    }

    /// A step that leaves the standard normal law as it is: as likely from z to z' as back, weighed by that law (Neal, "Regression and classification using
    /// Gaussian process priors", 1998; the autoregressive proposal).
    fn step(self, z: f64, stream: &mut Stream) -> f64 {
        let s = self.sample(stream);
        (1.0 - s * s).max(0.0).sqrt() * z + s * standard_normal(stream)
    }
}

/// `ln (Φ(b) − Φ(a))` for `a < b`, also where that is no float.
fn log_between(a: f64, b: f64) -> f64 {
    if b <= 0.0 {
        return log_between(-b, -a);
    }
    let scaled = |z: f64| math::erfc_scaled(z * std::f64::consts::FRAC_1_SQRT_2);
    if a <= 0.0 {
        let upper = |z: f64| 0.5 * math::erfc(z * std::f64::consts::FRAC_1_SQRT_2);
        return math::ln(1.0 - upper(-a) - upper(b));
    }
    math::ln(0.5 * (scaled(a) - scaled(b) * math::exp(0.5 * (a - b) * (a + b)))) - 0.5 * a * a
}

/// The dice that have a target, with its place in m.
fn aimed(target: &Dice) -> impl Iterator<Item = (usize, [f64; 2])> {
    target.plan.places.iter().enumerate().filter_map(|(die, place)| Some((die, (*place)?)))
}

/// Changes a control point of a table; whether it stays where its law has a density.
fn change(draw: &mut Draw, table: usize, site: Site, scale: Scale, stream: &mut Stream) -> bool {
    let score = scale.step(draw.tables[table].score(site), stream);
    draw.tables[table].set(site, score);
    score.abs() <= LARGEST_SCORE
}

/// A control point as a path: table, field and indices.
fn path(table: usize, site: Site) -> Path {
    let index = |k: i32| u64::from(k.cast_unsigned() & 0x00ff_ffff);
    Path((table as u64) << 50 | (site.field as u64) << 48 | index(site.i) << 24 | index(site.j))
}

/// What [`path`] made.
fn site(path: Path) -> (usize, Site) {
    let index = |bits: u64| (((bits as u32) << 8).cast_signed()) >> 8;
    let field = Field::ALL[((path.0 >> 48) & 3).min(2) as usize];
    ((path.0 >> 50) as usize, Site { field, i: index(path.0 >> 24), j: index(path.0) })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against Simpson's rule with 2,000 steps h, far out too: where the integrand falls as exp(−az) its relative error is (ah)⁴/180, 1.4e-8 at a = 50.
    #[test]
    fn shares_between_are_right() {
        for (a, width) in [(-0.8, 1.6), (-3.0, 1.0), (0.0, 0.5), (2.0, 1.6), (-40.0, 1.6), (50.0, 1.6), (300.0, 0.1)] {
            let b: f64 = a + width;
            let near = if a > 0.0 { a } else { b.min(0.0) };
            let density = |z: f64| math::exp(-0.5 * (z - near) * (z + near));
            let step = width / 2000.0;
            let weigh = |k: u32| f64::from(if k == 0 || k == 2000 { 1 } else { 2 + 2 * (k % 2) });
            let sum: f64 = (0..=2000).map(|k| weigh(k) * density(a + f64::from(k) * step)).sum();
            let expected = math::ln(sum * step / 3.0 / std::f64::consts::TAU.sqrt()) - 0.5 * near * near;
            assert!((log_between(a, b) - expected).abs() < 2e-8, "{a}: {} {expected}", log_between(a, b));
        }
    }

    #[test]
    fn paths_hold_any_site() {
        for (table, i, j) in [(0, 0, 0), (23, -1, 5), (7, -400_000, 399_999)] {
            for field in Field::ALL {
                let there = Site { field, i, j };
                assert_eq!(site(path(table, there)), (table, there));
            }
        }
    }
}
