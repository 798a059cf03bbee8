//! Whether contacts can hold bodies that wedge each other.
//!
//! There, Coulomb's law may allow rest beside other motions, and Newton's rule may find neither. This asks for rest
//! only. Without slip there is no shift (`newton.rs`), so impulses of the convex problem without shifts obey the law if
//! they leave no motion. They are those that leave the least energy: if they leave some, nothing can hold the bodies.

use super::contact_constraint::{ContactConstraint, SolverBody};
use super::newton::Newton;
use crate::rigid::tolerances::{
    COMPLIANCE_RATIO, CONVEX_ACCURACY, EQUILIBRIUM_PROBLEMS, EQUILIBRIUM_PROGRESS, FIRST_COMPLIANCE, LEAST_COMPLIANCE,
    MAX_NEWTON_BODIES,
};

impl Newton {
    /// Whether there are impulses within the cones of friction that leave no member faster than `most`.
    pub(crate) fn hold(&mut self, contacts: &mut [ContactConstraint], members: &mut [SolverBody], most: f64) -> bool {
        if members.len() > MAX_NEWTON_BODIES {
            return false;
        }
        self.order(contacts, members);
        self.shifts.clear();
        self.shifts.resize(contacts.len(), 0.0);
        let (mut compliance, mut before) = (FIRST_COMPLIANCE, f64::INFINITY);
        for _ in 0..EQUILIBRIUM_PROBLEMS {
            if !self.convex_relaxation(contacts, members, compliance, CONVEX_ACCURACY * most) {
                return false;
            }
            let left = members.iter().map(SolverBody::fastest).fold(0.0, f64::max);
            if left <= most {
                return true;
            }
            if left > EQUILIBRIUM_PROGRESS * before {
                return false;
            }
            (before, compliance) = (left, (COMPLIANCE_RATIO * compliance).max(LEAST_COMPLIANCE));
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigid::solver::contact_constraint::response;
    use glam::{DMat3, DVec3};
    use plaus_dist::math;

    /// A ladder on a floor and against a wall, with its weight's impulse over 10 ms.
    fn holds(angle: f64, friction: [f64; 2]) -> bool {
        let (s, c) = math::sin_cos(angle);
        let (inverse_mass, half) = (0.25, 1.5);
        let along = DVec3::new(-c, 0.0, s);
        let turns = DMat3::from_diagonal(DVec3::splat(3.0 * inverse_mass / (half * half)));
        let kick = -DVec3::Z * 0.0981;
        let ladder = SolverBody {
            inverse_mass,
            inverse_inertia: turns,
            v: kick,
            w: DVec3::ZERO,
            bounding_radius: half,
            last: [kick; 2],
        };
        let contact = |arm: DVec3, normal: DVec3, friction: f64| {
            let k = response(inverse_mass, &turns, arm);
            ContactConstraint::new(0, None, [arm, DVec3::ZERO], normal, friction, k)
        };
        let mut contacts =
            [contact(along * -half, DVec3::Z, friction[0]), contact(along * half, DVec3::X, friction[1])];
        Newton::default().hold(&mut contacts, &mut [ladder], 1e-6)
    }

    /// A uniform ladder can stand if `tan θ ≥ (1 − µ ν)/(2 µ)` with the friction µ of the floor and ν of the wall: the
    /// lines of force at the edges of both cones then meet beyond the line of the weight. A test that took the bound of
    /// a wall without friction, `1/(2 µ)`, would refuse the ladders a hundredth above the true bound.
    #[test]
    fn a_ladder_stands_up_to_the_bound_of_statics() {
        for (floor, wall) in [(0.3, 0.2), (0.5, 0.5), (0.2, 0.6), (0.7, 0.1), (0.4, 0.0)] {
            let least = math::atan((1.0 - floor * wall) / (2.0 * floor));
            assert!(holds(least + 0.01, [floor, wall]), "{floor} {wall}");
            assert!(!holds(least - 0.01, [floor, wall]), "{floor} {wall}");
            let smooth = math::atan(1.0 / (2.0 * floor));
            assert!(wall == 0.0 || smooth > least + 0.01, "the twin would not be caught");
        }
    }
}
