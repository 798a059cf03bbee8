//! Balls that are dropped or not, each at a place along a strip with equal bins; the constraint prefers filled bins.

use super::below;
use plaus_dist::{Gibbs, LogDensity, LogPotential, Stream, math, open_unit};
use plaus_mcmc::{Goal, ModelError, Simulated, SolutionClass, StateRef, StateRefOf, Target};

/// For each ball, where it drops, or that it does not.
pub type Drops = Vec<Option<f64>>;

pub struct Balls {
    pub count: usize,
    pub bins: usize,
    /// Size of the strip, in any unit.
    pub area: f64,
    /// Where a ball may drop: the middles of this many equal cells (then `area` is their number, so that the density is
    /// a probability), or anywhere.
    pub cells: Option<usize>,
    pub goal: Gibbs,
    /// Whether a simulation stops early where it may.
    pub stops_early: bool,
    /// A bug: it stops as if there were one ball fewer to come.
    pub stops_too_early: bool,
}

impl Balls {
    /// A world whose states can be listed: (1 + cells)^count of them.
    pub fn on_cells(count: usize, cells: usize, bins: usize, ln_lambda: f64) -> Self {
        Self { cells: Some(cells), ..Self::anywhere(count, bins, cells as f64, ln_lambda) }
    }

    pub fn anywhere(count: usize, bins: usize, area: f64, ln_lambda: f64) -> Self {
        let goal = Gibbs::from_ln_lambda(ln_lambda).unwrap();
        Self { count, bins, area, cells: None, goal, stops_early: true, stops_too_early: false }
    }

    pub fn place(&self, stream: &mut Stream) -> f64 {
        match self.cells {
            Some(cells) => below(cells, stream) as f64 + 0.5,
            None => self.area * open_unit(stream),
        }
    }

    /// Each ball is active with probability ½ and dropped uniformly: the prior in which each active ball has density
    /// 1/a.
    pub fn fresh(&self, stream: &mut Stream) -> Drops {
        (0..self.count).map(|_| (open_unit(stream) < 0.5).then(|| self.place(stream))).collect()
    }

    pub fn all(&self) -> Vec<Drops> {
        let places: Vec<Option<f64>> =
            std::iter::once(None).chain((0..self.cells.unwrap()).map(|cell| Some(cell as f64 + 0.5))).collect();
        (0..self.count).fold(vec![vec![]], |lists, _| {
            let longer = |list: &Drops| {
                let list = list.clone();
                places.iter().map(move |place| list.iter().copied().chain([*place]).collect()).collect::<Vec<_>>()
            };
            lists.iter().flat_map(longer).collect()
        })
    }

    pub fn bin(&self, place: f64) -> usize {
        ((place / self.area * self.bins as f64) as usize).min(self.bins - 1)
    }
}

pub fn active(draw: &Drops) -> usize {
    draw.iter().flatten().count()
}

pub fn filled(loads: &[u32]) -> u64 {
    loads.iter().filter(|&&load| load > 0).count() as u64
}

impl Target for Balls {
    type Draw = Drops;
    /// How many balls lie in each bin.
    type Outcome = Vec<u32>;
    type Scratch = Vec<u32>;
    fn start(&self, stream: &mut Stream) -> Drops {
        self.fresh(stream)
    }
    fn log_prior(&self, draw: &Drops) -> Result<LogDensity, ModelError> {
        Ok(LogDensity::new(-(active(draw) as f64) * math::ln(self.area))?)
    }
    fn simulate(
        &self,
        draw: &Drops,
        _: Option<StateRefOf<'_, Self>>,
        floor: LogPotential,
        loads: &mut Vec<u32>,
    ) -> Result<Simulated<Vec<u32>>, ModelError> {
        loads.clear();
        loads.resize(self.bins, 0);
        for (dropped, place) in (0..).zip(draw) {
            if let Some(place) = place {
                loads[self.bin(*place)] += 1;
            }
            let to_come = (self.count as u64 - 1 - dropped).saturating_sub(u64::from(self.stops_too_early));
            let most = self.goal.log_potential(filled(loads) + to_come);
            if self.stops_early && most <= floor {
                return Ok(Simulated::CannotExceedFloor);
            }
        }
        Ok(Simulated::Complete(loads.clone()))
    }
    fn log_constraint(&self, loads: &Vec<u32>) -> Result<LogPotential, ModelError> {
        Ok(self.goal.log_potential(filled(loads)))
    }
    fn most(&self) -> Option<LogPotential> {
        Some(self.goal.log_potential(self.bins as u64))
    }
}

impl Goal for Balls {
    /// Which ball lies in which bin.
    fn class(&self, StateRef { draw, outcome, .. }: StateRefOf<'_, Self>) -> Option<SolutionClass> {
        let bin = |place: &Option<f64>| place.map_or(-1, |place| self.bin(place) as i64);
        (filled(outcome) == self.bins as u64).then(|| SolutionClass::of(draw.iter().map(bin)))
    }
}
