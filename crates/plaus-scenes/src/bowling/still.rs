//! Bodies that are practically at rest: heaps whose steps of lasting contact never end creep by micrometres.

use glam::DVec3;
use plaus_sim::State;
use plaus_sim::rigid::{Phase, RigidBodyState};

/// Time in s after which a body that has kept to one place counts as at rest. Default 0.25: a body that begins to fall
/// from balance goes e times as far every 0.12 s. Larger values prolong shots that end in heaps; with smaller values a
/// turning point counts as rest.
const WHILE: f64 = 0.25;

/// How far in m the middle, head and foot of a body may move while it still keeps to its place. Default 1e-3.
const SPOT: f64 = 1e-3;

/// Distance in m of head and foot from the middle, for rotations. Default 0.2.
const ARM: f64 = 0.2;

/// Since when each body of a shot has kept to its place.
#[derive(Debug, Clone, Default)]
pub struct Still {
    since: Vec<(f64, DVec3, DVec3)>,
}

impl Still {
    /// Examines the bodies. To be called after each event of a run, on a new one for each run.
    pub fn look(&mut self, state: &State<RigidBodyState>) {
        let time = state.time();
        for (k, body) in state.bodies().iter().enumerate() {
            let axis = body.turn * DVec3::Z;
            // In flight a body has had no event for long, but still moves.
            let now = (time, body.path.at(time), axis);
            match self.since.get_mut(k) {
                None => self.since.push(now),
                Some((_, x, up)) if (*x - now.1).length() + ARM * (*up - axis).length() <= SPOT => {}
                Some(since) => *since = now,
            }
        }
    }

    /// Whether a body has kept to its place for long.
    #[must_use]
    pub fn is_still(&self, k: usize, state: &State<RigidBodyState>) -> bool {
        let (Some((since, ..)), Some(body)) = (self.since.get(k), state.bodies().get(k)) else { return false };
        body.phase != Phase::Waiting && state.time() - since > WHILE
    }
}
