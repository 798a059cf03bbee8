//! First contact of a turning body with a fixed part, by conservative advancement of second order.
//!
//! Each feeler's gap `f` obeys `f(t + τ) ≥ f + f′ τ − M τ²/2`, where `M` bounds its acceleration towards the part: gravity, rotation, and the surface's curvature times speed
//! squared. The body is advanced by the first root of these parabolas over all feelers, which cannot overshoot and converges quadratically, until a gap is
//! below `accuracy.gap` and closing. A gap that is small but opening is no event (rule of `crate::roots`); the search goes on from where it can close again.

use super::body::{Phase, Turning};
use super::part::{Part, ROUNDS, Table};
use super::{Rigid, Skin, Spec};
use crate::field::Bounds;
use crate::roots::fall_of_quadratic;
use crate::scenery::{Aabb, Plane, Surface};
use crate::shape::Feeler;
use glam::{DMat3, DVec3};

/// Most advancements of one search. Where they are spent the nearest point's time is handed on as an event: the body is looked at anew.
const MOST_ADVANCES: usize = 200;

/// Time until a gap `f` with rate `rate` and acceleration at least `-m` can be gone.
#[inline]
pub(super) fn earliest(f: f64, rate: f64, m: f64) -> f64 {
    if f > 0.0 {
        let root = (rate * rate + 2.0 * m * f).sqrt();
        if rate < 0.0 {
            2.0 * f / (root - rate)
        } else if m > 0.0 {
            (rate + root) / m
        } else {
            f64::INFINITY
        }
    } else if rate <= 0.0 {
        0.0
    } else if m > 0.0 {
        // Overlapping but opening: not before the rate has turned.
        let discriminant = rate * rate + 2.0 * m * f;
        (rate + discriminant.max(0.0).sqrt()) / m
    } else {
        f64::INFINITY
    }
}

/// A search for the first contact of one body.
struct Search<'s> {
    spec: &'s Spec,
    body: &'s Turning,
    /// Largest angular speed.
    fastest: f64,
    /// Acceleration of a point per its distance from the centre.
    turning: f64,
    /// The same for points on the axis of a body of revolution.
    axial: f64,
    until: f64,
    found: Option<(f64, Surface)>,
}

impl Rigid {
    /// First point of a body that touches a part, not after `until`.
    pub(super) fn first_touch(&self, index: usize, body: &Turning, until: f64) -> Option<(f64, Surface)> {
        if !matches!(body.phase, Phase::Flight | Phase::Step | Phase::Glide) {
            return None;
        }
        let spec = &self.specs[index];
        let free = body.phase == Phase::Flight;
        let momentum = spec.inertia.momentum(body.turn, body.spin).length();
        let fastest = if free {
            (momentum / spec.inertia.moments.min_element()).min(body.spin.length() * (1.0 + spec.wobble))
        } else {
            body.spin.length()
        };
        let fastest = if spec.wobble == 0.0 || !free { body.spin.length() } else { fastest };
        let turning = fastest * fastest * if free { 1.0 + spec.wobble } else { 1.0 };
        // The axis of a top only swings: at |L|/I₁ in flight, with the body in a step.
        let across = body.spin.reject_from_normalized(body.turn * DVec3::Z).length();
        let axial = match spec.skin {
            Skin::Revolved => across * if free { momentum / spec.inertia.moments.x } else { body.spin.length() },
            _ => turning,
        };
        let mut search = Search { spec, body, fastest, turning, axial, until: until - body.path.t, found: None };
        for (k, part) in self.parts.iter().enumerate() {
            match part {
                Part::Plane(plane) => search.plane(k as u16, plane),
                Part::Block { .. } => search.block(k as u16, part),
                Part::Table(table) => search.table(k as u16, table),
            }
        }
        let (time, surface) = search.found?;
        Some((body.path.t + time, surface))
    }
}

impl Search<'_> {
    /// Whether a point of the body is in lasting contact with the part already.
    #[inline]
    fn lasts(&self, part: u16, point: usize) -> bool {
        matches!(self.body.phase, Phase::Step | Phase::Glide)
            && self.body.touching().contains(&Surface::Part { part, point: point as u16 })
    }

    fn hit(&mut self, time: f64, part: u16, point: usize) {
        self.until = time;
        self.found = Some((time, Surface::Part { part, point: point as u16 }));
    }

    /// When the sphere around the body comes down to `level` along `normal`.
    fn approach(&self, normal: DVec3, level: f64) -> Option<f64> {
        let path = &self.body.path;
        let height = normal.dot(path.x) - level - self.spec.reach;
        if height <= 0.0 {
            return Some(0.0);
        }
        fall_of_quadratic([height, normal.dot(path.v), 0.5 * normal.dot(path.a)], self.until)
    }

    fn plane(&mut self, part: u16, plane: &Plane) {
        let (spec, path, n) = (self.spec, &self.body.path, plane.normal);
        let Some(mut t) = self.approach(n, plane.offset) else { return };
        if spec.is_ball && self.body.phase != Phase::Step {
            if self.lasts(part, 0) {
                return;
            }
            let height = n.dot(path.x) - plane.offset - spec.feelers[0].radius - 0.5 * spec.gap;
            if let Some(time) = fall_of_quadratic([height, n.dot(path.v), 0.5 * n.dot(path.a)], self.until) {
                self.hit(time, part, 0);
            }
            return;
        }
        let pull = -n.dot(path.a);
        let mut tumble = self.body.tumble(spec);
        for _ in 0..MOST_ADVANCES {
            let (x, v) = (path.after(t), path.velocity_after(t));
            let r = tumble.at(t);
            let w = self.spin_at(t);
            let (height, fall) = (n.dot(x) - plane.offset - 0.5 * spec.gap, n.dot(v));
            let (lever, swing) = (r.transpose() * n, r.transpose() * n.cross(w));
            let mut step = f64::INFINITY;
            let mut first = (0, f64::INFINITY);
            for (k, feeler) in spec.feelers[..spec.hull].iter().enumerate() {
                let f = height + lever.dot(feeler.centre) - feeler.radius;
                let rate = fall + swing.dot(feeler.centre);
                let m = (pull + self.axial * feeler.centre.length()).max(0.0);
                // Cheap test first: whether it can be gone before the others at all.
                if f > 0.0 && step.is_finite() && f + (rate - 0.5 * m * step) * step > 0.0 {
                    continue;
                }
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
                let time = earliest(f, rate, m);
                if time < step {
                    step = time;
                    first = (k, f);
                }
            }
            for k in spec.ring_points() {
                let (feeler, quarter) = spec.ring_point(k, lever);
                let gap = ring_gap(&feeler, quarter, (lever, swing), height, fall, (pull, self.turning));
                self.ring(part, k, gap, &mut step, &mut first);
            }
            if step == 0.0 {
                return self.hit(t, part, first.0);
            }
            t += step;
            if t >= self.until || t.is_nan() {
                return;
            }
        }
        self.hit(t, part, 0);
    }

    /// Whether a point of a ring comes first.
    fn ring(&self, part: u16, k: usize, [f, rate, slowest, m]: [f64; 4], step: &mut f64, first: &mut (usize, f64)) {
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

    /// Angular velocity after `t`; only a top's moves.
    #[inline]
    fn spin_at(&self, t: f64) -> DVec3 {
        if self.spec.wobble == 0.0 || self.body.phase != Phase::Flight {
            self.body.spin
        } else {
            self.body.motion_after(self.spec, t).w
        }
    }

    fn block(&mut self, part: u16, block: &Part) {
        let Part::Block { bounds, material, .. } = block else { return };
        let (spec, path) = (self.spec, &self.body.path);
        if spec.is_ball && self.lasts(part, 0) {
            // Its only point; that it leaves the box is an event of its motion.
            return;
        }
        let swept = path.bounds(0.0, self.until).grown(spec.reach);
        if !bounds.grown(spec.gap).meets(&swept) {
            return;
        }
        let over = swept.min.x > bounds.min.x
            && swept.max.x < bounds.max.x
            && swept.min.y > bounds.min.y
            && swept.max.y < bounds.max.y;
        if over && path.x.z > bounds.max.z {
            // Only its upper side is in question.
            return self.plane(part, &Plane { normal: DVec3::Z, offset: bounds.max.z, material: *material });
        }
        let pull = path.a.length();
        let mut tumble = self.body.tumble(spec);
        let mut t = 0.0;
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
                let w = self.spin_at(t);
                if let Some(apart) = self.beside(bounds, &(x, v, w, r), pull) {
                    t += apart;
                    if t >= self.until || t.is_nan() {
                        return;
                    }
                    continue;
                }
                step = f64::INFINITY;
                let mut first = (0, f64::INFINITY);
                for (k, feeler) in spec.feelers[..spec.hull].iter().enumerate() {
                    let arm = r * feeler.centre;
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
                    let time = earliest(f, rate, pull + self.axial * feeler.centre.length());
                    if time < step {
                        step = time;
                        first = (k, f);
                    }
                }
                let up = r.transpose() * block.foot(x, spec.reach).normal;
                for k in spec.ring_points() {
                    let (feeler, quarter) = spec.ring_point(k, up);
                    let arm = r * feeler.centre;
                    let foot = block.foot(x + arm, feeler.radius);
                    let (lever, swing) = (r.transpose() * foot.normal, r.transpose() * foot.normal.cross(w));
                    let height = foot.distance - lever.dot(feeler.centre) - 0.5 * spec.gap;
                    let gap =
                        ring_gap(&feeler, quarter, (lever, swing), height, foot.normal.dot(v), (pull, self.turning));
                    self.ring(part, k, gap, &mut step, &mut first);
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

    fn table(&mut self, part: u16, table: &Table) {
        let (spec, path) = (self.spec, &self.body.path);
        // Above the highest that the field can be there is nothing to look at.
        let Some(mut t) = self.approach(DVec3::Z, table.height.range()[1]) else { return };
        let gravity = path.a.length();
        let mut tumble = self.body.tumble(spec);
        let margin = 0.5 * spec.reach;
        let mut window: Option<(DVec3, Bounds)> = None;
        for _ in 0..MOST_ADVANCES {
            let (x, v) = (path.after(t), path.velocity_after(t));
            let (around, bounds) = match window {
                Some((c, b)) if (x - c).truncate().abs().max_element() < 0.9 * margin => (c, b),
                _ => {
                    let far = spec.reach + margin;
                    let Some(b) = table.height.bounds([x.x - far, x.y - far], [x.x + far, x.y + far]) else {
                        // A footprint of thousands of cells: nothing is known about it but its height.
                        return self.coarse(part, t);
                    };
                    window = Some((x, b));
                    (x, b)
                }
            };
            // Not out of the window, nor so long that speeds grow much.
            let speed = v.length() + (gravity * spec.reach).sqrt();
            let room = margin - (x - around).truncate().abs().max_element();
            let mut step = (room / speed).min(spec.reach / speed);
            let top = x.z - spec.reach - bounds.high;
            if top > 0.0 {
                t += earliest(top, v.z, -path.a.z).min(step);
            } else {
                let r = tumble.at(t);
                let w = self.spin_at(t);
                let mut first = None;
                for (k, feeler) in spec.feelers.iter().enumerate() {
                    self.table_feeler((part, k), feeler, table, &bounds, &(x, v, w, r), &mut step, &mut first);
                }
                if step == 0.0 {
                    return self.hit(t, part, first.map_or(0, |(k, _)| k));
                }
                t += step;
            }
            if t >= self.until || t.is_nan() {
                return;
            }
        }
        self.hit(t, part, 0);
    }

    #[allow(clippy::too_many_arguments)]
    #[inline]
    fn table_feeler(
        &self,
        (part, k): (u16, usize),
        feeler: &Feeler,
        table: &Table,
        bounds: &Bounds,
        (x, v, w, r): &(DVec3, DVec3, DVec3, DMat3),
        step: &mut f64,
        first: &mut Option<(usize, f64)>,
    ) {
        let spec = self.spec;
        let arm = *r * feeler.centre;
        let p = *x + arm;
        let pv = *v + w.cross(arm);
        let turning = self.turning * feeler.centre.length();
        let gravity = self.body.path.a;
        // Against the highest point around first.
        let low = p.z - feeler.radius - bounds.high;
        let m_low = (turning - gravity.z).max(0.0);
        if low > 0.0 && low + (pv.z - 0.5 * m_low * *step) * *step > 0.0 {
            return;
        }
        let (f, rate) = if feeler.radius > 0.0 {
            let foot = table.foot(p, ROUNDS);
            (foot.distance - feeler.radius, foot.normal.dot(pv))
        } else {
            let s = table.height.at(p.x, p.y);
            (p.z - s.value, pv.z - s.slope[0] * pv.x - s.slope[1] * pv.y)
        };
        let f = f - 0.5 * spec.gap;
        let speed = v.length() + self.fastest * feeler.centre.length() + gravity.length() * *step;
        let across = (1.0 + bounds.slope * bounds.slope).sqrt();
        let m = m_low.max(0.0) * across + bounds.bend * speed * speed;
        if f > 0.5 * spec.gap && f + (rate - 0.5 * m * *step) * *step > 0.0 {
            return;
        }
        if self.lasts(part, k) {
            return;
        }
        if f <= 0.5 * spec.gap && rate < 0.0 {
            if *step > 0.0 || first.is_none_or(|(_, deepest)| f < deepest) {
                *first = Some((k, f));
            }
            *step = 0.0;
            return;
        }
        let time = earliest(f, rate, m);
        if time < *step {
            *step = time;
        }
    }

    /// A body so large against the grid that its footprint is not looked at: it counts as touching where it comes down to the field's highest value.
    fn coarse(&mut self, part: u16, t: f64) {
        self.hit(t, part, 0);
    }
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

/// Sine of the lean from which the lowest point of a rim is followed. Default 0.02; smaller values take more advancements, larger ones see impacts a little early.
const LEANS: f64 = 0.02;
