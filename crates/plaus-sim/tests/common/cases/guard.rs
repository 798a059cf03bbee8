//! Runs that end in time.

use plaus_sim::rigid::{RigidBodyState, RigidWorld, Start};
use plaus_sim::trace::Observer;
use plaus_sim::{Outcome, Scratch, State};
use std::time::{Duration, Instant};

/// The limits of a run.
#[derive(Debug, Clone, Copy)]
pub struct Guard {
    pub seconds: f64,
    pub events: u64,
}

/// A finished run.
pub struct Went {
    pub state: State<RigidBodyState>,
    pub outcome: Outcome,
    /// Wall-clock time, in s.
    pub wall: f64,
    /// Whether it was cut off.
    pub cut: bool,
}

impl Went {
    /// The text to add to a report: where the run was cut off, and what it took.
    pub fn told(&self) -> String {
        let cut = if self.cut || self.outcome == Outcome::OutOfEvents {
            format!(", CUT at {:.3} s", self.state.time())
        } else {
            String::new()
        };
        format!("{:?}{cut}, {} events, {:.1} ms", self.outcome, self.state.counts().events, 1e3 * self.wall)
    }
}

struct Watchdog<O> {
    then: O,
    until: Instant,
    guard: Guard,
    cut: bool,
}

impl<O: Observer<RigidWorld>> Observer<RigidWorld> for Watchdog<O> {
    fn impact(&mut self, impact: &plaus_sim::mechanics::Impact) {
        self.then.impact(impact);
    }

    fn motion(&mut self, index: usize, body: &RigidBodyState) {
        self.then.motion(index, body);
    }

    #[allow(clippy::disallowed_methods, reason = "the wall's clock decides only when to give up")]
    fn proceed(&mut self, state: &State<RigidBodyState>) -> bool {
        self.cut = state.counts().events >= self.guard.events || Instant::now() > self.until;
        !self.cut && self.then.proceed(state)
    }
}

/// Runs a world from `starts` to `until`, or until the guard cuts it off.
#[allow(clippy::disallowed_methods, reason = "it measures time")]
pub fn go(world: &RigidWorld, starts: &[Start], until: f64, guard: Guard, observer: impl Observer<RigidWorld>) -> Went {
    let mut state = world.state(starts).expect("starts of these cases are sound");
    let clock = Instant::now();
    let end = clock + Duration::from_secs_f64(guard.seconds);
    let mut watchdog = Watchdog { then: observer, until: end, guard, cut: false };
    let outcome = world.run(&mut state, &mut Scratch::default(), until, &mut watchdog).expect("no tables, no faults");
    Went { state, outcome, wall: clock.elapsed().as_secs_f64(), cut: watchdog.cut }
}
