//! A density fitted to points that a chain visited in its warm-up: Gaussian kernels around the points, with one
//! covariance.
//!
//! The kernels' covariance is `h² Σ`, where Σ is the covariance of the points. Silverman's rule gives h from the number
//! of points and the number of coordinates. The kernels' centres are drawn towards the mean by `√(1 − h²)`, so that the
//! density has the same mean and covariance as the points (West, "Approximating posterior distributions by mixtures",
//! JRSS B 55, 1993). For few points with many coordinates h is near 1, so the density is nearly one Gaussian. Exactness
//! does not depend on how well it fits, because a move that proposes from it knows its density.

use plaus_dist::{Stream, math, open_unit, standard_normal};
use serde::{Deserialize, Serialize};

/// Largest number of points kept, and so of kernels. The cost of an evaluation is proportional to it.
const MOST: usize = 256;
/// The first fit is made when this many points have been noted, and another one each time their number has doubled.
const FIRST: u64 = 32;
/// A fit has settled if the one before gives the points a mean log density that is lower by no more than this. Where
/// draws of the fit are proposed, so much of a better one is hardly worth a tenth of the acceptance.
const NEAR: f64 = 0.1;

/// The points that a move learns from, and the last fits to them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Learning {
    /// How many coordinates of a point belong to each part. A point lists its parts one after the other; each part is
    /// fitted by itself.
    parts: Vec<usize>,
    /// One in this many points is kept; it doubles whenever the memory is full.
    stride: u64,
    noted: u64,
    /// The merit of the points noted; worse ones are not noted.
    merit: f64,
    kept: Vec<f64>,
    fits: Vec<Option<Fit>>,
    /// How many numbers were kept at the last look.
    old: usize,
    /// The fits to what was kept then.
    before: Vec<Option<Fit>>,
}

impl Learning {
    /// No points yet. `parts` gives the number of coordinates of each part; together they have at least one.
    pub(crate) fn start(parts: Vec<usize>) -> Self {
        let (stride, merit, none) = (1, f64::NEG_INFINITY, vec![None; parts.len()]);
        Self { stride, noted: 0, merit, kept: Vec::new(), fits: none.clone(), old: 0, before: none, parts }
    }

    /// How many coordinates of a point belong to each part.
    #[must_use]
    pub fn parts(&self) -> &[usize] {
        &self.parts
    }

    /// The last fit of each part; `None` while too little is known of it.
    #[must_use]
    pub fn fits(&self) -> &[Option<Fit>] {
        &self.fits
    }

    fn numbers(&self) -> usize {
        self.parts.iter().sum()
    }

    /// Notes where the chain is, unless that has less merit than an earlier point; if it has more, the earlier points
    /// are forgotten. An empty point is not noted. Returns whether a new fit was made.
    pub(crate) fn note(&mut self, point: &[f64], merit: f64) -> bool {
        if point.is_empty() || merit < self.merit {
            return false;
        }
        if merit > self.merit {
            (self.merit, self.noted, self.stride, self.old) = (merit, 0, 1, 0);
            self.kept.clear();
        }
        if self.noted.is_multiple_of(self.stride) {
            self.kept.extend_from_slice(point);
        }
        self.noted += 1;
        let numbers = self.numbers();
        if self.kept.len() >= MOST * numbers {
            let even = self.kept.chunks(numbers).step_by(2);
            self.kept = even.flatten().copied().collect();
            self.old = (self.old / numbers).div_ceil(2) * numbers;
            self.stride *= 2;
        }
        let is_due = self.noted >= FIRST && self.noted.is_power_of_two();
        is_due && self.refit()
    }

    /// Forgets the points from before the last look, and compares with the present from now on.
    pub(crate) fn turn(&mut self) {
        self.before = self.refits().into_iter().map(|(fit, _)| fit).collect();
        self.kept.drain(..self.old);
        self.old = self.kept.len();
    }

    /// Whether fits to the points known by now describe them hardly better than the fits at the last look do. Never
    /// before there are fits.
    pub(crate) fn has_settled(&self) -> bool {
        let settled = |((now, points), before): ((Option<Fit>, Vec<f64>), &Option<Fit>)| {
            let gain = now.zip(before.as_ref()).map(|(now, before)| {
                let gains = points.chunks(now.numbers).map(|x| now.log_density(x, 0) - before.log_density(x, 0));
                gains.sum::<f64>() / (points.len() / now.numbers) as f64
            });
            gain.is_some_and(|gain| gain <= NEAR)
        };
        self.refits().into_iter().zip(&self.before).all(settled)
    }

    /// Fits for the last time; the points are no longer needed.
    pub(crate) fn freeze(&mut self) {
        self.refit();
        (self.kept, self.old) = (Vec::new(), 0);
        self.before.fill(None);
    }

    fn refit(&mut self) -> bool {
        let (mut is_new, refits) = (false, self.refits());
        for (known, (fit, _)) in self.fits.iter_mut().zip(refits) {
            is_new |= fit.is_some();
            *known = fit.or_else(|| known.take());
        }
        is_new
    }

    /// For each part, a fit to the points kept, if there are enough, and what was fitted.
    fn refits(&self) -> Vec<(Option<Fit>, Vec<f64>)> {
        let (numbers, mut begin) = (self.numbers(), 0);
        let refit = |&part: &usize| {
            let of_part = self.kept.chunks(numbers).flat_map(|point| &point[begin..begin + part]).copied();
            let of_part: Vec<f64> = of_part.collect();
            begin += part;
            (Fit::to(&of_part, part), of_part)
        };
        self.parts.iter().map(refit).collect()
    }
}

/// A mixture of equally likely Gaussians with one covariance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fit {
    numbers: usize,
    /// The lower triangular root L of the kernels' covariance, row by row.
    root: Vec<f64>,
    /// The kernels' centres c, each as `L⁻¹ c`.
    centres: Vec<f64>,
    /// Log density of a kernel at its centre.
    peak: f64,
}

impl Fit {
    /// A fit to points of `numbers` coordinates each, one after the other. `None` if there are fewer different points
    /// than twice a covariance needs, or if a coordinate does not vary.
    #[must_use]
    pub fn to(points: &[f64], numbers: usize) -> Option<Self> {
        let rows: Vec<&[f64]> = points.chunks_exact(numbers.max(1)).collect();
        // A chain that stays where it is repeats a point, which then counts once; a point that it returns to counts
        // again.
        let different = rows.first().map_or(0, |_| 1) + rows.windows(2).filter(|two| two[0] != two[1]).count();
        if numbers == 0 || different < 2 * (numbers + 1) {
            return None;
        }
        let (d, count) = (numbers as f64, rows.len() as f64);
        let mean: Vec<f64> = (0..numbers).map(|k| rows.iter().map(|row| row[k]).sum::<f64>() / count).collect();
        let product = |i: usize, j: usize| rows.iter().map(|row| (row[i] - mean[i]) * (row[j] - mean[j])).sum::<f64>();
        // Silverman's rule for the square of the kernels' width, relative to the points' covariance.
        let narrow = math::exp(2.0 / (d + 4.0) * math::ln(4.0 / ((d + 2.0) * different as f64))).min(1.0);
        // Correlations are shrunk as if uncorrelated points had been added, one for each coordinate.
        let trusted = different as f64 / (different as f64 + d);
        let covariance = |i: usize, j: usize| {
            let shrunk = if i == j { 1.0 } else { trusted };
            narrow * shrunk * product(i, j) / count
        };
        let root = cholesky(numbers, covariance)?;
        let drawn_in = (1.0 - narrow).max(0.0).sqrt();
        let centre = |row: &&[f64]| -> Vec<f64> {
            let inwards = row.iter().zip(&mean).map(|(x, mean)| mean + drawn_in * (x - mean));
            whiten(&root, numbers, &inwards.collect::<Vec<f64>>())
        };
        let centres = rows.iter().flat_map(centre).collect();
        let log_volume: f64 = (0..numbers).map(|k| math::ln(root[k * numbers + k])).sum();
        let peak = -log_volume - 0.5 * d * math::ln(std::f64::consts::TAU);
        Some(Self { numbers, root, centres, peak })
    }

    /// How many kernels there are.
    #[must_use]
    pub fn kernels(&self) -> usize {
        self.centres.len() / self.numbers
    }

    /// The same density with its coordinates in another order; `order` lists each of them once. `None` if rounding
    /// leaves no triangular root.
    #[must_use]
    pub fn ordered(&self, order: &[usize]) -> Option<Self> {
        let n = self.numbers;
        let row = |k: usize| &self.root[order[k] * n..][..n];
        let root = cholesky(n, |i, j| row(i).iter().zip(row(j)).map(|(a, b)| a * b).sum())?;
        let centre = |white: &[f64]| {
            let point = self.coloured(white);
            whiten(&root, n, &order.iter().map(|&k| point[k]).collect::<Vec<f64>>())
        };
        let centres = self.centres.chunks(n).flat_map(centre).collect();
        Some(Self { numbers: n, centres, root, peak: self.peak })
    }

    /// A point of the mixture given its first coordinates `known`, which may be none, and the kernel that it came from.
    /// The nearer a kernel is to the known coordinates, the likelier it is.
    pub fn sample(&self, known: &[f64], stream: &mut Stream) -> (usize, Vec<f64>) {
        let mut white = whiten(&self.root, self.numbers, known);
        let logs = self.logs(&white);
        let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let weights: Vec<f64> = logs.iter().map(|log| math::exp(log - most)).collect();
        let mut left = weights.iter().sum::<f64>() * open_unit(stream);
        let chosen = weights.iter().position(|weight| {
            left -= weight;
            left < 0.0
        });
        let kernel = chosen.unwrap_or(weights.len() - 1);
        let centre = &self.centres[kernel * self.numbers..][..self.numbers];
        white.extend(centre[known.len()..].iter().map(|c| c + standard_normal(stream)));
        (kernel, self.coloured(&white))
    }

    /// Log density of the mixture at a point, given the first `known` of its coordinates.
    #[must_use]
    pub fn log_density(&self, point: &[f64], known: usize) -> f64 {
        let white = whiten(&self.root, self.numbers, point);
        self.log_peak(known) + log_sum_exp(&self.logs(&white)) - log_sum_exp(&self.logs(&white[..known]))
    }

    /// Log density of one kernel at a point, given the first `known` of its coordinates.
    ///
    /// # Panics
    /// If there is no such kernel.
    #[must_use]
    pub fn log_density_of(&self, kernel: usize, point: &[f64], known: usize) -> f64 {
        let white = whiten(&self.root, self.numbers, point);
        let centre = &self.centres[kernel * self.numbers..][..self.numbers];
        self.log_peak(known) + log_kernel(&centre[known..], &white[known..])
    }

    /// Log density of a kernel at its centre, given the first `known` coordinates.
    fn log_peak(&self, known: usize) -> f64 {
        let root = |k: usize| math::ln(self.root[k * self.numbers + k]);
        self.peak + (0..known).map(|k| root(k) + 0.5 * math::ln(std::f64::consts::TAU)).sum::<f64>()
    }

    /// For each kernel, the log density of the first coordinates relative to its centre.
    fn logs(&self, white: &[f64]) -> Vec<f64> {
        self.centres.chunks(self.numbers).map(|centre| log_kernel(centre, white)).collect()
    }

    /// The point from which [`whiten`] made this one.
    fn coloured(&self, white: &[f64]) -> Vec<f64> {
        let row = |i: usize| self.root[i * self.numbers..][..=i].iter().zip(white).map(|(l, y)| l * y).sum();
        (0..self.numbers).map(row).collect()
    }
}

/// Log density of a standard normal kernel relative to its centre.
fn log_kernel(centre: &[f64], white: &[f64]) -> f64 {
    -0.5 * centre.iter().zip(white).map(|(c, x)| math::square(x - c)).sum::<f64>()
}

fn log_sum_exp(logs: &[f64]) -> f64 {
    let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    most + math::ln(logs.iter().map(|log| math::exp(log - most)).sum())
}

/// The lower triangular root of a symmetric matrix, row by row; `None` if the matrix is not positive definite.
fn cholesky(numbers: usize, entry: impl Fn(usize, usize) -> f64) -> Option<Vec<f64>> {
    let mut root = vec![0.0; numbers * numbers];
    for i in 0..numbers {
        for j in 0..=i {
            let rest = entry(i, j) - (0..j).map(|k| root[i * numbers + k] * root[j * numbers + k]).sum::<f64>();
            root[i * numbers + j] = if i != j {
                rest / root[j * numbers + j]
            } else if rest > 0.0 && rest.is_finite() {
                rest.sqrt()
            } else {
                return None;
            };
        }
    }
    Some(root)
}

/// Solves `L y = x` for the first coordinates of y, as many as x has. L is lower triangular and has `rows` rows.
fn whiten(root: &[f64], rows: usize, x: &[f64]) -> Vec<f64> {
    let mut y: Vec<f64> = Vec::with_capacity(rows);
    for (i, x) in x.iter().enumerate() {
        let row = &root[i * rows..][..=i];
        let rest = x - y.iter().zip(row).map(|(y, l)| y * l).sum::<f64>();
        y.push(rest / row[i]);
    }
    y
}

#[cfg(test)]
mod tests {
    use super::*;
    use plaus_dist::{Purpose, Seed};

    /// Points whose second coordinate follows the first.
    fn points(count: usize, stream: &mut Stream) -> Vec<f64> {
        let one = |_| {
            let x = standard_normal(stream);
            [3.0 + x, 2.0 * x + 0.5 * standard_normal(stream)]
        };
        (0..count).flat_map(one).collect()
    }

    /// The mean of another density divided by the fit's, over the fit's own draws, is 1 for any other density. So the
    /// fit is normalised, and is the density of its draws; also given its second coordinate, here 1.5. The mean is over
    /// 40,000 terms of at most about 2, so five standard errors are below 0.03. The wrong twin, the density of both
    /// coordinates instead of one given the other, is caught.
    #[test]
    fn a_fit_s_density_is_that_of_its_draws() {
        let mut stream = Seed(4).chain(0).at(0, Purpose(100));
        let fit = Fit::to(&points(60, &mut stream), 2).unwrap();
        for (fit, known) in [(fit.clone(), &[][..]), (fit.ordered(&[1, 0]).unwrap(), &[1.5][..])] {
            let (given, free) = (known.len(), 2.0 - known.len() as f64);
            let other = |point: &[f64]| {
                // The fit's own first kernel, made half as wide.
                let by = fit.log_density_of(0, point, given) - fit.log_peak(given);
                math::exp(4.0 * by + fit.log_peak(given) + free * std::f64::consts::LN_2)
            };
            let mut mean_of_ratios = |taken_for_known: usize| {
                let (mut sum, mut square, count) = (0.0, 0.0, 40_000);
                for _ in 0..count {
                    let (_, point) = fit.sample(known, &mut stream);
                    let ratio = other(&point) / math::exp(fit.log_density(&point, taken_for_known));
                    sum += ratio;
                    square += ratio * ratio;
                }
                let mean = sum / f64::from(count);
                (mean, ((square / f64::from(count) - mean * mean) / f64::from(count)).sqrt())
            };
            let (mean, error) = mean_of_ratios(given);
            assert!((mean - 1.0).abs() < 5.0 * error && error < 0.05, "{mean} ± {error} given {given}");
            if given > 0 {
                let (mean, error) = mean_of_ratios(0);
                assert!((mean - 1.0).abs() > 5.0 * error, "not caught: {mean} ± {error}");
            }
        }
    }

    /// The density of a point is that of one coordinate times that of the other given it, in either order, and the
    /// order of coordinates does not matter. Tolerance: a few dozen roundings of numbers below 100.
    #[test]
    fn densities_of_parts_multiply() {
        let mut stream = Seed(6).chain(0).at(0, Purpose(100));
        let fit = Fit::to(&points(60, &mut stream), 2).unwrap();
        let other = fit.ordered(&[1, 0]).unwrap();
        let wide = Fit::to(&(0..40).map(|_| standard_normal(&mut stream)).collect::<Vec<f64>>(), 1).unwrap();
        assert!((wide.log_density(&[0.3], 0) - wide.ordered(&[0]).unwrap().log_density(&[0.3], 0)).abs() < 1e-12);
        for _ in 0..20 {
            let [x, y] = <[f64; 2]>::try_from(fit.sample(&[], &mut stream).1).unwrap();
            assert!((fit.log_density(&[x, y], 0) - other.log_density(&[y, x], 0)).abs() < 1e-10);
            // What remains of the whole depends on the given coordinate alone.
            let marginal = |y: f64, x: f64| other.log_density(&[y, x], 0) - other.log_density(&[y, x], 1);
            assert!((marginal(y, x) - marginal(y, x + 1.0)).abs() < 1e-10);
        }
    }

    #[test]
    fn too_few_points_are_not_fitted() {
        let mut stream = Seed(5).chain(0).at(0, Purpose(100));
        assert!(Fit::to(&points(5, &mut stream), 2).is_none());
        assert!(Fit::to(&points(6, &mut stream), 2).is_some());
        assert!(Fit::to(&[1.0, 2.0].repeat(100), 2).is_none(), "one point, again and again");
        let flat: Vec<f64> = (0..100).flat_map(|k| [f64::from(k), 1.0]).collect();
        assert!(Fit::to(&flat, 2).is_none(), "a number that does not vary");
    }

    /// Points of less merit do not matter to the fit, wherever they come.
    #[test]
    fn only_the_best_points_are_learnt_from() {
        let mut stream = Seed(7).chain(0).at(0, Purpose(100));
        let good: Vec<f64> = (0..40).map(|_| standard_normal(&mut stream)).collect();
        let learnt = |with_bad: bool| {
            let mut learning = Learning::start(vec![1]);
            for (k, x) in good.iter().enumerate() {
                if with_bad {
                    learning.note(&[50.0 + x], 1.0);
                    // The first good point makes the earlier ones forgotten.
                    for _ in 0..if k == 0 { 700 } else { 0 } {
                        learning.note(&[9.0 * x], 2.0);
                    }
                }
                learning.note(&[*x], 3.0);
                learning.note(&[], 4.0);
            }
            learning.freeze();
            learning.fits()[0].clone().unwrap()
        };
        assert_eq!(learnt(true), learnt(false));
        assert_eq!(learnt(true), Fit::to(&good, 1).unwrap());
    }

    /// The fit to many points settles. It does not before there are many, or while they wander; and what is fitted is
    /// all but the first quarter of the points.
    #[test]
    fn a_fit_settles_once_new_points_are_like_old_ones() {
        let settled = |speed: f64, first: u32| {
            let (mut stream, mut learning) = (Seed(7).chain(0).at(0, Purpose(100)), Learning::start(vec![2]));
            let (mut done, mut halves) = (0, Vec::new());
            for half in 0..4 {
                while done < first << half {
                    done += 1;
                    let wander = speed * math::ln(f64::from(done));
                    let mut point = points(1, &mut stream);
                    point.iter_mut().for_each(|x| *x += wander);
                    learning.note(&point, 0.0);
                }
                halves.push(learning.has_settled());
                learning.turn();
            }
            halves
        };
        assert_eq!(settled(0.0, 4), [false; 4], "few");
        assert_eq!(settled(0.0, 100), [false, true, true, true]);
        assert_eq!(settled(4.0, 100), [false; 4], "wandering");

        let mut learning = Learning::start(vec![1]);
        for k in 0..160_u32 {
            if [40, 80].contains(&k) {
                learning.turn();
            }
            learning.note(&[f64::from(k)], 0.0);
        }
        learning.freeze();
        let exact: Vec<f64> = (40..160).map(f64::from).collect();
        assert_eq!(learning.fits()[0], Fit::to(&exact, 1));
    }

    #[test]
    fn memory_is_bounded_and_evenly_spread() {
        let mut learning = Learning::start(vec![1]);
        for k in 0..10_000_u32 {
            learning.note(&[f64::from(k)], 0.0);
            assert!(learning.kept.len() < MOST);
        }
        let gaps: Vec<f64> = learning.kept.windows(2).map(|two| two[1] - two[0]).collect();
        assert!(learning.kept.len() >= MOST / 2 && gaps.iter().all(|gap| *gap == gaps[0]), "{gaps:?}");
        learning.freeze();
        assert!(learning.kept.is_empty() && learning.fits()[0].is_some());
    }
}
