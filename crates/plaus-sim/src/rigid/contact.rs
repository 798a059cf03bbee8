//! Which points touch, and one point's impact.

use super::body::{MOST_TOUCHES, Motion, Phase, Pose, Turning};
use super::part::{Part, farthest_side};
use super::step::TOUCHING;
use super::{Rigid, Spec};
use crate::material::Law;
use crate::mechanics::{Impact, Other};
use crate::resolve::{ContactMatrix, stronge_impulse};
use crate::scenery::Surface;
use glam::{DMat3, DVec3};

/// A point of a body on a part.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Touch {
    pub(crate) part: u16,
    pub(crate) point: u16,
    /// From the centre of gravity to the point of contact, in world axes.
    pub(crate) arm: DVec3,
    /// Unit normal out of the part.
    pub(crate) normal: DVec3,
    pub(crate) gap: f64,
}

impl Touch {
    pub(crate) fn surface(&self) -> Surface {
        Surface::Part { part: self.part, point: self.point }
    }
}

/// Velocity change at `arm` per impulse there, in world axes.
#[inline]
pub(crate) fn response(inverse_mass: f64, inverse_inertia: &DMat3, arm: DVec3) -> DMat3 {
    let cross = DMat3::from_cols(
        DVec3::new(0.0, arm.z, -arm.y),
        DVec3::new(-arm.z, 0.0, arm.x),
        DVec3::new(arm.y, -arm.x, 0.0),
    );
    DMat3::from_diagonal(DVec3::splat(inverse_mass)) - cross * *inverse_inertia * cross
}

impl Rigid {
    /// A point of a body, wherever it is.
    #[inline]
    pub(super) fn touch(&self, index: usize, pose: &Pose, part: u16, point: u16) -> Touch {
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
        Touch {
            part,
            point,
            arm: arm - foot.normal * feeler.radius,
            normal: foot.normal,
            gap: foot.distance - feeler.radius,
        }
    }

    /// Calls `each` for the points of a body that are within `within` of a part.
    pub(super) fn for_touches(&self, index: usize, pose: &Pose, within: f64, mut each: impl FnMut(Touch)) {
        let spec = &self.specs[index];
        for (k, part) in self.parts.iter().enumerate() {
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
                            each(Touch { part: k, point: point as u16, arm, normal: plane.normal, gap });
                        }
                    }
                    let swing = pose.r.transpose() * plane.normal.cross(pose.w);
                    for point in spec.ring_points() {
                        let (feeler, _) = spec.ring_point(point, lever, swing);
                        let gap = height + lever.dot(feeler.centre) - feeler.radius;
                        if gap <= within {
                            let arm = pose.r * feeler.centre - plane.normal * feeler.radius;
                            each(Touch { part: k, point: point as u16, arm, normal: plane.normal, gap });
                        }
                    }
                }
                Part::Block { bounds, .. } => {
                    if bounds.grown(spec.reach + within).contains(pose.x) {
                        // The box is part of the half space behind a side: what is not near that is not near the box.
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
                            let touch = self.touch(index, pose, k, point as u16);
                            if touch.gap <= within {
                                each(touch);
                            }
                        }
                        self.for_ledge_touches(index, pose, k, within, &mut each);
                    }
                }
                Part::Table(table) => {
                    let high = table.height.range()[1] + within;
                    if pose.x.z - spec.reach > high {
                        continue;
                    }
                    let far = spec.reach;
                    let here = table.height.bounds([pose.x.x - far, pose.x.y - far], [pose.x.x + far, pose.x.y + far]);
                    let high = here.map_or(high, |b| b.high + within);
                    let up = pose.r.transpose() * DVec3::Z;
                    for (point, feeler) in spec.feelers.iter().enumerate() {
                        if pose.x.z + up.dot(feeler.centre) - feeler.radius <= high {
                            let touch = self.touch(index, pose, k, point as u16);
                            if touch.gap <= within {
                                each(touch);
                            }
                        }
                    }
                }
            }
        }
    }

    /// Calls `each` for the points of a body that touch: those noted at its clock, where all were, or else those found now.
    pub(super) fn for_known_touches(&self, index: usize, body: &Turning, pose: &Pose, mut each: impl FnMut(Touch)) {
        let spec = &self.specs[index];
        let noted = body.touching();
        // Which point of a ring is the lowest goes with the velocities, and those an impact has changed.
        if body.listed != body.path.t || noted.len() == MOST_TOUCHES || !spec.rings.is_empty() {
            return self.for_touches(index, pose, TOUCHING * spec.gap, each);
        }
        for surface in noted {
            if let Surface::Part { part, point } = *surface {
                each(self.touch(index, pose, part, point));
            }
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
    pub(super) fn law_at(&self, index: usize, part: u16, point: DVec3) -> Law {
        let part = &self.parts[usize::from(part)];
        let law = self.laws.of(self.specs[index].material, part.material());
        match part {
            Part::Table(table) => table.law(point, law),
            Part::Block { stretches, .. } => {
                let here = stretches.iter().rev().find(|s| point.y >= s.from);
                Law { friction: here.and_then(|s| s.friction).unwrap_or(law.friction), ..*law }
            }
            _ => *law,
        }
    }

    /// Rebound speed up to which a contact lasts.
    #[inline]
    pub(super) fn settle_speed(&self, spec: &Spec, law: &Law) -> f64 {
        self.accuracy.settle * (1.0 - law.restitution) * spec.speed
    }

    /// Notes which points touch, once per time.
    pub(super) fn list_touches(&self, index: usize, body: &mut Turning) {
        if body.listed == body.path.t {
            return;
        }
        let spec = &self.specs[index];
        let mut found = [const { Surface::Part { part: 0, point: 0 } }; MOST_TOUCHES];
        let mut count = 0;
        self.for_touches(index, &body.pose(), TOUCHING * spec.gap, |t| {
            if count < found.len() {
                found[count] = t.surface();
                count += 1;
            }
        });
        body.list(found[..count].iter().copied());
        body.listed = body.path.t;
    }

    /// Impact of one point of a body on a part.
    pub(super) fn hit_part(&self, index: usize, body: &mut Turning, part: u16, point: u16) -> Option<Impact> {
        let spec = &self.specs[index];
        // Only the event's own contact may be one that the drift alone brings about.
        let first = body.listed != body.path.t;
        self.list_touches(index, body);
        let mut pose = body.pose();
        let touch = self.touch(index, &pose, part, point);
        let mut u = pose.velocity(touch.arm);
        let mut approach = -u.dot(touch.normal);
        let vigour = body.vigour(spec);
        let before = Motion { v: body.path.v, w: body.spin };
        if approach <= 0.0 && first {
            body.take_drift();
            pose = body.pose();
            u = pose.velocity(touch.arm);
            approach = -u.dot(touch.normal);
        }
        let law = self.law_at(index, part, pose.x + touch.arm);
        let settles = self.settle_speed(spec, &law);
        let lasting = law.restitution * approach <= settles || body.is_hurried();
        let far = touch.gap > TOUCHING * spec.gap;
        if approach <= 0.0 || far || (lasting && approach <= LEFT * settles) {
            // No impact: the drift's velocities, if taken, would bring energy.
            body.set_motion(before);
            return None;
        }
        let inverse = spec.inertia.inverse(&pose.r);
        let k = response(1.0 / spec.mass, &inverse, touch.arm);
        let e = if lasting { 0.0 } else { law.restitution };
        let impulse = impulse(&k, u, touch.normal, e, law.friction, self.accuracy.slip_turn);
        body.path.v += impulse / spec.mass;
        body.spin += inverse * touch.arm.cross(impulse);
        body.ends[0] = Motion { v: body.path.v, w: body.spin };
        let after = body.vigour(spec);
        if after > vigour {
            body.slow_down((vigour / after).sqrt());
        }
        if body.phase != Phase::Flight {
            body.phase = Phase::Step;
        }
        let at = pose.x + touch.arm;
        Some(Impact {
            time: body.path.t,
            body: index,
            other: Other::Surface(touch.surface()),
            point: at,
            normal: touch.normal,
            impulse,
            approach,
            lasting,
        })
    }
}

/// Approach, over the speed below which a bounce lasts, that is left to the solver of lasting contacts. Default 0.1; larger values lose the order of slow impacts.
const LEFT: f64 = 0.1;

/// Impulse of an impact in world axes. The tangents follow the slip, so that an impact in a plane stays in it.
pub(crate) fn impulse(k: &DMat3, u: DVec3, normal: DVec3, restitution: f64, friction: f64, turn: f64) -> DVec3 {
    let slip = u - normal * u.dot(normal);
    let speed = slip.length();
    let first = if speed > 0.0 { slip / speed } else { normal.any_orthonormal_vector() };
    let frame = DMat3::from_cols(first, normal.cross(first), normal);
    let local = ContactMatrix(frame.transpose() * *k * frame);
    frame * stronge_impulse(&local, frame.transpose() * u, restitution, friction, turn)
}
