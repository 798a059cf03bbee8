//! Two bodies: how near they are, when they touch, and their impact.
//!
//! `rows.rs` says which row serves which pair. Here, balls and bodies of revolution are treated as the balls and rings
//! of their skins. First contacts are found by advancement with a second-order bound
//! on the approach of the nearest points. If another pair of points comes first, the overlap is noticed, and the time
//! is found by bisection.

use super::advance::{bisect, flight};
use super::body::{Motion, Phase, Pose, Turning};
use super::capsule::capsules;
use super::coulomb::Member;
use super::scratch::{KEEP, PUSH, RigidScratch, TOUCHING, pair_contact};
use super::strike::{Point, strike};
use super::touch::{PairTouch, to_middle};
use super::{Rigid, Spec};
use crate::material::Law;
use crate::mechanics::{Impact, Other};
use crate::roots::earliest;
use glam::DVec3;

/// Maximum number of advancements of one search. After that the time reached is handed on as an event.
const MOST_ADVANCES: usize = 100;

/// Bisections of a step that ended in overlap: to 2⁻⁴⁰ of the step.
const BISECTIONS: usize = 40;

/// Distance of the capsules around two bodies, over their size, below which their skins are examined. Default 0.02.
const NEAR: f64 = 0.02;

/// Distance over the size that two skins may move between two looks, in addition to the distance between them. Default
/// 0.05; larger values miss grazes as deep as half of this.
const SKIP: f64 = 0.05;

/// Two balls, in world axes about the two centres of gravity.
pub(super) fn balls(offset: DVec3, [p, q]: [DVec3; 2], [r, s]: [f64; 2]) -> PairTouch {
    // `offset` points from the second centre of gravity to the first.
    let between = offset + p - q;
    let distance = between.length();
    let normal = if distance > 0.0 { between / distance } else { DVec3::Z };
    PairTouch { normal, arms: [p - normal * r, q + normal * s], gap: distance - r - s, spot: None }
}

pub(super) fn nearer(best: &mut Option<PairTouch>, other: PairTouch) {
    if best.is_none_or(|b| other.gap < b.gap) {
        *best = Some(other);
    }
}

pub(super) fn swapped(t: PairTouch) -> PairTouch {
    PairTouch { normal: -t.normal, arms: [t.arms[1], t.arms[0]], ..t }
}

impl Rigid {
    /// Gap at which two bodies touch.
    pub(super) fn pair_gap(&self, [i, j]: [usize; 2]) -> f64 {
        self.specs[i].gap.min(self.specs[j].gap)
    }

    pub(super) fn pair_law(&self, [i, j]: [usize; 2]) -> &Law {
        self.laws.of(self.specs[i].material, self.specs[j].material)
    }

    /// Rebound speed up to which a contact of two bodies lasts.
    pub(super) fn pair_settle_speed(&self, [i, j]: [usize; 2]) -> f64 {
        self.slowest_bounce(self.pair_law([i, j])) * self.specs[i].speed.min(self.specs[j].speed)
    }

    /// The wanted gap at a point of contact of two bodies at the end of a step of `h` seconds: an overlap is undone at
    /// a limited speed.
    pub(super) fn pair_goal(&self, [i, j]: [usize; 2], gap: f64, h: f64) -> f64 {
        let fastest = PUSH * self.accuracy.settle * self.specs[i].speed.min(self.specs[j].speed);
        (KEEP * self.pair_gap([i, j])).min(gap + fastest * h)
    }

    /// First time in `[from, until]` at which two bodies touch while approaching, for rows that use balls and rings.
    pub(super) fn first_of_feelers(
        &self,
        pair: [usize; 2],
        bodies: [&Turning; 2],
        from: f64,
        until: f64,
    ) -> Option<f64> {
        let [s, t] = pair.map(|k| &self.specs[k]);
        let level = self.pair_gap(pair);
        let pull = (bodies[0].path.a - bodies[1].path.a).length();
        let turning = |spec: &Spec, b: &Turning| {
            let square = if b.phase == Phase::Driven {
                let fastest = b.fastest(spec, until);
                fastest * fastest
            } else {
                b.spin.length_squared()
            };
            if spec.is_ball { 0.0 } else { square * (1.0 + spec.wobble) * spec.reach }
        };
        let m = pull + (turning(s, bodies[0]) + turning(t, bodies[1]));
        let reach = s.reach + t.reach;
        let swings = |spec: &Spec, b: &Turning| {
            let spin = if b.phase == Phase::Driven { b.fastest(spec, until) } else { b.spin.length() };
            spin * spec.reach
        };
        let swing = swings(s, bodies[0]) + swings(t, bodies[1]) + (pull * reach).sqrt();
        let mut tumbles = [bodies[0].tumble(s), bodies[1].tumble(t)];
        let mut pose = |k: usize, time: f64| {
            let (spec, b) = ([s, t][k], bodies[k]);
            let dt = time - b.path.t;
            let r = tumbles[k].at(dt);
            let w = tumbles[k].spin().unwrap_or_else(|| b.drift_spin(spec, dt));
            Pose { x: b.path.after(dt), r, v: b.path.velocity_after(dt), w }
        };
        let mut time = from;
        // The last time at which they were apart, if they have been.
        let mut clear = None;
        for _ in 0..MOST_ADVANCES {
            let distance = (bodies[0].path.at(time) - bodies[1].path.at(time)).length();
            let away = distance - s.reach - t.reach - level;
            if away > 0.0 {
                time += flight(bodies, time, away, level, pull);
                if time >= until || time.is_nan() {
                    return None;
                }
                clear = Some(time);
                continue;
            }
            let (a, b) = (pose(0, time), pose(1, time));
            let (apart, safe) = capsules([s, t], [&a, &b], level, m);
            if apart - level > NEAR * s.size.min(t.size) {
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
                return Some(bisect(BISECTIONS, clear, time, |t| {
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
            if f > ((a.v - b.v).length() + swing + m * left) * left {
                return None;
            }
            // Skins have necks: a pair of points that is not the nearest may meet first. Within this distance it is
            // seen in time, or hardly touches.
            let seen = (f.max(0.0) + SKIP * s.size.min(t.size)) / ((a.v - b.v).length() + swing);
            // The end of the search is examined too.
            time = (time + earliest(f, rate, m).min(seen)).min(until);
        }
        Some(time)
    }

    /// Impact of two bodies, at all points that are struck at once. Returns whether there was one, and whether their
    /// contact lasts from then on.
    pub(super) fn hit_pair(
        &self,
        pair: [usize; 2],
        [a, b]: [&mut Turning; 2],
        linked: bool,
        report: &mut dyn FnMut(&Impact),
    ) -> Option<bool> {
        let [s, t] = pair.map(|k| &self.specs[k]);
        let (time, hurried) = (a.path.t, a.is_hurried() || b.is_hurried());
        let (p, q) = (a.pose(), b.pose());
        let mut members = [RigidScratch::member(s, &p.r, p.v, p.w), RigidScratch::member(t, &q.r, q.v, q.w)];
        let mut points = self.points_of_pair(pair, [a, b], &members, linked);
        if !points.iter().any(Point::is_struck) {
            // They touch without an approach: within a step, where the drift approaches but the momenta no longer do;
            // or again and again, for example where two pairs of points are equally near. Their group has to deal with
            // it.
            let steps = [&*a, &*b].iter().any(|body| body.phase == Phase::Step);
            let stuck = !linked && (hurried || steps) && !points.is_empty();
            if stuck {
                a.stick_to(pair[1]);
                self.touch_again(pair, [a, b]);
            }
            return stuck.then_some(true);
        }
        strike(&mut points, &mut members, self.accuracy.slip_turn);
        for ((body, spec), m) in [(&mut *a, s), (&mut *b, t)].into_iter().zip(&members) {
            if !spec.is_driven() {
                body.set_motion(spec, Motion { v: m.v, w: m.w });
            }
        }
        self.touch_again(pair, [a, b]);
        for point in &points {
            point.report(time, pair[0], p.x, report);
        }
        Some(points.iter().all(|point| point.lasting))
    }

    /// The points at which two bodies touch, as an impact sees them.
    pub(super) fn points_of_pair(
        &self,
        pair: [usize; 2],
        [a, b]: [&Turning; 2],
        members: &[Member; 2],
        linked: bool,
    ) -> Vec<Point> {
        let (p, q, hurried) = (a.pose(), b.pose(), a.is_hurried() || b.is_hurried());
        let law = self.pair_law(pair);
        let (settles, within) = (self.pair_settle_speed(pair), TOUCHING * self.pair_gap(pair));
        let mut points = Vec::new();
        self.for_pair_touches(pair, [&p, &q], within, |touch| {
            let contact = pair_contact(members, [0, 1], to_middle(touch.arms, [p.x, q.x]), touch.normal, law.friction);
            let point = Point::new(contact, -touch.rate(&p, &q), law, settles, hurried, Other::Body(pair[1]));
            // A first contact is struck however slow it is; later, the steps of lasting contact deal with slow ones.
            points.push(Point { least: if linked && point.lasting { f64::INFINITY } else { 0.0 }, ..point });
        });
        points
    }

    /// Makes both bodies look anew for what they touch.
    fn touch_again(&self, pair: [usize; 2], bodies: [&mut Turning; 2]) {
        for (index, body) in pair.into_iter().zip(bodies).filter(|(k, _)| !self.specs[*k].is_driven()) {
            if !body.flies() {
                body.phase = Phase::Step;
            }
            self.list_touches(index, body);
        }
    }
}
