//! Impulses of lasting contacts, found together: Newton's rule, or block Gauss–Seidel whose blocks obey Coulomb's law
//! exactly.

mod block_lu;
pub(super) mod contact_constraint;
pub(super) mod force_limit;
mod friction_cone;
pub(super) mod newton;
pub(super) mod nncg;
pub(super) mod rolling_resistance;
pub(super) mod slip;
mod static_equilibrium;

use contact_constraint::{ConstraintKind, ContactConstraint, SlipSearch, SolverBody};
use newton::Newton;
use slip::Stiction;

use super::tolerances::{
    LEAST_NNCG_ROUNDS, LEAST_SLIP_TURN, NEWTON_ACCURACY, SLIP_ROUNDS, SLIP_ROUNDS_ALONE, SWEEPS_AFTER_NEWTON,
};

/// When sweeps end.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SolverTolerance {
    /// Change of velocity in m/s.
    speed: f64,
    /// Angle in radians by which the direction of a slip may be off.
    turn: f64,
}

impl SolverTolerance {
    /// Sweeps may end at changes of `speed`, and the velocities that contacts have to take up are of the order of
    /// `push`, both in m/s. If the direction of friction is off by a third of their ratio, the velocity is off by less
    /// than `speed`.
    pub(crate) fn new(speed: f64, push: f64) -> Self {
        Self { speed, turn: (speed / (3.0 * push)).max(LEAST_SLIP_TURN) }
    }
}

/// Solves all contacts until a round changes no body's velocity by more than `enough` says; returns whether it
/// converged.
///
/// Surfaces that do not slide may have a larger coefficient of friction than those that do. Which one a contact has is
/// decided here: the larger one if it does not slip before, or if its slip would turn round; the smaller one again if
/// it slips even so.
pub(crate) fn solve(
    contacts: &mut [ContactConstraint],
    members: &mut [SolverBody],
    newton: &mut Newton,
    enough: SolverTolerance,
    most: u32,
) -> bool {
    if contacts.iter().all(|c| c.stiction.is_none()) {
        return solve_as_is(contacts, members, newton, enough, most);
    }
    let still = |s: &Stiction| s.still.max(enough.speed);
    for c in contacts.iter_mut() {
        if let Some(s) = &c.stiction {
            c.friction = s.friction[usize::from(s.slip.length() <= still(s))];
        }
    }
    let mut is_solved = solve_as_is(contacts, members, newton, enough, most);
    for may_stick in [true, false] {
        let mut changes = false;
        for c in contacts.iter_mut() {
            let Some(s) = c.stiction else { continue };
            let slip = c.slip(members);
            let [sliding, sticking] = s.friction;
            let slips = slip.length() > still(&s);
            if may_stick && c.friction == sliding && slips && slip.dot(s.slip) <= 0.0 {
                (c.friction, c.held_slip) = (sticking, None);
                changes = true;
            } else if !may_stick && c.friction == sticking && slips {
                c.friction = sliding;
                changes = true;
            }
        }
        if changes {
            is_solved = solve_as_is(contacts, members, newton, enough, most);
        }
    }
    for c in contacts.iter_mut() {
        let slip = c.slip(members);
        if let Some(s) = &mut c.stiction {
            s.slip_after = slip;
        }
    }
    is_solved
}

/// Solves all contacts, each with its present coefficient of friction. It uses Newton's rule; where that does not
/// converge because friction wedges bodies, it makes at most `most` sweeps. Returns whether it converged.
fn solve_as_is(
    contacts: &mut [ContactConstraint],
    members: &mut [SolverBody],
    newton: &mut Newton,
    enough: SolverTolerance,
    most: u32,
) -> bool {
    if let [only] = contacts {
        let look = SlipSearch { turn: enough.turn, rounds: SLIP_ROUNDS_ALONE };
        for _ in 0..4 {
            // When its slip's direction is right, nothing is left to change.
            if only.solve(members, look) <= enough.speed || only.is_right {
                return true;
            }
        }
        return false;
    }
    if contacts.is_empty() {
        return true;
    }
    if newton.gives_way && contacts.iter().any(ContactConstraint::can_give_way) {
        give_way(contacts, members);
    }
    if newton.in_rounds {
        return newton.nncg.solve(contacts, members, enough.speed, most.max(LEAST_NNCG_ROUNDS));
    }
    if newton.is_time_stepped {
        // Rounds do the same where faces make the problem hard, in a tenth of the time.
        if !newton.is_hard && newton.solve(contacts, members, NEWTON_ACCURACY * enough.speed, enough.speed) {
            contacts.iter_mut().for_each(ContactConstraint::note_solved);
            return true;
        }
        return newton.nncg.solve(contacts, members, enough.speed, newton.rounds_with_faces);
    }
    let fine = NEWTON_ACCURACY * enough.speed;
    let mut is_solved = newton.solve(contacts, members, fine, enough.speed);
    if contacts.iter().any(ContactConstraint::is_overpressed) {
        newton.gives_way = true;
        give_way(contacts, members);
        is_solved = newton.solve(contacts, members, fine, enough.speed);
    }
    if !is_solved && contacts.iter().any(|c| c.hold != ConstraintKind::Coulomb || c.force_limit.is_some()) {
        // Joints and what is in the way may leave no room for a push out of overlaps.
        give_way(contacts, members);
        contacts.iter_mut().filter(|c| c.pushes_out()).for_each(|c| c.target = 0.0);
        is_solved = newton.solve(contacts, members, fine, enough.speed);
    }
    if is_solved {
        for c in contacts.iter_mut() {
            c.note_solved();
        }
        return true;
    }
    gauss_seidel(contacts, members, enough, most.min(SWEEPS_AFTER_NEWTON))
}

/// Lets contacts give way where driven bodies press, all from no impulse on.
fn give_way(contacts: &mut [ContactConstraint], members: &mut [SolverBody]) {
    contacts.iter_mut().for_each(|c| c.give_way(members));
}

/// Sweeps up and down over all contacts until a round changes no body's velocity by more than `enough` says, at most
/// `most` times. Returns whether it converged.
///
/// Velocities decide, not impulses: where contacts are redundant, impulses that cancel each other may go on growing for
/// ever.
pub(super) fn gauss_seidel(
    contacts: &mut [ContactConstraint],
    members: &mut [SolverBody],
    enough: SolverTolerance,
    most: u32,
) -> bool {
    let SolverTolerance { speed: enough, turn } = enough;
    let look = SlipSearch { turn, rounds: SLIP_ROUNDS };
    for round in 0..most {
        for m in members.iter_mut() {
            m.last = [m.v, m.w];
        }
        // The first contact was the last one of the previous pass.
        for c in contacts.iter_mut().skip(usize::from(round > 0)) {
            c.solve(members, look);
        }
        for c in contacts.iter_mut().rev().skip(1) {
            c.solve(members, look);
        }
        let quiet = |m: &SolverBody| {
            (m.v - m.last[0]).length_squared() <= enough * enough
                && (m.w - m.last[1]).length_squared() * m.bounding_radius * m.bounding_radius <= enough * enough
        };
        if members.iter().all(quiet) {
            return true;
        }
    }
    false
}
