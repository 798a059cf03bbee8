//! Where a body is, relative to another.

use crate::require::kinds::Ask;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::Reach;
use crate::require::ways::level;
use crate::require::when::When;
use crate::scene::ConfigError;
use crate::settings::settings;

settings! {
    /// A body's middle is at a given place relative to another's, at the end or at some time.
    pub struct Relative {
        /// Name of a body.
        body: String;
        /// Name of the other body.
        to: String;
        /// Distance along x from the other body. Unset: any.
        #[schemars(extend("x-example" = 20.0))]
        x_mm: Option<f64>, -1e6..=1e6, "mm";
        /// Distance along y from the other body. Unset: any.
        #[schemars(extend("x-example" = 0.0))]
        y_mm: Option<f64>, -1e6..=1e6, "mm";
        /// Height above the other body. Unset: any.
        #[schemars(extend("x-example" = 0.0))]
        z_mm: Option<f64>, -1e6..=1e6, "mm";
        /// A body that is closer than this to that place meets the requirement.
        within_mm: f64 = 10.0, 1e-3..=1e6, "mm";
        /// How many millimetres farther away cost one nat.
        scale_mm: f64 = 5.0, 1e-6..=1e6, "mm";
        /// At which time: `at_s`, `frame` or `from_s`. Unset: at the end.
        when: When;
    }
}

impl Ask for Relative {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        place.one_body("body", &self.body)?;
        place.one_body("to", &self.to)?;
        if self.body == self.to {
            return Err(place.at("to").wrong("`body` and `to` are the same body"));
        }
        if [self.x_mm, self.y_mm, self.z_mm] == [None; 3] {
            return Err(place.wrong("no place given: give `x_mm`, `y_mm` or `z_mm`"));
        }
        self.when.check(place)
    }

    fn subject(&self) -> Option<&str> {
        Some(&self.body)
    }

    fn nat(&self) -> Option<Nat> {
        Some(Nat::of(self.scale_mm, "mm"))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        let margin = |off: f64| (self.within_mm - off) / self.scale_mm;
        let Some(time) = probe.moment(self.when.instant()) else { return Reach::up_to(margin(0.0)) };
        let Some((one, other)) = probe.track(&self.body).zip(probe.track(&self.to)) else { return Reach::NEVER };
        let between = 1e3 * level(one.position(time) - other.position(time));
        let wanted = [self.x_mm, self.y_mm, self.z_mm].into_iter().zip(between.to_array());
        let squares = wanted.map(|(wanted, found)| wanted.map_or(0.0, |wanted| (found - wanted) * (found - wanted)));
        let off = squares.sum::<f64>().sqrt();
        Reach::certain(margin(off))
    }

    fn looks(&self) -> Looks {
        Looks::at(self.when.instant())
    }
}
