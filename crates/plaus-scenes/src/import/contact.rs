//! Friction and restitution of a thing, and what two of them have together.

use super::numbers::number;

/// What Plaus gives a thing of which nothing is said.
const USUAL: [f64; 3] = [0.5; 3];

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

/// Friction, restitution and static friction of a thing; the rules are of friction and of restitution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Contact {
    pub(super) values: [f64; 3],
    pub(super) rules: [Rule; 2],
}

impl Contact {
    /// Of a thing of which nothing is said.
    pub(super) const USUAL: Self = Self { values: USUAL, rules: [Rule::Unsaid; 2] };

    /// As in MuJoCo: the larger friction, and nothing bounces.
    pub(super) fn of_mujoco(friction: f64) -> Self {
        Self { values: [friction, 0.0, friction], rules: [Rule::Maximum; 2] }
    }

    /// The same with another of its kind, as a scenario has them.
    fn own(&self) -> [f64; 3] {
        [0, 1, 2].map(|k| self.rules[k % 2].of(self.values[k], self.values[k]))
    }

    /// What a material of it says, as lines of TOML.
    pub(super) fn lines(&self) -> String {
        let [friction, restitution, grip] = self.own().map(number);
        let grip = if grip == friction { String::new() } else { format!("static_friction = {grip}\n") };
        format!("friction = {friction}\n{grip}restitution = {restitution}\n")
    }

    /// What a pair of the two says, as lines of TOML: what is not the geometric means.
    pub(super) fn between(&self, other: &Self) -> String {
        let [friction, restitution, grip] = [0, 1, 2].map(|k| {
            let (a, b) = (self.values[k], other.values[k]);
            let value = self.rules[k % 2].min(other.rules[k % 2]).of(a, b);
            (number(value), number(value) != number((self.own()[k] * other.own()[k]).sqrt()))
        });
        let mut said = String::new();
        if friction.1 || grip.1 {
            said += &format!("friction = {}\n", friction.0);
            if grip.0 != friction.0 {
                said += &format!("static_friction = {}\n", grip.0);
            }
        }
        if restitution.1 {
            said += &format!("restitution = {}\n", restitution.0);
        }
        said
    }
}
