//! Random worlds of two to four bodies, of every pair of shapes and every way to say a shape, under laws that hold for
//! all of them. A world follows from a law, a seed and a preset. `tests/laws_worlds.rs` examines a fixed few, and
//! `cargo xtask fuzz-worlds` as many as there is time for.
//!
//! The laws' numbers come from closed forms, from the presets' own table, or from what a change of the start by a
//! preset's gap does. Overlaps are judged by [`exact`], which shares nothing with the simulator. Each law has a wrong
//! twin, which it must refuse.
#![allow(dead_code, unreachable_pub)]

pub mod exact;
pub mod form;
pub mod frames;
pub mod held;
pub mod meet;
pub mod run;
pub mod scenario;
pub mod seams;
pub mod world;

use plaus_sim::Preset;
use world::World;

/// A law that holds for all worlds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Law {
    /// Nothing passes through anything, looked at on the way too: overlaps stay below a tenth of the size.
    Through,
    /// At the ends of motions, overlaps stay below a few of the preset's gaps; where an event interrupts a step, also
    /// below what the step's path bends.
    Overlap,
    /// No run needs too many events, and no motion is not finite.
    Ends,
    /// Energy never grows.
    Energy,
    /// Two bodies in space keep their momentum.
    Momentum,
    /// What is dropped on a support that holds its centre of gravity stays on it, at the right height.
    Held,
    /// What slides over a seam of flush parts comes to rest after `v²/(2 µ g)`.
    Seams,
    /// A translation, a turn about the vertical and another order of bodies and parts change nothing but rounding.
    Frames,
    /// A fixed box is the same however it is said.
    Sayings,
    /// `reference` is at least as near to a closed form as `fine`, and that as `standard`.
    Presets,
}

impl Law {
    pub const ALL: [Self; 10] = [
        Self::Through,
        Self::Overlap,
        Self::Ends,
        Self::Energy,
        Self::Momentum,
        Self::Held,
        Self::Seams,
        Self::Frames,
        Self::Sayings,
        Self::Presets,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Through => "through",
            Self::Overlap => "overlap",
            Self::Ends => "ends",
            Self::Energy => "energy",
            Self::Momentum => "momentum",
            Self::Held => "held",
            Self::Seams => "seams",
            Self::Frames => "frames",
            Self::Sayings => "sayings",
            Self::Presets => "presets",
        }
    }

    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|l| l.name() == name)
    }

    /// The world of a seed, without running it; of several that are compared, the first.
    pub fn world(self, seed: u64, preset: Preset) -> World {
        match self {
            Self::Through | Self::Overlap | Self::Ends | Self::Energy => meet::meeting(seed, preset),
            Self::Momentum => meet::in_space(seed, preset),
            Self::Held => held::drop(seed, preset).world,
            Self::Seams => seams::slide(seed, preset).world,
            Self::Presets => seams::plain(seed, preset).world,
            Self::Frames => frames::moved(seed, preset).0,
            Self::Sayings => frames::said(seed, preset).0,
        }
    }

    /// Examines the world of a seed. `None` if its bodies overlap at the start, or if its motion depends so much on its
    /// start that there is nothing to compare.
    pub fn examine(self, seed: u64, preset: Preset) -> Option<Verdict> {
        match self {
            Self::Through => meet::through(seed, preset),
            Self::Overlap => meet::overlap(seed, preset),
            Self::Ends => meet::ends(seed, preset),
            Self::Energy => meet::energy_holds(seed, preset),
            Self::Momentum => meet::momentum_holds(seed, preset),
            Self::Held => held::examine(seed, preset),
            Self::Seams => seams::examine(seed, preset),
            Self::Presets => seams::order(seed, preset),
            Self::Frames => frames::examine(seed, preset),
            Self::Sayings => frames::examine_sayings(seed, preset),
        }
    }
}

/// What a law makes of a world.
#[derive(Debug, Clone)]
pub struct Verdict {
    /// How far off, in units of what is allowed: a breach above 1.
    pub worst: f64,
    /// What was found, with numbers.
    pub found: String,
    /// Whether the wrong twin was refused; none if the run has nothing that could be wrong.
    pub twin: Option<bool>,
    /// The world that repeats it.
    pub world: World,
}

impl Verdict {
    pub fn is_breach(&self) -> bool {
        self.worst.is_nan() || self.worst > 1.0
    }
}
