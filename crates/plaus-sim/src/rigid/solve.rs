//! Impulses of lasting contacts, found together: Newton's rule, or block Gauss–Seidel whose blocks obey Coulomb's law
//! exactly.

use super::coulomb::{Contact, Hold, Look, Member};
use super::newton::Newton;

/// Rounds over the direction of slip per visit; the sweeps around it do the rest.
const ROUNDS: u32 = 1;

/// The same if there is no other contact: the direction is then found once and for all.
const ROUNDS_ALONE: u32 = 6;

/// Least angle in radians that is asked for; rounding is smaller.
const LEAST_TURN: f64 = 1e-9;

/// When sweeps end.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Enough {
    /// Change of velocity in m/s.
    speed: f64,
    /// Angle in radians by which the direction of a slip may be off.
    turn: f64,
}

impl Enough {
    /// Sweeps may end at changes of `speed`, and the velocities that contacts have to take up are of the order of
    /// `push`, both in m/s. If the direction of friction is off by a third of their ratio, the velocity is off by less
    /// than `speed`.
    pub(crate) fn new(speed: f64, push: f64) -> Self {
        Self { speed, turn: (speed / (3.0 * push)).max(LEAST_TURN) }
    }
}

/// How much finer Newton's rule is solved than sweeps would be: it takes one more round at most. Default 1e-3.
const NEWTON_FINER: f64 = 1e-3;

/// Rounds that a large heap always gets, whatever the preset. Default 60: with fewer, the lowest bodies sink.
const FEWEST: u32 = 60;

/// Rounds for a crowd of bodies with faces. Default 20: what they leave is found in the next step, which starts from
/// their impulses; with 60, steps cost twice as much and end as deep.
const ROUNDS_IN_CROWDS: u32 = 20;

/// Number of the preset's sweeps that are made where Newton's rule fails, because friction wedges bodies. Default 60.
const SWEEPS_AFTER: u32 = 60;

/// Solves all contacts until a round changes no body's velocity by more than `enough` says. It uses Newton's rule;
/// where that does not converge because friction wedges bodies, it makes at most `most` sweeps. Returns whether it
/// converged.
pub(crate) fn solve(
    contacts: &mut [Contact],
    members: &mut [Member],
    newton: &mut Newton,
    enough: Enough,
    most: u32,
) -> bool {
    if let [only] = contacts {
        let look = Look { turn: enough.turn, rounds: ROUNDS_ALONE };
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
    if newton.gives_way && contacts.iter().any(Contact::can_give_way) {
        give_way(contacts, members);
    }
    if newton.in_rounds {
        return newton.gradients.solve(contacts, members, enough.speed, most.max(FEWEST));
    }
    if newton.in_crowd {
        // Rounds do the same where faces make the problem hard, in a tenth of the time.
        if !newton.is_hard && newton.solve(contacts, members, NEWTON_FINER * enough.speed, enough.speed) {
            contacts.iter_mut().for_each(Contact::note_solved);
            return true;
        }
        return newton.gradients.solve(contacts, members, enough.speed, ROUNDS_IN_CROWDS);
    }
    let fine = NEWTON_FINER * enough.speed;
    let mut is_solved = newton.solve(contacts, members, fine, enough.speed);
    if contacts.iter().any(Contact::is_overpressed) {
        newton.gives_way = true;
        give_way(contacts, members);
        is_solved = newton.solve(contacts, members, fine, enough.speed);
    }
    if !is_solved && contacts.iter().any(|c| c.hold != Hold::Coulomb || c.press.is_some()) {
        // Joints and what is in the way may leave no room for a push out of overlaps.
        give_way(contacts, members);
        contacts.iter_mut().for_each(|c| c.target = c.target.min(0.0));
        is_solved = newton.solve(contacts, members, fine, enough.speed);
    }
    if is_solved {
        for c in contacts.iter_mut() {
            c.note_solved();
        }
        return true;
    }
    sweep(contacts, members, enough, most.min(SWEEPS_AFTER))
}

/// Lets contacts give way where driven bodies press, all from no impulse on.
fn give_way(contacts: &mut [Contact], members: &mut [Member]) {
    contacts.iter_mut().for_each(|c| c.give_way(members));
}

/// Sweeps up and down over all contacts until a round changes no body's velocity by more than `enough` says, at most
/// `most` times. Returns whether it converged.
///
/// Velocities decide, not impulses: where contacts are redundant, impulses that cancel each other may go on growing for
/// ever.
pub(super) fn sweep(contacts: &mut [Contact], members: &mut [Member], enough: Enough, most: u32) -> bool {
    let Enough { speed: enough, turn } = enough;
    let look = Look { turn, rounds: ROUNDS };
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
        let quiet = |m: &Member| {
            (m.v - m.last[0]).length_squared() <= enough * enough
                && (m.w - m.last[1]).length_squared() * m.reach * m.reach <= enough * enough
        };
        if members.iter().all(quiet) {
            return true;
        }
    }
    false
}
