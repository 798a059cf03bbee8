//! Reference values by importance sampling: prior draws weighted by the constraint.
//!
//! No chain, no move, and not even the scene's simulator takes part: the bounces are written out again here.

use crate::stats::Estimate;
use crate::{Result, Work};
use plaus_dist::{Purpose, Seed, Stream, math, standard_normal};
use plaus_scenes::ball2d::Downward;
use rayon::prelude::*;
use std::f64::consts::FRAC_1_SQRT_2;

pub(super) const SEED: u64 = 3;
const BLOCK: u64 = 50_000;

/// Widths of the constraint, in D: the paper's, and others up to a factor of five on either side.
pub(super) const SIGMAS: [f64; 5] = [0.02, 0.05, 0.1, 0.2, 0.5];
/// The index of the paper's width.
pub(super) const PAPER_SIGMA: usize = 2;
/// Fall heights, in D. The place of rest is proportional to them.
pub(super) const HEIGHTS: [f64; 2] = [4.5, 4.0];
/// Rules for downward normals, with their names in a scenario.
pub(super) const RULES: [(Downward, &str); 5] = [
    (Downward::Back, "back"),
    (Downward::Level, "level"),
    (Downward::Zero, "zero"),
    (Downward::Mirror, "mirror"),
    (Downward::Reject, "reject"),
];

/// Sums of weights for one rule, height and width.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    all: f64,
    near: f64,
    all_squared: f64,
    near_squared: f64,
}

type Table = [[[Sums; SIGMAS.len()]; HEIGHTS.len()]; RULES.len()];

/// What prior draws show.
pub(super) struct Reference {
    pub(super) draws: u64,
    table: Table,
    downward: u64,
}

impl Reference {
    /// The share within 0.1 D of the target.
    pub(super) fn share(&self, rule: usize, height: usize, sigma: usize) -> Estimate {
        let sums = self.table[rule][height][sigma];
        let value = sums.near / sums.all;
        // The variance of a ratio of means, to first order.
        let squares = sums.near_squared * math::square(1.0 - value)
            + (sums.all_squared - sums.near_squared) * math::square(value);
        Estimate { value, error: squares.sqrt() / sums.all }
    }

    /// The share of prior draws that a rule for downward normals decides.
    pub(super) fn downward(&self) -> Estimate {
        Estimate::of(self.downward as usize, self.draws as usize)
    }
}

pub(super) fn sample(work: &Work) -> Result<Reference> {
    let blocks = work.size(1000, 4);
    let draws = blocks * BLOCK;
    work.say(format_args!("reference values: {draws} prior draws, seed {SEED}"));
    let parts: Vec<_> = (0..blocks).into_par_iter().map(block).collect();
    let mut reference = Reference { draws, table: Table::default(), downward: 0 };
    for (table, downward) in parts {
        reference.downward += downward;
        for (sum, part) in
            reference.table.as_flattened_mut().as_flattened_mut().iter_mut().zip(table.as_flattened().as_flattened())
        {
            sum.all += part.all;
            sum.near += part.near;
            sum.all_squared += part.all_squared;
            sum.near_squared += part.near_squared;
        }
    }
    Ok(reference)
}

fn block(index: u64) -> (Table, u64) {
    let mut stream = Seed(SEED).chain(index).at(0, Purpose::START);
    let (mut table, mut downward) = (Table::default(), 0);
    for _ in 0..BLOCK {
        let normals = draw(&mut stream);
        let (x, decided) = rest(&normals, HEIGHTS[0], Downward::Back);
        downward += u64::from(decided);
        for (rule, (kind, _)) in RULES.iter().enumerate() {
            let x = if decided { rest(&normals, HEIGHTS[0], *kind).0 } else { x };
            for (height, of_height) in HEIGHTS.iter().zip(&mut table[rule]) {
                add(of_height, x * (height / HEIGHTS[0]));
            }
        }
    }
    (table, downward)
}

/// Weights one draw that rests at `x`; NaN is a rejected one.
fn add(sums: &mut [Sums; SIGMAS.len()], x: f64) {
    let off = (x - 1.0).abs();
    for (sum, sigma) in sums.iter_mut().zip(SIGMAS) {
        let z = off / sigma;
        // Farther out the weight is below 1e-300 of the largest.
        if z < 37.0 {
            let weight = math::exp(-0.5 * z * z);
            let near = if off < 0.1 { weight } else { 0.0 };
            sum.all += weight;
            sum.near += near;
            sum.all_squared += weight * weight;
            sum.near_squared += near * near;
        }
    }
}

/// Sines and cosines of five angles from N(0, 10°).
fn draw(stream: &mut Stream) -> [(f64, f64); 5] {
    std::array::from_fn(|_| math::sin_cos(standard_normal(stream) * 10.0_f64.to_radians()))
}

/// The sixth collision's place, in D and with gravity 1 (paper, section 5.1), and whether a rule had to decide. NaN:
/// rejected.
fn rest(normals: &[(f64, f64)], height: f64, rule: Downward) -> (f64, bool) {
    let (mut x, mut vx, mut vy) = (0.0, 0.0, -(2.0 * height).sqrt());
    let mut decided = false;
    for &(sin, cos) in normals {
        let into = vx * sin + vy * cos;
        let (mut after_x, mut after_y) =
            (vx - (1.0 + FRAC_1_SQRT_2) * into * sin, vy - (1.0 + FRAC_1_SQRT_2) * into * cos);
        if after_y <= 0.0 {
            decided = true;
            (after_x, after_y) = match rule {
                Downward::Mirror => (after_x, -after_y),
                Downward::Zero => (after_x, 0.0),
                Downward::Level => (vx, -FRAC_1_SQRT_2 * vy),
                Downward::Back => (-FRAC_1_SQRT_2 * vx, -FRAC_1_SQRT_2 * vy),
                Downward::Reject => return (f64::NAN, true),
            };
        }
        x += 2.0 * after_x * after_y;
        (vx, vy) = (after_x, -after_y);
    }
    (x, decided)
}
