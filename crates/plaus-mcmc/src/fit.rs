//! A density fitted to points that a chain has visited in its warm-up: Gaussian kernels about them, of one covariance.
//!
//! The kernels' covariance is `h² Σ`, Σ being that of the points, with Silverman's h for so many points of so many
//! numbers; their centres are drawn towards the mean by `√(1 − h²)`, so that the density has the points' own mean and
//! covariance (West, "Approximating posterior distributions by mixtures", JRSS B 55, 1993). With few points of many
//! numbers h comes near 1, which is one Gaussian. How well it fits is no matter of exactness: a move that proposes from
//! it knows its density.

use plaus_dist::{Stream, math, open_unit, standard_normal};
use serde::{Deserialize, Serialize};

/// The most points that are kept, and so the most kernels: an evaluation costs so many times the numbers of a point.
const MOST: usize = 256;
/// Fits are made when so many points have been noted, and each time these have doubled.
const FIRST: u64 = 32;

/// The points that a move learns from, and what was fitted to them last.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Learning {
    /// How many numbers a point has of each part, one part after the other; each is fitted by itself.
    parts: Vec<usize>,
    /// One point in so many is kept; doubles whenever the memory is full.
    stride: u64,
    noted: u64,
    kept: Vec<f64>,
    fits: Vec<Option<Fit>>,
}

impl Learning {
    /// Nothing yet, of points with so many numbers of each part, at least one in all.
    pub(crate) fn start(parts: Vec<usize>) -> Self {
        Self { stride: 1, noted: 0, kept: Vec::new(), fits: vec![None; parts.len()], parts }
    }

    /// How many numbers a point has of each part.
    #[must_use]
    pub fn parts(&self) -> &[usize] {
        &self.parts
    }

    /// What was fitted last, by part; `None` while too little is known of one.
    #[must_use]
    pub fn fits(&self) -> &[Option<Fit>] {
        &self.fits
    }

    fn numbers(&self) -> usize {
        self.parts.iter().sum()
    }

    /// Notes where the chain is; whether another fit was made of it.
    pub(crate) fn note(&mut self, point: &[f64]) -> bool {
        if self.noted.is_multiple_of(self.stride) {
            self.kept.extend_from_slice(point);
        }
        self.noted += 1;
        let numbers = self.numbers();
        if self.kept.len() >= MOST * numbers {
            let even = self.kept.chunks(numbers).step_by(2);
            self.kept = even.flatten().copied().collect();
            self.stride *= 2;
        }
        let is_due = self.noted >= FIRST && self.noted.is_power_of_two();
        is_due && self.refit()
    }

    /// Fits for the last time; the points are no longer needed.
    pub(crate) fn freeze(&mut self) {
        self.refit();
        self.kept = Vec::new();
    }

    fn refit(&mut self) -> bool {
        let (numbers, mut begin, mut is_new) = (self.numbers(), 0, false);
        for (&part, known) in self.parts.iter().zip(&mut self.fits) {
            let of_part: Vec<f64> =
                self.kept.chunks(numbers).flat_map(|point| &point[begin..begin + part]).copied().collect();
            begin += part;
            if let Some(fit) = Fit::to(&of_part, part) {
                (*known, is_new) = (Some(fit), true);
            }
        }
        is_new
    }
}

/// A mixture of Gaussians of one covariance, each as likely.
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
    /// A fit to points of so many numbers, one after the other. `None` where they tell too little: unless there are
    /// twice as many different ones as a covariance needs, and all numbers vary.
    #[must_use]
    pub fn to(points: &[f64], numbers: usize) -> Option<Self> {
        let rows: Vec<&[f64]> = points.chunks_exact(numbers.max(1)).collect();
        // A chain that stays repeats itself; what comes back later counts anew.
        let different = rows.first().map_or(0, |_| 1) + rows.windows(2).filter(|two| two[0] != two[1]).count();
        if numbers == 0 || different < 2 * (numbers + 1) {
            return None;
        }
        let (d, count) = (numbers as f64, rows.len() as f64);
        let mean: Vec<f64> = (0..numbers).map(|k| rows.iter().map(|row| row[k]).sum::<f64>() / count).collect();
        let product = |i: usize, j: usize| rows.iter().map(|row| (row[i] - mean[i]) * (row[j] - mean[j])).sum::<f64>();
        // Silverman's rule for the square of the kernels' width, in units of the points' covariance.
        let narrow = math::exp(2.0 / (d + 4.0) * math::ln(4.0 / ((d + 2.0) * different as f64))).min(1.0);
        // Correlations are shrunk as if so many points as numbers had been added that know of none.
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

    /// The same density with its numbers in another order, that lists each once. `None` where rounding leaves no root.
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

    /// A point of the mixture given its first numbers, which may be none, and the kernel that it came from. A kernel is
    /// the likelier, the nearer these are.
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

    /// Log density of the mixture at a point, given so many of its first numbers.
    #[must_use]
    pub fn log_density(&self, point: &[f64], known: usize) -> f64 {
        let white = whiten(&self.root, self.numbers, point);
        self.log_peak(known) + log_sum_exp(&self.logs(&white)) - log_sum_exp(&self.logs(&white[..known]))
    }

    /// Log density of one kernel at a point, given so many of its first numbers.
    ///
    /// # Panics
    /// Where there is no such kernel.
    #[must_use]
    pub fn log_density_of(&self, kernel: usize, point: &[f64], known: usize) -> f64 {
        let white = whiten(&self.root, self.numbers, point);
        let centre = &self.centres[kernel * self.numbers..][..self.numbers];
        self.log_peak(known) + log_kernel(&centre[known..], &white[known..])
    }

    /// Log density of a kernel at its centre, given so many first numbers.
    fn log_peak(&self, known: usize) -> f64 {
        let root = |k: usize| math::ln(self.root[k * self.numbers + k]);
        self.peak + (0..known).map(|k| root(k) + 0.5 * math::ln(std::f64::consts::TAU)).sum::<f64>()
    }

    /// Per kernel, the log density of first numbers over that at its centre.
    fn logs(&self, white: &[f64]) -> Vec<f64> {
        self.centres.chunks(self.numbers).map(|centre| log_kernel(centre, white)).collect()
    }

    /// The point that [`whiten`] made this of.
    fn coloured(&self, white: &[f64]) -> Vec<f64> {
        let row = |i: usize| self.root[i * self.numbers..][..=i].iter().zip(white).map(|(l, y)| l * y).sum();
        (0..self.numbers).map(row).collect()
    }
}

/// Log density of a standard normal kernel over that at its centre.
fn log_kernel(centre: &[f64], white: &[f64]) -> f64 {
    -0.5 * centre.iter().zip(white).map(|(c, x)| math::square(x - c)).sum::<f64>()
}

fn log_sum_exp(logs: &[f64]) -> f64 {
    let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    most + math::ln(logs.iter().map(|log| math::exp(log - most)).sum())
}

/// The lower triangular root of a symmetric matrix, row by row; `None` where it is not positive definite.
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

/// Solves `L y = x`, L being lower triangular with so many rows, for as many first numbers as x has.
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

    /// Points whose second number follows the first.
    fn points(count: usize, stream: &mut Stream) -> Vec<f64> {
        let one = |_| {
            let x = standard_normal(stream);
            [3.0 + x, 2.0 * x + 0.5 * standard_normal(stream)]
        };
        (0..count).flat_map(one).collect()
    }

    /// Mean over its own draws of another density over its own is 1, whatever the other: so it is normalised, and the
    /// density of what it draws; also given its second number, here 1.5. 40,000 terms of at most about 2: five standard
    /// errors are below 0.03. The density of both numbers is not that of one given the other.
    #[test]
    fn its_density_is_that_of_its_draws() {
        let mut stream = Seed(4).chain(0).at(0, Purpose(100));
        let fit = Fit::to(&points(60, &mut stream), 2).unwrap();
        for (fit, known) in [(fit.clone(), &[][..]), (fit.ordered(&[1, 0]).unwrap(), &[1.5][..])] {
            let (given, free) = (known.len(), 2.0 - known.len() as f64);
            let other = |point: &[f64]| {
                // The fit's own first kernel, half as wide.
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

    /// The density of a point is that of one number times that of the other given it, in either order; and the order of
    /// numbers is no matter. A few dozen roundings of numbers below 100.
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
            // What is left of the whole is a function of the number that is given, alone.
            let marginal = |y: f64, x: f64| other.log_density(&[y, x], 0) - other.log_density(&[y, x], 1);
            assert!((marginal(y, x) - marginal(y, x + 1.0)).abs() < 1e-10);
        }
    }

    #[test]
    fn what_tells_too_little_is_not_fitted() {
        let mut stream = Seed(5).chain(0).at(0, Purpose(100));
        assert!(Fit::to(&points(5, &mut stream), 2).is_none());
        assert!(Fit::to(&points(6, &mut stream), 2).is_some());
        assert!(Fit::to(&[1.0, 2.0].repeat(100), 2).is_none(), "one point, again and again");
        let flat: Vec<f64> = (0..100).flat_map(|k| [f64::from(k), 1.0]).collect();
        assert!(Fit::to(&flat, 2).is_none(), "a number that does not vary");
    }

    #[test]
    fn memory_is_bounded_and_evenly_spread() {
        let mut learning = Learning::start(vec![1]);
        for k in 0..10_000_u32 {
            learning.note(&[f64::from(k)]);
            assert!(learning.kept.len() < MOST);
        }
        let gaps: Vec<f64> = learning.kept.windows(2).map(|two| two[1] - two[0]).collect();
        assert!(learning.kept.len() >= MOST / 2 && gaps.iter().all(|gap| *gap == gaps[0]), "{gaps:?}");
        learning.freeze();
        assert!(learning.kept.is_empty() && learning.fits()[0].is_some());
    }
}
