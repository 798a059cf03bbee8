//! Planes.

use super::{ConfigError, Deserialize, JsonSchema, Reader, Said, Serialize, What};

/// An infinite plane.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Plane {}

impl Said<What> for Plane {
    fn read(&self, _: &mut Reader<'_>) -> Result<What, ConfigError> {
        Ok(What::Plane)
    }
}
