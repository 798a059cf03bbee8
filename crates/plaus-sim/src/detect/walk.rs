//! A ball's way through the broad phase, cell by cell, until it touches something.

use super::sphere::sphere_surface;
use crate::motion::Parabola;
use crate::roots::fall_of_quadratic;
use crate::scenery::{Scenery, Surface};

/// First surface that a sphere touches while approaching it, within `until` seconds of the motion's clock. Surfaces in `skip` (its lasting contacts) do not count.
pub(crate) fn next_surface(scenery: &Scenery, path: &Parabola, radius: f64, skip: &[Surface], until: f64) -> Option<(f64, Surface)> {
    let mut best = None;
    let mut limit = until;
    for k in 0..scenery.planes().len() as u32 {
        consider(scenery, Surface::Plane(k), path, radius, skip, 0.0, &mut limit, &mut best);
    }
    let grid = scenery.grid();
    let mut cell = grid.cell_of(path.x);
    let mut from = 0.0;
    loop {
        let (leaves, next) = exit(scenery, cell, path, from, limit);
        let stop = leaves.min(limit);
        let items = grid.items(cell);
        if !items.is_empty() {
            let swept = path.bounds(from, stop).grown(radius * (1.0 + 1e-9));
            for &item in items {
                if scenery.bounds(item).meets(&swept) {
                    // A hit within this cell bounds the rest of the search, here and beyond.
                    consider(scenery, scenery.surface(item), path, radius, skip, from, &mut limit, &mut best);
                }
            }
        }
        match next {
            Some(neighbour) if leaves < limit => (cell, from) = (neighbour, leaves),
            _ => return best,
        }
    }
}

#[allow(clippy::too_many_arguments)]
#[inline]
fn consider(
    scenery: &Scenery,
    surface: Surface,
    path: &Parabola,
    radius: f64,
    skip: &[Surface],
    from: f64,
    limit: &mut f64,
    best: &mut Option<(f64, Surface)>,
) {
    if skip.contains(&surface) {
        return;
    }
    if let Some(t) = sphere_surface(scenery, surface, path, radius, from, *limit)
        && (t < *limit || best.is_none_or(|(b, s)| t < b || (t == b && surface < s)))
    {
        *limit = t;
        *best = Some((t, surface));
    }
}

/// When a centre leaves a cell after `from`, and into which neighbour; infinite and none where it stays until `limit`.
#[inline]
fn exit(scenery: &Scenery, cell: [usize; 3], path: &Parabola, from: f64, limit: f64) -> (f64, Option<[usize; 3]>) {
    let (low, high) = scenery.grid().walls(cell);
    let (x, v) = (path.after(from), path.velocity_after(from));
    let mut best = (f64::INFINITY, None);
    for k in 0..3 {
        for (wall, sign) in [(low[k], 1.0), (high[k], -1.0)] {
            if !wall.is_finite() {
                continue;
            }
            let c = [sign * (x[k] - wall), sign * v[k], sign * 0.5 * path.a[k]];
            if let Some(dt) = fall_of_quadratic(c, limit - from)
                && from + dt < best.0
            {
                let mut next = cell;
                next[k] = if sign > 0.0 { cell[k] - 1 } else { cell[k] + 1 };
                best = (from + dt, Some(next));
            }
        }
    }
    best
}
