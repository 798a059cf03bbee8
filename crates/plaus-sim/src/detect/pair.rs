//! Two spheres on parabolas.

use crate::motion::Parabola;
use crate::roots::{first_fall_of_quartic, squared_distance};

/// First time in `[from, until]` (absolute; both motions valid there, and until `horizon`) at which two spheres touch
/// while approaching; `reach` is the sum of their radii.
///
/// The time depends only on the two motions: the search begins at the later of their clocks, and covers all of the time
/// in which both are valid. So if a pair is examined again, because some other expected event did not happen, the time
/// found is the same to the last bit.
#[inline]
pub(crate) fn sphere_pair(a: &Parabola, b: &Parabola, reach: f64, [from, until, horizon]: [f64; 3]) -> Option<f64> {
    let start = a.t.max(b.t);
    let (da, db) = (start - a.t, start - b.t);
    let p = a.after(da) - b.after(db);
    let v = a.velocity_after(da) - b.velocity_after(db);
    let c = squared_distance(p, v, a.a - b.a, reach);
    // A little more than until: a touch at exactly that time counts, however it is rounded.
    let limit = until - start + 4.0 * f64::EPSILON * until;
    // A touch before `from` has been dealt with; one that rounding puts there is due now.
    let time = (start + first_fall_of_quartic(&c, limit, horizon - start)?).max(from);
    (time <= until).then_some(time)
}
