//! Impact laws: velocities before to velocities after, and nothing else. They know no time, no shape and no queue.
//!
//! **Impacts at one instant** come in rounds. A round has all pairs that touch and approach when it begins; those that
//! share a body are resolved at once, by Newton's and Coulomb's laws (Moreau), so that no order plays a part and a
//! mirror plane is kept. Pairs that touch without approach are no part of a round; those that it drives together are
//! the next one, again and again until nothing approaches. A row of touching equal balls with e = 1 then passes on what
//! comes in: from Newton's cradle as many balls leave as come in, and a chain of masses 1, 2, 4, 8, 16 behaves as if
//! there were gaps. This is the limit of stiff contacts each of which ends before the next begins. Other laws (all
//! contacts at once, those without approach too) give other answers, and steel balls lie in between. Source: Ivanov,
//! "On multiple impact", J. Appl. Math. Mech. 59 (1995), for both limits; Ceanga & Hurmuzlu, "A new look at an old
//! problem: Newton's cradle", J. Appl. Mech. 68 (2001), for measured chains. Sequences of impacts that would not end in
//! finite time (e < 1) become lasting contact, which is solved at once.

mod path;
mod sphere;
mod spheres;
mod stronge;

pub use sphere::{Impulse, Touch, sphere_impact};
pub use spheres::{Struck, spheres_at_once};
pub(crate) use stronge::stronge_impulse_with_grip;
pub use stronge::{ContactMatrix, stronge_impulse};
