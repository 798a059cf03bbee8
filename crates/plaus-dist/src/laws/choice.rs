//! One of several numbers.

use crate::number::as_number_law;
use crate::param::{LARGEST, ParamError};
use crate::{Density, LogDensity, NotANumber, Sample, Stream, math, open_unit};

/// One of some values, each with its weight.
///
/// The density of a value is its probability, weight over the sum of weights; it is 0 everywhere else.
///
/// ```
/// use plaus_dist::{Choice, Density};
/// let gear = Choice::new(&[1.0, 2.5, 4.0], &[1.0, 1.0, 2.0])?;
/// assert!((gear.log_density(&4.0)?.value() - 0.5_f64.ln()).abs() < 1e-15);
/// assert!(gear.log_density(&3.0)?.is_zero());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// In ascending order.
    values: Vec<f64>,
    log_chances: Vec<f64>,
    /// Probability that the value is this one or one before it; ends with 1.
    cumulative: Vec<f64>,
}

const NAME: &str = "choice";

impl Choice {
    /// Each of `values`, all different, with its weight above 0; without weights, all are equal.
    ///
    /// # Errors
    /// [`ParamError`] for no values, values that are equal or not within ±1e300, and weights that are not from 1e-100
    /// to 1e100, or not as many as values.
    pub fn new(values: &[f64], weights: &[f64]) -> Result<Self, ParamError> {
        let count = values.len() as f64;
        ParamError::unless(!values.is_empty(), NAME, "number of values", count, "at least 1")?;
        let fits = weights.is_empty() || weights.len() == values.len();
        ParamError::unless(fits, NAME, "number of weights", weights.len() as f64, "the number of values")?;
        let mut pairs: Vec<[f64; 2]> = Vec::with_capacity(values.len());
        for (place, &value) in values.iter().enumerate() {
            ParamError::unless(value.abs() <= LARGEST, NAME, "value", value, "from -1e300 to 1e300")?;
            let weight = weights.get(place).copied().unwrap_or(1.0);
            ParamError::unless((1e-100..=1e100).contains(&weight), NAME, "weight", weight, "from 1e-100 to 1e100")?;
            // So that 0 and −0 are one value.
            pairs.push([value + 0.0, weight]);
        }
        pairs.sort_by(|a, b| a[0].total_cmp(&b[0]));
        if let Some(twice) = pairs.windows(2).find(|pair| pair[0][0] == pair[1][0]) {
            return Err(ParamError {
                distribution: NAME,
                parameter: "value",
                value: twice[0][0],
                allowed: "given once",
            });
        }
        let sum: f64 = pairs.iter().map(|pair| pair[1]).sum();
        let mut so_far = 0.0;
        let mut cumulative: Vec<f64> = pairs
            .iter()
            .map(|pair| {
                so_far += pair[1];
                so_far / sum
            })
            .collect();
        if let Some(last) = cumulative.last_mut() {
            *last = 1.0;
        }
        let log_chances = pairs.iter().map(|pair| math::ln(pair[1] / sum)).collect();
        Ok(Self { values: pairs.iter().map(|pair| pair[0]).collect(), log_chances, cumulative })
    }

    /// The values, in ascending order.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The index of a value.
    fn place(&self, x: f64) -> Option<usize> {
        self.values.binary_search_by(|value| value.total_cmp(&(x + 0.0))).ok()
    }
}

impl Density<f64> for Choice {
    /// # Errors
    /// [`NotANumber`] if `x` is NaN.
    fn log_density(&self, x: &f64) -> Result<LogDensity, NotANumber> {
        if x.is_nan() {
            return LogDensity::new(*x);
        }
        self.place(*x).map_or(Ok(LogDensity::ZERO), |place| LogDensity::new(self.log_chances[place]))
    }
}

impl Sample for Choice {
    type Value = f64;
    fn sample(&self, stream: &mut Stream) -> f64 {
        let u = open_unit(stream);
        let place = self.cumulative.partition_point(|&bound| bound <= u);
        self.values[place.min(self.values.len() - 1)]
    }
}

as_number_law!(Choice {
    fn support(&self) -> [f64; 2] {
        [self.values[0], self.values[self.values.len() - 1]]
    }

    fn is_continuous(&self) -> bool {
        false
    }

    /// In indices of the list.
    fn width(&self) -> f64 {
        self.values.len() as f64
    }

    /// Moves this many places up the list, whose ends are joined.
    fn step(&self, x: f64, by: f64) -> f64 {
        let Some(place) = self.place(x).filter(|_| by.is_finite()) else { return x };
        let count = self.values.len() as f64;
        // The remainder is exact, and rounding away from 0 at halves keeps steps symmetric.
        let to = (place as f64 + (by % count).round()).rem_euclid(count);
        self.values[(to as usize).min(self.values.len() - 1)]
    }
});

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NumberLaw;
    use crate::standard_normal;
    use crate::testing::{Z_LIMIT, draws, stream, z_score};

    fn gear() -> Choice {
        Choice::new(&[4.0, -0.0, 2.5], &[5.0, 2.0, 3.0]).unwrap()
    }

    #[test]
    fn values_come_as_often_as_their_weights_say() {
        for (value, chance) in [(0.0, 0.2), (2.5, 0.3), (4.0, 0.5_f64)] {
            let share = |chance: f64| {
                let hits = draws(&gear(), 100_000, 15).into_iter().map(|x| f64::from(u8::from(x == value)));
                z_score(hits, chance, (chance * (1.0 - chance)).sqrt()).abs()
            };
            assert!(share(chance) < Z_LIMIT && share(chance + 0.02) > Z_LIMIT);
            assert!((gear().log_density(&value).unwrap().value() - math::ln(chance)).abs() < 1e-15);
        }
    }

    /// Every step is as likely as the one back.
    #[test]
    fn steps_are_symmetric() {
        let (law, mut stream) = (gear(), stream(16));
        let mut counts = [[0_i32; 3]; 3];
        for _ in 0..60_000 {
            for (from, &x) in law.values().iter().enumerate() {
                let to = law.place(law.step(x, 0.6 * standard_normal(&mut stream))).unwrap();
                counts[from][to] += 1;
            }
        }
        for (a, b) in [(0, 1), (1, 2), (0, 2)] {
            let (there, back) = (f64::from(counts[a][b]), f64::from(counts[b][a]));
            assert!((there - back).abs() < Z_LIMIT * (there + back).sqrt() && there > 1000.0, "{counts:?}");
        }
    }

    #[test]
    fn bad_numbers_are_refused() {
        let bad: [(&[f64], &[f64]); 6] = [
            (&[], &[]),
            (&[1.0, 1.0], &[]),
            (&[0.0, -0.0], &[]),
            (&[1.0], &[1.0, 2.0]),
            (&[f64::NAN], &[]),
            (&[1.0], &[0.0]),
        ];
        for (values, weights) in bad {
            assert!(Choice::new(values, weights).is_err(), "{values:?}");
        }
        assert!(gear().log_density(&f64::NAN).is_err() && gear().log_density(&1.0).unwrap().is_zero());
        assert_eq!(gear().step(7.0, 1.0), 7.0);
    }

    #[test]
    fn values_are_pinned() {
        assert_eq!(draws(&gear(), 4, 1), [2.5, 0.0, 0.0, 4.0]);
    }
}
