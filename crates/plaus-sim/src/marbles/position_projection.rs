//! Puts back centres that overlap what they touch, by the least motion, weighted by mass, that leaves no overlap.
//!
//! This is a linear complementarity problem like that of the impulses, with overlaps in place of approaches, and the
//! same sweeps solve it. It is set up again if surfaces have turned along the way. Motions between balls keep their
//! common centre of mass.

use super::Marbles;
use super::anderson::{Memory, Swept, relax};
use super::solve::{Contact, Member, With};
use glam::DVec3;
use std::ops::ControlFlow;

/// How often, at most, the problem is set up again. Default 8: each time leaves about the square of the previous
/// overlap.
const ROUNDS: usize = 8;

/// Overlaps below this, relative to the radius, need no correction. Default 1e-6.
pub(super) const CORRECTED: f64 = 1e-6;

/// Part of [`CORRECTED`] at which sweeps end.
const FINER: f64 = 0.1;

/// A contact that may overlap.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lift {
    a: usize,
    b: Option<usize>,
    normal: DVec3,
    /// Depth of the overlap in m, negative for a gap.
    missing: f64,
    /// Sum of the inverse masses.
    inverse: f64,
    /// Mass times distance that it has given.
    given: f64,
}

/// Depth of the overlap of a contact, negative for a gap, and the direction in which its first member leaves it.
pub(super) fn overlap(world: &Marbles, members: &[Member], c: &Contact) -> (f64, DVec3) {
    let m = &members[c.a];
    match c.with {
        With::Surface(s) => {
            let projection = world.scenery.project_near(s, m.x);
            (m.ball.radius - projection.distance, projection.normal)
        }
        With::Member(b) => {
            let offset = m.x - members[b].x;
            let distance = offset.length();
            let normal = if distance > 0.0 { offset / distance } else { c.push.last };
            (m.ball.radius + members[b].ball.radius - distance, normal)
        }
    }
}

/// Lifts members until nothing overlaps by more than [`CORRECTED`] of a radius, or sweeps do not converge.
pub(super) fn lift(
    world: &Marbles,
    members: &mut [Member],
    contacts: &[Contact],
    lifts: &mut Vec<Lift>,
    memory: &mut Memory,
) {
    for _ in 0..ROUNDS {
        lifts.clear();
        let mut smallest = f64::INFINITY;
        let mut overlaps = false;
        for c in contacts {
            let (missing, normal) = overlap(world, members, c);
            let m = &members[c.a].ball;
            let (b, other) = match c.with {
                With::Surface(_) => (None, 0.0),
                With::Member(b) => (Some(b), members[b].ball.inverse_mass),
            };
            overlaps |= missing > CORRECTED * m.radius;
            smallest = smallest.min(m.radius);
            lifts.push(Lift { a: c.a, b, normal, missing, inverse: m.inverse_mass + other, given: 0.0 });
        }
        if !overlaps {
            return;
        }
        members.iter_mut().for_each(|m| m.lift = DVec3::ZERO);
        let enough = FINER * CORRECTED * smallest;
        let most = world.accuracy.sweeps;
        relax(&mut Lifts { members, lifts }, memory, most, |_, left| {
            if left <= enough { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        members.iter_mut().for_each(|m| m.x += m.lift);
    }
}

struct Lifts<'g> {
    members: &'g mut [Member],
    lifts: &'g mut [Lift],
}

impl Lifts<'_> {
    /// Lifts the members of one contact out of each other; gives how far they moved.
    fn solve(&mut self, k: usize) -> f64 {
        let l = &self.lifts[k];
        let apart = self.members[l.a].lift - l.b.map_or(DVec3::ZERO, |b| self.members[b].lift);
        let given = (l.given + (l.missing - apart.dot(l.normal)) / l.inverse).max(0.0);
        let more = given - l.given;
        self.lifts[k].given = given;
        self.give(k, more)
    }

    fn give(&mut self, k: usize, more: f64) -> f64 {
        let Lift { a, b, normal, inverse, .. } = self.lifts[k];
        let m = &mut self.members[a];
        m.lift += normal * (more * m.ball.inverse_mass);
        if let Some(b) = b {
            let m = &mut self.members[b];
            m.lift -= normal * (more * m.ball.inverse_mass);
        }
        more.abs() * inverse
    }
}

impl Swept for Lifts<'_> {
    fn sweep(&mut self) -> f64 {
        for k in 0..self.lifts.len() {
            self.solve(k);
        }
        (0..self.lifts.len()).rev().map(|k| self.solve(k)).fold(0.0, f64::max)
    }

    fn read(&self, loads: &mut Vec<f64>) {
        loads.extend(self.lifts.iter().map(|l| l.given));
    }

    fn write(&mut self, loads: &[f64]) {
        self.members.iter_mut().for_each(|m| m.lift = DVec3::ZERO);
        for (k, &given) in loads.iter().enumerate() {
            self.lifts[k].given = given;
            self.give(k, given);
        }
    }
}
