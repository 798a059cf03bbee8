//! Which points of a body touch fixed parts, and its impact there.

use super::contact_id::ContactId;
use super::contact_point::ContactPoint;
use super::facets::Flat;
use super::foot::FootPoint;
use super::ground::StaticPieces;
use crate::rigid::body_state::{Pose, RigidBodyState};
use crate::rigid::static_shape::{Projection, StaticShape, distance_beyond, farthest_side, up_at_ring};
use crate::rigid::tolerances::{CONTACT_MARGIN, MAX_STATIC_CONTACTS};
use crate::rigid::{BodyDef, RigidWorld};
use crate::scenery::{Aabb, Surface};
use crate::shape::{Ring, Within};
use glam::DVec3;

impl RigidWorld {
    /// A point of a body, wherever it is.
    #[inline]
    pub(crate) fn touch(&self, index: usize, pose: &Pose, surface: Surface) -> ContactPoint {
        let (part, point) = match surface {
            Surface::Part { part, point } => (part, point),
            Surface::Spot { part, piece, point } => {
                return self.contact_of_id(index, pose, part, ContactId::of_surface(piece, point));
            }
            _ => (0, 0),
        };
        let (spec, k) = (&self.specs[index], usize::from(point));
        if let StaticShape::Block { bounds, .. } = &self.parts[usize::from(part)]
            && let Some(number) = k.checked_sub(spec.foot_points().start).filter(|_| !spec.rings.is_empty())
            && let Some(foot) = FootPoint::new(bounds, &spec.rings[0], pose.x, &pose.r, number)
        {
            return ContactPoint::of_point(part, point, foot.arm, foot.normal, foot.gap);
        }
        let sphere = match self.ring_at(index, part, k) {
            Some(ring) => {
                let up = match &self.parts[usize::from(part)] {
                    StaticShape::Block { bounds, .. } => up_at_ring(bounds, ring, pose.x, &pose.r),
                    // Away from the part, below the body.
                    _ => self.project(part, pose.x, spec.bounding_radius).normal,
                };
                let turned = pose.r.transpose();
                spec.ring_point(k, turned * up, turned * up.cross(pose.w)).0
            }
            None => spec.contact_spheres[k],
        };
        let arm = pose.r * sphere.centre;
        let projection = self.project(part, pose.x + arm, sphere.radius);
        ContactPoint::of_point(
            part,
            point,
            arm - projection.normal * sphere.radius,
            projection.normal,
            projection.distance - sphere.radius,
        )
    }

    /// The ring that a point of a body on a part belongs to. A table is touched by the contact spheres alone.
    #[inline]
    pub(crate) fn ring_at(&self, index: usize, part: u16, point: usize) -> Option<&Ring> {
        let ring = self.specs[index].ring_of(point)?;
        (!matches!(self.parts[usize::from(part)], StaticShape::Table(_))).then_some(ring)
    }

    /// Where a ball's centre is relative to a part that is no mesh.
    #[inline]
    fn project(&self, part: u16, p: DVec3, radius: f64) -> Projection {
        match (&self.parts[usize::from(part)], self.static_colliders[usize::from(part)].pieces.first()) {
            (StaticShape::Solid(_), Some(piece)) => {
                let (normal, distance) = piece.about(DVec3::ZERO).project(p);
                Projection { normal, distance: distance - piece.rounding }
            }
            (part, _) => part.project(p, radius),
        }
    }

    /// Calls `each` for the points of a body that are within `within` of a part.
    pub(crate) fn for_touches(
        &self,
        index: usize,
        pose: &Pose,
        within: impl Into<Within>,
        mut each: impl FnMut(ContactPoint),
    ) {
        let all = within.into();
        let within = all.gap;
        let spec = &self.specs[index];
        let around = Aabb::around([pose.x]).grown(spec.bounding_radius + within);
        self.for_parts(&around, |k, part| {
            if let StaticShape::Block { .. } | StaticShape::Solid(_) | StaticShape::Mesh(_) | StaticShape::Arc(_) = part
                && !self.static_colliders[k].bounds().meets(&around)
            {
                return;
            }
            if let StaticShape::Arc(arc) = part {
                Self::for_arc_contacts(spec, pose, (k as u16, arc), within, &mut each);
                if arc.covers(pose.x, spec.bounding_radius + within) {
                    return;
                }
            }
            let (flat, rest) = self.ground(spec, k, pose);
            if let Some(flat) = flat {
                if spec.is_compound() || matches!(part, StaticShape::Mesh(_)) {
                    self.for_piece_contacts(spec, pose, (k, StaticPieces::flat(flat)), all, &mut each);
                } else {
                    self.for_contacts_with_flat(spec, pose, (k as u16, flat), within, &mut each);
                }
            }
            match (part, rest) {
                (StaticShape::Block { bounds, .. }, Some(_)) if spec.meets_by_rings(part) => {
                    self.for_ring_contacts(index, pose, (k as u16, bounds), within, &mut each);
                }
                (_, Some(rest)) => self.for_piece_contacts(spec, pose, (k, rest), all, &mut each),
                (StaticShape::Table(table), None) => {
                    let k = k as u16;
                    let (high, x) = (table.height.range()[1] + within, table.place(pose.x));
                    if x.z - spec.bounding_radius > high {
                        return;
                    }
                    let far = spec.bounding_radius;
                    let here = table.height.bounds([x.x - far, x.y - far], [x.x + far, x.y + far]);
                    let high = here.map_or(high, |b| b.high + within);
                    let up = pose.r.transpose() * table.up();
                    for (point, sphere) in spec.contact_spheres.iter().enumerate() {
                        if x.z + up.dot(sphere.centre) - sphere.radius <= high {
                            let touch = self.touch(index, pose, Surface::Part { part: k, point: point as u16 });
                            if touch.gap <= within {
                                each(touch);
                            }
                        }
                    }
                }
                _ => {}
            }
        });
    }

    /// Calls `each` for the points of a body that are within `within` of a half space.
    fn for_contacts_with_flat(
        &self,
        spec: &BodyDef,
        pose: &Pose,
        (part, flat): (u16, Flat),
        within: f64,
        each: &mut impl FnMut(ContactPoint),
    ) {
        let height = flat.distance(pose.x);
        if height > spec.bounding_radius + within {
            return;
        }
        let body_normal = pose.r.transpose() * flat.normal;
        let body_normal_rate = pose.r.transpose() * flat.normal.cross(pose.w);
        for point in (0..spec.hull).chain(spec.ring_points()) {
            let sphere = spec.point(point, body_normal, body_normal_rate);
            let gap = height + body_normal.dot(sphere.centre) - sphere.radius;
            if gap <= within {
                let arm = pose.r * sphere.centre - flat.normal * sphere.radius;
                each(ContactPoint::of_point(part, point as u16, arm, flat.normal, gap));
            }
        }
    }

    /// Calls `each` for the balls and rings of a body of revolution that are within `within` of a box.
    fn for_ring_contacts(
        &self,
        index: usize,
        pose: &Pose,
        (k, bounds): (u16, &Aabb),
        within: f64,
        each: &mut impl FnMut(ContactPoint),
    ) {
        let spec = &self.specs[index];
        // The box is part of the half space behind a side, so a point that is not near the half space is
        // not near the box.
        let side = farthest_side(bounds, pose.x);
        let (normal, height) = side.map_or((DVec3::ZERO, 0.0), |s| (s.normal, s.beyond));
        let body_normal = pose.r.transpose() * normal;
        for point in (0..spec.hull).chain(spec.ring_points()) {
            let above = match spec.ring_of(point) {
                Some(ring) => body_normal.z * ring.height - ring.circle * body_normal.truncate().length() - ring.radius,
                None => body_normal.dot(spec.contact_spheres[point].centre) - spec.contact_spheres[point].radius,
            };
            if side.is_some() && height + above > within {
                continue;
            }
            let touch = self.touch(index, pose, Surface::Part { part: k, point: point as u16 });
            if touch.gap <= within {
                each(touch);
            }
        }
        let ring = &spec.rings[0];
        let (middle, reach) = (pose.x + pose.r.z_axis * ring.height, ring.circle + ring.radius + within);
        if distance_beyond(bounds, middle) > reach {
            return;
        }
        let first = spec.foot_points().start;
        FootPoint::for_near_edges(bounds, middle, reach, |number| {
            if let Some(foot) = FootPoint::new(bounds, ring, pose.x, &pose.r, number)
                && foot.gap <= within
                && foot.is_under(ring)
            {
                each(ContactPoint::of_point(k, (first + number) as u16, foot.arm, foot.normal, foot.gap));
            }
        });
    }

    /// Calls `each` for the points of a body that touch: those noted at its clock if all were noted, otherwise those
    /// found now.
    pub(crate) fn for_known_touches(
        &self,
        index: usize,
        body: &RigidBodyState,
        pose: &Pose,
        mut each: impl FnMut(ContactPoint),
    ) {
        let spec = &self.specs[index];
        let noted = body.touching();
        // Which point of a ring is lowest depends on the velocities, and an impact has changed these.
        let moves = |s: &Surface| !spec.is_ball && matches!(s, Surface::Spot { .. });
        if body.listed != body.path.t
            || noted.len() == MAX_STATIC_CONTACTS
            || !spec.rings.is_empty()
            || noted.iter().any(moves)
        {
            return self.for_touches(index, pose, CONTACT_MARGIN * spec.gap, each);
        }
        for &surface in noted {
            each(self.touch(index, pose, surface));
        }
    }

    /// The deepest overlap of a body with a part.
    pub(crate) fn deepest(&self, index: usize, body: &RigidBodyState) -> Option<(u16, f64)> {
        let mut deepest: Option<(u16, f64)> = None;
        self.for_touches(index, &body.pose(), 0.0, |t| {
            if deepest.is_none_or(|(_, depth)| -t.gap > depth) {
                deepest = Some((t.part, -t.gap));
            }
        });
        deepest
    }

    /// Notes which points touch, once for each time.
    pub(crate) fn list_touches(&self, index: usize, body: &mut RigidBodyState) {
        if body.listed == body.path.t {
            return;
        }
        let spec = &self.specs[index];
        let mut found = [const { Surface::Part { part: 0, point: 0 } }; MAX_STATIC_CONTACTS];
        let mut count = 0;
        self.for_touches(index, &body.pose(), CONTACT_MARGIN * spec.gap, |t| {
            if count < found.len() {
                found[count] = t.surface;
                count += 1;
            }
        });
        body.list(found[..count].iter().copied());
        body.listed = body.path.t;
    }
}
