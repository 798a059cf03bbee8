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
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A body's middle is at a given place relative to another's, at the end or at some time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Relative {
    /// Name of a body.
    pub body: String,
    /// Name of the other body.
    pub to: String,
    /// Distance along x from the other body. Unset: any.
    #[schemars(extend("minimum" = -1e6, "maximum" = 1e6, "x-unit" = "mm", "x-example" = 20.0))]
    pub x_mm: Option<f64>,
    /// Distance along y from the other body. Unset: any.
    #[schemars(extend("minimum" = -1e6, "maximum" = 1e6, "x-unit" = "mm", "x-example" = 0.0))]
    pub y_mm: Option<f64>,
    /// Height above the other body. Unset: any.
    #[schemars(extend("minimum" = -1e6, "maximum" = 1e6, "x-unit" = "mm", "x-example" = 0.0))]
    pub z_mm: Option<f64>,
    /// A body that is closer than this to that place meets the requirement.
    #[schemars(extend("minimum" = 1e-3, "maximum" = 1e6, "x-unit" = "mm"))]
    pub within_mm: f64,
    /// How many millimetres farther away cost one nat.
    #[schemars(extend("minimum" = 1e-6, "maximum" = 1e6, "x-unit" = "mm"))]
    pub scale_mm: f64,
    /// At which time: `at_s`, `frame` or `from_s`. Unset: at the end.
    pub when: When,
}

impl Default for Relative {
    fn default() -> Self {
        Self {
            body: String::new(),
            to: String::new(),
            x_mm: None,
            y_mm: None,
            z_mm: None,
            within_mm: 10.0,
            scale_mm: 5.0,
            when: When::default(),
        }
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
