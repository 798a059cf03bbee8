//! What the study needs of a world.

use glam::DVec3;
use plaus_figures::Result;
use plaus_sim::Preset;

/// Which simulator, how exact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Way {
    /// This project's, at a preset.
    Preset(Preset),
    /// rapier3d-f64, with this many steps per second.
    Peer(f64),
}

impl Way {
    /// All ways, the reference first.
    pub(crate) const ALL: [Self; 7] = [
        Self::Preset(Preset::Reference),
        Self::Preset(Preset::Fine),
        Self::Preset(Preset::Standard),
        Self::Preset(Preset::Draft),
        Self::Peer(60.0),
        Self::Peer(240.0),
        Self::Peer(1000.0),
    ];
}

/// A world with random draws, an outcome, and positions to compare.
pub(crate) trait World {
    /// Name of its files.
    fn name(&self) -> &'static str;
    /// Heading of its section.
    fn title(&self) -> &'static str;
    /// What it is, and how far the peer's world is the same.
    fn about(&self) -> &'static str;
    /// How many outcomes there are.
    fn outcomes(&self) -> usize;
    /// Distance between bodies at which they no longer agree, in m.
    fn tolerance(&self) -> f64;
    /// Simulates a draw: which outcome, and how many seconds of computing the simulation alone took.
    fn outcome(&mut self, way: Way, draw: u64) -> Result<(usize, f64)>;
    /// Positions of all bodies at each of `times`.
    fn positions(&mut self, way: Way, draw: u64, times: &[f64]) -> Result<Vec<Vec<DVec3>>>;
}
