//! Two cuboids: when they first touch, and the points of their contact.
//!
//! Along a direction that turns evenly, every corner of one keeps a distance from every corner of the other that can shrink only so fast: its rate is known, and its
//! acceleration is bounded by what gravity, the bodies' rotations and the direction's own turning can do. While all these distances are positive the direction separates the
//! cuboids. So the bodies are advanced by the first root of those parabolas, along the normal of the nearest features, turning as that normal does; this cannot overshoot, and
//! converges quadratically (conservative advancement: Mirtich, *Impulse-based Dynamic Simulation* (1996), ch. 2.3, with corners' own second-order bounds in the place of one bound on
//! the speed).
//!
//! Bodies in lasting contact are looked at in the same way, without the pairs of corners that span their contact: the steps deal with those.

use super::body::{Phase, Pose, Turning};
use super::detect::earliest;
use super::pair::PairTouch;
use super::{Rigid, Skin, Spec};
use crate::shape::cuboid_pair::{CuboidPair, Feature, Meeting, Placed};
use glam::DVec3;

/// Most advancements of one search; then the time reached is handed on as an event, and the bodies are looked at anew.
const MOST_ADVANCES: usize = 200;

/// Least advancement near contact: the time in which corners move by this part of the gap at which bodies touch. Default 0.1.
const LEAST: f64 = 0.1;

/// Least number of looks at bodies in lasting contact within one of their steps. Default 8: a point whose corners are held can come into contact only by turning.
const LOOKS: f64 = 8.0;

/// Halvings of the time between two such looks.
const BISECTIONS: usize = 30;

/// Most points of a contact that are remembered while bodies stay in touch: an octagon has eight.
const MOST_POINTS: usize = 16;

/// Points of contact at the start of a step.
#[derive(Default)]
struct Held {
    features: [Option<Feature>; MOST_POINTS],
    count: usize,
    /// The corners of each that span them.
    corners: [u8; 2],
    /// Which pairs of those corners lie in the plane of contact: bit j of entry i for corner i of the first and j of the second.
    flat: [u8; 8],
}

impl Held {
    fn new(cuboids: &CuboidPair, nearest: &Meeting, within: f64) -> Self {
        let mut held = Self::default();
        cuboids.touching(nearest, within, |m| {
            if held.count < MOST_POINTS {
                held.features[held.count] = Some(m.feature);
                held.count += 1;
            }
            for (mask, more) in held.corners.iter_mut().zip(m.feature.corners()) {
                *mask |= more;
            }
        });
        let n = nearest.normal;
        let [p, q] = [0, 1].map(|k| cuboids.corners_along(k, n, n));
        let base = cuboids.offset_along(n) - cuboids.roundings();
        for (i, mask) in held.flat.iter_mut().enumerate().filter(|(i, _)| held.corners[0] >> i & 1 == 1) {
            let low = |j: usize| base + (p[i].0 - q[j].0) <= within;
            *mask = (0..8).filter(|&j| low(j)).fold(0, |m, j| m | 1 << j) & held.corners[1];
        }
        held
    }

    fn has(&self, feature: Feature) -> bool {
        self.features[..self.count].contains(&Some(feature))
    }

    /// Of the points that touch and are not held, the least gap and the least rate.
    fn newest(&self, cuboids: &CuboidPair, nearest: &Meeting, [a, b]: [&Pose; 2], level: f64) -> New {
        let mut new = New { gap: f64::INFINITY, rate: f64::INFINITY };
        // The same points as steps see, of which those within the gap count.
        cuboids.touching(nearest, super::step::TOUCHING * level, |m| {
            if m.gap <= level && !self.has(m.feature) {
                new.gap = new.gap.min(m.gap);
                new.rate = new.rate.min(PairTouch::from(m).rate(a, b));
            }
        });
        new
    }
}

/// What is new among points of contact.
struct New {
    gap: f64,
    rate: f64,
}

/// The end of the last of [`BISECTIONS`] halves in which `is` becomes true.
fn bisect(mut low: f64, mut high: f64, mut is: impl FnMut(f64) -> bool) -> f64 {
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if is(middle) { high = middle } else { low = middle }
    }
    high
}

/// Largest angular speed of a body within its current motion.
fn fastest(spec: &Spec, body: &Turning) -> f64 {
    let now = body.spin.length();
    if spec.wobble == 0.0 || body.phase != Phase::Flight {
        return now;
    }
    spec.inertia.momentum(body.turn, body.spin).length() / spec.inertia.moments.min_element()
}

impl Rigid {
    /// Both bodies as cuboids, if they are.
    #[inline]
    fn cuboids(&self, [i, j]: [usize; 2], [a, b]: [&Pose; 2]) -> Option<CuboidPair> {
        let placed = |k: usize, pose: &Pose| match self.specs[k].skin {
            Skin::Cuboid { half, rounding } => Some(Placed { axes: pose.r, core: half - rounding, rounding }),
            _ => None,
        };
        Some(CuboidPair::new(a.x - b.x, placed(i, a)?, placed(j, b)?))
    }

    pub(super) fn are_cuboids(&self, pair: [usize; 2]) -> bool {
        pair.iter().all(|&k| matches!(self.specs[k].skin, Skin::Cuboid { .. }))
    }

    /// The nearest points of two cuboids.
    pub(super) fn nearest_of_cuboids(&self, pair: [usize; 2], poses: [&Pose; 2]) -> Option<PairTouch> {
        Some(self.cuboids(pair, poses)?.nearest().into())
    }

    /// Calls `each` for the points at which two bodies touch: all of two cuboids, the nearest of others.
    pub(super) fn for_pair_touches(
        &self,
        pair: [usize; 2],
        poses: [&Pose; 2],
        within: f64,
        mut each: impl FnMut(PairTouch),
    ) {
        if let Some(cuboids) = self.cuboids(pair, poses) {
            return cuboids.touching(&cuboids.nearest(), within, |m| each(m.into()));
        }
        let touch = self.pair_touch(pair, poses);
        if touch.gap <= within {
            each(touch);
        }
    }

    /// The same point of contact at other poses.
    pub(super) fn pair_again(&self, pair: [usize; 2], poses: [&Pose; 2], touch: &PairTouch) -> PairTouch {
        match (touch.feature, self.cuboids(pair, poses)) {
            (Some(feature), Some(cuboids)) => cuboids.again(feature, touch.normal).into(),
            _ => self.pair_touch(pair, poses),
        }
    }

    /// The point at which two bodies hit each other: the fastest of those that touch.
    pub(super) fn hitting(&self, pair: [usize; 2], [a, b]: [&Pose; 2]) -> PairTouch {
        let mut worst: Option<(f64, PairTouch)> = None;
        if self.are_cuboids(pair) {
            self.for_pair_touches(pair, [a, b], super::step::TOUCHING * self.pair_gap(pair), |t| {
                let rate = t.rate(a, b);
                if worst.is_none_or(|(w, _)| rate < w) {
                    worst = Some((rate, t));
                }
            });
        }
        worst.map_or_else(|| self.pair_touch(pair, [a, b]), |(_, t)| t)
    }

    /// First time in `[from, until]` at which two cuboids touch while approaching. Of bodies in lasting contact (`linked`) only at points that are not part of it yet.
    pub(super) fn first_of_cuboids(
        &self,
        pair: [usize; 2],
        bodies: [&Turning; 2],
        [from, until]: [f64; 2],
        linked: bool,
    ) -> Option<f64> {
        let [s, t] = pair.map(|k| &self.specs[k]);
        let level = self.pair_gap(pair);
        let pull = (bodies[0].path.a - bodies[1].path.a).length();
        let swing = [fastest(s, bodies[0]), fastest(t, bodies[1])];
        let reach = s.reach + t.reach;
        // Longest advancement, and what it can add to the relative speed.
        let (longest, gain) = ((reach / pull).sqrt(), (pull * reach).sqrt());
        let swings = |k: usize, spec: &Spec| swing[k] * swing[k] * (1.0 + spec.wobble) * spec.reach;
        let bound = pull + (swings(0, s) + swings(1, t));
        let mut tumbles = [bodies[0].tumble(s), bodies[1].tumble(t)];
        let mut pose = |k: usize, time: f64| {
            let (spec, b) = ([s, t][k], bodies[k]);
            let dt = time - b.path.t;
            let free = spec.wobble != 0.0 && b.phase == Phase::Flight;
            let w = if free { b.motion_after(spec, dt).w } else { b.spin };
            Pose { x: b.path.after(dt), r: tumbles[k].at(dt), v: b.path.velocity_after(dt), w }
        };
        let mut held = Held::default();
        let (mut time, mut clear) = (from, from);
        for advance in 0..MOST_ADVANCES {
            let offset = bodies[0].path.at(time) - bodies[1].path.at(time);
            let distance = offset.length();
            let away = distance - reach - level;
            if away > 0.0 {
                let dv = bodies[0].path.velocity_after(time - bodies[0].path.t)
                    - bodies[1].path.velocity_after(time - bodies[1].path.t);
                let step = earliest(away, offset.dot(dv) / distance, pull);
                // Never less than a thousandth of the gap, so that it ends.
                time += step + 1e-3 * level / (dv.length() + (pull * level).sqrt()).max(f64::MIN_POSITIVE);
                if time >= until || time.is_nan() {
                    return None;
                }
                continue;
            }
            let (a, b) = (pose(0, time), pose(1, time));
            let cuboids = self.cuboids(pair, [&a, &b])?;
            let nearest = cuboids.nearest();
            if linked && advance == 0 {
                held = Held::new(&cuboids, &nearest, super::step::TOUCHING * level);
            }
            if nearest.gap <= level {
                let new = held.newest(&cuboids, &nearest, [&a, &b], level);
                if new.rate < 0.0 {
                    return Some(if new.gap < -level && time > clear {
                        // A point outside the plane of contact turned into it: back to where it came.
                        bisect(clear, time, |t| {
                            let (a, b) = (pose(0, t), pose(1, t));
                            let cuboids = self.cuboids(pair, [&a, &b]);
                            cuboids.is_some_and(|c| held.newest(&c, &c.nearest(), [&a, &b], level).gap <= 0.5 * level)
                        })
                    } else {
                        time
                    });
                }
            }
            clear = time;
            let across = cuboids.turning(nearest.feature, nearest.normal, [a.w, b.w]);
            let speed = (a.v - b.v).length() + (swing[0] * s.reach + swing[1] * t.reach) + gain;
            let turn = across.length();
            let search = Advance { cuboids: &cuboids, poses: [&a, &b], normal: nearest.normal, across, level };
            let m = bound + turn * (turn * (distance + reach) + 2.0 * speed);
            let step =
                search.time(m, &held.flat).min(longest).min(if linked { (until - from) / LOOKS } else { longest });
            // Nothing that touches approaches: an overlap may grow to twice what it is until then.
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
struct Advance<'c> {
    cuboids: &'c CuboidPair,
    poses: [&'c Pose; 2],
    normal: DVec3,
    /// The direction's rate.
    across: DVec3,
    level: f64,
}

impl Advance<'_> {
    /// How long at least no corner of one gets to the half gap over a corner of the other, but for the pairs held; `m` bounds the accelerations.
    fn time(&self, m: f64, held: &[u8; 8]) -> f64 {
        let [a, b] = self.poses;
        let (n, across) = (self.normal, self.across);
        let base = self.cuboids.offset_along(n) - self.cuboids.roundings() - 0.5 * self.level;
        let base_rate = self.cuboids.offset_along(across) + n.dot(a.v - b.v);
        let corners = [0, 1].map(|k| {
            let pose = self.poses[k];
            self.cuboids.corners_along(k, n, across + n.cross(pose.w))
        });
        let mut step = f64::INFINITY;
        for (i, &(p, p_rate)) in corners[0].iter().enumerate() {
            for (j, &(q, q_rate)) in corners[1].iter().enumerate() {
                if held[i] >> j & 1 == 1 {
                    continue;
                }
                let (f, rate) = (base + (p - q), base_rate + (p_rate - q_rate));
                // Cheap test first: whether it can be gone before the others at all.
                if f > 0.0 && step.is_finite() && f + (rate - 0.5 * m * step) * step > 0.0 {
                    continue;
                }
                step = step.min(earliest(f, rate, m));
            }
        }
        step
    }
}
