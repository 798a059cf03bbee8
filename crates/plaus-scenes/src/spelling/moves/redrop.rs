//! A ball dropped over a bin that lacks one.

use super::aim::Aim;
use crate::spelling::{Drops, Rest, Spelling};
use plaus_dist::{LogRatio, Stream, math};
use plaus_mcmc::library::one_of;
use plaus_mcmc::{At, ModelError, Move, Path, Proposal, StateRefOf, Transition};

/// A ball that fills no designated bin by itself is this many times as likely to be chosen as one that does.
const USELESS: f64 = 10.0;

/// Takes a ball that is dropped, mostly a useless one, and drops it elsewhere, mostly over a designated bin that no
/// other ball fills.
///
/// The outcome tells which balls are useless and which bins are empty; for the way back, the candidate's outcome does.
/// So the ratio is `w'(ball)/Σw' · h'(old position) / (w(ball)/Σw · h(new position))`, where the primed factors are
/// known after the simulation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Redrop {
    /// Share of positions that aim.
    pub aimed: f64,
}

/// Weights of the balls to choose from: 0 for one that is not dropped.
fn weights<'a>(target: &'a Spelling, draw: &'a Drops, rest: &'a Rest) -> impl Iterator<Item = f64> + Clone + 'a {
    draw.balls.iter().zip(&rest.bins).enumerate().map(move |(ball, (position, bin))| {
        let alone = |bin: u16| rest.bins.iter().enumerate().all(|(other, at)| other == ball || *at != Some(bin));
        match (position, bin) {
            (None, _) => 0.0,
            (Some(_), Some(bin)) if target.word().wants(*bin) && alone(*bin) => 1.0,
            _ => USELESS,
        }
    })
}

impl Redrop {
    /// Log probability of choosing `ball`, and log density of dropping it at `position`.
    fn log_q(self, target: &Spelling, from: StateRefOf<'_, Spelling>, ball: usize, position: [f64; 2]) -> f64 {
        let (mut chosen, mut sum) = (0.0, 0.0);
        for (index, weight) in weights(target, from.draw, from.outcome).enumerate() {
            sum += weight;
            if index == ball {
                chosen = weight;
            }
        }
        let aim = Aim::new(target, self.aimed, from.outcome, ball);
        math::ln(chosen / sum) + aim.log_density(position)
    }

    /// The way back, from `to` to `from`.
    fn back(
        self,
        target: &Spelling,
        from: &Drops,
        to: StateRefOf<'_, Spelling>,
        ball: usize,
    ) -> Result<LogRatio, ModelError> {
        Ok(match from.balls.get(ball).copied().flatten() {
            Some(position) => LogRatio::new(self.log_q(target, to, ball, position))?,
            None => LogRatio::ZERO,
        })
    }
}

impl Move<Spelling> for Redrop {
    fn name(&self) -> &'static str {
        "redrop"
    }

    fn propose(
        &self,
        at: At<'_, Spelling>,
        candidate: &mut Drops,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let chosen = one_of(weights(at.target, at.state.draw, at.state.outcome), stream);
        // Rounding may pass the last one.
        let Some(ball) = chosen.or_else(|| candidate.balls.iter().rposition(Option::is_some)) else {
            return Ok(Proposal::Stay);
        };
        let position = Aim::new(at.target, self.aimed, at.state.outcome, ball).sample(stream);
        candidate.balls[ball] = Some(position);
        let log_ratio = LogRatio::new(-self.log_q(at.target, at.state, ball, position))?;
        let later = Some(LogRatio::new(Aim::highest(at.target, self.aimed))?);
        Ok(Proposal::Candidate { log_ratio, path: Path(ball as u64), later })
    }

    fn log_ratio(&self, step: Transition<'_, Spelling>) -> Result<LogRatio, ModelError> {
        let ball = step.path.0 as usize;
        let Some(position) = step.to.draw.balls[ball] else { return Ok(LogRatio::ZERO) };
        let forth = LogRatio::new(self.log_q(step.target, step.from, ball, position))?;
        Ok(self.back(step.target, step.from.draw, step.to, ball)?.times(forth.inverse())?)
    }

    fn log_ratio_after(&self, step: Transition<'_, Spelling>) -> Result<LogRatio, ModelError> {
        self.back(step.target, step.from.draw, step.to, step.path.0 as usize)
    }
}
