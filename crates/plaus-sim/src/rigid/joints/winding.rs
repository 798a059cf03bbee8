//! Strings of a world: how far they are wound, and for how long they may be seen as straight.

use super::axis::Fault;
use super::joint::{JointConstraint, JointRow, JointRowKind, Side, WORLD_POSE};
use super::string::StringJoint;
use crate::rigid::RigidWorld;
use crate::rigid::body_state::{Phase, Pose, RigidBodyState};
use crate::rigid::scratch::RigidScratch;
use crate::rigid::tolerances::{SHORT_STRING, START_OVERLAP};
use glam::DVec3;

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
