//! Which bodies an event concerns: those in lasting contact with each other, and what a large island may touch soon.

use crate::broad::BoxTree;
use crate::links::{Link, Links};
use crate::mechanics::{Lookahead, Mechanics};
use crate::state::State;

/// Which bodies have been seen since the last wipe.
#[derive(Debug, Default)]
pub(crate) struct Marks {
    epoch: u64,
    seen: Vec<u64>,
}

impl Marks {
    pub(crate) fn wipe(&mut self, bodies: usize) {
        self.epoch += 1;
        self.seen.resize(bodies, 0);
    }

    /// Whether a body has been marked.
    pub(crate) fn has(&self, body: u32) -> bool {
        self.seen[body as usize] == self.epoch
    }

    /// Marks a body; returns whether it was unmarked before.
    pub(crate) fn mark(&mut self, body: u32) -> bool {
        let seen = &mut self.seen[body as usize];
        std::mem::replace(seen, self.epoch) != self.epoch
    }
}

/// Appends the bodies in lasting contact with `seed`, including itself, in ascending order; nothing if it is marked
/// already.
pub(crate) fn add_group(links: &Links, seed: u32, marks: &mut Marks, members: &mut Vec<u32>) {
    let start = members.len();
    let mut next = start;
    if marks.mark(seed) {
        members.push(seed);
    }
    if links.is_empty() {
        return;
    }
    while let Some(&at) = members.get(next) {
        next += 1;
        members.extend(links.of(at).filter(|&other| marks.mark(other)));
    }
    members[start..].sort_unstable();
}

/// What is known of a large island that takes up the bodies near it.
pub(crate) struct Neighbours<'s> {
    pub(crate) concerned: &'s mut Vec<u32>,
    /// The large island, then with its neighbours, in ascending order.
    pub(crate) group: &'s mut Vec<u32>,
    /// Bodies that are concerned.
    pub(crate) marks: &'s mut Marks,
    /// Bodies of the large island and its neighbours.
    pub(crate) stepped: &'s mut Marks,
    /// Pairs that may touch, in ascending order.
    pub(crate) pairs: &'s mut Vec<Link>,
    pub(crate) tree: &'s mut BoxTree,
    pub(crate) near: &'s mut Vec<u32>,
}

impl Neighbours<'_> {
    /// Adds all bodies that the large island may touch within its next step, and lists the pairs.
    pub(crate) fn add<M: Mechanics>(self, mechanics: &M, state: &mut State<M::Body>, ahead: &Lookahead) {
        let Self { concerned, group, marks, stepped, pairs, tree, near } = self;
        let State { bodies, links, boxes, time, .. } = state;
        pairs.clear();
        let mut next = 0;
        while let Some(&k) = group.get(next) {
            next += 1;
            let around = mechanics.swept(k as usize, &bodies[k as usize], *time, *time + ahead.span);
            tree.meeting(boxes, &around.grown(2.0 * ahead.slack + ahead.fall), near);
            for &j in near.iter().filter(|&&j| j != k) {
                if !mechanics.is_present(&bodies[j as usize]) {
                    continue;
                }
                let (pair, is_new) = ([k.min(j), k.max(j)], !stepped.has(j));
                let both = pair.map(|m| &bodies[m as usize]);
                if !mechanics.may_be_near(pair.map(|m| m as usize), both, *time, ahead) {
                    continue;
                }
                let other = is_new.then(|| {
                    let mut other = bodies[j as usize].clone();
                    mechanics.advance(j as usize, &mut other, *time);
                    other
                });
                let of = |m: u32| other.as_ref().filter(|_| m == j).unwrap_or(&bodies[m as usize]);
                if !mechanics.may_touch(pair.map(|m| m as usize), pair.map(of), ahead) {
                    continue;
                }
                pairs.push(pair);
                if is_new {
                    let first = group.len();
                    add_group(links, j, stepped, group);
                    for &m in group[first..].iter().filter(|&&m| marks.mark(m)) {
                        concerned.push(m);
                        mechanics.advance(m as usize, &mut bodies[m as usize], *time);
                    }
                }
            }
        }
        group.sort_unstable();
        pairs.sort_unstable();
        pairs.dedup();
        // Bodies of another large island have their next step already: what comes of them is an event.
        pairs.retain(|pair| pair.iter().all(|k| group.binary_search(k).is_ok()));
    }
}
