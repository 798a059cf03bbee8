//! How steps of lasting contact differ where cuboids touch each other: in piles, and for dice that lean or are pushed.
//!
//! A corner that turns against a face that also turns needs shorter steps than a corner on a table, and errors at one
//! body's contacts disturb the next body.

use super::Rigid;
use super::coulomb::Contact;
use super::scratch::{CLOSE, KEEP, PUSH, RigidScratch};
use super::touch::{PairTouch, Touch};

/// Overlap over the size that cuboids in lasting contact may have half way through a step. Default 1e-3; for smaller
/// values, the cost of fast turning in contact grows as their inverse root.
pub(super) const SAG: f64 = 1e-3;

/// How much deeper than their goal bodies other than cuboids may end a step, over the gap at which they touch. Default
/// 300, which is 40 µm for a pin at the standard preset. With closer limits, steps of pins get shorter and cost half as
/// much again.
const ROUGH: f64 = 300.0;

/// The same for all points in a crowd of bodies with faces, if it is not more than [`DEEPEST`] of the size. Default 30.
const ROUGH_IN_CROWDS: f64 = 30.0;

/// Overlap over the size that a step of a crowd may leave where the preset's gap does not allow more. Default 3e-4.
const DEEPEST: f64 = 3e-4;

/// Distance from the wanted gap up to which a step of a crowd needs no correction, and depth from which on a point that
/// was not part of the step is taken up, both over how deep it may end. Default 1/3: the next step corrects what is
/// left.
pub(super) const CLOSE_IN_CROWDS: f64 = 1.0 / 3.0;

/// How deep in each other the bodies of a crowd may end a step, over the gap at which they touch.
pub(super) fn rough_in_crowds(world: &Rigid) -> f64 {
    (DEEPEST / world.accuracy.gap).clamp(1.0, ROUGH_IN_CROWDS)
}

impl RigidScratch {
    /// The fraction of a step in which cuboids that touch do not turn far into each other before its end. A straight
    /// drift strays from the curve of a corner by an eighth of what turning adds over the step; this grows as the
    /// square of the step.
    pub(super) fn straightness(&self, world: &Rigid, h: f64) -> f64 {
        let mut worst = 0.0_f64;
        for (ab, t) in self.pairs.iter().filter(|p| p.1.spot.is_some()) {
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
        if worst > 4.0 * SAG { (4.0 * SAG / worst).sqrt() } else { 1.0 }
    }

    /// Whether bodies end a step deeper in each other than their goal; the step is then too long for the passes.
    pub(super) fn misses(&self, world: &Rigid, h: f64) -> Option<f64> {
        let rough = if self.newton.in_crowd { rough_in_crowds(world) } else { 1.0 };
        let deep = |(c, (ab, t)): (&Contact, &([usize; 2], PairTouch))| {
            if c.soft > 0.0 {
                return false;
            }
            let [p, q] = ab.map(|k| &self.places[k]);
            let both = [p.body, q.body];
            let after = world.pair_again(both, [&p.end, &q.end], t).gap;
            let most = if t.spot.is_some() { rough } else { ROUGH };
            let goal = world.pair_goal(both, t.gap, h);
            after < goal.min(t.gap + (goal - t.gap) * self.push) - most * world.pair_gap(both)
        };
        let at_ledges = self.is_at_ledges();
        let deep_at_ledge = |(k, t): &(usize, Touch)| {
            let (p, spec) = (&self.places[*k], &world.specs[self.places[*k].body]);
            let rise = self.push * PUSH * world.accuracy.settle * spec.speed * h;
            at_ledges && world.touch(p.body, &p.end, t.surface).gap < (KEEP * spec.gap).min(t.gap + rise) - spec.gap
        };
        (self.contacts[self.touches.len()..].iter().zip(&self.pairs).any(deep)
            || self.touches.iter().any(deep_at_ledge))
        .then_some(0.5)
    }

    /// Whether bodies touch by their pieces. They come to rest where they are: tidying one up could
    /// push it into another.
    pub(super) fn has_faces_in_touch(&self) -> bool {
        self.pairs.iter().any(|p| p.1.spot.is_some())
    }

    /// How large the error at the ends of a step may be where cuboids touch, in m. If it were larger, the correction at
    /// one contact would undo others, and bodies that lean on each other would never come to rest.
    pub(super) fn fine(&self, world: &Rigid) -> f64 {
        let cuboids = self.pairs.iter().filter(|p| p.1.spot.is_some());
        let fine = cuboids.map(|(ab, _)| CLOSE * world.pair_gap(ab.map(|k| self.places[k].body)));
        let ledges = self.touches.iter().filter(|(_, t)| t.point().is_none());
        let fine_at_ledges = ledges.map(|(k, _)| CLOSE * world.specs[self.places[*k].body].gap);
        fine.chain(fine_at_ledges).fold(f64::INFINITY, f64::min)
    }

    /// Whether polyhedra touch edges or corners of boxes.
    pub(super) fn is_at_ledges(&self) -> bool {
        self.touches.iter().any(|(_, t)| t.point().is_none())
    }

    /// The least gap of all contacts, over the gap at which bodies touch.
    pub(super) fn least_gap(&self, world: &Rigid) -> f64 {
        let fixed = self.touches.iter().map(|(k, t)| t.gap / world.specs[self.places[*k].body].gap);
        let pairs = self.pairs.iter().map(|(ab, t)| t.gap / world.pair_gap(ab.map(|k| self.places[k].body)));
        fixed.chain(pairs).fold(f64::INFINITY, f64::min)
    }
}
