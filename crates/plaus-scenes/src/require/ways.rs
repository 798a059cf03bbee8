//! Exact answers about motions in closed form: extremes of distances over pieces, without samples in time.

use glam::DVec3;
use plaus_animation::{Piece, Track, Turn};
use plaus_dist::math;
use plaus_sim::roots::{refine, roots_of_quadratic};

/// Standard gravity, m/s², which is the gravity of all scenes to a part in a thousand.
const GRAVITY: f64 = 9.806_65;

/// A part of a piece: position `p + v t + ½ a t²` for `t` from 0 to `length`, in m and s, z up.
#[derive(Debug, Clone, Copy)]
pub(super) struct Leg {
    pub(super) p: DVec3,
    pub(super) v: DVec3,
    pub(super) a: DVec3,
    pub(super) length: f64,
    /// How it turns, along an animation's axes, and since how many seconds.
    pub(super) turn: Turn,
    pub(super) since: f64,
}

/// From an animation's axes to a scenario's, in which z points up; exact.
pub(super) fn level(v: DVec3) -> DVec3 {
    DVec3::new(v.x, -v.z, v.y)
}

impl Leg {
    /// Where it is after `t` s.
    pub(super) fn at(&self, t: f64) -> DVec3 {
        self.p + t * (self.v + 0.5 * t * self.a)
    }

    /// Its first half and its second.
    pub(super) fn halves(&self) -> [Self; 2] {
        let length = 0.5 * self.length;
        let (p, v, since) = (self.at(length), self.v + length * self.a, self.since + length);
        [Self { length, ..*self }, Self { p, v, length, since, ..*self }]
    }

    fn of(piece: &Piece, from: f64, to: f64) -> Self {
        let waits = from < piece.start;
        Self {
            p: level(piece.position(from)),
            v: if waits { DVec3::ZERO } else { level(piece.velocity(from)) },
            a: if waits { DVec3::ZERO } else { level(piece.acceleration) },
            length: (to - from).max(0.0),
            turn: if waits { Turn::still(piece.turn.orientation) } else { piece.turn },
            since: (from - piece.start).max(0.0),
        }
    }

    /// The motion of this leg relative to another one with the same beginning and length.
    pub(super) fn seen_from(&self, other: &Self) -> Self {
        Self { p: self.p - other.p, v: self.v - other.v, a: self.a - other.a, ..*self }
    }

    /// Times at which the distance from `point` may be least or largest: the ends, and where its derivative is 0.
    fn turning_points(&self, point: DVec3) -> Vec<f64> {
        let p = self.p - point;
        // Half the derivative of the squared distance.
        let c = [p.dot(self.v), self.v.dot(self.v) + p.dot(self.a), 1.5 * self.v.dot(self.a), 0.5 * self.a.dot(self.a)];
        let value = |t: f64| c[0] + t * (c[1] + t * (c[2] + t * c[3]));
        let slope = |t: f64| c[1] + t * (2.0 * c[2] + t * 3.0 * c[3]);
        let mut ends = vec![0.0];
        let bends = roots_of_quadratic([c[1], 2.0 * c[2], 3.0 * c[3]]).into_iter().flatten();
        ends.extend(bends.filter(|t| *t > 0.0 && *t < self.length));
        ends.push(self.length);
        let crossings = ends.windows(2).filter_map(|pair| {
            let (low, high) = (value(pair[0]), value(pair[1]));
            (low * high < 0.0).then(|| refine(|t| (value(t), slope(t)), pair[0], pair[1], low > 0.0))
        });
        let crossings: Vec<f64> = crossings.collect();
        ends.extend(crossings);
        ends
    }

    /// Least and largest distance from a point, in m.
    pub(super) fn distances(&self, point: DVec3) -> [f64; 2] {
        let distances = self.turning_points(point).into_iter().map(|t| self.at(t).distance(point));
        distances.fold([f64::INFINITY, 0.0], |[low, high], d| [low.min(d), high.max(d)])
    }

    /// Least and greatest height, in m.
    pub(super) fn heights(&self) -> [f64; 2] {
        extremes_of_smallest(&[[self.p.z, self.v.z, 0.5 * self.a.z]], self.length)
    }

    /// Least and greatest speed, in m/s.
    pub(super) fn speeds(&self) -> [f64; 2] {
        let Self { v, a, .. } = self;
        let squares = [v.length_squared(), 2.0 * v.dot(*a), a.length_squared()];
        extremes_of_smallest(&[squares], self.length).map(|square| square.max(0.0).sqrt())
    }

    /// How fast it turns, in rad/s: as its own third axis goes round its spin, always as fast.
    pub(super) fn spin(&self) -> f64 {
        match self.turn.own {
            0.0 => self.turn.spin.length(),
            own => (self.turn.spin + own * (self.turn.orientation * DVec3::Z)).length(),
        }
    }

    /// Its third axis: what of it stays along its spin, what goes round that, and a quarter turn later; with how fast
    /// it goes round, in rad/s.
    fn third_axis(&self) -> ([DVec3; 3], f64) {
        let (axis, pole) = (self.turn.after(self.since) * DVec3::Z, self.turn.spin.normalize_or_zero());
        let along = axis.dot(pole) * pole;
        ([along, axis - along, pole.cross(axis)], self.turn.spin.length())
    }

    /// The integral of its angular velocity, in rad.
    pub(super) fn turned(&self) -> DVec3 {
        let ([along, across, later], rate) = self.third_axis();
        let round = if rate * self.length == 0.0 {
            self.length * across
        } else {
            let (sin, cos) = math::sin_cos(rate * self.length);
            (sin * across + (1.0 - cos) * later) / rate
        };
        level(self.length * self.turn.spin + self.turn.own * (self.length * along + round))
    }

    /// After how many seconds the cosine of its third axis' angle with the vertical is first at most this.
    pub(super) fn leans(&self, cosine: f64) -> Option<f64> {
        let ([along, across, later], rate) = self.third_axis();
        // What of the axis is upright: along + across cos ωt + later sin ωt.
        let [along, across, later] = [along.y, across.y, later.y];
        if along + across <= cosine {
            return Some(0.0);
        }
        let most = (across * across + later * later).sqrt();
        let lowered = (cosine - along) / most;
        if most == 0.0 || lowered < -1.0 {
            return None;
        }
        let time = (math::acos(lowered.min(1.0)) + math::atan2(later, across)) / rate;
        (time <= self.length).then_some(time)
    }

    /// Whether only gravity changes its velocity.
    pub(super) fn is_flight(&self) -> bool {
        self.a.x == 0.0 && self.a.y == 0.0 && (self.a.z + GRAVITY).abs() < 1e-3 * GRAVITY
    }

    /// The length of its path, in m.
    pub(super) fn path_length(&self) -> f64 {
        let (a, along) = (self.a.length(), self.a.normalize_or_zero());
        if a == 0.0 {
            return self.v.length() * self.length;
        }
        // Speed √(w² + u²) with u = u₀ + a t along the acceleration and w across it.
        let u = self.v.dot(along);
        let w = (self.v - u * along).length();
        let whole = |u: f64| {
            let speed = (u * u + w * w).sqrt();
            let bent = if w == 0.0 { 0.0 } else { w * w * asinh(u / w) };
            0.5 * (u * speed + bent)
        };
        ((whole(u + a * self.length) - whole(u)) / a).max(0.0)
    }
}

/// Inverse hyperbolic sine, odd to the last bit.
fn asinh(x: f64) -> f64 {
    let y = x.abs();
    math::ln_1p(y + y * y / (1.0 + (1.0 + y * y).sqrt())).copysign(x)
}

/// A quadratic `c₀ + c₁ t + c₂ t²`.
pub(super) type Quadratic = [f64; 3];

fn value(c: &Quadratic, t: f64) -> f64 {
    c[0] + t * (c[1] + t * c[2])
}

/// Least and largest value, over `0 ≤ t ≤ length`, of the smallest of some quadratics. Each is at an end, at a vertex
/// of one quadratic, or at a crossing of two.
pub(super) fn extremes_of_smallest(all: &[Quadratic], length: f64) -> [f64; 2] {
    let mut times = vec![0.0, length];
    times.extend(all.iter().filter(|c| c[2] != 0.0).map(|c| -0.5 * c[1] / c[2]));
    for (i, a) in all.iter().enumerate() {
        for b in &all[..i] {
            let difference = std::array::from_fn(|k| a[k] - b[k]);
            times.extend(roots_of_quadratic(difference).into_iter().flatten());
        }
    }
    let inside = times.into_iter().filter(|t| (0.0..=length).contains(t));
    let smallest = inside.map(|t| all.iter().map(|c| value(c, t)).fold(f64::INFINITY, f64::min));
    smallest.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], f| [low.min(f), high.max(f)])
}

/// The legs of a body between two times; one leg of length 0 if both are the same.
pub(super) fn legs(track: &Track, from: f64, to: f64) -> Vec<Leg> {
    let first = track.pieces.partition_point(|piece| piece.start <= from).saturating_sub(1);
    let mut legs = Vec::new();
    for (index, piece) in track.pieces.iter().enumerate().skip(first) {
        let start = if legs.is_empty() { from } else { piece.start };
        if start > to || (start == to && !legs.is_empty()) {
            break;
        }
        let mut end = track.pieces.get(index + 1).map_or(to, |next| next.start.min(to));
        // Before its first piece a body waits.
        if start < piece.start && end > piece.start {
            legs.push(Leg::of(piece, start, piece.start));
            legs.push(Leg::of(piece, piece.start, end));
            continue;
        }
        end = end.max(start);
        legs.push(Leg::of(piece, start, end));
    }
    legs
}

/// The motion of one body relative to another between two times, leg by leg.
pub(super) fn relative(one: &Track, other: &Track, from: f64, to: f64) -> Vec<Leg> {
    let mut cuts: Vec<f64> = [one, other].iter().flat_map(|track| &track.pieces).map(|piece| piece.start).collect();
    cuts.retain(|time| *time > from && *time < to);
    cuts.extend([from, to]);
    cuts.sort_by(f64::total_cmp);
    cuts.dedup();
    if cuts.len() == 1 {
        cuts.push(to);
    }
    let pairs = cuts.windows(2).filter_map(|pair| {
        let [a, b] = [one, other].map(|track| legs(track, pair[0], pair[1]).into_iter().next());
        Some(a?.seen_from(&b?))
    });
    pairs.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;
    use plaus_dist::{Seed, Stream};
    use rand::RngExt;

    /// A symmetric top.
    fn turn(stream: &mut Stream) -> Turn {
        let mut number = || stream.random_range(-1.0..1.0);
        let [x, y, z, w] = std::array::from_fn(|_| number());
        let spin = 9.0 * DVec3::new(number(), number(), number());
        Turn { orientation: DQuat::from_xyzw(x, y, z, w).normalize(), spin, own: 20.0 * number() }
    }

    fn leg(stream: &mut Stream) -> Leg {
        let turn = turn(stream);
        let mut v = |scale: f64| DVec3::from_array(std::array::from_fn(|_| scale * stream.random_range(-1.0..1.0)));
        Leg { p: v(1.0), v: v(3.0), a: v(10.0), length: 0.7, turn, since: 0.1 }
    }

    /// Compared with many samples: no sample lies outside the extremes, and the extremes are not farther from the
    /// samples than these are from each other.
    #[test]
    fn extremes_are_those_of_dense_samples() {
        let mut stream = Seed(1).chain(0).at(0, plaus_dist::Purpose::START);
        let steps = 4000;
        for _ in 0..200 {
            let leg = leg(&mut stream);
            let point = DVec3::new(stream.random_range(-1.0..1.0), 0.3, -0.2);
            let times = (0..=steps).map(|i| leg.length * f64::from(i) / f64::from(steps));
            let sampled: Vec<f64> = times.clone().map(|t| leg.at(t).distance(point)).collect();
            let [least, most] =
                sampled.iter().fold([f64::INFINITY, 0.0], |[a, b], d| [f64::min(a, *d), f64::max(b, *d)]);
            let [low, high] = leg.distances(point);
            // Between two samples the distance changes by at most the top speed over half a step.
            let slack = (3.0 * 1.8 + 0.7 * 17.4) * 0.5 * leg.length / f64::from(steps);
            assert!(low <= least + 1e-12 && low >= least - slack, "{low} {least}");
            assert!(high >= most - 1e-12 && high <= most + slack, "{high} {most}");
            let walked: f64 = times.clone().zip(times.skip(1)).map(|(a, b)| leg.at(a).distance(leg.at(b))).sum();
            assert!((leg.path_length() / walked - 1.0).abs() < 1e-5, "{} {walked}", leg.path_length());
        }
    }

    /// Speed, height, turns and lean, compared with small steps.
    #[test]
    fn what_changes_over_a_leg_is_what_small_steps_add_up_to() {
        let (mut stream, steps, mut fallen) = (Seed(3).chain(0).at(0, plaus_dist::Purpose::START), 20_000, 0);
        for _ in 0..100 {
            let leg = leg(&mut stream);
            let step = leg.length / f64::from(steps);
            let times = || (0..=steps).map(|i| step * f64::from(i));
            // What changes by at most so much from one sample to the next.
            let near = |[low, high]: [f64; 2], slack: f64, of: &dyn Fn(f64) -> f64| {
                let [least, most] = times().map(of).fold([f64::MAX, f64::MIN], |[a, b], x| [a.min(x), b.max(x)]);
                assert!(low <= least + 1e-12 && low >= least - slack, "{low} {least}");
                assert!(high >= most - 1e-12 && high <= most + slack, "{high} {most}");
            };
            near(leg.speeds(), step * leg.a.length(), &|t| (leg.v + t * leg.a).length());
            near(leg.heights(), step * leg.speeds()[1], &|t| leg.at(t).z);
            let orientation = |t: f64| leg.turn.after(leg.since + t);
            let (mut turned, mut all) = (DVec3::ZERO, 0.0);
            for t in times().skip(1) {
                let way = (orientation(t) * orientation(t - step).conjugate()).to_scaled_axis();
                (turned, all) = (turned + way, all + way.length());
            }
            // Each step turns by ω h up to ω³ h³; rounding of quaternions adds 1e-16 each.
            assert!((leg.turned() - level(turned)).length() < 1e-6, "{} {turned}", leg.turned());
            assert!((leg.spin() * leg.length - all).abs() < 1e-6, "{} {all}", leg.spin() * leg.length);
            let upright = |t: f64| (orientation(t) * DVec3::Z).y;
            let cosine = stream.random_range(-0.9..0.9);
            let found = times().find(|t| upright(*t) <= cosine);
            match (leg.leans(cosine), found) {
                (Some(at), Some(later)) => {
                    assert!(at <= later + 1e-12 && at >= later - step - 1e-12, "{at} {later}");
                    fallen += 1;
                }
                (Some(at), None) => assert!((upright(at) - cosine).abs() < 1e-9, "between two samples"),
                (None, found) => assert_eq!(found, None),
            }
        }
        assert!(fallen > 20 && fallen < 100, "{fallen}");
    }

    #[test]
    fn the_smallest_of_quadratics_has_the_reported_extremes() {
        let mut stream = Seed(2).chain(0).at(0, plaus_dist::Purpose::START);
        let steps = 4000;
        for _ in 0..200 {
            let all: Vec<Quadratic> = (0..6).map(|_| std::array::from_fn(|_| stream.random_range(-1.0..1.0))).collect();
            let smallest = |t: f64| all.iter().map(|c| value(c, t)).fold(f64::INFINITY, f64::min);
            let sampled = (0..=steps).map(|i| smallest(2.0 * f64::from(i) / f64::from(steps)));
            let [least, most] = sampled.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], f| [a.min(f), b.max(f)]);
            let [low, high] = extremes_of_smallest(&all, 2.0);
            let slack = 5.0 * 2.0 / f64::from(steps);
            assert!(low <= least + 1e-12 && low >= least - slack, "{low} {least}");
            assert!(high >= most - 1e-12 && high <= most + slack, "{high} {most}");
        }
    }
}
