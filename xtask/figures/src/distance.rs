//! Distance between laws of outcomes, from samples.

use plaus_dist::{Purpose, Seed, Stream, stream::below};

/// For each reading of a world, the categories of one simulation: one, or one for each body.
pub type Outcome = Vec<Vec<u16>>;

/// Total variation between two samples, and the value that sampling alone would give.
#[derive(Debug, Clone, Copy)]
pub struct Distance {
    /// Total variation between the two samples' frequencies.
    pub found: f64,
    /// Mean of the same between two samples of these sizes from one law, namely both samples together.
    pub noise: f64,
    /// Its 95 % quantile.
    pub most: f64,
}

/// Number of resamplings; noise is then known to about a twentieth.
const RESAMPLED: usize = 200;

impl Distance {
    /// Distance for one reading's categories. Draws are resampled as a whole, because bodies of one draw depend on each
    /// other.
    pub fn between(a: &[Outcome], b: &[Outcome], reading: usize, categories: usize) -> Self {
        let found = variation(&law(a.iter(), reading, categories), &law(b.iter(), reading, categories));
        let pool: Vec<&Outcome> = a.iter().chain(b).collect();
        let mut stream = Seed(5).chain(reading as u64).at(categories as u64, Purpose::START);
        let again = |count: usize, stream: &mut Stream| {
            law((0..count).map(|_| pool[below(stream, pool.len())]), reading, categories)
        };
        let mut by_chance: Vec<f64> =
            (0..RESAMPLED).map(|_| variation(&again(a.len(), &mut stream), &again(b.len(), &mut stream))).collect();
        by_chance.sort_by(f64::total_cmp);
        let noise = by_chance.iter().sum::<f64>() / RESAMPLED as f64;
        Self { found, noise, most: by_chance[RESAMPLED * 19 / 20] }
    }

    /// The distance minus what sampling gives on average.
    pub fn excess(&self) -> f64 {
        (self.found - self.noise).max(0.0)
    }
}

/// Frequencies of the categories.
fn law<'o>(outcomes: impl Iterator<Item = &'o Outcome>, reading: usize, categories: usize) -> Vec<f64> {
    let mut counts = vec![0_u64; categories];
    let mut total = 0_u64;
    for category in outcomes.flat_map(|outcome| &outcome[reading]) {
        counts[usize::from(*category)] += 1;
        total += 1;
    }
    counts.into_iter().map(|count| count as f64 / total.max(1) as f64).collect()
}

fn variation(p: &[f64], q: &[f64]) -> f64 {
    0.5 * p.iter().zip(q).map(|(p, q)| (p - q).abs()).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_law_is_within_noise_and_another_is_not() {
        let mut stream = Seed(1).chain(0).at(0, Purpose::START);
        let mut sample = |sides: usize| -> Vec<Outcome> {
            (0..1000).map(|_| vec![vec![below(&mut stream, sides) as u16]]).collect()
        };
        let (a, b, c) = (sample(6), sample(6), sample(5));
        let same = Distance::between(&a, &b, 0, 6);
        // Three times the mean is beyond what 200 resamplings of six categories ever show.
        assert!(same.found < 3.0 * same.noise && same.noise < same.most, "{same:?}");
        let other = Distance::between(&a, &c, 0, 6);
        // The truth is 1/6, with a deviation of a hundredth or so.
        assert!(other.found > other.most && (other.found - 1.0 / 6.0).abs() < 0.05, "{other:?}");
    }
}
