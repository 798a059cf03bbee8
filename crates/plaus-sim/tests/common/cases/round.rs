//! Steady rolling of a round body on its rim, without dissipation: Euler's disk, a coin.

use super::guard::go;
use super::{Found, Setting};
use crate::laws::worlds::{G, M, on_floor};
use glam::{DQuat, DVec3};
use plaus_dist::math;
use plaus_sim::Law;
use plaus_sim::rigid::{BodySpec, RigidWorld, Start};
use plaus_sim::shape::{MassProperties, Profile, Revolution, Shape};
use std::sync::Arc;

/// A round body that rolls on its rim, the ring of its foot.
#[derive(Debug, Clone)]
pub struct Disk {
    pub body: BodySpec,
    ring: plaus_sim::shape::Ring,
}

/// A steady motion: the axis precesses about the vertical.
#[derive(Debug, Clone, Copy)]
pub struct Steady {
    pub start: Start,
    /// Rate at which the axis turns about the vertical, in rad/s.
    pub precession: f64,
    /// Angle between the foot and the floor, in rad.
    pub tilt: f64,
    /// Radius of the centre's circle, in m.
    pub circle: f64,
}

impl Disk {
    /// A low cone with a rim of 4 cm and the mass of a disk.
    pub fn new() -> Self {
        let profile = Profile {
            foot: 0.037,
            rim: 0.003,
            points: vec![[0.007, 0.03], [0.011, 0.018], [0.014, 0.008]],
            top: 0.022,
        };
        let shape = Revolution::new(&profile, 60).expect("a cone");
        let ring = shape.rings()[0];
        let mass = 0.4;
        let across = 0.25 * mass * 0.04 * 0.04;
        let mass = MassProperties { mass, inertia: DVec3::new(across, across, 2.0 * across) };
        Self { body: BodySpec { shape: Shape::Revolution(Arc::new(shape)), mass, material: M }, ring }
    }

    /// From the centre of gravity to the point of contact: along the foot downwards, and along the axis downwards.
    fn arms(&self, tilt: f64) -> [f64; 2] {
        let (sin, cos) = math::sin_cos(tilt);
        [self.ring.circle + self.ring.radius * sin, self.ring.radius * cos - self.ring.height]
    }

    /// The precession at which the centre of gravity stands still (Euler's disk). The axis of rotation goes through it
    /// and the point of contact, and `dL/dt = Ω × L` is the torque of the weight:
    /// `Ω² sin α (I A cos α − K H sin α) = m g A (A cos α − H sin α)`; for a thin disk `Ω² sin α = 4 g/R`.
    pub fn precession_at_rest(&self, tilt: f64) -> f64 {
        let ([a, h], (sin, cos)) = (self.arms(tilt), math::sin_cos(tilt));
        let (m, i) = (self.body.mass.mass, self.body.mass.inertia);
        (m * G * a * (a * cos - h * sin) / (sin * (i.x * a * cos - i.z * h * sin))).sqrt()
    }

    /// The steady motion with this tilt and precession, rolling without slip. About the centre of gravity, along the
    /// level axis of the foot: `Ω (I ω₁ cos α + K ω₃ sin α) = −m g (A cos α − H sin α) + m Ω V (A sin α + H cos α)`,
    /// with `ω₁ = −Ω sin α` and the speed `V = −(ω₁ H + ω₃ A)` of the centre.
    pub fn steady(&self, tilt: f64, precession: f64) -> Steady {
        let ([a, h], (sin, cos), p) = (self.arms(tilt), math::sin_cos(tilt), precession);
        let (m, i) = (self.body.mass.mass, self.body.mass.inertia);
        let (level, high) = (a * cos - h * sin, a * sin + h * cos);
        let right = -m * G * level + high * m * p * p * h * sin + p * p * i.x * sin * cos;
        let w3 = right / (p * i.z * sin + high * m * p * a);
        let w1 = -p * sin;
        let v = -(w1 * h + w3 * a);
        // The axis leans along x, towards the point of contact; the foot's level axis is y.
        let orientation = DQuat::from_axis_angle(DVec3::Y, tilt);
        let spin = orientation * DVec3::new(w1, 0.0, w3);
        let position = DVec3::Z * high;
        let start = Start { position, orientation, velocity: DVec3::Y * v, spin, time: 0.0 };
        Steady { start, precession, tilt, circle: (v / p).abs() }
    }
}

/// Follows a steady motion for a second: when the body leaves it, how far round it has gone, and how tilted it is at
/// the end.
fn follow(s: &Setting<'_>, disk: &Disk, steady: &Steady, until: f64) -> Found {
    let world =
        RigidWorld::new(on_floor(vec![disk.body.clone()], Law::new(0.9, 0.5), s.preset)).expect("a sound world");
    let went = go(&world, &[steady.start], until, s.guard, &mut ());
    let t = went.state.time();
    let body = world.at(0, &went.state.bodies()[0], t);
    let axis = body.turn * DVec3::Z;
    let tilt = math::acos(axis.z.clamp(-1.0, 1.0));
    // Exact and found angle about the vertical: their difference is within half a turn.
    let found = math::atan2(axis.y, axis.x);
    let off = found - steady.precession * t;
    let off = off - (off / std::f64::consts::TAU).round() * std::f64::consts::TAU;
    let energy = |b: &plaus_sim::rigid::RigidBodyState| world.energy(0, b);
    let first = world.state(&[steady.start]).expect("sound").bodies()[0].clone();
    let lost = 1.0 - energy(&body) / energy(&first);
    let circle = (body.path.x - steady.start.position).with_z(0.0).length();
    let text = format!(
        "tilt {:.4}° for {:.4}°, {off:.1e} rad behind, energy lost {lost:.1e}, {:.1} mm off, {}",
        tilt.to_degrees(),
        steady.tilt.to_degrees(),
        1e3 * (circle - 2.0 * steady.circle).max(0.0),
        went.told()
    );
    // Because stability is neutral, errors of the start and of the gap grow with the angle turned: to about the gap
    // times that angle.
    let holds = !went.cut && (tilt - steady.tilt).abs() < 0.01 * steady.tilt && lost.abs() < 1e-3 && off.abs() < 0.1;
    let far = if went.cut { f64::NAN } else { off.abs() + (tilt / steady.tilt - 1.0).abs() };
    Found::new(holds, far, text)
}

/// Euler's disk at about 7°.
pub fn euler(s: &Setting<'_>) -> Found {
    let disk = Disk::new();
    let tilt = 0.12;
    let steady = disk.steady(tilt, disk.precession_at_rest(tilt));
    follow(s, &disk, &steady, 1.0)
}

/// A coin that rolls in a circle, leaning.
pub fn coin(s: &Setting<'_>) -> Found {
    let disk = Disk::new();
    let steady = disk.steady(1.1, 6.0);
    follow(s, &disk, &steady, 1.0)
}
