//! How solutions look: what a person sees of them, and how different that is.

use serde::{Deserialize, Serialize};

/// How a viewer sees a solution: numbers whose distance says how different two of them look.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Look {
    /// A number for the values with which its motion begins: of solutions that have it in common only one counts.
    /// `None`: nothing is known of them.
    pub release: Option<u64>,
    /// Points in a space of `width` dimensions, one for each thing that is seen; as many in all solutions. Empty: the
    /// solution looks different from every other.
    pub seen: Vec<f32>,
    /// The number of dimensions.
    pub width: u32,
}

impl Look {
    /// The distance to another: that of the thing that differs most. From 1 on they are clearly different. It obeys the
    /// triangle inequality.
    #[must_use]
    pub fn distance(&self, other: &Self) -> f64 {
        if self.seen.is_empty() || other.seen.is_empty() {
            return f64::INFINITY;
        }
        let width = (self.width as usize).max(1);
        let things = self.seen.chunks(width).zip(other.seen.chunks(width));
        let squared =
            |(a, b): (&[f32], &[f32])| a.iter().zip(b).map(|(a, b)| f64::from((a - b) * (a - b))).sum::<f64>();
        things.map(squared).fold(0.0, f64::max).sqrt()
    }
}
