//! A density fitted to points that a chain has visited in its warm-up: Gaussian kernels about them, of one covariance.
//!
//! The kernels' covariance is `h² Σ`, Σ being that of the points, with Silverman's h for so many points of so many
//! numbers; their centres are drawn towards the mean by `√(1 − h²)`, so that the density has the points' own mean and
//! covariance (West, "Approximating posterior distributions by mixtures", JRSS B 55, 1993). With few points of many
//! numbers h comes near 1, which is one Gaussian. How well it fits is no matter of exactness: a move that proposes from
//! it knows its density.

use plaus_dist::stream::below;
use plaus_dist::{Stream, math, standard_normal};
use serde::{Deserialize, Serialize};

/// The most points that are kept, and so the most kernels: an evaluation costs so many times the numbers of a point.
const MOST: usize = 256;
/// Fits are made when so many points have been noted, and each time these have doubled.
const FIRST: u64 = 32;

/// The points that a move learns from, and what was fitted to them last.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Learning {
    /// How many numbers a point has.
    numbers: usize,
    /// One point in so many is kept; doubles whenever the memory is full.
    stride: u64,
    noted: u64,
    kept: Vec<f64>,
    fit: Option<Fit>,
}

impl Learning {
    /// Nothing yet, of points with so many numbers, at least one.
    pub(crate) fn start(numbers: usize) -> Self {
        Self { numbers, stride: 1, noted: 0, kept: Vec::new(), fit: None }
    }

    /// How many numbers a point has.
    #[must_use]
    pub fn numbers(&self) -> usize {
        self.numbers
    }

    /// What was fitted last; `None` while too little is known.
    #[must_use]
    pub fn fit(&self) -> Option<&Fit> {
        self.fit.as_ref()
    }

    /// Notes where the chain is; whether another fit was made of it.
    pub(crate) fn note(&mut self, point: &[f64]) -> bool {
        if self.noted.is_multiple_of(self.stride) {
            self.kept.extend_from_slice(point);
        }
        self.noted += 1;
        if self.kept.len() >= MOST * self.numbers {
            let even = self.kept.chunks(self.numbers).step_by(2);
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
        let fit = Fit::to(&self.kept, self.numbers);
        let is_new = fit.is_some();
        self.fit = fit.or(self.fit.take());
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
            whiten(&root, &inwards.collect::<Vec<f64>>())
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

    /// A point of the mixture, and the kernel it came from.
    pub fn sample(&self, stream: &mut Stream) -> (usize, Vec<f64>) {
        let kernel = below(stream, self.kernels());
        let centre = &self.centres[kernel * self.numbers..][..self.numbers];
        let white: Vec<f64> = centre.iter().map(|c| c + standard_normal(stream)).collect();
        let row = |i: usize| (0..=i).map(|j| self.root[i * self.numbers + j] * white[j]).sum();
        (kernel, (0..self.numbers).map(row).collect())
    }

    /// Log density of the mixture at a point.
    #[must_use]
    pub fn log_density(&self, point: &[f64]) -> f64 {
        let white = whiten(&self.root, point);
        let sum = self
            .centres
            .chunks(self.numbers)
            .fold(f64::NEG_INFINITY, |sum, centre| math::ln_add_exp(sum, self.log_kernel(centre, &white)));
        sum - math::ln(self.kernels() as f64)
    }

    /// Log density of one kernel at a point.
    ///
    /// # Panics
    /// Where there is no such kernel.
    #[must_use]
    pub fn log_density_of(&self, kernel: usize, point: &[f64]) -> f64 {
        self.log_kernel(&self.centres[kernel * self.numbers..][..self.numbers], &whiten(&self.root, point))
    }

    fn log_kernel(&self, centre: &[f64], white: &[f64]) -> f64 {
        self.peak - 0.5 * centre.iter().zip(white).map(|(c, x)| math::square(x - c)).sum::<f64>()
    }
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

/// Solves `L y = x`, L being lower triangular.
fn whiten(root: &[f64], x: &[f64]) -> Vec<f64> {
    let mut y: Vec<f64> = Vec::with_capacity(x.len());
    for (i, x) in x.iter().enumerate() {
        let row = &root[i * y.capacity()..];
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
    /// density of what it draws. 40,000 terms of at most about 2: five standard errors are below 0.03.
    #[test]
    fn its_density_is_that_of_its_draws() {
        let mut stream = Seed(4).chain(0).at(0, Purpose(100));
        let fit = Fit::to(&points(60, &mut stream), 2).unwrap();
        let other = |point: &[f64]| {
            // The fit's own first kernel, half as wide.
            let by = fit.log_density_of(0, point) - fit.peak;
            math::exp(4.0 * by + fit.peak) * 4.0
        };
        let (mut sum, mut square, count) = (0.0, 0.0, 40_000);
        for _ in 0..count {
            let (_, point) = fit.sample(&mut stream);
            let ratio = other(&point) / math::exp(fit.log_density(&point));
            sum += ratio;
            square += ratio * ratio;
        }
        let mean = sum / f64::from(count);
        let error = ((square / f64::from(count) - mean * mean) / f64::from(count)).sqrt();
        assert!((mean - 1.0).abs() < 5.0 * error && error < 0.05, "{mean} ± {error}");
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
        let mut learning = Learning::start(1);
        for k in 0..10_000_u32 {
            learning.note(&[f64::from(k)]);
            assert!(learning.kept.len() < MOST);
        }
        let gaps: Vec<f64> = learning.kept.windows(2).map(|two| two[1] - two[0]).collect();
        assert!(learning.kept.len() >= MOST / 2 && gaps.iter().all(|gap| *gap == gaps[0]), "{gaps:?}");
        learning.freeze();
        assert!(learning.kept.is_empty() && learning.fit().is_some());
    }
}
