//! Boxes.

use super::{
    Amount, ConfigError, Deserialize, Form, JsonSchema, Length, MM, Made, Reader, Round, Rounding, Said, Serialize,
    Value, animation, vector,
};
use plaus_sim::shape::{self, Shape as Solid};

/// A box.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cuboid {
    /// Its edges along x, y and z.
    pub size_mm: [Amount<Length>; 3],
    /// Radius of its edges and corners; 0 is sharp. The faces do not move.
    #[serde(default)]
    pub rounding_mm: Amount<Rounding>,
}

impl Said for Cuboid {
    fn read(&self, reader: &mut Reader<'_>) -> Result<Form, ConfigError> {
        let size = reader.three("size_mm", "size_", &self.size_mm)?;
        let rounding = reader.number("rounding_mm", "rounding", &self.rounding_mm)?;
        let form = reader.form(Round::Not, move |numbers| {
            let cuboid = shape::Cuboid::new(vector(&size, numbers) * MM, rounding.metres(numbers))?;
            let drawn = animation::Shape::Cuboid { half: cuboid.half(), pips: None };
            Ok(Made::plain(Solid::Cuboid(cuboid), drawn))
        });
        let is_angular = rounding == Value::Fixed(0.0);
        Ok(Form { roundings: vec![rounding], is_angular, cuboid: Some((size, rounding)), ..form })
    }
}
