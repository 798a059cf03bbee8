//! The mutable half of a simulation. It can be cloned or serialised at any pause and resumed to the same bits.

use crate::links::Links;
use crate::mechanics::Mechanics;
use crate::queue::{Event, Happening, Place};
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
    /// New motions of bodies: an event gives one to each member of the groups that it concerns, so this bounds both the
    /// time that a run takes and what a recording of it holds.
    #[serde(default)]
    pub motions: u64,
}

/// Bodies with their motions, lasting contacts between them, and the queue.
#[derive(Debug, Serialize, Deserialize)]
pub struct State<B> {
    /// Time up to which everything has happened.
    pub(crate) time: f64,
    pub(crate) bodies: Vec<B>,
    pub(crate) links: Links,
    pub(crate) events: Vec<Event>,
    pub(crate) generations: Vec<u32>,
    pub(crate) boxes: Vec<Aabb>,
    /// The order of bodies whose events are due at the same time.
    pub(crate) places: Vec<Place>,
    pub(crate) counts: Counts,
    /// Whether the first predictions have been made.
    pub(crate) started: bool,
}

impl<B: Clone> Clone for State<B> {
    fn clone(&self) -> Self {
        Self {
            time: self.time,
            bodies: self.bodies.clone(),
            links: self.links.clone(),
            events: self.events.clone(),
            generations: self.generations.clone(),
            boxes: self.boxes.clone(),
            places: self.places.clone(),
            counts: self.counts,
            started: self.started,
        }
    }

    /// Copies without allocating if there is room: this is how a scene goes back to a saved beginning.
    fn clone_from(&mut self, source: &Self) {
        self.time = source.time;
        self.bodies.clone_from(&source.bodies);
        self.links.clone_from(&source.links);
        self.events.clone_from(&source.events);
        self.generations.clone_from(&source.generations);
        self.boxes.clone_from(&source.boxes);
        self.places.clone_from(&source.places);
        self.counts = source.counts;
        self.started = source.started;
    }
}

impl<B> State<B> {
    /// A state of bodies that have not been examined yet.
    pub(crate) fn new(bodies: Vec<B>) -> Self {
        let places = vec![Place::default(); bodies.len()];
        Self::with_places(bodies, places)
    }

    /// The same with an order for ties.
    pub(crate) fn with_places(bodies: Vec<B>, places: Vec<Place>) -> Self {
        let n = bodies.len();
        Self {
            time: 0.0,
            bodies,
            links: Links::default(),
            events: vec![Event { time: 0.0, happening: Happening::End }; n],
            generations: vec![0; n],
            boxes: vec![Aabb::around([glam::DVec3::ZERO]); n],
            places,
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
    pub fn links(&self) -> &Links {
        &self.links
    }

    /// Work done so far.
    #[must_use]
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Replaces a body that nothing has examined yet, so that no other body's events change.
    pub(crate) fn replace_unreleased(&mut self, index: usize, body: B, place: Place, release: f64) {
        (self.bodies[index], self.places[index]) = (body, place);
        self.events[index] = Event { time: release, happening: Happening::Expiry };
    }

    /// Gives a body a different next event, so that anything found about it by other bodies is examined anew.
    pub(crate) fn interrupt(&mut self, index: usize, event: Event) {
        self.events[index] = event;
        self.generations[index] = self.generations[index].wrapping_add(1);
    }

    /// Whether every body is at rest.
    pub(crate) fn all_resting<M: Mechanics<Body = B>>(&self, mechanics: &M) -> bool {
        self.bodies.iter().all(|b| mechanics.is_resting(b))
    }
}
