//! Resistance to rolling and to spinning: torques up to a bound.
//!
//! A contact with normal force N at distance R from the centre of gravity resists rolling, which is the part of the
//! relative angular velocity across its normal, with a torque of at most ρ N R. It resists spinning, the part along its
//! normal, with at most σ N R. The law gives ρ and σ. Without this resistance, a nudged pin would circle on the rim of
//! its foot for ever, and a lying pin would roll for ever: nothing else takes their energy.
//!
//! Between two bodies, R is the distance in the ball if one of them is a ball, otherwise the shorter of both distances;
//! the torques on both are opposite.
//!
//! On a body that turns, the torque has its bound. Where that is more than enough to stop the body, the torque is as
//! large as is needed, as friction is: it is found in rounds with the contacts' impulses. Each acts against the angular
//! velocity that the last one left. How much of it contacts brought back says how much more is needed: they make a body
//! turn with its mass at some distance.

//!
//! A point alone cannot stop a spin about its normal that is too much for its resistance to spinning: such a body goes
//! on spinning, but it is stopped from rolling as if it did not spin.

use super::contact_constraint::SolverBody;
use crate::rigid::tolerances::{MAX_RESISTANCE_GAIN, RESISTANCE_ROUNDING};
use glam::DVec3;

/// The resistance to an island's members.
#[derive(Debug, Default)]
pub(crate) struct RollingResistance {
    points: Vec<ResistedContact>,
    pub(crate) turns: Vec<ResistedBody>,
}

/// The resistance at a point of contact.
#[derive(Debug)]
struct ResistedContact {
    contact: RollingContact,
    /// The angular impulse that acts on the member.
    taken: DVec3,
}

/// A point of contact that bears.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RollingContact {
    pub(crate) member: usize,
    /// The member that it touches; none if that is a fixed part.
    pub(crate) other: Option<usize>,
    pub(crate) normal: DVec3,
    /// The largest angular impulses in kg m²/s across the normal and along it.
    pub(crate) most: [f64; 2],
}

impl RollingContact {
    /// The sign with which its impulses act on a member; 0 if it does not touch that.
    fn sign(&self, member: usize) -> f64 {
        if self.member == member {
            1.0
        } else if self.other == Some(member) {
            -1.0
        } else {
            0.0
        }
    }

    fn spin(&self, members: &[SolverBody]) -> DVec3 {
        members[self.member].w - self.other.map_or(DVec3::ZERO, |k| members[k].w)
    }

    /// The change of the relative angular velocity per angular impulse.
    fn response(&self, members: &[SolverBody], axis: DVec3) -> DVec3 {
        let one = |k: usize| members[k].inverse_inertia * axis;
        one(self.member) + self.other.map_or(DVec3::ZERO, one)
    }

    fn push(&self, members: &mut [SolverBody], impulse: DVec3) {
        for (k, sign) in [(Some(self.member), 1.0), (self.other, -1.0)] {
            if let Some(m) = k.map(|k| &mut members[k]) {
                m.w += m.inverse_inertia * (impulse * sign);
            }
        }
    }
}

/// How a member turns.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ResistedBody {
    /// How much more is done than would stop it if nothing touched it.
    gain: f64,
    /// The part of its angular velocity that was acted against one round ago.
    before: DVec3,
    /// The normal about which it goes on spinning: see [`drill`].
    drill: Option<DVec3>,
    /// Whether it may be held at rest.
    pub(crate) is_held: bool,
    /// Whether the bounds allow it to be stopped.
    pub(crate) may_stop: bool,
}

impl ResistedBody {
    /// The part of an angular velocity that resistance may stop.
    pub(crate) fn resisted(&self, w: DVec3) -> DVec3 {
        self.drill.map_or(w, |n| w - n * w.dot(n))
    }
}

impl RollingResistance {
    /// Takes the points that bear. Returns whether there are any.
    pub(crate) fn gather(&mut self, members: usize, points: impl Iterator<Item = RollingContact>) -> bool {
        self.points.clear();
        self.turns.clear();
        self.points.extend(points.map(|contact| ResistedContact { contact, taken: DVec3::ZERO }));
        if !self.points.is_empty() {
            self.turns.resize(
                members,
                ResistedBody { gain: 1.0, before: DVec3::ZERO, drill: None, is_held: false, may_stop: false },
            );
        }
        !self.points.is_empty()
    }

    /// Slows the members down before contacts act: by the whole bounds, or by what stops each part of a rotation. So
    /// energy only falls, and no rotation is reversed. The contacts' friction, which is found afterwards, makes the
    /// velocities of rolling bodies fit again.
    pub(crate) fn slow_down(&mut self, members: &mut [SolverBody]) {
        for ResistedContact { contact, taken } in &mut self.points {
            for (is_along, most) in [false, true].into_iter().zip(contact.most) {
                let spin = contact.spin(members);
                let about = contact.normal * spin.dot(contact.normal);
                let part = if is_along { about } else { spin - about };
                let speed = part.length();
                if most <= 0.0 || speed <= 0.0 {
                    continue;
                }
                let axis = part / speed;
                let whole = speed / axis.dot(contact.response(members, axis));
                let impulse = axis * -most.min(whole);
                contact.push(members, impulse);
                *taken += impulse;
                for k in [Some(contact.member), contact.other].into_iter().flatten() {
                    self.turns[k].may_stop |= whole < most;
                }
            }
        }
    }

    /// Acts against the angular velocities that are left. Returns whether the bounds allow that for any member.
    pub(crate) fn act(&mut self, members: &mut [SolverBody]) -> bool {
        let mut allow = false;
        for (k, turn) in self.turns.iter_mut().enumerate() {
            let m = members[k];
            // Nothing slows down a driven body.
            if !turn.is_held || m.inverse_mass == 0.0 {
                continue;
            }
            turn.drill = drill(&self.points, k, &m);
            let w = turn.resisted(m.w);
            // Each round leaves a small part of what it finds. While others are still braked, nothing is left of it in
            // the end, not even its direction.
            let Some(axis) = w.try_normalize() else { continue };
            let before = turn.before.length_squared();
            if before > 0.0 {
                let brought_back = w.dot(turn.before) / before;
                turn.gain = (turn.gain / (1.0 - brought_back.min(0.99))).min(MAX_RESISTANCE_GAIN);
            }
            turn.before = w;
            let whole = w * (-turn.gain / axis.dot(m.inverse_inertia * axis));
            let mut missing = whole;
            for ResistedContact { contact, taken } in &mut self.points {
                let sign = contact.sign(k);
                if sign == 0.0 {
                    continue;
                }
                let wanted = *taken + missing * sign;
                let along = wanted.dot(contact.normal);
                let across = wanted - contact.normal * along;
                let [most_across, most_along] = contact.most;
                let next = contact.normal * along.clamp(-most_along, most_along) + across.clamp_length_max(most_across);
                contact.push(members, next - *taken);
                missing -= (next - *taken) * sign;
                *taken = next;
            }
            turn.may_stop = missing.length() <= RESISTANCE_ROUNDING * whole.length();
            allow |= turn.may_stop;
        }
        allow
    }
}

/// The normal of the only point that bears a member, if its resistance to spinning cannot stop the spin about it.
fn drill(points: &[ResistedContact], member: usize, m: &SolverBody) -> Option<DVec3> {
    let mut contact = points.iter().filter(|p| p.contact.sign(member) != 0.0);
    let (Some(ResistedContact { contact, taken }), None) = (contact.next(), contact.next()) else { return None };
    let n = contact.normal;
    let needed = m.w.dot(n) / n.dot(m.inverse_inertia * n);
    let along = taken.dot(n) * contact.sign(member) - needed;
    (along.abs() > contact.most[1] + RESISTANCE_ROUNDING * needed.abs()).then_some(n)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat3;

    fn ball(w: DVec3) -> SolverBody {
        let inverse_inertia = DMat3::from_diagonal(DVec3::splat(2.5));
        SolverBody {
            inverse_mass: 1.0,
            inverse_inertia,
            v: DVec3::ZERO,
            w,
            bounding_radius: 1.0,
            last: [DVec3::ZERO; 2],
        }
    }

    fn resistance(members: &[SolverBody], most: [f64; 2]) -> RollingResistance {
        let mut resistance = RollingResistance::default();
        let contact = |member| RollingContact { member, other: None, normal: DVec3::Z, most };
        assert!(resistance.gather(members.len(), (0..members.len()).map(contact)));
        resistance.turns.iter_mut().for_each(|turn| turn.is_held = true);
        resistance
    }

    /// What a member has left may be so small that its square is 0. It once became a direction without a length.
    #[test]
    fn a_member_that_has_stopped_long_ago_stays_finite() {
        for tiny in [1e-150, 1e-161, 1e-170, 1e-300, 5e-324] {
            let mut members = [ball(DVec3::X * tiny), ball(DVec3::Y)];
            let mut resistance = resistance(&members, [10.0, 10.0]);
            for _ in 0..3 {
                assert!(resistance.act(&mut members) || members[1].w == DVec3::ZERO);
                assert!(members.iter().all(|m| m.w.is_finite() && m.w.length() <= 1.0), "{tiny:e}: {members:?}");
                members[0].w = DVec3::X * tiny;
            }
        }
    }

    /// A driven capsule that sweeps others turns about its middle. Once, what would stop it was infinite.
    #[test]
    fn a_driven_member_is_not_stopped() {
        let mut members =
            [SolverBody { inverse_mass: 0.0, inverse_inertia: DMat3::ZERO, ..ball(DVec3::Y) }, ball(DVec3::X)];
        let mut resistance = RollingResistance::default();
        let contact = RollingContact { member: 0, other: Some(1), normal: DVec3::Z, most: [10.0, 10.0] };
        assert!(resistance.gather(2, std::iter::once(contact)));
        resistance.turns.iter_mut().for_each(|turn| turn.is_held = true);
        assert!(resistance.act(&mut members));
        assert!(members[0].w == DVec3::Y && members[1].w.length() < 1e-15, "{members:?}");
    }

    /// Without resistance to spinning, a ball that rolls and spins is stopped from rolling and spins on. The twin,
    /// which has to stop as a whole, is one whose spin lies across the normal, beyond its bound: it is not stopped.
    #[test]
    fn a_spin_about_the_normal_does_not_keep_a_ball_rolling() {
        for spin in [1e-12, 1e-3, 50.0] {
            let mut members = [ball(DVec3::new(0.3, -0.2, spin))];
            let mut resistance = resistance(&members, [10.0, 0.0]);
            assert!(resistance.act(&mut members), "{spin}");
            assert!(members[0].w.truncate().length() < 1e-15 && members[0].w.z == spin, "{spin}: {}", members[0].w);
        }
        let mut members = [ball(DVec3::new(0.3, -0.2, 0.0) * 100.0)];
        assert!(!resistance(&members, [10.0, 0.0]).act(&mut members), "{}", members[0].w);
    }
}
