//! First contact of a body of revolution with a solid box, by the balls and rings of its skin.

use super::rim;
use super::static_search::StaticTimeOfImpact;
use crate::rigid::narrow_phase::foot::FootPoint;
use crate::rigid::static_shape::{StaticShape, distance_beyond, up_at_ring};
use crate::rigid::tolerances::{LEANING_RIM, LEAST_BOX_ADVANCE, MAX_STATIC_ADVANCES, SAME_BOX_GAP};
use crate::roots::earliest;
use crate::scenery::Aabb;
use crate::shape::ContactSphere;
use crate::special_case::SpecialCase;
use glam::{DMat3, DVec2, DVec3};

/// Where a body is, and how it moves.
struct Placed {
    x: DVec3,
    v: DVec3,
    r: DMat3,
    w: DVec3,
    /// Acceleration of its centre of gravity, in m/s².
    gravity: f64,
}

/// Which of a body's points examined so far touches first.
struct Soonest {
    /// How long nothing touches, in s.
    step: f64,
    /// The point that may touch then, and its gap now.
    point: usize,
    gap: f64,
}

impl Soonest {
    /// A point touches now; if several do, the deepest counts.
    fn touches(&mut self, point: usize, gap: f64) {
        self.step = 0.0;
        if gap < self.gap {
            (self.point, self.gap) = (point, gap);
        }
    }

    /// A point touches no sooner than after `time`.
    fn comes(&mut self, point: usize, gap: f64, time: f64) {
        if time < self.step {
            *self = Self { step: time, point, gap };
        }
    }
}

impl StaticTimeOfImpact<'_> {
    /// When, within these times after its clock, the body first touches a box.
    pub(crate) fn block(&mut self, part: u16, block: &StaticShape, [from, until]: [f64; 2]) {
        let StaticShape::Block { bounds, .. } = block else { return };
        let (spec, path) = (self.spec, &self.body.path);
        let mut t = from;
        let gravity = path.a.length();
        let mut free_rotation = self.body.free_rotation(spec);
        for _ in 0..MAX_STATIC_ADVANCES {
            let (x, v) = (path.after(t), path.velocity_after(t));
            let offset = x - x.clamp(bounds.min, bounds.max);
            let away = offset.length() - spec.bounding_radius;
            t += if away > 0.0 {
                // The sphere around the body: its centre only falls.
                let n = offset / offset.length();
                let least = LEAST_BOX_ADVANCE * away
                    / (v.length() + gravity * away).max(f64::MIN_POSITIVE).sqrt().max(v.length());
                earliest(away, n.dot(v), gravity).max(least)
            } else {
                let at = Placed { x, v, r: free_rotation.at(t), w: self.spin_at(&free_rotation, t), gravity };
                if SpecialCase::Capsules.is_on()
                    && let Some(apart) = self.beside(bounds, &at)
                {
                    apart
                } else {
                    let mut soonest = Soonest { step: until - t, point: 0, gap: f64::INFINITY };
                    self.spheres_at_block(part, block, &at, &mut soonest);
                    self.rings_at_block(part, block, &at, &mut soonest);
                    self.foot_at_edges(part, bounds, &at, &mut soonest);
                    if soonest.step == 0.0 {
                        return self.hit(t, part, soonest.point);
                    }
                    soonest.step
                }
            };
            if t >= until || t.is_nan() {
                return;
            }
        }
        self.hit(t, part, 0);
    }

    /// How far a point at this distance from the centre of gravity can move within a time.
    fn way(&self, at: &Placed, arm: f64, time: f64) -> f64 {
        (at.v.length() + at.w.length() * arm + 0.5 * (at.gravity + self.turning * arm) * time) * time + self.spec.gap
    }

    /// When those points of a body that are not on rings reach a box.
    fn spheres_at_block(&self, part: u16, block: &StaticShape, at: &Placed, soonest: &mut Soonest) {
        let StaticShape::Block { bounds, .. } = block else { return };
        let spec = self.spec;
        for (k, sphere) in spec.contact_spheres[..spec.hull].iter().enumerate() {
            let arm = at.r * sphere.centre;
            if distance_beyond(bounds, at.x + arm) - sphere.radius > self.way(at, spec.arms[k], soonest.step) {
                continue;
            }
            let projection = block.project(at.x + arm, sphere.radius);
            let f = projection.distance - sphere.radius - 0.5 * spec.gap;
            let rate = projection.normal.dot(at.v + at.w.cross(arm));
            if self.lasts(part, k) {
                continue;
            }
            if f <= 0.5 * spec.gap && rate < 0.0 {
                soonest.touches(k, f);
            } else {
                soonest.comes(k, f, earliest(f, rate, at.gravity + self.axial * spec.arms[k]));
            }
        }
    }

    /// When the points of a body's rings reach a box.
    fn rings_at_block(&self, part: u16, block: &StaticShape, at: &Placed, soonest: &mut Soonest) {
        let StaticShape::Block { bounds, .. } = block else { return };
        let Placed { x, v, r, w, gravity } = *at;
        let spec = self.spec;
        for (index, ring) in spec.rings.iter().enumerate() {
            let near = distance_beyond(bounds, x + r.z_axis * ring.height) - ring.circle - ring.radius;
            if near > self.way(at, spec.ring_arms[index], soonest.step) {
                continue;
            }
            let speed = v.length() + w.length() * spec.ring_arms[index];
            let up = up_at_ring(bounds, ring, x, &r);
            let (up, body_normal_rate) = (r.transpose() * up, r.transpose() * up.cross(w));
            let first_of = spec.points_of(index).start;
            for k in spec.points_of(index) {
                let (sphere, quarter) = spec.ring_point(k, up, body_normal_rate);
                let projection = block.project(x + r * sphere.centre, sphere.radius);
                let (body_normal, body_normal_rate) =
                    (r.transpose() * projection.normal, r.transpose() * projection.normal.cross(w));
                let height = projection.distance - body_normal.dot(sphere.centre) - 0.5 * spec.gap;
                let fall = projection.normal.dot(v);
                let gap =
                    ring_gap(&sphere, quarter, (body_normal, body_normal_rate), height, fall, (gravity, self.turning));
                let (p, q) = (body_normal.truncate(), body_normal_rate.truncate());
                if k != first_of || p == DVec2::ZERO || self.lasts(part, k) {
                    self.ring_at_edge(part, k, gap, speed, soonest);
                    continue;
                }
                // The box is behind the plane through the projection, so every point of the ring is at least as far
                // from the box as from that plane.
                let middle = height + body_normal.z * ring.height - ring.radius;
                let m = gravity + self.turning * spec.ring_arms[index];
                let low = rim::LowestRimPoint {
                    middle,
                    rate: fall + body_normal_rate.z * ring.height,
                    circle: ring.circle,
                    p,
                    q,
                    m,
                };
                if gap[0] - low.at(0.0) <= SAME_BOX_GAP * spec.gap {
                    self.ring_by_plane(k, gap, &low, soonest);
                } else {
                    self.ring_at_edge(part, k, gap, speed, soonest);
                }
                if self.body.flies() {
                    break;
                }
            }
        }
    }

    /// When the foot reaches an edge of a box that crosses it. An edge comes under the foot over its rim, which has
    /// another bound.
    fn foot_at_edges(&self, part: u16, bounds: &Aabb, at: &Placed, soonest: &mut Soonest) {
        let Placed { x, v, ref r, w, gravity } = *at;
        let (spec, z) = (self.spec, r.z_axis);
        let (ring, arm) = (&spec.rings[0], spec.ring_arms[0]);
        let middle = x + z * ring.height;
        let reach = ring.circle + ring.radius + self.way(at, arm, soonest.step);
        if distance_beyond(bounds, middle) > reach {
            return;
        }
        // The disc's plane swings about the centre of gravity, and an edge is a fixed line.
        let across = w.cross(z).length();
        let fastest = v.length() + gravity * soonest.step;
        let m = gravity + self.axial * (arm + reach) + 2.0 * across * fastest;
        let first = spec.foot_points().start;
        FootPoint::for_near_edges(bounds, middle, reach, |number| {
            let Some(foot) = FootPoint::new(bounds, ring, x, r, number).filter(|foot| foot.is_beside(ring)) else {
                return;
            };
            let (k, f) = (first + number, foot.gap - 0.5 * spec.gap);
            let rate = foot.normal.dot(v + w.cross(foot.arm));
            let closes = earliest(f, rate, m);
            if !foot.is_under(ring) {
                let turns = (-foot.facing - 0.5 * LEANING_RIM) / across;
                soonest.comes(k, f, if f > 0.0 { turns.max(closes) } else { turns });
            } else if self.lasts(part, k) {
            } else if f > 0.5 * spec.gap {
                soonest.comes(k, f, closes);
            } else if rate < 0.0 {
                soonest.touches(k, f);
            } else {
                // It opens. The chord is not halved so soon, and until then its end runs along the edge no faster.
                let speed = v.length() + w.length() * arm;
                let runs = 2.0 * speed * ring.circle / foot.half_chord;
                let halves = 0.375 * foot.half_chord * foot.half_chord / (ring.circle * speed);
                soonest.comes(k, f, earliest(f, rate, m + across * runs).min(halves).max(-f / speed));
            }
        });
    }

    /// Whether the lowest point of a ring comes first, tested against the plane through its projection.
    fn ring_by_plane(&self, k: usize, [f, rate, ..]: [f64; 4], low: &rim::LowestRimPoint, soonest: &mut Soonest) {
        let is_now = f <= 0.5 * self.spec.gap && rate < 0.0;
        let time = if is_now { 0.0 } else { low.earliest(soonest.step) };
        if time < soonest.step || (is_now && f < soonest.gap) {
            *soonest = Soonest { step: time, point: k, gap: f };
        }
    }

    /// Whether a point of a ring, which is at most this fast, comes first.
    fn ring_at_edge(&self, part: u16, k: usize, [f, rate, slowest, m]: [f64; 4], speed: f64, soonest: &mut Soonest) {
        if self.lasts(part, k) {
            return;
        }
        if f <= 0.5 * self.spec.gap && rate < 0.0 {
            return soonest.touches(k, f);
        }
        let time = if f > 0.5 * self.spec.gap {
            earliest(f, slowest, m)
        } else {
            // It opens. An overlap may at most double until it is examined again.
            earliest(f, rate, m / LEANING_RIM).max(-f / speed)
        };
        soonest.comes(k, f, time);
    }

    /// If the capsule around the body is beyond one side of a box: a lower bound on how long it stays there.
    fn beside(&self, bounds: &Aabb, &Placed { x, v, r, w, gravity }: &Placed) -> Option<f64> {
        let [low, high, radius] = self.spec.capsule;
        let arms = [r.z_axis * low, r.z_axis * high];
        let mut longest: Option<f64> = None;
        for axis in 0..3 {
            for (side, face) in [(1.0, bounds.max[axis]), (-1.0, -bounds.min[axis])] {
                let gap = |arm: &DVec3| side * (x[axis] + arm[axis]) - face - radius;
                if gap(&arms[0]).min(gap(&arms[1])) > 0.1 * self.spec.size {
                    let time = |arm: &DVec3| {
                        earliest(gap(arm), side * (v + w.cross(*arm))[axis], gravity + self.axial * arm.length())
                    };
                    let both = time(&arms[0]).min(time(&arms[1]));
                    longest = Some(longest.map_or(both, |l| l.max(both)));
                }
            }
        }
        longest
    }
}

/// Gap of a ring's point, its rate, the rate used for the bound, and a bound on its acceleration. The point moves round
/// the ring as the body leans, which adds `ρ ω²` over the sine of the lean. For bodies that hardly lean, the circle's
/// own bound is used instead: the whole rim is taken to fall as fast as its fastest point.
fn ring_gap(
    sphere: &ContactSphere,
    quarter: usize,
    (body_normal, body_normal_rate): (DVec3, DVec3),
    height: f64,
    fall: f64,
    (gravity, turning): (f64, f64),
) -> [f64; 4] {
    let f = height + body_normal.dot(sphere.centre) - sphere.radius;
    let circle = sphere.centre.truncate().length();
    let lean = body_normal.truncate().length();
    let middle = fall + body_normal_rate.z * sphere.centre.z;
    let rate = fall + body_normal_rate.dot(sphere.centre);
    let m = (gravity + turning * sphere.centre.length()).max(0.0);
    if quarter == 0 && lean < LEANING_RIM {
        return [f, rate, middle - circle * body_normal_rate.truncate().length(), m];
    }
    // Sideways points keep their place on the circle while the body spins.
    [f, rate, if quarter.is_multiple_of(2) { rate } else { middle }, m + turning * circle / lean.max(LEANING_RIM)]
}
