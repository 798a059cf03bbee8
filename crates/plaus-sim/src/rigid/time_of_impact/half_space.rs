//! First contact with a half space.

use super::rim;
use super::static_search::StaticTimeOfImpact;
use crate::rigid::RIM_POINTS;
use crate::rigid::body_state::Phase;
use crate::rigid::tolerances::{LEANING_RIM, MAX_STATIC_ADVANCES, PLANE_CAPSULE_MARGIN};
use crate::roots::{earliest, fall_of_quadratic};
use crate::special_case::SpecialCase;
use glam::{DVec2, DVec3};

/// The body against the half space at one time of the search.
struct Look {
    part: u16,
    t: f64,
    /// Height of the centre of gravity over the plane, minus half the gap.
    height: f64,
    /// Rate of the height.
    fall: f64,
    /// The normal in body axes, and its rate there.
    body_normal: DVec3,
    body_normal_rate: DVec3,
    /// Acceleration of the centre of gravity towards the plane.
    gravity: f64,
}

/// How far the body may go, and which point then touches first.
struct Advance {
    step: f64,
    first: Option<(usize, f64)>,
}

impl Advance {
    /// A point with gap `f` cannot touch before `time`.
    fn not_before(&mut self, time: f64, point: usize, f: f64) {
        if time < self.step {
            self.step = time;
            self.first = Some((point, f));
        }
    }

    /// A point touches now; the deepest counts.
    fn now(&mut self, point: usize, f: f64) {
        if self.step > 0.0 || self.first.is_none_or(|(_, deepest)| f < deepest) {
            self.first = Some((point, f));
        }
        self.step = 0.0;
    }

    /// Whether a gap with at most this acceleration cannot close within the step.
    #[inline]
    fn outlasts(&self, f: f64, rate: f64, m: f64) -> bool {
        f > 0.0 && f + (rate - 0.5 * m * self.step) * self.step > 0.0
    }
}

impl StaticTimeOfImpact<'_> {
    /// When, after the clock and within `[from, until]`, and with which point the body first reaches a half space.
    pub(crate) fn half_space(
        &self,
        part: u16,
        (n, offset): (DVec3, f64),
        [from, until]: [f64; 2],
    ) -> Option<(f64, usize)> {
        let (spec, path) = (self.spec, &self.body.path);
        let mut t = self.approach(n, offset, from, until)?;
        if spec.is_ball && self.body.phase != Phase::Step && SpecialCase::BallOnPlane.is_on() {
            if self.lasts(part, 0) {
                return None;
            }
            let height = n.dot(path.after(from)) - offset - spec.contact_spheres[0].radius - 0.5 * spec.gap;
            let fall = [height, n.dot(path.velocity_after(from)), 0.5 * n.dot(path.a)];
            return Some((from + fall_of_quadratic(fall, until - from)?, 0));
        }
        let gravity = -n.dot(path.a);
        let mut free_rotation = self.body.free_rotation(spec);
        let view = free_rotation.view(n);
        for _ in 0..MAX_STATIC_ADVANCES {
            let (body_normal, body_normal_rate) = free_rotation.see(&view, t);
            let look = Look {
                part,
                t,
                height: n.dot(path.after(t)) - offset - 0.5 * spec.gap,
                fall: n.dot(path.velocity_after(t)),
                body_normal,
                body_normal_rate,
                gravity,
            };
            let mut next = Advance { step: until - t, first: None };
            match self.capsule(&look, next.step).filter(|_| SpecialCase::Capsules.is_on()) {
                Some(apart) if t + apart >= until => return None,
                Some(apart) => {
                    t += apart;
                    continue;
                }
                None => {}
            }
            self.balls(&look, &mut next);
            for k in 0..spec.rings.len() {
                self.ring(&look, k, &mut next);
            }
            let (first, _) = next.first?;
            if next.step == 0.0 {
                return Some((t, first));
            }
            t += next.step;
            if t >= until || t.is_nan() {
                return None;
            }
        }
        Some((t, 0))
    }

    /// A lower bound on how long the capsule around the body stays clear of the plane, if that is worth a step of the
    /// search.
    fn capsule(&self, look: &Look, step: f64) -> Option<f64> {
        let [low, high, radius] = self.spec.capsule;
        let mut soonest = f64::INFINITY;
        for end in [low, high] {
            let f = look.height + look.body_normal.z * end - radius;
            let (rate, m) =
                (look.fall + look.body_normal_rate.z * end, (look.gravity + self.axial * end.abs()).max(0.0));
            let clear = f > 0.0 && f + (rate - 0.5 * m * step) * step > 0.0;
            if !clear && f <= PLANE_CAPSULE_MARGIN * self.spec.size {
                return None;
            }
            soonest = soonest.min(if clear { step } else { earliest(f, rate, m) });
        }
        Some(soonest)
    }

    fn balls(&self, look: &Look, next: &mut Advance) {
        let (spec, half) = (self.spec, 0.5 * self.spec.gap);
        let (height, fall, body_normal, body_normal_rate) =
            (look.height, look.fall, look.body_normal, look.body_normal_rate);
        for (k, (sphere, arm)) in spec.contact_spheres[..spec.hull].iter().zip(&spec.arms).enumerate() {
            let f = height + body_normal.dot(sphere.centre) - sphere.radius;
            let rate = fall + body_normal_rate.dot(sphere.centre);
            let m = (look.gravity + self.axial * arm).max(0.0);
            if next.outlasts(f, rate, m) || self.lasts(look.part, k) {
                continue;
            }
            if f <= half && rate < 0.0 {
                next.now(k, f);
                continue;
            }
            next.not_before(earliest(f, rate, m), k, f);
        }
    }

    /// The time within which a point at this distance from the centre of gravity cannot double an overlap. It is
    /// examined again then: where it opens slowly, the time at which it may sink again comes nearer without end.
    fn doubles(&self, look: &Look, f: f64, arm: f64) -> f64 {
        if f >= 0.0 { 0.0 } else { -f / (self.body.path.velocity_after(look.t).length() + self.fastest * arm) }
    }

    /// The lowest point of a ring. On the rim also the sideways points and the highest one, which may touch while the
    /// lowest does.
    fn ring(&self, look: &Look, index: usize, next: &mut Advance) {
        let (spec, ring) = (self.spec, &self.spec.rings[index]);
        let point = spec.points_of(index).start;
        let (p, q) = (look.body_normal.truncate(), look.body_normal_rate.truncate());
        let m = (look.gravity + self.turning * spec.ring_arms[index]).max(0.0);
        let middle = look.height + look.body_normal.z * ring.height - ring.radius;
        let rate = look.fall + look.body_normal_rate.z * ring.height;
        if next.outlasts(middle - ring.circle * p.length(), rate - ring.circle * q.length(), m) {
            return;
        }
        let f = middle - ring.circle * p.length();
        if p != DVec2::ZERO && !self.lasts(look.part, point) {
            let along = rate - ring.circle * p.dot(q) / p.length();
            if f <= 0.5 * spec.gap && along < 0.0 {
                next.now(point, f);
            } else {
                let low = rim::LowestRimPoint { middle, rate, circle: ring.circle, p, q, m };
                let time = low.earliest(next.step).max(self.doubles(look, f, spec.ring_arms[index]));
                next.not_before(time, point, f);
            }
        }
        if index == 0 && (p == DVec2::ZERO || !self.body.flies()) {
            for quarter in usize::from(p != DVec2::ZERO)..RIM_POINTS {
                self.rim_point(look, point + quarter, [middle, rate, m], next);
            }
        }
    }

    /// A point of the rim that is not its lowest. The sideways points are as high as the rim's middle, whichever way
    /// the body turns.
    fn rim_point(&self, look: &Look, point: usize, [middle, rate, m]: [f64; 3], next: &mut Advance) {
        if self.lasts(look.part, point) {
            return;
        }
        let (sphere, quarter) = self.spec.ring_point(point, look.body_normal, look.body_normal_rate);
        let f = middle + look.body_normal.truncate().dot(sphere.centre.truncate());
        let own = rate + look.body_normal_rate.truncate().dot(sphere.centre.truncate());
        if f > 0.5 * self.spec.gap {
            next.not_before(earliest(f, if quarter.is_multiple_of(2) { own } else { rate }, m), point, f);
        } else if own < 0.0 {
            next.now(point, f);
        } else {
            let time = earliest(f, own, m / LEANING_RIM).max(self.doubles(look, f, sphere.centre.length()));
            next.not_before(time, point, f);
        }
    }
}
