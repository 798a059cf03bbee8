//! A ball's path through the broad phase, cell by cell, until it touches something.

use super::sphere::{Stretch, sphere_surface};
use crate::motion::{Course, Parabola};
use crate::roots::fall_of_quadratic;
use crate::scenery::{Aabb, Probe, Scenery, Surface, lesser};
use glam::DVec3;

/// First surface that a sphere touches while approaching it, within `until` seconds of the motion's clock. Surfaces in
/// `skip` (its lasting contacts) do not count.
pub(crate) fn next_surface(
    scenery: &Scenery,
    path: &Parabola,
    radius: f64,
    skip: &[Surface],
    until: f64,
) -> Option<(f64, Surface)> {
    let grid = scenery.grid();
    // A little more than the radius, so that rounding cannot hide a surface that touches.
    let near = radius * radius * (1.0 + 1e-9);
    let (course, mut cell) = (Course::new(path), grid.cell_of(path.x));
    let stretch = Stretch { path, from: 0.0, x: path.x, v: path.v };
    let mut search = Search { scenery, radius, skip, stretch, limit: until, best: None };
    // From this time on nothing matters: it is the first touch that is known.
    let mut limit = until;
    // A coordinate that moves with its acceleration never turns again. With that knowledge, rounding cannot send the
    // walk to and fro.
    let mut onward = [0.0; 3];
    loop {
        let (walls, from, x) = (grid.walls(cell), search.stretch.from, search.stretch.x);
        let way = course.bounds(from, x, limit);
        let stays = way.min.cmpgt(walls.0).all() && way.max.cmplt(walls.1).all();
        let (leaves, next) =
            if stays { (f64::INFINITY, None) } else { exit(walls, &way, &search.stretch, limit, &onward) };
        let items = grid.items(cell);
        if !items.is_empty() {
            search.limit = lesser(leaves, limit);
            let swept = if stays { way } else { course.bounds(from, x, search.limit) };
            let probe = Probe::new(&swept.grown(radius * (1.0 + 1e-8)));
            for &item in items {
                // The first comparison rules out most of them.
                if scenery.may_meet(item, &probe) && scenery.bounds(item).distance_squared(&swept) <= near {
                    // A hit within this cell bounds the rest of the search, here and beyond. A surface hit beyond this
                    // cell is listed there.
                    search.consider(scenery.surface(item));
                }
            }
            limit = search.best.map_or(limit, |(time, _)| limit.min(time));
        }
        match next {
            Some((axis, way)) if leaves < limit => {
                cell[axis] = if way > 0.0 { cell[axis] + 1 } else { cell[axis] - 1 };
                onward[axis] = if path.a[axis] * way >= 0.0 { way } else { 0.0 };
                search.stretch = Stretch::new(path, leaves);
            }
            _ => return search.best,
        }
    }
}

/// A search for the first surface of a stretch.
struct Search<'s> {
    scenery: &'s Scenery,
    radius: f64,
    skip: &'s [Surface],
    stretch: Stretch<'s>,
    /// A touch later than this many seconds after the motion's clock does not count.
    limit: f64,
    best: Option<(f64, Surface)>,
}

impl Search<'_> {
    /// Notes a surface if it is touched first. Not inlined, so that the scan over nearby things keeps its numbers in
    /// registers.
    #[inline(never)]
    fn consider(&mut self, surface: Surface) {
        if self.skip.contains(&surface) {
            return;
        }
        if let Some(t) = sphere_surface(self.scenery, surface, &self.stretch, self.radius, self.limit)
            && (t < self.limit || self.best.is_none_or(|(b, s)| t < b || (t == b && surface < s)))
        {
            self.limit = t;
            self.best = Some((t, surface));
        }
    }
}

/// When a centre leaves a cell during a stretch, along which axis and in which direction; infinite and none if it stays
/// until `limit`. `way` is the box that holds the centre until then.
#[inline]
fn exit(
    (low, high): (DVec3, DVec3),
    way: &Aabb,
    stretch: &Stretch<'_>,
    limit: f64,
    onward: &[f64; 3],
) -> (f64, Option<(usize, f64)>) {
    let &Stretch { path, from, x, v } = stretch;
    let mut best = (f64::INFINITY, None);
    for k in 0..3 {
        for (wall, way, crosses) in [(low[k], -1.0, way.min[k] <= low[k]), (high[k], 1.0, way.max[k] >= high[k])] {
            if !crosses || onward[k] == -way {
                continue;
            }
            let c = [way * (wall - x[k]), -way * v[k], -way * 0.5 * path.a[k]];
            if let Some(dt) = fall_of_quadratic(c, limit - from)
                && from + dt < best.0
            {
                best = (from + dt, Some((k, way)));
            }
        }
    }
    best
}
