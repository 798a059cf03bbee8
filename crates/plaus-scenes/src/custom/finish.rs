//! How surfaces look.

use crate::animation;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How a surface looks; it has no influence on motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Finish {
    /// Paper, chalk.
    Matte,
    /// Lacquer, plastic, marbles.
    #[default]
    Glossy,
    /// Transparent.
    Glass,
    /// Steel.
    Metal,
    /// Planed and varnished.
    Wood,
    /// Cloth.
    Felt,
}

impl Finish {
    pub(super) fn material(self) -> animation::Material {
        match self {
            Self::Matte => animation::Material::Matte,
            Self::Glossy => animation::Material::Glossy,
            Self::Glass => animation::Material::Glass,
            Self::Metal => animation::Material::Metal,
            Self::Wood => animation::Material::Wood,
            Self::Felt => animation::Material::Felt,
        }
    }
}
