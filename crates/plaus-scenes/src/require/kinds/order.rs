//! The order in which bodies do something.

use crate::require::event::Event;
use crate::require::kinds::{All, Ask, Before, Require};
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::{Presence, Probe};
use crate::require::score::{FAR, Mark, Reach};
use crate::require::timed::Timed;
use crate::require::when::When;
use crate::scene::ConfigError;
use crate::settings::settings;

settings! {
    /// Several bodies do something one after the other: each but the last does it, and none before the one that is
    /// named before it.
    pub struct Order {
        /// Names of bodies, the first one first. A pattern such as `domino_*` stands for all that match, by number.
        bodies: Vec<String>;
        /// What each of them does.
        each: Event;
        /// How much later than the one before, at least.
        by_ms: f64 = 0.0, 0.0..=1e6, "ms";
        /// How many milliseconds too early cost one nat.
        scale_ms: f64 = 20.0, 1e-6..=1e6, "ms";
    }
}

impl Order {
    fn event(&self, body: &str) -> Event {
        Event { body: body.to_owned(), ..self.each.clone() }
    }

    /// The bodies; those that match a pattern and are known not to be there are left out.
    fn all<'a>(&'a self, probe: &'a Probe<'_>) -> Vec<&'a str> {
        let one = |name: &'a String| match name.contains('*') {
            true => probe.bodies(name).collect(),
            false => vec![name.as_str()],
        };
        self.bodies.iter().flat_map(one).collect()
    }

    /// One before the other, for any two that follow each other.
    fn pairs(&self, bodies: &[&str]) -> All {
        let pair = |two: &[&str]| {
            let [first, then] = [two[0], two[1]].map(|body| self.event(body));
            Require::Before(Before { first, then, by_ms: self.by_ms, scale_ms: self.scale_ms })
        };
        All(bodies.windows(2).map(pair).collect())
    }
}

impl Ask for Order {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        let bodies = place.at("bodies");
        for (index, name) in self.bodies.iter().enumerate() {
            if name.is_empty() {
                return Err(bodies.entry(index).wrong("the name of a body is missing"));
            }
            place.body(&format!("bodies[{index}]"), name)?;
        }
        let mut all: Vec<&str> = self.bodies.iter().flat_map(|name| place.cast().matching(name)).collect();
        if all.len() < 2 {
            return Err(bodies.wrong("an order takes two bodies at least"));
        }
        all.sort_unstable();
        if let Some(twice) = all.windows(2).find(|two| two[0] == two[1]) {
            return Err(bodies.wrong(&format!("{} is there twice, and cannot come before itself", twice[0])));
        }
        if !self.each.body.is_empty() {
            return Err(place.at("each.body").wrong("the bodies are those in `bodies`: leave this out"));
        }
        self.event(all[0]).check(&place.at("each"))
    }

    fn subject(&self) -> Option<&str> {
        None
    }

    fn nat(&self) -> Option<Nat> {
        Some(Nat::of(self.scale_ms, "ms"))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        let bodies = self.all(probe);
        // Which bodies follow each other depends on which are there.
        if bodies.iter().any(|body| probe.presence(body) == Presence::Unknown) {
            let least = Mark { margin: -FAR, log: -FAR * bodies.len() as f64 };
            return Reach { least, most: Mark::of(FAR) };
        }
        self.pairs(&bodies).reach(probe)
    }

    fn times(&self, probe: &Probe<'_>) -> Vec<Timed> {
        let time = |body: &str| Timed::of_event(&self.event(body), &When::default(), probe);
        self.all(probe).into_iter().map(time).collect()
    }

    fn looks(&self) -> Looks {
        Looks::default().or_impacts()
    }
}
