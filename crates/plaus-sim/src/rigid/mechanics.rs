//! Turning bodies as the event loop sees them, and where they are at any time.

use super::Rigid;
use super::body::{Phase, Turning};
use super::heap;
use super::land;
use super::part::Part;
use super::scratch::RigidScratch;
use super::step;
use super::tumble::drift;
use crate::links::Links;
use crate::mechanics::{Ahead, ContactForce, Crowd, Impact, Island, Mechanics, Meeting, Other};
use crate::scenery::{Aabb, Surface};

impl Mechanics for Rigid {
    type Body = Turning;
    type Scratch = RigidScratch;
    const WATCHES_LINKED: bool = true;
    const WHOLE: bool = true;
    const HEAP: usize = heap::HEAP;
    const CROWD: usize = heap::CROWD;

    fn len(&self) -> usize {
        self.specs.len()
    }

    fn duration(&self) -> f64 {
        self.duration
    }

    fn event_budget(&self) -> u64 {
        self.accuracy.events * self.specs.len() as u64
    }

    #[inline]
    fn clock(&self, body: &Turning) -> f64 {
        body.path.t
    }

    #[inline]
    fn expiry(&self, body: &Turning) -> f64 {
        body.expiry
    }

    #[inline]
    fn is_present(&self, body: &Turning) -> bool {
        !matches!(body.phase, Phase::Waiting | Phase::Gone)
    }

    #[inline]
    fn is_resting(&self, body: &Turning) -> bool {
        matches!(body.phase, Phase::Rest | Phase::Gone)
    }

    fn is_finite(&self, body: &Turning) -> bool {
        body.path.x.is_finite()
            && body.path.v.is_finite()
            && body.turn.is_finite()
            && body.spin.is_finite()
            && !body.expiry.is_nan()
            && !self.parts.iter().any(Part::is_faulty)
    }

    #[inline]
    fn crushed_by(&self, body: &Turning) -> Option<usize> {
        body.crushed_by.map(|k| k as usize)
    }

    #[inline]
    fn advance(&self, index: usize, body: &mut Turning, time: f64) {
        body.advance(&self.specs[index], time);
    }

    #[inline]
    fn bring(&self, members: &[u32], bodies: &mut [Turning], links: &mut Links, scratch: &mut RigidScratch, time: f64) {
        if !self.joints.bonds.is_empty() {
            land::land(self, members, bodies, links, scratch, time);
        }
        for &k in members {
            self.advance(k as usize, &mut bodies[k as usize], time);
        }
    }

    #[inline]
    fn swept(&self, index: usize, body: &Turning, from: f64, until: f64) -> Aabb {
        let spec = &self.specs[index];
        // Grown a little, so that rounding cannot hide a touching pair.
        body.path.bounds(from - body.path.t, until - body.path.t).grown(spec.reach * (1.0 + 1e-9) + spec.gap)
    }

    #[inline]
    fn first_surface(&self, index: usize, body: &Turning, until: f64) -> Option<(f64, Surface)> {
        // In a crowd, what a body touches is part of its step.
        if body.crowd == 0 { self.first_touch(index, body, until) } else { None }
    }

    fn first_meeting(&self, pair: [usize; 2], bodies: [&Turning; 2], from: f64, until: f64) -> Option<f64> {
        if self.ignores(pair, bodies) {
            return None;
        }
        self.first_pair(pair, bodies, from, until)
    }

    fn first_new_meeting(&self, pair: [usize; 2], bodies: [&Turning; 2], from: f64, until: f64) -> Option<f64> {
        if self.ignores(pair, bodies) { None } else { self.first_new(pair, bodies, from, until) }
    }

    fn strikes(&self, pair: [usize; 2], bodies: [&Turning; 2], linked: bool, time: f64) -> bool {
        self.pair_strikes(pair, bodies, linked, time)
    }

    fn strikes_surfaces(&self, index: usize, body: &mut Turning, add: &mut dyn FnMut(Surface)) {
        if let Some(surface) = self.struck_surface(index, body) {
            add(surface);
        }
    }

    fn gives(&self, index: usize) -> bool {
        !self.specs[index].is_driven()
    }

    fn hit_at_once(
        &self,
        meetings: &[Meeting],
        bodies: &mut [Turning],
        links: &mut Links,
        report: &mut dyn FnMut(&Impact),
    ) -> bool {
        self.hit_together(meetings, bodies, links, report)
    }

    fn hit_surface(&self, index: usize, body: &mut Turning, surface: Surface, report: &mut dyn FnMut(&Impact)) -> bool {
        match surface {
            Surface::Part { .. } | Surface::Spot { .. } => self.hit_part(index, body, surface, report),
            _ => false,
        }
    }

    fn hit_body(
        &self,
        pair: [usize; 2],
        bodies: [&mut Turning; 2],
        linked: bool,
        report: &mut dyn FnMut(&Impact),
    ) -> Option<bool> {
        self.hit_pair(pair, bodies, linked, report)
    }

    #[inline]
    fn hit_joined(
        &self,
        index: usize,
        other: Other,
        linked: bool,
        bodies: &mut [Turning],
        report: &mut dyn FnMut(&Impact),
    ) -> Option<Option<bool>> {
        if self.joints.bonds.is_empty() { None } else { self.hit_cluster(index, other, linked, bodies, report) }
    }

    #[inline]
    fn joined(&self, a: u32, b: Option<u32>, bodies: &[Turning]) -> Vec<u32> {
        if self.joints.bonds.is_empty() { Vec::new() } else { self.cluster_beside(a, b, bodies) }
    }

    #[inline]
    fn contacts<'b>(&self, body: &'b Turning) -> &'b [Surface] {
        body.touching()
    }

    fn crowds(&self, members: &[u32], bodies: &[Turning]) -> Option<Ahead> {
        self.ahead(members, bodies)
    }

    #[inline]
    fn is_crowded(&self, body: &Turning) -> bool {
        body.crowd != 0
    }

    fn may_touch(&self, pair: [usize; 2], bodies: [&Turning; 2], ahead: &Ahead) -> bool {
        self.may_touch_ahead(pair, bodies, ahead)
    }

    fn settle_crowd(
        &self,
        crowd: &Crowd,
        bodies: &mut [Turning],
        links: &mut Links,
        scratch: &mut RigidScratch,
        report: &mut dyn FnMut(&Impact),
    ) {
        self.settle_in_crowd(crowd, bodies, links, scratch, report);
    }

    fn settle(&self, members: &[u32], bodies: &mut [Turning], links: &mut Links, scratch: &mut RigidScratch) {
        step::settle(self, members, bodies, links, scratch);
    }

    fn contact_forces(&self, island: &Island<'_, Self>, work: &mut RigidScratch, each: &mut dyn FnMut(&ContactForce)) {
        self.tell_forces(island, work, each);
    }
}

impl Rigid {
    /// Whether two bodies cannot meet now: both are at rest or driven, or they are joined.
    pub(super) fn ignores(&self, pair: [usize; 2], bodies: [&Turning; 2]) -> bool {
        bodies.iter().all(|b| b.phase == Phase::Rest)
            || pair.iter().all(|&k| self.specs[k].is_driven())
            || bodies[0].is_in_crowd_with(bodies[1])
            || self.is_joined(pair, bodies)
    }
}

impl Rigid {
    /// Place, orientation and velocities of a body at any time within its current motion. Before its release it is
    /// where it starts.
    #[must_use]
    pub fn at(&self, index: usize, body: &Turning, time: f64) -> Turning {
        let mut moved = body.clone();
        let time = if body.phase == Phase::Waiting { time.max(body.path.t) } else { time };
        moved.advance(&self.specs[index], time);
        moved
    }

    /// A body at any time within its current motion, for pictures of it. Like [`Rigid::at`], but within a step it stays
    /// on the step's drift, with the drift's velocities. [`Rigid::at`] gives the velocities that the body would have if
    /// the step ended then.
    #[must_use]
    pub fn on_its_way(&self, index: usize, body: &Turning, time: f64) -> Turning {
        if body.phase != Phase::Step {
            return self.at(index, body, time);
        }
        let mut moved = body.clone();
        (moved.path.x, moved.path.t) = (body.path.after(time - body.path.t), time);
        (moved.turn, moved.spin) = drift(&self.specs[index].inertia, body.turn, body.spin, time - body.path.t);
        moved
    }
}
