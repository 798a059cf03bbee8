//! First times of contact: where a gap closes while it is shrinking.
//!
//! The rule is that of Bannerman, Strobl, Formella & Pöschel, "Stable algorithm for event detection in event-driven
//! particle dynamics" (2014, arXiv 1211.6718): an event is a time at which the gap is **not positive and falling**.
//! Bodies that overlap by a rounding error but move apart are not an event; the search continues from the gap's next
//! turning point. So rounding can neither let a body tunnel nor make it hit twice.
//!
//! Roots are bracketed between the roots of the derivative, which are bracketed between those of the second derivative,
//! and refined by Newton's method kept inside its bracket. No tolerance is absolute: scaling all lengths by 4 and times
//! by 2 scales every result exactly.

mod bracket;
mod quadratic;
mod quartic;

pub use bracket::refine;
pub(crate) use quadratic::earliest;
pub use quadratic::{fall_of_quadratic, roots_of_quadratic};
pub(crate) use quartic::first_fall_of_quartic;
pub use quartic::{fall_of_quartic, falls_of_quartic, squared_distance};
