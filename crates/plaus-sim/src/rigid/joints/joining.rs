//! The joints of a world: made and checked, held and broken; how far strings are wound, and for how long they may be
//! seen as straight.

use super::axis::{Fault, JointMotor, Motor};
use super::joint::{Frame, Joint, JointConstraint, JointKind, JointRow, JointRowKind, Side, WORLD_POSE};
use super::string::StringJoint;
use crate::error::WorldError;
use crate::rigid::body_state::{Phase, Pose, RigidBodyState};
use crate::rigid::scratch::RigidScratch;
use crate::rigid::tolerances::{MAX_JOINTS, SHORT_STRING, START_OVERLAP};
use crate::rigid::{RigidWorld, not_finite};
use crate::state::State;
use glam::{DMat3, DVec3};

impl RigidWorld {
    /// Adds a joint. Returns its number, for errors.
    ///
    /// # Errors
    /// [`WorldError::BadJoint`] naming the joint and its fault: a body that is not there, the same body twice, no body
    /// that can move, numbers that are not finite, limits with no angle between them, a string or a drum without a
    /// length or radius above 0, or more than 32 joints on a body.
    pub fn join(&mut self, joint: Joint) -> Result<usize, WorldError> {
        let number = self.joints.bonds.len();
        let bad = |field, value, expected| Err(WorldError::BadJoint { joint: number, field, value, expected });
        let bodies = || [joint.body].into_iter().chain(joint.other);
        if let Some(k) = bodies().find(|&k| k >= self.specs.len()) {
            return bad("index of a body", k as f64, "one of the world's bodies");
        }
        if joint.other == Some(joint.body) {
            return bad("the other body", joint.body as f64, "another than the first");
        }
        if bodies().all(|k| self.specs[k].is_driven()) {
            return bad("index of a body", joint.body as f64, "one of two without keyframes");
        }
        if let JointKind::String(string) = &joint.kind
            && let Err((field, value, expected)) = string.check()
        {
            return bad(field, value, expected);
        }
        for frame in &joint.frames {
            if let Some(value) = not_finite(frame.at.to_array()) {
                return bad("anchor", value, "finite numbers");
            }
            let length = frame.turn.length();
            if !(length > 0.0 && length.is_finite()) {
                return bad("length of its axes", length, "finite axes that are not zero");
            }
        }
        match &joint.kind {
            JointKind::Hinge(axis) | JointKind::Slider(axis) => {
                let is_hinge = matches!(joint.kind, JointKind::Hinge(_));
                if let Err((field, value, expected)) = axis.check(is_hinge) {
                    return bad(field, value, expected);
                }
            }
            JointKind::Ball | JointKind::Weld | JointKind::String(_) => {}
        }
        if joint.breaks_at.is_nan() || joint.breaks_at <= 0.0 {
            return bad("impulse that breaks it", joint.breaks_at, "a positive number");
        }
        if let Some(k) = bodies().find(|&k| self.joints.of(k).len() >= MAX_JOINTS) {
            return bad("index of a body", k as f64, "one with fewer than 32 joints");
        }
        let far = bodies().map(|k| self.specs[k].bounding_radius).fold(f64::INFINITY, f64::min);
        let frames = joint.frames.map(|f| Frame { turn: f.turn.normalize(), ..f });
        let axes = frames.map(|f| DMat3::from_quat(f.turn));
        let free = usize::from(self.specs[joint.body].is_driven());
        let middle = axes[free].transpose() * -frames[free].at;
        let triangle = [(1.0, 0.0), (-0.5, SIN_60), (-0.5, -SIN_60)];
        let points = match joint.kind {
            JointKind::Ball => vec![DVec3::ZERO],
            JointKind::String(_) => Vec::new(),
            JointKind::Hinge(_) => vec![DVec3::Z * far, DVec3::NEG_Z * far],
            JointKind::Slider(_) => triangle.map(|(z, x)| middle + DVec3::new(x, 0.0, z) * far).to_vec(),
            JointKind::Weld => triangle.map(|(x, y)| DVec3::new(x, y, 0.0) * far).to_vec(),
        };
        let lever = if matches!(joint.kind, JointKind::Slider(_) | JointKind::String(_)) { 1.0 } else { far };
        let has_drum =
            |k: &&usize| self.joints.bonds[**k].joint.body == joint.body && self.joints.bonds[**k].drum().is_some();
        let drum = self.joints.of(joint.body).iter().filter(has_drum).count();
        self.joints.of.resize(self.specs.len(), Vec::new());
        let bit = 1 << self.joints.of[joint.body].len();
        for k in bodies() {
            self.joints.of[k].push(number);
        }
        self.joints.bonds.push(JointConstraint {
            joint: Joint { frames, ..joint },
            axes,
            lever,
            middle,
            motor: None,
            points,
            bit,
            drum,
        });
        Ok(number)
    }

    /// Gives the hinge or slider with this number a motor.
    ///
    /// # Errors [`WorldError::BadJoint`] naming the joint and its fault: none with this number, another kind of joint,
    /// or numbers of the motor that are not finite or not positive.
    pub fn power(&mut self, joint: usize, motor: &Motor) -> Result<(), WorldError> {
        let bad = |(field, value, expected)| WorldError::BadJoint { joint, field, value, expected };
        let bond = self.joints.bonds.get_mut(joint).filter(|bond| bond.axis().is_some());
        let Some(bond) = bond else { return Err(bad(("number", joint as f64, "that of a hinge or slider"))) };
        bond.motor = Some(JointMotor::new(motor, &self.specs[bond.joint.body]).map_err(bad)?);
        Ok(())
    }

    /// Whether the joint with this number still holds in a state: until it breaks, or one of its bodies is gone.
    #[must_use]
    pub fn is_held(&self, joint: usize, state: &State<RigidBodyState>) -> bool {
        joint < self.joints.bonds.len() && self.holds(joint, &state.bodies)
    }

    /// Whether the joint with this number is broken, by what is known of the body that it was made for.
    #[must_use]
    pub fn is_broken(&self, joint: usize, body: &RigidBodyState) -> bool {
        self.joints.bonds.get(joint).is_some_and(|bond| body.torn & bond.bit != 0)
    }

    /// Whether a joint still holds: until it breaks, or one of its bodies is gone.
    pub(crate) fn holds(&self, joint: usize, bodies: &[RigidBodyState]) -> bool {
        let bond = &self.joints.bonds[joint];
        let own = &bodies[bond.joint.body];
        let is_gone = |k: usize| bodies[k].phase == Phase::Gone;
        own.torn & bond.bit == 0 && !is_gone(bond.joint.body) && !bond.joint.other.is_some_and(is_gone)
    }

    /// Breaks a joint.
    pub(crate) fn tear(&self, joint: usize, bodies: &mut [RigidBodyState]) {
        let bond = &self.joints.bonds[joint];
        bodies[bond.joint.body].torn |= bond.bit;
    }

    /// The joints that hold a body.
    pub(crate) fn bonds_of(&self, body: usize, bodies: &[RigidBodyState]) -> impl Iterator<Item = usize> {
        self.joints.of(body).iter().copied().filter(move |&j| self.holds(j, bodies))
    }

    /// Whether a joint that keeps them from touching holds two bodies to each other: any but a string.
    #[inline]
    pub(crate) fn is_joined(&self, pair: [usize; 2], bodies: [&RigidBodyState; 2]) -> bool {
        self.has_joint(pair, bodies, |bond| bond.string().is_none())
    }

    /// Whether a joint, or a string, holds two bodies to each other: then they move together.
    #[inline]
    pub(crate) fn is_tied(&self, pair: [usize; 2], bodies: [&RigidBodyState; 2]) -> bool {
        self.has_joint(pair, bodies, |_| true)
    }

    #[inline]
    fn has_joint(
        &self,
        [i, j]: [usize; 2],
        [a, b]: [&RigidBodyState; 2],
        counts: impl Fn(&JointConstraint) -> bool,
    ) -> bool {
        self.joints.of(i).iter().any(|&k| {
            let bond = &self.joints.bonds[k];
            let JointConstraint { joint, bit, .. } = bond;
            let own = if joint.body == i { a } else { b };
            (joint.body == j || joint.other == Some(j)) && own.torn & bit == 0 && counts(bond)
        })
    }

    /// Whether the joints fit the bodies at the start.
    pub(crate) fn check_joints(&self, bodies: &[RigidBodyState]) -> Result<(), WorldError> {
        for (number, bond) in self.joints.bonds.iter().enumerate() {
            let bad = |field, value, expected| Err(WorldError::BadJoint { joint: number, field, value, expected });
            let Joint { body, other, kind, .. } = bond.joint;
            let pose = bodies[body].pose();
            let to = other.map_or(WORLD_POSE, |k| bodies[k].pose());
            if let Some(k) = other
                && bodies[k].path.t != bodies[body].path.t
            {
                return bad("start time of its second body", bodies[k].path.t, "that of its first");
            }
            let poses = [&pose, &to];
            if let Err((field, value, expected)) = self.check_string(bond, poses, bodies) {
                return bad(field, value, expected);
            }
            let worst = (0..bond.points.len()).map(|p| bond.point(p, poses).apart.length()).fold(0.0, f64::max);
            // The arms may be long, and their orientations have been rounded.
            let arms = bond.anchors(poses).map(DVec3::length);
            if worst > START_OVERLAP * (self.specs[body].size + arms[0].max(arms[1])) {
                let (field, expected) = if kind == JointKind::Ball {
                    ("distance of its anchors in m at the start", "0")
                } else {
                    ("distance in m of what it holds together, at the start", "0")
                };
                return bad(field, worst, expected);
            }
            if let Some([low, high]) = bond.limits()
                && !(low - START_OVERLAP..=high + START_OVERLAP).contains(&bond.coordinate(poses))
            {
                let field = if bond.slides() { "distance at the start" } else { "angle at the start" };
                return bad(field, bond.coordinate(poses), "one within its limits");
            }
        }
        Ok(())
    }
}

const SIN_60: f64 = 0.866_025_403_784_438_6;

impl StringJoint {
    pub(super) fn check(&self) -> Result<(), Fault> {
        if let Some(drum) = &self.drum {
            if !(drum.radius > 0.0 && drum.radius.is_finite()) {
                return Err(("radius of a drum", drum.radius, "a positive number"));
            }
            if !drum.turned.is_finite() {
                return Err(("angle by which a string is wound", drum.turned, "a finite number"));
            }
        }
        if !(self.length > 0.0 && self.length.is_finite()) {
            return Err(("length of a string", self.length, "a positive number"));
        }
        Ok(())
    }
}

impl RigidWorld {
    /// Whether a joint, if it is a string, is long enough for where its bodies start.
    pub(super) fn check_string(
        &self,
        bond: &JointConstraint,
        poses: [&Pose; 2],
        bodies: &[RigidBodyState],
    ) -> Result<(), Fault> {
        let Some(string) = bond.string() else { return Ok(()) };
        let length = bond.course(bond.turned(&bodies[bond.joint.body]), poses).length;
        if length - string.length > START_OVERLAP * (self.specs[bond.joint.body].size + length) {
            return Err(("distance in m along a string at the start", length, "at most its length"));
        }
        Ok(())
    }

    /// Winds the strings of bodies at their starts: as they were made, or, where bodies start elsewhere, as far as
    /// their lengths allow.
    pub(crate) fn wind_up(&self, bodies: &mut [RigidBodyState]) {
        for bond in &self.joints.bonds {
            let (Some(string), Some(drum)) = (bond.string(), bond.drum()) else { continue };
            let (body, other) = (bodies[bond.joint.body].pose(), bond.joint.other.map(|k| bodies[k].pose()));
            let poses = [&body, other.as_ref().unwrap_or(&WORLD_POSE)];
            let mut turned = bond.course(drum.turned, poses).turned;
            if (turned - drum.turned).abs() > START_OVERLAP {
                let room = START_OVERLAP * self.specs[bond.joint.body].size;
                turned = drum.most_turned(bond.seen_from_drum(poses), string.length + room);
            }
            bodies[bond.joint.body].wound.push(turned);
        }
    }

    /// Notes how far the strings of an island are wound. Each motion turns bodies by less than half a turn.
    pub(crate) fn wind(&self, island: &[u32], bodies: &mut [RigidBodyState]) {
        for &k in island {
            for &j in self.joints.of(k as usize) {
                let bond = &self.joints.bonds[j];
                if bond.joint.body != k as usize || bond.drum().is_none() || !self.holds(j, bodies) {
                    continue;
                }
                let (body, other) = (bodies[k as usize].pose(), bond.joint.other.map(|k| bodies[k].pose()));
                let poses = [&body, other.as_ref().unwrap_or(&WORLD_POSE)];
                let turned = bond.course(bond.turned(&bodies[k as usize]), poses).turned;
                if let Some(wound) = bodies[k as usize].wound.get_mut(bond.drum) {
                    *wound = turned;
                }
            }
        }
    }
}

impl RigidWorld {
    /// The two ends of the free part of a string at a time: on the body that it was made for, and on the other one or
    /// the fixed world. `motion` gives each body's motion at that time. `None` for other joints, or if a body has none.
    #[must_use]
    pub fn free_string<'b>(
        &self,
        joint: usize,
        time: f64,
        motion: impl Fn(usize) -> Option<&'b RigidBodyState>,
    ) -> Option<[DVec3; 2]> {
        let bond = self.joints.bonds.get(joint).filter(|bond| bond.string().is_some())?;
        let own = motion(bond.joint.body)?;
        let at = |k: usize, body: &RigidBodyState| match body.phase {
            Phase::Rest => body.pose(),
            _ => self.on_its_way(k, body, time).pose(),
        };
        let other = match bond.joint.other {
            Some(k) => at(k, motion(k)?),
            None => WORLD_POSE,
        };
        let poses = [&at(bond.joint.body, own), &other];
        let ends = bond.free_part(bond.turned(own), poses);
        Some([0, 1].map(|k| poses[k].x + ends.arms[k]))
    }
}

impl RigidScratch {
    /// Whether there are strings that are not taut.
    pub(crate) fn has_slack_strings(&self) -> bool {
        self.stops.iter().any(|row| matches!(row.part, JointRowKind::Stop(Side::Length { .. })))
    }

    /// The time in which a string, or what swings on one that is taut, turns by a radian; infinite without strings.
    pub(crate) fn string_time(&self, world: &RigidWorld) -> f64 {
        let time = |row: &JointRow, is_taut: bool| {
            let JointRowKind::Stop(Side::Length { near }) = row.part else { return f64::INFINITY };
            let bond = &world.joints.bonds[row.joint];
            let poses = self.start_poses(row);
            let ends = bond.free_part(near, poses);
            let n = ends.normal;
            let [p, a] = [0, 1].map(|k| poses[k].x + ends.arms[k]);
            let free = (a - p).length().max(SHORT_STRING * world.specs[bond.joint.body].size);
            let v = poses[1].velocity(ends.arms[1]) - poses[0].velocity(ends.arms[0]);
            let across = v.reject_from_normalized(n).length();
            if !is_taut {
                return free / across;
            }
            // What the ends would part with if nothing pulled, and by how much they give way to what pulls.
            let (mut parts, mut yields, mut turns) = (across * across / free, 0.0, 0.0_f64);
            for (k, place) in [Some(row.a), row.b].into_iter().enumerate() {
                let Some(spec) = place.map(|place| &world.specs[self.places[place].body]) else { continue };
                let (arm, w) = (ends.arms[k], poses[k].w);
                parts += w.cross(w.cross(arm)).dot(n).abs();
                if !spec.is_driven() {
                    let turn = poses[k].r.transpose() * arm.cross(n);
                    parts += spec.gravity.dot(n).abs();
                    yields += 1.0 / spec.mass + turn.dot(turn / spec.inertia.moments);
                    turns = turns.max(arm.length() / spec.inertia.moments.min_element());
                }
            }
            (free / across).min((yields / (parts * turns)).sqrt())
        };
        let (taut, slack) =
            (self.rows.iter().map(|row| time(row, true)), self.stops.iter().map(|row| time(row, false)));
        taut.chain(slack).fold(f64::INFINITY, f64::min)
    }
}
