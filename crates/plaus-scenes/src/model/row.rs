//! What is said of a move where a scene lists it.

/// What a move is to the paper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Printed {
    /// It is none of the paper's.
    Not,
    /// It is one of the paper's, which gives it this weight.
    Weight(f64),
    /// It is one of the paper's, which leaves its weight to the user.
    Free,
}

/// A move of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Its name, as in the mixture.
    pub name: &'static str,
    /// What it does.
    pub meaning: &'static str,
    /// Its weight where a scenario does not say.
    pub weight: f64,
    /// What it is to the paper.
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
