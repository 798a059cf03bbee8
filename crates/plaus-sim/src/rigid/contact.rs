//! Which points of a body touch fixed parts, and its impact there.

use super::body::{MOST_TOUCHES, Motion, Phase, Pose, Turning};
use super::coulomb::{Contact, Member, response};
use super::part::{Foot, Part, farthest_side, up_at_ring};
use super::scratch::{RigidScratch, TOUCHING};
use super::still::Ground;
use super::strike::{Point, strike};
use super::touch::{Spot, Touch};
use super::{Rigid, Spec};
use crate::material::Law;
use crate::mechanics::{Impact, Other};
use crate::scenery::{Aabb, Surface};
use crate::shape::Within;
use crate::shape::convex_pair::Mark;
use glam::{DMat3, DVec3};

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
        let (spec, k) = (&self.specs[index], usize::from(point));
        let feeler = match spec.ring_of(k) {
            Some(ring) => {
                let up = match &self.parts[usize::from(part)] {
                    Part::Block { bounds, .. } => up_at_ring(bounds, ring, pose.x, &pose.r),
                    // Away from the part, below the body.
                    _ => self.foot(part, pose.x, spec.reach).normal,
                };
                let turned = pose.r.transpose();
                spec.ring_point(k, turned * up, turned * up.cross(pose.w)).0
            }
            None => spec.feelers[k],
        };
        let arm = pose.r * feeler.centre;
        let foot = self.foot(part, pose.x + arm, feeler.radius);
        Touch::of_point(part, point, arm - foot.normal * feeler.radius, foot.normal, foot.distance - feeler.radius)
    }

    /// Where a ball's centre is relative to a part that is no mesh.
    #[inline]
    fn foot(&self, part: u16, p: DVec3, radius: f64) -> Foot {
        match (&self.parts[usize::from(part)], self.stills[usize::from(part)].pieces.first()) {
            (Part::Solid(_), Some(piece)) => {
                let (normal, distance) = piece.placed(&DMat3::IDENTITY, DVec3::ZERO).foot(p);
                Foot { normal, distance: distance - piece.rounding }
            }
            (part, _) => part.foot(p, radius),
        }
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
        let around = Aabb::around([pose.x]).grown(spec.reach + within);
        self.for_parts(&around, |k, part| {
            if let Part::Block { .. } | Part::Solid(_) | Part::Mesh(_) = part
                && !self.stills[k].bounds().meets(&around)
            {
                return;
            }
            let ground = self.ground(spec, k, pose);
            match (part, ground) {
                (Part::Mesh(_), Some(Ground::Flat(flat))) => {
                    self.for_spots(spec, pose, (k, Ground::Flat(flat), Mark::PLANE), all, &mut each);
                    // What else there is of the mesh.
                    self.for_spots(spec, pose, (k, Ground::Still(&self.stills[k]), flat.face), all, &mut each);
                }
                (_, Some(Ground::Flat(flat))) if !spec.is_compound() => {
                    let k = k as u16;
                    let height = flat.distance(pose.x);
                    if height > spec.reach + within {
                        return;
                    }
                    let lever = pose.r.transpose() * flat.normal;
                    let swing = pose.r.transpose() * flat.normal.cross(pose.w);
                    for point in (0..spec.hull).chain(spec.ring_points()) {
                        let feeler = spec.point(point, lever, swing);
                        let gap = height + lever.dot(feeler.centre) - feeler.radius;
                        if gap <= within {
                            let arm = pose.r * feeler.centre - flat.normal * feeler.radius;
                            each(Touch::of_point(k, point as u16, arm, flat.normal, gap));
                        }
                    }
                }
                (Part::Block { bounds, .. }, Some(_)) if spec.meets_by_rings(part) => {
                    let k = k as u16;
                    // The box is part of the half space behind a side, so a point that is not near the half space is
                    // not near the box.
                    let side = farthest_side(bounds, pose.x);
                    let (normal, height) = side.map_or((DVec3::ZERO, 0.0), |s| (s.normal, s.beyond));
                    let lever = pose.r.transpose() * normal;
                    for point in (0..spec.hull).chain(spec.ring_points()) {
                        let above = match spec.ring_of(point) {
                            Some(ring) => lever.z * ring.height - ring.circle * lever.truncate().length() - ring.radius,
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
                }
                (_, Some(ground)) => self.for_spots(spec, pose, (k, ground, Mark::PLANE), all, &mut each),
                (Part::Table(table), None) => {
                    let k = k as u16;
                    let (high, x) = (table.height.range()[1] + within, table.place(pose.x));
                    if x.z - spec.reach > high {
                        return;
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
                (_, None) => {}
            }
        });
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
