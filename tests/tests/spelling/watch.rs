//! A check of marbles over bins, for a test and for the example `spelling_drops`.

use plaus_scenes::spelling::Bins;
use plaus_sim::marbles::{Marble, Marbles};
use plaus_sim::motion::Parabola;
use plaus_sim::roots::roots_of_quadratic;
use plaus_sim::trace::Observer;

/// Watches every motion: a marble may cross the middle of a partition only above it, and stays in the box and above the
/// floor.
#[derive(Debug)]
pub(crate) struct Watch<'b> {
    bins: &'b Bins,
    last: Vec<Option<Parabola>>,
    tunnelled: usize,
}

impl<'b> Watch<'b> {
    /// A watch over `count` marbles.
    pub(crate) fn new(bins: &'b Bins, count: usize) -> Self {
        Self { bins, last: vec![None; count], tunnelled: 0 }
    }

    /// Motions that began outside the box, sunk by more than a thousandth of a radius, or beyond a partition without
    /// having passed above it.
    pub(crate) fn tunnelled(&self) -> usize {
        self.tunnelled
    }

    /// Whether the path of a centre between two times crosses no middle plane of a partition below its ridge.
    fn is_clear(&self, path: &Parabola, until: f64) -> bool {
        let clear = self.bins.height - 2.0 * self.bins.margin + 0.9 * self.bins.marble;
        (0..2).all(|axis| {
            let lines = 1..[self.bins.columns, self.bins.rows][axis];
            lines.into_iter().all(|line| {
                let c = [path.x[axis] - line as f64 * self.bins.side, path.v[axis], 0.5 * path.a[axis]];
                let times = roots_of_quadratic(c).into_iter().flatten();
                times.into_iter().all(|dt| dt < 0.0 || path.t + dt > until || path.after(dt).z > clear)
            })
        })
    }
}

impl Observer<Marbles> for Watch<'_> {
    fn motion(&mut self, index: usize, body: &Marble) {
        let (x, r) = (body.path.x, self.bins.marble);
        let (width, breadth) = self.bins.extent();
        let inside = x.z > r * (1.0 - 1e-3) && x.x > 0.0 && x.y > 0.0 && x.x < width && x.y < breadth;
        let clear = self.last[index].is_none_or(|path| self.is_clear(&path, body.path.t));
        self.tunnelled += usize::from(!inside || !clear);
        self.last[index] = Some(body.path);
    }
}
