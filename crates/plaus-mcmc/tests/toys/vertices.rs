//! Offsets of a few vertices in space, Gaussian; the constraint prefers vertices that lean to the right.

use super::below;
use plaus_dist::{Density, Gibbs, IsotropicGaussian, LogDensity, LogPotential, LogRatio, Radial, Sample, Stream, math};
use plaus_mcmc::{At, ModelError, Move, Path, Proposal, Simulated, StateRefOf, Target, Transition};

pub type Offsets = Vec<[f64; 3]>;

pub struct Vertices {
    pub count: usize,
    pub offset: IsotropicGaussian<3>,
    pub radial: Radial<3>,
    pub goal: Gibbs,
}

impl Vertices {
    /// `count` vertices with offsets of a tenth of a millimetre.
    pub fn new(count: usize, ln_lambda: f64) -> Self {
        let offset = IsotropicGaussian::new(1e-4).unwrap();
        let radial = Radial::new(1e-4).unwrap();
        Self { count, offset, radial, goal: Gibbs::from_ln_lambda(ln_lambda).unwrap() }
    }

    fn prior(&self, offsets: &[[f64; 3]]) -> Result<LogDensity, ModelError> {
        let mut sum = LogDensity::ONE;
        for offset in offsets {
            sum = sum + self.offset.log_density(offset)?;
        }
        Ok(sum)
    }
}

impl Target for Vertices {
    type Draw = Offsets;
    type Outcome = u64;
    type Scratch = ();
    fn start(&self, stream: &mut Stream) -> Offsets {
        (0..self.count).map(|_| self.offset.sample(stream)).collect()
    }
    fn log_prior(&self, draw: &Offsets) -> Result<LogDensity, ModelError> {
        self.prior(draw)
    }
    fn simulate(
        &self,
        draw: &Offsets,
        _: Option<StateRefOf<'_, Self>>,
        _: LogPotential,
        (): &mut (),
    ) -> Result<Simulated<u64>, ModelError> {
        Ok(Simulated::Complete(draw.iter().filter(|offset| offset[0] > 0.0).count() as u64))
    }
    fn log_constraint(&self, leaning: &u64) -> Result<LogPotential, ModelError> {
        Ok(self.goal.log_potential(*leaning))
    }
}

/// How a fresh offset is drawn.
#[derive(Clone, Copy, PartialEq)]
pub enum Fresh {
    /// From the prior.
    Gaussian,
    /// In a random direction, with a length N(0, σ): the paper's recipe, which gives another law.
    Radial,
}

impl Fresh {
    fn vertex(self, world: &Vertices, stream: &mut Stream) -> [f64; 3] {
        match self {
            Self::Gaussian => world.offset.sample(stream),
            Self::Radial => world.radial.sample(stream),
        }
    }
}

/// Draws all offsets anew.
pub struct ChangeAll {
    pub fresh: Fresh,
    /// The wrong twin takes it for symmetric.
    pub symmetric: bool,
}

impl ChangeAll {
    fn ratio(&self, world: &Vertices, from: &Offsets, to: &Offsets) -> Result<LogRatio, ModelError> {
        Ok(if self.symmetric { LogRatio::ONE } else { LogRatio::of(world.prior(from)?, world.prior(to)?)? })
    }
}

impl Move<Vertices> for ChangeAll {
    fn name(&self) -> &str {
        "change-all"
    }
    fn propose(
        &self,
        at: At<'_, Vertices>,
        candidate: &mut Offsets,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        candidate.iter_mut().for_each(|offset| *offset = self.fresh.vertex(at.target, stream));
        Ok(Proposal::with_ratio(self.ratio(at.target, at.state.draw, candidate)?))
    }
    fn log_ratio(&self, step: Transition<'_, Vertices>) -> Result<LogRatio, ModelError> {
        self.ratio(step.target, step.from.draw, step.to.draw)
    }
}

/// Draws the offset of one vertex anew.
pub struct RedrawOne(pub Fresh);

impl Move<Vertices> for RedrawOne {
    fn name(&self) -> &str {
        "redraw-one"
    }
    fn propose(
        &self,
        at: At<'_, Vertices>,
        candidate: &mut Offsets,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let which = below(at.target.count, stream);
        candidate[which] = self.0.vertex(at.target, stream);
        let log_ratio = LogRatio::of(at.target.prior(&[at.state.draw[which]])?, at.target.prior(&[candidate[which]])?)?;
        Ok(Proposal::Candidate { log_ratio, path: Path(which as u64), later: None })
    }
    fn log_ratio(&self, step: Transition<'_, Vertices>) -> Result<LogRatio, ModelError> {
        let which = step.path.0 as usize;
        Ok(LogRatio::of(step.target.prior(&[step.from.draw[which]])?, step.target.prior(&[step.to.draw[which]])?)?)
    }
}

/// Adds to one vertex a step in a random direction; its length may have any law, here |N(0, σ)|.
pub struct WalkOne;

impl Move<Vertices> for WalkOne {
    fn name(&self) -> &str {
        "walk-one"
    }
    fn propose(
        &self,
        at: At<'_, Vertices>,
        candidate: &mut Offsets,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let which = below(at.target.count, stream);
        let step = Fresh::Radial.vertex(at.target, stream);
        candidate[which].iter_mut().zip(step).for_each(|(x, dx)| *x += dx);
        Ok(Proposal::SYMMETRIC)
    }
    fn log_ratio(&self, _: Transition<'_, Vertices>) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::ONE)
    }
}

/// Sum of squares of all offsets over σ².
pub fn radius(draw: &Offsets, world: &Vertices) -> f64 {
    draw.iter().flatten().map(|x| math::square(x / world.offset.sd())).sum()
}
