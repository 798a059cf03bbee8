//! The kinds of requirements: one file and one row each.

mod air_time;
mod apart;
mod beats;
mod before;
mod bounces;
mod breaks;
mod combine;
mod count;
mod faces_up;
mod falls;
mod height;
mod impact;
mod impulse;
mod in_view;
mod inside;
mod leaves;
mod named;
mod order;
mod orientation;
mod passes;
mod path_length;
mod points;
mod relative;
mod rests;
mod rests_at;
mod rests_on;
mod speed;
mod spells;
mod spin;
mod stands;
mod sum;
mod touches;
mod turns;
mod varying;

pub use air_time::AirTime;
pub use apart::Apart;
pub use beats::{Beats, Each, Onsets};
pub use before::Before;
pub use bounces::Bounces;
pub use breaks::Breaks;
pub use combine::{All, AnyOf, AtLeast, Not};
pub use count::Count;
pub use faces_up::FacesUp;
pub use falls::Falls;
pub use height::Height;
pub use impact::Impact;
pub use impulse::Impulse;
pub use in_view::{Camera, InView};
pub use inside::{How, Inside};
pub use leaves::Leaves;
pub use named::Named;
pub use order::Order;
pub use orientation::Orientation;
pub use passes::Passes;
pub use path_length::PathLength;
pub use points::Points;
pub use relative::Relative;
pub use rests::Rests;
pub use rests_at::RestsAt;
pub use rests_on::RestsOn;
pub use speed::Speed;
pub use spells::Spells;
pub use spin::Spin;
pub use stands::Stands;
pub use sum::Sum;
pub use touches::Touches;
pub use turns::Turns;
pub(super) use varying::settled;
pub use varying::{Formula, Varying};

use super::aim::Aim;
use super::cast::Cast;
use super::claim::Claim;
use super::event::Event;
use super::looks::Looks;
use super::missed::{Missed, Nat};
use super::place::Place;
use super::probe::{Presence, Probe};
use super::score::Reach;
use super::spot::Spot;
use super::timed::Timed;
use super::when::When;
use crate::files::Files;
use crate::scene::ConfigError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What every kind of requirement must provide.
pub(super) trait Ask {
    /// Reads the files that it names; `key` is its own key.
    fn load(&mut self, _key: &str, _files: &dyn Files) -> Result<(), ConfigError> {
        Ok(())
    }

    /// Refuses what makes no sense: bodies that do not exist, empty windows.
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError>;

    /// How well a motion meets it; or, for a motion known in part, how well it can still be met.
    fn reach(&self, probe: &Probe<'_>) -> Reach;

    /// The body, or the pattern for bodies, that must be there, whatever else it asks for. `None` if it is about
    /// several things, or if it is met without the body.
    fn subject(&self) -> Option<&str>;

    /// What a nat of its margin measures; `None` if several things with different measures decide it.
    fn nat(&self) -> Option<Nat> {
        None
    }

    /// When the beginning of a motion may show that it can no longer be met; by default only the end shows it.
    fn looks(&self) -> Looks {
        Looks::default()
    }

    /// The events that it is about, at whatever time they happen.
    fn events(&self) -> Vec<Event> {
        Vec::new()
    }

    /// The moments that decide it: the times that it asks for, if any, and when each event happened in a motion that is
    /// known to its end.
    fn times(&self, probe: &Probe<'_>) -> Vec<Timed> {
        self.events().iter().map(|event| Timed::of_event(event, &When::default(), probe)).collect()
    }

    /// The spots at which something should come to rest, for pictures.
    fn spots(&self) -> Vec<Spot> {
        Vec::new()
    }

    /// Its claims, which other requirements may contradict.
    fn claims(&self) -> Vec<Claim> {
        Vec::new()
    }

    /// What it wants of bodies' ends, for moves that lead them there.
    fn aims(&self) -> Vec<Aim> {
        Vec::new()
    }
}

macro_rules! kinds {
    ($($(#[$doc:meta])* $name:literal $kind:ident,)+) => {
        /// A requirement on a motion.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
        pub enum Require {
            $($(#[$doc])* #[serde(rename = $name)] $kind($kind),)+
            /// One of these with formulas in place of some numbers. Scenario files just write them.
            #[serde(rename = "varying")]
            #[schemars(skip)]
            Varying(Box<Varying>),
        }

        impl Require {
            /// Names of all kinds, as in scenario files.
            pub const NAMES: &'static [&'static str] = &[$($name),+];

            /// The name of its kind.
            #[must_use]
            pub fn name(&self) -> &'static str {
                match self {
                    $(Self::$kind(_) => $name,)+
                    Self::Varying(varying) => varying.middle().map_or("varying", Self::name),
                }
            }

            fn ask(&self) -> &dyn Ask {
                match self {
                    $(Self::$kind(kind) => kind,)+
                    Self::Varying(varying) => &**varying,
                }
            }

            fn ask_mut(&mut self) -> &mut dyn Ask {
                match self {
                    $(Self::$kind(kind) => kind,)+
                    Self::Varying(varying) => &mut **varying,
                }
            }
        }
    };
}

kinds! {
    /// An impact happens within a window of time: the first of a body, the last, or another.
    "impact" Impact,
    /// A body comes to rest within a window of time.
    "rests" Rests,
    /// The number of times that a body hits something lies within limits.
    "bounces" Bounces,
    /// A face of a die, or an axis of a body, points up.
    "faces_up" FacesUp,
    /// A face or an axis of a body points in a direction.
    "points" Points,
    /// A body is turned as given.
    "orientation" Orientation,
    /// The pips on the upper faces of dice add up to a number within limits.
    "sum" Sum,
    /// A body stands.
    "stands" Stands,
    /// A body falls within a window of time.
    "falls" Falls,
    /// Some pins stand, and all others have fallen.
    "leaves" Leaves,
    /// Balls at rest in bins spell a word.
    "spells" Spells,
    /// A body comes to rest near a place.
    "rests_at" RestsAt,
    /// A body lies on another, or on a part of the scenery.
    "rests_on" RestsOn,
    /// A body is inside a region at some time, always, never, or at the end.
    "inside" Inside,
    /// A camera sees a body.
    "in_view" InView,
    /// A body passes near a point.
    "passes" Passes,
    /// A body touches another, or a part of the scenery.
    "touches" Touches,
    /// A joint breaks.
    "breaks" Breaks,
    /// One event happens before another.
    "before" Before,
    /// The time between two events lies within limits.
    "apart" Apart,
    /// Bodies do something one after the other.
    "order" Order,
    /// Impacts come on the beats of a rhythm.
    "beats" Beats,
    /// The speed of a body at an impact, or in a window of time, lies within limits.
    "speed" Speed,
    /// The angular speed of a body at an impact, or in a window of time, lies within limits.
    "spin" Spin,
    /// The greatest or the least height of a body lies within limits.
    "height" Height,
    /// The number of turns that a body makes lies within limits.
    "turns" Turns,
    /// The impulse of an impact lies within limits.
    "impulse" Impulse,
    /// The time that a body is in flight lies within limits.
    "air_time" AirTime,
    /// The length of a body's path lies within limits.
    "path_length" PathLength,
    /// A body is at a given place relative to another.
    "relative" Relative,
    /// The number of bodies that meet a requirement lies within limits.
    "count" Count,
    /// All of several requirements.
    "all" All,
    /// Any of several requirements.
    "any" AnyOf,
    /// A requirement is not met.
    "not" Not,
    /// At least a number of several requirements are met.
    "at_least" AtLeast,
    /// A requirement with a name of your own.
    "named" Named,
}

impl Require {
    /// How well a motion meets it; or, for a motion known in part, how well it can still be met. If the body that it is
    /// about is not there, it is not met.
    #[must_use]
    pub fn reach(&self, probe: &Probe<'_>) -> Reach {
        match self.ask().subject().map_or(Presence::There, |body| probe.presence(body)) {
            Presence::There => self.ask().reach(probe),
            Presence::Unknown => self.ask().reach(probe).or_never(),
            Presence::Absent => Reach::NEVER,
        }
    }

    /// The moments that decide it: the times that it asks for, if any, and when each event happened in a motion that is
    /// known to its end. Empty for kinds that are not about moments. Also empty for `not`: an event that must not
    /// happen has no time.
    #[must_use]
    pub fn times(&self, probe: &Probe<'_>) -> Vec<Timed> {
        self.ask().times(probe)
    }

    /// What galleries and messages call it, if it has a name of its own.
    #[must_use]
    pub fn own_name(&self) -> Option<&str> {
        match self {
            Self::Named(named) => Some(&named.name),
            Self::Varying(varying) => varying.middle()?.own_name(),
            _ => None,
        }
    }

    /// Whether it can only be met once the bodies that it names are at rest.
    pub(super) fn needs_rest(&self) -> bool {
        match self {
            Self::Rests(_) | Self::RestsAt(_) | Self::RestsOn(_) => true,
            Self::Named(named) => named.that.needs_rest(),
            Self::Count(count) => count.at_least.is_some_and(|least| least > 0) && count.that.needs_rest(),
            Self::All(all) => all.0.iter().any(Self::needs_rest),
            Self::AnyOf(any) => any.0.iter().all(Self::needs_rest),
            Self::Varying(varying) => varying.middle().is_some_and(Self::needs_rest),
            _ => false,
        }
    }

    /// By how much it is missed at a margin below 0, in the unit of its keys. `None` if several things with different
    /// measures decide it.
    #[must_use]
    pub fn missed(&self, margin: f64) -> Option<Missed> {
        self.nat().map(|nat| nat.missed(margin))
    }

    pub(super) fn nat(&self) -> Option<Nat> {
        self.ask().nat()
    }

    /// Reads the files that it names; `key` is its own key.
    pub(crate) fn load(&mut self, key: &str, files: &dyn Files) -> Result<(), ConfigError> {
        let key = format!("{key}.{}", self.name());
        self.ask_mut().load(&key, files)
    }

    pub(super) fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        self.ask().check(place)
    }

    pub(super) fn looks(&self) -> Looks {
        self.ask().looks()
    }

    pub(super) fn spots(&self) -> Vec<Spot> {
        self.ask().spots()
    }

    pub(super) fn claims(&self) -> Vec<Claim> {
        self.ask().claims()
    }

    fn aims(&self) -> Vec<Aim> {
        self.ask().aims()
    }

    /// What some requirements want of the ends of bodies of a cast.
    pub(super) fn aims_of(all: &[Self], cast: &Cast) -> Vec<Aim> {
        let named = |aim: Aim| Aim { body: cast.only_or(aim.body), ..aim };
        all.iter().flat_map(Self::aims).map(named).collect()
    }
}
