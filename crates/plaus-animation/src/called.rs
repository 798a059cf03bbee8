//! Names that are copied like numbers.

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::borrow::Cow;
use std::fmt;

/// A short name, or none.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Called([u8; Self::LONGEST]);

impl Called {
    /// Its most bytes.
    pub const LONGEST: usize = 64;
    /// No name.
    pub const NOTHING: Self = Self([0; Self::LONGEST]);

    /// The beginning of a name, as far as it fits.
    #[must_use]
    pub fn new(name: &str) -> Self {
        let mut bytes = [0; Self::LONGEST];
        let kept = &name.as_bytes()[..name.floor_char_boundary(Self::LONGEST)];
        bytes[..kept.len()].copy_from_slice(kept);
        Self(bytes)
    }

    /// The name; empty if there is none.
    #[must_use]
    pub fn as_str(&self) -> &str {
        let end = self.0.iter().position(|byte| *byte == 0).unwrap_or(Self::LONGEST);
        std::str::from_utf8(&self.0[..end]).unwrap_or_default()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0[0] == 0
    }
}

impl Default for Called {
    fn default() -> Self {
        Self::NOTHING
    }
}

impl fmt::Debug for Called {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), f)
    }
}

impl Serialize for Called {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(self.as_str())
    }
}

impl<'de> Deserialize<'de> for Called {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        Cow::<str>::deserialize(from).map(|name| Self::new(&name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::de::IntoDeserializer;
    use serde::de::value::Error;

    #[test]
    fn names_are_kept_as_far_as_they_fit() {
        for name in ["", "steel", "Eschenholz, geölt"] {
            let called = Called::new(name);
            assert_eq!((called.as_str(), called.is_empty()), (name, name.is_empty()));
            let read: Result<Called, Error> = Called::deserialize(called.as_str().into_deserializer());
            assert_eq!(read.ok(), Some(called));
        }
        let long = format!("a{}", "ö".repeat(40));
        assert_eq!(Called::new(&long).as_str(), &long[..63], "never half a letter");
    }
}
