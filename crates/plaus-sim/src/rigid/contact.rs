//! Which points of a body touch fixed parts, and its impact there.

use super::body::{MOST_TOUCHES, Motion, Phase, Pose, Turning};
use super::coulomb::{Contact, Member, response};
use super::part::{Part, farthest_side};
use super::scratch::{RigidScratch, TOUCHING};
use super::strike::{Point, strike};
use super::touch::{Spot, Touch};
use super::{Rigid, Spec};
use crate::material::Law;
use crate::mechanics::{Impact, Other};
use crate::scenery::Surface;
use crate::shape::Within;
use glam::DVec3;

impl Rigid {
    /// A point of a body, wherever it is.
    #[inline]
    pub(super) fn touch(&self, index: usize, pose: &Pose, surface: Surface) -> Touch {
        let (part, point) = match surface {
            Surface::Part { part, point } => (part, point),
            Surface::Spot { part, piece, point } => {
                return self.spot_touch(index, pose, part, Spot::of_surface(piece, point));
            }
            _ => (0, 0),
        };
        let (spec, part_here, k) = (&self.specs[index], &self.parts[usize::from(part)], usize::from(point));
        if k >= spec.hull
            && let Some(touch) = self.ledge_touch(index, pose, part, point)
        {
            return touch;
        }
        let feeler = match spec.ring_of(k) {
            Some(ring) => {
                let (up, turned) = (part_here.up_at_ring(ring, pose.x, &pose.r), pose.r.transpose());
                spec.ring_point(k, turned * up, turned * up.cross(pose.w)).0
            }
            None => spec.feelers[k],
        };
        let arm = pose.r * feeler.centre;
        let foot = part_here.foot(pose.x + arm, feeler.radius);
        Touch::of_point(part, point, arm - foot.normal * feeler.radius, foot.normal, foot.distance - feeler.radius)
    }

    /// Calls `each` for the points of a body that are within `within` of a part.
    pub(super) fn for_touches(
        &self,
        index: usize,
        pose: &Pose,
        within: impl Into<Within>,
        mut each: impl FnMut(Touch),
    ) {
        let all = within.into();
        let within = all.gap;
        let spec = &self.specs[index];
        for (k, part) in self.parts.iter().enumerate() {
            if self.ground(spec, k).is_some() {
                self.for_spots(index, pose, k, all, &mut each);
                continue;
            }
            let k = k as u16;
            match part {
                Part::Plane(plane) => {
                    let height = plane.distance(pose.x);
                    if height > spec.reach + within {
                        continue;
                    }
                    let lever = pose.r.transpose() * plane.normal;
                    for (point, feeler) in spec.feelers[..spec.hull].iter().enumerate() {
                        let gap = height + lever.dot(feeler.centre) - feeler.radius;
                        if gap <= within {
                            let arm = pose.r * feeler.centre - plane.normal * feeler.radius;
                            each(Touch::of_point(k, point as u16, arm, plane.normal, gap));
                        }
                    }
                    let swing = pose.r.transpose() * plane.normal.cross(pose.w);
                    for point in spec.ring_points() {
                        let (feeler, _) = spec.ring_point(point, lever, swing);
                        let gap = height + lever.dot(feeler.centre) - feeler.radius;
                        if gap <= within {
                            let arm = pose.r * feeler.centre - plane.normal * feeler.radius;
                            each(Touch::of_point(k, point as u16, arm, plane.normal, gap));
                        }
                    }
                }
                Part::Block { bounds, .. } => {
                    if bounds.grown(spec.reach + within).contains(pose.x) {
                        // The box is part of the half space behind a side, so a point that is not near the half space
                        // is not near the box.
                        let side = farthest_side(bounds, pose.x);
                        let (normal, height) = side.map_or((DVec3::ZERO, 0.0), |s| (s.normal, s.beyond));
                        let lever = pose.r.transpose() * normal;
                        for point in (0..spec.hull).chain(spec.ring_points()) {
                            let above = match spec.ring_of(point) {
                                Some(ring) => {
                                    lever.z * ring.height - ring.circle * lever.truncate().length() - ring.radius
                                }
                                None => lever.dot(spec.feelers[point].centre) - spec.feelers[point].radius,
                            };
                            if side.is_some() && height + above > within {
                                continue;
                            }
                            let touch = self.touch(index, pose, Surface::Part { part: k, point: point as u16 });
                            if touch.gap <= within {
                                each(touch);
                            }
                        }
                        self.for_ledge_touches(index, pose, k, all, &mut each);
                    }
                }
                Part::Table(table) => {
                    let (high, x) = (table.height.range()[1] + within, table.place(pose.x));
                    if x.z - spec.reach > high {
                        continue;
                    }
                    let far = spec.reach;
                    let here = table.height.bounds([x.x - far, x.y - far], [x.x + far, x.y + far]);
                    let high = here.map_or(high, |b| b.high + within);
                    let up = pose.r.transpose() * table.up();
                    for (point, feeler) in spec.feelers.iter().enumerate() {
                        if x.z + up.dot(feeler.centre) - feeler.radius <= high {
                            let touch = self.touch(index, pose, Surface::Part { part: k, point: point as u16 });
                            if touch.gap <= within {
                                each(touch);
                            }
                        }
                    }
                }
                Part::Solid(_) | Part::Mesh(_) => {}
            }
        }
    }

    /// Calls `each` for the points of a body that touch: those noted at its clock if all were noted, otherwise those
    /// found now.
    pub(super) fn for_known_touches(&self, index: usize, body: &Turning, pose: &Pose, mut each: impl FnMut(Touch)) {
        let spec = &self.specs[index];
        let noted = body.touching();
        // Which point of a ring is lowest depends on the velocities, and an impact has changed these.
        let moves = |s: &Surface| !spec.is_ball && matches!(s, Surface::Spot { .. });
        if body.listed != body.path.t
            || noted.len() == MOST_TOUCHES
            || !spec.rings.is_empty()
            || noted.iter().any(moves)
        {
            return self.for_touches(index, pose, TOUCHING * spec.gap, each);
        }
        for &surface in noted {
            each(self.touch(index, pose, surface));
        }
    }

    /// The deepest overlap of a body with a part.
    pub(super) fn deepest(&self, index: usize, body: &Turning) -> Option<(u16, f64)> {
        let mut deepest: Option<(u16, f64)> = None;
        self.for_touches(index, &body.pose(), 0.0, |t| {
            if deepest.is_none_or(|(_, depth)| -t.gap > depth) {
                deepest = Some((t.part, -t.gap));
            }
        });
        deepest
    }

    /// The law at a point of contact.
    #[inline]
    pub(super) fn law_at(&self, index: usize, t: &Touch, point: DVec3) -> Law {
        let part = &self.parts[usize::from(t.part)];
        let law = self.laws.of(self.specs[index].material, part.material(t.surface));
        match part {
            Part::Table(table) => table.law(point, law),
            Part::Block { sections, .. } => {
                let here = sections.iter().rev().find(|s| point.y >= s.from);
                Law { friction: here.and_then(|s| s.friction).unwrap_or(law.friction), ..*law }
            }
            _ => *law,
        }
    }

    /// Rebound speed up to which a contact counts as lasting.
    #[inline]
    pub(super) fn settle_speed(&self, spec: &Spec, law: &Law) -> f64 {
        self.slowest_bounce(law) * spec.speed
    }

    /// Rebound speed over `√(g · size)` up to which a contact counts as lasting. A bounce no higher than the gap at
    /// which bodies touch is not counted as one, however elastic.
    #[inline]
    pub(super) fn slowest_bounce(&self, law: &Law) -> f64 {
        (self.accuracy.settle * (1.0 - law.restitution)).max((2.0 * self.accuracy.gap).sqrt())
    }

    /// Notes which points touch, once for each time.
    pub(super) fn list_touches(&self, index: usize, body: &mut Turning) {
        if body.listed == body.path.t {
            return;
        }
        let spec = &self.specs[index];
        let mut found = [const { Surface::Part { part: 0, point: 0 } }; MOST_TOUCHES];
        let mut count = 0;
        self.for_touches(index, &body.pose(), TOUCHING * spec.gap, |t| {
            if count < found.len() {
                found[count] = t.surface;
                count += 1;
            }
        });
        body.list(found[..count].iter().copied());
        body.listed = body.path.t;
    }

    /// Impact of a body on a fixed part, at this point and at all others that are struck at once. Returns whether there
    /// was one.
    pub(super) fn hit_part(
        &self,
        index: usize,
        body: &mut Turning,
        surface: Surface,
        report: &mut dyn FnMut(&Impact),
    ) -> bool {
        let spec = &self.specs[index];
        let pose = body.pose();
        let mut members = [RigidScratch::member(spec, &pose.r, pose.v, pose.w)];
        let mut points = self.points_on_part(index, body, surface, &members[0]);
        if points.is_empty() {
            return false;
        }
        strike(&mut points, &mut members, self.accuracy.slip_turn);
        body.set_motion(spec, Motion { v: members[0].v, w: members[0].w });
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
        body: &mut Turning,
        surface: Surface,
        member: &Member,
    ) -> Vec<Point> {
        self.list_touches(index, body);
        let (pose, hurried) = (body.pose(), body.is_hurried());
        let first = self.point_on_part(&self.touch(index, &pose, surface), index, &pose, hurried, member);
        let Some(first) = first.filter(Point::is_struck) else { return Vec::new() };
        let mut points = vec![first];
        self.for_known_touches(index, body, &pose, |t| {
            if t.surface != surface {
                points.extend(self.point_on_part(&t, index, &pose, hurried, member));
            }
        });
        points
    }

    pub(super) fn point_on_part(
        &self,
        t: &Touch,
        index: usize,
        pose: &Pose,
        hurried: bool,
        member: &Member,
    ) -> Option<Point> {
        let spec = &self.specs[index];
        if t.gap > TOUCHING * spec.gap {
            return None;
        }
        let law = self.law_at(index, t, pose.x + t.arm);
        let k = response(member.inverse_mass, &member.inverse_inertia, t.arm);
        let contact = Contact::new(0, None, [t.arm, DVec3::ZERO], t.normal, law.friction, k);
        let approach = -pose.velocity(t.arm).dot(t.normal);
        Some(Point::new(contact, approach, &law, self.settle_speed(spec, &law), hurried, Other::Surface(t.surface)))
    }
}
