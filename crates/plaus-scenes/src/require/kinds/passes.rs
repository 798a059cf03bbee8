//! Passing a point.

use crate::require::kinds::Ask;
use crate::require::kinds::inside::{How, Inside};
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::Reach;
use crate::require::timed::Timed;
use crate::require::when::When;
use crate::scene::ConfigError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A body's middle passes near a point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Passes {
    /// Name of a body. May be left out if there is only one.
    pub body: String,
    /// The point along x.
    #[schemars(extend("minimum" = -1e6, "maximum" = 1e6, "x-unit" = "mm"))]
    pub x_mm: f64,
    /// Along y.
    #[schemars(extend("minimum" = -1e6, "maximum" = 1e6, "x-unit" = "mm"))]
    pub y_mm: f64,
    /// The point's height.
    #[schemars(extend("minimum" = -1e6, "maximum" = 1e6, "x-unit" = "mm"))]
    pub z_mm: f64,
    /// A body that comes closer than this meets the requirement.
    #[schemars(extend("minimum" = 1e-3, "maximum" = 1e6, "x-unit" = "mm"))]
    pub within_mm: f64,
    /// How many millimetres farther away cost one nat.
    #[schemars(extend("minimum" = 1e-6, "maximum" = 1e6, "x-unit" = "mm"))]
    pub scale_mm: f64,
    /// The window of time.
    pub when: When,
}

impl Default for Passes {
    fn default() -> Self {
        let (body, when) = (String::new(), When::default());
        Self { body, x_mm: 0.0, y_mm: 0.0, z_mm: 0.0, within_mm: 10.0, scale_mm: 5.0, when }
    }
}

impl Passes {
    /// Some time inside a ball about the point.
    fn ball(&self) -> Inside {
        Inside {
            body: self.body.clone(),
            centre_mm: Some([self.x_mm, self.y_mm, self.z_mm]),
            radius_mm: self.within_mm,
            how: How::Sometimes,
            scale_mm: self.scale_mm,
            when: self.when,
            ..Inside::default()
        }
    }
}

impl Ask for Passes {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        self.ball().check(place)
    }

    fn subject(&self) -> Option<&str> {
        Some(&self.body)
    }

    fn nat(&self) -> Option<Nat> {
        Some(Nat::of(self.scale_mm, "mm"))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        self.ball().reach(probe)
    }

    fn times(&self, probe: &Probe<'_>) -> Vec<Timed> {
        let [x, y, z] = [self.x_mm, self.y_mm, self.z_mm];
        let what = format!("{} passes ({x}, {y}, {z})", probe.name(&self.body));
        self.ball().times(probe).into_iter().map(|time| Timed { what: what.clone(), ..time }).collect()
    }

    fn looks(&self) -> Looks {
        self.ball().looks()
    }
}
