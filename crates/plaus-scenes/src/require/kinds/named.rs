//! A requirement with a name of the user's.

use crate::files::Files;
use crate::require::aim::Aim;
use crate::require::claim::Claim;
use crate::require::kinds::{Ask, Require};
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::Reach;
use crate::require::spot::Spot;
use crate::require::timed::Timed;
use crate::scene::ConfigError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Most characters of a name: what a column of the gallery can hold.
const LONGEST: usize = 60;

/// A requirement with a name of your own, by which galleries, plots and messages call it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Named {
    /// Its name: up to 60 characters, such as `ring the bell`.
    pub name: String,
    /// What is required.
    pub that: Box<Require>,
}

impl Ask for Named {
    fn load(&mut self, key: &str, files: &dyn Files) -> Result<(), ConfigError> {
        self.that.load(&format!("{key}.that"), files)
    }

    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        let fits = (1..=LONGEST).contains(&self.name.trim().chars().count());
        if !fits || self.name.chars().any(char::is_control) {
            return Err(place.at("name").wrong(&format!("a name has 1 to {LONGEST} characters, on one line")));
        }
        self.that.check(&place.at("that").at(self.that.name()))
    }

    fn subject(&self) -> Option<&str> {
        None
    }

    fn nat(&self) -> Option<Nat> {
        self.that.nat()
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        self.that.reach(probe)
    }

    /// The name alone says what a single moment is.
    fn times(&self, probe: &Probe<'_>) -> Vec<Timed> {
        let mut times = self.that.times(probe);
        match times.as_mut_slice() {
            [one] => one.what.clone_from(&self.name),
            several => several.iter_mut().for_each(|one| one.what = format!("{}: {}", self.name, one.what)),
        }
        times
    }

    fn spots(&self) -> Vec<Spot> {
        self.that.spots()
    }

    fn looks(&self) -> Looks {
        self.that.looks()
    }

    fn aims(&self) -> Vec<Aim> {
        self.that.aims()
    }

    fn claims(&self) -> Vec<Claim> {
        self.that.claims()
    }
}
