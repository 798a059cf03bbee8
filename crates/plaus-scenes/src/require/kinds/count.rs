//! How many bodies do something.

use crate::files::Files;
use crate::require::kinds::combine::at_least;
use crate::require::kinds::{Ask, Require};
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::{Presence, Probe};
use crate::require::score::{Mark, Reach};
use crate::require::timed::Timed;
use crate::scene::ConfigError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The number of bodies that meet a requirement lies within limits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Count {
    /// Which bodies: a pattern such as `die_*`.
    #[serde(default = "everybody")]
    pub of: String,
    /// The least allowed. Unset: no lower limit.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "maximum" = 10_000, "x-example" = 4))]
    pub at_least: Option<u32>,
    /// The most allowed. Unset: no upper limit.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "maximum" = 10_000, "x-example" = 4))]
    pub at_most: Option<u32>,
    /// What each of them must do: a requirement that names no body.
    pub that: Box<Require>,
}

fn everybody() -> String {
    "*".into()
}

impl Ask for Count {
    fn load(&mut self, key: &str, files: &dyn Files) -> Result<(), ConfigError> {
        self.that.load(&format!("{key}.that"), files)
    }

    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        place.body("of", &self.of)?;
        place.limits(self.at_least.map(f64::from), self.at_most.map(f64::from))?;
        let bodies = place.cast().matching(&self.of).count();
        if let Some(wanted) = self.at_least.filter(|wanted| *wanted as usize > bodies) {
            return Err(place.at("at_least").wrong(&format!("{wanted} is too many: there are only {bodies} bodies")));
        }
        self.that.check(&place.at("that").counted().at(self.that.name()))
    }

    fn subject(&self) -> Option<&str> {
        None
    }

    fn nat(&self) -> Option<Nat> {
        self.that.nat().filter(Nat::is_smooth)
    }

    /// The margin of the body that decides; the costs of all bodies too few or too many add up.
    fn reach(&self, probe: &Probe<'_>) -> Reach {
        let each =
            probe.bodies(&self.of).map(|body| match (self.that.reach(&probe.about(body)), probe.presence(body)) {
                (reach, Presence::Unknown) => reach.or_never(),
                (reach, _) => reach,
            });
        let each: Vec<Reach> = each.collect();
        let mark = |end: fn(&Reach) -> Mark| {
            let enough: Vec<Mark> = each.iter().map(end).collect();
            let others: Vec<Mark> = each.iter().map(|reach| end(&reach.opposite())).collect();
            let few = self.at_most.map_or(0, |most| others.len().saturating_sub(most as usize));
            let limits = [at_least(&enough, self.at_least.unwrap_or(0) as usize), at_least(&others, few)];
            Mark { margin: limits[0].margin.min(limits[1].margin), log: limits[0].log + limits[1].log }
        };
        Reach { least: mark(|reach| reach.least), most: mark(|reach| reach.most) }
    }

    fn times(&self, probe: &Probe<'_>) -> Vec<Timed> {
        let bodies = probe.bodies(&self.of);
        bodies.flat_map(|body| self.that.times(&probe.about(body))).collect()
    }

    fn looks(&self) -> Looks {
        self.that.looks()
    }
}
