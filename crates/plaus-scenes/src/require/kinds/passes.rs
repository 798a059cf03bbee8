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
use crate::settings::settings;

settings! {
    /// A body's middle passes near a point.
    pub struct Passes {
        /// Name of a body. May be left out if there is only one.
        body: String;
        /// The point along x.
        x_mm: f64 = 0.0, -1e6..=1e6, "mm";
        /// Along y.
        y_mm: f64 = 0.0, -1e6..=1e6, "mm";
        /// The point's height.
        z_mm: f64 = 0.0, -1e6..=1e6, "mm";
        /// A body that comes closer than this meets the requirement.
        within_mm: f64 = 10.0, 1e-3..=1e6, "mm";
        /// How many millimetres farther away cost one nat.
        scale_mm: f64 = 5.0, 1e-6..=1e6, "mm";
        /// The window of time.
        when: When;
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
