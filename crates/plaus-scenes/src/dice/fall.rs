//! What a simulation of some dice leaves behind.

use super::flight::Trip;
use super::surface::Touched;
use crate::model::groups::Group;
use crate::way::Way;
use plaus_sim::rigid::RigidBodyState;
use plaus_sim::trace::Trace;
use std::sync::Arc;

/// Dice of one group, from their throws to the end.
#[derive(Debug)]
pub(super) struct Fall {
    /// Which dice, in ascending order.
    pub(super) members: Vec<usize>,
    pub(super) trips: Vec<Trip>,
    pub(super) ways: Vec<Way>,
    /// The control points that were looked at: nothing else of the table had any influence.
    pub(super) touched: Touched,
    /// The motions, if they are kept.
    pub(super) recorded: Option<Arc<Recorded>>,
}

impl Group for Fall {
    fn members(&self) -> &[usize] {
        &self.members
    }

    fn ways(&self) -> &[Way] {
        &self.ways
    }
}

/// Dice that were simulated together, with all that happened.
#[derive(Debug)]
pub(super) struct Recorded {
    /// Which dice, in ascending order.
    pub(super) members: Vec<usize>,
    pub(super) trace: Trace<RigidBodyState>,
}

/// Some dice, in ascending order, with what is recorded of them.
pub(super) type Seen<'a> = (&'a [usize], &'a Trace<RigidBodyState>);

impl Recorded {
    /// A run that left the bodies as they are.
    pub(super) fn new(members: Vec<usize>, mut trace: Trace<RigidBodyState>, bodies: Vec<RigidBodyState>) -> Self {
        for (motions, last) in trace.motions.iter_mut().zip(bodies) {
            motions.push(last);
        }
        Self { members, trace }
    }

    pub(super) fn seen(&self) -> Seen<'_> {
        (&self.members, &self.trace)
    }
}
