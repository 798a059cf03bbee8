//! What acts on a body besides contact, as a scenario says it.

use super::config::Body;
use super::values::{Collector, Numbers, Owner, Value, Values, vector};
use crate::scene::ConfigError;
use plaus_sim::rigid::Forces;

/// What acts on a body, once a draw is known, and whether it sleeps until it is hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Acting {
    gravity: Value,
    force: Values,
    torque: Values,
    damping: Value,
    angular_damping: Value,
    pub(super) is_asleep: bool,
}

impl Default for Acting {
    /// Gravity alone.
    fn default() -> Self {
        let (none, nothing) = (Value::Fixed(0.0), [Value::Fixed(0.0); 3]);
        let gravity = Value::Fixed(1.0);
        Self { gravity, force: nothing, torque: nothing, damping: none, angular_damping: none, is_asleep: false }
    }
}

impl Acting {
    /// What the keys of a body say. One that sleeps may not move: its velocities are given too.
    pub(super) fn new(
        collector: &mut Collector,
        owner: &Owner<'_>,
        body: &Body,
        velocities: [Values; 2],
    ) -> Result<Self, ConfigError> {
        if body.asleep && velocities != [[Value::Fixed(0.0); 3]; 2] {
            let message = "a body that is asleep does not move: leave `velocity_m_s` and `spin_deg_s` out";
            return Err(owner.wrong("asleep", message));
        }
        Ok(Self {
            gravity: collector.number(owner, "gravity_scale", "gravity_scale", &body.gravity_scale)?,
            force: collector.three(owner, "force_n", ["fx", "fy", "fz"], &body.force_n)?,
            torque: collector.three(owner, "torque_n_m", ["tx", "ty", "tz"], &body.torque_n_m)?,
            damping: collector.number(owner, "damping", "damping", &body.damping)?,
            angular_damping: collector.number(owner, "angular_damping", "angular_damping", &body.angular_damping)?,
            is_asleep: body.asleep,
        })
    }

    fn values(&self) -> impl Iterator<Item = Value> + '_ {
        let single = [self.gravity, self.damping, self.angular_damping];
        single.into_iter().chain(self.force).chain(self.torque)
    }

    /// Whether no draw changes it.
    pub(super) fn is_fixed(&self) -> bool {
        self.values().all(Value::is_fixed)
    }

    /// Whether it may be slowed down without contact, or pushed.
    pub(super) fn is_slowed(&self) -> bool {
        let none = Value::Fixed(0.0);
        let others = [self.damping, self.angular_damping].into_iter().chain(self.force).chain(self.torque);
        self.is_asleep || others.into_iter().any(|value| value != none)
    }

    /// Whether nothing acts that tells one level direction from another.
    pub(super) fn is_upright(&self) -> bool {
        let [fx, fy, _] = self.force;
        let [tx, ty, _] = self.torque;
        [fx, fy, tx, ty].iter().all(|value| *value == Value::Fixed(0.0))
    }

    /// What acts in a draw; `None` where it is gravity alone.
    pub(super) fn forces(&self, numbers: &Numbers<'_>) -> Option<Forces> {
        let forces = Forces {
            gravity: self.gravity.of(numbers),
            force: vector(&self.force, numbers),
            torque: vector(&self.torque, numbers),
            damping: self.damping.of(numbers),
            angular_damping: self.angular_damping.of(numbers),
        };
        (forces != Forces::default()).then_some(forces)
    }
}
