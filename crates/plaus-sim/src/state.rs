//! The mutable half of a simulation. It can be cloned or serialised at any pause and resumed to the same bits.

use crate::mechanics::{Link, Mechanics};
use crate::queue::{Event, Happening};
use crate::scenery::Aabb;
use serde::{Deserialize, Serialize};

/// How much work a run did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Counts {
    /// Events taken from the queue.
    pub events: u64,
    /// Impacts resolved.
    pub impacts: u64,
    /// Closed forms that ended by themselves, steps of contact groups among them.
    pub expiries: u64,
    /// Stale events.
    pub stale: u64,
}

/// Bodies with their motions, lasting contacts between them, and the queue.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct State<B> {
    /// Time up to which everything has happened.
    pub(crate) time: f64,
    pub(crate) bodies: Vec<B>,
    pub(crate) links: Vec<Link>,
    pub(crate) events: Vec<Event>,
    pub(crate) generations: Vec<u32>,
    pub(crate) boxes: Vec<Aabb>,
    pub(crate) counts: Counts,
    /// Whether the first predictions have been made.
    pub(crate) started: bool,
}

impl<B> State<B> {
    /// A state of bodies that have not been looked at yet.
    pub(crate) fn new(bodies: Vec<B>) -> Self {
        let n = bodies.len();
        Self {
            time: 0.0,
            bodies,
            links: Vec::new(),
            events: vec![Event { time: 0.0, happening: Happening::End }; n],
            generations: vec![0; n],
            boxes: vec![Aabb::EMPTY; n],
            counts: Counts::default(),
            started: false,
        }
    }

    /// Time up to which everything has happened, in s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// The bodies, each at its own clock.
    #[must_use]
    pub fn bodies(&self) -> &[B] {
        &self.bodies
    }

    /// Pairs of bodies in lasting contact.
    #[must_use]
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// Work done so far.
    #[must_use]
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Replaces a body that nothing has looked at yet, so that no other body's events change.
    pub(crate) fn replace_unreleased(&mut self, index: usize, body: B, release: f64) {
        self.bodies[index] = body;
        self.events[index] = Event { time: release, happening: Happening::Expiry };
    }

    /// The group of bodies in lasting contact that `seed` belongs to, in ascending order, appended to `members`.
    pub(crate) fn group(&self, seed: u32, members: &mut Vec<u32>) {
        let start = members.len();
        members.push(seed);
        let mut next = start;
        while next < members.len() {
            let at = members[next];
            next += 1;
            for &[a, b] in &self.links {
                let other = if a == at { b } else if b == at { a } else { continue };
                if !members[start..].contains(&other) {
                    members.push(other);
                }
            }
        }
        members[start..].sort_unstable();
    }

    /// Whether two bodies are in lasting contact.
    #[inline]
    pub(crate) fn are_linked(&self, a: u32, b: u32) -> bool {
        !self.links.is_empty() && self.links.contains(&[a.min(b), a.max(b)])
    }

    /// Whether every body is at rest.
    pub(crate) fn all_resting<M: Mechanics<Body = B>>(&self, mechanics: &M) -> bool {
        self.bodies.iter().all(|b| mechanics.is_resting(b))
    }
}
