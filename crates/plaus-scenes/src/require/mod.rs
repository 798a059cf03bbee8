//! Requirements on a motion, in any scene: one vocabulary, `[[require]]` in scenario files.
//!
//! ```
//! use plaus_scenes::Scenario;
//!
//! let text = "
//! [world.ball2d]
//! [[require]]
//! impact = { when = { at_s = 0.3, within_ms = 20 } }
//! [[require]]
//! not = { inside = { x_mm = [-500, 0], how = 'sometimes' } }
//! ";
//! let scenario = Scenario::read("inline", text, &[])?;
//! assert_eq!(scenario.require.len(), 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Each kind is one file in `kinds` and one row there. It gives a **margin**, in nats on a stated scale, which is at
//! least 0 if the requirement is met. The state loses as much log density as the margin lacks. All kinds look at a
//! motion through one [`Probe`], at its closed-form pieces, never at samples in time. For a motion known only in part,
//! the same function gives the range in which the margin will end up. So stopping a hopeless simulation early, which
//! [`Stop`] does for every scene, cannot disagree with judging a whole one.
//!
//! Places are in millimetres along the axes of the scenario files, z up; times are in seconds of the animation.

mod accents;
mod agree;
mod aim;
mod answer;
mod asked;
mod begun;
mod cast;
mod claim;
mod ended;
mod event;
mod extreme;
mod judge;
mod kinds;
mod looks;
mod missed;
mod place;
mod probe;
mod score;
mod sides;
mod sight;
mod spot;
mod stop;
mod tally;
mod timed;
mod ways;
mod when;

pub use accents::Accents;
pub(crate) use agree::agree;
pub use aim::{Aim, End, Up, Zone};
pub use answer::{Answer, Judged};
pub use asked::Asked;
pub use begun::Begun;
pub use cast::Cast;
pub use ended::{Ended, Ends};
pub use event::{Event, What};
pub use extreme::Extreme;
pub use judge::{Candidate, Judge};
pub use kinds::*;
pub use missed::Missed;
pub use probe::Probe;
pub use score::{Band, FAR, Mark, Reach, Span};
pub use sides::Axis;
pub(crate) use sides::upper_face;
pub(crate) use stop::Kept;
pub use stop::{Stop, Stops};
pub use tally::{Clause, Tally, each_of_prior};
pub use timed::Timed;
pub use when::{When, Window};

/// How deep requirements may be nested.
pub const DEEPEST: usize = 8;
