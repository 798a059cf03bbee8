//! Friction and restitution of a thing, and what two of them have together.

use super::numbers::number;

/// What Plaus gives a thing of which nothing is said.
const USUAL: [f64; 2] = [0.5, 0.5];

/// How a value follows from those of two materials. Of two different rules the earlier one here holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Rule {
    Average,
    Minimum,
    Maximum,
    Multiply,
    /// Nothing is said: the other's rule, or else the average.
    Unsaid,
}

impl Rule {
    /// The rule of this name, as `KHR_physics_rigid_bodies` has it.
    pub(super) fn named(name: &str) -> Option<Self> {
        Some(match name {
            "average" => Self::Average,
            "minimum" => Self::Minimum,
            "maximum" => Self::Maximum,
            "multiply" => Self::Multiply,
            _ => return None,
        })
    }

    fn of(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Average | Self::Unsaid => 0.5 * (a + b),
            Self::Minimum => a.min(b),
            Self::Maximum => a.max(b),
            Self::Multiply => a * b,
        }
    }
}

/// Friction and restitution of a thing, each with its rule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Contact {
    pub(super) values: [f64; 2],
    pub(super) rules: [Rule; 2],
}

impl Contact {
    /// Of a thing of which nothing is said.
    pub(super) const USUAL: Self = Self { values: USUAL, rules: [Rule::Unsaid; 2] };

    /// As in MuJoCo: the larger friction, and nothing bounces.
    pub(super) fn of_mujoco(friction: f64) -> Self {
        Self { values: [friction, 0.0], rules: [Rule::Maximum; 2] }
    }

    /// Friction and restitution between two, where they are not the geometric means, as far as a scenario can say.
    pub(super) fn between(&self, other: &Self) -> [Option<f64>; 2] {
        [0, 1].map(|k| {
            let (a, b) = (self.values[k], other.values[k]);
            let value = self.rules[k].min(other.rules[k]).of(a, b);
            (number(value) != number((a * b).sqrt())).then_some(value)
        })
    }
}
