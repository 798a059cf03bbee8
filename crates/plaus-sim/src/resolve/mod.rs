//! Impact laws: velocities before to velocities after, and nothing else. They know no time, no shape and no queue.
//!
//! **Impacts at one instant** are resolved pair by pair in the order of their times; equal times are ordered by a rule
//! that knows no labels of marbles. Each impact is resolved as if the others were absent, again and again until nothing
//! approaches. A row of touching equal balls with e = 1 then passes on what comes in: from Newton's cradle as many
//! balls leave as come in, and a chain of masses 1, 2, 4, 8, 16 behaves as if there were gaps. This is the limit of
//! stiff contacts each of which ends before the next begins. Other laws (all contacts at once) give other answers, and
//! steel balls lie in between. Source: Ivanov, "On multiple impact", J. Appl. Math. Mech. 59 (1995), for both limits;
//! Ceanga & Hurmuzlu, "A new look at an old problem: Newton's cradle", J. Appl. Mech. 68 (2001), for measured chains.
//! Sequences of impacts that would not end in finite time (e < 1) become lasting contact, which is solved at once.

mod path;
mod sphere;
mod stronge;

pub use sphere::{Impulse, Touch, sphere_impact};
pub use stronge::{ContactMatrix, stronge_impulse};
