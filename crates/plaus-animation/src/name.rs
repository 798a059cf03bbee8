//! Names of looks, for readers of an export: `maple`, `glossy red`.

use super::look::{Colour, Look, Material};

/// Looks with names of their own.
const KNOWN: [(Look, &str); 6] = [
    (Look::WOOD, "maple"),
    (Look::FELT, "green felt"),
    (Look::GLASS, "window glass"),
    (Look::STONE, "grey stone"),
    (Look::IVORY, "glossy ivory"),
    (Look::TARGET, "target mark"),
];

/// Colours by name.
const COLOURS: [(&str, [u8; 3]); 16] = [
    ("black", [25, 25, 28]),
    ("dark grey", [75, 75, 80]),
    ("grey", [128, 128, 128]),
    ("light grey", [192, 192, 192]),
    ("white", [245, 244, 240]),
    ("red", [200, 45, 40]),
    ("orange", [230, 120, 40]),
    ("amber", [214, 160, 60]),
    ("yellow", [235, 205, 60]),
    ("green", [35, 155, 90]),
    ("light blue", [95, 185, 230]),
    ("blue", [40, 120, 200]),
    ("navy", [36, 52, 120]),
    ("purple", [120, 100, 200]),
    ("pink", [205, 90, 150]),
    ("brown", [130, 85, 50]),
];

impl Look {
    /// The material's own name, or else one in lower-case words, such as `maple` or `glossy red`, which looks of
    /// similar colour share.
    #[must_use]
    pub fn name(self) -> String {
        if !self.called.is_empty() {
            return self.called.as_str().to_owned();
        }
        if let Some((_, name)) = KNOWN.iter().find(|(look, _)| *look == self) {
            return (*name).to_owned();
        }
        format!("{} {}", self.material.name(), self.colour.name())
    }
}

impl Material {
    /// What it is, in one lower-case word.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Matte => "matte",
            Self::Glossy => "glossy",
            Self::Glass => "glass",
            Self::Metal => "metal",
            Self::Wood => "wooden",
            Self::Felt => "felt",
            Self::Mark => "mark",
        }
    }
}

impl Colour {
    /// The nearest of sixteen colours that have names.
    #[must_use]
    pub fn name(self) -> &'static str {
        let off = |other: [u8; 3]| -> u32 {
            self.0.iter().zip(other).map(|(a, b)| u32::from(a.abs_diff(b)) * u32::from(a.abs_diff(b))).sum()
        };
        COLOURS.iter().min_by_key(|(_, colour)| off(*colour)).map_or("grey", |(name, _)| name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looks_are_called_what_one_sees() {
        assert_eq!(Look::WOOD.name(), "maple");
        assert_eq!(Look::new([200, 40, 40], Material::Glossy).name(), "glossy red");
        assert_eq!(Look::WOOD.called("beech").name(), "beech");
        assert_eq!(Look::new([255, 255, 255], Material::Matte).name(), "matte white");
        let eight: Vec<String> = (0..8).map(|n| Look::nth(n).name()).collect();
        let mut distinct = eight.clone();
        distinct.sort();
        distinct.dedup();
        assert!(distinct.len() >= 7, "{eight:?}");
    }
}
