//! Colours and materials: hints for drawing, without influence on anything that is sampled.

use super::called::Called;
use serde::{Deserialize, Serialize};

/// A colour in sRGB, as used on the web.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Colour(pub [u8; 3]);

/// What something seems to be made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Material {
    /// Paper, chalk.
    Matte,
    /// Lacquer, plastic, marbles.
    Glossy,
    /// Transparent.
    Glass,
    /// Steel.
    Metal,
    /// Planed and varnished.
    Wood,
    /// Cloth of a gaming table.
    Felt,
    /// Not a real thing: a mark, drawn translucent and without shadow.
    Mark,
}

/// Colour and material.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Look {
    /// The colour.
    pub colour: Colour,
    /// The material.
    pub material: Material,
    /// What the material is called, if it has a name of its own.
    #[serde(default, skip_serializing_if = "Called::is_empty")]
    pub called: Called,
}

/// Colours that remain distinct for people with colour blindness (after Okabe & Ito), brightest first.
const PALETTE: [[u8; 3]; 8] = [
    [230, 120, 40],
    [40, 130, 200],
    [35, 165, 125],
    [235, 190, 60],
    [205, 90, 150],
    [95, 185, 230],
    [200, 70, 50],
    [120, 110, 200],
];

/// Quiet colours of what stands still, told apart by hue and not by brightness.
const QUIET: [[u8; 3]; 5] = [[176, 178, 184], [196, 180, 156], [150, 170, 186], [168, 182, 158], [188, 168, 172]];

impl Look {
    /// Varnished wood.
    pub const WOOD: Self = Self::new([196, 150, 100], Material::Wood);
    /// Green cloth.
    pub const FELT: Self = Self::new([38, 104, 74], Material::Felt);
    /// A window.
    pub const GLASS: Self = Self::new([205, 225, 235], Material::Glass);
    /// Light grey, dull.
    pub const STONE: Self = Self::new(QUIET[0], Material::Matte);
    /// White, like pins.
    pub const IVORY: Self = Self::new([244, 240, 230], Material::Glossy);
    /// A place to reach.
    pub const TARGET: Self = Self::new([60, 190, 110], Material::Mark);

    /// A colour in sRGB, and a material.
    #[must_use]
    pub const fn new(colour: [u8; 3], material: Material) -> Self {
        Self { colour: Colour(colour), material, called: Called::NOTHING }
    }

    /// Share of the light from behind that passes through; `None` if nothing does.
    #[must_use]
    pub const fn clear(self) -> Option<f64> {
        match self.material {
            Material::Glass => Some(0.9),
            Material::Mark => Some(0.6),
            _ => None,
        }
    }

    /// The same of a material with a name of its own. Of a longer name the first [`Called::LONGEST`] bytes count.
    #[must_use]
    pub fn called(self, name: &str) -> Self {
        Self { called: Called::new(name), ..self }
    }

    /// The n-th of several quiet colours for what stands still, dull; the first is [`STONE`](Self::STONE). It starts over
    /// after five.
    #[must_use]
    pub const fn quiet(n: usize) -> Self {
        Self::new(QUIET[n % QUIET.len()], Material::Matte)
    }

    /// The n-th of several colours that are easy to distinguish, glossy; starts over after eight.
    #[must_use]
    pub const fn nth(n: usize) -> Self {
        Self::new(PALETTE[n % PALETTE.len()], Material::Glossy)
    }
}
