//! Random fields over a table: uniform cubic tensor-product b-splines. Their control points are made only when
//! something examines them.
//!
//! Over cell `(i, j)` the value is `Σ B_a(u) B_b(v) P(i+a, j+b)`, `a, b = 0…3`, with the uniform cubic basis
//! `B = ((1−u)³, 3u³−6u²+4, −3u³+3u²+3u+1, u³)/6`; it is twice continuously differentiable and lies within the hull of
//! its 16 control points. The caller gives a function for the control points. It is called once per point, and only for
//! points of cells that are examined, so memory grows with what is touched, not with the table. A value that is not
//! finite, or is outside the promised range, is kept as a [fault](Spline::fault).
//!
//! Source: de Boor, *A Practical Guide to Splines* (2001), ch. IX; bounds by conversion to Bernstein form (Farin,
//! *Curves and Surfaces*, §8).
//!
//! ```
//! use plaus_sim::field::{Spline, Grid};
//! let height = Spline::new("height", Grid { origin: [0.0, 0.0], spacing: 0.01 }, [-0.002, 0.002], |i, j| 1e-3 * ((i + 2 * j) % 2) as f64).unwrap();
//! let here = height.at(0.005, 0.005);
//! assert!(here.value.abs() <= 0.002 && height.touched_count() == 16);
//! ```

mod cell;
mod lookup;
mod spline;

pub use cell::{Bounds, Sample};
pub use spline::{Grid, MOST_CELLS, Points, Spline};
