//! Broad phase for what does not move: a uniform grid over the space of ball centres.
//!
//! A feature is listed in each cell that its box, grown by the largest radius and the mesh's margin, touches. The outermost cells reach to infinity.

use crate::scenery::Aabb;
use glam::DVec3;

/// Most cells along one axis; bounds memory at about 2 million cells.
const MOST_CELLS: f64 = 128.0;

/// Side of a cell over the mean side of a grown box. Default 0.25: smaller cells list less each but are crossed more often.
const CELL: f64 = 0.25;

/// Lists of features per cell.
#[derive(Debug, Clone)]
pub(crate) struct Grid {
    origin: DVec3,
    inverse: f64,
    size: f64,
    counts: [usize; 3],
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl Grid {
    /// A grid over boxes, which are grown by `reach`.
    pub(crate) fn new(boxes: &[Aabb], reach: f64) -> Self {
        let boxes: Vec<Aabb> = boxes.iter().map(|b| b.grown(reach)).collect();
        let listed = || boxes.iter().filter(|b| b.min.x <= b.max.x);
        let all = listed().fold(Aabb::EMPTY, |a, b| a.union(*b));
        let count = listed().count();
        let extent = if count == 0 { DVec3::ZERO } else { all.max - all.min };
        let widest = extent.max_element();
        let mean = listed().map(|b| (b.max - b.min).max_element()).sum::<f64>() / (count.max(1) as f64);
        let size = (CELL * mean).max(widest / MOST_CELLS).max(f64::MIN_POSITIVE);
        let counts = extent.to_array().map(|e| ((e / size).ceil()).clamp(1.0, MOST_CELLS) as usize);
        let origin = if count == 0 { DVec3::ZERO } else { all.min };
        let mut grid = Self { origin, inverse: 1.0 / size, size, counts, starts: Vec::new(), items: Vec::new() };
        grid.fill(&boxes);
        grid
    }

    fn fill(&mut self, boxes: &[Aabb]) {
        let cells = self.counts[0] * self.counts[1] * self.counts[2];
        let mut counts = vec![0_u32; cells + 1];
        for b in boxes {
            self.each_cell(b, |cell| counts[cell + 1] += 1);
        }
        for k in 0..cells {
            counts[k + 1] += counts[k];
        }
        let mut next = counts.clone();
        let mut items = vec![0; counts[cells] as usize];
        for (k, b) in boxes.iter().enumerate() {
            self.each_cell(b, |cell| {
                items[next[cell] as usize] = k as u32;
                next[cell] += 1;
            });
        }
        self.starts = counts;
        self.items = items;
    }

    fn each_cell(&self, b: &Aabb, mut visit: impl FnMut(usize)) {
        if b.min.x > b.max.x {
            return;
        }
        let (low, high) = (self.cell_of(b.min), self.cell_of(b.max));
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                for x in low[0]..=high[0] {
                    visit(self.index([x, y, z]));
                }
            }
        }
    }

    #[inline]
    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.counts[1] + y) * self.counts[0] + x
    }

    /// The cell of a ball's centre.
    #[inline]
    pub(crate) fn cell_of(&self, x: DVec3) -> [usize; 3] {
        let scaled = ((x - self.origin) * self.inverse).to_array();
        // A float-to-integer cast saturates, and sends what lies below to the first cell.
        std::array::from_fn(|k| (scaled[k] as usize).min(self.counts[k] - 1))
    }

    /// What is listed in a cell, in ascending order.
    #[inline]
    pub(crate) fn items(&self, cell: [usize; 3]) -> &[u32] {
        let k = self.index(cell);
        &self.items[self.starts[k] as usize..self.starts[k + 1] as usize]
    }

    /// Lower and upper walls of a cell, infinite where it is outermost.
    #[inline]
    pub(crate) fn walls(&self, cell: [usize; 3]) -> (DVec3, DVec3) {
        let low = |k: usize| if cell[k] == 0 { f64::NEG_INFINITY } else { self.origin[k] + cell[k] as f64 * self.size };
        let high = |k: usize| if cell[k] + 1 == self.counts[k] { f64::INFINITY } else { self.origin[k] + (cell[k] + 1) as f64 * self.size };
        (DVec3::new(low(0), low(1), low(2)), DVec3::new(high(0), high(1), high(2)))
    }
}
