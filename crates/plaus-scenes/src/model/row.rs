//! A move's entry in a scene's list.

/// A move's role in the paper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Printed {
    /// It is not one of the paper's.
    Not,
    /// It is one of the paper's, with this weight.
    Weight(f64),
    /// It is one of the paper's, but its weight is left to the user.
    Free,
}

/// A move of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Its name, as in the mixture.
    pub name: &'static str,
    /// What it does.
    pub meaning: &'static str,
    /// Its weight if a scenario does not give one.
    pub weight: f64,
    /// Its role in the paper.
    pub printed: Printed,
}

impl Row {
    /// One of our own.
    #[must_use]
    pub const fn own(name: &'static str, weight: f64, meaning: &'static str) -> Self {
        Self { name, meaning, weight, printed: Printed::Not }
    }

    /// One of the paper's.
    #[must_use]
    pub const fn paper(name: &'static str, weight: f64, printed: Printed, meaning: &'static str) -> Self {
        Self { name, meaning, weight, printed }
    }
}
