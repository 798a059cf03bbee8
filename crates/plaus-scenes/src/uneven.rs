//! Random fields over a table: whole tables as functions of keys; what the scores of control points mean; and how the
//! surface is drawn.

mod points;

pub(crate) use points::{Changed, SCATTER, about, declared, impact_of_path, path, path_of_impact, site, streams};
pub use points::{Field, LARGEST_SCORE, Site};

use crate::animation::{Form, upright};
use glam::DVec3;
use plaus_dist::stream::below as index_below;
use plaus_dist::{Stream, TruncatedGaussian, math, normal_quantile, standard_normal};
use plaus_mcmc::library::{Sizes, normal_step};
use rand::Rng;
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// A whole random table. Its scores are `cos φ · a + sin φ · b`, where `a` and `b` each follow from a key, except at
/// points that moves have changed. For any angle φ they are independent standard normal numbers. So the table has the
/// same law for every φ, and a small turn of φ changes all points a little.
///
/// A change of one point is held as a change of `a` and `b` there. So what later steps do does not depend on which
/// points have been changed. If it did (say, if changed points took no part in turns of φ), then rejections would make
/// the list of changed points depend on the scores, and these would not keep their law.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Bumps {
    keys: [u64; 2],
    changed: [Changed; 2],
    /// φ in radians, from 0 to τ.
    angle: f64,
}

impl Bumps {
    /// Draws it anew.
    pub(crate) fn renew(&mut self, stream: &mut Stream) {
        self.keys = [stream.next_u64(), stream.next_u64()];
        self.angle = TAU * plaus_dist::open_unit(stream);
        self.changed.iter_mut().for_each(Changed::clear);
    }

    /// A step that preserves its law: either φ turns, by a Gaussian angle of `size` times half a turn; or the key that
    /// counts less at this φ is drawn anew.
    pub(crate) fn step(&mut self, size: f64, stream: &mut Stream) {
        if index_below(stream, 2) == 0 {
            self.angle = (self.angle + size * PI * standard_normal(stream)).rem_euclid(TAU);
            return;
        }
        let (sin, cos) = math::sin_cos(self.angle);
        let which = usize::from(sin.abs() < cos.abs());
        self.keys[which] = stream.next_u64();
        self.changed[which].clear();
    }

    /// A step of one point that preserves its law. Of `a` and `b` there, only the part along the direction of φ
    /// changes. Gives whether its size comes from the whole range, and whether the law has a density there.
    pub(crate) fn step_point(&mut self, site: Site, sizes: Sizes, stream: &mut Stream) -> (bool, bool) {
        let (size, is_wide) = sizes.sample(stream);
        let is_possible = self.change(site, |z| normal_step(size, z, stream));
        (is_wide, is_possible)
    }

    /// Draws some points anew, in the same way: what is across the direction of φ stays.
    /// Gives the same as [`step_points`](Self::step_points).
    pub(crate) fn renew_points(&mut self, sites: [Site; 3], stream: &mut Stream) -> (bool, bool) {
        let is_possible = sites.map(|site| self.change(site, |_| standard_normal(stream)));
        (true, is_possible.iter().all(|is_possible| *is_possible))
    }

    /// The same as a step of one size for all; gives what [`step_point`](Self::step_point) does.
    pub(crate) fn step_points(&mut self, sites: [Site; 3], sizes: Sizes, stream: &mut Stream) -> (bool, bool) {
        let (size, is_wide) = sizes.sample(stream);
        let mut is_possible = true;
        for site in sites {
            is_possible &= self.change(site, |z| normal_step(size, z, stream));
        }
        (is_wide, is_possible)
    }

    /// Changes a point along the direction of φ; gives whether the law has a density there.
    fn change(&mut self, site: Site, to: impl FnOnce(f64) -> f64) -> bool {
        let ((sin, cos), [a, b]) = (math::sin_cos(self.angle), self.both()(site));
        let (across, along) = (cos * b - sin * a, to(cos * a + sin * b));
        let both = [cos * along - sin * across, sin * along + cos * across];
        self.changed.iter_mut().zip(both).for_each(|(changed, score)| changed.set(site, score));
        both.iter().all(|score| score.abs() <= LARGEST_SCORE)
    }

    /// `a` and `b` of its points.
    fn both(&self) -> impl Fn(Site) -> [f64; 2] + Send + Sync + use<> {
        let (streams, changed) = (self.keys.map(streams), self.changed.clone());
        move |site| [0, 1].map(|k| changed[k].score(&streams[k], site))
    }

    /// The score of a point.
    #[must_use]
    pub fn score(&self, site: Site) -> f64 {
        self.source()(site)
    }

    /// The scores of its points. One in 5·10⁸ would be beyond [`LARGEST_SCORE`]; it is set to that value.
    pub(crate) fn source(&self) -> impl Fn(Site) -> f64 + Send + Sync + use<> {
        let (both, (sin, cos)) = (self.both(), math::sin_cos(self.angle));
        move |site| {
            let [a, b] = both(site);
            (cos * a + sin * b).clamp(-LARGEST_SCORE, LARGEST_SCORE)
        }
    }
}

/// Largest share of a law that may be cut off.
pub(crate) const MOST_CUT: f64 = 0.05;

/// The law of a control value: a Gaussian cut off at both ends, as a function of a standard normal score.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Values {
    /// The mean before it is cut off.
    pub(crate) mean: f64,
    sd: f64,
    low: f64,
    high: f64,
    /// The share of the Gaussian below `low`, and the share between the cuts. `None` if no score within
    /// [`LARGEST_SCORE`] reaches a cut.
    cut: Option<[f64; 2]>,
}

/// Share of the standard normal law below `z`.
fn below(z: f64) -> f64 {
    0.5 * math::erfc(-z * std::f64::consts::FRAC_1_SQRT_2)
}

impl Values {
    /// A law that these ends cut off.
    pub(crate) fn new(mean: f64, sd: f64, low: f64, high: f64) -> Self {
        let reach = (LARGEST_SCORE + 1.0) * sd;
        let cut = (sd > 0.0 && (mean - reach < low || mean + reach > high)).then(|| {
            let least = below((low - mean) / sd);
            [least, below((high - mean) / sd) - least]
        });
        Self { mean, sd, low, high, cut }
    }

    /// The value at a score: the law's quantile at the share of scores below.
    pub(crate) fn at(&self, score: f64) -> f64 {
        let z = match self.cut {
            None => score,
            Some([least, between]) => normal_quantile(least + between * below(score)),
        };
        (self.mean + self.sd * z).clamp(self.low, self.high)
    }

    /// A law that only the largest score cuts off, for heights.
    pub(crate) fn plain(mean: f64, sd: f64) -> Self {
        let reach = LARGEST_SCORE * sd;
        Self { mean, sd, low: mean - reach, high: mean + reach, cut: None }
    }

    /// The smallest and the largest value.
    pub(crate) fn range(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// Share of the Gaussian beyond the cuts, if it is more than allowed.
    pub(crate) fn beyond(mean: f64, sd: f64, low: f64, high: f64) -> Option<f64> {
        let law = TruncatedGaussian::new(mean, sd, low, high);
        let beyond = law.map_or(1.0, |law| 1.0 - math::exp(law.log_mass()));
        (sd > 0.0 && beyond > MOST_CUT).then_some(beyond)
    }
}

/// Heights per cell of the grid, along each axis.
pub(crate) const FINE: f64 = 3.0;
/// Most heights along an axis.
const MOST: usize = 160;

/// A surface over a rectangle as it is drawn, for control points this far apart.
pub(crate) fn relief([low, high]: [[f64; 2]; 2], spacing: f64, height: impl Fn(f64, f64) -> f64) -> Form {
    let step = spacing / FINE;
    let count = |axis: usize| (((high[axis] - low[axis]) / step).ceil() as usize + 1).clamp(2, MOST);
    let (columns, rows) = (count(0), count(1));
    let steps = [(high[0] - low[0]) / (columns - 1) as f64, (high[1] - low[1]) / (rows - 1) as f64];
    // An animation's z points against the simulator's y.
    let at = |i: usize, j: usize| height(low[0] + i as f64 * steps[0], high[1] - j as f64 * steps[1]);
    let heights = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))).map(|(i, j)| at(i, j)).collect();
    let origin = upright(DVec3::new(low[0], high[1], 0.0));
    Form::Heightfield { origin, step: steps, columns: columns as u32, heights }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plaus_dist::{Density, Purpose, Seed, standard_normal};

    /// Values of normal scores have the truncated law: the share below x, by Kolmogorov's distance over 10⁵ values. A
    /// distance of 0.0095 has a probability below 1e-7 (Dvoretzky, Kiefer, Wolfowitz, Massart).
    #[test]
    fn values_have_the_truncated_law() {
        for (mean, sd, high) in [(0.9, 0.06, 1.0), (0.1, 0.06, f64::INFINITY), (0.5, 0.05, 1.0)] {
            let values = Values::new(mean, sd, 0.0, f64::min(high, 10.0));
            let law = TruncatedGaussian::new(mean, sd, 0.0, high).unwrap();
            let mut stream = Seed(3).chain(0).at(0, Purpose(100));
            let mut drawn: Vec<f64> = (0..100_000).map(|_| values.at(standard_normal(&mut stream))).collect();
            drawn.sort_by(f64::total_cmp);
            assert!(drawn.iter().all(|x| (0.0..=high).contains(x)));
            // The law's own distribution function, by summing its density.
            let (from, steps) = (mean - 6.0 * sd, 20_000);
            let (mut share, mut next, mut farthest) = (0.0, 0, 0.0_f64);
            for k in 0..steps {
                let width = 12.0 * sd / f64::from(steps);
                let x = from + (f64::from(k) + 0.5) * width;
                share += math::exp(law.log_density(&x).unwrap().value()) * width;
                while next < drawn.len() && drawn[next] <= x + 0.5 * width {
                    next += 1;
                }
                farthest = farthest.max((share - next as f64 / drawn.len() as f64).abs());
            }
            assert!(farthest < 0.0095, "{mean} ± {sd}: {farthest}");
        }
    }

    /// Steps of a table and of single points; and two wrong twins: steps towards a fresh table in a straight line,
    /// which make it flatter and flatter, and changes of points that leave nothing across the direction of φ. Over
    /// 20,000 tables and four points each, the mean of squares is 1 and the mean of products of neighbours is 0, within
    /// 5.2 standard errors (a false alarm in 5·10⁶).
    #[test]
    fn steps_leave_a_table_s_law_invariant() {
        let site = |i, j| Site { field: Field::Height, i, j };
        let sites = [site(0, 0), site(0, 1), site(5, -3), site(-400, 7)];
        let n = 20_000;
        let (mut squares, mut products, mut twins, mut halves) = (0.0, 0.0, 0.0, 0.0);
        for table in 0..n {
            let mut stream = Seed(11).chain(0).at(table, Purpose::START);
            let (mut bumps, mut other) = (Bumps::default(), Bumps::default());
            bumps.renew(&mut stream);
            other.renew(&mut stream);
            let before = sites.map(bumps.source());
            let mut half = bumps.clone();
            for k in 0..20 {
                bumps.step(0.3, &mut stream);
                bumps.step_point(sites[k % 4], Sizes::new(0.1, 1.0), &mut stream);
                half.step(0.3, &mut stream);
                half.step_point(sites[k % 4], Sizes::new(0.1, 1.0), &mut stream);
                let (score, (sin, cos)) = (half.score(sites[k % 4]), math::sin_cos(half.angle));
                half.changed[0].set(sites[k % 4], cos * score);
                half.changed[1].set(sites[k % 4], sin * score);
            }
            let (scores, fresh) = (sites.map(bumps.source()), sites.map(other.source()));
            squares += scores.iter().map(|score| score * score).sum::<f64>() / 4.0;
            products += scores[0] * scores[1];
            halves += sites.map(half.source()).iter().map(|score| score * score).sum::<f64>() / 4.0;
            let twin = |k: usize| 0.7 * before[k] + 0.3 * fresh[k];
            twins += (0..4).map(|k| twin(k) * twin(k)).sum::<f64>() / 4.0;
        }
        let n = n as f64;
        assert!((squares / n - 1.0).abs() < 5.2 * (2.0 / (4.0 * n)).sqrt(), "{}", squares / n);
        assert!((products / n).abs() < 5.2 / n.sqrt(), "{}", products / n);
        for twin in [twins, halves] {
            assert!((twin / n - 1.0).abs() > 5.2 * (2.0 / (4.0 * n)).sqrt(), "a twin passes: {}", twin / n);
        }
    }

    /// A small step is a small change, and large steps reach tables that have nothing in common with the first.
    #[test]
    fn steps_are_small_and_lead_anywhere() {
        let mut stream = Seed(12).chain(0).at(0, Purpose::START);
        let mut bumps = Bumps::default();
        bumps.renew(&mut stream);
        let scores = |bumps: &Bumps| (0..400).map(|i| Site { field: Field::Height, i, j: i }).map(bumps.source());
        let first: Vec<f64> = scores(&bumps).collect();
        let alike = |bumps: &Bumps| scores(bumps).zip(&first).map(|(a, b)| a * b).sum::<f64>() / 400.0;
        let turned = Bumps { angle: bumps.angle + 0.01, ..bumps.clone() };
        assert!((alike(&turned) / alike(&bumps) - 1.0).abs() < 0.01, "{}", alike(&turned));
        for _ in 0..200 {
            bumps.step(0.5, &mut stream);
        }
        // 5.2 standard errors of a mean of 400 products of independent numbers.
        assert!(alike(&bumps).abs() < 5.2 / 20.0, "{}", alike(&bumps));
    }
}
