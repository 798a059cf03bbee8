//! Impact laws: velocities before to velocities after, and nothing else. They know no time, no shape and no queue.
//!
//! **Impacts at one instant** are resolved pair by pair, in the order of their times, and where these are equal in an
//! order that knows no labels of marbles: each as if the others were not there, again and again until nothing
//! approaches. A row of touching equal balls with e = 1 then hands on what comes in: of Newton's cradle as many leave
//! as come in, and a chain of masses 1, 2, 4, 8, 16 goes as if there were gaps. That is the limit of stiff contacts of
//! which each is over before the next begins; other laws (all contacts at once) answer otherwise, and balls of steel
//! lie between. Source: Ivanov, "On multiple impact", J. Appl. Math. Mech. 59 (1995), for both limits; Ceanga &
//! Hurmuzlu, "A new look at an old problem: Newton's cradle", J. Appl. Mech. 68 (2001), for measured chains. What
//! remains of impacts that never end in finite time (e < 1) becomes lasting contact, and that is solved at once.

mod path;
mod sphere;
mod stronge;

pub use sphere::{Impulse, Touch, sphere_impact};
pub use stronge::{ContactMatrix, stronge_impulse};
