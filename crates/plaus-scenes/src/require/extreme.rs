//! The greatest and the least value of a number that changes with time.

use super::place::Place;
use super::probe::Probe;
use super::score::{Band, Reach, Span};
use super::ways::Leg;
use super::when::When;
use crate::scene::ConfigError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Which value in a window of time counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Extreme {
    /// The greatest.
    #[default]
    Greatest,
    /// The least.
    Least,
}

impl Extreme {
    /// How a number of a body that is never below `lowest` lies in a band. `of` is its least and its greatest value
    /// over a leg.
    pub(super) fn reach(
        self,
        probe: &Probe<'_>,
        (body, when): (&str, &When),
        (band, lowest): (&Band, f64),
        of: impl Fn(&Leg) -> [f64; 2],
    ) -> Reach {
        let window = when.moments();
        if probe.is_whole() && probe.track(body).is_none() {
            return Reach::NEVER;
        }
        let (whole, mut legs) = (probe.sees_all(window), probe.legs(body, window));
        // A body at rest stays so.
        if probe.is_whole() && window.to >= probe.end() {
            legs.extend(probe.legs(body, probe.at_end()));
        }
        let wider = |[low, high]: [f64; 2], leg: [f64; 2]| [low.min(leg[0]), high.max(leg[1])];
        let [low, high] = legs.iter().map(of).fold([f64::MAX, lowest], wider);
        band.reach(match self {
            Self::Greatest => Span { low: high, high: if whole { high } else { f64::MAX } },
            Self::Least => Span { low: if whole { low } else { lowest }, high: low },
        })
    }

    /// Refuses what makes no sense of a body's number at a time; `of_impact` tells whether keys of impacts are given.
    pub(super) fn check(
        self,
        place: &Place<'_>,
        (body, when): (&str, &When),
        of_impact: bool,
    ) -> Result<(), ConfigError> {
        if !when.is_set() {
            let wrong = || place.at("which").wrong("of which window? Give `when`, or leave this out");
            return if self == Self::default() { Ok(()) } else { Err(wrong()) };
        }
        if of_impact {
            let both = "at a time, or at an impact? Leave out `when`, or else `with`, `nth`, `faster_than` and `after`";
            return Err(place.at("when").wrong(both));
        }
        place.one_body("body", body)?;
        when.check(place)
    }
}
