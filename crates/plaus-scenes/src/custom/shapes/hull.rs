//! Convex hulls of points.

use super::{
    Amount, ConfigError, Deserialize, Form, JsonSchema, MM, Made, Place, Reader, Round, Rounding, Said, Serialize,
    Value, Values, vector,
};
use glam::DVec3;
use plaus_sim::shape::ConvexHull;

/// The convex hull of points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Hull {
    /// Its corners; points inside the hull are allowed.
    #[schemars(length(min = 4, max = 1000))]
    pub points_mm: Vec<[Amount<Place>; 3]>,
    /// How far the body reaches beyond the hull, on all sides; 0 is sharp.
    #[serde(default)]
    pub rounding_mm: Amount<Rounding>,
}

impl Said for Hull {
    fn read(&self, reader: &mut Reader<'_>) -> Result<Form, ConfigError> {
        let points = self.points_mm.iter().enumerate();
        let points = points
            .map(|(index, point)| reader.three(&format!("points_mm[{index}]"), &format!("point_{index}_"), point));
        let points: Vec<Values> = points.collect::<Result<_, _>>()?;
        let rounding = reader.number("rounding_mm", "rounding", &self.rounding_mm)?;
        let form = reader.form(Round::Not, move |numbers| {
            let points: Vec<DVec3> = points.iter().map(|point| vector(point, numbers) * MM).collect();
            Made::hull(ConvexHull::new(&points, rounding.metres(numbers))?)
        });
        let is_angular = rounding == Value::Fixed(0.0) && form.is_fixed;
        Ok(Form { roundings: vec![rounding], is_angular, ..form })
    }
}
