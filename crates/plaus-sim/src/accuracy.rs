//! How exact a simulation is: one setting for all tolerances, and the one place that names each of them.
//!
//! | tolerance | unit | draft | standard | fine | reference | usual range | danger | source |
//! | --- | --- | --- | --- | --- | --- | --- | --- | --- |
//! | `settle` | √(g·size) | 1e-1 | 3e-2 | 3e-3 | 3e-4 | 1e-6–1e-1 | large: bounces end early, visibly; small: many more impacts before rest | bounces of relative height `settle²/2` are unseen; convergence: `cargo xtask tradeoff` |
//! | `rattle` | √(size/g) | 1e-3 | 1e-4 | 1e-6 | 1e-9 | 1e-9–1e-2 | large: quick successions of true bounces lose energy; small: a heavy ball on a light one needs millions of events | the t_c model of Luding & McNamara, Granular Matter 1 (1998), after forty in a row, of rigid bodies sixteen |
//! | `step` | √(ρ/g), rolling √((1+k)ρ/g), ρ/speed | 0.7 | 0.4 | 0.1 | 0.02 | 0.002–0.7 | large: lasting contact drifts in phase, error ∝ step²; between the ends of a step centres leave what they touch by up to step³/10 of ρ | second-order scheme, phase error ≈ step²/24 per radian; `tests/marble_truth.rs` |
//! | `sweeps` | count | 20 | 60 | 500 | 1000 | 20–10⁴ | small: stacks sink or creep | Gauss–Seidel; each sweep carries the load one body further, those of marbles are combined (`marbles/relax.rs`) |
//! | `sweep_tolerance` | g·step | 1e-2 | 3e-3 | 1e-6 | 1e-8 | 1e-12–1e-2 | as `sweeps` | change at which sweeps end: no contact is left approaching faster |
//! | `rest_speed` | √(g·size) | 5e-2 | 3e-2 | 3e-3 | 1e-3 | 1e-6–5e-2 | large: a slow body on its way to fall is stopped; static support is always tested first | energy of `rest_speed²/2` of a body height |
//! | `rest_residual` | g·step | 2e-2 | 1e-2 | 1e-3 | 3e-4 | 1e-8–1e-1 | large: slopes steeper than friction allows hold bodies | what a static solution may leave unbalanced |
//! | `slip_turn` | rad | 0.5 | 0.3 | 0.1 | 0.03 | 0.005–0.5 | large: direction of friction within an impact is off, error ∝ turn² | Darboux–Keller steps of third order; where the slip nearly stops, of second (measured against another make: nine in ten impulses within 7e-3, 2.9e-3, 5.4e-4, 4.8e-5) |
//! | `gap` | body size | 1e-4 | 1e-5 | 1e-6 | 1e-8 | 1e-9–1e-3 | large: bodies float; small: more steps of conservative advancement | first contact of rigid bodies; spheres need none |
//! | `crowd` | bodies with faces | 4 | 4 | – | – | 4– | small: impacts in a group are felt at the end of a step, a wave of dominoes is up to 2 % too fast or slow; large: dominoes take five times the time, shards three times | `rigid/island/crowd_step.rs` |
//! | `events` | count per body | 2e4 | 2e4 | 5e4 | 5e5 | 1e2–1e7 | small: long runs end as `OutOfEvents` | a guard; ten marbles need about 40 each |
//!
//! **Which preset to take.** `Standard` for sampling; `Draft` while looking for a scenario that works; `Fine` for a
//! trajectory to be shown; `Reference` only to judge the others. Free flight, bounces, sliding and rolling on planes
//! are exact at every preset. When chaos separates trajectories, the distribution of the outcomes stays the same.
//!
//! The validation report (`docs/validation/accuracy.md`) has the errors of each preset beside truths that are
//! independent of the simulator (`cargo xtask accuracy`), and `docs/validation/peers.md` what draws cost beside other
//! simulators (`cargo xtask tradeoff`).
//!
//! **f32 or f64.** There is only f64. Events are ordered by their times across bodies. An f32 holds a time of 2 s to
//! 2e-7 s, in which a marble at 1 m/s moves by 4e-5 of its radius: contacts would be found too early or too late by
//! more than the presets allow.
//!
//! In `step`, ρ is the radius of curvature of a centre's path, and k is a rolling marble's inertia over m r²: the step
//! is a fraction of a radian of the marble's swing in a bowl.
//!
//! Every length is in units of a body's own size and every time in units of `√(size/g)`, so no tolerance is absolute:
//! the same world at another scale gives the same bits up to the scale.

use crate::error::WorldError;
use serde::{Deserialize, Serialize};

/// A named setting between fast and exact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Preset {
    /// For trying out ideas: contact is coarse.
    Draft,
    /// The default: outcome distributions agree with the reference within sampling noise (see `cargo xtask tradeoff`).
    Standard,
    /// Trajectories agree with the reference to about a thousandth of a radius until chaos separates them.
    Fine,
    /// The standard that the others are compared with.
    Reference,
}

impl Preset {
    /// All presets, fastest first.
    pub const ALL: [Self; 4] = [Self::Draft, Self::Standard, Self::Fine, Self::Reference];

    /// Its name in scenario files and tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Draft => "draft",
            Self::Standard => "standard",
            Self::Fine => "fine",
            Self::Reference => "reference",
        }
    }
}

/// All tolerances; see the table of this module.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Accuracy {
    /// Rebound speed below which a contact lasts, over `√(g·size)·(1 − e)`.
    pub settle: f64,
    /// Time between impacts, over `√(size/g)`, within which many impacts in a row become plastic.
    pub rattle: f64,
    /// Length of a step of lasting contact, over the contact's own time scales.
    pub step: f64,
    /// Maximum number of Gauss–Seidel sweeps per step.
    pub sweeps: u32,
    /// Velocity change over `g·step` at which sweeps end.
    pub sweep_tolerance: f64,
    /// Speed over `√(g·size)` below which static support is tested.
    pub rest_speed: f64,
    /// Velocity over `g·step` that a static solution may leave.
    pub rest_residual: f64,
    /// Largest rotation of the slip within one step of an impact, in radians.
    pub slip_turn: f64,
    /// Gap at which rigid bodies touch, over their size.
    pub gap: f64,
    /// Number of bodies with faces, at least 4, from which meetings within a step are part of it; [`u32::MAX`] for
    /// never.
    pub crowd: u32,
    /// Maximum number of events per body; a run that needs more ends as [`Outcome::OutOfEvents`](crate::Outcome).
    pub events: u64,
}

impl Accuracy {
    /// The tolerances of a preset.
    #[must_use]
    pub const fn preset(preset: Preset) -> Self {
        match preset {
            Preset::Draft => Self {
                settle: 1e-1,
                rattle: 1e-3,
                step: 0.7,
                sweeps: 20,
                sweep_tolerance: 1e-2,
                rest_speed: 5e-2,
                rest_residual: 2e-2,
                slip_turn: 0.5,
                gap: 1e-4,
                crowd: 4,
                events: 20_000,
            },
            Preset::Standard => Self {
                settle: 3e-2,
                rattle: 1e-4,
                step: 0.4,
                sweeps: 60,
                sweep_tolerance: 3e-3,
                rest_speed: 3e-2,
                rest_residual: 1e-2,
                slip_turn: 0.3,
                gap: 1e-5,
                crowd: 4,
                events: 20_000,
            },
            Preset::Fine => Self {
                settle: 3e-3,
                rattle: 1e-6,
                step: 0.1,
                sweeps: 500,
                sweep_tolerance: 1e-6,
                rest_speed: 3e-3,
                rest_residual: 1e-3,
                slip_turn: 0.1,
                gap: 1e-6,
                crowd: u32::MAX,
                events: 50_000,
            },
            Preset::Reference => Self {
                settle: 3e-4,
                rattle: 1e-9,
                step: 0.02,
                sweeps: 1000,
                sweep_tolerance: 1e-8,
                rest_speed: 1e-3,
                rest_residual: 3e-4,
                slip_turn: 0.03,
                gap: 1e-8,
                crowd: u32::MAX,
                events: 500_000,
            },
        }
    }

    /// Whether crowds of bodies with faces take their impacts up in steps.
    pub(crate) const fn takes_crowd_steps(&self) -> bool {
        self.crowd < u32::MAX
    }

    /// Checks every tolerance.
    ///
    /// # Errors
    /// [`WorldError::BadNumber`] naming the first that is not positive and finite.
    pub fn check(&self) -> Result<(), WorldError> {
        let named = [
            ("settle", self.settle),
            ("rattle", self.rattle),
            ("step", self.step),
            ("sweeps", f64::from(self.sweeps)),
            ("sweep_tolerance", self.sweep_tolerance),
            ("rest_speed", self.rest_speed),
            ("rest_residual", self.rest_residual),
            ("slip_turn", self.slip_turn),
            ("gap", self.gap),
            ("crowd", f64::from(self.crowd)),
        ];
        for (field, value) in named {
            if !(value > 0.0 && value.is_finite()) {
                return Err(WorldError::BadNumber { field, value, expected: "a positive tolerance" });
            }
        }
        Ok(())
    }
}

impl Default for Accuracy {
    fn default() -> Self {
        Self::preset(Preset::Standard)
    }
}
