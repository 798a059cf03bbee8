//! Swings whose motion is known without the simulator: a double pendulum by Lagrange's equations, and Newton's cradle
//! ball by ball, both in very small steps.
#![allow(dead_code, unreachable_pub, clippy::unwrap_used, reason = "shared by tests and a measuring program")]

use glam::{DQuat, DVec3};
use plaus_dist::math;
use plaus_sim::rigid::{BodySpec, Joint, RigidBodyState, RigidWorld, RigidWorldDesc, Start};
use plaus_sim::shape::{Cuboid, Shape};
use plaus_sim::{Accuracy, Law, Laws, Material, Preset};

const G: f64 = 9.81;

/// One step of the classical Runge–Kutta method of fourth order.
fn stepped<const N: usize>(y: [f64; N], h: f64, slope: impl Fn(&[f64; N]) -> [f64; N]) -> [f64; N] {
    let plus = |k: &[f64; N], h: f64| std::array::from_fn(|i| y[i] + k[i] * h);
    let a = slope(&y);
    let b = slope(&plus(&a, 0.5 * h));
    let c = slope(&plus(&b, 0.5 * h));
    let d = slope(&plus(&c, h));
    std::array::from_fn(|i| y[i] + (a[i] + 2.0 * (b[i] + c[i]) + d[i]) * (h / 6.0))
}

fn world(shapes: &[Shape], density: f64, preset: Preset) -> RigidWorld {
    RigidWorld::new(RigidWorldDesc {
        bodies: shapes.iter().map(|s| BodySpec::solid(s.clone(), density, Material(0))).collect(),
        laws: Laws::uniform(Law::new(0.0, 1.0)).unwrap(),
        gravity: DVec3::NEG_Z * G,
        accuracy: Accuracy { events: 10_000_000, ..Accuracy::preset(preset) },
        duration: 100.0,
        ..RigidWorldDesc::default()
    })
    .unwrap()
}

/// Two rods that hang from the ends of each other on hinges, let go at these angles from hanging down.
#[derive(Clone, Copy)]
pub struct Double(pub [f64; 2]);

impl Double {
    const RODS: [DVec3; 2] = [DVec3::new(0.06, 0.1, 0.5), DVec3::new(0.05, 0.06, 0.4)];

    fn shapes() -> [Shape; 2] {
        Self::RODS.map(|rod| Shape::Cuboid(Cuboid::new(rod, 0.0).unwrap()))
    }

    pub fn world(self, preset: Preset) -> (RigidWorld, Vec<Start>) {
        let turns = self.0.map(|angle| DQuat::from_rotation_y(-angle));
        let elbow = turns[0] * DVec3::NEG_Z * Self::RODS[0].z;
        let at = [0.5 * elbow, elbow + turns[1] * DVec3::NEG_Z * (0.5 * Self::RODS[1].z)];
        let starts = [0, 1].map(|k| Start { orientation: turns[k], ..Start::at_rest(at[k]) });
        let mut world = world(&Self::shapes(), 1000.0, preset);
        world.join(Joint::hinge(DVec3::ZERO, DVec3::Y, 0, &starts[0])).unwrap();
        world.join(Joint::hinge(elbow, DVec3::Y, 0, &starts[0]).to(1, &starts[1])).unwrap();
        (world, starts.to_vec())
    }

    /// The lower end of the second rod.
    pub fn end(bodies: &[RigidBodyState]) -> DVec3 {
        bodies[1].path.x + bodies[1].turn * (DVec3::NEG_Z * (0.5 * Self::RODS[1].z))
    }

    /// The same by Lagrange's equations, after so many steps.
    pub fn truth(self, time: f64, steps: u32) -> DVec3 {
        let [m, n] = Self::shapes().map(|s| s.mass_properties(1000.0));
        let [l, k] = Self::RODS.map(|r| r.z);
        let (c, d) = (0.5 * l, 0.5 * k);
        let slope = |[p, q, u, w]: &[f64; 4]| {
            let (s, k) = math::sin_cos(p - q);
            let (a, b) = (m.inertia.y + m.mass * c * c + n.mass * l * l, n.mass * l * d * k);
            let e = n.inertia.y + n.mass * d * d;
            let f = -(m.mass * c + n.mass * l) * G * math::sin(*p) - n.mass * l * d * s * w * w;
            let g = -n.mass * d * G * math::sin(*q) + n.mass * l * d * s * u * u;
            let det = a * e - b * b;
            [*u, *w, (f * e - g * b) / det, (g * a - f * b) / det]
        };
        let mut y = [self.0[0], self.0[1], 0.0, 0.0];
        for _ in 0..steps {
            y = stepped(y, time / f64::from(steps), slope);
        }
        let down = |angle: f64| DVec3::new(math::sin(angle), 0.0, -math::cos(angle));
        down(y[0]) * l + down(y[1]) * k
    }
}

/// Newton's cradle: five balls on hinges, of which the first is let go at an angle.
#[derive(Clone, Copy)]
pub struct Cradle(pub f64);

impl Cradle {
    pub const COUNT: usize = 5;
    pub const RADIUS: f64 = 0.015;
    const STRING: f64 = 0.15;
    /// Between two balls that hang.
    const GAP: f64 = 1e-4;

    fn hinge(ball: usize) -> DVec3 {
        DVec3::X * (ball as f64 * (2.0 * Self::RADIUS + Self::GAP))
    }

    fn at(ball: usize, angle: f64) -> DVec3 {
        let (s, c) = math::sin_cos(angle);
        Self::hinge(ball) - DVec3::new(s, 0.0, c) * Self::STRING
    }

    pub fn world(self, preset: Preset) -> (RigidWorld, Vec<Start>) {
        let raised = |ball: usize, angle: f64| Start {
            orientation: DQuat::from_rotation_y(angle),
            ..Start::at_rest(Self::at(ball, angle))
        };
        let mut world = world(&vec![Shape::Ball(Self::RADIUS); Self::COUNT], 7800.0, preset);
        for k in 0..Self::COUNT {
            world.join(Joint::hinge(Self::hinge(k), DVec3::Y, k, &raised(k, 0.0))).unwrap();
        }
        let starts = (0..Self::COUNT).map(|k| raised(k, if k == 0 { self.0 } else { 0.0 })).collect();
        (world, starts)
    }

    /// Where the balls are after a time: each swings about its hinge, and two that touch exchange what an elastic
    /// impact of bodies that can only turn exchanges. The time of each impact is bisected within steps of `h` seconds.
    pub fn truth(self, time: f64, h: f64) -> [DVec3; Self::COUNT] {
        const N: usize = Cradle::COUNT;
        let rate = G * Self::STRING / (0.4 * Self::RADIUS * Self::RADIUS + Self::STRING * Self::STRING);
        let slope = |y: &[f64; 2 * N]| -> [f64; 2 * N] {
            std::array::from_fn(|i| if i < N { y[N + i] } else { -rate * math::sin(y[i - N]) })
        };
        let pair = |y: &[f64; 2 * N], k: usize| {
            let way = Self::at(k + 1, y[k + 1]) - Self::at(k, y[k]);
            let n = way.normalize();
            let arm = [k, k + 1].map(|k| {
                let (s, c) = math::sin_cos(y[k]);
                n.dot(DVec3::new(-c, 0.0, s)) * Self::STRING
            });
            (way.length() - 2.0 * Self::RADIUS, arm)
        };
        let struck = |y: &[f64; 2 * N]| {
            (0..N - 1).find(|&k| {
                let (gap, arm) = pair(y, k);
                gap <= 0.0 && arm[0] * y[N + k] > arm[1] * y[N + k + 1]
            })
        };
        let mut y: [f64; 2 * N] = [0.0; 2 * N];
        y[0] = self.0;
        let mut t = 0.0;
        while t < time {
            let step = h.min(time - t);
            let next = stepped(y, step, slope);
            if struck(&next).is_none() {
                (y, t) = (next, t + step);
                continue;
            }
            let (mut low, mut high) = (0.0, step);
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                if struck(&stepped(y, middle, slope)).is_some() { high = middle } else { low = middle }
            }
            (y, t) = (stepped(y, high, slope), t + high);
            while let Some(k) = struck(&y) {
                let (_, [a, b]) = pair(&y, k);
                let impulse = 2.0 * (a * y[N + k] - b * y[N + k + 1]) / (a * a + b * b);
                y[N + k] -= impulse * a;
                y[N + k + 1] += impulse * b;
            }
        }
        std::array::from_fn(|k| Self::at(k, y[k]))
    }
}
