//! What happens at a time: impacts, and coming to rest.

use super::place::Place;
use super::probe::{Presence, Probe};
use super::score::{Band, FAR, Reach, Span};
use crate::scene::ConfigError;
use crate::settings::settings;
use plaus_animation::Impact;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

settings! {
    /// An event: the n-th impact of a body, or its coming to rest.
    pub struct Event {
        /// Name of a body as in exports, or a pattern such as `ball_*` for all matching bodies. May be left out if
        /// there is only one body.
        body: String;
        /// What happens.
        what: What = What::Impact;
        /// For impacts: with what, a body or a part of the scenery; empty: with anything.
        with: String;
        /// For impacts: which of them, counted from 1; −1 is the last, −2 the last but one.
        nth: i32 = 1, -10_000..=10_000;
        /// For impacts: only count those at which the two meet at this speed or faster.
        faster_than: f64 = 0.0, 0.0..=1000.0, "m/s";
        /// For falls: a body whose third axis leans farther than this from upright has fallen.
        fallen_deg: f64 = 45.0, 0.1..=179.0, "degree";
    }
}

/// What happens.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum What {
    /// It hits something.
    #[default]
    Impact,
    /// It comes to rest; for several bodies, the last of those that are there does.
    Rest,
    /// It falls over, as its third axis leans too far; for several bodies, the last of those that are there does.
    Fall,
}

/// Declares a kind of requirement about one impact: keys that choose it, as an [`Event`]; then the kind's own, as in
/// [`settings`].
macro_rules! of_impact {
    ($(#[$doc:meta])* pub struct $kind:ident { $($own:tt)* }) => {
        $crate::settings::settings! {
            $(#[$doc])*
            pub struct $kind {
                /// Name of a body, or a pattern such as `ball_*` for any matching body. May be left out if there is
                /// only one body.
                body: String;
                /// What it hits: a body, a part of the scenery, or a pattern; empty: anything.
                with: String;
                /// Which of its impacts, counted from 1; −1 is the last, −2 the last but one.
                nth: i32 = 1, -10_000..=10_000;
                /// Only count impacts at which the two meet at this speed or faster.
                faster_than: f64 = 0.0, 0.0..=1000.0, "m/s";
                $($own)*
            }
        }

        impl $kind {
            fn event(&self) -> $crate::require::event::Event {
                let Self { body, with, nth, faster_than, .. } = self.clone();
                $crate::require::event::Event { body, with, nth, faster_than, ..Default::default() }
            }
        }
    };
}
pub(super) use of_impact;

impl Event {
    pub(super) fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        place.body("body", &self.body)?;
        place.partner("with", &self.with)?;
        if self.what == What::Fall {
            place.turned()?;
        }
        if self.nth == 0 {
            return Err(place.at("nth").wrong("there is no impact 0: count from 1 forwards, or from −1 backwards"));
        }
        Ok(())
    }

    /// When it happens.
    pub(super) fn time(&self, probe: &Probe<'_>) -> Span {
        match self.what {
            What::Rest | What::Fall => {
                let time = |body: &str| match (probe.presence(body), self.what) {
                    // Others alone may count.
                    (Presence::Unknown, _) => Span::from(0.0),
                    (_, What::Fall) => probe.turned().fall(body, self.fallen_deg),
                    _ => probe.rest(body),
                };
                let last = |a: Span, b: Span| Span { low: a.low.max(b.low), high: a.high.max(b.high) };
                probe.bodies(&self.body).map(time).reduce(last).unwrap_or(Span::NEVER)
            }
            What::Impact => match (self.found(probe), probe.is_whole()) {
                (Some(hit), true) => Span::at(hit.time),
                (Some(hit), false) if self.nth > 0 => Span::at(hit.time),
                // Later impacts may still change which one is the n-th last.
                (Some(hit), false) => Span::from(hit.time),
                (None, true) => Span::NEVER,
                (None, false) => Span::from(if self.nth > 0 { probe.known() } else { 0.0 }),
            },
        }
    }

    /// The impact, as far as it is known.
    pub(super) fn found<'a>(&self, probe: &Probe<'a>) -> Option<&'a Impact> {
        let nth = self.nth.unsigned_abs() as usize - 1;
        let hits: Vec<&'a Impact> = probe.hits(&self.body, &self.with, self.faster_than).collect();
        if self.nth > 0 { hits.get(nth).copied() } else { hits.iter().rev().nth(nth).copied() }
    }

    /// The range of a number of the impact relative to `band`; it is unknown as long as the impact is unknown.
    pub(super) fn measured(
        &self,
        probe: &Probe<'_>,
        band: &Band,
        number: impl FnOnce(&Impact) -> Option<f64>,
    ) -> Reach {
        let certain = probe.is_whole() || self.nth > 0;
        match self.found(probe).filter(|_| certain) {
            Some(hit) => number(hit).map_or(Reach::NEVER, |number| band.reach(Span::at(number))),
            None if probe.is_whole() => Reach::NEVER,
            None => Reach::between(-FAR, band.reach(Span { low: 0.0, high: f64::MAX }).most.margin),
        }
    }

    /// Whether both mean the same event, apart from when it happens.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        let alike = match self.what {
            What::Rest => true,
            What::Fall => self.fallen_deg == other.fallen_deg,
            What::Impact => self.with == other.with && self.nth == other.nth && self.faster_than == other.faster_than,
        };
        self.body == other.body && self.what == other.what && alike
    }
}
