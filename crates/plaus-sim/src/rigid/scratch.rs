//! Work space of a group's step: its bodies, the points at which they touch, and the gaps wanted at these points.

use super::body::{Pose, Turning};
use super::brake::Brakes;
use super::coulomb::{Contact, Member, response};
use super::joint::Row;
use super::newton::Newton;
use super::touch::{PairTouch, Touch};
use super::tumble::{drift, rotation};
use super::{Rigid, Spec};
use glam::{DMat3, DQuat, DVec3};

/// Gap that lasting contacts keep, over the gap at which bodies touch. Default 0.75: below 1, so that they go on
/// touching.
pub(super) const KEEP: f64 = 0.75;

/// Gap up to which a point counts as touching, over the gap at which bodies touch: so the gaps that a step leaves are
/// not taken for new impacts. This is the preset's gap.
pub(super) const TOUCHING: f64 = 2.0;

/// Distance from the wanted gap up to which a step needs no correction, over the gap. Default 0.2.
pub(super) const CLOSE: f64 = 0.2;

/// Largest speed at which a point is pushed out of an overlap, over the speed below which bounces last. Default 1. It
/// acts on the drift only, not on the velocities.
pub(super) const PUSH: f64 = 1.0;

/// Least fraction of a step that one shortening leaves.
pub(super) const SHORTEST: f64 = 0.1;

/// Work space of a group's step.
#[derive(Debug, Default)]
pub struct RigidScratch {
    pub(super) members: Vec<Member>,
    pub(super) places: Vec<Place>,
    /// Points on fixed parts.
    pub(super) touches: Vec<(usize, Touch)>,
    /// Forces at those points in the last step.
    pub(super) loads: Vec<Option<DVec3>>,
    /// Points that touch but separate.
    pub(super) leaving: Vec<(usize, Touch)>,
    /// Points between bodies.
    pub(super) pairs: Vec<([usize; 2], PairTouch)>,
    /// Forces on the first of each at those points in the last step.
    pub(super) pair_loads: Vec<Option<DVec3>>,
    /// Points between bodies in lasting contact that touch but separate.
    pub(super) parting: Vec<([usize; 2], PairTouch)>,
    /// Rows of joints.
    pub(super) rows: Vec<Row>,
    /// Limits of joints that are not touched, or are just being left.
    pub(super) stops: Vec<Row>,
    /// Contacts of the touches first, then of the pairs, then of the joints.
    pub(super) contacts: Vec<Contact>,
    /// The same contacts with the impulses of a step's first kick.
    pub(super) firsts: Vec<Contact>,
    /// Fraction of the push out of overlaps that is applied.
    pub(super) push: f64,
    /// Distance that a step may leave between the points that a joint holds together, over the gap.
    pub(super) closed: f64,
    /// Length in s of a step that nothing shortens.
    pub(super) nominal: f64,
    pub(super) newton: Newton,
    pub(super) brakes: Brakes,
    /// Whether the group is a crowd: then points that do not touch yet are listed too.
    pub(super) in_crowd: bool,
    /// Whether nothing moves at the start and the end of a crowd's last step, which nothing interrupted.
    pub(super) stays: bool,
    /// Pairs of a crowd's places that may touch within its step.
    pub(super) near: Vec<[usize; 2]>,
    /// In a crowd: the speed at which each point parts if it is struck, in m/s; 0 for one that lasts.
    pub(super) rebounds: Vec<f64>,
    /// Fraction of these speeds that is applied.
    pub(super) bounce: f64,
    /// The time in s over which the impulses that hold an island at rest act.
    pub(super) kick: f64,
}

/// A member's pose and orientation at the start and at the end of a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) body: usize,
    /// With the velocities before the first kick.
    pub(super) start: Pose,
    pub(super) turn: DQuat,
    /// Angular velocity at the start of the drift.
    pub(super) spin: DVec3,
    /// With the velocities at the end of the drift.
    pub(super) end: Pose,
    pub(super) end_turn: DQuat,
    /// Its clock at the start.
    pub(super) clock: f64,
}

impl Place {
    pub(super) fn of(body: &Turning, index: usize) -> Self {
        let (pose, turn) = (body.pose(), body.turn);
        Self { body: index, start: pose, turn, spin: pose.w, end: pose, end_turn: turn, clock: body.path.t }
    }

    /// Velocities with which a kick of `part` of a step of `h` seconds lets it drift: those of its start with what acts
    /// on it freely, or those with which it is driven.
    pub(super) fn kicked(&self, spec: &Spec, h: f64, part: f64) -> (DVec3, DVec3) {
        match &spec.drive {
            Some(drive) => drive.carried(self.clock, h).mean,
            None => spec.kicked(&self.start.r, [self.start.v, self.start.w], part * h),
        }
    }

    /// Velocities after the second half of a step of `h` seconds, but for its contacts.
    pub(super) fn kicked_again(&self, spec: &Spec, h: f64) -> (DVec3, DVec3) {
        match &spec.drive {
            Some(drive) => drive.carried(self.clock, h).end,
            None => spec.kicked(&self.end.r, [self.end.v, self.end.w], 0.5 * h),
        }
    }

    /// Pose and orientation after a drift from these velocities: straight, with free rotation.
    pub(super) fn drifted(&self, spec: &Spec, v: DVec3, w: DVec3, h: f64) -> (Pose, DQuat) {
        let (turn, w) = if spec.is_driven() {
            ((rotation(w * h) * self.turn).normalize(), w)
        } else {
            drift(&spec.inertia, self.turn, w, h)
        };
        (Pose { x: self.start.x + v * h, r: DMat3::from_quat(turn), v, w }, turn)
    }

    /// The pose at the start with the velocities of the drift.
    pub(super) fn begin(&self) -> Pose {
        Pose { v: self.end.v, w: self.spin, ..self.start }
    }
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
        (self.in_crowd, self.stays) = (false, false);
        self.newton.in_rounds = false;
        self.newton.in_crowd = false;
    }

    pub(super) fn pair_contact(&self, world: &Rigid, ab: [usize; 2], arms: [DVec3; 2], normal: DVec3) -> Contact {
        pair_contact(&self.members, ab, arms, normal, world.pair_law(ab.map(|k| self.places[k].body)).friction)
    }
}

/// A point of contact of two members.
pub(super) fn pair_contact(
    members: &[Member],
    [a, b]: [usize; 2],
    arms: [DVec3; 2],
    normal: DVec3,
    friction: f64,
) -> Contact {
    let (m, n) = (&members[a], &members[b]);
    let k =
        response(m.inverse_mass, &m.inverse_inertia, arms[0]) + response(n.inverse_mass, &n.inverse_inertia, arms[1]);
    Contact::new(a, Some(b), arms, normal, friction, k)
}
