//! Bodies that are practically at rest: heaps whose steps of lasting contact never end creep by micrometres.

use crate::rigid::{Phase, Turning};
use crate::state::State;
use glam::DVec3;

/// How long in s a body has kept to one place from when on it counts as at rest. Default 0.25: what begins to fall from
/// a balance goes e times as far every 0.12 s. Larger values make shots longer that end in heaps; smaller ones take a
/// turning point for rest.
const WHILE: f64 = 0.25;

/// How far in m a body's middle may move, and head or foot with it, that keeps to its place. Default 1e-3.
const SPOT: f64 = 1e-3;

/// Distance in m of head and foot from the middle, for turns. Default 0.2.
const ARM: f64 = 0.2;

/// Since when each body of a shot has kept to its place.
#[derive(Debug, Clone, Default)]
pub struct Still {
    since: Vec<(f64, DVec3, DVec3)>,
}

impl Still {
    /// Looks at the bodies. To be called after each event of a run; a new one for each run.
    pub fn look(&mut self, state: &State<Turning>) {
        let time = state.time();
        for (k, body) in state.bodies().iter().enumerate() {
            let axis = body.turn * DVec3::Z;
            // In flight it has had no event for long, and moves all the same.
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
    pub fn is_still(&self, k: usize, state: &State<Turning>) -> bool {
        let (Some((since, ..)), Some(body)) = (self.since.get(k), state.bodies().get(k)) else { return false };
        body.phase != Phase::Waiting && state.time() - since > WHILE
    }
}
