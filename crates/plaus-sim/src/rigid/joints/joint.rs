//! Joints: they hold bodies together, or hold a body to the fixed world.

use super::axis::{AxisJoint, JointMotor, Spring};
use super::string::{Course, Drum, StringJoint, Winding};
use crate::rigid::body_state::{Pose, RigidBodyState};
use crate::rigid::pose::Start;
use glam::{DMat3, DQuat, DVec3};
use plaus_dist::math;
use std::f64::consts::{PI, TAU};

/// A joint of two bodies, or of a body and the fixed world. Bodies that a joint holds do not collide with each other,
/// but for those on the two ends of a string.
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
    /// coincide in all that the joint holds; of a string, they are at its two ends.
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
    /// The anchor, in m. Of the drum on which a string is wound, the middle.
    pub at: DVec3,
    /// Turns the joint's axes into the body's. A hinge and a drum turn about their z axis, a slider slides along it.
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
    /// The anchors are no farther apart than a string is long, which may be wound on a drum of the first body.
    String(StringJoint),
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

    /// A string from a body's point `from` to the point `to` of the fixed world, just taut.
    #[must_use]
    pub fn string(from: DVec3, to: DVec3, body: usize, start: &Start) -> Self {
        let string = StringJoint { length: (to - from).length(), drum: None };
        let joint = Self::new(JointKind::String(string), from, DQuat::IDENTITY, body, start);
        Self { frames: [joint.frames[0], Frame { at: to, turn: DQuat::IDENTITY }], ..joint }
    }

    /// A string that is wound on a drum of a body, with its middle at `at`, and goes on to the point `to` of the fixed
    /// world, just taut.
    #[must_use]
    pub fn wound(at: DVec3, to: DVec3, winding: &Winding, body: usize, start: &Start) -> Self {
        let axis = winding.axis.normalize();
        let out =
            (to - at).reject_from_normalized(axis).try_normalize().unwrap_or_else(|| axis.any_orthonormal_vector());
        let seen = DMat3::from_cols(out, axis.cross(out), axis).transpose() * (to - at);
        let (drum, length) = Drum::wound(winding.radius, winding.length, seen);
        let (sin, cos) = math::sin_cos(drum.turned);
        let fastened = out * cos - axis.cross(out) * sin;
        let turn = DQuat::from_mat3(&DMat3::from_cols(fastened, axis.cross(fastened), axis));
        let string = StringJoint { length, drum: Some(drum) };
        let joint = Self::new(JointKind::String(string), at, turn, body, start);
        Self { frames: [joint.frames[0], Frame { at: to, turn: DQuat::IDENTITY }], ..joint }
    }

    /// Gives a string another length in m, what is wound included. Does not change other joints.
    #[must_use]
    pub fn with_length(mut self, length: f64) -> Self {
        if let JointKind::String(string) = &mut self.kind {
            string.length = length;
        }
        self
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
    /// The place of its drum among those of its first body, in [`RigidBodyState::wound`].
    pub(super) drum: usize,
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
    Stop(Side),
}

/// A limit of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Side {
    /// The least coordinate.
    Low,
    /// The largest.
    High,
    /// The length of a string; `near` is about how far it is wound, as [`Drum::turned`].
    Length { near: f64 },
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

    pub(super) fn string(&self) -> Option<&StringJoint> {
        if let JointKind::String(string) = &self.joint.kind { Some(string) } else { None }
    }

    /// The drum on which its string is wound.
    pub(super) fn drum(&self) -> Option<&Drum> {
        self.string().and_then(|string| string.drum.as_ref())
    }

    /// How far its string is wound, as [`Drum::turned`], when the motion of its first body began.
    pub(super) fn turned(&self, body: &RigidBodyState) -> f64 {
        let start = self.drum().map_or(0.0, |drum| drum.turned);
        body.wound.get(self.drum).copied().unwrap_or(start)
    }

    /// Its limits.
    pub(crate) fn sides(&self, bodies: &[RigidBodyState]) -> impl Iterator<Item = Side> + use<> {
        let axis = self.limits().map(|_| [Side::Low, Side::High]);
        let string = self.string().map(|_| Side::Length { near: self.turned(&bodies[self.joint.body]) });
        axis.into_iter().flatten().chain(string)
    }

    /// The other end of a string, from the middle of its drum, in the drum's axes.
    pub(super) fn seen_from_drum(&self, poses: [&Pose; 2]) -> DVec3 {
        let [a, b] = self.anchors(poses);
        (poses[0].r * self.axes[0]).transpose() * ((poses[1].x + b) - (poses[0].x + a))
    }

    /// The course of a string, in the drum's axes and from its middle; without a drum in the body's, from its anchor.
    pub(super) fn course(&self, near: f64, poses: [&Pose; 2]) -> Course {
        let to = self.seen_from_drum(poses);
        match self.drum() {
            Some(drum) => drum.course(to, near),
            None => Course::straight(to),
        }
    }

    /// Where a string pulls, in one line, near the ends of its free part; the direction is from the first body to the
    /// second.
    pub(super) fn free_part(&self, near: f64, poses: [&Pose; 2]) -> JointAnchors {
        let course = self.course(near, poses);
        let (axes, [a, b]) = (poses[0].r * self.axes[0], self.anchors(poses));
        let normal = axes * course.along;
        let end = (poses[1].x + b) - poses[0].x;
        let from = end - normal * (end - a - axes * course.from).dot(normal);
        JointAnchors { arms: [from, b], apart: DVec3::ZERO, normal }
    }

    /// How far the lever's end is from a limit; of a string, how much it is too long.
    pub(crate) fn room(&self, side: Side, poses: [&Pose; 2]) -> f64 {
        if let (Side::Length { near }, Some(string)) = (side, self.string()) {
            let course = self.course(near, poses);
            return (string.length - course.length) / course.gain;
        }
        let Some([low, high]) = self.limits() else { return f64::INFINITY };
        let now = self.coordinate(poses);
        self.lever * if side == Side::High { high - now } else { now - low }
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
