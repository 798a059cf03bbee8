//! Regions of space, and in which of them bodies end.

use super::values::MM;
use crate::scene::ConfigError;
use crate::settings::settings;
use glam::DVec3;

settings! {
    /// A region of space: a box, without end along axes that are not given. In tables, the column `ball.region` tells
    /// in which one a body's centre of gravity ends.
    pub struct Region {
        /// Range along x. Unset: anywhere.
        #[schemars(extend("x-unit" = "mm"))]
        x_mm: Option<[f64; 2]>;
        /// Range along y. Unset: anywhere.
        #[schemars(extend("x-unit" = "mm"))]
        y_mm: Option<[f64; 2]>;
        /// Range of height. Unset: anywhere.
        #[schemars(extend("x-unit" = "mm"))]
        z_mm: Option<[f64; 2]>;
    }
}

impl Region {
    fn sides(&self) -> [(&'static str, Option<[f64; 2]>); 3] {
        [("x_mm", self.x_mm), ("y_mm", self.y_mm), ("z_mm", self.z_mm)]
    }

    fn holds(&self, place: DVec3) -> bool {
        let along = self.sides().into_iter().zip((place / MM).to_array());
        along.into_iter().all(|((_, side), x)| side.is_none_or(|[low, high]| low <= x && x < high))
    }

    /// The number, from 1, of the first region that holds a place in m; 0 if none does.
    pub(super) fn of(all: &[Self], place: DVec3) -> usize {
        all.iter().position(|region| region.holds(place)).map_or(0, |index| index + 1)
    }

    /// Refuses ranges that are none.
    pub(super) fn check(all: &[Self]) -> Result<(), ConfigError> {
        for (index, region) in all.iter().enumerate() {
            let sides = region.sides();
            let is_range = |side: &[f64; 2]| side[0] < side[1] && side.iter().all(|x| x.abs() <= 1e6);
            let key = format!("world.custom.regions[{index}]");
            if sides.iter().all(|(_, side)| side.is_none()) {
                return Err(ConfigError::new(key, "which region? Give `x_mm`, `y_mm` or `z_mm`"));
            }
            if let Some((name, _)) = sides.iter().find(|(_, side)| side.is_some_and(|side| !is_range(&side))) {
                let range = "a range in mm: the first number is the smaller one, and both are at most 1e6";
                return Err(ConfigError::new(format!("{key}.{name}"), range));
            }
        }
        Ok(())
    }
}
