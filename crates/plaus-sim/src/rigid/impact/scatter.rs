//! Impacts of real, imperfect surfaces. The dents, grains and edges that no shape describes give each impact a normal
//! of its own, tilted a little from that of the surfaces, and a restitution of its own.
//!
//! Sources: Barzel, Hughes & Wood, "Plausible motion simulation for computer graphics animation" (1996); the ball of
//! Chenney & Forsyth, "Sampling plausible solutions to multi-body constraint problems" (2000), in three dimensions.
//!
//! The law of a pair of materials ([`Scatter`](crate::material::Scatter)) and three standard normal scores of an impact
//! say which. The normal turns about an axis in the tangent plane: by the first score in the direction in which the
//! first body slides over the other, by the second to its left, so that a rotation of the whole world changes nothing.
//! Where nothing slides, a direction that is fixed in the first body takes that one's place. The restitution is
//! multiplied by one plus the third score's part, and stays within [0, 1].
//!
//! An impact is then resolved by its law about the tilted normal. That law takes energy from any normal, and its
//! impulses act on both bodies at one point. But what leaves a tilted facet may still approach the surface: that rest
//! is resolved about the surface's own normal, by the same law, as a second impact at the same instant (on a rough
//! surface, the next facet). So no energy is made, momentum is kept, and afterwards nothing approaches. To limit the
//! tilt instead would change the law of tilts where impacts graze.
//!
//! The simulator knows no chance: the scores are a function of the impact's name, which is the two things that meet and
//! how many impacts that scatter they had before. Points that are struck at one instant are told one by one. Contacts
//! that last do not scatter, nor do impacts after which a contact lasts, those of time-stepped islands, and joints at
//! their limits.

use super::simultaneous::ImpactPoint;
use crate::mechanics::Other;
use crate::rigid::RigidWorld;
use crate::rigid::body_state::RigidBodyState;
use crate::rigid::scattered::{ImpactName, ImpactScores, Partner};
use crate::rigid::solver::contact_constraint::SolverBody;
use crate::rigid::tolerances::{MOST_TILT, UNTOLD_SLIP};
use crate::scenery::Surface;
use glam::{DMat3, DQuat, DVec2, DVec3};
use plaus_dist::math;

/// What a point is on.
pub(super) fn partner(other: Other) -> Partner {
    match other {
        Other::Body(k) => Partner::Body(k as u32),
        Other::Surface(Surface::Part { part, .. } | Surface::Spot { part, .. }) => Partner::Part(part.into()),
        Other::Surface(_) => Partner::Part(u32::MAX),
    }
}

/// The direction from which tilts are told, across a normal: that of the slip, for a velocity `u` of the first body
/// over the other; where it does not slide, an axis of the body, which `turn` turns.
fn direction(n: DVec3, u: DVec3, turn: DQuat) -> DVec3 {
    let slip = u - n * u.dot(n);
    if slip.length() > UNTOLD_SLIP * u.length() {
        return slip.normalize();
    }
    let axes = DMat3::from_quat(turn);
    let axes = [axes.x_axis, axes.y_axis, axes.z_axis];
    let most_across = axes.into_iter().min_by(|a, b| a.dot(n).abs().total_cmp(&b.dot(n).abs()));
    let axis = most_across.unwrap_or(DVec3::X);
    (axis - n * axis.dot(n)).normalize()
}

/// A normal tilted by so many radians in a direction across it and to the left of that.
fn tilted(n: DVec3, along: DVec3, by: DVec2) -> DVec3 {
    let angle = by.length();
    if angle == 0.0 {
        return n;
    }
    let (sin, cos) = math::sin_cos(angle.min(MOST_TILT));
    let across = (along * by.x + n.cross(along) * by.y) / angle;
    (n * cos + across * sin).normalize()
}

impl RigidWorld {
    /// Lets impacts scatter as the laws of contact say: with these scores.
    pub fn scatter_by(&mut self, scores: ImpactScores) {
        self.scores = Some(scores);
    }

    /// What a body of a state struck in impacts that scattered, and how often, so far: bodies of higher index, and
    /// fixed parts. Their ordinals are those from 0 on.
    pub fn scattered<'b>(&self, body: &'b RigidBodyState) -> impl Iterator<Item = (Partner, u32)> + use<'b> {
        body.scattered.counts()
    }

    /// Gives the points that are struck their own normals and restitutions. All are of one body, the first of their
    /// contacts, on one thing or on fixed parts; `members` are as in the contacts.
    pub(super) fn scatter(
        &self,
        points: &mut [ImpactPoint],
        members: &[SolverBody],
        index: usize,
        body: &mut RigidBodyState,
    ) {
        let Some(scores) = &self.scores else { return };
        for p in points.iter_mut().filter(|p| p.is_struck() && !p.lasting && !p.scatter.is_none()) {
            let other = partner(p.other);
            let ordinal = body.scattered.next(other);
            let [along, across, part] = scores.of(ImpactName { body: index as u32, other, ordinal });
            p.is_scattered = true;
            p.restitution = (p.restitution * (1.0 + p.scatter.restitution * part)).clamp(0.0, 1.0);
            if p.restitution * p.approach <= p.settles {
                (p.restitution, p.lasting) = (0.0, true);
                continue;
            }
            let (n, tilt) = (p.contact.normal, p.scatter.tilt);
            if tilt > 0.0 {
                let way = direction(n, p.contact.velocity(members), body.turn);
                p.tilted = Some(tilted(n, way, DVec2::new(along, across) * tilt));
            }
        }
    }
}
