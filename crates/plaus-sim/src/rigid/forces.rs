//! What acts on one body besides contact.

use super::body_state::{Phase, RigidBodyState};
use super::motion::damping::Damping;
use super::{BodyDef, RigidWorld};
use crate::error::WorldError;
use crate::state::State;
use glam::DVec3;

/// What acts on a body besides contact. Without damping and torque its flight stays a parabola; with them it has a
/// closed form too, which is followed in legs: see [`Phase::Leg`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forces {
    /// How much of the world's gravity it feels. Default 1; 0 for a body that floats, negative for one that rises.
    pub gravity: f64,
    /// A constant force at the centre of gravity, in N. Default none.
    pub force: DVec3,
    /// A constant torque in world axes, in N m. Default none.
    pub torque: DVec3,
    /// A force at the centre of gravity, in N, that is constant in the body's axes and turns with it: a rocket's
    /// thrust. Default none. Where that or its torque turns, a flight takes as many legs as it needs to stay within
    /// half the preset's gap, and each turns by half a radian at most.
    pub own_force: DVec3,
    /// A torque in N m that is constant in the body's axes. Default none.
    pub own_torque: DVec3,
    /// Rate at which velocity is lost, in 1/s: by a factor of e in `1/damping` seconds. Default 0; usual 0–1. It is
    /// exact for a body in flight; in lasting contact it has the error of the steps.
    pub damping: f64,
    /// The same for the angular momentum. A body that turns at ω rad/s takes `√(damping · ω · bounding_radius/(2 · gap
    /// · size))` legs per second, where `gap` is the preset's, `size` is the body's least half width, and
    /// `bounding_radius` is the distance of its farthest point from its centre of gravity. If its moments of inertia
    /// have the ratio 1 to r, it takes up to `√r` times as many. For a cube that is 930 at 10 rad/s, a damping of 1/s
    /// and the standard preset. Each leg counts as an event of the run's budget.
    pub angular_damping: f64,
}

impl Default for Forces {
    fn default() -> Self {
        let none = DVec3::ZERO;
        Self {
            gravity: 1.0,
            force: none,
            torque: none,
            own_force: none,
            own_torque: none,
            damping: 0.0,
            angular_damping: 0.0,
        }
    }
}

impl RigidWorld {
    /// Sets what acts on a body.
    ///
    /// # Errors
    /// [`WorldError::BadBody`] for numbers that are not finite, and for damping below 0.
    pub fn act_on(&mut self, body: usize, forces: Forces) -> Result<(), WorldError> {
        let numbers = [forces.gravity].into_iter().chain(forces.force.to_array()).chain(forces.own_force.to_array());
        if let Some(value) = numbers.into_iter().find(|x| !x.is_finite()) {
            return Err(WorldError::BadBody { body, field: "force", value, expected: "finite numbers" });
        }
        let torques = forces.torque.to_array().into_iter().chain(forces.own_torque.to_array());
        if let Some(value) = torques.into_iter().find(|x| !x.is_finite()) {
            return Err(WorldError::BadBody { body, field: "torque", value, expected: "finite numbers" });
        }
        for (field, value) in [("damping", forces.damping), ("angular damping", forces.angular_damping)] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(WorldError::BadBody { body, field, value, expected: "a rate of at least 0" });
            }
        }
        let Some(spec) = self.specs.get_mut(body) else {
            return Err(WorldError::WrongState { state: body + 1, world: self.specs.len() });
        };
        spec.gravity = self.gravity * forces.gravity + forces.force / spec.mass;
        spec.gravity_magnitude = spec.gravity.length();
        let Forces { torque, damping: linear, angular_damping: angular, own_force, own_torque, .. } = forces;
        let turns = own_force != DVec3::ZERO || own_torque != DVec3::ZERO;
        let own = turns.then_some([own_force / spec.mass, own_torque]);
        let is_free = torque == DVec3::ZERO && linear == 0.0 && angular == 0.0 && !turns;
        spec.damping = (!is_free).then_some(Damping { linear, angular, torque, own });
        // Time scales follow from the strongest pull.
        let gravity_magnitude = self.specs.iter().map(BodyDef::strongest_pull).fold(self.gravity.length(), f64::max);
        if gravity_magnitude != self.gravity_magnitude {
            self.gravity_magnitude = gravity_magnitude;
            for spec in &mut self.specs {
                spec.scale_by(gravity_magnitude, &self.accuracy);
            }
        }
        Ok(())
    }

    /// Puts a body to sleep that has not been released yet. From its release on it stays where it is, even in the air,
    /// until another body hits it.
    ///
    /// # Errors
    /// [`WorldError::BadBody`] for a body that is not there, has been released, is driven, or has joints.
    pub fn put_to_sleep(&self, state: &mut State<RigidBodyState>, body: usize) -> Result<(), WorldError> {
        let known = self.specs.get(body).is_some_and(|s| !s.is_driven()) && self.joints.of(body).is_empty();
        match state.bodies.get_mut(body).filter(|b| known && b.phase == Phase::Waiting) {
            Some(sleeper) => {
                sleeper.sleeps = true;
                Ok(())
            }
            None => Err(WorldError::BadBody {
                body,
                field: "index of a sleeper",
                value: body as f64,
                expected: "a body that waits for its release and has neither keyframes nor joints",
            }),
        }
    }
}
