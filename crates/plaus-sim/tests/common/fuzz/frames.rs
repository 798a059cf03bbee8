//! Worlds that are the same: moved, turned about the vertical, listed in another order, or said in another way.
//!
//! Two runs that differ by rounding at the start differ more later. How much more, this world tells itself: its start
//! is changed by a known small length, and what becomes of that is the measure.

use super::Verdict;
use super::form::{Form, Kind};
use super::meet::meeting;
use super::run::poses;
use super::world::{Fixed, G, Mover, Saying, World};
use crate::laws::worlds::Dice;
use glam::{DQuat, DVec3};
use plaus_sim::{Accuracy, Law, Preset};
use std::f64::consts::FRAC_PI_2;

type Poses = Vec<(DVec3, DQuat)>;

const EVENTS: u64 = 5_000;

/// Largest distance of two poses, turns taken as that of a point at the body's reach.
fn apart(a: &Poses, b: &Poses, reach: &[f64]) -> f64 {
    let one = |k: usize| {
        let turned = (a[k].1.inverse() * b[k].1).normalize();
        let angle = 2.0 * turned.xyz().length().min(1.0);
        (a[k].0 - b[k].0).length().max(angle * reach[k])
    };
    // `max` would leave out what is not a number.
    (0..a.len()).map(one).fold(0.0, |most, x| if x.is_nan() || most < x { x } else { most })
}

fn reach(world: &World) -> Vec<f64> {
    world.movers.iter().map(|m| m.form.shape().0.reach()).collect()
}

/// The largest change that a change of the start by `by` metres makes: of each body's place and turn.
fn sensitivity(world: &World, at_end: &Poses, by: f64, dice: &mut Dice) -> Option<f64> {
    let mut most = 0.0_f64;
    for k in 0..world.movers.len() {
        for sign in [-1.0, 1.0] {
            let mut near = world.clone();
            let mover = &mut near.movers[k];
            mover.at += dice.in_cube().normalize() * (sign * by);
            let turn = dice.in_cube().normalize() * (sign * by / mover.form.shape().0.reach());
            mover.turn = (DQuat::from_scaled_axis(turn) * mover.turn).normalize();
            most = most.max(apart(at_end, &poses(&near, EVENTS)?, &reach(world)));
        }
    }
    Some(most)
}

/// A world of some bodies that meet, for a short time, and the same moved.
pub fn moved(seed: u64, preset: Preset) -> (World, Moved) {
    let mut dice = Dice::new(127, seed);
    let mut world = meeting(seed, preset);
    world.fixed.retain(|f| !matches!(f, Fixed::Table { .. }));
    world.until = 0.3 * dice.between(0.2, 1.0);
    let has_block = world.fixed.iter().any(|f| matches!(f, Fixed::Block { .. }));
    let how = match dice.of(&[0, 1, 2]) {
        0 => Moved::Shifted(DVec3::new(0.3, -0.2, 0.15) * dice.between(0.2, 1.0)),
        1 if has_block => Moved::Turned(FRAC_PI_2),
        1 => Moved::Turned(dice.between(0.1, 6.2)),
        _ => Moved::Reordered,
    };
    (world, how)
}

/// What was done to a world.
#[derive(Debug, Clone, Copy)]
pub enum Moved {
    Shifted(DVec3),
    /// About the vertical, in rad.
    Turned(f64),
    Reordered,
}

impl Moved {
    fn of(self, world: &World) -> World {
        let mut other = world.clone();
        let (by, turn) = match self {
            Self::Shifted(by) => (by, DQuat::IDENTITY),
            Self::Turned(angle) => (DVec3::ZERO, DQuat::from_rotation_z(angle)),
            Self::Reordered => {
                other.movers.reverse();
                other.fixed.reverse();
                return other;
            }
        };
        for m in &mut other.movers {
            m.at = turn * m.at + by;
            m.turn = (turn * m.turn).normalize();
            (m.velocity, m.spin) = (turn * m.velocity, turn * m.spin);
        }
        for fixed in &mut other.fixed {
            match fixed {
                Fixed::Plane(level) => *level += by.z,
                Fixed::Table { level, .. } => *level += by.z,
                Fixed::Block { at, edges } => {
                    *at = turn * *at + by;
                    if turn != DQuat::IDENTITY {
                        *edges = DVec3::new(edges.y, edges.x, edges.z);
                    }
                }
                Fixed::Solid { at, turn: own, .. } | Fixed::Mesh { at, turn: own, .. } => {
                    *at = turn * *at + by;
                    *own = (turn * *own).normalize();
                }
            }
        }
        other
    }

    /// Poses of the moved world, brought back.
    fn back(self, poses: Poses) -> Poses {
        match self {
            Self::Shifted(by) => poses.into_iter().map(|(x, q)| (x - by, q)).collect(),
            Self::Turned(angle) => {
                let back = DQuat::from_rotation_z(-angle);
                poses.into_iter().map(|(x, q)| (back * x, (back * q).normalize())).collect()
            }
            Self::Reordered => poses.into_iter().rev().collect(),
        }
    }
}

/// A change of the start, in m, with which the world is asked how much its motion depends on it. It is far above
/// rounding, and far below any length of the world.
const ASKED: f64 = 1e-8;

/// What rounding may do in a run, in m: a third of the smallest gap of these worlds (1e-8 of 30 mm), within which
/// searches for times of impact end.
const ROUNDING: f64 = 1e-10;

/// A world that makes more of a change of its start than this has nothing to compare.
const CHAOS: f64 = 1e5;

pub fn examine(seed: u64, preset: Preset) -> Option<Verdict> {
    let (world, how) = moved(seed, preset);
    let here = poses(&world, EVENTS)?;
    let factor = sensitivity(&world, &here, ASKED, &mut Dice::new(131, seed))? / ASKED;
    if factor.is_nan() || factor >= CHAOS {
        return None;
    }
    let there = how.back(poses(&how.of(&world), EVENTS)?);
    let reach = reach(&world);
    let (off, allowed) = (apart(&here, &there, &reach), ROUNDING * factor.max(1.0));
    let found = format!("{how:.3?}: off by {off:.2e} m ({allowed:.1e} allowed) after {:.3} s", world.until);
    // Moved by what the world was asked with.
    let shifted: Poses =
        there.iter().map(|&(x, q)| (x + DVec3::X * (ASKED * factor.max(1.0) + 2.0 * off), q)).collect();
    let twin = (off <= allowed).then(|| apart(&here, &shifted, &reach) > allowed);
    Some(Verdict { worst: off / allowed, found, twin, world })
}

/// A body that falls on a fixed box, for a short time: the box said in one way, and in another.
pub fn said(seed: u64, preset: Preset) -> (World, Saying) {
    let mut dice = Dice::new(137, seed);
    let half = dice.of_any_size(1.0 / 10.0, 10.0).sqrt();
    let [s, t] = [0.03 * half, 0.03 / half];
    let form = Form::random(Kind::ALL[(seed % 13) as usize], s, &mut dice);
    let edges = DVec3::new(dice.between(0.5, 2.0), dice.between(0.5, 2.0), dice.between(0.3, 1.0)) * t;
    let reach = form.shape().0.reach();
    let high = dice.between(1.02, 1.5) * reach;
    let over = DVec3::new(edges.x * dice.between(-0.5, 0.5), edges.y * dice.between(-0.5, 0.5), high);
    let turn = dice.turn();
    let centre = form.shape().1;
    let speed = (G * reach).sqrt() * dice.between(0.0, 1.0);
    let velocity = dice.in_cube() * speed;
    let mover = Mover { at: over - turn * centre, turn, velocity, spin: dice.in_cube() * (speed / reach), form };
    let at = DVec3::Z * (-0.5 * edges.z);
    let other = Saying::ALL[1 + (seed / 13 % 7) as usize];
    let law = Law::new(dice.of(&[0.0, 0.3, 0.8]), dice.of(&[0.0, 0.5, 0.9]));
    let until = 4.0 * (reach / G).sqrt();
    let fixed = Saying::Block.parts(at, edges, DQuat::IDENTITY, 0.5);
    (World { movers: vec![mover], fixed, law, gravity: G, preset, until, wanted: Vec::new() }, other)
}

/// Error of each of the two: of a body that tips, slides or bounces for 0.2 s, over its size. The worst row of the
/// table of `docs/validation/accuracy.md`, that of a die.
fn of_table(preset: Preset) -> f64 {
    match preset {
        Preset::Draft => 4.9e-2,
        Preset::Standard => 1.2e-2,
        Preset::Fine => 2.2e-3,
        Preset::Reference => 2.1e-4,
    }
}

/// A body that touches at another place within the gap goes on from another start: as if it had been moved by a few
/// gaps. Default 4: two surfaces, two runs.
const GAPS: f64 = 4.0;

pub fn examine_sayings(seed: u64, preset: Preset) -> Option<Verdict> {
    let (world, other) = said(seed, preset);
    let Some(Fixed::Block { at, edges }) = world.fixed.first() else { return None };
    let seam = Dice::new(139, seed).between(0.2, 0.8);
    let mut another = world.clone();
    another.fixed = other.parts(*at, *edges, DQuat::IDENTITY, seam);
    let (size, reach) = (world.sizes()[0], reach(&world));
    let here = poses(&world, EVENTS)?;
    let by = Accuracy::preset(preset).gap * size;
    let change = sensitivity(&world, &here, by, &mut Dice::new(149, seed))?;
    if change.is_nan() || change >= 0.02 * size {
        return None;
    }
    let there = poses(&another, EVENTS)?;
    let off = apart(&here, &there, &reach);
    let allowed = GAPS * (change + by) + 2.0 * of_table(preset) * size;
    let found = format!(
        "{} on Block and on {other:?}: apart by {off:.2e} m ({allowed:.1e} allowed) after {:.3} s",
        world.movers[0].form.told(),
        world.until
    );
    // The box lower by the body's size; it shows where the body met the box.
    let mut empty = world.clone();
    empty.fixed.clear();
    let met = apart(&here, &poses(&empty, EVENTS)?, &reach) > 2.0 * allowed;
    let mut lowered = another.clone();
    lowered.fixed = other.parts(*at - DVec3::Z * size, *edges, DQuat::IDENTITY, seam);
    let twin = poses(&lowered, EVENTS).filter(|_| met && off <= allowed);
    let twin = twin.map(|t| apart(&here, &t, &reach) > allowed);
    another.movers.clone_from(&world.movers);
    Some(Verdict { worst: off / allowed, found, twin, world: another })
}
