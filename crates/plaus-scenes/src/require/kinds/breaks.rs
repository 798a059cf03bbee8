//! Whether a joint breaks.

use crate::require::cast::matches;
use crate::require::kinds::Ask;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::Reach;
use crate::require::timed::Timed;
use crate::require::when::When;
use crate::scene::ConfigError;
use crate::settings::settings;

settings! {
    /// A joint breaks in an impact. For a joint that must hold, use `not`.
    pub struct Breaks {
        /// Name of a joint, or a pattern for any matching joint; empty: any joint.
        joint: String;
        /// What it costs if none breaks; or, under `not`, if one does.
        nats: f64 = 2.0, 1e-3..=1000.0, "nat";
        /// The window of time.
        when: When;
    }
}

impl Breaks {
    /// The first time in the window at which one breaks, as far as the motion is known.
    fn first(&self, probe: &Probe<'_>) -> Option<f64> {
        let window = self.when.window();
        let ours = |name: &str| self.joint.is_empty() || matches(&self.joint, name);
        let breaks = probe.motion().breaks.iter().filter(|one| one.time < probe.known() && ours(&one.joint));
        breaks.map(|one| one.time).filter(|time| (window.from..=window.to).contains(time)).reduce(f64::min)
    }
}

impl Ask for Breaks {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        place.joint("joint", &self.joint)?;
        self.when.check(place)
    }

    fn subject(&self) -> Option<&str> {
        None
    }

    fn nat(&self) -> Option<Nat> {
        Some(Nat::YES_OR_NO)
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        match self.first(probe) {
            Some(_) => Reach::certain(self.nats),
            None if probe.sees_all(self.when.window()) => Reach::certain(-self.nats),
            None => Reach::between(-self.nats, self.nats),
        }
    }

    fn times(&self, probe: &Probe<'_>) -> Vec<Timed> {
        let what = if self.joint.is_empty() { "a joint" } else { &self.joint };
        vec![Timed { what: format!("{what} breaks"), wanted: self.when.window(), found: self.first(probe) }]
    }

    fn looks(&self) -> Looks {
        Looks::after(self.when.window()).or_impacts()
    }
}
