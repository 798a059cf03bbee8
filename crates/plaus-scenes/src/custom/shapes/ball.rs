//! Balls.

use super::{
    Amount, ConfigError, Deserialize, Form, JsonSchema, Length, Made, Reader, Round, Said, Serialize, animation,
};
use plaus_sim::shape::Shape as Solid;

/// A ball.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ball {
    /// Its radius.
    pub radius_mm: Amount<Length>,
}

impl Said for Ball {
    fn read(&self, reader: &mut Reader<'_>) -> Result<Form, ConfigError> {
        let radius = reader.number("radius_mm", "radius", &self.radius_mm)?;
        Ok(reader.form(Round::Ball, move |numbers| {
            let radius = radius.metres(numbers);
            Ok(Made::plain(Solid::Ball(radius), animation::Shape::ball(radius)))
        }))
    }
}
