//! How often a body hits something.

use crate::require::claim::Claim;
use crate::require::event::Event;
use crate::require::kinds::Ask;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::{Band, Reach, Span};
use crate::require::timed::{Timed, words};
use crate::require::when::When;
use crate::scene::ConfigError;
use crate::settings::settings;

settings! {
    /// The number of times that a body hits something lies within limits.
    pub struct Bounces {
        /// Name of a body, or a pattern such as `ball_*`: impacts of all matching bodies count. May be left out if
        /// there is only one body.
        body: String;
        /// What it hits: a body, a part of the scenery, or a pattern; empty: anything.
        with: String;
        /// Only count impacts at which the two meet at this speed or faster: the last bounces of a thing are many and
        /// small.
        faster_than: f64 = 0.05, 0.0..=1000.0, "m/s";
        /// The least allowed. Unset: no lower limit.
        #[schemars(extend("x-example" = 4))]
        at_least: Option<u32>, 0..=1_000_000;
        /// The most allowed. Unset: no upper limit.
        #[schemars(extend("x-example" = 4))]
        at_most: Option<u32>, 0..=1_000_000;
        /// What each bounce too few or too many costs.
        nats_each: f64 = 2.0, 1e-3..=1000.0, "nat";
        /// Only impacts in this window count.
        when: When;
    }
}

impl Bounces {
    /// Half a bounce of room on either side, so that no count lies on an edge.
    fn band(&self) -> Band {
        let from = self.at_least.map_or(f64::NEG_INFINITY, |n| f64::from(n) - 0.5);
        let to = self.at_most.map_or(f64::INFINITY, |n| f64::from(n) + 0.5);
        Band { from, to, scale: 1.0 / self.nats_each }
    }

    /// When those happen that count.
    fn hits<'a>(&'a self, probe: &Probe<'a>) -> impl Iterator<Item = f64> + 'a {
        let window = self.when.window();
        let hits = probe.hits(&self.body, &self.with, self.faster_than).map(|hit| hit.time);
        hits.filter(move |time| (window.from..=window.to).contains(time))
    }
}

impl Ask for Bounces {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        place.body("body", &self.body)?;
        place.partner("with", &self.with)?;
        self.when.check(place)?;
        place.limits(self.at_least.map(f64::from), self.at_most.map(f64::from))
    }

    fn subject(&self) -> Option<&str> {
        Some(&self.body)
    }

    fn nat(&self) -> Option<Nat> {
        // Limits lie half a bounce beyond the numbers that are allowed.
        Some(Nat::of(1.0 / self.nats_each, "bounces").beyond(0.5 * self.nats_each))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        let window = self.when.window();
        let count = self.hits(probe).count() as f64;
        // The number of further impacts has no limit, but the bound must be a finite number.
        let most = if probe.sees_all(window) { count } else { f64::MAX };
        self.band().reach(Span { low: count, high: most })
    }

    /// The last of those that must happen.
    fn times(&self, probe: &Probe<'_>) -> Vec<Timed> {
        let Some(least) = self.at_least.filter(|least| *least > 0) else { return Vec::new() };
        let event = Event { body: self.body.clone(), with: self.with.clone(), nth: least as i32, ..Event::default() };
        let wanted = When::default().window();
        vec![Timed { what: words(&event, probe), wanted, found: self.hits(probe).nth(least as usize - 1) }]
    }

    fn looks(&self) -> Looks {
        Looks::after(self.when.window()).or_impacts()
    }

    fn claims(&self) -> Vec<Claim> {
        let what = format!("{} {} {} {:?}", self.body, self.with, self.faster_than, self.when.window());
        let range = Band::of_limits(self.at_least.map(f64::from), self.at_most.map(f64::from), 1.0);
        vec![Claim::number(format!("bounces {what}"), range)]
    }
}
