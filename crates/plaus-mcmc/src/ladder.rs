//! Inverse temperatures between the prior and the target, and how to space them.

use plaus_dist::ParamError;
use serde::{Deserialize, Serialize};

/// Ascending inverse temperatures from 0, the prior, to 1, the target; or the target's alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<f64>", into = "Vec<f64>")]
pub struct Ladder(Vec<f64>);

impl TryFrom<Vec<f64>> for Ladder {
    type Error = ParamError;
    fn try_from(betas: Vec<f64>) -> Result<Self, ParamError> {
        Self::new(betas)
    }
}

impl From<Ladder> for Vec<f64> {
    fn from(ladder: Ladder) -> Self {
        ladder.0
    }
}

/// Most rungs that a ladder may have, whether it is sized by itself or set.
pub const MOST_RUNGS: usize = 256;

/// At least this part of the barrier lies between any two neighbours, so that rungs between which no swap was rejected
/// stay apart.
const LEAST: f64 = 1e-3;

impl Ladder {
    /// A ladder of these inverse temperatures.
    ///
    /// # Errors
    /// [`ParamError`] unless they ascend strictly from 0 to 1, or are 1 alone.
    pub fn new(betas: Vec<f64>) -> Result<Self, ParamError> {
        let ascends = betas.windows(2).all(|pair| pair[0] < pair[1]);
        let ends = betas.first() == Some(&0.0) && betas.last() == Some(&1.0);
        let alone = betas == [1.0];
        if ascends && ends || alone {
            return Ok(Self(betas));
        }
        let value = betas.windows(2).find(|pair| pair[0] >= pair[1]).map_or(f64::NAN, |pair| pair[1]);
        Err(ParamError { distribution: "Ladder", parameter: "betas", value, allowed: "strictly ascending from 0 to 1" })
    }

    /// `rungs` inverse temperatures, at least 2, equally spaced.
    #[must_use]
    pub fn even(rungs: usize) -> Self {
        let steps = rungs.max(2) - 1;
        Self((0..=steps).map(|k| k as f64 / steps as f64).collect())
    }

    /// The target alone, without a ladder.
    #[must_use]
    pub fn single() -> Self {
        Self(vec![1.0])
    }

    /// The inverse temperatures.
    #[must_use]
    pub fn betas(&self) -> &[f64] {
        &self.0
    }

    /// The barrier Λ: the sum of the shares of swaps rejected between neighbours. With enough rungs it hardly depends
    /// on their number. At best, states come down and up again about once in `2 + 2 Λ` rounds, for which about `2 Λ +
    /// 1` rungs are needed (Syed, Bouchard-Côté, Deligiannidis & Doucet, "Non-reversible parallel tempering", JRSS B
    /// 84, 2022).
    #[must_use]
    pub fn barrier(rejected: &[f64]) -> f64 {
        rejected.iter().sum()
    }

    /// The number of rungs that suits a barrier: `2 Λ + 1`, rounded, at least 2 and at most [`MOST_RUNGS`].
    #[must_use]
    pub fn best_rungs(barrier: f64) -> usize {
        // A barrier is finite: a sum of shares.
        ((2.0 * barrier).round() as usize + 1).clamp(2, MOST_RUNGS)
    }

    /// A ladder of `rungs` rungs that would divide the barrier equally. `rejected` holds the share of swaps rejected
    /// between each rung and the next: each is between 0 and 1, and there is one fewer than rungs. The barrier is
    /// assumed to grow evenly from rung to rung.
    #[must_use]
    pub fn adapted(&self, rejected: &[f64], rungs: usize) -> Self {
        let steps = rungs.max(2) - 1;
        let mut height = vec![0.0];
        for k in 0..self.0.len() - 1 {
            let seen = rejected.get(k).copied().unwrap_or(0.0).clamp(0.0, 1.0);
            height.push(height[k] + seen + LEAST * (self.0[k + 1] - self.0[k]));
        }
        let whole = height[height.len() - 1];
        let at = |goal: f64| {
            let above = height.partition_point(|&h| h <= goal).clamp(1, height.len() - 1);
            let part = (goal - height[above - 1]) / (height[above] - height[above - 1]);
            self.0[above - 1] + part * (self.0[above] - self.0[above - 1])
        };
        let betas: Vec<f64> =
            (0..=steps).map(|k| if k == steps { 1.0 } else { at(whole * k as f64 / steps as f64) }).collect();
        // Rounding can make two rungs equal only if they were hardly apart.
        Self::new(betas).unwrap_or_else(|_| Self::even(rungs))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ladders_ascend_from_0_to_1() {
        assert_eq!(Ladder::even(5).betas(), [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(Ladder::even(0).betas(), [0.0, 1.0]);
        for bad in
            [vec![], vec![0.0], vec![0.0, 0.5], vec![0.1, 1.0], vec![0.0, 0.5, 0.5, 1.0], vec![0.0, f64::NAN, 1.0]]
        {
            assert!(Ladder::new(bad.clone()).is_err(), "{bad:?}");
        }
        assert!(serde_json::from_str::<Ladder>("[0.0, 0.7, 1.0]").is_ok());
        assert!(serde_json::from_str::<Ladder>("[0.0, 0.7]").is_err());
    }

    #[test]
    fn an_adapted_ladder_shares_the_barrier() {
        // All of the barrier is between 0 and ½, so the rungs go there.
        let adapted = Ladder::even(3).adapted(&[0.8, 0.0], 5);
        assert!(adapted.betas()[3] < 0.5 && adapted.betas()[1] > 0.1, "{adapted:?}");
        // The shares are equal, so the ladder stays.
        let even = Ladder::even(4).adapted(&[0.3, 0.3, 0.3], 4);
        assert!(even.betas().iter().zip(Ladder::even(4).betas()).all(|(a, b)| (a - b).abs() < 1e-12), "{even:?}");
        // Nothing was ever rejected, so the rungs are spaced evenly.
        assert_eq!(Ladder::even(3).adapted(&[0.0, 0.0], 3).betas(), [0.0, 0.5, 1.0]);
    }
}
