//! A ring of places with unequal prior weights, some of them forbidden; the constraint prefers even places.

use super::below;
use plaus_dist::{Gibbs, LogDensity, LogPotential, LogRatio, Stream, math, open_unit};
use plaus_mcmc::check::{Branch, Enumerable};
use plaus_mcmc::{
    At, Goal, ModelError, Move, Path, Proposal, Simulated, SolutionClass, StateRefOf, Target, Transition,
};

pub struct Ring {
    pub weights: Vec<f64>,
    pub goal: Gibbs,
}

impl Ring {
    /// Nine places, weight 0 at places 3 and 7.
    pub fn of_nine(ln_lambda: f64) -> Self {
        let weights = vec![1.0, 2.0, 0.5, 0.0, 3.0, 1.5, 0.25, 0.0, 1.0];
        Self { weights, goal: Gibbs::from_ln_lambda(ln_lambda).unwrap() }
    }

    pub fn all(&self) -> Vec<usize> {
        (0..self.weights.len()).collect()
    }

    pub fn probability(&self, place: usize) -> f64 {
        self.weights[place] / self.weights.iter().sum::<f64>()
    }

    fn draw(&self, stream: &mut Stream) -> usize {
        let mut left = open_unit(stream) * self.weights.iter().sum::<f64>();
        let found = self.weights.iter().position(|weight| {
            left -= weight;
            left < 0.0
        });
        found.unwrap_or(self.weights.len() - 1)
    }

    fn prior(&self, place: usize) -> Result<LogDensity, ModelError> {
        Ok(LogDensity::new(math::ln(self.probability(place)))?)
    }
}

impl Target for Ring {
    type Draw = usize;
    type Outcome = usize;
    type Scratch = ();
    fn start(&self, stream: &mut Stream) -> usize {
        self.draw(stream)
    }
    fn log_prior(&self, place: &usize) -> Result<LogDensity, ModelError> {
        self.prior(*place)
    }
    fn simulate(
        &self,
        place: &usize,
        _: Option<StateRefOf<'_, Self>>,
        _: LogPotential,
        (): &mut (),
    ) -> Result<Simulated<usize>, ModelError> {
        Ok(Simulated::Complete(*place))
    }
    fn log_constraint(&self, place: &usize) -> Result<LogPotential, ModelError> {
        Ok(self.goal.log_potential(u64::from(place.is_multiple_of(2))))
    }
}

impl Goal for Ring {
    fn class(&self, state: StateRefOf<'_, Self>) -> Option<SolutionClass> {
        state.draw.is_multiple_of(2).then(|| SolutionClass::of([*state.draw as i64]))
    }
}

/// One step to either side, around the ring.
pub struct Walk;

impl Move<Ring> for Walk {
    fn name(&self) -> &str {
        "walk"
    }
    fn propose(&self, at: At<'_, Ring>, place: &mut usize, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let size = at.target.weights.len();
        let path = below(2, stream) as u64;
        *place = (*place + if path == 0 { 1 } else { size - 1 }) % size;
        Ok(Proposal::Candidate { log_ratio: LogRatio::ONE, path: Path(path), later: None })
    }
    fn log_ratio(&self, _: Transition<'_, Ring>) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::ONE)
    }
    fn reverse(&self, path: Path) -> Path {
        Path(1 - path.0)
    }
}

impl Enumerable<Ring> for Walk {
    fn branches(&self, ring: &Ring, state: StateRefOf<'_, Ring>) -> Result<Vec<Branch<usize>>, ModelError> {
        let size = ring.weights.len();
        let to = |path, step| Branch { draw: Some((state.draw + step) % size), probability: 0.5, path: Path(path) };
        Ok(vec![to(0, 1), to(1, size - 1)])
    }
}

/// A fresh draw of the prior.
pub struct Redraw {
    /// The wrong twin takes it for symmetric.
    pub symmetric: bool,
}

impl Move<Ring> for Redraw {
    fn name(&self) -> &str {
        "redraw"
    }
    fn propose(&self, at: At<'_, Ring>, place: &mut usize, stream: &mut Stream) -> Result<Proposal, ModelError> {
        *place = at.target.draw(stream);
        Ok(Proposal::with_ratio(self.ratio(at.target, *at.state.draw, *place)?))
    }
    fn log_ratio(&self, step: Transition<'_, Ring>) -> Result<LogRatio, ModelError> {
        self.ratio(step.target, *step.from.draw, *step.to.draw)
    }
}

impl Redraw {
    fn ratio(&self, ring: &Ring, from: usize, to: usize) -> Result<LogRatio, ModelError> {
        Ok(if self.symmetric { LogRatio::ONE } else { LogRatio::of(ring.prior(from)?, ring.prior(to)?)? })
    }
}

impl Enumerable<Ring> for Redraw {
    fn branches(&self, ring: &Ring, _: StateRefOf<'_, Ring>) -> Result<Vec<Branch<usize>>, ModelError> {
        let to = |place| Branch { draw: Some(place), probability: ring.probability(place), path: Path(0) };
        Ok(ring.all().into_iter().map(to).collect())
    }
}
