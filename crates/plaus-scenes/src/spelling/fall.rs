//! Some balls simulated by themselves: their paths, where they end, and the vertices that this can depend on.

use super::arena::Arena;
use super::bins::Bins;
use crate::failed::failure;
use crate::model::groups::Group;
use crate::way::{Way, follow};
use glam::DVec3;
use plaus_mcmc::{Failure, ModelError};
use plaus_sim::marbles::{Marble, MarbleScratch, Marbles, Phase, Start};
use plaus_sim::mechanics::{Impact, Other};
use plaus_sim::motion::Parabola;
use plaus_sim::trace::Observer;
use plaus_sim::{Outcome, Scratch};

/// The balls of one group, from their drops to the end.
#[derive(Debug)]
pub(super) struct Fall {
    /// Which balls, in ascending order.
    pub(super) members: Vec<usize>,
    pub(super) starts: Vec<Start>,
    pub(super) ways: Vec<Way>,
    /// Each one's bin, as in [`super::Rest`].
    pub(super) bins: Vec<Option<u16>>,
    /// Why the simulation failed, if it did.
    pub(super) failed: Option<Box<Failure>>,
    /// The impacts, if they are kept.
    pub(super) impacts: Option<Vec<Impact>>,
    /// For each random vertex, whether the outcome of a ball alone can depend on it.
    touched: Vec<bool>,
}

/// Records paths, and impacts if asked for.
#[derive(Default)]
pub(super) struct Recorder {
    ways: Vec<Vec<Parabola>>,
    pub(super) impacts: Option<Vec<Impact>>,
}

impl Observer<Marbles> for Recorder {
    #[inline]
    fn impact(&mut self, impact: &Impact) {
        if let Some(impacts) = &mut self.impacts {
            impacts.push(*impact);
        }
    }

    #[inline]
    fn motion(&mut self, index: usize, body: &Marble) {
        if body.phase == Phase::Waiting {
            return;
        }
        follow(&mut self.ways[index], body.path);
    }
}

impl Fall {
    /// Simulates `members` with their `starts` in a world with as many balls.
    pub(super) fn simulate(
        arena: &Arena,
        world: &Marbles,
        (members, starts): (Vec<usize>, Vec<Start>),
        scratch: &mut Scratch<MarbleScratch>,
        recorder: &mut Recorder,
    ) -> Result<Self, ModelError> {
        recorder.ways.resize_with(members.len(), Vec::new);
        recorder.ways.iter_mut().for_each(Vec::clear);
        let mut state = world.state(&starts).map_err(ModelError::new)?;
        let outcome = world.run(&mut state, scratch, arena.duration, recorder).map_err(ModelError::new)?;
        if outcome == Outcome::Stopped {
            return Err(ModelError::new("a simulation stopped without being asked to: a bug"));
        }
        let name = |other: Other| match other {
            Other::Body(ball) => format!("ball_{}", members[ball]),
            Other::Surface(_) => "bins".to_owned(),
        };
        let failed = failure(outcome, state.time(), name).map(Box::new);
        let ways = recorder.ways[..members.len()].iter().map(|way| Way::new(way, arena.duration)).collect();
        let bins = state.bodies().iter().map(|ball| arena.bin_of(ball)).collect();
        let impacts = recorder.impacts.take();
        let mut fall = Self { members, starts, ways, bins, failed, impacts, touched: Vec::new() };
        if let [way] = fall.ways.as_slice() {
            fall.touched = Footprint::new(&arena.bins).of(way, arena);
        }
        Ok(fall)
    }

    /// Whether the simulation could have other bits once the vertices `moved` have moved.
    ///
    /// A ball alone depends on the vertices near its path. Several balls can also depend on features that they were
    /// deflected from before they got there, wherever those are.
    pub(super) fn depends_on(&self, moved: &[usize]) -> bool {
        match self.members.len() {
            1 => moved.iter().any(|&k| self.touched[k]),
            _ => !moved.is_empty(),
        }
    }
}

impl Group for Fall {
    fn members(&self) -> &[usize] {
        &self.members
    }

    fn ways(&self) -> &[Way] {
        &self.ways
    }
}

/// The vertices that a path can depend on.
///
/// Moving a vertex changes the tops of the partitions that meet in it, up to the next crossings. Their features are
/// looked at if a ball's path, up to the cell of the broad phase in which a motion ends, passes within its radius of
/// where they can be.
struct Footprint {
    side: f64,
    /// The largest distance of a ball's centre from the middle of a partition's top, along and across it, at which it
    /// can notice a change.
    near: f64,
    columns: usize,
    rows: usize,
}

impl Footprint {
    fn new(bins: &Bins) -> Self {
        // The broad phase makes its cells a quarter as large as a typical feature with its surroundings, but at least
        // 1/128 of all.
        let around = 2.0 * (bins.margin + bins.marble);
        let largest = (bins.side + bins.thickness).max(2.0 * bins.height) + around;
        let extent = bins.extent();
        let all = extent.0.max(extent.1).max(2.0 * bins.height) + bins.thickness + around;
        let cell = (0.25 * largest).max(all / 128.0);
        let near = 0.5 * bins.thickness + bins.margin + bins.marble + cell;
        Self { side: bins.side, near: near * (1.0 + 1e-9), columns: bins.columns, rows: bins.rows }
    }

    fn of(&self, way: &Way, arena: &Arena) -> Vec<bool> {
        let mut crossings = vec![false; (self.columns + 1) * (self.rows + 1)];
        for piece in &way.pieces {
            self.mark(piece.around.min, piece.around.max, &mut crossings);
        }
        arena.vertices.iter().map(|(vertex, _)| crossings[*vertex as usize]).collect()
    }

    fn mark(&self, low: DVec3, high: DVec3, crossings: &mut [bool]) {
        let wide = self.side + self.near;
        let index = |x: f64, most: usize| (x.max(0.0) as usize).min(most);
        let range = |low: f64, high: f64, most: usize| {
            index(((low - wide) / self.side).ceil(), most)..=index(((high + wide) / self.side).floor(), most)
        };
        let within = |low: f64, high: f64, x: f64, slack: f64| low - slack <= x && x <= high + slack;
        for j in range(low.y, high.y, self.rows) {
            for i in range(low.x, high.x, self.columns) {
                let (x, y) = (i as f64 * self.side, j as f64 * self.side);
                let along_x = within(low.x, high.x, x, wide) && within(low.y, high.y, y, self.near);
                let along_y = within(low.x, high.x, x, self.near) && within(low.y, high.y, y, wide);
                crossings[j * (self.columns + 1) + i] |= along_x || along_y;
            }
        }
    }
}
