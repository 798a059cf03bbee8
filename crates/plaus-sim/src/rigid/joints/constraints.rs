//! Joints within the steps of lasting contact: rows beside those of contacts, which hold under any load.
//!
//! The impulses of the first kick bring together what a joint holds at the end of the drift, to within [`JOINT_GAP`] or
//! [`ROUGH_JOINT_GAP`] of the gap at which bodies touch, wherever it was before. So nothing drifts apart, however long
//! the run. The impulses of the second kick remove the velocity between the joint's points. This method is RATTLE
//! (Andersen, J. Comput. Phys. 52 (1983)), of second order, and symplectic as long as steps are equal. Both bodies get
//! their impulses at one point, so linear and angular momentum stay constant to rounding. Half way through a step, the
//! points of a joint are apart by the mid-step drift of a curve, `(ω h)²/8` of its arm.
//!
//! A hinge holds two points of its axis, a weld three, a slider three to lines along its axis; their redundant parts
//! share the load. Dry friction is a row of limited size along one direction, at a lever from a hinge's axis, along
//! that of a slider. A limit is a contact without friction there.
//!
//! A motor is a row of limited size too, with a velocity to reach: its mean in the drift, and at the end of the step. A
//! spring acts in both kicks by where the bodies are, as gravity does. A damper is a soft row in the first kick; in
//! the second it has the same impulse again, if that does not turn the motion round. This is the trapezoidal rule, but
//! for a damper that stops all within half a step.

use super::axis::JointMotor;
use super::joint::{JointAnchors, JointConstraint, JointRow, JointRowKind, Side, WORLD_POSE};
use crate::rigid::body_state::{Pose, RigidBodyState};
use crate::rigid::narrow_phase::contact_point::to_middle;
use crate::rigid::scratch::{RigidScratch, StepPoses};
use crate::rigid::solver::contact_constraint::{ConstraintKind, ContactConstraint, SolverBody, response};
use crate::rigid::tolerances::{
    CONTACT_MARGIN, JOINT_GAP, KEPT_GAP, LEAST_SHORTENING, LIMIT_AIMS, LIMIT_GAP, PUSH_OUT_SPEED, ROUGH_JOINT_GAP,
};
use crate::rigid::{BodyDef, RigidWorld};
use glam::{DMat3, DVec3};
use std::f64::consts::TAU;

/// What a step of `h` seconds leaves of the offset between a joint's points. It closes as fast as a fall through it
/// would, without gravity within a step of the usual length: what is in the way is pushed aside no faster.
fn left_apart(gravity_magnitude: f64, apart: DVec3, h: f64, nominal: f64) -> DVec3 {
    let far = apart.length();
    let speed = if gravity_magnitude > 0.0 { (2.0 * gravity_magnitude * far).sqrt() } else { far / nominal };
    if far <= speed * h { DVec3::ZERO } else { apart * (1.0 - speed * h / far) }
}

/// A row of a joint between members, or a member and the fixed world.
pub(crate) fn row_contact(
    members: &[SolverBody],
    row: &JointRow,
    anchors: &JointAnchors,
    hold: ConstraintKind,
) -> ContactConstraint {
    let response = |k: usize, arm: DVec3| response(members[k].inverse_mass, &members[k].inverse_inertia, arm);
    let other = row.b.map_or(DMat3::ZERO, |b| response(b, anchors.arms[1]));
    let k = response(row.a, anchors.arms[0]) + other;
    let mut contact = ContactConstraint::new(row.a, row.b, anchors.arms, anchors.normal, 0.0, k);
    contact.hold = hold;
    contact
}

impl JointConstraint {
    /// Where a row is when its bodies are in these places; both get their impulse at one point.
    pub(crate) fn seat(&self, part: JointRowKind, poses: [&Pose; 2]) -> JointAnchors {
        let anchors = match part {
            JointRowKind::Point(k) => self.point(k, poses),
            JointRowKind::Stop(Side::Length { near }) => return self.free_part(near, poses),
            JointRowKind::Stop(Side::High) => {
                let anchors = self.lever(poses);
                JointAnchors { normal: -anchors.normal, ..anchors }
            }
            _ => self.lever(poses),
        };
        JointAnchors { arms: to_middle(anchors.arms, poses.map(|p| p.x)), ..anchors }
    }

    /// Which impulses a row may have within this many seconds.
    pub(crate) fn hold(&self, part: JointRowKind, time: f64) -> ConstraintKind {
        match part {
            JointRowKind::Point(_) if self.slides() => ConstraintKind::Across,
            JointRowKind::Point(_) => ConstraintKind::Point,
            JointRowKind::DryFriction => {
                ConstraintKind::DryFriction(self.axis().map_or(0.0, |axis| axis.friction) * time / self.lever)
            }
            JointRowKind::Motor => {
                ConstraintKind::DryFriction(self.motor.as_ref().map_or(0.0, |m| m.most) * time / self.lever)
            }
            // Any against its compliance, but nothing without a damper.
            JointRowKind::Spring => {
                let is_damped = self.spring().is_some_and(|spring| spring.damping > 0.0);
                ConstraintKind::DryFriction(if is_damped && time > 0.0 { f64::INFINITY } else { 0.0 })
            }
            JointRowKind::Stop(_) => ConstraintKind::Coulomb,
        }
    }

    /// Velocity that a row gives way by per impulse, if a damper acts there for `time` seconds.
    fn compliance(&self, part: JointRowKind, time: f64) -> f64 {
        match self.spring().filter(|spring| part == JointRowKind::Spring && spring.damping > 0.0 && time > 0.0) {
            Some(spring) => self.lever * self.lever / (spring.damping * time),
            None => 0.0,
        }
    }

    /// What one of its bodies resists with along the coordinate if the anchor is fixed: its mass or moment of inertia.
    fn inertia(&self, k: usize, spec: &BodyDef) -> f64 {
        if self.slides() {
            return spec.mass;
        }
        let axis = self.axes[k].z_axis;
        let arm = self.joint.frames[k].at.cross(axis);
        axis.dot(spec.inertia.moments * axis) + spec.mass * arm.length_squared()
    }

    /// Gives bodies in these places what a joint's spring pulls with within `time` seconds; dampers are left out.
    fn pull(&self, row: &ContactConstraint, members: &mut [SolverBody], poses: [&Pose; 2], time: f64) {
        if let Some(spring) = self.spring() {
            let force = spring.stiffness * (spring.rest - self.coordinate(poses));
            row.push(members, row.normal * (force * time / self.lever));
        }
    }

    /// The difference of two coordinates; of a hinge's, within half a turn.
    fn ahead(&self, to: f64, from: f64) -> f64 {
        let way = to - from;
        if self.slides() { way } else { way - TAU * (way / TAU).round() }
    }

    /// The mean velocity at the lever that a motor seeks within `h` seconds from a time on, at which bodies are in
    /// these places, and the one at the end.
    fn sought(&self, time: f64, h: f64, poses: [&Pose; 2]) -> [f64; 2] {
        let Some(motor) = &self.motor else { return [0.0; 2] };
        let lag = |to: f64| self.ahead(to, self.coordinate(poses));
        motor.rates(time, h, lag).map(|rate| rate * self.lever)
    }

    /// The distance to a limit and its rate of change, at the lever, and the restitution there.
    pub(crate) fn stop(&self, side: Side, poses: [&Pose; 2]) -> (f64, f64, f64) {
        if let Side::Length { near } = side {
            let JointAnchors { arms, normal, .. } = self.free_part(near, poses);
            let rate = (poses[0].velocity(arms[0]) - poses[1].velocity(arms[1])).dot(normal);
            return (self.room(side, poses), rate, 0.0);
        }
        let rate = self.rate(poses) * self.lever;
        let restitution = self.axis().map_or(0.0, |axis| axis.restitution);
        (self.room(side, poses), if side == Side::High { -rate } else { rate }, restitution)
    }

    /// The part of the speed of an approach to a limit that is more than contact can take without an impact: that with
    /// which it would rebound. A string that becomes taut does not rebound, yet it is struck, so that it can break.
    pub(crate) fn struck(&self, rate: f64, restitution: f64) -> f64 {
        -rate * if self.string().is_some() { 1.0 } else { restitution }
    }
}

impl RigidWorld {
    /// Gap at which a limit of a joint is touched.
    pub(crate) fn stop_gap(&self, bond: &JointConstraint) -> f64 {
        self.specs[bond.joint.body].gap
    }

    /// Distance that a step may leave between the points that a joint holds together, over the gap at which its bodies
    /// touch.
    pub(crate) fn joint_gap(&self) -> f64 {
        if self.accuracy.takes_crowd_steps() { ROUGH_JOINT_GAP } else { JOINT_GAP }
    }

    /// Rebound speed at its lever up to which a joint stays at a limit.
    pub(crate) fn stop_settle_speed(&self, bond: &JointConstraint, restitution: f64) -> f64 {
        let settle = (self.accuracy.settle * (1.0 - restitution)).max((2.0 * self.accuracy.gap).sqrt());
        settle * self.specs[bond.joint.body].speed
    }
}

impl RigidScratch {
    /// The poses of a joint's bodies, taken from their places by `pose`.
    fn poses<'p>(&'p self, row: &JointRow, pose: impl Fn(&'p StepPoses) -> &'p Pose) -> [&'p Pose; 2] {
        [pose(&self.places[row.a]), row.b.map_or(&WORLD_POSE, |b| pose(&self.places[b]))]
    }

    /// The poses of a joint's bodies at the start of a step.
    pub(crate) fn start_poses(&self, row: &JointRow) -> [&Pose; 2] {
        self.poses(row, |p| &p.start)
    }

    /// Finds the rows of the joints that hold an island's bodies: all of their points, their dry friction, and the
    /// limits that stay touched. All other limits are put in `stops`.
    pub(crate) fn gather_joints(&mut self, world: &RigidWorld, island: &[u32], bodies: &[RigidBodyState]) {
        let (mut rows, mut stops) = (std::mem::take(&mut self.rows), std::mem::take(&mut self.stops));
        let at = |k: usize| self.places.iter().position(|p| p.body == k);
        for &k in island {
            for j in world.bonds_of(k as usize, bodies) {
                let bond = &world.joints.bonds[j];
                let Some(a) = at(k as usize).filter(|_| bond.joint.body == k as usize) else { continue };
                let row = |part| JointRow { joint: j, part, a, b: bond.joint.other.and_then(at) };
                rows.extend((0..bond.points.len()).map(|k| row(JointRowKind::Point(k))));
                if bond.axis().is_some_and(|axis| axis.friction > 0.0) {
                    rows.push(row(JointRowKind::DryFriction));
                }
                if bond.spring().is_some() {
                    rows.push(row(JointRowKind::Spring));
                }
                if bond.motor.is_some() {
                    rows.push(row(JointRowKind::Motor));
                }
                for side in bond.sides(bodies) {
                    let stop = row(JointRowKind::Stop(side));
                    let (room, rate, e) = bond.stop(side, self.poses(&stop, |p| &p.start));
                    let limit = world.stop_settle_speed(bond, e);
                    let is_met = room <= CONTACT_MARGIN * world.stop_gap(bond);
                    let lasts = is_met && rate <= limit && bond.struck(rate, e) <= limit;
                    if lasts { &mut rows } else { &mut stops }.push(stop);
                }
            }
        }
        (self.rows, self.stops) = (rows, stops);
    }

    /// How large the error at the ends of a step may be where joints hold, in m.
    pub(crate) fn most_apart(&self, world: &RigidWorld) -> f64 {
        let gap = |row: &JointRow| self.closed * world.stop_gap(&world.joints.bonds[row.joint]);
        self.rows.iter().map(gap).fold(f64::INFINITY, f64::min)
    }

    /// Adds the rows of joints to the contacts of members at their starts; dry friction acts for `time` seconds.
    pub(crate) fn prepare_joints(&mut self, world: &RigidWorld, time: f64) {
        for row in &self.rows {
            let bond = &world.joints.bonds[row.joint];
            let anchors = bond.seat(row.part, self.poses(row, |p| &p.start));
            let mut contact = row_contact(&self.members, row, &anchors, bond.hold(row.part, time));
            if row.part == JointRowKind::Spring {
                let poses = self.poses(row, |p| &p.start).map(|p| *p);
                bond.pull(&contact, &mut self.members, [&poses[0], &poses[1]], time);
                contact.soften(bond.compliance(row.part, time));
            }
            contact.target = self.sought(world, row, time)[0];
            self.contacts.push(contact);
        }
    }

    /// Says what each row has to achieve over a drift of `h` seconds that ends at `ends`: its points must meet there.
    /// Returns the largest error, over the allowed one.
    pub(crate) fn aim_joints(
        &mut self,
        world: &RigidWorld,
        h: f64,
        ends: impl Fn(&StepPoses, &SolverBody) -> Pose,
    ) -> f64 {
        let first = self.contacts.len() - self.rows.len();
        let mut worst = 0.0_f64;
        let nominal = self.nominal;
        for (c, row) in self.contacts[first..].iter_mut().zip(&self.rows) {
            let bond = &world.joints.bonds[row.joint];
            let end = |k: usize| ends(&self.places[k], &self.members[k]);
            let ends = [end(row.a), row.b.map_or(WORLD_POSE, end)];
            let ends = [&ends[0], &ends[1]];
            let gap = world.stop_gap(bond);
            match row.part {
                JointRowKind::Point(k) => {
                    let starts = [&self.places[row.a].start, row.b.map_or(&WORLD_POSE, |b| &self.places[b].start)];
                    let left = left_apart(world.gravity_magnitude, bond.point(k, starts).apart, h.abs(), nominal);
                    let apart = bond.point(k, ends).apart - left;
                    if c.compliance == 0.0 {
                        worst = worst.max(apart.length() / (self.closed * gap));
                    }
                    c.bias = apart / h - c.velocity(&self.members);
                }
                JointRowKind::Stop(side) => {
                    let starts = [row.a].into_iter().chain(row.b).map(|k| &self.places[k].start);
                    let mut starts = starts.chain([&WORLD_POSE]);
                    let room = bond.room(side, std::array::from_fn(|_| starts.next().unwrap_or(&WORLD_POSE)));
                    let spec = &world.specs[bond.joint.body];
                    c.target = ((KEPT_GAP * gap - room) / h).min(PUSH_OUT_SPEED * world.accuracy.settle * spec.speed);
                    let left = bond.room(side, ends);
                    if matches!(side, Side::Length { .. }) && c.impulse != DVec3::ZERO {
                        worst = worst.max((room + c.target * h - left).abs() / (self.closed * gap));
                    }
                    let mean = (left - room) / h;
                    c.bias = c.normal * (mean - c.velocity(&self.members).dot(c.normal));
                }
                JointRowKind::Motor => {
                    let start = [&self.places[row.a].start, row.b.map_or(&WORLD_POSE, |b| &self.places[b].start)];
                    c.target = bond.sought(self.places[row.a].clock, h, start)[0];
                    let begin = |k: usize| {
                        let m = &self.members[k];
                        Pose { v: m.v, w: m.w, ..self.places[k].start }
                    };
                    let begin = [begin(row.a), row.b.map_or(WORLD_POSE, begin)];
                    let mean = bond.ahead(bond.coordinate(ends), bond.coordinate(start)) / h;
                    c.bias = c.normal * ((mean - bond.rate([&begin[0], &begin[1]])) * bond.lever);
                }
                JointRowKind::DryFriction | JointRowKind::Spring => {}
            }
        }
        worst
    }

    /// How far the points of a row are apart at the start.
    pub(crate) fn apart(&self, world: &RigidWorld, row: &JointRow) -> f64 {
        let JointRowKind::Point(k) = row.part else { return 0.0 };
        world.joints.bonds[row.joint].point(k, self.poses(row, |p| &p.start)).apart.length()
    }

    /// Shortens a step after whose drift a joint's points are apart by more than the gap at which its bodies touch, or
    /// a taut string is as much too long or, pulling, too short: it is too long for the passes.
    pub(crate) fn tears(&self, world: &RigidWorld, h: f64) -> Option<f64> {
        let first = self.contacts.len() - self.rows.len();
        let is_torn = |(c, row): (&ContactConstraint, &JointRow)| {
            let bond = &world.joints.bonds[row.joint];
            if let JointRowKind::Stop(side @ Side::Length { .. }) = row.part {
                let [start, end] =
                    [self.poses(row, |p| &p.start), self.poses(row, |p| &p.end)].map(|p| bond.room(side, p));
                let missed = start + c.target * h - end;
                return missed > world.stop_gap(bond) || c.impulse != DVec3::ZERO && -missed > world.stop_gap(bond);
            }
            let JointRowKind::Point(k) = row.part else { return false };
            let [start, end] =
                [self.poses(row, |p| &p.start), self.poses(row, |p| &p.end)].map(|p| bond.point(k, p).apart);
            let left = left_apart(world.gravity_magnitude, start, h.abs(), self.nominal);
            c.compliance == 0.0 && (end - left).length() > world.stop_gap(bond)
        };
        self.contacts[first..].iter().zip(&self.rows).any(is_torn).then_some(0.5)
    }

    /// A row of a joint at the end of a drift, and whether it goes on: a limit goes on if it is still touched. `time`
    /// is how long dry friction acts.
    pub(crate) fn row_at_end(&self, world: &RigidWorld, row: &JointRow, time: f64) -> (ContactConstraint, bool) {
        let bond = &world.joints.bonds[row.joint];
        let poses = self.poses(row, |p| &p.end);
        let contact = row_contact(&self.members, row, &bond.seat(row.part, poses), bond.hold(row.part, time));
        let goes_on = match row.part {
            JointRowKind::Stop(side) => bond.room(side, poses) <= CONTACT_MARGIN * world.stop_gap(bond),
            _ => true,
        };
        (contact, goes_on)
    }

    /// The velocities that the motor of a row seeks within `h` seconds: the mean, and the one at the end.
    pub(crate) fn sought(&self, world: &RigidWorld, row: &JointRow, h: f64) -> [f64; 2] {
        if row.part != JointRowKind::Motor || h <= 0.0 {
            return [0.0; 2];
        }
        world.joints.bonds[row.joint].sought(self.places[row.a].clock, h, self.start_poses(row))
    }

    /// The motors of an island, with their clocks.
    pub(crate) fn motors<'s>(&'s self, world: &'s RigidWorld) -> impl Iterator<Item = (&'s JointMotor, f64)> {
        let motors = self.rows.iter().filter(|row| row.part == JointRowKind::Motor);
        motors.filter_map(|row| Some((world.joints.bonds[row.joint].motor.as_ref()?, self.places[row.a].clock)))
    }

    /// What a spring does in the second kick.
    pub(crate) fn pull_at_end(&mut self, world: &RigidWorld, row: &JointRow, contact: &ContactConstraint, time: f64) {
        let poses = self.poses(row, |p| &p.end).map(|p| *p);
        world.joints.bonds[row.joint].pull(contact, &mut self.members, [&poses[0], &poses[1]], time);
    }

    /// A spring's time of oscillation over 2π, as if its anchors were fixed, and half of it as they may recoil; ∞
    /// without springs.
    pub(crate) fn spring_time(&self, world: &RigidWorld) -> f64 {
        let time = |row: &JointRow| {
            let bond = &world.joints.bonds[row.joint];
            let yields = |(k, place): (usize, Option<usize>)| {
                let spec = place.map(|place| &world.specs[self.places[place].body]).filter(|spec| !spec.is_driven());
                spec.map_or(0.0, |spec| 1.0 / bond.inertia(k, spec))
            };
            let yields: f64 = [Some(row.a), row.b].into_iter().enumerate().map(yields).sum();
            0.5 / (bond.spring().map_or(0.0, |spring| spring.stiffness) * yields).sqrt()
        };
        let springs = self.rows.iter().filter(|row| row.part == JointRowKind::Spring);
        springs.map(time).fold(f64::INFINITY, f64::min)
    }

    /// Shortens a step so that it ends at the first limit that it would pass. Within a step, the room is nearly a
    /// parabola in time.
    pub(crate) fn until_stop(&mut self, world: &RigidWorld, mut h: f64) -> f64 {
        if self.stops.is_empty() {
            return h;
        }
        self.closed = world.joint_gap();
        let whole = h;
        for _ in 0..LIMIT_AIMS {
            self.drift(world, h);
            let (mut first, mut back) = (h, None);
            for (k, row) in self.stops.iter().enumerate() {
                let JointRowKind::Stop(side) = row.part else { continue };
                let bond = &world.joints.bonds[row.joint];
                let aim = LIMIT_GAP * world.stop_gap(bond);
                let (room, rate, _) = bond.stop(side, self.poses(row, |p| &p.start));
                let end = bond.room(side, self.poses(row, |p| &p.end));
                if end >= 0.0 {
                    continue;
                }
                let is_touched = room <= CONTACT_MARGIN * world.stop_gap(bond);
                // room + rate t + bend t² reaches the aim, for the last time before the end.
                let (room, bend) = (room - aim, ((end - room) / h - rate) / h);
                let root = (rate * rate - 4.0 * bend * room).max(0.0).sqrt();
                let late = if rate > 0.0 { -(rate + root) / (2.0 * bend) } else { 2.0 * room / (root - rate) };
                let late = if late > 0.0 && late < h { late } else { 0.5 * h };
                if is_touched && late < LEAST_SHORTENING * whole {
                    back = Some(k);
                }
                first = first.min(late);
            }
            if let Some(k) = back {
                // It is just being left, and something presses it back at once: it stays touched.
                let row = self.stops.remove(k);
                self.rows.push(row);
                continue;
            }
            if first == h {
                break;
            }
            h = first;
        }
        h
    }

    /// Notes what the impulses of joints between two bodies add to their angular momenta during the step.
    pub(crate) fn pass_joints(&self, world: &RigidWorld, bodies: &mut [RigidBodyState], h: f64) {
        let first = self.contacts.len() - self.rows.len();
        for ((c, early), row) in self.contacts[first..].iter().zip(&self.firsts[first..]).zip(&self.rows) {
            if let Some(b) = row.b {
                self.pass(world, bodies, [row.a, b], early.impulse + c.impulse, h, f64::INFINITY);
            }
        }
    }
}
