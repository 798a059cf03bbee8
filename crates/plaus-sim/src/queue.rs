//! The event queue: one slot per body, holding its earliest event, under a tournament tree.
//!
//! An event may become stale through a change elsewhere. The partner's generation shows that when the event comes up,
//! and the body is examined again. Nothing is lost: later events of that body were left out only because the stale one
//! came first.

use crate::scenery::Surface;
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;

/// What happens.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Happening {
    /// The run ends, and nothing happens before that.
    End,
    /// The closed form of the motion ends.
    Expiry,
    /// The body touches a surface.
    Surface(Surface),
    /// The body touches another body, which had this generation when the event was found.
    Body {
        /// The other's index.
        other: u32,
        /// Its generation then.
        generation: u32,
    },
}

/// When and what.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Event {
    /// In s.
    pub time: f64,
    /// What happens then.
    pub happening: Happening,
}

/// The order of bodies whose events are due at the same time: by these numbers in turn, then by index. If a kind of
/// bodies sets the numbers from how each body starts, ties do not depend on labels.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Place(pub [f64; 4]);

/// Which of two bodies comes first if times are equal.
fn order(a: u32, b: u32, places: &[Place]) -> Ordering {
    let (p, q) = (places[a as usize].0, places[b as usize].0);
    let by_place = p.iter().zip(&q).map(|(s, t)| s.total_cmp(t)).find(|o| o.is_ne());
    by_place.unwrap_or(Ordering::Equal).then(a.cmp(&b))
}

impl Event {
    /// The bodies involved, in order.
    fn pair(&self, body: u32, places: &[Place]) -> [u32; 2] {
        match self.happening {
            Happening::Body { other, .. } if order(other, body, places).is_lt() => [other, body],
            Happening::Body { other, .. } => [body, other],
            _ => [body, body],
        }
    }

    /// Whether this event of `body` comes before `other` of `rival`: by time, then by the bodies involved, so that ties
    /// never depend on bookkeeping.
    #[inline]
    #[must_use]
    pub(crate) fn precedes(&self, body: u32, other: &Self, rival: u32, places: &[Place]) -> bool {
        self.time < other.time || (self.time == other.time && self.wins_tie(body, other, rival, places))
    }

    #[cold]
    fn wins_tie(&self, body: u32, other: &Self, rival: u32, places: &[Place]) -> bool {
        let ([a, b], [c, d]) = (self.pair(body, places), other.pair(rival, places));
        order(a, c, places).then(order(b, d, places)).is_lt()
    }
}

/// A complete binary tree whose inner nodes name the body with the earlier event.
#[derive(Debug, Clone, Default)]
pub(crate) struct Tournament {
    leaves: usize,
    winners: Vec<u32>,
}

impl Tournament {
    /// Plays all matches anew.
    pub(crate) fn rebuild(&mut self, events: &[Event], places: &[Place]) {
        self.leaves = events.len().next_power_of_two().max(1);
        self.winners.clear();
        self.winners.resize(2 * self.leaves, NOBODY);
        for k in 0..events.len() {
            self.winners[self.leaves + k] = k as u32;
        }
        for node in (1..self.leaves).rev() {
            self.play(node, events, places);
        }
    }

    /// Plays the matches of one body anew.
    #[inline]
    pub(crate) fn update(&mut self, body: usize, events: &[Event], places: &[Place]) {
        let mut node = (self.leaves + body) / 2;
        while node >= 1 {
            self.play(node, events, places);
            node /= 2;
        }
    }

    #[inline]
    fn play(&mut self, node: usize, events: &[Event], places: &[Place]) {
        let (a, b) = (self.winners[2 * node], self.winners[2 * node + 1]);
        let a_wins = b == NOBODY || (a != NOBODY && !events[b as usize].precedes(b, &events[a as usize], a, places));
        self.winners[node] = if a_wins { a } else { b };
    }

    /// The body whose event comes first, if there are bodies.
    #[inline]
    pub(crate) fn first(&self) -> Option<usize> {
        let winner = if self.leaves == 1 { *self.winners.get(1)? } else { self.winners[1] };
        (winner != NOBODY).then_some(winner as usize)
    }
}

const NOBODY: u32 = u32::MAX;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The tree compared with a scan of a plain list, through random updates.
        #[test]
        fn first_is_the_least(
            times in prop::collection::vec(0_u8..6, 1..40),
            updates in prop::collection::vec((0_usize..40, 0_u8..6), 0..60),
        ) {
            let event = |t: u8| Event { time: f64::from(t), happening: Happening::Expiry };
            let mut events: Vec<Event> = times.iter().map(|&t| event(t)).collect();
            let mut tree = Tournament::default();
            let places = vec![Place::default(); events.len()];
            tree.rebuild(&events, &places);
            for (k, t) in updates {
                let k = k % events.len();
                events[k] = event(t);
                tree.update(k, &events, &places);
                let sooner = |&a: &usize, &b: &usize| events[a].time.total_cmp(&events[b].time).then(a.cmp(&b));
                let scanned = (0..events.len()).min_by(sooner);
                prop_assert_eq!(tree.first(), scanned);
            }
        }
    }

    #[test]
    fn nobody_comes_first_in_an_empty_world() {
        let mut tree = Tournament::default();
        tree.rebuild(&[], &[]);
        assert_eq!(tree.first(), None);
    }
}
