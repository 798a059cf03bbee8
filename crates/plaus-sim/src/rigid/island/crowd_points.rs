//! Points of a crowd's step: measured once, then carried along.

use super::crowd::{Carrier, Crowd, CrowdPoint};
use crate::rigid::narrow_phase::contact_id::ContactId;
use crate::rigid::narrow_phase::contact_point::{ContactPoint, PairContactPoint, to_middle};
use crate::rigid::scratch::RigidScratch;
use crate::rigid::static_shape::StaticShape;
use crate::rigid::tolerances::{CONTACT_MARGIN, KEPT_GAP, PUSH_OUT_SPEED};
use crate::rigid::{BodyDef, RigidWorld};
use crate::scenery::Surface;
use crate::shape::On;
use crate::shape::convex_pair::Mark;
use crate::shape::hull_pair::Feature;
use crate::shape::piece::Core;
use glam::DVec3;

/// Where a point is now.
pub(super) struct Carried {
    pub(super) arms: [DVec3; 2],
    pub(super) normal: DVec3,
    pub(super) gap: f64,
}

impl Crowd {
    /// Lists the points by height.
    pub(super) fn list(&mut self, scratch: &RigidScratch, world: &RigidWorld) {
        self.points.clear();
        let up = -world.gravity;
        let push = PUSH_OUT_SPEED * world.accuracy.settle;
        for (number, (k, t)) in scratch.touches.iter().enumerate() {
            let (p, spec) = (&scratch.places[*k], &world.specs[scratch.places[*k].body]);
            let law = world.law_at(p.body, t, p.start.x + t.arm);
            let arm = t.arm.length();
            let (carrier, rounding) = world.carrier_of_touch(p.body, t);
            self.points.push(CrowdPoint {
                number,
                height: up.dot(p.start.x + t.arm),
                a: *k,
                b: None,
                carrier,
                arms: [t.arm, DVec3::ZERO],
                rounding,
                normal: t.normal,
                gap: t.gap,
                kept: KEPT_GAP * spec.gap,
                near: CONTACT_MARGIN * spec.gap,
                push: push * spec.speed,
                frictions: [law.friction, law.grip()],
                still: world.still(p.body),
                resists: resists([law.spinning, law.rolling], arm),
                now: t.gap,
                restitution: law.restitution,
                settles: world.settle_speed(spec, &law),
                ..CrowdPoint::default()
            });
        }
        for (number, (ab, t)) in (scratch.touches.len()..).zip(&scratch.pairs) {
            let [p, q] = ab.map(|k| &scratch.places[k]);
            let both = [p.body, q.body];
            let (law, gap) = (world.pair_law(both), world.pair_gap(both));
            let arm = world.resisted_arm(both, &t.arms);
            self.points.push(CrowdPoint {
                number,
                height: up.dot(p.start.x + t.arms[0]),
                a: ab[0],
                b: Some(ab[1]),
                carrier: world.carrier_of_pair(both, t),
                arms: to_middle(t.arms, [p.start.x, q.start.x]),
                rounding: 0.0,
                normal: t.normal,
                gap: t.gap,
                kept: KEPT_GAP * gap,
                near: CONTACT_MARGIN * gap,
                push: push * world.specs[p.body].speed.min(world.specs[q.body].speed),
                frictions: [law.friction, law.grip()],
                still: world.still(p.body).min(world.still(q.body)),
                resists: resists([law.spinning, law.rolling], arm),
                now: t.gap,
                restitution: law.restitution,
                settles: world.pair_settle_speed(both),
                ..CrowdPoint::default()
            });
        }
        self.points.sort_unstable_by(|p, q| p.height.total_cmp(&q.height).then(p.number.cmp(&q.number)));
    }

    /// Where a point is now.
    pub(super) fn carry(&self, scratch: &RigidScratch, world: &RigidWorld, p: &CrowdPoint) -> Carried {
        let a = &scratch.places[p.a];
        let b = p.b.map(|b| &scratch.places[b]);
        if p.carrier == Carrier::Skin {
            return match (b, scratch.touches.get(p.number)) {
                (Some(b), _) => {
                    let (both, t) = ([a.body, b.body], &scratch.pairs[p.number - scratch.touches.len()].1);
                    let after = world.pair_again(both, [&a.end, &b.end], t);
                    let arms = to_middle(after.arms, [a.end.x, b.end.x]);
                    Carried { arms, normal: after.normal, gap: after.gap }
                }
                (None, Some((_, t))) => {
                    let after = world.touch(a.body, &a.end, t.surface);
                    Carried { arms: [after.arm, DVec3::ZERO], normal: after.normal, gap: after.gap }
                }
                (None, None) => Carried { arms: p.arms, normal: p.normal, gap: p.gap },
            };
        }
        let (turn, other) = (&self.turned[p.a], p.b.map(|b| &self.turned[b]));
        let n = match (p.carrier, other) {
            (Carrier::First, _) => *turn * p.normal,
            (Carrier::Second, Some(other)) => *other * p.normal,
            (Carrier::Both, other) => {
                (*turn * p.normal + other.map_or(p.normal, |other| *other * p.normal)).normalize()
            }
            _ => p.normal,
        };
        let centre = p.arms[0] + p.normal * p.rounding;
        let mut arms = [*turn * centre - n * p.rounding, other.map_or(DVec3::ZERO, |other| *other * p.arms[1])];
        let mut moved = a.end.x - a.start.x + arms[0] - p.arms[0];
        if let Some(b) = b {
            moved -= b.end.x - b.start.x + arms[1] - p.arms[1];
            // Both bodies are pushed at one point: that of the body whose corner it is.
            let apart = (a.end.x + arms[0]) - (b.end.x + arms[1]);
            match p.carrier {
                Carrier::Second => arms[1] += apart,
                Carrier::First => arms[0] -= apart,
                _ => (arms[0], arms[1]) = (arms[0] - apart * 0.5, arms[1] + apart * 0.5),
            }
        }
        Carried { arms, normal: n, gap: p.gap + moved.dot(n) }
    }
}

impl RigidWorld {
    /// With what the normal of a touch turns, and how far the skin is from the point that the body carries.
    fn carrier_of_touch(&self, body: usize, t: &ContactPoint) -> (Carrier, f64) {
        match t.surface {
            Surface::Spot { piece, point, .. } if !self.specs[body].is_ball => {
                let id = ContactId::of_surface(piece, point);
                let own = &self.specs[body].pieces[usize::from(id.own)];
                let carrier = match id.mark {
                    Mark::Polyhedra(feature) => carrier(feature, Carrier::Fixed),
                    Mark::Over { .. } if matches!(own.core, Core::Polyhedron(_)) => Carrier::Fixed,
                    _ => Carrier::Skin,
                };
                (carrier, if carrier == Carrier::Fixed { own.rounding } else { 0.0 })
            }
            _ => match (&self.parts[usize::from(t.part)], self.fixed_sphere(body, t)) {
                (StaticShape::Plane(_), Some(sphere)) => (Carrier::Fixed, sphere.radius),
                _ => (Carrier::Skin, 0.0),
            },
        }
    }

    fn carrier_of_pair(&self, both: [usize; 2], t: &PairContactPoint) -> Carrier {
        match t.id {
            Some(ContactId { mark: Mark::Polyhedra(feature), .. }) if !both.iter().any(|&k| self.specs[k].is_ball) => {
                match carrier(feature, Carrier::Second) {
                    Carrier::First if self.is_turned(both) => Carrier::Second,
                    Carrier::Second if self.is_turned(both) => Carrier::First,
                    as_listed => as_listed,
                }
            }
            _ => Carrier::Skin,
        }
    }
}

/// Whether a body has a skin whose point of contact moves about on it.
pub(super) fn is_curved(spec: &BodyDef) -> bool {
    let has_faces = !spec.pieces.is_empty() && spec.pieces.iter().all(|p| matches!(p.core, Core::Polyhedron(_)));
    !spec.is_ball && !has_faces
}

/// With what the normal of two polyhedra turns, of which the second is, or is carried by, `second`.
fn carrier(feature: Feature, second: Carrier) -> Carrier {
    match feature {
        Feature::Corner { of: 0, on: On::Face(_), .. } => second,
        Feature::Corner { of: 1, on: On::Face(_), .. } => Carrier::First,
        _ => Carrier::Both,
    }
}

fn resists([spinning, rolling]: [f64; 2], arm: f64) -> Option<[f64; 2]> {
    (spinning > 0.0 || rolling > 0.0).then_some([spinning * arm, rolling * arm])
}
