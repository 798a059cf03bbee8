//! Joints: they hold bodies together, or hold a body to the fixed world.

use super::axis::{AxisJoint, JointMotor, Spring};
use crate::rigid::body_state::Pose;
use crate::rigid::start::Start;
use glam::{DMat3, DQuat, DVec3};
use plaus_dist::math;
use std::f64::consts::{PI, TAU};

/// A joint of two bodies, or of a body and the fixed world. Bodies that a joint holds do not collide with each other.
///
/// Places and directions are given in world axes, at the bodies' starts:
///
/// ```
/// use glam::DVec3;
/// use plaus_sim::rigid::{Joint, Start};
///
/// let [upper, lower] = [1.0, 2.0].map(|depth| Start::at_rest(DVec3::NEG_Z * depth));
/// let nail = Joint::hinge(DVec3::ZERO, DVec3::Y, 0, &upper).with_limits([-1.0, 1.0], 0.3);
/// let elbow = Joint::ball(DVec3::NEG_Z * 1.5, 0, &upper).to(1, &lower);
/// # let _ = (nail, elbow);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// The body that is held.
    pub body: usize,
    /// The body that it is held to; none for the fixed world.
    pub other: Option<usize>,
    /// Where the joint is in the axes of the body, and in the axes of the other body or the fixed world. The two
    /// coincide in all that the joint holds.
    pub frames: [Frame; 2],
    /// What the joint holds.
    pub kind: JointKind,
    /// Impulse in N s, in (0, ∞], above which an impact breaks the joint: the vector sum of the impulses that the joint
    /// transmits, which it still transmits when it breaks. Impulses that contact or gravity build up over time never
    /// break it. Default ∞.
    pub breaks_at: f64,
}

/// Where a joint is in a body's own axes about its centre of gravity; in world axes for the fixed world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// The anchor, in m.
    pub at: DVec3,
    /// Turns the joint's axes into the body's. A hinge turns about their z axis, a slider slides along it.
    pub turn: DQuat,
}

/// What a joint holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JointKind {
    /// The anchors stay together; all rotations are free.
    Ball,
    /// The anchors and the axes stay together.
    Hinge(AxisJoint),
    /// The axes stay on one line, and nothing turns.
    Slider(AxisJoint),
    /// Nothing moves.
    Weld,
}

impl Joint {
    fn new(kind: JointKind, at: DVec3, turn: DQuat, body: usize, start: &Start) -> Self {
        let world = Frame { at, turn };
        Self { body, other: None, frames: [world.seen_by(start), world], kind, breaks_at: f64::INFINITY }
    }

    /// A ball joint that holds a body's point `at` to the fixed world.
    #[must_use]
    pub fn ball(at: DVec3, body: usize, start: &Start) -> Self {
        Self::new(JointKind::Ball, at, DQuat::IDENTITY, body, start)
    }

    /// A hinge about a line through `at` along `axis` that holds a body to the fixed world. `axis` may have any length
    /// but 0.
    #[must_use]
    pub fn hinge(at: DVec3, axis: DVec3, body: usize, start: &Start) -> Self {
        let turn = DQuat::from_rotation_arc(DVec3::Z, axis.normalize());
        Self::new(JointKind::Hinge(AxisJoint::default()), at, turn, body, start)
    }

    /// A slider along a line through `at` in the direction `axis` that holds a body to the fixed world. `axis` may have
    /// any length but 0.
    #[must_use]
    pub fn slider(at: DVec3, axis: DVec3, body: usize, start: &Start) -> Self {
        Self { kind: JointKind::Slider(AxisJoint::default()), ..Self::hinge(at, axis, body, start) }
    }

    /// A weld that holds a body to the fixed world.
    #[must_use]
    pub fn weld(at: DVec3, body: usize, start: &Start) -> Self {
        Self::new(JointKind::Weld, at, DQuat::IDENTITY, body, start)
    }

    /// The same joint, to another body instead of the fixed world.
    #[must_use]
    pub fn to(self, other: usize, start: &Start) -> Self {
        let [own, world] = self.frames;
        Self { other: Some(other), frames: [own, world.seen_by(start)], ..self }
    }

    /// Gives a hinge limits in radians, a slider in m, and a restitution there. Does not change other joints.
    #[must_use]
    pub fn with_limits(self, limits: [f64; 2], restitution: f64) -> Self {
        self.with_axis(|axis| AxisJoint { limits: Some(limits), restitution, ..axis })
    }

    /// Gives a hinge dry friction with a torque in N m, a slider with a force in N. Does not change other joints.
    #[must_use]
    pub fn with_friction(self, friction: f64) -> Self {
        self.with_axis(|axis| AxisJoint { friction, ..axis })
    }

    /// Gives a hinge or a slider a spring. Does not change other joints.
    #[must_use]
    pub fn with_spring(self, spring: Spring) -> Self {
        self.with_axis(|axis| AxisJoint { spring: Some(spring), ..axis })
    }

    /// Makes a joint break at impacts with a larger impulse in N s.
    #[must_use]
    pub fn that_breaks_at(self, breaks_at: f64) -> Self {
        Self { breaks_at, ..self }
    }

    fn with_axis(mut self, change: impl Fn(AxisJoint) -> AxisJoint) -> Self {
        if let JointKind::Hinge(axis) | JointKind::Slider(axis) = &mut self.kind {
            *axis = change(*axis);
        }
        self
    }
}

impl Frame {
    /// The same frame in the axes of a body.
    fn seen_by(&self, start: &Start) -> Self {
        let back = start.orientation.normalize().conjugate();
        Self { at: back * (self.at - start.position), turn: back * self.turn }
    }
}

/// A checked joint.
#[derive(Debug, Clone)]
pub(crate) struct JointConstraint {
    pub(crate) joint: Joint,
    /// The axes of the two frames.
    pub(super) axes: [DMat3; 2],
    /// Distance in m from a hinge's axis at which friction and limits act; 1 for a slider.
    pub(crate) lever: f64,
    /// Where a slider acts, in the axes of the frames: as nothing turns, it may be anywhere, and is at the centre of
    /// gravity of a body, however far away the anchor is.
    pub(super) middle: DVec3,
    pub(crate) motor: Option<JointMotor>,
    /// The points that are held together, in the axes of the frames.
    pub(crate) points: Vec<DVec3>,
    /// Its bit in [`RigidBodyState::torn`] of its first body.
    pub(super) bit: u32,
}

/// The joints of a world.
#[derive(Debug, Clone, Default)]
pub(crate) struct JointConstraints {
    pub(crate) bonds: Vec<JointConstraint>,
    /// The joints of each body; empty if the world has none at all.
    pub(super) of: Vec<Vec<usize>>,
}

impl JointConstraints {
    /// Pairs of bodies that are joined.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = [usize; 2]> {
        self.bonds.iter().filter_map(|b| Some([b.joint.body, b.joint.other?]))
    }

    /// The joints of a body.
    #[inline]
    pub(crate) fn of(&self, body: usize) -> &[usize] {
        self.of.get(body).map_or(&[], Vec::as_slice)
    }
}

/// What a row of a joint holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum JointRowKind {
    /// One of its points.
    Point(usize),
    /// Friction about its axis.
    DryFriction,
    /// A motor.
    Motor,
    /// A spring with its damper.
    Spring,
    /// A limit.
    Stop { is_high: bool },
}

/// A row of a joint between places of an island.
#[derive(Debug, Clone, Copy)]
pub(crate) struct JointRow {
    pub(crate) joint: usize,
    pub(crate) part: JointRowKind,
    pub(crate) a: usize,
    pub(crate) b: Option<usize>,
}

/// Where a row of a joint is: arms from the two centres of gravity to its points, the offset between these points, and
/// the direction, for a row that has only one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct JointAnchors {
    pub(crate) arms: [DVec3; 2],
    pub(crate) apart: DVec3,
    pub(crate) normal: DVec3,
}

/// The fixed world as a body.
pub(crate) const WORLD_POSE: Pose = Pose { x: DVec3::ZERO, r: DMat3::IDENTITY, v: DVec3::ZERO, w: DVec3::ZERO };

impl JointConstraint {
    pub(super) fn anchors(&self, poses: [&Pose; 2]) -> [DVec3; 2] {
        [0, 1].map(|k| poses[k].r * self.joint.frames[k].at)
    }

    /// One of the points that are held together. Those of a slider are held to a line: across its axis, the normal.
    pub(crate) fn point(&self, point: usize, poses: [&Pose; 2]) -> JointAnchors {
        let frames = &self.joint.frames;
        let arms = [0, 1].map(|k| poses[k].r * (frames[k].at + self.axes[k] * self.points[point]));
        let apart = (poses[0].x + arms[0]) - (poses[1].x + arms[1]);
        if !self.slides() {
            return JointAnchors { arms, apart, normal: DVec3::Z };
        }
        let normal = poses[1].r * self.axes[1].z_axis;
        let ahead = normal * apart.dot(normal);
        JointAnchors { arms: [arms[0], arms[1] + ahead], apart: apart - ahead, normal }
    }

    /// The coordinate of a hinge or slider. That of a hinge is the value nearest to the middle of its limits, or else
    /// to its spring's rest.
    pub(crate) fn coordinate(&self, poses: [&Pose; 2]) -> f64 {
        if self.slides() {
            let [a, b] = self.anchors(poses);
            return ((poses[0].x + a) - (poses[1].x + b)).dot(poses[1].r * self.axes[1].z_axis);
        }
        let [a, b] = [0, 1].map(|k| poses[k].r * self.axes[k]);
        let angle = math::atan2(a.x_axis.dot(b.y_axis), a.x_axis.dot(b.x_axis));
        let rest = || self.spring().map_or(0.0, |spring| spring.rest);
        let middle = self.limits().map_or_else(rest, |[low, high]| 0.5 * (low + high));
        if angle > middle + PI {
            angle - TAU
        } else if angle < middle - PI {
            angle + TAU
        } else {
            angle
        }
    }

    /// A point at the lever from a hinge's axis, or a slider's anchor, as a point of both bodies: `normal` is the
    /// direction in which the coordinate grows.
    pub(crate) fn lever(&self, poses: [&Pose; 2]) -> JointAnchors {
        let axes = poses[0].r * self.axes[0];
        let anchor = self.anchors(poses)[0];
        let (arm, normal) = if self.slides() {
            (anchor + axes * self.middle, poses[1].r * self.axes[1].z_axis)
        } else {
            (anchor + axes.x_axis * self.lever, axes.y_axis)
        };
        JointAnchors { arms: [arm, poses[0].x + arm - poses[1].x], apart: DVec3::ZERO, normal }
    }

    pub(super) fn slides(&self) -> bool {
        matches!(self.joint.kind, JointKind::Slider(_))
    }

    pub(super) fn axis(&self) -> Option<&AxisJoint> {
        if let JointKind::Hinge(axis) | JointKind::Slider(axis) = &self.joint.kind { Some(axis) } else { None }
    }

    pub(super) fn spring(&self) -> Option<&Spring> {
        self.axis().and_then(|axis| axis.spring.as_ref())
    }

    pub(crate) fn limits(&self) -> Option<[f64; 2]> {
        self.axis().and_then(|axis| axis.limits)
    }

    /// How far the lever's end is from a limit.
    pub(crate) fn room(&self, is_high: bool, poses: [&Pose; 2]) -> f64 {
        let Some([low, high]) = self.limits() else { return f64::INFINITY };
        let now = self.coordinate(poses);
        self.lever * if is_high { high - now } else { now - low }
    }

    /// How fast the coordinate grows.
    pub(crate) fn rate(&self, poses: [&Pose; 2]) -> f64 {
        if self.slides() {
            let JointAnchors { arms, normal, .. } = self.lever(poses);
            return (poses[0].velocity(arms[0]) - poses[1].velocity(arms[1])).dot(normal);
        }
        (poses[0].w - poses[1].w).dot(poses[0].r * self.axes[0].z_axis)
    }
}
