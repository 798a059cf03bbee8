//! What a crowd's step works on: its bodies, and the points at which they touch.

use crate::rigid::solver::contact_constraint::SolverBody;
use crate::rigid::solver::nncg::Nncg;
use glam::{DMat3, DVec3};

/// Work space of a crowd's step.
#[derive(Debug, Default)]
pub(crate) struct Crowd {
    pub(super) points: Vec<CrowdPoint>,
    pub(super) rounds: Nncg,
    /// Rows of the points, in their order: each may be followed by one of resistance.
    pub(super) rows: Vec<usize>,
    pub(super) members: Vec<SolverBody>,
    /// How far each body has turned since the start.
    pub(super) turned: Vec<DMat3>,
    /// How overlaps move bodies: the shift, the turn and the change of angular momentum of each, and the impulse of
    /// each point, in kg m.
    pub(super) shifts: Vec<[DVec3; 3]>,
    pub(super) pushes: Vec<f64>,
    /// How far each body has strayed from the path on which its points were looked for, in m.
    pub(super) strayed: Vec<f64>,
    /// Change of velocity at which rounds end, over the length of the kick, in m/s².
    pub(super) enough: f64,
    /// Energy in J by which shifts have lifted bodies.
    pub(super) lifted: f64,
    /// The largest speed of any body's point at the end of the step, in m/s.
    pub(super) fastest: f64,
    /// Rounds at most in each substep: of impulses, and of shifts.
    pub(super) most: [u32; 2],
}

/// With what a normal turns.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) enum Carrier {
    /// A fixed part.
    #[default]
    Fixed,
    First,
    Second,
    /// The mean of both bodies.
    Both,
    /// It is measured anew: a round skin touches with another point.
    Skin,
}

/// A point of contact in a step.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct CrowdPoint {
    /// Its number among the touches, then among the pairs.
    pub(super) number: usize,
    pub(super) height: f64,
    pub(super) a: usize,
    pub(super) b: Option<usize>,
    pub(super) carrier: Carrier,
    /// To the point half way between the skins, and how far the first body's skin is from the point that it carries.
    pub(super) arms: [DVec3; 2],
    pub(super) rounding: f64,
    pub(super) normal: DVec3,
    pub(super) gap: f64,
    /// The gap that it keeps, and the one up to which it touches, in m.
    pub(super) kept: f64,
    pub(super) near: f64,
    /// Speed in m/s at which it is pushed out of an overlap at most.
    pub(super) push: f64,
    /// Coefficients of friction while it slides, and while it does not; up to which speed in m/s that is; and its last
    /// slip.
    pub(super) frictions: [f64; 2],
    pub(super) still: f64,
    pub(super) slip: DVec3,
    /// Torques along the normal and across it, over the load.
    pub(super) resists: Option<[f64; 2]>,
    pub(super) restitution: f64,
    /// Speed in m/s up to which a rebound lasts.
    pub(super) settles: f64,
    /// The gap now.
    pub(super) now: f64,
    /// The speed in m/s at which it came near at the start of this substep, and whether it bore load before.
    pub(super) approach: f64,
    pub(super) bore: bool,
    /// Speed at which it parts in the next solve, in m/s.
    pub(super) rebound: f64,
    pub(super) strike: Option<Strike>,
    /// Its impulse in N s, and the force in the last substep in N.
    pub(super) total: DVec3,
    pub(super) force: DVec3,
}

/// When a point was first struck, in s from the start of the step, at which speed in m/s, and the sum of its impulses
/// from then on, which turns with its normal.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Strike {
    pub(super) after: f64,
    pub(super) speed: f64,
    pub(super) impulse: DVec3,
}

impl CrowdPoint {
    /// Takes note of the impulse of a solve over `kick` seconds.
    pub(super) fn take(&mut self, impulse: DVec3, kick: f64, time: f64) {
        let bears = impulse != DVec3::ZERO;
        self.rebound = 0.0;
        if bears && !self.bore {
            let parts = self.approach * self.restitution;
            self.rebound = if parts > self.settles { parts } else { 0.0 };
            self.strike = self.strike.or(Some(Strike { after: time, speed: self.approach, impulse: DVec3::ZERO }));
        }
        if let Some(strike) = &mut self.strike {
            strike.impulse += impulse;
        }
        self.bore = bears;
        self.total += impulse;
        self.force = impulse / kick;
    }
}
