//! Moves of the balls, and their wrong twins.

use super::balls::{Balls, Drops, active};
use super::below;
use plaus_dist::{LogRatio, Stream, math, open_unit};
use plaus_mcmc::check::{Branch, Enumerable};
use plaus_mcmc::{At, ModelError, Move, Path, Proposal, StateRefOf, Transition};

type S<'a> = StateRefOf<'a, Balls>;

/// Activates: each inactive ball is dropped somewhere with probability η. The reverse, deactivating: each active ball
/// is removed with probability η. The move does either with probability ½, or only one of the two.
#[derive(Clone, Copy)]
pub struct Toggle {
    pub eta: f64,
    pub ways: Ways,
    /// A wrong twin forgets the balls that were not toggled.
    pub forgets_untoggled: bool,
    /// A wrong twin measures the strip in another unit: 1 is right, 1e6 a slip from m² to mm².
    pub unit: f64,
}

#[derive(Clone, Copy, PartialEq)]
pub enum Ways {
    Both,
    Activate,
    Deactivate,
}

const ACTIVATE: Path = Path(0);
const DEACTIVATE: Path = Path(1);

impl Toggle {
    pub const RIGHT: Self = Self { eta: 0.25, ways: Ways::Both, forgets_untoggled: false, unit: 1.0 };

    /// Log probability, or density, of going along `path` between states with these numbers of active balls.
    fn log_q(&self, balls: &Balls, from: &Drops, to: &Drops, path: Path) -> f64 {
        let (n, m) = (active(from), active(to));
        let choices = if path == ACTIVATE { balls.count - n } else { n };
        let toggled = n.abs_diff(m);
        let untoggled = if self.forgets_untoggled { 0 } else { choices - toggled };
        let place = if path == ACTIVATE { -math::ln(balls.area * self.unit) } else { 0.0 };
        toggled as f64 * (math::ln(self.eta) + place) + untoggled as f64 * math::ln(1.0 - self.eta)
    }

    fn ratio(&self, balls: &Balls, from: &Drops, to: &Drops, path: Path) -> Result<LogRatio, ModelError> {
        let back = self.log_q(balls, to, from, Path(1 - path.0));
        Ok(LogRatio::new(back - self.log_q(balls, from, to, path))?)
    }
}

impl Move<Balls> for Toggle {
    fn name(&self) -> &str {
        match self.ways {
            Ways::Both => "toggle",
            Ways::Activate => "activate",
            Ways::Deactivate => "deactivate",
        }
    }
    fn propose(&self, at: At<'_, Balls>, drops: &mut Drops, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let path = match self.ways {
            Ways::Both => Path(below(2, stream) as u64),
            Ways::Activate => ACTIVATE,
            Ways::Deactivate => DEACTIVATE,
        };
        for drop in drops.iter_mut().filter(|drop| drop.is_none() == (path == ACTIVATE)) {
            if open_unit(stream) < self.eta {
                *drop = if drop.is_none() { Some(at.target.place(stream)) } else { None };
            }
        }
        if *drops == *at.state.draw {
            return Ok(Proposal::Stay);
        }
        let log_ratio = self.ratio(at.target, at.state.draw, drops, path)?;
        Ok(Proposal::Candidate { log_ratio, path, later: None })
    }
    fn log_ratio(&self, step: Transition<'_, Balls>) -> Result<LogRatio, ModelError> {
        self.ratio(step.target, step.from.draw, step.to.draw, step.path)
    }
    fn reverse(&self, path: Path) -> Path {
        Path(1 - path.0)
    }
}

impl Enumerable<Balls> for Toggle {
    fn branches(&self, balls: &Balls, state: S<'_>) -> Result<Vec<Branch<Drops>>, ModelError> {
        let from = state.draw;
        let ways: &[(Path, f64)] = match self.ways {
            Ways::Both => &[(ACTIVATE, 0.5), (DEACTIVATE, 0.5)],
            Ways::Activate => &[(ACTIVATE, 1.0)],
            Ways::Deactivate => &[(DEACTIVATE, 1.0)],
        };
        let mut branches = Vec::new();
        for &(path, chosen) in ways {
            for to in balls.all() {
                // The probability of each ball by itself; −∞ if the move could not make it.
                let each = from.iter().zip(&to).map(|(x, y)| match (x, y, path) {
                    (None, None, ACTIVATE) | (Some(_), Some(_), DEACTIVATE) if x == y => 1.0 - self.eta,
                    (None, Some(_), ACTIVATE) => self.eta / balls.area,
                    (Some(_), None, DEACTIVATE) => self.eta,
                    _ if x == y => 1.0,
                    _ => 0.0,
                });
                let probability: f64 = chosen * each.product::<f64>();
                if probability > 0.0 {
                    branches.push(Branch { draw: (to != *from).then_some(to), probability, path });
                }
            }
        }
        Ok(branches)
    }
}

/// A fresh draw of the prior.
pub struct ChangeAll {
    /// The wrong twin takes it for symmetric, although the dimension may change.
    pub symmetric: bool,
}

impl ChangeAll {
    fn ratio(&self, balls: &Balls, from: &Drops, to: &Drops) -> Result<LogRatio, ModelError> {
        let log_q = |drops: &Drops| -(active(drops) as f64) * math::ln(balls.area);
        Ok(LogRatio::new(if self.symmetric { 0.0 } else { log_q(from) - log_q(to) })?)
    }
}

impl Move<Balls> for ChangeAll {
    fn name(&self) -> &str {
        "change-all"
    }
    fn propose(&self, at: At<'_, Balls>, drops: &mut Drops, stream: &mut Stream) -> Result<Proposal, ModelError> {
        *drops = at.target.fresh(stream);
        Ok(Proposal::with_ratio(self.ratio(at.target, at.state.draw, drops)?))
    }
    fn log_ratio(&self, step: Transition<'_, Balls>) -> Result<LogRatio, ModelError> {
        self.ratio(step.target, step.from.draw, step.to.draw)
    }
}

impl Enumerable<Balls> for ChangeAll {
    fn branches(&self, balls: &Balls, _: S<'_>) -> Result<Vec<Branch<Drops>>, ModelError> {
        let half_each = math::powi(0.5, balls.count as i32);
        let chance = |to: &Drops| half_each * math::powi(balls.area, -(active(to) as i32));
        let branch = |to: Drops| Branch { probability: chance(&to), draw: Some(to), path: Path(0) };
        Ok(balls.all().into_iter().map(branch).collect())
    }
}

/// Drops one of the *useless* balls, those not alone in their bin, somewhere else. Only the outcome tells which balls
/// these are, so the ratio is known only after the simulation. It is 0 if the ball becomes useful, because it could not
/// be chosen again then.
pub struct Redrop {
    pub fault: Fault,
}

#[derive(Clone, Copy, PartialEq)]
pub enum Fault {
    None,
    /// `propose` does not announce the part that comes later.
    Unannounced,
    /// The ratio leaves out how many useless balls there are afterwards.
    Forgotten,
    /// The announced bound is too low.
    Bound,
}

/// The useless balls of a state.
fn useless(balls: &Balls, state: S<'_>) -> Vec<usize> {
    let shared =
        |(ball, drop): (usize, &Option<f64>)| drop.filter(|place| state.outcome[balls.bin(*place)] > 1).map(|_| ball);
    state.draw.iter().enumerate().filter_map(shared).collect()
}

impl Redrop {
    /// Log probability of choosing the ball of this path again.
    fn log_back(&self, balls: &Balls, to: S<'_>, path: Path) -> Result<LogRatio, ModelError> {
        let choices = useless(balls, to);
        let found = choices.contains(&(path.0 as usize));
        Ok(if found { LogRatio::new(-math::ln(choices.len() as f64))? } else { LogRatio::ZERO })
    }
}

impl Move<Balls> for Redrop {
    fn name(&self) -> &str {
        "redrop"
    }
    fn propose(&self, at: At<'_, Balls>, drops: &mut Drops, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let choices = useless(at.target, at.state);
        if choices.is_empty() {
            return Ok(Proposal::Stay);
        }
        let ball = choices[below(choices.len(), stream)];
        drops[ball] = Some(at.target.place(stream));
        let path = Path(ball as u64);
        if self.fault == Fault::Forgotten {
            return Ok(Proposal::Candidate { log_ratio: LogRatio::ONE, path, later: None });
        }
        let log_ratio = LogRatio::new(math::ln(choices.len() as f64))?;
        // The probability of choosing the ball again is at most 1, and no fewer than one ball shares its bin.
        let bound = match self.fault {
            Fault::Bound => LogRatio::new(-math::ln(3.0))?,
            _ => LogRatio::new(-math::ln(2.0))?,
        };
        Ok(Proposal::Candidate { log_ratio, path, later: (self.fault != Fault::Unannounced).then_some(bound) })
    }
    fn log_ratio(&self, step: Transition<'_, Balls>) -> Result<LogRatio, ModelError> {
        if self.fault == Fault::Forgotten {
            return Ok(LogRatio::ONE);
        }
        let log_forth = -math::ln(useless(step.target, step.from).len() as f64);
        Ok(LogRatio::new(self.log_back(step.target, step.to, step.path)?.value() - log_forth)?)
    }
    fn log_ratio_after(&self, step: Transition<'_, Balls>) -> Result<LogRatio, ModelError> {
        self.log_back(step.target, step.to, step.path)
    }
}

impl Enumerable<Balls> for Redrop {
    fn branches(&self, balls: &Balls, state: S<'_>) -> Result<Vec<Branch<Drops>>, ModelError> {
        let choices = useless(balls, state);
        if choices.is_empty() {
            return Ok(vec![Branch { draw: None, probability: 1.0, path: Path(0) }]);
        }
        let cells = balls.cells.unwrap();
        let probability = 1.0 / (choices.len() * cells) as f64;
        let to = |(ball, cell): (usize, usize)| {
            let mut draw = state.draw.clone();
            draw[ball] = Some(cell as f64 + 0.5);
            Branch { draw: Some(draw), probability, path: Path(ball as u64) }
        };
        Ok(choices.iter().flat_map(|&ball| (0..cells).map(move |cell| (ball, cell))).map(to).collect())
    }
}
