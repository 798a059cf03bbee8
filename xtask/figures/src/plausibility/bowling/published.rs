//! What is published about first balls.

use super::roll::Leave;
use crate::plausibility::chance::Count;

/// First balls of right- and left-handers at the Professional Bowlers Association's finals on television, 2005 to 2010.
pub(super) const FIRST_BALLS: u64 = 7_155;

/// The share of these that were strikes.
pub(super) const STRIKES: f64 = 0.611;

/// The shares that left exactly these pins.
const LEAVES: [(&[u16], f64); 6] =
    [(&[10], 0.099), (&[7], 0.047), (&[9], 0.012), (&[7, 10], 0.0074), (&[3, 10], 0.0049), (&[4, 6, 7, 10], 0.0042)];

/// Range of boards on which a ball that enters at 6° nearly always strikes: from, to.
pub(super) const WINDOW: (f64, f64) = (17.0, 18.5);

/// The best line: board, and angle of entry in degrees.
pub(super) const BEST: (f64, f64) = (17.5, 6.0);

/// The largest number of boards on which a straight ball strikes nine times in ten.
pub(super) const STRAIGHT: f64 = 0.5;

/// Nine strikes in ten.
pub(super) const OFTEN: f64 = 0.9;

/// Leaves and how often they were left.
pub(super) fn leaves() -> Vec<(Leave, Count)> {
    LEAVES.map(|(pins, share)| (Leave::of_pins(pins), Count::of_share(share, FIRST_BALLS))).to_vec()
}
