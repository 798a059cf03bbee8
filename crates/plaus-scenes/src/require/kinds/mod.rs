//! The kinds of requirements: a file and a row each.

mod air_time;
mod beats;
mod before;
mod bounces;
mod combine;
mod count;
mod faces_up;
mod impact;
mod impulse;
mod inside;
mod passes;
mod path_length;
mod relative;
mod rests;
mod rests_at;
mod rests_on;
mod speed;
mod spin;
mod stands;
mod touches;

pub use air_time::AirTime;
pub use beats::{Beats, Each, Onsets};
pub use before::Before;
pub use bounces::Bounces;
pub use combine::{All, AnyOf, AtLeast, Not};
pub use count::Count;
pub use faces_up::{Axis, FacesUp};
pub use impact::Impact;
pub use impulse::Impulse;
pub use inside::{How, Inside};
pub use passes::Passes;
pub use path_length::PathLength;
pub use relative::Relative;
pub use rests::Rests;
pub use rests_at::RestsAt;
pub use rests_on::RestsOn;
pub use speed::Speed;
pub use spin::Spin;
pub use stands::Stands;
pub use touches::Touches;

use super::claim::Claim;
use super::place::Place;
use super::probe::Probe;
use super::score::Reach;
use super::timed::Timed;
use crate::files::Files;
use crate::scene::ConfigError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a kind of requirement must say of itself.
pub(super) trait Ask {
    /// Reads the files that it names; `key` is where it stands.
    fn load(&mut self, _key: &str, _files: &dyn Files) -> Result<(), ConfigError> {
        Ok(())
    }

    /// Refuses what can mean nothing: bodies that are not there, empty windows.
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError>;

    /// How well a motion meets it, or can still meet it, where it is known in part.
    fn reach(&self, probe: &Probe<'_>) -> Reach;

    /// A time from which on it may be seen, of a motion known until then, that it cannot be met any more; `None` where
    /// only the end says.
    fn moment(&self) -> Option<f64> {
        None
    }

    /// The times that it asks for, and what came of each in a motion that is known to its end.
    fn times(&self, _probe: &Probe<'_>) -> Vec<Timed> {
        Vec::new()
    }

    /// What it claims that others may contradict.
    fn claims(&self) -> Vec<Claim> {
        Vec::new()
    }
}

macro_rules! kinds {
    ($($(#[$doc:meta])* $name:literal $kind:ident,)+) => {
        /// Something that is required of a motion.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
        pub enum Require {
            $($(#[$doc])* #[serde(rename = $name)] $kind($kind),)+
        }

        impl Require {
            /// Names of all kinds, as in scenario files.
            pub const NAMES: &'static [&'static str] = &[$($name),+];

            /// The name of its kind.
            #[must_use]
            pub fn name(&self) -> &'static str {
                match self { $(Self::$kind(_) => $name),+ }
            }

            fn ask(&self) -> &dyn Ask {
                match self { $(Self::$kind(kind) => kind),+ }
            }

            fn ask_mut(&mut self) -> &mut dyn Ask {
                match self { $(Self::$kind(kind) => kind),+ }
            }
        }
    };
}

kinds! {
    /// An impact happens when asked for: the first of a body, the last, or another.
    "impact" Impact,
    /// A body comes to rest when asked for.
    "rests" Rests,
    /// A body hits something at least, or at most, so many times.
    "bounces" Bounces,
    /// A face of a die, or an axis of a body, is up.
    "faces_up" FacesUp,
    /// A body stands.
    "stands" Stands,
    /// A body comes to rest near a place.
    "rests_at" RestsAt,
    /// A body lies on another, or on a part of the scenery.
    "rests_on" RestsOn,
    /// A body is inside a region at some time, always, never, or at the end.
    "inside" Inside,
    /// A body passes near a point.
    "passes" Passes,
    /// A body touches another, or a part of the scenery.
    "touches" Touches,
    /// One event happens before another.
    "before" Before,
    /// Impacts come on the beats of a rhythm.
    "beats" Beats,
    /// A body is so fast at an impact.
    "speed" Speed,
    /// A body turns so fast at an impact.
    "spin" Spin,
    /// An impact is so hard.
    "impulse" Impulse,
    /// A body flies for so long.
    "air_time" AirTime,
    /// The way of a body is so long.
    "path_length" PathLength,
    /// A body is so far from another.
    "relative" Relative,
    /// So many of several bodies do something.
    "count" Count,
    /// All of several requirements.
    "all" All,
    /// Any of several requirements.
    "any" AnyOf,
    /// Not a requirement.
    "not" Not,
    /// At least so many of several requirements.
    "at_least" AtLeast,
}

impl Require {
    /// How well a motion meets it, or can still meet it, where it is known in part.
    #[must_use]
    pub fn reach(&self, probe: &Probe<'_>) -> Reach {
        self.ask().reach(probe)
    }

    /// The times that it asks for, and what came of each in a motion that is known to its end; empty for kinds that are
    /// not about one moment. Of `not` there are none: what must not be has no time.
    #[must_use]
    pub fn times(&self, probe: &Probe<'_>) -> Vec<Timed> {
        self.ask().times(probe)
    }

    /// Reads the files that it names; `key` is where it stands.
    pub(crate) fn load(&mut self, key: &str, files: &dyn Files) -> Result<(), ConfigError> {
        let key = format!("{key}.{}", self.name());
        self.ask_mut().load(&key, files)
    }

    pub(super) fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        self.ask().check(place)
    }

    pub(super) fn moment(&self) -> Option<f64> {
        self.ask().moment()
    }

    pub(super) fn claims(&self) -> Vec<Claim> {
        self.ask().claims()
    }
}
