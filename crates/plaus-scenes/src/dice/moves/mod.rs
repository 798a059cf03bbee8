//! The moves of the dice, one in each file. The first three are the paper's (its section 5.4).
//!
//! Ratios are taken with respect to the law of the tables, like the prior's density: a change of a control point that
//! preserves its law has ratio 1.

mod pick;
mod point;
mod recast;
mod shift;

pub use pick::Pick;
pub use point::Point;
pub use recast::Recast;
pub use shift::Shift;

use super::draw::{EACH, NUMBERS, ORIENTATION};
use super::draw::{LARGEST_SCORE, Site};
use super::{Dice, Draw};
use crate::model::{Menu, Printed, Row};
use crate::rules::Rules;
use crate::uneven::{about, declared, path, site};
use plaus_dist::stream::below;
use plaus_dist::{Stream, math};
use plaus_mcmc::library::{RedrawAll, RedrawGroup, Sizes, Step, Symmetry, Way, marked};
use plaus_mcmc::{Move, Path, StateRefOf};

/// The moves of the dice.
#[derive(Debug, Clone, PartialEq)]
pub enum DiceMoves {}

impl Menu for DiceMoves {
    type Scene = Dice;
    const SCENE: &'static str = "dice";
    const ROWS: &'static [Row] = &[
        Row::paper("everything", 0.01, Printed::Free, "The paper's: draw everything anew."),
        Row::paper(
            "component",
            0.2,
            Printed::Free,
            "The paper's: change one number of one die's initial conditions, or its orientation.",
        ),
        Row::paper("point", 0.04, Printed::Free, "The paper's: change one control point anywhere on the table."),
        Row::own("near", 0.2, "Change a control point near one of the collisions of the current animation."),
        Row::own("rethrow", 0.05, "Draw one die's throw anew, and its table too if it has its own."),
        Row::own(
            "recast",
            1.0,
            "Give a die a new throw, and a new table if it has its own, and move both to where a trial shows that it \
         comes to rest near its target with the right face up.",
        ),
        Row::own(
            "pick",
            0.1,
            "Like recast, but try throws until one is likely under the prior and comes to rest near its target; for dice \
         thrown onto one table.",
        ),
        Row::own(
            "turn",
            0.15,
            "Begin a die's throw in another of the orientations that its symmetry makes equivalent: another face comes \
         up, and nothing else changes.",
        ),
        Row::own(
            "shift",
            0.15,
            "Shift a die's throw, and its table too if it has its own, so that the die comes to rest near its \
         target.",
        ),
    ];
}

/// All moves. A table without randomness has no points to change, and a die without a target cannot be aimed.
pub(super) fn all(scene: &Dice, rules: &Rules) -> Vec<Box<dyn Move<Dice>>> {
    let (steps, symmetric, recipe) = (&scene.config.steps, rules.symmetric_redraws(), rules.recipe());
    let sizes = Sizes::new(steps.point_least, steps.point_most);
    let recast = Recast { sd: steps.recast_sd_mm * 1e-3 };
    let mut all: Vec<Box<dyn Move<Dice>>> = vec![
        Box::new(RedrawAll { name: "everything", symmetric, recipe }),
        Box::new(component(scene, Sizes::new(steps.component_least, steps.component_most))),
    ];
    if !scene.fields().is_empty() {
        all.extend([Point::anywhere(sizes), Point::near(sizes)].map(|point| Box::new(point) as Box<dyn Move<Dice>>));
    }
    all.push(Box::new(RedrawGroup { name: "rethrow" }));
    let aims = scene.plan.places.iter().any(Option::is_some);
    if aims {
        all.push(Box::new(recast));
        if scene.config.together {
            all.push(Box::new(Pick { sd: recast.sd, near: steps.pick_sd_mm * 1e-3 }));
        }
    }
    all.push(Box::new(Symmetry { name: "turn", map: turn }));
    if aims {
        all.push(Box::new(Shift { sd: steps.shift_sd_mm * 1e-3 }));
    }
    all
}

/// Changes one number of one die's initial conditions by a step that preserves its law; or, a quarter of the time,
/// turns its orientation about a random axis. There are sizes for steps of places, of velocities, of spins and of
/// turns.
#[must_use]
pub fn component(scene: &Dice, sizes: Sizes) -> Step {
    const NAMES: [&str; 4] = ["place", "velocity", "spin", "turn"];
    let of_die = |die: usize| {
        let numbers = (0..NUMBERS).map(move |number| Way { var: die * EACH + number, size: number / 3 });
        numbers.chain([Way { var: die * EACH + ORIENTATION, size: 3 }; 3])
    };
    let ways = (0..scene.config.dice as usize).flat_map(of_die).collect();
    Step { name: "component", ways, each: NUMBERS + 3, sizes: NAMES.map(|name| (name, sizes)).to_vec() }
}

/// Turns one die's pips by another of the rotations that map its body to itself, all equally likely. The throw begins
/// in another orientation, the body moves as before bit by bit, and another face comes up. A cube has 24 such
/// rotations, a cuboid with two equal edges 8, any other 4: a face of a cuboid can only be replaced by one of its size.
pub fn turn(target: &Dice, _: StateRefOf<'_, Dice>, candidate: &mut Draw, stream: &mut Stream) -> bool {
    let die = below(stream, candidate.throws.len());
    let (turns, turn) = (target.plan.rotations.len(), &mut candidate.throws[die].turn);
    // Any but the current one.
    let other = 1 + below(stream, turns - 1);
    *turn = ((usize::from(*turn) + other) % turns) as u8;
    true
}

/// `ln (Φ(b) − Φ(a))` for `a < b`, even if the difference itself is too small for a float.
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

/// Changes a control point of a table. Gives the way in which it was changed, and whether its law has a density there.
fn change(draw: &mut Draw, table: usize, site: Site, sizes: Sizes, stream: &mut Stream) -> (Path, bool) {
    let (score, is_wide) = sizes.step(draw.tables[table].score(site), stream);
    draw.tables[table].set(site, score);
    (marked(path(table, site), is_wide), score.abs() <= LARGEST_SCORE)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compared with Simpson's rule with 2,000 steps h, also far out: if the integrand falls as exp(−az), the rule's
    /// relative error is (ah)⁴/180, 1.4e-8 at a = 50.
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
}
