//! Where a body is, seen from another.

use crate::require::kinds::Ask;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::Reach;
use crate::require::ways::level;
use crate::require::when::When;
use crate::scene::ConfigError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A body's middle is so far from another's, at the end or at a time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Relative {
    /// Name of a body.
    pub body: String,
    /// Name of the body it is seen from.
    pub to: String,
    /// How far along x. Unset: any.
    #[schemars(extend("minimum" = -1e6, "maximum" = 1e6, "x-unit" = "mm", "x-example" = 20.0))]
    pub x_mm: Option<f64>,
    /// How far along y. Unset: any.
    #[schemars(extend("minimum" = -1e6, "maximum" = 1e6, "x-unit" = "mm", "x-example" = 0.0))]
    pub y_mm: Option<f64>,
    /// How far upwards. Unset: any.
    #[schemars(extend("minimum" = -1e6, "maximum" = 1e6, "x-unit" = "mm", "x-example" = 0.0))]
    pub z_mm: Option<f64>,
    /// A body that is closer to that meets it.
    #[schemars(extend("minimum" = 1e-3, "maximum" = 1e6, "x-unit" = "mm"))]
    pub within_mm: f64,
    /// What lies farther off loses one nat each so many millimetres.
    #[schemars(extend("minimum" = 1e-6, "maximum" = 1e6, "x-unit" = "mm"))]
    pub scale_mm: f64,
    /// At which time: `at_s`, `frame` or `from_s`. Without one: at the end.
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
            return Err(place.at("to").wrong("a body cannot be seen from itself"));
        }
        if [self.x_mm, self.y_mm, self.z_mm] == [None; 3] {
            return Err(place.wrong("where? Give `x_mm`, `y_mm` or `z_mm`"));
        }
        self.when.check(place)
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

    fn moment(&self) -> Option<f64> {
        self.when.instant()
    }
}
