//! How a body is turned.

use crate::require::claim::Claim;
use crate::require::kinds::Ask;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::Reach;
use crate::require::sides::Side;
use crate::require::when::When;
use crate::scene::ConfigError;
use crate::settings::settings;
use crate::turns::by_angles;
use glam::{DQuat, DVec3};
use plaus_animation::{Track, UPRIGHT};
use plaus_dist::math;

settings! {
    /// A body is turned as given, up to an angle about any axis: at the end, or at some time.
    pub struct Orientation {
        /// Name of a body. May be left out if there is only one.
        body: String;
        /// How it is turned, by angles about the scenario's x, then about its y, then about its z: as `turn_deg` of
        /// bodies.
        #[schemars(extend("x-unit" = "degree"))]
        turn_deg: [f64; 3];
        /// By which angle it may be turned away from that.
        within_deg: f64 = 20.0, 0.1..=180.0, "degree";
        /// How many degrees beyond that cost one nat.
        scale_deg: f64 = 10.0, 1e-3..=1e4, "degree";
        /// At which time: `at_s`, `frame` or `from_s`. Unset: at the end.
        when: When;
    }
}

impl Orientation {
    fn wanted(&self) -> DQuat {
        by_angles(self.turn_deg)
    }

    /// By how many degrees a body is turned away from it.
    fn off(&self, track: &Track, time: f64) -> f64 {
        let way = track.orientation(time) * (UPRIGHT * self.wanted()).conjugate();
        2.0 * math::atan2(way.xyz().length(), way.w.abs()).to_degrees()
    }
}

impl Ask for Orientation {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        place.one_body("body", &self.body)?;
        if !self.turn_deg.iter().all(|angle| angle.abs() <= 1e6) {
            return Err(place.at("turn_deg").wrong("three angles from -1e6 to 1e6 degrees"));
        }
        place.turned()?;
        self.when.check(place)
    }

    fn subject(&self) -> Option<&str> {
        Some(&self.body)
    }

    fn nat(&self) -> Option<Nat> {
        Some(Nat::of(self.scale_deg, "degrees"))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        let probe = probe.turned();
        let margin = |angle: f64| (self.within_deg - angle) / self.scale_deg;
        let Some(time) = probe.moment(self.when.instant()) else { return Reach::between(margin(180.0), margin(0.0)) };
        probe.track(&self.body).map_or(Reach::NEVER, |track| Reach::certain(margin(self.off(track, time))))
    }

    fn looks(&self) -> Looks {
        Looks::at(self.when.instant())
    }

    /// Each axis points where it then does, up to the same angle.
    fn claims(&self) -> Vec<Claim> {
        let points = |axis: DVec3| Claim::Points {
            body: self.body.clone(),
            at: self.when.instant(),
            side: Side::Axis(axis),
            toward: self.wanted() * axis,
            within_deg: self.within_deg,
        };
        DVec3::AXES.map(points).into()
    }
}
