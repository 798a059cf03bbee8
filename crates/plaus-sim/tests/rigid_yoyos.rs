//! Yo-yos, compared with their closed form and with two independent integrators.

use crate::common::G;
use crate::rigid_joints::world;
use crate::rigid_strings::{BIG, Numbers, after, ball, bend, energy, gap, rotated};
use glam::{DQuat, DVec3};
use plaus_dist::math;
use plaus_sim::rigid::{Joint, RigidWorld, Start, Winding};
use plaus_sim::shape::Shape;
use plaus_sim::{Accuracy, Preset};
use std::f64::consts::{FRAC_PI_2, TAU};

/// A ball as a yo-yo on a drum of radius `r`, its string fastened above it, `free` m of it free.
fn yoyo(r: f64, free: f64, wound: f64, preset: Preset) -> (RigidWorld, Start) {
    let start = Start::at_rest(DVec3::new(r, 0.0, -free));
    let mut world = world(&[Shape::Ball(BIG)], G, preset);
    let winding = Winding { axis: DVec3::Y, radius: r, length: wound };
    world.join(Joint::wound(start.position, DVec3::ZERO, &winding, 0, &start)).unwrap();
    (world, start)
}

/// A yo-yo falls with `a = g / (1 + I / m r²)` and turns with `a / r`, straight down: but for the middle of the step,
/// to the gaps at which bodies touch. Its string has the tension that this takes, as its energy stays the same. Twins:
/// one without its moment of inertia, one whose string is fastened to the rim, and one that is wound the other way.
#[test]
fn a_yoyo_falls_as_its_inertia_lets_it() {
    let mut numbers = Numbers(1);
    let [m, i] = ball(BIG);
    for preset in Preset::ALL {
        for _ in 0..6 {
            let (r, free, way) = (numbers.within(0.005, 0.03), numbers.within(0.02, 0.1), numbers.within(0.1, 0.3));
            let (falls, start) = yoyo(r, free, 0.4, preset);
            let a = G / (1.0 + i / (m * r * r));
            let time = (2.0 * way / a).sqrt();
            let there = start.position - DVec3::Z * way;
            let found = after(&falls, &[start], time);
            let off = (found[0].path.x - there).length();
            let turned = (found[0].spin - DVec3::Y * (a * time / r)).length() * r / (a * time);
            let allowed = bend(a, BIG, preset) + 2.0 * gap(BIG, preset) + 1e-12;
            assert!(off < allowed && turned < 1e-8, "{preset:?} {r}: {off:e} of {allowed:e}, {turned:e}");
            let lost = (energy(&falls, &found) + m * G * free).abs() / (m * G * way);
            assert!(lost < allowed / way, "{preset:?} {r}: {lost:e}");
            assert!(0.5 * G * time * time - way > 10.0 * allowed, "{r}: no inertia");
            let twin = |joint: Joint| {
                let mut twin = world(&[Shape::Ball(BIG)], G, preset);
                twin.join(joint).unwrap();
                (after(&twin, &[start], time)[0].path.x - there).length()
            };
            let winding = Winding { axis: DVec3::NEG_Y, radius: r, length: 0.4 };
            let fastened = twin(Joint::string(DVec3::NEG_Z * free, DVec3::ZERO, 0, &start));
            let other_way = twin(Joint::wound(start.position, DVec3::ZERO, &winding, 0, &start));
            assert!(fastened > 0.5 * way && other_way > 10.0 * allowed, "{r}: {fastened} {other_way}");
        }
    }
}

/// A yo-yo in a plane, by its place and angle, with the tension that keeps its string's length: the length is that of
/// the straight line to the rim where the drum does not hide it, and else that of the tangent and the arc.
#[derive(Clone, Copy)]
struct Planar {
    r: f64,
    mass: f64,
    inertia: f64,
    /// The angle about −y from the string's fastening on the rim to where it is held, at the start.
    turned: f64,
}

type Plane3 = [f64; 3];

impl Planar {
    /// A string that is held at the origin, with the body in this place at the start.
    fn new(r: f64, wound: f64, [x, z]: [f64; 2], inertia: f64) -> Self {
        let far = (x * x + z * z).sqrt();
        let mass = ball(BIG)[0];
        // Unwinding turns the body about +y, so the string is wound about −y.
        let about = math::acos(r / far) + wound / r;
        Self { r, mass, inertia, turned: about + math::atan2(-z, -x) }
    }

    /// The string's length; the body has turned by `phi` about +y.
    fn length(&self, [x, z, phi]: &Plane3) -> f64 {
        let far = (x * x + z * z).sqrt();
        let mut about = self.turned - phi - math::atan2(-z, -x);
        // The direction of the string's end stays within a turn of where it begins.
        about -= TAU * ((about - self.near(*phi)) / TAU).round();
        let hidden = about.abs() - math::acos(self.r / far);
        if hidden > 0.0 {
            return (far * far - self.r * self.r).sqrt() + self.r * hidden;
        }
        (far * far + self.r * self.r - 2.0 * far * self.r * math::cos(about)).sqrt()
    }

    /// Its angle if its end is straight above.
    fn near(&self, phi: f64) -> f64 {
        self.turned - phi - FRAC_PI_2
    }

    fn slope(&self, y: &[f64; 6]) -> [f64; 6] {
        let (q, v): (Plane3, Plane3) = ([y[0], y[1], y[2]], [y[3], y[4], y[5]]);
        let at = |dir: Plane3, s: f64| self.length(&std::array::from_fn(|k| q[k] + s * dir[k]));
        let h = [1e-5, 1e-5, 1e-3];
        let j: Plane3 = std::array::from_fn(|k| {
            let unit = std::array::from_fn(|l| if l == k { h[k] } else { 0.0 });
            (8.0 * (at(unit, 1.0) - at(unit, -1.0)) - (at(unit, 2.0) - at(unit, -2.0))) / (12.0 * h[k])
        });
        let e = 2e-5;
        let bend = (at(v, e) - 2.0 * at(v, 0.0) + at(v, -e)) / (e * e);
        let inverse = [1.0 / self.mass, 1.0 / self.mass, 1.0 / self.inertia];
        let yields: f64 = j.iter().zip(inverse).map(|(j, inverse)| j * j * inverse).sum();
        let pull = (bend - j[1] * G).max(0.0) / yields;
        let a: Plane3 = std::array::from_fn(|k| if k == 1 { -G } else { 0.0 } - pull * j[k] * inverse[k]);
        [v[0], v[1], v[2], a[0], a[1], a[2]]
    }

    fn after(&self, start: [f64; 4], time: f64, steps: u32) -> DVec3 {
        let h = time / f64::from(steps);
        let mut y = [start[0], start[1], 0.0, start[2], start[3], 0.0];
        let plus = |y: &[f64; 6], k: &[f64; 6], h: f64| -> [f64; 6] { std::array::from_fn(|i| y[i] + k[i] * h) };
        for _ in 0..steps {
            let a = self.slope(&y);
            let b = self.slope(&plus(&y, &a, 0.5 * h));
            let c = self.slope(&plus(&y, &b, 0.5 * h));
            let d = self.slope(&plus(&y, &c, h));
            y = std::array::from_fn(|i| y[i] + h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]));
        }
        DVec3::new(y[0], 0.0, y[1])
    }
}

/// A yo-yo that swings while it falls, by Lagrange's equations for the string's angle θ from hanging down and the
/// body's own angle φ, anticlockwise both: `L = (I + m r²) φ′²/2 + m l² θ′²/2 + m g (l cos θ − r sin θ)`, where the
/// free length is `l = l₀ + r (θ − θ₀ − φ)`.
#[derive(Clone, Copy)]
struct Swinging {
    r: f64,
    theta: f64,
    free: f64,
    inertia: f64,
}

impl Swinging {
    fn free(&self, y: &[f64; 4]) -> f64 {
        self.free + self.r * (y[0] - self.theta - y[1])
    }

    fn slope(&self, y: &[f64; 4]) -> [f64; 4] {
        let [m, _] = ball(BIG);
        let (l, r, (s, c)) = (self.free(y), self.r, math::sin_cos(y[0]));
        let l_rate = r * (y[2] - y[3]);
        let swing = (r * y[2] * y[2] - G * s - 2.0 * l_rate * y[2]) / l;
        let turn = -r * m * (l * y[2] * y[2] + G * c) / (self.inertia + m * r * r);
        [y[2], y[3], swing, turn]
    }

    fn after(&self, rates: [f64; 2], time: f64, steps: u32) -> [f64; 4] {
        let h = time / f64::from(steps);
        let mut y = [self.theta, 0.0, rates[0], rates[1]];
        let plus = |y: &[f64; 4], k: &[f64; 4], h: f64| -> [f64; 4] { std::array::from_fn(|i| y[i] + k[i] * h) };
        for _ in 0..steps {
            let a = self.slope(&y);
            let b = self.slope(&plus(&y, &a, 0.5 * h));
            let c = self.slope(&plus(&y, &b, 0.5 * h));
            let d = self.slope(&plus(&y, &c, h));
            y = std::array::from_fn(|i| y[i] + h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]));
        }
        y
    }

    /// Where the body's centre is, from where the string is fastened.
    fn centre(&self, y: &[f64; 4]) -> DVec3 {
        let (s, c) = math::sin_cos(y[0]);
        DVec3::new(s, 0.0, -c) * self.free(y) + DVec3::new(c, 0.0, s) * self.r
    }
}

/// The error falls as the square of the step: it is at most that of a step's middle, times the number of radians that
/// the body turns by. `Swinging` is solved to 1e-10 (checked by halving its steps). The world is turned about the
/// vertical at random. A twin without the moment of inertia is far away.
#[test]
fn a_swinging_yoyo_agrees_with_lagrange() {
    let mut numbers = Numbers(3);
    for _ in 0..3 {
        let (r, free) = (numbers.within(0.01, 0.03), numbers.within(0.1, 0.2));
        let (theta, rate, turn) = (numbers.within(0.2, 0.9), numbers.within(-3.0, 3.0), numbers.within(0.0, 6.0));
        let truth = Swinging { r, theta, free, inertia: ball(BIG)[1] };
        let time = 0.5;
        let [exact, coarse] = [4000, 2000].map(|steps| truth.centre(&truth.after([rate, 0.0], time, steps)));
        assert!((exact - coarse).length() < 1e-10);
        let twin = Swinging { inertia: 0.0, ..truth };
        let twin = (twin.centre(&twin.after([rate, 0.0], time, 4000)) - exact).length();
        let turn = DQuat::from_rotation_z(turn);
        let begin = truth.centre(&[theta, 0.0, 0.0, 0.0]);
        let (s, c) = math::sin_cos(theta);
        let start = Start { velocity: DVec3::new(c, 0.0, s) * (free * rate), ..Start::at_rest(begin) };
        let start = rotated(turn, &start);
        for preset in Preset::ALL {
            let mut world = world(&[Shape::Ball(BIG)], G, preset);
            let winding = Winding { axis: turn * DVec3::Y, radius: r, length: 1.5 };
            world.join(Joint::wound(start.position, DVec3::ZERO, &winding, 0, &start)).unwrap();
            let found = after(&world, &[start], time)[0].path.x;
            let off = (found - turn * exact).length();
            let turned = truth.after([rate, 0.0], time, 4000)[1].abs();
            let allowed = bend(G, BIG, preset) * turned + 2.0 * gap(BIG, preset);
            assert!(off < allowed, "{preset:?} {r} {theta} {rate}: {off:e} of {allowed:e}");
            assert!(twin > 100.0 * allowed, "{twin:e}");
        }
    }
}

/// A yo-yo falls to the end of its string, turns over there, and climbs on the other side, as the integrator of its
/// plane says (good to 1e-5 m). Its body turns there by at most a quarter of the preset's step within a step, half way
/// through which its centre is off by an eighth of that angle's square, times the radius; eight times that is allowed
/// for what comes of it. Energy is lost or gained by a tenth of the same square at most. A twin has half of the
/// moment of inertia.
#[test]
fn a_yoyo_climbs_again() {
    let [m, i] = ball(BIG);
    for (r, wound, time) in [(0.02, 0.2, 0.65), (0.03, 0.3, 0.6), (0.012, 0.15, 0.8)] {
        let start = [r, -0.1, 0.0, 0.0];
        let exact = Planar::new(r, wound, [r, -0.1], i).after(start, time, 4000);
        let twin = Planar::new(r, wound, [r, -0.1], 0.5 * i).after(start, time, 4000);
        for preset in Preset::ALL {
            let (world, start) = yoyo(r, 0.1, wound, preset);
            let found = after(&world, &[start], time);
            let lost = (energy(&world, &found) / (m * G * wound) + 0.1 / wound).abs();
            let off = (found[0].path.x - exact).length();
            let turn = 0.25 * Accuracy::preset(preset).step;
            let allowed = r * turn * turn + 1e-5;
            assert!(off < allowed && lost < 0.1 * turn * turn, "{preset:?} {r}: {off:e} of {allowed:e}, {lost:e}");
            assert!((twin - exact).length() > 10.0 * allowed, "{:e}", (twin - exact).length());
        }
    }
}
