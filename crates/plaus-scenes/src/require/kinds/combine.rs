//! Requirements made of others: all of them, any of them, not one, at least some number of them.

use crate::files::Files;
use crate::require::aim::Aim;
use crate::require::claim::Claim;
use crate::require::kinds::{Ask, Require};
use crate::require::looks::Looks;
use crate::require::missed::{Nat, shared};
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::{FAR, Mark, Reach};
use crate::require::spot::Spot;
use crate::require::timed::Timed;
use crate::scene::ConfigError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// All of several requirements: what they cost adds up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct All(#[schemars(length(min = 1, max = 64))] pub Vec<Require>);

/// Any of several requirements: the best one counts, so a state that meets it weighs 1, however many it meets.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct AnyOf(#[schemars(length(min = 1, max = 64))] pub Vec<Require>);

/// A requirement must not be met. The cost grows with the margin by which it is met.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct Not(pub Box<Require>);

/// At least a number of several requirements must be met. The margin is that of the last one needed; the costs of those
/// that are needed add up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AtLeast {
    /// How many.
    #[schemars(range(min = 1, max = 64))]
    pub count: u32,
    /// Which requirements.
    #[schemars(length(min = 1, max = 64))]
    pub of: Vec<Require>,
}

/// The k-th largest of some margins; the smallest possible value if there are fewer.
fn kth_best(margins: &[f64], k: usize) -> f64 {
    let mut margins = margins.to_vec();
    margins.sort_by(|a, b| b.total_cmp(a));
    if k == 0 { FAR } else { margins.get(k - 1).copied().unwrap_or(-FAR) }
}

/// Of `marks`, at least `k` must be met: the margin is that of the last one needed, and the costs of the best `k` add
/// up, so that each one that is met is a step towards the whole.
pub(super) fn at_least(marks: &[Mark], k: usize) -> Mark {
    let margins: Vec<f64> = marks.iter().map(|mark| mark.margin).collect();
    let mut logs: Vec<f64> = marks.iter().map(|mark| mark.log).collect();
    logs.sort_by(|a, b| b.total_cmp(a));
    let lacking = k.saturating_sub(logs.len()) as f64;
    let needed = logs.iter().take(k).fold(0.0, |sum, log| sum + log);
    Mark { margin: kth_best(&margins, k).clamp(-FAR, FAR), log: needed - FAR * lacking }
}

fn check(of: &[Require], place: &Place<'_>) -> Result<(), ConfigError> {
    of.iter().enumerate().try_for_each(|(index, one)| one.check(&place.entry(index).at(one.name())))
}

/// The best and the worst marks that some requirements can get, combined by one function.
fn put_together(of: &[Require], probe: &Probe<'_>, together: impl Fn(&[Mark]) -> Mark) -> Reach {
    let each: Vec<Reach> = of.iter().map(|one| one.reach(probe)).collect();
    let end = |end: fn(&Reach) -> Mark| together(&each.iter().map(end).collect::<Vec<_>>());
    Reach { least: end(|reach| reach.least), most: end(|reach| reach.most) }
}

fn load(of: &mut [Require], key: &str, files: &dyn Files) -> Result<(), ConfigError> {
    of.iter_mut().enumerate().try_for_each(|(index, one)| one.load(&format!("{key}[{index}]"), files))
}

/// The times that all of them ask for.
fn times(of: &[Require], probe: &Probe<'_>) -> Vec<Timed> {
    of.iter().flat_map(|one| one.times(probe)).collect()
}

impl Ask for All {
    fn load(&mut self, key: &str, files: &dyn Files) -> Result<(), ConfigError> {
        load(&mut self.0, key, files)
    }

    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        check(&self.0, place)
    }

    fn subject(&self) -> Option<&str> {
        None
    }

    fn nat(&self) -> Option<Nat> {
        shared(self.0.iter().map(Require::nat))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        put_together(&self.0, probe, |marks| Mark {
            margin: marks.iter().map(|mark| mark.margin).fold(FAR, f64::min),
            log: marks.iter().fold(0.0, |sum, mark| sum + mark.log),
        })
    }

    fn times(&self, probe: &Probe<'_>) -> Vec<Timed> {
        times(&self.0, probe)
    }

    fn spots(&self) -> Vec<Spot> {
        self.0.iter().flat_map(Require::spots).collect()
    }

    fn looks(&self) -> Looks {
        Looks::of_all(self.0.iter().map(Require::looks))
    }

    fn aims(&self) -> Vec<Aim> {
        self.0.iter().flat_map(Require::aims).collect()
    }

    fn claims(&self) -> Vec<Claim> {
        self.0.iter().flat_map(Require::claims).collect()
    }
}

impl Ask for AnyOf {
    fn load(&mut self, key: &str, files: &dyn Files) -> Result<(), ConfigError> {
        load(&mut self.0, key, files)
    }

    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        check(&self.0, place)
    }

    fn subject(&self) -> Option<&str> {
        None
    }

    fn nat(&self) -> Option<Nat> {
        shared(self.0.iter().map(Require::nat))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        put_together(&self.0, probe, |marks| Mark {
            margin: marks.iter().map(|mark| mark.margin).fold(-FAR, f64::max),
            log: marks.iter().map(|mark| mark.log).fold(f64::NEG_INFINITY, f64::max),
        })
    }

    fn times(&self, probe: &Probe<'_>) -> Vec<Timed> {
        times(&self.0, probe)
    }

    fn spots(&self) -> Vec<Spot> {
        self.0.iter().flat_map(Require::spots).collect()
    }

    fn looks(&self) -> Looks {
        Looks::of_all(self.0.iter().map(Require::looks))
    }

    fn aims(&self) -> Vec<Aim> {
        self.0.iter().flat_map(Require::aims).collect()
    }
}

impl Ask for Not {
    fn load(&mut self, key: &str, files: &dyn Files) -> Result<(), ConfigError> {
        self.0.load(key, files)
    }

    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        self.0.check(&place.at(self.0.name()))
    }

    fn subject(&self) -> Option<&str> {
        None
    }

    fn nat(&self) -> Option<Nat> {
        self.0.nat().filter(Nat::is_smooth)
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        self.0.reach(probe).opposite()
    }

    fn looks(&self) -> Looks {
        self.0.looks()
    }
}

impl Ask for AtLeast {
    fn load(&mut self, key: &str, files: &dyn Files) -> Result<(), ConfigError> {
        load(&mut self.of, &format!("{key}.of"), files)
    }

    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        let (wanted, all) = (self.count, self.of.len());
        if wanted as usize > all {
            return Err(place.at("count").wrong(&format!("at least {wanted} of {all} requirements can never be met")));
        }
        check(&self.of, &place.at("of"))
    }

    fn subject(&self) -> Option<&str> {
        None
    }

    fn nat(&self) -> Option<Nat> {
        shared(self.of.iter().map(Require::nat))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        put_together(&self.of, probe, |marks| at_least(marks, self.count as usize))
    }

    fn times(&self, probe: &Probe<'_>) -> Vec<Timed> {
        times(&self.of, probe)
    }

    fn looks(&self) -> Looks {
        Looks::of_all(self.of.iter().map(Require::looks))
    }

    fn aims(&self) -> Vec<Aim> {
        self.of.iter().flat_map(Require::aims).collect()
    }
}
