//! Work space of an island's step: its bodies, the points at which they touch, and the gaps wanted at these points.

use super::RigidWorld;
use super::island::crowd::{Crowd, Strike};
use super::joints::joint::JointRow;
use super::joints::runge_kutta::TreeStep;
use super::narrow_phase::contact_point::{ContactPoint, PairContactPoint};
use super::solver::contact_constraint::{ContactConstraint, SolverBody, pair_contact};
use super::solver::newton::Newton;
use super::solver::rolling_resistance::RollingResistance;
pub(crate) use super::step_poses::StepPoses;
use crate::material::Law;
use glam::DVec3;

/// Work space of an island's step.
#[derive(Debug, Default)]
pub struct RigidScratch {
    pub(super) members: Vec<SolverBody>,
    pub(super) places: Vec<StepPoses>,
    /// Points on fixed parts.
    pub(super) touches: Vec<(usize, ContactPoint)>,
    /// Forces at those points in the last step.
    pub(super) loads: Vec<Option<DVec3>>,
    /// Points that touch but separate.
    pub(super) leaving: Vec<(usize, ContactPoint)>,
    /// Points between bodies.
    pub(super) pairs: Vec<([usize; 2], PairContactPoint)>,
    /// Forces on the first of each at those points in the last step.
    pub(super) pair_loads: Vec<Option<DVec3>>,
    /// Points between bodies in lasting contact that touch but separate.
    pub(super) parting: Vec<([usize; 2], PairContactPoint)>,
    /// Rows of joints.
    pub(super) rows: Vec<JointRow>,
    /// Limits of joints that are not touched, or are just being left.
    pub(super) stops: Vec<JointRow>,
    /// Contacts of the touches first, then of the pairs, then of the joints.
    pub(super) contacts: Vec<ContactConstraint>,
    /// The same contacts with the impulses of a step's first kick.
    pub(super) firsts: Vec<ContactConstraint>,
    /// Fraction of the push out of overlaps that is applied.
    pub(super) push: f64,
    /// Distance that a step may leave between the points that a joint holds together, over the gap.
    pub(super) closed: f64,
    /// Length in s of a step that nothing shortens.
    pub(super) nominal: f64,
    pub(super) newton: Newton,
    /// The trees of joints of an island, in a step.
    pub(super) articulated: TreeStep,
    pub(super) resistance: RollingResistance,
    /// Whether the island is a time-stepped island: then points that do not touch yet are listed too.
    pub(super) is_time_stepped: bool,
    /// Whether nothing moves at the start and the end of a time-stepped island's last step, which nothing interrupted.
    pub(super) stays: bool,
    /// Pairs of a time-stepped island's places that may touch within its step.
    pub(super) near: Vec<[usize; 2]>,
    /// In a time-stepped island: the speed at which each point parts if it is struck, in m/s; 0 for one that lasts.
    pub(super) rebounds: Vec<f64>,
    /// Fraction of these speeds that is applied.
    pub(super) bounce: f64,
    pub(super) crowd: Crowd,
    /// How each point of a crowd was struck in its step, if it was.
    pub(super) strikes: Vec<Option<Strike>>,
    /// Of the touches and of the pairs: whether each is a point of a crowd that is too far to bear in a straight step.
    pub(super) is_far: [Vec<bool>; 2],
    /// The time in s over which the impulses that hold an island at rest act.
    pub(super) kick: f64,
}

impl RigidScratch {
    /// Forgets all contacts.
    pub(super) fn clear(&mut self) {
        self.places.clear();
        self.touches.clear();
        self.loads.clear();
        self.pair_loads.clear();
        self.leaving.clear();
        self.pairs.clear();
        self.parting.clear();
        self.rows.clear();
        self.contacts.clear();
        self.firsts.clear();
        self.stops.clear();
        self.rebounds.clear();
        self.near.clear();
        self.is_far.iter_mut().for_each(Vec::clear);
        (self.is_time_stepped, self.stays) = (false, false);
        self.newton.in_rounds = false;
        self.newton.is_time_stepped = false;
    }

    pub(super) fn pair_contact(
        &self,
        world: &RigidWorld,
        ab: [usize; 2],
        arms: [DVec3; 2],
        normal: DVec3,
    ) -> ContactConstraint {
        pair_contact(&self.members, ab, arms, normal, self.pair_law(world, ab).friction)
    }

    /// The law between two members.
    pub(super) fn pair_law<'w>(&self, world: &'w RigidWorld, ab: [usize; 2]) -> &'w Law {
        world.pair_law(ab.map(|k| self.places[k].body))
    }
}
