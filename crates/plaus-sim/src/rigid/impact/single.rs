//! The impact of two bodies, or of a body on a fixed part, at all points that are struck at once.

use super::simultaneous::{ImpactPoint, resolve_impact};
use crate::mechanics::{Impact, Other};
use crate::rigid::RigidWorld;
use crate::rigid::body_state::{Phase, Pose, RigidBodyState, Velocities};
use crate::rigid::narrow_phase::contact_point::{ContactPoint, to_middle};
use crate::rigid::solver::contact_constraint::{ContactConstraint, SolverBody, pair_contact, response};
use crate::rigid::tolerances::CONTACT_MARGIN;
use crate::scenery::Surface;
use glam::DVec3;

impl RigidWorld {
    /// Impact of two bodies, at all points that are struck at once. Returns whether there was one, and whether their
    /// contact lasts from then on.
    pub(crate) fn hit_pair(
        &self,
        pair: [usize; 2],
        [a, b]: [&mut RigidBodyState; 2],
        linked: bool,
        report: &mut dyn FnMut(&Impact),
    ) -> Option<bool> {
        let [s, t] = pair.map(|k| &self.specs[k]);
        let (time, chattering) = (a.path.t, a.is_chattering() || b.is_chattering());
        let (p, q) = (a.pose(), b.pose());
        let mut members = [SolverBody::of(s, &p.r, p.v, p.w), SolverBody::of(t, &q.r, q.v, q.w)];
        let mut points = self.points_of_pair(pair, [a, b], &members, linked);
        if !points.iter().any(ImpactPoint::is_struck) {
            // They touch without an approach: within a step, where the drift approaches but the momenta no longer do;
            // or again and again, for example where two pairs of points are equally near. Their island has to deal with
            // it.
            let steps = [&*a, &*b].iter().any(|body| matches!(body.phase, Phase::Step | Phase::Articulated));
            let deferred = !linked && (chattering || steps) && !points.is_empty();
            if deferred {
                a.defer_pair(pair[1]);
                self.touch_again(pair, [a, b]);
            }
            return deferred.then_some(true);
        }
        self.scatter(&mut points, &members, pair[0], a);
        resolve_impact(&mut points, &mut members, self.accuracy.slip_turn);
        for ((body, spec), m) in [(&mut *a, s), (&mut *b, t)].into_iter().zip(&members) {
            if !spec.is_driven() {
                body.set_motion(spec, Velocities { v: m.v, w: m.w });
            }
        }
        self.touch_again(pair, [a, b]);
        for point in &points {
            point.report(time, pair[0], p.x, report);
        }
        Some(points.iter().all(|point| point.lasting))
    }

    /// The points at which two bodies touch, as an impact sees them.
    pub(super) fn points_of_pair(
        &self,
        pair: [usize; 2],
        [a, b]: [&RigidBodyState; 2],
        members: &[SolverBody; 2],
        linked: bool,
    ) -> Vec<ImpactPoint> {
        let (p, q, chattering) = (a.pose(), b.pose(), a.is_chattering() || b.is_chattering());
        let law = self.pair_law(pair);
        let (settles, within) = (self.pair_settle_speed(pair), CONTACT_MARGIN * self.pair_gap(pair));
        let mut points = Vec::new();
        self.for_pair_touches(pair, [&p, &q], within, |touch| {
            let contact = pair_contact(members, [0, 1], to_middle(touch.arms, [p.x, q.x]), touch.normal, law.friction);
            let still = pair.map(|k| self.still(k));
            let contact = contact.gripping(law, still[0].min(still[1]), |c| c.velocity(members));
            let point = ImpactPoint::new(contact, -touch.rate(&p, &q), law, settles, chattering, Other::Body(pair[1]));
            // A first contact is struck however slow it is; later, the steps of lasting contact deal with slow ones.
            points.push(ImpactPoint { least: if linked && point.lasting { f64::INFINITY } else { 0.0 }, ..point });
        });
        points
    }

    /// Makes both bodies look anew for what they touch.
    fn touch_again(&self, pair: [usize; 2], bodies: [&mut RigidBodyState; 2]) {
        for (index, body) in pair.into_iter().zip(bodies).filter(|(k, _)| !self.specs[*k].is_driven()) {
            if !body.flies() {
                body.phase = Phase::Step;
            }
            self.list_touches(index, body);
        }
    }
}

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
        let struck = self.touch(index, &pose, surface);
        let first = self.point_on_part(&struck, index, &pose, chattering, member);
        let Some(first) = first.filter(ImpactPoint::is_struck) else { return Vec::new() };
        let mut points = vec![first];
        // Where two triangles meet, one point has a name on each.
        let is_first =
            |t: &ContactPoint| t.surface == surface || t.is_same(struck.arm, struck.normal, self.specs[index].size);
        self.for_known_touches(index, body, &pose, |t| {
            if !is_first(&t) {
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
