//! Resistance to rolling and to spinning as it holds bodies at rest: torques up to a bound.
//!
//! The law is that of `energy.rs`. At rest the torque is as large as is needed, within the bound, as friction is. It is
//! found in rounds with the contacts' impulses: each acts against the angular velocity that the last one left. How much
//! of it contacts brought back says how much more is needed: they make a body turn with its mass at some distance.

use super::Rigid;
use super::coulomb::Member;
use super::scratch::RigidScratch;
use glam::DVec3;

/// Largest factor by which more is done than would stop the body if nothing touched it. Default 100: a cylinder that
/// rolls needs 3, a pin that turns about the line through two points of contact some tens.
const MOST_GAIN: f64 = 100.0;

/// Fraction of what is needed that may be missing. Default 1e-9: rounding.
const ROUNDING: f64 = 1e-9;

/// The resistance to a group's members.
pub(super) struct Brakes {
    points: Vec<Point>,
    /// For each member the factor, and the angular velocity of one round ago.
    turns: Vec<(f64, DVec3)>,
}

/// The resistance at a point on a fixed part.
struct Point {
    member: usize,
    normal: DVec3,
    /// The largest angular impulses in kg m²/s across the normal and along it, and the one that acts.
    most: [f64; 2],
    taken: DVec3,
}

impl Brakes {
    /// That of all points that bear, with the present impulses.
    pub(super) fn new(world: &Rigid, group: &RigidScratch) -> Self {
        let mut points = Vec::new();
        for ((k, t), c) in group.touches.iter().zip(&group.contacts) {
            let (place, load) = (&group.places[*k], c.impulse.dot(t.normal));
            let law = world.law_at(place.body, t, place.start.x + t.arm);
            let torque = load * t.arm.length();
            if torque > 0.0 && law.rolling > 0.0 {
                let most = [law.rolling * torque, law.spinning * torque];
                points.push(Point { member: *k, normal: t.normal, most, taken: DVec3::ZERO });
            }
        }
        Self { points, turns: vec![(1.0, DVec3::ZERO); group.places.len()] }
    }

    /// Acts against the angular velocities that are left. Returns whether the bounds allow that for any member.
    pub(super) fn act(&mut self, members: &mut [Member]) -> bool {
        let mut allow = false;
        for (k, (m, (gain, before))) in members.iter_mut().zip(&mut self.turns).enumerate() {
            if m.w == DVec3::ZERO {
                continue;
            }
            if *before != DVec3::ZERO {
                let brought_back = m.w.dot(*before) / before.length_squared();
                *gain = (*gain / (1.0 - brought_back.min(0.99))).min(MOST_GAIN);
            }
            *before = m.w;
            let axis = m.w.normalize();
            let whole = m.w * (-*gain / axis.dot(m.inverse_inertia * axis));
            let mut missing = whole;
            for p in self.points.iter_mut().filter(|p| p.member == k) {
                let wanted = p.taken + missing;
                let along = wanted.dot(p.normal);
                let across = wanted - p.normal * along;
                let next = p.normal * along.clamp(-p.most[1], p.most[1]) + across.clamp_length_max(p.most[0]);
                m.w += m.inverse_inertia * (next - p.taken);
                missing -= next - p.taken;
                p.taken = next;
            }
            allow |= missing.length() <= ROUNDING * whole.length();
        }
        allow
    }
}
