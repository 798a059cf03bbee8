//! Shared by the examples that count overlaps: an observer that looks for bodies in each other or in fixed parts.

use plaus_sim::rigid::{Phase, RigidBodyState, RigidWorld};
use plaus_sim::trace::Observer;

/// Examines bodies whenever one begins a new motion, at that time and half way from the last one: not only at the end.
pub(crate) struct Overlaps<'w> {
    world: &'w RigidWorld,
    last: Vec<Option<RigidBodyState>>,
    /// Deepest overlap so far of two bodies, and of a body and a fixed part, in m; below 0 if they only came near.
    pub(crate) deepest: [f64; 2],
    /// The time and the bodies of the first of those two.
    pub(crate) worst: (f64, [usize; 2]),
}

impl<'w> Overlaps<'w> {
    pub(crate) fn new(world: &'w RigidWorld) -> Self {
        let last = (0..world.count()).map(|_| None).collect();
        Self { world, last, deepest: [f64::NEG_INFINITY, 0.0], worst: (0.0, [0; 2]) }
    }

    fn look(&mut self, index: usize, body: &RigidBodyState) {
        let time = body.path.t;
        self.deepest[1] = self.deepest[1].max(self.world.depth(index, body));
        for (other, there) in self.last.iter().enumerate() {
            let Some(there) = there.as_ref().filter(|b| other != index && b.path.t <= time) else { continue };
            let there = self.world.at(other, there, time);
            let pair = [index.min(other), index.max(other)];
            let both = if index < other { [body, &there] } else { [&there, body] };
            let depth = -self.world.gap(pair, both);
            if depth > self.deepest[0] {
                self.deepest[0] = depth;
                self.worst = (time, pair);
            }
        }
    }
}

impl Observer<RigidWorld> for Overlaps<'_> {
    fn motion(&mut self, index: usize, body: &RigidBodyState) {
        if let Some(before) = self.last[index].take() {
            let half = self.world.at(index, &before, 0.5 * (before.path.t + body.path.t));
            self.look(index, &half);
        }
        if matches!(body.phase, Phase::Waiting | Phase::Gone) {
            return;
        }
        self.look(index, body);
        self.last[index] = Some(body.clone());
    }
}
