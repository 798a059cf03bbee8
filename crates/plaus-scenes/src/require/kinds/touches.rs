//! Whether two things touch.

use crate::require::cast::matches;
use crate::require::kinds::Ask;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::{FAR, Reach};
use crate::require::timed::Timed;
use crate::require::ways;
use crate::require::when::When;
use crate::scene::ConfigError;
use crate::settings::settings;
use plaus_animation::Track;

settings! {
    /// A body touches another, or a part of the scenery. If two bodies never touch, their least distance counts. For a
    /// body that must never touch another, use `not`.
    pub struct Touches {
        /// Name of a body, or a pattern for any matching body. May be left out if there is only one body.
        body: String;
        /// What it touches: a body, a part of the scenery, or a pattern; empty: anything.
        with: String;
        /// What it costs not to touch; or, under `not`, to touch.
        nats: f64 = 2.0, 1e-3..=1000.0, "nat";
        /// How many millimetres between two bodies cost one more nat.
        scale_mm: f64 = 20.0, 1e-6..=1e6, "mm";
        /// The window of time.
        when: When;
    }
}

impl Touches {
    /// The first time in the window at which it touches, as far as the motion is known.
    fn first(&self, probe: &Probe<'_>) -> Option<f64> {
        let window = self.when.window();
        let body = probe.name(&self.body);
        let fits = |one: &str, other: &str| matches(body, one) && (self.with.is_empty() || matches(&self.with, other));
        let contacts = probe.motion().contacts.iter().filter(|contact| contact.start < probe.known());
        let contacts =
            contacts.filter(|contact| probe.lasts_until(contact) >= window.from && contact.start <= window.to);
        let ours = contacts.filter(|one| fits(&one.body, &one.other) || fits(&one.other, &one.body));
        let hits = probe.hits(&self.body, &self.with, 0.0).map(|hit| hit.time);
        let hits = hits.filter(|time| *time >= window.from && *time <= window.to);
        hits.chain(ours.map(|contact| contact.start.max(window.from))).reduce(f64::min)
    }

    /// The least distance between the two in mm, with balls around them in their place; 0 if it is unknown.
    fn gap(&self, probe: &Probe<'_>) -> f64 {
        let Some([from, to]) = probe.seen(self.when.window()) else { return 0.0 };
        let tracks = |pattern: &str| {
            let names: Vec<&str> = probe.cast().matching(pattern).collect();
            names.into_iter().filter_map(|name| probe.track(name)).collect::<Vec<&Track>>()
        };
        let (ones, others) = (tracks(probe.name(&self.body)), tracks(&self.with));
        let pairs = ones.iter().flat_map(|one| others.iter().map(move |other| (*one, *other)));
        let gap = |(one, other): (&Track, &Track)| {
            let legs = ways::relative(one, other, from, to);
            let nearest = legs.iter().map(|leg| leg.distances(glam::DVec3::ZERO)[0]).fold(f64::INFINITY, f64::min);
            1e3 * (nearest - one.shape.reach() - other.shape.reach()).max(0.0)
        };
        let least = pairs.filter(|(one, other)| one.name != other.name).map(gap).fold(f64::INFINITY, f64::min);
        if least.is_finite() { least } else { 0.0 }
    }
}

impl Ask for Touches {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        place.body("body", &self.body)?;
        place.partner("with", &self.with)?;
        self.when.check(place)
    }

    fn subject(&self) -> Option<&str> {
        Some(&self.body)
    }

    fn nat(&self) -> Option<Nat> {
        Some(Nat::of(self.scale_mm, "mm").beyond(-self.nats))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        let probe = &probe.touched();
        if self.first(probe).is_some() {
            return Reach::certain(self.nats);
        }
        if !probe.sees_all(self.when.window()) {
            return Reach::between(-FAR, self.nats);
        }
        Reach::certain(-self.nats - self.gap(probe) / self.scale_mm)
    }

    fn times(&self, probe: &Probe<'_>) -> Vec<Timed> {
        let named = |name: &str| if name.is_empty() { "anything".to_owned() } else { name.to_owned() };
        let what = format!("{} touches {}", probe.name(&self.body), named(&self.with));
        vec![Timed { what: what.trim_start().to_owned(), wanted: self.when.window(), found: self.first(probe) }]
    }

    fn looks(&self) -> Looks {
        Looks::after(self.when.window()).or_impacts().and_contacts()
    }
}
