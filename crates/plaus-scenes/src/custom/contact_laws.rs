//! What happens where two materials touch, as the simulator's laws.

use super::plan::Plan;
use super::substances::Substance;
use super::values::{Numbers, Value};
use plaus_sim::WorldError;
use plaus_sim::material::{Law, Laws, Material as Kind, Scatter};

impl Plan {
    /// The laws of all pairs of materials in a draw.
    pub(super) fn laws(&self, numbers: &Numbers<'_>) -> Result<Laws, WorldError> {
        let count = self.substances.len();
        let mut laws = Laws::new(count as u16, Law::new(0.0, 0.0))?;
        let contact: Vec<[f64; 5]> =
            self.substances.iter().map(|one| one.contact.map(|value| value.of(numbers))).collect();
        let scatter: Vec<Scatter> = self.substances.iter().map(|one| scatter(one, numbers)).collect();
        let mut set = |a: usize, b: usize, said: &[Option<Value>; 5]| {
            let follows = |k: usize| {
                let (one, other) = (contact[a][k], contact[b][k]);
                if [0, 1, 4].contains(&k) { (one * other).sqrt() } else { 0.5 * (one + other) }
            };
            let [friction, restitution, rolling, spinning, grip] =
                [0, 1, 2, 3, 4].map(|k| said[k].map_or_else(|| follows(k), |value| value.of(numbers)));
            let law = Law::new(friction, restitution).with_resistance(rolling, spinning).with_static_friction(grip);
            laws.set(Kind(a as u16), Kind(b as u16), law.with_scatter(both(&scatter[a], &scatter[b])))
        };
        for b in 0..count {
            for a in 0..=b {
                set(a, b, &[None; 5])?;
            }
        }
        for ([a, b], said) in &self.pairs {
            set(*a, *b, said)?;
        }
        Ok(laws)
    }
}

/// How impacts of a material scatter in a draw.
fn scatter(substance: &Substance, numbers: &Numbers<'_>) -> Scatter {
    let [normal_deg, restitution] = substance.scatter.map(|value| value.of(numbers));
    Scatter { tilt: normal_deg.to_radians(), restitution }
}

/// Two surfaces that scatter independently: their variances add.
fn both(one: &Scatter, other: &Scatter) -> Scatter {
    let of = |a: f64, b: f64| (a * a + b * b).sqrt();
    Scatter { tilt: of(one.tilt, other.tilt), restitution: of(one.restitution, other.restitution) }
}
