//! How far bodies must be moved so that none begins inside another, or inside scenery: as little as possible.

use super::config::Config;
use super::plan::{Plan, World};
use crate::scene::ConfigError;
use glam::DVec3;
use plaus_sim::mechanics::Other;
use plaus_sim::rigid::{Separation, Start};

/// How often separations are found anew. Each time the normals are those where bodies have come to, so a few are
/// enough where they turn little.
const ROUNDS: u32 = 32;
/// If so many do not suffice, something is lifted: by a tenth of a millimetre, in m, and twice as far each time, to
/// farther than a scenario reaches.
const LIFT: f64 = 1e-4;
const LIFTS: u32 = 24;
/// Overlap that counts as none, in m: below the shortest length that a scenario can say.
const NONE: f64 = 1e-9;
/// Distance at which bodies touch, in m, and the horizontal part of a normal from which on they touch at a side.
const TOUCHING: f64 = 1e-6;
const UPRIGHT: f64 = 1e-3;
/// Separations up to this many times the deepest overlap are heeded, so that what is moved goes into nothing else.
const HEEDED: f64 = 2.0;
/// Sweeps over the separations of a round, at most.
const SWEEPS: usize = 2000;

/// How far bodies of a world must be moved.
#[derive(Debug)]
pub(crate) struct Apart {
    /// Each of the groups, in m.
    pub(crate) by: Vec<DVec3>,
    /// What begins inside what although neither can be moved, or only both together: a body, and another or a piece of
    /// scenery by its name.
    pub(crate) stuck: Option<(usize, String)>,
    /// Bodies that then touch another, or something that stands still, at their sides: not straight above or below.
    pub(crate) sides: Vec<(usize, Option<usize>)>,
}

/// Moves the bodies of a world apart, with all that is uncertain in the middle of its law. Bodies move with their
/// groups; those without one do not.
///
/// # Errors
/// [`ConfigError`] if the world is none.
pub(crate) fn apart(config: &Config, groups: &[Option<usize>]) -> Result<Apart, ConfigError> {
    let (plan, _) = Plan::new(config)?;
    let wrong = |error| ConfigError::new("world.custom", error);
    let numbers = plan.works.numbers(None);
    let built = plan.build(&numbers).map_err(wrong)?;
    let count = groups.iter().flatten().max().map_or(0, |&most| most + 1);
    let mut moved = Apart { by: vec![DVec3::ZERO; count], stuck: None, sides: Vec::new() };
    let World::Turning(world) = &built.world else { return Ok(moved) };
    let starts = plan.starts(&numbers, &built.there, &built.shapes);
    let group = |body: usize| groups.get(built.there[body]).copied().flatten();
    let mut lifts = vec![0; count];
    for round in 1.. {
        let shifted = |(body, start): (usize, &Start)| {
            let by = group(body).map_or(DVec3::ZERO, |group| moved.by[group]);
            Start { position: start.position + by, ..*start }
        };
        let now: Vec<Start> = starts.iter().enumerate().map(shifted).collect();
        let ends = |one: &Separation| [group(one.body), body_of(one.other).and_then(group)];
        let overlaps = world.separations(&now, -NONE);
        let Some(deepest) = overlaps.iter().min_by(|a, b| a.gap.total_cmp(&b.gap)) else {
            let touching = world.separations(&now, TOUCHING);
            let at_side = touching.iter().filter(|one| one.normal.truncate().length() > UPRIGHT);
            moved.sides =
                at_side.map(|one| (built.there[one.body], body_of(one.other).map(|k| built.there[k]))).collect();
            break;
        };
        if let Some(one) = overlaps.iter().find(|one| ends(one)[0] == ends(one)[1]) {
            let other = plan.name(built.number(one.other, plan.bodies.len()));
            moved.stuck = Some((built.there[one.body], other.to_owned()));
            break;
        }
        if round % ROUNDS == 0 {
            // The shortest ways out lead from one thing into another: higher up, they are other ones.
            let Some(group) = ends(deepest).into_iter().flatten().find(|&group| lifts[group] < LIFTS) else { break };
            moved.by[group] = DVec3::Z * (LIFT * f64::from(1_u32 << lifts[group]));
            lifts[group] += 1;
            continue;
        }
        let near = world.separations(&now, -HEEDED * deepest.gap);
        let row = |one: &Separation| Row { ends: ends(one), normal: one.normal, gap: one.gap, push: 0.0 };
        let mut rows: Vec<Row> = near.iter().filter(|one| ends(one)[0] != ends(one)[1]).map(row).collect();
        for (by, step) in moved.by.iter_mut().zip(least_motion(&mut rows, count)) {
            *by += step;
        }
    }
    Ok(moved)
}

/// The other body, if it is one.
fn body_of(other: Other) -> Option<usize> {
    if let Other::Body(body) = other { Some(body) } else { None }
}

/// A separation of two groups, of which one may stand still.
#[derive(Debug)]
struct Row {
    ends: [Option<usize>; 2],
    /// Towards the first.
    normal: DVec3,
    gap: f64,
    /// How far it moves each of the two.
    push: f64,
}

impl Row {
    /// The gap after these motions.
    fn gap_after(&self, by: &[DVec3]) -> f64 {
        let [a, b] = self.ends.map(|end| end.map_or(DVec3::ZERO, |group| by[group]));
        self.gap + (a - b).dot(self.normal)
    }
}

/// Motions with the least sum of squares after which no gap is negative, as far as normals stay what they are: a
/// quadratic program, solved row by row in its dual (Hildreth 1957).
fn least_motion(rows: &mut [Row], count: usize) -> Vec<DVec3> {
    let mut by = vec![DVec3::ZERO; count];
    for _ in 0..SWEEPS {
        let mut largest: f64 = 0.0;
        for row in &mut *rows {
            let movable = row.ends.iter().flatten().count() as f64;
            let push = (row.push - row.gap_after(&by) / movable).max(0.0);
            let change = push - row.push;
            row.push = push;
            for (end, sign) in row.ends.iter().zip([1.0, -1.0]) {
                if let Some(group) = *end {
                    by[group] += row.normal * (sign * change);
                }
            }
            largest = largest.max(change.abs());
        }
        if largest <= 0.1 * NONE {
            break;
        }
    }
    by
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What stands on what is moved goes along; what is pressed from two sides goes aside; else both move by half.
    #[test]
    fn motions_are_the_least() {
        let row = |ends, normal, gap| Row { ends, normal, gap, push: 0.0 };
        let stack = &mut [row([Some(0), None], DVec3::Z, -1.0), row([Some(1), Some(0)], DVec3::Z, 0.0)];
        let by = least_motion(stack, 2);
        assert!(by.iter().all(|by| (*by - DVec3::Z).length() < 1e-9), "{by:?}");
        let by = least_motion(&mut [row([Some(0), Some(1)], DVec3::X, -1.0)], 2);
        assert!((by[0] - 0.5 * DVec3::X).length() < 1e-9 && (by[0] + by[1]).length() < 1e-9, "{by:?}");
        let corner = [0.6, -0.6].map(|x| row([Some(0), None], DVec3::new(x, 0.8, 0.0), -1.0));
        let by = least_motion(&mut Vec::from(corner), 1);
        assert!((by[0] - 1.25 * DVec3::Y).length() < 1e-8, "{by:?}");
        // What is free of all is left alone.
        assert_eq!(least_motion(&mut [row([Some(0), None], DVec3::Z, 0.5)], 1), [DVec3::ZERO]);
    }
}
