//! Are two laws equal? The tests' p-values are bounds, not approximations, so a stated false-alarm rate such as 1e-6
//! holds.

use plaus_dist::math;
use std::cmp::Ordering;
use std::f64::consts::LN_2;
use std::fmt;

/// A p-value (or an upper bound of one), kept as its logarithm, at most 0, so that overwhelming evidence remains a
/// number.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct LogP(f64);

impl LogP {
    /// No evidence: p = 1.
    pub const ONE: Self = Self(0.0);
    /// Something impossible has happened: p = 0.
    pub const ZERO: Self = Self(f64::NEG_INFINITY);

    /// From ln p; values above 0 count as 0.
    pub(super) fn of(ln_p: f64) -> Self {
        Self(ln_p.min(0.0))
    }

    /// ln p, in nats.
    #[must_use]
    pub fn ln(self) -> f64 {
        self.0
    }

    /// p itself; 0 if it is below the smallest float.
    #[must_use]
    pub fn value(self) -> f64 {
        math::exp(self.0)
    }

    /// Bonferroni's correction: the p-value of the smallest of `tests` p-values, however they depend on each other.
    #[must_use]
    pub fn of_smallest_among(self, tests: usize) -> Self {
        Self::of(self.0 + math::ln(tests.max(1) as f64))
    }
}

impl fmt::Display for LogP {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = if *self == Self::ZERO {
            "0".to_owned()
        } else if self.0 > -690.0 {
            // exp(−690) is about 1e-300: still an ordinary float.
            format!("{:.1e}", self.value())
        } else {
            format!("1e{:.0}", self.0 / std::f64::consts::LN_10)
        };
        f.pad(&text)
    }
}

/// Tests that the differences `d` have a law symmetric about 0, by their mean.
///
/// Given their sizes |d|, only the signs are random, so `P(|Σd| ≥ z √Σd²) ≤ 2 exp(−z²/2)` for any law and any number of
/// them (Hoeffding, "Probability inequalities for sums of bounded random variables", JASA 58, 1963; Efron, "Student's
/// t-test under symmetry conditions", JASA 64, 1969).
pub(super) fn symmetric(differences: impl Iterator<Item = f64>) -> LogP {
    let (sum, squares) = differences.fold((0.0, 0.0), |(sum, squares), d| (sum + d, squares + d * d));
    if squares > 0.0 { LogP::of(LN_2 - 0.5 * sum * sum / squares) } else { LogP::ONE }
}

/// Tests that two sorted samples of equal size have one law, by the largest distance D between their distribution
/// functions: `P ≤ 2 exp(−n D²)` for n ≥ 458, with equality in the limit for continuous laws (Wei & Dudley, "Two-sample
/// Dvoretzky–Kiefer–Wolfowitz inequalities", Statistics & Probability Letters 82, 2012).
pub(super) fn same_law(a: &[f64], b: &[f64]) -> LogP {
    let size = a.len().min(b.len()) as f64;
    let (mut i, mut j, mut largest) = (0, 0, 0_usize);
    while i < a.len() && j < b.len() {
        // Past all values equal to the smaller of the two heads, in both samples at once.
        let value = if a[i].total_cmp(&b[j]) == Ordering::Greater { b[j] } else { a[i] };
        while i < a.len() && a[i] <= value {
            i += 1;
        }
        while j < b.len() && b[j] <= value {
            j += 1;
        }
        largest = largest.max(i.abs_diff(j));
    }
    let distance = largest as f64 / size;
    LogP::of(LN_2 - size * distance * distance)
}

/// Tests that counts over cells come from the given probabilities, by the relative entropy D of the observed shares:
/// for `t = n D > k − 1`, `P ≤ exp(−t) (e t / (k − 1))^(k − 1)` (Agrawal, "Finite-sample concentration of the
/// multinomial in relative entropy", IEEE Trans. Inf. Theory 66, 2020). 2t is the G statistic, asymptotically χ² with k
/// − 1 degrees of freedom; the bound also holds for cells with few counts.
pub(super) fn multinomial(cells: &[(u64, f64)]) -> LogP {
    let total: u64 = cells.iter().map(|(count, _)| count).sum();
    let free = cells.iter().filter(|(_, probability)| *probability > 0.0).count().saturating_sub(1) as f64;
    let term = |&(count, probability): &(u64, f64)| match count {
        0 => 0.0,
        _ => count as f64 * math::ln(count as f64 / (total as f64 * probability)),
    };
    let t: f64 = cells.iter().map(term).sum();
    if t == f64::INFINITY {
        LogP::ZERO
    } else if t <= free || free == 0.0 {
        LogP::ONE
    } else {
        LogP::of(-t + free * (1.0 + math::ln(t / free)))
    }
}

/// The values of one statistic before the step, after it, and for fresh draws without a step.
pub(super) struct Column {
    pub(super) before: Vec<f64>,
    pub(super) after: Vec<f64>,
    pub(super) fresh: Vec<f64>,
}

/// The strongest evidence, over several tests, that a step changes the law of a statistic, and the test that found it.
/// The second number is how many tests there were.
pub(super) fn compare(column: &Column, cells: usize) -> ((LogP, String), usize) {
    let Column { before, after, fresh } = column;
    let pairs = || before.iter().zip(after);
    let mut sorted = fresh.clone();
    sorted.sort_unstable_by(f64::total_cmp);
    let mut after_sorted = after.clone();
    after_sorted.sort_unstable_by(f64::total_cmp);
    let centre = sorted[sorted.len() / 2];
    let square = |x: f64| math::square(x - centre);

    let mut tests = vec![
        (symmetric(pairs().map(|(x, y)| y - x)), "mean".to_owned()),
        (symmetric(pairs().map(|(x, y)| square(*y) - square(*x))), "spread".to_owned()),
        (same_law(&after_sorted, &sorted), "Kolmogorov–Smirnov".to_owned()),
    ];
    let edges = edges(&sorted, cells);
    let cell = |x: f64| edges.partition_point(|&edge| edge <= x);
    let placed: Vec<_> = pairs().map(|(&x, &y)| (cell(x), cell(y))).filter(|(x, y)| x != y).collect();
    for index in 0..=edges.len() {
        let inside = |cell: usize| f64::from(u8::from(cell == index));
        let low = index.checked_sub(1).map_or(f64::NEG_INFINITY, |below| edges[below]);
        let high = edges.get(index).copied().unwrap_or(f64::INFINITY);
        let p = symmetric(placed.iter().map(|&(x, y)| inside(y) - inside(x)));
        tests.push((p, format!("share in [{low:.4}, {high:.4})")));
    }
    let count = tests.len();
    let strongest = tests.into_iter().min_by(|(p, _), (q, _)| p.ln().total_cmp(&q.ln()));
    (strongest.unwrap_or((LogP::ONE, String::new())), count)
}

/// Edges between cells with equal shares of a sorted sample; if it has few values, edges between all of them.
fn edges(sorted: &[f64], cells: usize) -> Vec<f64> {
    let mut values = Vec::new();
    for &x in sorted {
        if values.last() != Some(&x) {
            values.push(x);
        }
        if values.len() > 2 * cells {
            values = (1..cells).map(|i| sorted[i * sorted.len() / cells]).collect();
            values.dedup();
            break;
        }
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use plaus_dist::{Purpose, Seed, open_unit};

    /// How often `p` of fresh uniform samples is at most 0.01, in 10,000 trials.
    fn alarms(p: impl Fn(&mut dyn FnMut() -> f64) -> LogP) -> usize {
        let streams = Seed(5).chain(0);
        let alarm = |trial| {
            let mut stream = streams.at(trial, Purpose(100));
            p(&mut || open_unit(&mut stream)).value() <= 0.01
        };
        (0..10_000).filter(|&trial| alarm(trial)).count()
    }

    fn sorted(mut values: Vec<f64>) -> Vec<f64> {
        values.sort_unstable_by(f64::total_cmp);
        values
    }

    /// Under the hypothesis p ≤ 0.01 at most once in a hundred: 100 of 10,000, six standard deviations (10) above that
    /// is 160.
    #[test]
    fn p_values_are_not_too_small() {
        assert!(alarms(|unit| symmetric((0..50).map(|_| unit() - unit()))) <= 160);
        assert!(alarms(|unit| multinomial(&thrown(unit, 60))) <= 160);
        let sample = |unit: &mut dyn FnMut() -> f64| sorted((0..500).map(|_| unit()).collect());
        assert!(alarms(|unit| same_law(&sample(unit), &sample(unit))) <= 160);
    }

    /// 60 throws of a die with sides of unequal weight.
    fn thrown(unit: &mut dyn FnMut() -> f64, throws: u32) -> Vec<(u64, f64)> {
        let mut cells = vec![(0, 0.5), (0, 0.3), (0, 0.15), (0, 0.04), (0, 0.01)];
        for _ in 0..throws {
            let u = unit();
            let mut sum = 0.0;
            let side = cells.iter().position(|(_, p)| {
                sum += p;
                u < sum
            });
            cells[side.unwrap_or(4)].0 += 1;
        }
        cells
    }

    #[test]
    fn differences_are_seen() {
        assert!(symmetric((0..100).map(f64::from)).value() < 1e-6);
        let ramp = |shift: f64| (0..1000).map(|i| f64::from(i) / 1000.0 + shift).collect::<Vec<_>>();
        assert!(same_law(&ramp(0.0), &ramp(0.2)).value() < 1e-6);
        assert!(multinomial(&[(900, 0.8), (100, 0.2)]).value() < 1e-6);
        assert_eq!(multinomial(&[(900, 1.0), (1, 0.0)]), LogP::ZERO);
        assert_eq!(LogP::ZERO.to_string(), "0");
        assert_eq!(LogP::of(-2302.585).to_string(), "1e-1000");
    }

    #[test]
    fn ties_are_one_jump() {
        let ones = vec![1.0; 1000];
        assert_eq!(same_law(&ones, &ones), LogP::ONE);
        let mixed: Vec<_> = (0..1000).map(|i| f64::from(i / 500)).collect();
        assert_eq!(same_law(&mixed, &mixed), LogP::ONE);
    }

    #[test]
    fn few_values_get_cells_of_their_own_and_many_share_cells() {
        let few: Vec<_> = (0..1000).map(|i| f64::from(i % 3)).collect();
        assert_eq!(edges(&sorted(few), 4), [0.0, 1.0, 2.0]);
        let many: Vec<_> = (0..1000).map(f64::from).collect();
        assert_eq!(edges(&many, 4), [250.0, 500.0, 750.0]);
    }
}
