//! Draws whose simulation failed: they have probability 0, and are counted.
//!
//! A failure is no error: the run goes on as if the constraint forbade the draw. So that nobody has to wonder what is
//! missing from a run's states, its chains count what failed, and keep the first example of each kind. Counts and
//! examples are part of a chain's snapshot: they do not depend on threads, blocks or interruptions.

use serde::{Deserialize, Serialize};
use std::fmt;

/// A simulation that failed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Failure {
    /// What failed: a body, by its name.
    pub body: String,
    /// What it did with what, as it failed, as in "king touches rook"; the body alone where there is nothing to say.
    pub doing: String,
    /// When, in s.
    pub time: f64,
    /// Why, in a few words: "not finite".
    pub cause: String,
}

/// Its time is finite.
impl Eq for Failure {}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Three digits after the first that counts, or thousandths.
        let digits = if self.time > 0.0 && self.time < 0.01 { 6 } else { 3 };
        let time = format!("{:.digits$}", self.time);
        let time = if time.contains('.') { time.trim_end_matches('0').trim_end_matches('.') } else { &time };
        write!(f, "{} at {time} s: {}", self.doing, self.cause)
    }
}

/// Failures of one body with one cause.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FailureKind {
    /// How many.
    pub count: u64,
    /// The iteration of the first, and the replica that made it.
    pub since: (u64, u32),
    /// The first.
    pub first: Failure,
}

/// How many simulations there were, and which failed. There are no more kinds than bodies times causes.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Failures {
    /// Draws that were simulated, to the end or until they could no longer be accepted.
    pub simulated: u64,
    /// In order of cause and body.
    kinds: Vec<FailureKind>,
}

impl Failures {
    /// Counts a simulation; `since` is the iteration that made it, and the replica.
    pub fn note(&mut self, since: (u64, u32), failure: Option<Failure>) {
        self.simulated += 1;
        if let Some(first) = failure {
            self.add_kind(FailureKind { count: 1, since, first });
        }
    }

    /// The same, of another replica.
    pub(crate) fn move_to(&mut self, replica: u32) {
        self.kinds.iter_mut().for_each(|kind| kind.since.1 = replica);
    }

    fn add_kind(&mut self, kind: FailureKind) {
        let key = |kind: &FailureKind| (kind.first.cause.clone(), kind.first.body.clone());
        match self.kinds.binary_search_by_key(&key(&kind), key) {
            Err(place) => self.kinds.insert(place, kind),
            Ok(place) => {
                let known = &mut self.kinds[place];
                known.count += kind.count;
                if kind.since < known.since {
                    (known.since, known.first) = (kind.since, kind.first);
                }
            }
        }
    }

    /// Adds others; in which order does not matter.
    pub fn add(&mut self, others: &Self) {
        self.simulated += others.simulated;
        others.kinds.iter().for_each(|kind| self.add_kind(kind.clone()));
    }

    /// How many failed.
    #[must_use]
    pub fn failed(&self) -> u64 {
        self.kinds.iter().map(|kind| kind.count).sum()
    }

    /// What failed, the most frequent first.
    #[must_use]
    pub fn kinds(&self) -> Vec<&FailureKind> {
        let mut kinds: Vec<&FailureKind> = self.kinds.iter().collect();
        kinds.sort_by_key(|kind| std::cmp::Reverse(kind.count));
        kinds
    }
}

/// How many kinds are named.
const SHOWN: usize = 3;

/// One sentence without a full stop, such as "2 of 40 draws failed, and have probability 0: king touches rook at 0.31
/// s: not finite (the first of 2)"; empty if none failed.
impl fmt::Display for Failures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (failed, kinds) = (self.failed(), self.kinds());
        if failed == 0 {
            return Ok(());
        }
        let have = if failed == 1 { "has" } else { "have" };
        write!(f, "{failed} of {} draws failed, and {have} probability 0: ", self.simulated)?;
        for (k, kind) in kinds.iter().take(SHOWN).enumerate() {
            let times = if kind.count > 1 { format!(" (the first of {})", kind.count) } else { String::new() };
            write!(f, "{}{}{times}", if k > 0 { "; " } else { "" }, kind.first)?;
        }
        if kinds.len() > SHOWN { f.write_str("; and others") } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn failure(body: &str, other: &str, time: f64) -> Failure {
        Failure { body: body.into(), doing: format!("{body} touches {other}"), time, cause: "not finite".into() }
    }

    #[test]
    fn the_first_of_each_kind_is_kept_in_whatever_order_counts_are_added() {
        let (mut a, mut b) = (Failures::default(), Failures::default());
        a.note((7, 0), Some(failure("king", "rook", 0.31)));
        a.note((8, 0), None);
        b.note((3, 1), Some(failure("king", "queen", 1.5)));
        b.note((4, 1), Some(failure("pawn", "arm", 0.001_25)));
        let (mut ab, mut ba) = (a.clone(), b.clone());
        ab.add(&b);
        ba.add(&a);
        assert_eq!(ab, ba);
        assert_eq!((ab.simulated, ab.failed()), (4, 3));
        let text = "3 of 4 draws failed, and have probability 0: king touches queen at 1.5 s: not finite (the first \
                    of 2); pawn touches arm at 0.00125 s: not finite";
        assert_eq!(ab.to_string(), text);
        assert_eq!(Failures::default().to_string(), "");
    }
}
