//! Rigid bodies as the event loop sees them, and where they are at any time.

use super::RigidWorld;
use super::body_state::{Phase, RigidBodyState};
use super::island::{step, truncate_step};
use super::scratch::RigidScratch;
use super::static_shape::StaticShape;
use super::tolerances::{CONTACT_MARGIN, LARGE_ISLAND, LEAST_TIME_STEPPED};
use crate::links::Links;
use crate::mechanics::{ContactForce, Impact, Island, Lookahead, Mechanics, Meeting, Other, TimeSteppedIsland};
use crate::scenery::{Aabb, Surface};
use std::cmp::Ordering;

impl Mechanics for RigidWorld {
    type Body = RigidBodyState;
    type Scratch = RigidScratch;
    const WATCHES_LINKED: bool = true;
    const WHOLE: bool = true;
    const LARGE_ISLAND: usize = LARGE_ISLAND;
    const LEAST_TIME_STEPPED: usize = LEAST_TIME_STEPPED;

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
    fn clock(&self, body: &RigidBodyState) -> f64 {
        body.path.t
    }

    #[inline]
    fn expiry(&self, body: &RigidBodyState) -> f64 {
        body.expiry
    }

    #[inline]
    fn is_present(&self, body: &RigidBodyState) -> bool {
        !matches!(body.phase, Phase::Waiting | Phase::Gone)
    }

    #[inline]
    fn is_resting(&self, body: &RigidBodyState) -> bool {
        matches!(body.phase, Phase::Rest | Phase::Gone)
    }

    fn is_finite(&self, body: &RigidBodyState) -> bool {
        body.path.x.is_finite()
            && body.path.v.is_finite()
            && body.turn.is_finite()
            && body.spin.is_finite()
            && !body.expiry.is_nan()
            && !self.parts.iter().any(StaticShape::is_faulty)
    }

    #[inline]
    fn crushed_by(&self, body: &RigidBodyState) -> Option<usize> {
        body.crushed_by.map(|k| k as usize)
    }

    /// By place, then by velocity: what labels say counts only for bodies that are alike in both.
    fn order(&self, [i, j]: [u32; 2], [a, b]: [&RigidBodyState; 2]) -> Ordering {
        let key = |body: &RigidBodyState| {
            let (x, v) = (body.path.x, body.path.v);
            [x.x, x.y, x.z, v.x, v.y, v.z]
        };
        let (p, q) = (key(a), key(b));
        p.iter().zip(&q).map(|(s, t)| s.total_cmp(t)).find(|o| o.is_ne()).unwrap_or(Ordering::Equal).then(i.cmp(&j))
    }

    #[inline]
    fn advance(&self, index: usize, body: &mut RigidBodyState, time: f64) {
        body.advance(&self.specs[index], time);
    }

    #[inline]
    fn bring(
        &self,
        members: &[u32],
        bodies: &mut [RigidBodyState],
        links: &mut Links,
        scratch: &mut RigidScratch,
        time: f64,
    ) {
        truncate_step::truncate_step(self, members, bodies, links, scratch, time);
        for &k in members {
            self.advance(k as usize, &mut bodies[k as usize], time);
        }
    }

    #[inline]
    fn swept(&self, index: usize, body: &RigidBodyState, from: f64, until: f64) -> Aabb {
        let spec = &self.specs[index];
        // Grown a little, so that rounding cannot hide a touching pair.
        body.path.bounds(from - body.path.t, until - body.path.t).grown(spec.bounding_radius * (1.0 + 1e-9) + spec.gap)
    }

    #[inline]
    fn first_surface(&self, index: usize, body: &RigidBodyState, until: f64) -> Option<(f64, Surface)> {
        // In a time-stepped island, what a body touches is part of its step.
        if body.time_step_island == 0 { self.first_touch(index, body, until) } else { None }
    }

    fn first_meeting(&self, pair: [usize; 2], bodies: [&RigidBodyState; 2], from: f64, until: f64) -> Option<f64> {
        if self.ignores(pair, bodies) { None } else { self.first_pair(pair, bodies, [from, until], false) }
    }

    fn first_new_meeting(&self, pair: [usize; 2], bodies: [&RigidBodyState; 2], from: f64, until: f64) -> Option<f64> {
        if self.ignores(pair, bodies) {
            return None;
        }
        // Bodies on a string may be linked without touching.
        let touch = || {
            let [p, q] = [0, 1].map(|k| self.on_its_way(pair[k], bodies[k], from).pose());
            self.may_be_within(pair, [&p, &q], CONTACT_MARGIN * self.pair_gap(pair))
        };
        self.first_pair(pair, bodies, [from, until], !self.is_tied(pair, bodies) || touch())
    }

    fn strikes(&self, pair: [usize; 2], bodies: [&RigidBodyState; 2], linked: bool, time: f64) -> bool {
        self.pair_strikes(pair, bodies, linked, time)
    }

    fn strikes_surfaces(&self, index: usize, body: &mut RigidBodyState, add: &mut dyn FnMut(Surface)) {
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
        bodies: &mut [RigidBodyState],
        links: &mut Links,
        report: &mut dyn FnMut(&Impact),
    ) -> bool {
        self.hit_together(meetings, bodies, links, report)
    }

    fn hit_surface(
        &self,
        index: usize,
        body: &mut RigidBodyState,
        surface: Surface,
        report: &mut dyn FnMut(&Impact),
    ) -> bool {
        match surface {
            Surface::Part { .. } | Surface::Spot { .. } => self.hit_part(index, body, surface, report),
            _ => false,
        }
    }

    fn hit_body(
        &self,
        pair: [usize; 2],
        bodies: [&mut RigidBodyState; 2],
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
        bodies: &mut [RigidBodyState],
        report: &mut dyn FnMut(&Impact),
    ) -> Option<Option<bool>> {
        if self.joints.bonds.is_empty() { None } else { self.hit_articulation(index, other, linked, bodies, report) }
    }

    #[inline]
    fn joined(&self, a: u32, b: Option<u32>, bodies: &[RigidBodyState]) -> Vec<u32> {
        if self.joints.bonds.is_empty() { Vec::new() } else { self.articulation_beside(a, b, bodies) }
    }

    #[inline]
    fn contacts<'b>(&self, body: &'b RigidBodyState) -> &'b [Surface] {
        body.touching()
    }

    fn as_described(&self, body: &RigidBodyState, surface: Surface) -> Surface {
        self.user_surface(surface, body.path.x)
    }

    fn lookahead(&self, members: &[u32], bodies: &[RigidBodyState]) -> Option<Lookahead> {
        self.ahead(members, bodies)
    }

    #[inline]
    fn is_time_stepped(&self, body: &RigidBodyState) -> bool {
        body.time_step_island != 0
    }

    fn may_be_near(&self, pair: [usize; 2], bodies: [&RigidBodyState; 2], time: f64, ahead: &Lookahead) -> bool {
        self.may_be_near_ahead(pair, bodies, time, ahead)
    }

    fn may_touch(&self, pair: [usize; 2], bodies: [&RigidBodyState; 2], ahead: &Lookahead) -> bool {
        self.may_touch_ahead(pair, bodies, ahead)
    }

    fn settle_time_stepped(
        &self,
        island: &TimeSteppedIsland,
        bodies: &mut [RigidBodyState],
        links: &mut Links,
        scratch: &mut RigidScratch,
        report: &mut dyn FnMut(&Impact),
    ) {
        self.settle_in_time_step(island, bodies, links, scratch, report);
    }

    fn settle(&self, members: &[u32], bodies: &mut [RigidBodyState], links: &mut Links, scratch: &mut RigidScratch) {
        step::settle(self, members, bodies, links, scratch);
    }

    fn contact_forces(&self, island: &Island<'_, Self>, work: &mut RigidScratch, each: &mut dyn FnMut(&ContactForce)) {
        self.tell_forces(island, work, each);
    }
}

impl RigidWorld {
    /// Whether two bodies cannot meet now: both are at rest or driven, or they never touch.
    pub(super) fn ignores(&self, pair: [usize; 2], bodies: [&RigidBodyState; 2]) -> bool {
        bodies.iter().all(|b| b.phase == Phase::Rest)
            || pair.iter().all(|&k| self.specs[k].is_driven())
            || bodies[0].shares_time_step_with(bodies[1])
            || self.never_touch(pair, bodies)
    }
}

impl RigidWorld {
    /// Place, orientation and velocities of a body at any time within its current motion. Before its release it is
    /// where it starts.
    #[must_use]
    pub fn at(&self, index: usize, body: &RigidBodyState, time: f64) -> RigidBodyState {
        let mut moved = body.clone();
        let time = if body.phase == Phase::Waiting { time.max(body.path.t) } else { time };
        moved.advance(&self.specs[index], time);
        moved
    }

    /// A body at any time within its current motion, for pictures of it. Like [`RigidWorld::at`], but within a step it
    /// stays on the step's drift, with the drift's velocities. [`RigidWorld::at`] gives the velocities that the body
    /// would have if the step ended then.
    #[must_use]
    pub fn on_its_way(&self, index: usize, body: &RigidBodyState, time: f64) -> RigidBodyState {
        if body.phase != Phase::Step {
            return self.at(index, body, time);
        }
        let mut moved = body.clone();
        (moved.path.x, moved.path.t) = (body.path.after(time - body.path.t), time);
        (moved.turn, moved.spin) = body.stepped(&self.specs[index], time - body.path.t);
        moved
    }
}
