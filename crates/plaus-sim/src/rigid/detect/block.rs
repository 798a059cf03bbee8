//! First contact with a solid box.

use super::plane::BEYOND;
use super::{LEANS, MOST_ADVANCES, Search, earliest};
use crate::rigid::body::Phase;
use crate::rigid::part::{Part, Side, farthest_side, is_over};
use crate::rigid::rim;
use crate::scenery::Aabb;
use crate::shape::Feeler;
use glam::{DMat3, DVec2, DVec3};

impl Search<'_> {
    pub(super) fn block(&mut self, part: u16, block: &Part) {
        let Part::Block { bounds, .. } = block else { return };
        let (spec, path) = (self.spec, &self.body.path);
        if spec.is_ball && self.lasts(part, 0) {
            // Its only point; that it leaves the box is an event of its motion.
            return;
        }
        let swept = path.bounds(0.0, self.until).grown(spec.reach);
        if !bounds.grown(spec.gap).meets(&swept) {
            return;
        }
        let mut t = 0.0;
        if let Some(side) = farthest_side(bounds, path.x) {
            // The box is part of the half space behind that side, so nothing touches it before.
            let edges = Some((bounds, side.axis));
            let Some((time, point)) = self.half_space(part, (side.normal, side.offset), edges) else { return };
            if self.is_at_side(bounds, &side, time, point) {
                return self.hit(time, part, point);
            }
            t = time;
        }
        let pull = path.a.length();
        let mut tumble = self.body.tumble(spec);
        for _ in 0..MOST_ADVANCES {
            let (x, v) = (path.after(t), path.velocity_after(t));
            let nearest = x.clamp(bounds.min, bounds.max);
            let offset = x - nearest;
            let away = offset.length() - spec.reach;
            let mut step;
            if away > 0.0 {
                // The sphere around the body, whose centre only falls.
                let n = offset / offset.length();
                step = earliest(away, n.dot(v), pull)
                    .max(1e-3 * away / (v.length() + pull * away).max(f64::MIN_POSITIVE).sqrt().max(v.length()));
            } else {
                let r = tumble.at(t);
                let w = self.spin_at(&tumble, t);
                if let Some(apart) = self.beside(bounds, &(x, v, w, r), pull) {
                    t += apart;
                    if t >= self.until || t.is_nan() {
                        return;
                    }
                    continue;
                }
                step = self.until - t;
                let mut first = (0, f64::INFINITY);
                let (speed, spin) = (v.length(), w.length());
                // How far a point at this distance from the centre of gravity can come within a time.
                let way = |arm: f64, time: f64| {
                    (speed + spin * arm + 0.5 * (pull + self.turning * arm) * time) * time + spec.gap
                };
                for (k, feeler) in spec.feelers[..spec.hull].iter().enumerate() {
                    let arm = r * feeler.centre;
                    if outside(bounds, x + arm) - feeler.radius > way(spec.arms[k], step) {
                        continue;
                    }
                    let foot = block.foot(x + arm, feeler.radius);
                    let f = foot.distance - feeler.radius - 0.5 * spec.gap;
                    let rate = foot.normal.dot(v + w.cross(arm));
                    if self.lasts(part, k) {
                        continue;
                    }
                    if f <= 0.5 * spec.gap && rate < 0.0 {
                        step = 0.0;
                        if f < first.1 {
                            first = (k, f);
                        }
                        continue;
                    }
                    let time = earliest(f, rate, pull + self.axial * spec.arms[k]);
                    if time < step {
                        step = time;
                        first = (k, f);
                    }
                }
                for (index, ring) in spec.rings.iter().enumerate() {
                    let near = outside(bounds, x + r.z_axis * ring.height) - ring.circle - ring.radius;
                    if near > way(spec.ring_arms[index], step) {
                        continue;
                    }
                    let up = block.up_at_ring(ring, x, &r);
                    let (up, swing) = (r.transpose() * up, r.transpose() * up.cross(w));
                    let first_of = spec.points_of(index).start;
                    for k in spec.points_of(index) {
                        let (feeler, quarter) = spec.ring_point(k, up, swing);
                        let foot = block.foot(x + r * feeler.centre, feeler.radius);
                        let (lever, swing) = (r.transpose() * foot.normal, r.transpose() * foot.normal.cross(w));
                        let height = foot.distance - lever.dot(feeler.centre) - 0.5 * spec.gap;
                        let fall = foot.normal.dot(v);
                        let gap = ring_gap(&feeler, quarter, (lever, swing), height, fall, (pull, self.turning));
                        let (p, q) = (lever.truncate(), swing.truncate());
                        if k == first_of && p != DVec2::ZERO && !self.lasts(part, k) {
                            // The box is behind the plane through the foot, and so farther from all of the ring than that plane.
                            let middle = height + lever.z * ring.height - ring.radius;
                            let m = pull + self.turning * spec.ring_arms[index];
                            let low =
                                rim::Low { middle, rate: fall + swing.z * ring.height, circle: ring.circle, p, q, m };
                            if gap[0] - low.at(0.0) <= 1e-6 * spec.gap {
                                self.ring_by_plane(k, gap, &low, &mut step, &mut first);
                            } else {
                                self.ring_at_edge(part, k, gap, &mut step, &mut first);
                            }
                            if self.body.phase == Phase::Flight {
                                break;
                            }
                            continue;
                        }
                        self.ring_at_edge(part, k, gap, &mut step, &mut first);
                    }
                }
                if step == 0.0 {
                    return self.hit(t, part, first.0);
                }
            }
            t += step;
            if t >= self.until || t.is_nan() {
                return;
            }
        }
        self.hit(t, part, 0);
    }

    /// Whether a point of the body is within the edges of a box's side.
    pub(in crate::rigid) fn is_at_side(&self, bounds: &Aabb, side: &Side, time: f64, point: usize) -> bool {
        if point == BEYOND {
            return false;
        }
        let mut tumble = self.body.tumble(self.spec);
        let (x, r) = (self.body.path.after(time), tumble.at(time));
        let swing = r.transpose() * side.normal.cross(self.spin_at(&tumble, time));
        let feeler = self.spec.point(point, r.transpose() * side.normal, swing);
        is_over(bounds, side.axis, x + r * feeler.centre)
    }

    /// Whether the lowest point of a ring comes first, against the plane through its foot.
    fn ring_by_plane(
        &self,
        k: usize,
        [f, rate, ..]: [f64; 4],
        low: &rim::Low,
        step: &mut f64,
        first: &mut (usize, f64),
    ) {
        let is_now = f <= 0.5 * self.spec.gap && rate < 0.0;
        let time = if is_now { 0.0 } else { low.earliest(*step) };
        if time < *step || (is_now && f < first.1) {
            (*step, *first) = (time, (k, f));
        }
    }

    /// Whether a point of a ring comes first.
    fn ring_at_edge(
        &self,
        part: u16,
        k: usize,
        [f, rate, slowest, m]: [f64; 4],
        step: &mut f64,
        first: &mut (usize, f64),
    ) {
        if self.lasts(part, k) {
            return;
        }
        if f <= 0.5 * self.spec.gap && rate < 0.0 {
            *step = 0.0;
            if f < first.1 {
                *first = (k, f);
            }
            return;
        }
        let time = if f > 0.5 * self.spec.gap { earliest(f, slowest, m) } else { earliest(f, rate, m / LEANS) };
        if time < *step {
            *step = time;
            *first = (k, f);
        }
    }

    /// Where the capsule around the body is beyond one side of a box: for how long at least it stays there.
    fn beside(&self, bounds: &Aabb, (x, v, w, r): &(DVec3, DVec3, DVec3, DMat3), pull: f64) -> Option<f64> {
        let [low, high, radius] = self.spec.capsule;
        let arms = [r.z_axis * low, r.z_axis * high];
        let mut longest: Option<f64> = None;
        for axis in 0..3 {
            for (side, face) in [(1.0, bounds.max[axis]), (-1.0, -bounds.min[axis])] {
                let gap = |arm: &DVec3| side * (x[axis] + arm[axis]) - face - radius;
                if gap(&arms[0]).min(gap(&arms[1])) > 0.1 * self.spec.size {
                    let time = |arm: &DVec3| {
                        earliest(gap(arm), side * (v + w.cross(*arm))[axis], pull + self.axial * arm.length())
                    };
                    let both = time(&arms[0]).min(time(&arms[1]));
                    longest = Some(longest.map_or(both, |l| l.max(both)));
                }
            }
        }
        longest
    }
}

/// How far a point is at least from a box: its distance from the farthest side, negative inside.
fn outside(bounds: &Aabb, p: DVec3) -> f64 {
    (bounds.min - p).max(p - bounds.max).max_element()
}

/// Gap of a point of a ring, its rate, the rate to reckon with, and a bound on its acceleration. The point moves round the ring as the body leans, which adds `ρ ω²` over the sine of the lean; for
/// bodies that hardly lean the circle's own bound is used instead, in which the whole rim falls as fast as its fastest point.
fn ring_gap(
    feeler: &Feeler,
    quarter: usize,
    (lever, swing): (DVec3, DVec3),
    height: f64,
    fall: f64,
    (pull, turning): (f64, f64),
) -> [f64; 4] {
    let f = height + lever.dot(feeler.centre) - feeler.radius;
    let circle = feeler.centre.truncate().length();
    let lean = lever.truncate().length();
    let middle = fall + swing.z * feeler.centre.z;
    let rate = fall + swing.dot(feeler.centre);
    let m = (pull + turning * feeler.centre.length()).max(0.0);
    if quarter == 0 && lean < LEANS {
        return [f, rate, middle - circle * swing.truncate().length(), m];
    }
    // Sideways points keep their place on the circle while the body spins.
    [f, rate, if quarter.is_multiple_of(2) { rate } else { middle }, m + turning * circle / lean.max(LEANS)]
}
