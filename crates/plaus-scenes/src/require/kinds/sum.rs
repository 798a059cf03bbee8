//! The sum of dice.

use crate::require::kinds::Ask;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::{Band, Reach, Span};
use crate::require::sides::{count, face_up};
use crate::require::when::When;
use crate::scene::ConfigError;
use crate::settings::settings;

settings! {
    /// The numbers on the faces of dice that count add up to a number within limits.
    pub struct Sum {
        /// Which dice: a pattern such as `die_*`.
        of: String = "*".to_owned();
        /// The least allowed. Unset: no lower limit.
        #[schemars(extend("x-example" = 7))]
        at_least: Option<u32>, 0..=1_000_000;
        /// The most allowed. Unset: no upper limit.
        #[schemars(extend("x-example" = 7))]
        at_most: Option<u32>, 0..=1_000_000;
        /// What each pip too few or too many costs.
        nats_each: f64 = 1.0, 1e-3..=1000.0, "nat";
        /// At which time: `at_s`, `frame` or `from_s`. Unset: at the end.
        when: When;
    }
}

impl Sum {
    /// Half a pip of room on either side, so that no sum lies on an edge.
    fn band(&self) -> Band {
        let from = self.at_least.map_or(f64::NEG_INFINITY, |n| f64::from(n) - 0.5);
        let to = self.at_most.map_or(f64::INFINITY, |n| f64::from(n) + 0.5);
        Band { from, to, scale: 1.0 / self.nats_each }
    }
}

impl Ask for Sum {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        place.body("of", &self.of)?;
        if !place.cast().faces && place.cast().marks.is_empty() {
            return Err(place.at("of").wrong("no body here has faces with numbers"));
        }
        place.turned()?;
        self.when.check(place)?;
        place.limits(self.at_least.map(f64::from), self.at_most.map(f64::from))
    }

    fn subject(&self) -> Option<&str> {
        None
    }

    fn nat(&self) -> Option<Nat> {
        // Limits lie half a pip beyond the numbers that are allowed.
        Some(Nat::of(1.0 / self.nats_each, "pips").beyond(0.5 * self.nats_each))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        let probe = probe.turned();
        let time = probe.moment(self.when.instant());
        let spans = probe.bodies(&self.of).map(|body| match (probe.track(body), time) {
            (Some(track), Some(time)) => Span::at(f64::from(face_up(probe.cast(), track, time).unwrap_or(0))),
            // It may be absent, or show any face.
            _ => Span { low: 0.0, high: count(probe.cast(), body) as f64 },
        });
        let all = spans.fold(Span::at(0.0), |a, b| Span { low: a.low + b.low, high: a.high + b.high });
        self.band().reach(all)
    }

    fn looks(&self) -> Looks {
        Looks::at(self.when.instant())
    }
}
