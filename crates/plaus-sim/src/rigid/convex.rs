//! Two bodies with flat faces, cuboids or other convex polyhedra: when they first touch, and which points are new in a
//! lasting contact.
//!
//! Along a direction that turns evenly, the distance of any corner of one body from any corner of the other can shrink
//! only so fast: its rate is known, and its acceleration is bounded by what gravity, the bodies' rotations and the
//! direction's own turning can do. While all these distances are positive, the direction separates the bodies. So they
//! are advanced by the first root of those parabolas, along the normal of the nearest features, turning as that normal
//! does. This cannot overshoot, and converges quadratically (conservative advancement: Mirtich, *Impulse-based Dynamic
//! Simulation* (1996), ch. 2.3, with second-order bounds for each corner instead of one bound on the speed).
//!
//! Bodies in lasting contact are examined in the same way, without the pairs of corners that span their contact: the
//! steps deal with those.

use super::Spec;
use super::advance::{bisect, flight};
use super::body::{Pose, Turning};
use super::scratch::TOUCHING;
use crate::roots::earliest;
use crate::shape::cuboid_pair::Meeting;
use glam::DVec3;

/// Maximum number of advancements of one search. After that the time reached is handed on as an event, and the bodies
/// are examined anew.
const MOST_ADVANCES: usize = 200;

/// Least advancement near contact: the time in which corners move by this fraction of the gap at which bodies touch.
/// Default 0.1.
const LEAST: f64 = 0.1;

/// Least number of times that bodies in lasting contact are examined within one of their steps. Default 8: a point
/// whose corners are held can come into contact only by turning.
const LOOKS: f64 = 8.0;

/// Halvings of the time between two such times.
const BISECTIONS: usize = 30;

/// Maximum number of points of a contact that are remembered while bodies stay in touch: an octagon has eight, two
/// faces of twelve corners have 24.
const MOST_POINTS: usize = 24;

/// Two bodies in their places, as the search sees them.
pub(super) trait ConvexPair: Sized {
    /// The elements that meet at a point of contact.
    type Feature: Copy + PartialEq;
    /// A set of corners of the second for every corner of the first.
    type Sets: AsRef<[u64]> + AsMut<[u64]>;
    /// Where the corners of one body are along two directions.
    type Along: AsRef<[(f64, f64)]>;

    /// Empty sets.
    fn no_sets() -> Self::Sets;
    /// The nearest points; `last` are those of a pose shortly before.
    fn nearest(&self, last: Option<&Meeting<Self::Feature>>) -> Meeting<Self::Feature>;
    /// Calls `each` for the points with a gap of at most `within`.
    fn touching(&self, nearest: &Meeting<Self::Feature>, within: f64, each: impl FnMut(Meeting<Self::Feature>));
    /// Rate of a feature's normal while the bodies turn at these angular velocities.
    fn turning(&self, feature: Self::Feature, normal: DVec3, spins: [DVec3; 2]) -> DVec3;
    /// The corners of each body that span a feature.
    fn corners(&self, feature: Self::Feature) -> [u64; 2];
    /// Where the corners of the first (0) or the second (1) body are along two directions, about its centre.
    fn corners_along(&self, of: usize, first: DVec3, second: DVec3) -> Self::Along;
    /// From the second centre to the first, along a direction.
    fn offset_along(&self, direction: DVec3) -> f64;
    /// Both roundings together.
    fn roundings(&self) -> f64;
}

/// Rate of the gap of a meeting.
fn rate<F>(m: &Meeting<F>, [a, b]: [&Pose; 2]) -> f64 {
    (a.velocity(m.arms[0]) - b.velocity(m.arms[1])).dot(m.normal)
}

/// Points of contact at the start of a step.
struct Held<P: ConvexPair> {
    features: [Option<P::Feature>; MOST_POINTS],
    count: usize,
    /// The corners of each body that span these points.
    corners: [u64; 2],
    /// Which pairs of those corners lie in the plane of contact: bit j of entry i is set for corner i of the first body
    /// and corner j of the second.
    flat: P::Sets,
    /// Gap up to which points belong to the contact, in m: names of points depend on it.
    within: f64,
}

impl<P: ConvexPair> Held<P> {
    fn none() -> Self {
        Self { features: [None; MOST_POINTS], count: 0, corners: [0; 2], flat: P::no_sets(), within: 0.0 }
    }

    /// The points up to `within` that the step of these bodies deals with, in the `rest` of it: a point beyond touching
    /// that goes on towards its partner is not one of them.
    fn new(bodies: &P, nearest: &Meeting<P::Feature>, [near, within]: [f64; 2], poses: [&Pose; 2], rest: f64) -> Self {
        let mut held = Self { within, ..Self::none() };
        bodies.touching(nearest, within, |m| {
            if m.gap > near && m.gap + rate(&m, poses) * rest < 0.0 {
                return;
            }
            if held.count < MOST_POINTS {
                held.features[held.count] = Some(m.feature);
                held.count += 1;
            }
            for (set, more) in held.corners.iter_mut().zip(bodies.corners(m.feature)) {
                *set |= more;
            }
        });
        let n = nearest.normal;
        let [p, q] = [0, 1].map(|k| bodies.corners_along(k, n, n));
        let base = bodies.offset_along(n) - bodies.roundings();
        for (i, &(p, _)) in p.as_ref().iter().enumerate().filter(|(i, _)| held.corners[0] >> i & 1 == 1) {
            let low = |(j, &(q, _)): (usize, &(f64, f64))| u64::from(base + (p - q) <= within) << j;
            held.flat.as_mut()[i] =
                q.as_ref().iter().enumerate().map(low).fold(0, |set, bit| set | bit) & held.corners[1];
        }
        held
    }

    fn has(&self, feature: P::Feature) -> bool {
        self.features[..self.count].contains(&Some(feature))
    }

    /// The least gap and the least rate of the points that touch and are not held.
    fn newest(&self, bodies: &P, nearest: &Meeting<P::Feature>, poses: [&Pose; 2], level: f64) -> New {
        let mut new = New { gap: f64::INFINITY, rate: f64::INFINITY };
        let limit = if self.within > 0.0 { 0.5 * level } else { level };
        // The same points that steps see; those that advancement takes for touching count.
        bodies.touching(nearest, self.within.max(TOUCHING * level), |m| {
            if m.gap <= limit && !self.has(m.feature) {
                new.gap = new.gap.min(m.gap);
                new.rate = new.rate.min(rate(&m, poses));
            }
        });
        new
    }
}

/// The new points among the points of contact.
struct New {
    gap: f64,
    rate: f64,
}

/// One search for the time at which two bodies touch.
pub(super) struct Quest<'w> {
    pub(super) specs: [&'w Spec; 2],
    pub(super) bodies: [&'w Turning; 2],
    /// Gap at which they touch, in m.
    pub(super) level: f64,
    pub(super) from: f64,
    pub(super) until: f64,
    /// Whether the bodies are in lasting contact: then only points count that are not yet part of it.
    pub(super) linked: bool,
    /// Largest distances of corners from the centres of gravity, in m.
    pub(super) arms: [f64; 2],
}

impl Quest<'_> {
    /// First time in `[from, until]` at which two bodies touch while approaching; `place` moves them to poses.
    pub(super) fn first<P: ConvexPair>(&self, place: impl Fn([&Pose; 2]) -> Option<P>) -> Option<f64> {
        let Quest { specs: [s, t], bodies, level, from, until, linked, arms } = *self;
        let pull = (bodies[0].path.a - bodies[1].path.a).length();
        let swing = [bodies[0].fastest(s, until), bodies[1].fastest(t, until)];
        let reach = s.reach + t.reach;
        // Longest advancement, and how much it can add to the relative speed.
        let (longest, gain) = ((reach / pull).sqrt(), (pull * reach).sqrt());
        let swings = |k: usize, spec: &Spec| swing[k] * swing[k] * (1.0 + spec.wobble) * arms[k];
        let bound = pull + (swings(0, s) + swings(1, t));
        let mut tumbles = [bodies[0].tumble(s), bodies[1].tumble(t)];
        let mut pose = |k: usize, time: f64| {
            let (spec, b) = ([s, t][k], bodies[k]);
            let dt = time - b.path.t;
            let free = spec.wobble != 0.0 && b.turns_freely();
            let r = tumbles[k].at(dt);
            let w =
                if free { tumbles[k].spin().unwrap_or_else(|| b.drift_spin(spec, dt)) } else { b.keyed_spin(spec, dt) };
            Pose { x: b.path.after(dt), r, v: b.path.velocity_after(dt), w }
        };
        let mut held = Held::<P>::none();
        let (mut time, mut clear) = (from, from);
        let mut last: Option<Meeting<P::Feature>> = None;
        for advance in 0..MOST_ADVANCES {
            let distance = (bodies[0].path.at(time) - bodies[1].path.at(time)).length();
            let away = distance - reach - level;
            if away > 0.0 {
                time += flight(bodies, time, away, level, pull);
                if time >= until || time.is_nan() {
                    return None;
                }
                continue;
            }
            let (a, b) = (pose(0, time), pose(1, time));
            let placed = place([&a, &b])?;
            let nearest = placed.nearest(last.as_ref());
            last = Some(nearest);
            if linked && advance == 0 {
                // The points with which the step was made.
                let sag = bodies[0].sag.min(bodies[1].sag) * s.size.min(t.size);
                let near = TOUCHING * level;
                let rest = bodies[0].expiry.min(bodies[1].expiry) - time;
                held = Held::new(&placed, &nearest, [near, near + sag], [&a, &b], rest);
            }
            if nearest.gap <= level {
                let new = held.newest(&placed, &nearest, [&a, &b], level);
                if new.rate < 0.0 {
                    return Some(if new.gap < -level && time > clear {
                        // A point outside the plane of contact has turned into it: go back to when it touched.
                        bisect(BISECTIONS, clear, time, |t| {
                            let (a, b) = (pose(0, t), pose(1, t));
                            let placed = place([&a, &b]);
                            let newest = |c: P| held.newest(&c, &c.nearest(None), [&a, &b], level).gap;
                            placed.is_some_and(|c| newest(c) <= 0.5 * level)
                        })
                    } else {
                        time
                    });
                }
            }
            clear = time;
            let across = placed.turning(nearest.feature, nearest.normal, [a.w, b.w]);
            let speed = (a.v - b.v).length() + (swing[0] * arms[0] + swing[1] * arms[1]) + gain;
            let turn = across.length();
            let search = Advance { bodies: &placed, poses: [&a, &b], normal: nearest.normal, across, level };
            let m = bound + turn * (turn * (distance + reach) + 2.0 * speed);
            let step = search.time(m, held.flat.as_ref()).min(longest).min(if linked {
                (until - from) / LOOKS
            } else {
                longest
            });
            // Nothing that touches approaches: an overlap may at most double until then.
            let least = (LEAST * level).max(-nearest.gap);
            time += step.max(least / speed.max(f64::MIN_POSITIVE));
            if time >= until || time.is_nan() {
                return None;
            }
        }
        Some(time)
    }
}

/// The distances of corners along a turning direction.
struct Advance<'c, P> {
    bodies: &'c P,
    poses: [&'c Pose; 2],
    normal: DVec3,
    /// The direction's rate of change.
    across: DVec3,
    level: f64,
}

impl<P: ConvexPair> Advance<'_, P> {
    /// A lower bound on the time in which no corner of one body comes within half the gap over a corner of the other,
    /// except for the pairs held; `m` bounds the accelerations.
    fn time(&self, m: f64, held: &[u64]) -> f64 {
        let [a, b] = self.poses;
        let (n, across) = (self.normal, self.across);
        let base = self.bodies.offset_along(n) - self.bodies.roundings() - 0.5 * self.level;
        let base_rate = self.bodies.offset_along(across) + n.dot(a.v - b.v);
        let corners = [0, 1].map(|k| {
            let pose = self.poses[k];
            self.bodies.corners_along(k, n, across + n.cross(pose.w))
        });
        let mut step = f64::INFINITY;
        for (i, &(p, p_rate)) in corners[0].as_ref().iter().enumerate() {
            for (j, &(q, q_rate)) in corners[1].as_ref().iter().enumerate() {
                if held[i] >> j & 1 == 1 {
                    continue;
                }
                let (f, rate) = (base + (p - q), base_rate + (p_rate - q_rate));
                // A quick test first: whether this distance can vanish before the others at all.
                if f > 0.0 && step.is_finite() && f + (rate - 0.5 * m * step) * step > 0.0 {
                    continue;
                }
                step = step.min(earliest(f, rate, m));
            }
        }
        step
    }
}
