//! How runs end.

use crate::mechanics::Other;

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Outcome {
    /// The time asked for was reached.
    TimeReached,
    /// Every body is at rest: nothing will ever happen again.
    AllAtRest,
    /// The observer asked to stop, or another thread did, see [`interruptible`](crate::interruptible).
    Stopped,
    /// The event budget was spent: as many events for each body as the accuracy allows, of bodies alone or of groups
    /// whose members all take a new motion. The state is the one at that time.
    OutOfEvents,
    /// A body's motion is no longer finite, at the state's time. The state is kept as it is, for replay; the observer
    /// has not seen that motion.
    NotFinite {
        /// Index of the body.
        body: usize,
        /// What it touched last: what it met in that event, or is in lasting contact with, if anything.
        touched: Option<Other>,
    },
    /// A driven body left a body no way out and is in it (or their joint is open) by a hundredth of the smaller size.
    Crushed {
        /// Index of the body.
        body: usize,
        /// Index of the driven body.
        by: usize,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::links::Links;
    use crate::mechanics::{ContactForce, Impact, Island, Mechanics, Meeting};
    use crate::scenery::{Aabb, Surface};
    use crate::simulate::{Scratch, simulate};
    use crate::state::State;
    use crate::trace::Trace;
    use glam::DVec3;

    /// A point on a line, at `x` at the time `t`.
    #[derive(Debug, Clone)]
    struct Point {
        t: f64,
        x: f64,
        v: f64,
        touches: Vec<Surface>,
    }

    /// Points that lose all sense as they meet each other, a wall at 1, or time `breaks`.
    struct Points {
        breaks: f64,
    }

    const WALL: Surface = Surface::Plane(3);

    impl Mechanics for Points {
        type Body = Point;
        type Scratch = ();

        fn len(&self) -> usize {
            3
        }
        fn duration(&self) -> f64 {
            10.0
        }
        fn event_budget(&self) -> u64 {
            100
        }
        fn clock(&self, body: &Point) -> f64 {
            body.t
        }
        fn expiry(&self, body: &Point) -> f64 {
            if body.t < self.breaks { self.breaks } else { f64::MAX }
        }
        fn is_present(&self, _: &Point) -> bool {
            true
        }
        fn is_resting(&self, _: &Point) -> bool {
            false
        }
        fn is_finite(&self, body: &Point) -> bool {
            body.x.is_finite()
        }
        fn advance(&self, _: usize, body: &mut Point, time: f64) {
            (body.x, body.t) = (body.x + body.v * (time - body.t), time);
        }
        fn swept(&self, _: usize, _: &Point, _: f64, _: f64) -> Aabb {
            Aabb::around([DVec3::splat(-1e3), DVec3::splat(1e3)])
        }
        fn first_surface(&self, _: usize, body: &Point, until: f64) -> Option<(f64, Surface)> {
            let time = body.t + (1.0 - body.x) / body.v;
            (body.v > 0.0 && body.x < 1.0 && time <= until).then_some((time, WALL))
        }
        fn first_meeting(&self, _: [usize; 2], [a, b]: [&Point; 2], from: f64, until: f64) -> Option<f64> {
            let time = ((b.x - b.v * b.t) - (a.x - a.v * a.t)) / (a.v - b.v);
            (time > from && time <= until).then_some(time)
        }
        fn hit_surface(&self, _: usize, body: &mut Point, _: Surface, _: &mut dyn FnMut(&Impact)) -> bool {
            body.x = f64::NAN;
            true
        }
        fn hit_body(
            &self,
            _: [usize; 2],
            [a, _]: [&mut Point; 2],
            _: bool,
            _: &mut dyn FnMut(&Impact),
        ) -> Option<bool> {
            a.x = f64::INFINITY;
            Some(false)
        }
        fn strikes(&self, _: [usize; 2], [a, b]: [&Point; 2], _: bool, _: f64) -> bool {
            a.v > b.v
        }
        fn strikes_surfaces(&self, _: usize, _: &mut Point, _: &mut dyn FnMut(Surface)) {}
        fn hit_at_once(&self, _: &[Meeting], _: &mut [Point], _: &mut Links, _: &mut dyn FnMut(&Impact)) -> bool {
            false
        }
        fn contact_forces(&self, _: &Island<'_, Self>, (): &mut (), _: &mut dyn FnMut(&ContactForce)) {}
        fn contacts<'b>(&self, body: &'b Point) -> &'b [Surface] {
            &body.touches
        }
        fn settle(&self, members: &[u32], bodies: &mut [Point], _: &mut Links, (): &mut ()) {
            for &k in members {
                let body = &mut bodies[k as usize];
                if body.t >= self.breaks {
                    body.x = f64::NAN;
                }
            }
        }
    }

    /// The run ends at the time at which a motion is no longer finite, and names the body and what it met; where it met
    /// nothing then, what it is linked to, or what it touches. No listener sees such a motion.
    #[test]
    fn what_a_body_touched_last_is_named() {
        let at = |x: f64, v: f64| Point { t: 0.0, x, v, touches: Vec::new() };
        let far = || at(-500.0, 0.0);
        let held = Point { touches: vec![WALL, Surface::Plane(4)], ..at(0.0, 0.0) };
        for (bodies, link, breaks, body, touched, time) in [
            ([at(-2.0, 1.0), at(0.0, 0.0), far()], None, 20.0, 0, Some(Other::Body(1)), 2.0),
            ([far(), at(0.0, 0.5), far()], None, 20.0, 1, Some(Other::Surface(WALL)), 2.0),
            ([far(), at(0.0, 0.0), far()], None, 3.0, 0, None, 3.0),
            ([held.clone(), far(), far()], None, 3.0, 0, Some(Other::Surface(WALL)), 3.0),
            ([held, far(), far()], Some([0, 2]), 3.0, 0, Some(Other::Body(2)), 3.0),
        ] {
            let mut state = State::new(bodies.to_vec());
            if let Some([a, b]) = link {
                state.links.insert(a, b);
            }
            let mut trace = Trace::default();
            let outcome = simulate(&Points { breaks }, &mut state, &mut Scratch::default(), 10.0, &mut trace);
            assert_eq!(outcome, Outcome::NotFinite { body, touched });
            assert_eq!(state.time(), time);
            assert!(trace.motions.iter().flatten().all(|motion| motion.x.is_finite()));
        }
    }
}
