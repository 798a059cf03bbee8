//! The moves of the dice, one a file. The first three are the paper's (its section 5.4).
//!
//! Ratios are taken with respect to the law of the tables, as the prior's density is: a change of a control point that
//! leaves its law as it is has ratio 1.

mod component;
mod everything;
mod near;
mod pick;
mod point;
mod recast;
mod rethrow;
mod scale;
mod shift;
mod turn;

pub use component::Component;
pub use everything::Everything;
pub use near::Near;
pub use pick::Pick;
pub use point::Point;
pub use recast::Recast;
pub use rethrow::Rethrow;
pub use scale::Scale;
pub use shift::Shift;
pub use turn::Turn;

use super::config::Moves;
use super::draw::{Field, LARGEST_SCORE, Site};
use super::{Dice, Draw};
use crate::rules::Rules;
use plaus_dist::{Stream, math};
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
    let pick = Pick { sd: steps.recast_sd_mm * 1e-3, near: steps.pick_sd_mm * 1e-3 };
    vec![
        (weights.everything, Box::new(Everything { symmetric: rules.symmetric_redraws() })),
        (weights.component, Box::new(Component::new(Scale::new(steps.component_least, steps.component_most)))),
        (if_fields(weights.point), Box::new(Point::new(scale))),
        (if_fields(weights.near), Box::new(Near::new(scale))),
        (weights.rethrow, Box::new(Rethrow)),
        (if_places(weights.recast), Box::new(Recast { sd: steps.recast_sd_mm * 1e-3 })),
        (if_places(if config.together { weights.pick } else { 0.0 }), Box::new(pick)),
        (weights.turn, Box::new(Turn)),
        (if_places(weights.shift), Box::new(Shift { sd: steps.shift_sd_mm * 1e-3 })),
    ]
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

/// Changes a control point of a table: the way it was changed, and whether it stays where its law has a density.
fn change(draw: &mut Draw, table: usize, site: Site, scale: Scale, stream: &mut Stream) -> (Path, bool) {
    let (score, is_wide) = scale.step(draw.tables[table].score(site), stream);
    draw.tables[table].set(site, score);
    (marked(path(table, site), is_wide), score.abs() <= LARGEST_SCORE)
}

/// The scales of a move of control points: one a field.
fn declared(scales: &[Scale; 3]) -> Vec<plaus_mcmc::Scale> {
    let names = ["height", "restitution", "friction"];
    names.iter().zip(scales).map(|(name, scale)| scale.declared(name, plaus_mcmc::Scale::ONE)).collect()
}

/// The same at other values.
fn about(scales: [Scale; 3], values: &[Option<f64>]) -> [Scale; 3] {
    std::array::from_fn(|k| scales[k].about(values.get(k).copied().flatten()))
}

/// Set in the path of a step whose size did not come from the adapted scale.
const WIDE: u64 = 1 << 63;

/// A path that says where the step's size came from. No ratio depends on that.
fn marked(path: Path, is_wide: bool) -> Path {
    Path(path.0 | if is_wide { WIDE } else { 0 })
}

/// Whether a step's size came from the adapted scale.
fn is_adapted(path: Path) -> bool {
    path.0 & WIDE == 0
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
    ((path.0 & !WIDE) as usize >> 50, Site { field, i: index(path.0 >> 24), j: index(path.0) })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against Simpson's rule with 2,000 steps h, far out too: where the integrand falls as exp(−az) its relative error
    /// is (ah)⁴/180, 1.4e-8 at a = 50.
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
                for is_wide in [false, true] {
                    let path = marked(path(table, there), is_wide);
                    assert_eq!((site(path), is_adapted(path)), ((table, there), !is_wide));
                }
            }
        }
    }
}
