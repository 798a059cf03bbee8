//! What acts on a body besides contact, as a scenario says it.

use super::config::Body;
use super::values::{Collector, Numbers, Owner, Value, Values, vector};
use crate::scene::ConfigError;
use glam::DQuat;
use plaus_sim::rigid::Forces;

/// What acts on a body, once a draw is known, and whether it sleeps until it is hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Acting {
    gravity: Value,
    force: Values,
    torque: Values,
    /// Force and torque along the body's axes.
    own: [Values; 2],
    damping: Value,
    angular_damping: Value,
    pub(super) is_asleep: bool,
}

impl Default for Acting {
    /// Gravity alone.
    fn default() -> Self {
        let (none, nothing) = (Value::Fixed(0.0), [Value::Fixed(0.0); 3]);
        let gravity = Value::Fixed(1.0);
        Self {
            gravity,
            force: nothing,
            torque: nothing,
            own: [nothing; 2],
            damping: none,
            angular_damping: none,
            is_asleep: false,
        }
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
            own: [
                collector.three(owner, "own_force_n", ["own_fx", "own_fy", "own_fz"], &body.own_force_n)?,
                collector.three(owner, "own_torque_n_m", ["own_tx", "own_ty", "own_tz"], &body.own_torque_n_m)?,
            ],
            damping: collector.number(owner, "damping", "damping", &body.damping)?,
            angular_damping: collector.number(owner, "angular_damping", "angular_damping", &body.angular_damping)?,
            is_asleep: body.asleep,
        })
    }

    fn values(&self) -> impl Iterator<Item = Value> + '_ {
        let single = [self.gravity, self.damping, self.angular_damping];
        single.into_iter().chain(self.force).chain(self.torque).chain(self.own.into_iter().flatten())
    }

    /// Whether no draw changes it.
    pub(super) fn is_fixed(&self) -> bool {
        self.values().all(Value::is_fixed)
    }

    /// Whether it may be slowed down without contact, or pushed.
    pub(super) fn is_slowed(&self) -> bool {
        let none = Value::Fixed(0.0);
        self.is_asleep || self.values().skip(1).any(|value| value != none)
    }

    /// Whether nothing acts that tells one level direction from another.
    pub(super) fn is_upright(&self) -> bool {
        let [fx, fy, _] = self.force;
        let [tx, ty, _] = self.torque;
        [fx, fy, tx, ty].iter().all(|value| *value == Value::Fixed(0.0))
    }

    /// How much of gravity it feels.
    pub(super) fn gravity(&self, numbers: &Numbers<'_>) -> f64 {
        self.gravity.of(numbers)
    }

    /// What a body that is released at this time in s has beside gravity and contact, in words.
    pub(super) fn told(&self, release: f64) -> Vec<String> {
        let none = Value::Fixed(0.0);
        let all = [
            (self.damping != none || self.angular_damping != none, "its damping".to_owned()),
            (
                self.force.iter().chain(&self.torque).chain(self.own.as_flattened()).any(|value| *value != none),
                "its force and torque".to_owned(),
            ),
            (self.is_asleep, "that it sleeps until it is hit".to_owned()),
            (release > 0.0, format!("that it appears after {release} s: it is there from the start")),
        ];
        all.into_iter().filter_map(|(is_so, what)| is_so.then_some(what)).collect()
    }

    /// What acts in a draw; `None` where it is gravity alone. `axes` turns the simulator's body axes into those of the
    /// scenario.
    pub(super) fn forces(&self, numbers: &Numbers<'_>, axes: DQuat) -> Option<Forces> {
        let [own_force, own_torque] = self.own.map(|own| axes.conjugate() * vector(&own, numbers));
        let forces = Forces {
            gravity: self.gravity.of(numbers),
            force: vector(&self.force, numbers),
            torque: vector(&self.torque, numbers),
            own_force,
            own_torque,
            damping: self.damping.of(numbers),
            angular_damping: self.angular_damping.of(numbers),
        };
        (forces != Forces::default()).then_some(forces)
    }
}
