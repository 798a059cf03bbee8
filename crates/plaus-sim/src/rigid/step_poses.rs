//! Where a body is at the start and at the end of a step.

use super::BodyDef;
use super::body_state::RigidBodyState;
use super::motion::free_rotation::{LEFT_OUT, drift_within, rotation};
use super::pose::Pose;
use glam::{DMat3, DQuat, DVec3};

/// A member's pose and orientation at the start and at the end of a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StepPoses {
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

impl StepPoses {
    pub(super) fn of(body: &RigidBodyState, index: usize) -> Self {
        let (pose, turn) = (body.pose(), body.turn);
        Self { body: index, start: pose, turn, spin: pose.w, end: pose, end_turn: turn, clock: body.path.t }
    }

    /// Velocities with which a kick of `part` of a step of `h` seconds lets it drift: those of its start with what acts
    /// on it freely, or those with which it is driven.
    pub(super) fn kicked(&self, spec: &BodyDef, h: f64, part: f64) -> (DVec3, DVec3) {
        match &spec.drive {
            Some(drive) => drive.carried(self.clock, h).mean,
            None => spec.kicked(&self.start.r, [self.start.v, self.start.w], part * h),
        }
    }

    /// Velocities after the second half of a step of `h` seconds, but for its contacts.
    pub(super) fn kicked_again(&self, spec: &BodyDef, h: f64) -> (DVec3, DVec3) {
        match &spec.drive {
            Some(drive) => drive.carried(self.clock, h).end,
            None => spec.kicked(&self.end.r, [self.end.v, self.end.w], 0.5 * h),
        }
    }

    /// Pose and orientation after a drift from these velocities: straight, with free rotation.
    pub(super) fn drifted(&self, spec: &BodyDef, v: DVec3, w: DVec3, h: f64) -> (Pose, DQuat) {
        self.drifted_within(spec, [v, w], h, LEFT_OUT)
    }

    /// The same, but for terms of a series of the free rotation below `left_out`.
    pub(super) fn drifted_within(&self, spec: &BodyDef, [v, w]: [DVec3; 2], h: f64, left_out: f64) -> (Pose, DQuat) {
        let (turn, w) = if spec.is_driven() {
            ((rotation(w * h) * self.turn).normalize(), w)
        } else {
            drift_within(&spec.inertia, self.turn, w, h, left_out)
        };
        (Pose { x: self.start.x + v * h, r: DMat3::from_quat(turn), v, w }, turn)
    }

    /// The pose at the start with the velocities of the drift.
    pub(super) fn begin(&self) -> Pose {
        Pose { v: self.end.v, w: self.spin, ..self.start }
    }
}
