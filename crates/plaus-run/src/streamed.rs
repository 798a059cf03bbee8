//! Mean and standard deviation of more draws than fit in memory; each draw is read once.

/// Count, mean and sum of squared differences from the mean, of values that come one after the other (Welford 1962).
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Moments {
    count: f64,
    mean: f64,
    squares: f64,
}

impl Moments {
    /// Adds a value that occurred `times` times.
    pub(crate) fn note(&mut self, value: f64, times: u64) {
        self.join(&Self { count: times as f64, mean: value, squares: 0.0 });
    }

    /// Adds the values that another one has counted (Chan, Golub & LeVeque 1979).
    pub(crate) fn join(&mut self, other: &Self) {
        if other.count == 0.0 {
            return;
        }
        let count = self.count + other.count;
        let (apart, share) = (other.mean - self.mean, other.count / count);
        self.squares += other.squares + apart * apart * self.count * share;
        self.mean += apart * share;
        self.count = count;
    }

    pub(crate) fn mean(&self) -> f64 {
        self.mean
    }

    /// Standard deviation over n − 1; `None` for fewer than two values.
    pub(crate) fn sd(&self) -> Option<f64> {
        (self.count > 1.0).then(|| (self.squares / (self.count - 1.0)).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_and_repeats_come_to_what_all_values_do() {
        let values: Vec<f64> = (0..1000).map(|i| 1e6 + f64::from((i * 37) % 101)).collect();
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let sd = (values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (n - 1.0)).sqrt();
        let mut all = Moments::default();
        for part in values.chunks(17) {
            let mut of_part = Moments::default();
            part.iter().for_each(|&value| of_part.note(value, 1));
            all.join(&of_part);
        }
        // Some n roundings of numbers of this size.
        let tolerance = n * f64::EPSILON;
        assert!((all.mean() / mean - 1.0).abs() < tolerance);
        assert!((all.sd().unwrap_or(0.0) / sd - 1.0).abs() < 1e6 * tolerance, "squares lose what the offset has");
        let mut repeated = Moments::default();
        repeated.note(3.0, 4);
        repeated.note(5.0, 4);
        assert_eq!((repeated.mean(), repeated.squares), (4.0, 8.0));
        assert!(Moments::default().sd().is_none());
    }
}
