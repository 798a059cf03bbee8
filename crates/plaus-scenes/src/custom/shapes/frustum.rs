//! Cylinders, cones and rods with round ends.

use super::{Amount, ConfigError, Deserialize, Form, JsonSchema, Length, Made, Reader, Round, Said, Serialize};
use plaus_sim::shape::Frustum;

/// A cylinder.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cylinder {
    /// Its radius.
    pub radius_mm: Amount<Length>,
    /// Distance between its faces.
    pub height_mm: Amount<Length>,
}

impl Said for Cylinder {
    fn read(&self, reader: &mut Reader<'_>) -> Result<Form, ConfigError> {
        let radius = reader.number("radius_mm", "radius", &self.radius_mm)?;
        let height = reader.number("height_mm", "height", &self.height_mm)?;
        Ok(reader.form(Round::Rod, move |numbers| {
            Made::round(Frustum::cylinder(radius.metres(numbers), height.metres(numbers))?)
        }))
    }
}

/// A cone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cone {
    /// Radius of its base.
    pub radius_mm: Amount<Length>,
    /// Distance from base to tip; `at_mm` is half way between them.
    pub height_mm: Amount<Length>,
}

impl Said for Cone {
    fn read(&self, reader: &mut Reader<'_>) -> Result<Form, ConfigError> {
        let radius = reader.number("radius_mm", "radius", &self.radius_mm)?;
        let height = reader.number("height_mm", "height", &self.height_mm)?;
        Ok(reader.form(Round::Partly, move |numbers| {
            Made::round(Frustum::cone(radius.metres(numbers), height.metres(numbers))?)
        }))
    }
}

/// A rod with round ends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Capsule {
    /// Its radius.
    pub radius_mm: Amount<Length>,
    /// Distance between the centres of its round ends.
    pub length_mm: Amount<Length>,
}

impl Said for Capsule {
    fn read(&self, reader: &mut Reader<'_>) -> Result<Form, ConfigError> {
        let radius = reader.number("radius_mm", "radius", &self.radius_mm)?;
        let length = reader.number("length_mm", "length", &self.length_mm)?;
        Ok(reader.form(Round::Rod, move |numbers| {
            Made::round(Frustum::capsule(radius.metres(numbers), length.metres(numbers))?)
        }))
    }
}
