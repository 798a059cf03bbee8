//! The impact of a body on a fixed part, at all points that are struck at once.

use super::simultaneous::{ImpactPoint, resolve_impact};
use crate::mechanics::{Impact, Other};
use crate::rigid::RigidWorld;
use crate::rigid::body_state::{Phase, Pose, RigidBodyState, Velocities};
use crate::rigid::narrow_phase::contact_point::ContactPoint;
use crate::rigid::solver::contact_constraint::{ContactConstraint, SolverBody, response};
use crate::rigid::tolerances::CONTACT_MARGIN;
use crate::scenery::Surface;
use glam::DVec3;

impl RigidWorld {
    /// Impact of a body on a fixed part, at this point and at all others that are struck at once. Returns whether there
    /// was one.
    pub(crate) fn hit_part(
        &self,
        index: usize,
        body: &mut RigidBodyState,
        surface: Surface,
        report: &mut dyn FnMut(&Impact),
    ) -> bool {
        let spec = &self.specs[index];
        let pose = body.pose();
        let mut members = [SolverBody::of(spec, &pose.r, pose.v, pose.w)];
        let mut points = self.points_on_part(index, body, surface, &members[0]);
        if points.is_empty() {
            return false;
        }
        self.scatter(&mut points, &members, index, body);
        resolve_impact(&mut points, &mut members, self.accuracy.slip_turn);
        body.set_motion(spec, Velocities { v: members[0].v, w: members[0].w });
        if !body.flies() {
            body.phase = Phase::Step;
        }
        for p in &points {
            p.report(body.path.t, index, pose.x, report);
        }
        true
    }

    /// The points at which a body strikes or touches a part; none if the first is not struck.
    pub(super) fn points_on_part(
        &self,
        index: usize,
        body: &mut RigidBodyState,
        surface: Surface,
        member: &SolverBody,
    ) -> Vec<ImpactPoint> {
        self.list_touches(index, body);
        let (pose, chattering) = (body.pose(), body.is_chattering());
        let first = self.point_on_part(&self.touch(index, &pose, surface), index, &pose, chattering, member);
        let Some(first) = first.filter(ImpactPoint::is_struck) else { return Vec::new() };
        let mut points = vec![first];
        self.for_known_touches(index, body, &pose, |t| {
            if t.surface != surface {
                points.extend(self.point_on_part(&t, index, &pose, chattering, member));
            }
        });
        points
    }

    pub(super) fn point_on_part(
        &self,
        t: &ContactPoint,
        index: usize,
        pose: &Pose,
        chattering: bool,
        member: &SolverBody,
    ) -> Option<ImpactPoint> {
        let spec = &self.specs[index];
        if t.gap > CONTACT_MARGIN * spec.gap {
            return None;
        }
        let law = self.law_at(index, t, pose.x + t.arm);
        let k = response(member.inverse_mass, &member.inverse_inertia, t.arm);
        let contact = ContactConstraint::new(0, None, [t.arm, DVec3::ZERO], t.normal, law.friction, k);
        let contact = contact.gripping(&law, self.still(index), |_| pose.velocity(t.arm));
        let approach = -pose.velocity(t.arm).dot(t.normal);
        Some(ImpactPoint::new(
            contact,
            approach,
            &law,
            self.settle_speed(spec, &law),
            chattering,
            Other::Surface(self.user_surface(t.surface, pose.x + t.arm)),
        ))
    }
}
