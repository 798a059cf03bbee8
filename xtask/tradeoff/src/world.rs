//! What the study needs of a world.

use glam::DVec3;
use plaus_figures::Result;
pub(crate) use plaus_figures::distance::Outcome;
use plaus_sim::Preset;

/// Which simulator, and how exact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Way {
    /// This project's, at a preset.
    Preset(Preset),
    /// rapier3d-f64, with this many steps per second.
    Peer(f64),
}

impl Way {
    pub(crate) const REFERENCE: Self = Self::Preset(Preset::Reference);
    pub(crate) const STANDARD: Self = Self::Preset(Preset::Standard);

    pub(crate) fn name(self) -> String {
        match self {
            Self::Preset(preset) => format!("plaus-sim, {}", preset.name()),
            Self::Peer(rate) => format!("rapier3d-f64, 1/{rate}"),
        }
    }
}

/// Positions of all bodies at one time; `None` for a body that has left the world.
pub(crate) type Places = Vec<Option<DVec3>>;

/// Something that is read from the end of a simulation.
pub(crate) struct Reading {
    pub(crate) name: &'static str,
    /// How many categories it has.
    pub(crate) categories: usize,
}

/// A world with random draws, outcomes, and positions to compare.
pub(crate) trait World {
    /// Name of its files, and of the world on the command line.
    fn name(&self) -> &'static str;
    /// Heading of its section.
    fn title(&self) -> &'static str;
    /// What it is, what is timed, and how far the peer's world is the same.
    fn about(&self) -> String;
    /// What is read from an outcome.
    fn readings(&self) -> Vec<Reading>;
    /// Distance between bodies at which they no longer agree, in m.
    fn tolerance(&self) -> f64;
    /// This world's share of each simulator's seconds, relative to other worlds.
    fn patience(&self) -> f64 {
        1.0
    }
    /// Simulates a draw to its end. Returns the outcome, and the seconds of computing that the simulation alone took.
    fn outcome(&mut self, way: Way, draw: u64) -> Result<(Outcome, f64)>;
    /// Places of all bodies at each of `times`, which are multiples of every peer's step.
    fn places(&mut self, way: Way, draw: u64, times: &[f64]) -> Result<Vec<Places>>;
}
