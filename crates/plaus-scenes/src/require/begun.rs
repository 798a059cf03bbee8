//! What a simulation that has not ended shows of its motion.

use crate::animation::Motion;

/// The beginning of a motion, as a simulation shows it that has not ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Begun {
    /// The motion. What it shows of later times may still change.
    pub motion: Motion,
    /// Places and impacts are known before this time, in s.
    pub known: f64,
    /// Orientations and spins are known before this time, in s.
    pub turns: f64,
    /// Lasting contacts are known before this time, in s.
    pub contacts: f64,
}
