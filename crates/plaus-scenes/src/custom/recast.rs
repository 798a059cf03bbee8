//! A new throw that ends where it should.

use super::Custom;
use super::throws::{Throw, Trial};
use super::values::Drawn;
use plaus_dist::stream::below;
use plaus_dist::{LogRatio, Stream, math};
use plaus_mcmc::library::{happens, one_of};
use plaus_mcmc::vars::{log_density, renew};
use plaus_mcmc::{At, ModelError, Move, Path, Proposal, Recipe, Transition};

/// Draws all that belongs to one body anew from its law, and begins where a trial of the body alone shows that it ends
/// as is asked: at a place drawn from the requirement's own density, and relabelled so that the right axis is likely to
/// be up. One in sixteen begins where its law says, so states to which nothing is led have a way back.
///
/// The density of a proposal is that of the laws, but for the place, whose density is that of where the trial ends from
/// there, times the probability of the label. It depends on the state led to alone, so the ratio is that of the old
/// state over that of the new one. A trial begins in the middle of the law of the body's place, whatever the draw's: it
/// is a function of the other numbers. A body whose trial does not end as it has to is neither led to nor from.
#[derive(Debug, Clone, Copy)]
pub(super) struct Recast;

/// Share of throws that begin where their laws say.
const LEFT: f64 = 1.0 / 16.0;
/// Rounding of a sum of densities, in nats.
const SLACK: f64 = 1e-9;

/// Log density of a throw's place, as it is drawn or as if it were led to the likeliest end: of a mixture of both ways
/// in which places are proposed, in the units of the draw's numbers.
fn log_place(world: &Custom, throw: &Throw, draw: &Drawn, end: Option<[f64; 2]>) -> Result<f64, ModelError> {
    let mut laws = [0.0; 2];
    for (log, handle) in laws.iter_mut().zip(&throw.handles.place) {
        *log = handle.map_or(Ok(0.0), |handle| log_density(world, draw, handle.var).map(|log| log.value()))?;
    }
    let drawn = laws[0] + laws[1];
    let led = |zone: &crate::require::Zone| {
        let leads = zone.leads();
        let others: f64 = laws.iter().zip(leads).filter(|(_, leads)| !leads).map(|(log, _)| log).sum();
        let handles = throw.handles.place.iter().zip(leads).filter(|(_, leads)| *leads);
        let unit: f64 = handles.filter_map(|(handle, _)| *handle).map(|handle| math::ln(handle.factor.abs())).sum();
        others + unit + end.map_or(zone.log_most(), |end| zone.log_density(end))
    };
    let count = throw.zones.len() as f64;
    if throw.zones.is_empty() {
        return Ok(drawn);
    }
    let each = (1.0 - LEFT) / count;
    let logs: Vec<f64> =
        throw.zones.iter().map(|zone| led(zone) + math::ln(each)).chain([drawn + math::ln(LEFT)]).collect();
    let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if most == f64::NEG_INFINITY {
        return Ok(most);
    }
    Ok(most + math::ln(logs.into_iter().map(|log| math::exp(log - most)).sum()))
}

impl Recast {
    /// Log density of the place and of the label of a throw as it is.
    fn log_led(world: &Custom, throw: &Throw, draw: &Drawn, trial: &Trial) -> Result<f64, ModelError> {
        let label = match throw.handles.turn.filter(|_| throw.rotations.len() > 1) {
            Some(index) => {
                let weights = throw.weights(trial);
                math::ln(weights[throw.label(trial, draw.turns[index])] / weights.iter().sum::<f64>())
            }
            None => 0.0,
        };
        Ok(log_place(world, throw, draw, Some(throw.led(draw, trial)))? + label)
    }

    /// Log density under their laws of the numbers that are the body's own, but for its place.
    fn log_elsewhere(world: &Custom, throw: &Throw, draw: &Drawn) -> Result<f64, ModelError> {
        let is_place = |var: usize| throw.handles.place.iter().flatten().any(|handle| handle.var == var);
        let elsewhere = throw.handles.own.iter().filter(|var| !is_place(**var));
        elsewhere.map(|&var| Ok(log_density(world, draw, var)?.value())).sum()
    }

    /// The whole; `None` if the throw's trial does not end as it has to.
    fn log_q(world: &Custom, throw: &Throw, draw: &Drawn) -> Result<Option<f64>, ModelError> {
        let Some(trial) = throw.trial(draw)? else { return Ok(None) };
        Ok(Some(Self::log_led(world, throw, draw, &trial)? + Self::log_elsewhere(world, throw, draw)?))
    }
}

impl Move<Custom> for Recast {
    fn name(&self) -> &'static str {
        "recast"
    }

    fn propose(&self, at: At<'_, Custom>, candidate: &mut Drawn, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let world = at.target;
        let index = below(stream, world.throws.len());
        let throw = &world.throws[index];
        for &var in &throw.handles.own {
            renew(world, candidate, var, Recipe::Exact, stream);
        }
        let is_led = !throw.zones.is_empty() && !happens(LEFT, stream);
        let Some(trial) = throw.trial(candidate)? else { return Ok(Proposal::Stay) };
        if is_led {
            let zone = &throw.zones[below(stream, throw.zones.len())];
            let to = zone.sample(stream);
            throw.lead(candidate, &trial, (zone, to));
        }
        if let Some(turn) = throw.handles.turn.filter(|_| throw.rotations.len() > 1) {
            let weights = throw.weights(&trial);
            let chosen = one_of(weights.iter().copied(), stream).unwrap_or(weights.len() - 1);
            let now = throw.label(&trial, candidate.turns[turn]);
            candidate.turns[turn] =
                (candidate.turns[turn] * throw.rotations[now].conjugate() * throw.rotations[chosen]).normalize();
            // Where rounding leads to another trial, there is no way back.
            if !throw.shares(&trial, candidate) || throw.label(&trial, candidate.turns[turn]) != chosen {
                return Ok(Proposal::Stay);
            }
        }
        let to = Self::log_led(world, throw, candidate, &trial)? + Self::log_elsewhere(world, throw, candidate)?;
        let from = Self::log_elsewhere(world, throw, at.state.draw)?;
        let most = log_place(world, throw, at.state.draw, None)? + SLACK;
        let log_ratio = LogRatio::new(from - to)?;
        Ok(Proposal::Candidate { log_ratio, path: Path(index as u64), later: Some(LogRatio::new(most)?) })
    }

    fn log_ratio(&self, step: Transition<'_, Custom>) -> Result<LogRatio, ModelError> {
        let throw = &step.target.throws[step.path.0 as usize];
        let Some(from) = Self::log_q(step.target, throw, step.from.draw)? else { return Ok(LogRatio::ZERO) };
        let Some(to) = Self::log_q(step.target, throw, step.to.draw)? else { return Ok(LogRatio::ZERO) };
        Ok(LogRatio::new(from - to)?)
    }

    fn log_ratio_after(&self, step: Transition<'_, Custom>) -> Result<LogRatio, ModelError> {
        let throw = &step.target.throws[step.path.0 as usize];
        let Some(trial) = throw.trial(step.from.draw)? else { return Ok(LogRatio::ZERO) };
        Ok(LogRatio::new(Self::log_led(step.target, throw, step.from.draw, &trial)?)?)
    }
}
