//! When two bodies that are represented by their contact spheres first touch: balls and bodies of revolution.
//!
//! They are advanced with a second-order bound on the approach of the nearest points. If another pair of points
//! comes first, the overlap is noticed, and the time is found by bisection.

use super::advancement::{bisect, free_flight_bound};
use super::capsules::capsules;
use crate::rigid::body_state::RigidBodyState;
use crate::rigid::tolerances::{MAX_SPHERE_ADVANCES, PAIR_CAPSULE_MARGIN, SKIN_SKIP, SPHERE_BISECTIONS};
use crate::rigid::{BodyDef, RigidWorld};
use crate::roots::earliest;
use crate::special_case::SpecialCase;

impl RigidWorld {
    /// First time in `[from, until]` at which two bodies touch while approaching, for pairs that are treated as balls
    /// and rings.
    pub(crate) fn first_of_spheres(
        &self,
        pair: [usize; 2],
        bodies: [&RigidBodyState; 2],
        from: f64,
        until: f64,
    ) -> Option<f64> {
        let [s, t] = pair.map(|k| &self.specs[k]);
        let level = self.pair_gap(pair);
        let gravity = (bodies[0].path.a - bodies[1].path.a).length();
        let turning = |spec: &BodyDef, b: &RigidBodyState| {
            let square = if b.is_keyed() {
                let fastest = b.fastest(spec, until);
                fastest * fastest
            } else {
                b.spin.length_squared()
            };
            if spec.is_ball { 0.0 } else { square * (1.0 + spec.anisotropy) * spec.bounding_radius }
        };
        let m = gravity + (turning(s, bodies[0]) + turning(t, bodies[1]));
        let bounding_radius = s.bounding_radius + t.bounding_radius;
        let swings = |spec: &BodyDef, b: &RigidBodyState| {
            let spin = if b.is_keyed() { b.fastest(spec, until) } else { b.spin.length() };
            spin * spec.bounding_radius
        };
        let rotation_speed = swings(s, bodies[0]) + swings(t, bodies[1]) + (gravity * bounding_radius).sqrt();
        let mut rotations = [bodies[0].free_rotation(s), bodies[1].free_rotation(t)];
        let mut pose = |k: usize, time: f64| bodies[k].pose_at([s, t][k], &mut rotations[k], time);
        let mut time = from;
        // The last time at which they were apart, if they have been.
        let mut clear = None;
        for _ in 0..MAX_SPHERE_ADVANCES {
            let distance = (bodies[0].path.at(time) - bodies[1].path.at(time)).length();
            let away = distance - s.bounding_radius - t.bounding_radius - level;
            if away > 0.0 {
                time += free_flight_bound(bodies, time, away, level, gravity);
                if time >= until || time.is_nan() {
                    return None;
                }
                clear = Some(time);
                continue;
            }
            let (a, b) = (pose(0, time), pose(1, time));
            let (apart, safe) = capsules([s, t], [&a, &b], level, m);
            if apart - level > PAIR_CAPSULE_MARGIN * s.size.min(t.size) && SpecialCase::Capsules.is_on() {
                clear = Some(time);
                if time >= until || time.is_nan() {
                    return None;
                }
                time = (time + safe).min(until);
                continue;
            }
            let touch = self.pair_touch(pair, [&a, &b]);
            let f = touch.gap - 0.5 * level;
            let rate = (a.velocity(touch.arms[0]) - b.velocity(touch.arms[1])).dot(touch.normal);
            if f < -2.0 * level
                && let Some(clear) = clear
            {
                // Another pair of points came first: go back to when they touch.
                return Some(bisect(SPHERE_BISECTIONS, clear, time, |t| {
                    let (a, b) = (pose(0, t), pose(1, t));
                    self.pair_touch(pair, [&a, &b]).gap <= 0.5 * level
                }));
            }
            if f <= 0.5 * level && rate < 0.0 {
                return Some(time);
            }
            if f > 0.0 {
                clear = Some(time);
            }
            if time >= until || time.is_nan() {
                return None;
            }
            // Not even the fastest points come together.
            let left = until - time;
            if f > ((a.v - b.v).length() + rotation_speed + m * left) * left {
                return None;
            }
            // Skins have necks: a pair of points that is not the nearest may meet first. Within this distance it is
            // seen in time, or hardly touches.
            let seen = (f.max(0.0) + SKIN_SKIP * s.size.min(t.size)) / ((a.v - b.v).length() + rotation_speed);
            // The end of the search is examined too.
            time = (time + earliest(f, rate, m).min(seen)).min(until);
        }
        Some(time)
    }
}
