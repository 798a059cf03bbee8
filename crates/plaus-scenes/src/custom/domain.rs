//! The allowed values of a number, for any law.

/// What a number may be, whatever its law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Domain {
    /// Any number.
    Any,
    /// An angle: any number; values that differ by whole turns are the same.
    Turn,
    /// Any number of a unit that is not known: it may be an angle in degrees.
    Plain,
    /// At least 0.
    NotNegative,
    /// From 0 to 1.
    Share,
}

impl Domain {
    /// Whether all values between these are allowed.
    pub(super) fn holds(self, [low, high]: [f64; 2]) -> bool {
        match self {
            Self::Any | Self::Turn | Self::Plain => true,
            Self::NotNegative => low >= 0.0,
            Self::Share => low >= 0.0 && high <= 1.0,
        }
    }

    /// What is allowed, in words.
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Any | Self::Turn | Self::Plain => "any number",
            Self::NotNegative => "at least 0",
            Self::Share => "from 0 to 1",
        }
    }
}
