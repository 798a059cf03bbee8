//! Where a face, or an axis, of a body points.

use crate::require::aim::{Aim, End, Up};
use crate::require::cast::FACES;
use crate::require::claim::Claim;
use crate::require::kinds::Ask;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::Reach;
use crate::require::sides::{Axis, Side, count};
use crate::require::when::When;
use crate::scene::ConfigError;
use crate::settings::settings;
use glam::DVec3;
use plaus_animation::{Track, upright};
use plaus_dist::math;

settings! {
    /// A face or an axis of a body points in a direction: at the end, or at some time.
    pub struct Points {
        /// Name of a body. May be left out if there is only one.
        body: String;
        /// Which face, for a die or a body with marked `faces`: its outward direction, of a die with 4 faces the
        /// opposite one. Unset: `axis` is used.
        #[schemars(extend("x-example" = 6))]
        face: Option<u32>, 1..=100;
        /// Which axis of the body.
        axis: Axis = Axis::X;
        /// The direction in which it points, along the scenario's axes and of any length.
        toward: [f64; 3] = [1.0, 0.0, 0.0];
        /// How far from that direction it may be.
        within_deg: f64 = 20.0, 0.1..=180.0, "degree";
        /// How many degrees beyond that cost one nat.
        scale_deg: f64 = 10.0, 1e-3..=1e4, "degree";
        /// At which time: `at_s`, `frame` or `from_s`. Unset: at the end.
        when: When;
    }
}

impl Points {
    /// Upwards, whichever way a number of the scenario's axes says it.
    pub(super) const UP: [f64; 3] = [0.0, 0.0, 1.0];

    /// The direction in which it points, of length 1.
    fn direction(&self) -> DVec3 {
        DVec3::from_array(self.toward).normalize_or_zero()
    }

    fn side(&self) -> Side {
        self.face.map_or(Side::Axis(self.axis.vector()), Side::Face)
    }

    /// Angle in degrees between an axis of a body and the direction.
    fn off(&self, track: &Track, axis: DVec3, time: f64) -> f64 {
        let along = (track.orientation(time) * axis).dot(upright(self.direction()));
        math::acos(along.clamp(-1.0, 1.0)).to_degrees()
    }
}

impl Ask for Points {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        place.one_body("body", &self.body)?;
        let cast = place.cast();
        if self.face.is_some() && !cast.faces && cast.marks.is_empty() {
            return Err(place.at("face").wrong("no body here has faces with numbers; use `axis`, or mark its `faces`"));
        }
        let body = cast.only_or(self.body.clone());
        let most = match body.as_str() {
            "" => cast.marks.values().map(Vec::len).max().unwrap_or(0).max(FACES.len()),
            body => count(cast, body),
        };
        if self.face.is_some_and(|face| face as usize > most) {
            return Err(place.at("face").wrong(&format!("its faces are numbered from 1 to {most}")));
        }
        place.direction("toward", self.toward)?;
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
        let track = probe.track(&self.body);
        let angle = track.and_then(|track| Some(self.off(track, self.side().axis_of(probe.cast(), track)?, time)));
        angle.map_or(Reach::NEVER, |angle| Reach::certain(margin(angle)))
    }

    fn looks(&self) -> Looks {
        Looks::at(self.when.instant())
    }

    fn claims(&self) -> Vec<Claim> {
        vec![Claim::Points {
            body: self.body.clone(),
            at: self.when.instant(),
            side: self.side(),
            toward: self.direction(),
            within_deg: self.within_deg,
        }]
    }

    /// Moves turn bodies about the vertical, so they lead to none but vertical directions.
    fn aims(&self) -> Vec<Aim> {
        let [x, y, z] = self.direction().to_array();
        let is_led = self.when.instant().is_none() && self.face.is_none() && [x, y] == [0.0, 0.0];
        let up = Up { axis: z * self.axis.vector(), within: self.within_deg, scale: self.scale_deg };
        is_led.then(|| Aim { body: self.body.clone(), end: End::Up(up) }).into_iter().collect()
    }
}
