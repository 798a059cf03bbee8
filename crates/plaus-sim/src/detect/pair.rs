//! Two spheres on parabolas.

use crate::motion::Parabola;
use crate::roots::{fall_of_quartic, squared_distance};

/// First time in `[from, until]` (absolute; both motions valid there) at which two spheres touch while approaching; `reach` is the sum of their radii.
#[inline]
pub(crate) fn sphere_pair(a: &Parabola, b: &Parabola, reach: f64, from: f64, until: f64) -> Option<f64> {
    let (da, db) = (from - a.t, from - b.t);
    let p = a.after(da) - b.after(db);
    let v = a.velocity_after(da) - b.velocity_after(db);
    let c = squared_distance(p, v, a.a - b.a, reach);
    fall_of_quartic(&c, 0.0, until - from).map(|dt| from + dt)
}
