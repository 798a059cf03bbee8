//! Bodies that meet only now and then, simulated group by group: first every body alone, then together those that would
//! meet, until no two groups meet.
//!
//! Bodies that never touch do not influence each other, so this equals the simulation of all of them at once, up to
//! rounding. To the last bit, the result is defined by this procedure, which knows nothing of the chain. Some groups
//! need not be simulated again for a candidate: those of the same bodies that, according to the scene, are the same in
//! both draws.

use crate::require::Stop;
use crate::way::{Way, merge};
use plaus_mcmc::ModelError;
use std::sync::Arc;

/// Some bodies simulated by themselves, to the end.
pub(crate) trait Group {
    /// Which bodies, in ascending order.
    fn members(&self) -> &[usize];

    /// The path of each.
    fn ways(&self) -> &[Way];

    /// Whether a body of this group comes nearer than `reach` to one of another group.
    fn meets(&self, other: &Self, reach: f64) -> bool {
        self.ways().iter().any(|way| other.ways().iter().any(|their| way.meets(their, reach).is_some()))
    }

    /// A time before which none does; infinite if they never meet.
    fn apart_until(&self, other: &Self, reach: f64) -> f64 {
        let pairs = self.ways().iter().flat_map(|way| other.ways().iter().map(move |their| way.meets(their, reach)));
        pairs.flatten().fold(f64::INFINITY, f64::min)
    }
}

/// Runs the groups of one draw.
pub(crate) trait Runner<G> {
    /// Simulates some bodies by themselves, to the end; `None` if the draw can no longer be accepted.
    fn run(&mut self, members: Vec<usize>) -> Result<Option<G>, ModelError>;

    /// Whether the beginning rules out the draw: the motions of these groups, before the time that `known` works out.
    fn is_hopeless(&self, groups: &[Arc<G>], known: impl FnOnce() -> f64) -> bool;
}

/// The simulations of one draw.
#[derive(Debug)]
pub(crate) struct Groups<D, G> {
    /// The draw, once there is one.
    pub(crate) draw: Option<D>,
    /// Each body alone.
    alone: Vec<Option<Arc<G>>>,
    /// Groups that were simulated together on the way to the final ones.
    together: Vec<Arc<G>>,
    /// The final groups.
    pub(crate) last: Vec<Arc<G>>,
}

impl<D, G> Default for Groups<D, G> {
    fn default() -> Self {
        Self { draw: None, alone: Vec::new(), together: Vec::new(), last: Vec::new() }
    }
}

impl<D: Clone, G: Group> Groups<D, G> {
    /// Makes these the simulations of `draw`. `present` tells for each body whether it is there. Bodies with centres
    /// nearer than `reach` are simulated together; without `reach`, bodies do not touch. Groups of `known` that are the
    /// `same` in both draws are reused, all others are run by `runner`. Returns whether the draw was simulated to the
    /// end.
    pub(crate) fn simulate(
        &mut self,
        draw: &D,
        present: impl Iterator<Item = bool>,
        reach: Option<f64>,
        (known, same): (&Self, impl Fn(&G) -> bool),
        runner: &mut impl Runner<G>,
    ) -> Result<bool, ModelError> {
        // Only a draw that was simulated to the end is remembered.
        let kept = self.draw.take();
        self.alone.clear();
        self.together.clear();
        self.last.clear();
        for (body, present) in present.enumerate() {
            let group = match known.alone.get(body).and_then(Option::as_ref).filter(|group| same(group)) {
                _ if !present => None,
                Some(group) => Some(Arc::clone(group)),
                None => {
                    let Some(made) = runner.run(vec![body])? else { return Ok(false) };
                    Some(Arc::new(made))
                }
            };
            self.last.extend(group.clone());
            self.alone.push(group);
        }
        if let Some(reach) = reach
            && !self.join(reach, (known, same), runner)?
        {
            return Ok(false);
        }
        self.draw = Some(match kept {
            Some(mut old) => {
                old.clone_from(draw);
                old
            }
            None => draw.clone(),
        });
        Ok(true)
    }

    /// The time before which no two groups meet.
    fn apart_until(&self, reach: f64) -> f64 {
        let others = |(k, group): (usize, &Arc<G>)| {
            self.last[..k].iter().map(|other| group.apart_until(other, reach)).fold(f64::INFINITY, f64::min)
        };
        self.last.iter().enumerate().map(others).fold(f64::INFINITY, f64::min)
    }

    /// Joins groups that meet, until none do. Returns whether the simulation came to that.
    fn join(
        &mut self,
        reach: f64,
        (known, same): (&Self, impl Fn(&G) -> bool),
        runner: &mut impl Runner<G>,
    ) -> Result<bool, ModelError> {
        loop {
            let merged = merge(self.last.len(), |a, b| self.last[a].meets(&self.last[b], reach));
            if merged.len() == self.last.len() {
                return Ok(true);
            }
            if runner.is_hopeless(&self.last, || self.apart_until(reach)) {
                return Ok(false);
            }
            let mut groups = Vec::with_capacity(merged.len());
            for union in merged {
                if let [only] = *union {
                    groups.push(Arc::clone(&self.last[only]));
                    continue;
                }
                let mut members: Vec<usize> =
                    union.iter().flat_map(|&k| self.last[k].members().iter().copied()).collect();
                members.sort_unstable();
                let found = known.together.iter().find(|group| group.members() == members && same(group));
                let group = match found {
                    Some(group) => Arc::clone(group),
                    None => {
                        let Some(made) = runner.run(members)? else { return Ok(false) };
                        Arc::new(made)
                    }
                };
                self.together.push(Arc::clone(&group));
                groups.push(group);
            }
            self.last = groups;
        }
    }
}

/// What a chain remembers: the simulations of its current state, and of the candidate simulated last.
#[derive(Debug)]
pub(crate) struct Memory<D, G> {
    current: Groups<D, G>,
    /// Until the candidate is accepted or rejected.
    pub(crate) candidate: Groups<D, G>,
}

impl<D, G> Default for Memory<D, G> {
    fn default() -> Self {
        Self { current: Groups::default(), candidate: Groups::default() }
    }
}

impl<D: Clone + PartialEq, G: Group> Memory<D, G> {
    /// Keeps what is known about that candidate if it became the current state.
    pub(crate) fn decided(&mut self, accepted: bool) {
        if accepted {
            std::mem::swap(&mut self.current, &mut self.candidate);
        }
    }

    /// Simulates `draw` by a function that gets what is known, fills in what is new, and returns whether it came to the
    /// end; `None` if it did not because of `stop`. `known` is a draw whose simulation can be reused in part; it is
    /// simulated now unless it is remembered.
    pub(crate) fn simulate(
        &mut self,
        (draw, stop): (&D, Option<Stop>),
        known: Option<&D>,
        mut simulate: impl FnMut(&D, &Groups<D, G>, &mut Groups<D, G>, Option<Stop>) -> Result<bool, ModelError>,
    ) -> Result<Option<&Groups<D, G>>, ModelError> {
        let nothing = Groups::default();
        if let Some(known) = known.filter(|known| self.current.draw.as_ref() != Some(*known)) {
            simulate(known, &nothing, &mut self.current, None)?;
        }
        let current = if known.is_some() { &self.current } else { &nothing };
        Ok(simulate(draw, current, &mut self.candidate, stop)?.then_some(&self.candidate))
    }
}
