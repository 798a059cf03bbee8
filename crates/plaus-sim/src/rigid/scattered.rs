//! Names of impacts that scatter, what they are counted by, and their scores. `impact/scatter.rs` has the law.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::Arc;

/// What a body strikes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Partner {
    /// Another body, by index.
    Body(u32),
    /// A fixed part, by index.
    Part(u32),
}

/// The name of an impact that scatters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct ImpactName {
    /// The body; the lower index of two.
    pub body: u32,
    /// What it strikes.
    pub other: Partner,
    /// How many impacts of these two scattered before; of points that are struck at once, each counts.
    pub ordinal: u32,
}

/// The scores of all impacts of a world: three numbers for each name, of the tilt along the slip, of that across it,
/// and of the restitution. Impacts have the law that [`Scatter`](crate::material::Scatter) describes if these are
/// independent standard normal numbers.
#[derive(Clone)]
pub struct ImpactScores(Arc<dyn Fn(ImpactName) -> [f64; 3] + Send + Sync>);

impl ImpactScores {
    /// Scores by a function, which must give finite numbers, and the same ones whenever it is asked for a name.
    pub fn new(scores: impl Fn(ImpactName) -> [f64; 3] + Send + Sync + 'static) -> Self {
        Self(Arc::new(scores))
    }

    /// The scores of an impact.
    pub(super) fn of(&self, name: ImpactName) -> [f64; 3] {
        self.0(name)
    }
}

impl fmt::Debug for ImpactScores {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("ImpactScores")
    }
}

/// How often a body struck each thing in impacts that scatter: bodies of higher index, and fixed parts.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct ScatteredImpacts(Vec<(Partner, u32)>);

impl ScatteredImpacts {
    /// The number of the next impact on something.
    pub(super) fn next(&mut self, other: Partner) -> u32 {
        let place = self.0.iter().position(|(known, _)| *known == other).unwrap_or_else(|| {
            self.0.push((other, 0));
            self.0.len() - 1
        });
        let count = &mut self.0[place].1;
        std::mem::replace(count, *count + 1)
    }

    /// Forgets the last impact on something: it did not take place.
    pub(super) fn take_back(&mut self, other: Partner) {
        if let Some((_, count)) = self.0.iter_mut().find(|(known, _)| *known == other) {
            *count -= 1;
        }
    }

    /// Everything that it struck, and how often.
    pub(super) fn counts(&self) -> impl Iterator<Item = (Partner, u32)> + use<'_> {
        self.0.iter().copied().filter(|(_, count)| *count > 0)
    }
}
