//! How a body on joints moves within a step: on cubics of its place and of its quaternion, with the velocities of the
//! step's ends. Only searches for a first contact see the centre on a parabola, which meets the cubic at the start, in
//! the middle and at the end.

use super::keyed_rotation::{Cubic, Turns, at};
use crate::rigid::BodyDef;
use crate::rigid::body_state::{Momentum, Phase, RigidBodyState};
use glam::{DQuat, DVec3, DVec4};
use std::ops::{Add, Mul, Sub};

/// The cubic from a value to another within `h` seconds, with these rates at its ends.
fn cubic<T>([x, y]: [T; 2], [v, w]: [T; 2], h: f64) -> Cubic<T>
where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f64, Output = T>,
{
    let mean = (y - x) * (1.0 / h);
    [x, v, (mean * 3.0 - v * 2.0 - w) * (1.0 / h), (v + w - mean * 2.0) * (1.0 / (h * h))]
}

/// The rate of a quaternion that turns with this angular velocity.
fn rate(turn: DQuat, spin: DVec3) -> DVec4 {
    DVec4::from(DQuat::from_xyzw(0.5 * spin.x, 0.5 * spin.y, 0.5 * spin.z, 0.0) * turn)
}

/// Place, orientation and velocities at the end of a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StepEnd {
    pub(crate) x: DVec3,
    pub(crate) turn: DQuat,
    pub(crate) motion: [DVec3; 2],
}

impl RigidBodyState {
    /// Moves a body with these velocities within `h` seconds to an end.
    pub(crate) fn take_cubic_step(&mut self, spec: &BodyDef, [v, w]: [DVec3; 2], end: &StepEnd, h: f64) {
        let turn = if self.turn.dot(end.turn) < 0.0 { -end.turn } else { end.turn };
        let momentum = |turn: DQuat, [v, w]: [DVec3; 2]| Momentum { v, l: spec.inertia.momentum(turn, w) };
        self.ends = [momentum(self.turn, [v, w]), momentum(turn, end.motion)];
        self.end_turn = turn;
        let x = self.path.x;
        let middle = (x + end.x) * 0.5 + (v - end.motion[0]) * (0.125 * h);
        self.begin(Phase::Articulated, (x + end.x - middle * 2.0) * (4.0 / (h * h)));
        self.path.v = (end.x - x) / h - self.path.a * (0.5 * h);
        self.spin = w;
        self.angular_momentum_transport = DVec3::ZERO;
        self.expiry = self.path.t + h;
    }

    fn cubic_path(&self) -> Cubic<DVec3> {
        let h = self.expiry - self.path.t;
        cubic([self.path.x, self.path.after(h)], self.ends.map(|end| end.v), h)
    }

    /// How its quaternion goes.
    pub(crate) fn cubic_turns(&self, spec: &BodyDef) -> Turns {
        if self.expiry <= self.path.t {
            return Turns::Steady { turn: self.turn, spin: self.spin };
        }
        let turns = [self.turn, self.end_turn];
        let rates = [0, 1].map(|k| rate(turns[k], spec.inertia.spin(turns[k], self.ends[k].l)));
        Turns::Cubic(cubic(turns.map(DVec4::from), rates, self.expiry - self.path.t))
    }

    /// Velocity and angular velocity `dt` after the start.
    pub(crate) fn cubic_motion(&self, spec: &BodyDef, dt: f64) -> [DVec3; 2] {
        if dt <= 0.0 {
            [self.ends[0].v, spec.inertia.spin(self.turn, self.ends[0].l)]
        } else if self.path.t + dt >= self.expiry {
            [self.ends[1].v, spec.inertia.spin(self.end_turn, self.ends[1].l)]
        } else {
            [at(&self.cubic_path(), dt)[1], self.cubic_turns(spec).turned(dt).1]
        }
    }

    /// Moves to a time within the step, its new clock, and ends it there.
    pub(crate) fn follow_cubic(&mut self, spec: &BodyDef, time: f64) {
        let (dt, h) = (time - self.path.t, self.expiry - self.path.t);
        let [v, w] = self.cubic_motion(spec, dt);
        if h > 0.0 {
            let way = self.cubic_path();
            if dt >= h {
                (self.path.x, self.turn, self.ends[0]) = (self.path.after(h), self.end_turn, self.ends[1]);
                self.energy_debt[0] = self.energy_debt[1];
            } else if dt > 0.0 {
                (self.path.x, self.turn) = (at(&way, dt)[0], self.cubic_turns(spec).turned(dt).0);
                self.ends[0] = Momentum { v, l: spec.inertia.momentum(self.turn, w) };
            }
            if dt > 0.0 {
                (self.path.t, self.expiry) = (time, time);
            }
            self.path.a = at(&way, dt)[2];
        }
        (self.path.v, self.spin) = (v, w);
    }
}
