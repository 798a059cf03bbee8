//! How steps of lasting contact differ where cuboids touch each other: in stacks, and for dice that lean or are pushed.
//!
//! A corner that turns against a face that also turns needs shorter steps than a corner on a table, and errors at one
//! body's contacts disturb the next body.

use crate::rigid::RigidWorld;
use crate::rigid::narrow_phase::contact_point::{ContactPoint, PairContactPoint};
use crate::rigid::scratch::RigidScratch;
use crate::rigid::solver::contact_constraint::ContactConstraint;
use crate::rigid::tolerances::{
    DEEPEST_STEP_OVERLAP, GAP_ERROR, KEPT_GAP, MID_STEP_DRIFT, PUSH_OUT_SPEED, STEP_OVERLAP, STEP_OVERLAP_WITH_FACES,
};

/// How deep in each other the bodies of a time-stepped island may end a step, over the gap at which they touch.
pub(super) fn step_overlap_time_stepped(world: &RigidWorld) -> f64 {
    (DEEPEST_STEP_OVERLAP / world.accuracy.gap).clamp(1.0, STEP_OVERLAP_WITH_FACES)
}

impl RigidScratch {
    /// The fraction of a step in which cuboids that touch do not turn far into each other before its end. A straight
    /// drift strays from the curve of a corner by an eighth of what turning adds over the step; this grows as the
    /// square of the step.
    pub(super) fn straightness(&self, world: &RigidWorld, h: f64) -> f64 {
        let mut worst = 0.0_f64;
        for (ab, t) in self.pairs.iter().filter(|p| p.1.id.is_some()) {
            let [p, q] = ab.map(|k| &self.places[k]);
            let [a, b] = [p, q].map(|p| p.drifted(&world.specs[p.body], p.start.v, p.start.w, h).0);
            let both = [p.body, q.body];
            let bend = world.pair_again(both, [&a, &b], t).gap - t.gap - h * t.rate(&p.start, &q.start);
            worst = worst.max(bend.abs() / world.specs[p.body].size.min(world.specs[q.body].size));
        }
        for (k, t) in &self.touches {
            let p = &self.places[*k];
            if t.point().is_none() {
                let there = p.drifted(&world.specs[p.body], p.start.v, p.start.w, h).0;
                let rate = p.start.velocity(t.arm).dot(t.normal);
                let bend = world.touch(p.body, &there, t.surface).gap - t.gap - h * rate;
                worst = worst.max(bend.abs() / world.specs[p.body].size);
            }
        }
        if worst > 4.0 * MID_STEP_DRIFT { (4.0 * MID_STEP_DRIFT / worst).sqrt() } else { 1.0 }
    }

    /// Whether bodies end a step deeper in each other than their goal; the step is then too long for the passes.
    pub(super) fn misses(&self, world: &RigidWorld, h: f64) -> Option<f64> {
        let rough = if self.newton.is_time_stepped { step_overlap_time_stepped(world) } else { 1.0 };
        let deep = |(c, (ab, t)): (&ContactConstraint, &([usize; 2], PairContactPoint))| {
            if c.compliance > 0.0 {
                return false;
            }
            let [p, q] = ab.map(|k| &self.places[k]);
            let both = [p.body, q.body];
            let after = world.pair_again(both, [&p.end, &q.end], t).gap;
            let most = if t.id.is_some() { rough } else { STEP_OVERLAP };
            let goal = world.pair_goal(both, t.gap, h);
            after < goal.min(t.gap + (goal - t.gap) * self.push) - most * world.pair_gap(both)
        };
        let at_ledges = self.is_at_ledges();
        let deep_at_ledge = |(k, t): &(usize, ContactPoint)| {
            let (p, spec) = (&self.places[*k], &world.specs[self.places[*k].body]);
            let rise = self.push * PUSH_OUT_SPEED * world.accuracy.settle * spec.speed * h;
            at_ledges && world.touch(p.body, &p.end, t.surface).gap < (KEPT_GAP * spec.gap).min(t.gap + rise) - spec.gap
        };
        (self.contacts[self.touches.len()..].iter().zip(&self.pairs).any(deep)
            || self.touches.iter().any(deep_at_ledge))
        .then_some(0.5)
    }

    /// Whether bodies touch by their pieces. They come to rest where they are: tidying one up could
    /// push it into another.
    pub(super) fn has_faces_in_touch(&self) -> bool {
        self.pairs.iter().any(|p| p.1.id.is_some())
    }

    /// How large the error at the ends of a step may be where cuboids touch, in m. If it were larger, the correction at
    /// one contact would undo others, and bodies that lean on each other would never come to rest.
    pub(crate) fn fine(&self, world: &RigidWorld) -> f64 {
        let cuboids = self.pairs.iter().filter(|p| p.1.id.is_some());
        let fine = cuboids.map(|(ab, _)| GAP_ERROR * world.pair_gap(ab.map(|k| self.places[k].body)));
        let ledges = self.touches.iter().filter(|(_, t)| t.point().is_none());
        let fine_at_ledges = ledges.map(|(k, _)| GAP_ERROR * world.specs[self.places[*k].body].gap);
        fine.chain(fine_at_ledges).fold(f64::INFINITY, f64::min)
    }

    /// Whether polyhedra touch edges or corners of boxes.
    pub(super) fn is_at_ledges(&self) -> bool {
        self.touches.iter().any(|(_, t)| t.point().is_none())
    }

    /// The least gap of all contacts, over the gap at which bodies touch.
    pub(super) fn least_gap(&self, world: &RigidWorld) -> f64 {
        let fixed = self.touches.iter().map(|(k, t)| t.gap / world.specs[self.places[*k].body].gap);
        let pairs = self.pairs.iter().map(|(ab, t)| t.gap / world.pair_gap(ab.map(|k| self.places[k].body)));
        fixed.chain(pairs).fold(f64::INFINITY, f64::min)
    }
}
