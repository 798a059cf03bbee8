//! Pairs of bodies in lasting contact.

use serde::{Deserialize, Serialize};

/// A pair of bodies in lasting contact, lower index first.
pub(crate) type Link = [u32; 2];

/// The set of links. Kept sorted in both directions, so that the neighbours of a body are one slice.
#[derive(Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Links {
    both_ways: Vec<Link>,
}

impl Clone for Links {
    fn clone(&self) -> Self {
        Self { both_ways: self.both_ways.clone() }
    }

    fn clone_from(&mut self, source: &Self) {
        self.both_ways.clone_from(&source.both_ways);
    }
}

impl Links {
    /// Whether there are none.
    #[inline]
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.both_ways.is_empty()
    }

    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.both_ways.len() / 2
    }

    /// All links in ascending order.
    pub fn iter(&self) -> impl Iterator<Item = Link> + '_ {
        self.both_ways.iter().copied().filter(|[a, b]| a < b)
    }

    /// The bodies linked with `body`, in ascending order.
    #[inline]
    pub fn of(&self, body: u32) -> impl Iterator<Item = u32> + '_ {
        let start = self.both_ways.partition_point(|&[a, _]| a < body);
        self.both_ways[start..].iter().take_while(move |&&[a, _]| a == body).map(|&[_, b]| b)
    }

    /// Whether two bodies are linked.
    #[inline]
    #[must_use]
    pub fn contains(&self, a: u32, b: u32) -> bool {
        !self.is_empty() && self.both_ways.binary_search(&[a, b]).is_ok()
    }

    /// Links two bodies.
    pub fn insert(&mut self, a: u32, b: u32) {
        for link in [[a, b], [b, a]] {
            if let Err(at) = self.both_ways.binary_search(&link) {
                self.both_ways.insert(at, link);
            }
        }
    }

    /// Links all these pairs, lower index first.
    pub(crate) fn add(&mut self, pairs: &[Link]) {
        self.both_ways.extend(pairs.iter().flat_map(|&[a, b]| [[a, b], [b, a]]));
        self.both_ways.sort_unstable();
        self.both_ways.dedup();
    }

    /// Keeps the links for which `keep` returns true; it is called twice for each and must give the same answer.
    pub fn retain(&mut self, mut keep: impl FnMut(Link) -> bool) {
        self.both_ways.retain(|&[a, b]| keep([a.min(b), a.max(b)]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_found_in_both_directions() {
        let mut links = Links::default();
        links.insert(4, 1);
        links.insert(1, 2);
        links.insert(1, 4);
        assert_eq!(links.len(), 2);
        assert_eq!(links.iter().collect::<Vec<_>>(), [[1, 2], [1, 4]]);
        assert_eq!(links.of(1).collect::<Vec<_>>(), [2, 4]);
        assert_eq!(links.of(4).collect::<Vec<_>>(), [1]);
        links.retain(|link| link != [1, 4]);
        assert!(!links.contains(4, 1) && links.contains(2, 1));
    }
}
