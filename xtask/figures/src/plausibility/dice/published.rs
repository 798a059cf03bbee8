//! Rolls of real cuboids.

use crate::plausibility::chance::Count;

/// A cuboid x × y × y that was rolled.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rolled {
    /// Edge x over edge y.
    pub(super) ratio: f64,
    /// How often a square face was uppermost.
    pub(super) square: Count,
}

/// Edge x over y, share of rolls with a square face uppermost, number of rolls: table 1 of "97.16 Probability analysis
/// for rolls of a square cuboidal die", The Mathematical Gazette, March 2013. Fifteen cuboids were cut out of a steel
/// bar and rolled by students. The article does not say how they were rolled, or onto what.
const TABLE: [(f64, f64, u64); 15] = [
    (0.47, 0.916, 332),
    (0.63, 0.738, 840),
    (0.75, 0.548, 799),
    (0.81, 0.496, 740),
    (0.93, 0.399, 516),
    (0.97, 0.385, 530),
    (1.16, 0.148, 1011),
    (1.23, 0.154, 532),
    (1.44, 0.052, 654),
    (1.55, 0.040, 606),
    (1.60, 0.017, 702),
    (1.71, 0.031, 609),
    (1.87, 0.009, 680),
    (2.12, 0.007, 275),
    (2.65, 0.006, 503),
];

/// Cuboids by which the conditions of the throw may be chosen; the others are held out.
pub(super) const CHOSEN_BY: [f64; 7] = [0.47, 0.75, 0.93, 1.16, 1.44, 1.60, 1.87];

impl Rolled {
    pub(super) fn all() -> Vec<Self> {
        TABLE.map(|(ratio, share, rolls)| Self { ratio, square: Count::of_share(share, rolls) }).to_vec()
    }

    pub(super) fn is_held_out(&self) -> bool {
        !CHOSEN_BY.contains(&self.ratio)
    }
}
