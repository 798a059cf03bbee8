//! How draws end: at rest, or why not.

use std::collections::BTreeMap;

/// How a simulation ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ended {
    /// In a few words: "came to rest", "still spinning after 10 s", "fell out of the scene", "out of events".
    pub how: String,
    /// The bodies that caused it, by their names; empty if it came to rest.
    pub bodies: Vec<String>,
}

impl Ended {
    /// What a draw is called in which everything came to rest.
    pub const REST: &str = "came to rest";
    /// How that begins of which something turned on the spot to the end.
    pub const SPINS: &str = "still spinning";

    pub(crate) fn of(how: impl Into<String>, bodies: impl IntoIterator<Item = String>) -> Self {
        Self { how: how.into(), bodies: bodies.into_iter().collect() }
    }
}

/// How many draws ended in which way.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Ends {
    /// Number of draws.
    pub draws: u64,
    /// For each way, how many draws, and in how many of them each body was a cause.
    ways: BTreeMap<String, (u64, BTreeMap<String, u64>)>,
}

impl Ends {
    /// Counts a draw.
    pub fn add(&mut self, Ended { how, bodies }: Ended) {
        self.draws += 1;
        let (count, causes) = self.ways.entry(how).or_default();
        *count += 1;
        bodies.into_iter().for_each(|body| *causes.entry(body).or_default() += 1);
    }

    /// Whether all came to rest, or there were none.
    #[must_use]
    pub fn all_rest(&self) -> bool {
        self.ways.keys().all(|how| how == Ended::REST)
    }

    /// The ways, the most frequent first, each with its number of draws, and with the body that is a cause in more than
    /// half of these, if one is.
    #[must_use]
    pub fn ways(&self) -> Vec<(&str, u64, Option<&str>)> {
        let mut ways: Vec<_> = self
            .ways
            .iter()
            .map(|(how, (count, causes))| {
                let most = causes.iter().max_by_key(|(_, times)| **times).filter(|(_, times)| 2 * **times > *count);
                (how.as_str(), *count, most.map(|(body, _)| body.as_str()))
            })
            .collect();
        ways.sort_by_key(|(_, count, _)| std::cmp::Reverse(*count));
        ways
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_body_is_named_that_is_the_cause_in_most_draws() {
        let mut ends = Ends::default();
        assert!(ends.all_rest());
        for (how, bodies) in [("b", "x y"), ("b", "x"), ("b", "y x"), ("a", "x"), ("a", "y")] {
            ends.add(Ended::of(how, bodies.split(' ').map(str::to_owned)));
        }
        assert_eq!(ends.ways(), [("b", 3, Some("x")), ("a", 2, None)]);
        assert!(ends.draws == 5 && !ends.all_rest());
    }
}
