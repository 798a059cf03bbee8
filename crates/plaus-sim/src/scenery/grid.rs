//! Broad phase for static scenery: a uniform grid over the space of ball centres.
//!
//! A feature is listed in each cell from which the largest ball can touch its box, grown by how far it may be moved.
//! The outermost cells reach to infinity.

use crate::scenery::Aabb;
use glam::DVec3;

/// Maximum number of cells along one axis; bounds memory at about 2 million cells.
const MOST_CELLS: f64 = 128.0;

/// Side of a cell over the mean side of a grown box. Default 0.15: smaller cells list less each but are crossed more
/// often.
const CELL: f64 = 0.15;

/// Lists of features per cell.
#[derive(Debug, Clone)]
pub(crate) struct Grid {
    origin: DVec3,
    inverse: f64,
    size: f64,
    counts: [usize; 3],
    /// Highest index of a cell along each axis.
    last: [i32; 3],
    /// Walls between cells along each axis, the outermost infinite.
    walls: [Vec<f64>; 3],
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl Grid {
    /// A grid over boxes for balls of radius up to `reach`. `may_touch` can rule out that a ball whose centre is in a
    /// box touches an item, beyond what boxes say. Endless boxes may be listed in any cell and have no part in the
    /// choice of cells.
    pub(crate) fn new(boxes: &[Aabb], reach: f64, may_touch: impl Fn(u32, &Aabb) -> bool) -> Self {
        let listed = || boxes.iter().filter(|b| b.min.x <= b.max.x && b.min.is_finite()).map(|b| b.grown(reach));
        let all = listed().fold(Aabb::EMPTY, Aabb::union);
        let count = listed().count();
        let extent = if count == 0 { DVec3::ZERO } else { all.max - all.min };
        let widest = extent.max_element();
        let mean = listed().map(|b| (b.max - b.min).max_element()).sum::<f64>() / (count.max(1) as f64);
        let size = (CELL * mean).max(widest / MOST_CELLS).max(f64::MIN_POSITIVE);
        let counts = extent.to_array().map(|e| ((e / size).ceil()).clamp(1.0, MOST_CELLS) as usize);
        let origin = if count == 0 { DVec3::ZERO } else { all.min };
        let walls = std::array::from_fn(|k| {
            let inner = (1..counts[k]).map(|i| origin[k] + i as f64 * size);
            std::iter::once(f64::NEG_INFINITY).chain(inner).chain([f64::INFINITY]).collect()
        });
        let (starts, items) = (Vec::new(), Vec::new());
        let last = counts.map(|count| count as i32 - 1);
        let mut grid = Self { origin, inverse: 1.0 / size, size, counts, last, walls, starts, items };
        grid.fill(boxes, reach, may_touch);
        grid
    }

    fn fill(&mut self, boxes: &[Aabb], reach: f64, may_touch: impl Fn(u32, &Aabb) -> bool) {
        // A little more than the reach, for rounding at the cells' walls.
        let reach = reach * (1.0 + 1e-6);
        let mut pairs: Vec<(u32, u32)> = Vec::new();
        for (k, b) in boxes.iter().enumerate().filter(|(_, b)| b.min.x <= b.max.x) {
            let around = b.grown(reach);
            let (low, high) = (self.cell_of(around.min), self.cell_of(around.max));
            for z in low[2]..=high[2] {
                for y in low[1]..=high[1] {
                    for x in low[0]..=high[0] {
                        let (min, max) = self.walls([x, y, z]);
                        let cell = Aabb { min, max };
                        if cell.distance_squared(b) <= reach * reach
                            && may_touch(k as u32, &cell.grown(1e-6 * self.size))
                        {
                            pairs.push((self.index([x, y, z]) as u32, k as u32));
                        }
                    }
                }
            }
        }
        pairs.sort_unstable();
        let cells = self.counts[0] * self.counts[1] * self.counts[2];
        self.starts = (0..=cells).map(|cell| pairs.partition_point(|&(c, _)| (c as usize) < cell) as u32).collect();
        self.items = pairs.into_iter().map(|(_, k)| k).collect();
    }

    #[inline]
    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.counts[1] + y) * self.counts[0] + x
    }

    /// The cell of a ball's centre.
    #[inline]
    pub(crate) fn cell_of(&self, x: DVec3) -> [usize; 3] {
        let scaled = ((x - self.origin) * self.inverse).to_array();
        // A float-to-integer cast saturates. Anything below goes to the first cell.
        std::array::from_fn(|k| (scaled[k] as i32).clamp(0, self.last[k]) as usize)
    }

    /// The features listed in a cell, in ascending order.
    #[inline]
    pub(crate) fn items(&self, cell: [usize; 3]) -> &[u32] {
        let k = self.index(cell);
        &self.items[self.starts[k] as usize..self.starts[k + 1] as usize]
    }

    /// Lower and upper walls of a cell; infinite if it is outermost.
    #[inline]
    pub(crate) fn walls(&self, cell: [usize; 3]) -> (DVec3, DVec3) {
        let wall = |k: usize, beyond: usize| self.walls[k][cell[k] + beyond];
        (DVec3::new(wall(0, 0), wall(1, 0), wall(2, 0)), DVec3::new(wall(0, 1), wall(1, 1), wall(2, 1)))
    }
}
