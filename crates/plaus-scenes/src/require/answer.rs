//! What becomes of a draw under requirements.

use super::score::Mark;
use plaus_dist::LogPotential;
use serde::{Deserialize, Serialize};

/// An outcome, with a judgement of how well each requirement is met.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Answer<O> {
    /// The scene's own outcome.
    pub outcome: O,
    /// The judgement of the requirements; `None` if there are none.
    pub judged: Option<Box<Judged>>,
}

/// The judgement of requirements on an outcome.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Judged {
    /// The scene's own log constraint.
    pub own: LogPotential,
    /// A mark for each requirement, in order; then that of the [`Judge`](super::Judge), if there was one.
    pub marks: Vec<Mark>,
}

impl<O> Answer<O> {
    /// A mark for each requirement, in order; then that of the [`Judge`](super::Judge), if there was one.
    #[must_use]
    pub fn marks(&self) -> &[Mark] {
        self.judged.as_ref().map_or(&[], |judged| &judged.marks)
    }

    /// The same with the one mark that only `other` has: that of a [`Judge`](super::Judge) that was not asked here.
    /// `own` is the scene's own log constraint.
    #[must_use]
    pub fn completed_by(mut self, other: &Self, own: LogPotential) -> Self {
        if let Some([further]) = other.marks().get(self.marks().len()..) {
            let judged = self.judged.get_or_insert_with(|| Box::new(Judged { own, marks: Vec::new() }));
            judged.marks.push(*further);
        }
        self
    }
}
