//! A new throw that ends where it should.

use super::Custom;
use super::angles::ANGLES;
use super::throws::{Throw, Trial};
use super::values::Drawn;
use crate::require::Zone;
use plaus_dist::stream::below;
use plaus_dist::{LogRatio, Stream, math};
use plaus_mcmc::library::{happens, one_of};
use plaus_mcmc::vars::{log_density, renew};
use plaus_mcmc::{At, ModelError, Move, Path, Proposal, Recipe, Transition};

/// Draws all that belongs to one body anew from its law; turns the throw about the vertical by an angle from which it
/// can well be led; lets it begin where a trial of the body alone shows that it ends as is asked, at a place drawn from
/// the requirement's own density; and relabels the body so that the right axis is likely to be up. One in sixteen
/// begins where its law says, so states to which nothing is led have a way back. Bodies that end otherwise than asked
/// are chosen more often.
///
/// Each state also has an angle by which its throw was turned, drawn anew from what its laws make likely whenever this
/// move is made. The density of proposing a state and an angle is that of the laws of the throw turned back, but for
/// the place; times the probability of the angle, given the trial; times the density of the place, which is that of
/// where the trial ends from there; times the probability of the label. It does not depend on the state led from, so
/// the ratio is that of the old state over that of the new one, of this and of the probabilities of the angles.
///
/// A trial begins in the middle of the law of the body's place, turned back, with one label for all: so it is a
/// function of what does not change when a throw is led. A body whose trial does not end as it has to is neither led to
/// nor from.
#[derive(Debug, Clone, Copy)]
pub(super) struct Recast;

/// Share of throws that begin where their laws say.
const LEFT: f64 = 1.0 / 16.0;
/// Rounding of sums of densities, in nats.
pub(super) const SLACK: f64 = 1e-9;

/// Which throw, by which angle it is turned in the new state, and by which in the old one.
#[derive(Debug, Clone, Copy)]
struct How {
    throw: usize,
    to: u64,
    from: u64,
}

impl How {
    fn path(self) -> Path {
        Path((self.throw as u64 * ANGLES + self.to) * ANGLES + self.from)
    }

    fn of(path: Path) -> Self {
        let rest = path.0 / ANGLES;
        Self { throw: (rest / ANGLES) as usize, to: rest % ANGLES, from: path.0 % ANGLES }
    }
}

/// Log density of a throw's place that ends there; or, without an end, as if that were the likeliest one. It is that of
/// the mixture of both ways in which places are proposed, in the units of the draw's numbers.
fn log_place(world: &Custom, throw: &Throw, draw: &Drawn, end: Option<[f64; 2]>) -> Result<f64, ModelError> {
    let mut laws = [0.0; 2];
    for (log, handle) in laws.iter_mut().zip(&throw.handles.place) {
        *log = handle.map_or(Ok(0.0), |handle| log_density(world, draw, handle.var).map(|log| log.value()))?;
    }
    let drawn = laws[0] + laws[1];
    if throw.zones.is_empty() {
        return Ok(drawn);
    }
    let led = |zone: &Zone| {
        let leads = zone.leads();
        let others: f64 = laws.iter().zip(leads).filter(|(_, leads)| !leads).map(|(log, _)| log).sum();
        let handles = throw.handles.place.iter().zip(leads).filter(|(_, leads)| *leads);
        let unit: f64 = handles.filter_map(|(handle, _)| *handle).map(|handle| math::ln(handle.factor.abs())).sum();
        others + unit + end.map_or(zone.log_most(), |end| zone.log_density(end))
    };
    let each = math::ln((1.0 - LEFT) / throw.zones.len() as f64);
    let logs = throw.zones.iter().map(|zone| led(zone) + each);
    Ok(logs.fold(drawn + math::ln(LEFT), math::ln_add_exp))
}

/// Log density under their laws of the numbers that are the body's own, but for its place.
fn log_elsewhere(world: &Custom, throw: &Throw, draw: &Drawn) -> Result<f64, ModelError> {
    let is_place = |var: usize| throw.handles.place.iter().flatten().any(|handle| handle.var == var);
    let elsewhere = throw.handles.own.iter().filter(|var| !is_place(**var));
    elsewhere.map(|&var| Ok(log_density(world, draw, var)?.value())).sum()
}

/// The part of the log density that follows from a trial: of the angle, the place and the label.
fn log_led(world: &Custom, throw: &Throw, draw: &Drawn, (trial, angle): (&Trial, u64)) -> Result<f64, ModelError> {
    let turned = throw.angle(angle);
    let label = throw.labelled().map_or(0.0, |_| {
        let weights = throw.weights(trial);
        math::ln(weights[throw.label(trial, draw, turned)] / weights.iter().sum::<f64>())
    });
    let place = log_place(world, throw, draw, Some(throw.led(world, draw, trial, turned)))?;
    Ok(throw.angles_after(world, trial).log(angle) + place + label)
}

/// The log density of proposing a draw and an angle; `None` if the throw's trial does not end as it has to.
fn log_q(world: &Custom, throw: &Throw, draw: &Drawn, angle: u64) -> Result<Option<f64>, ModelError> {
    let Some(trial) = throw.trial(world, draw, throw.angle(angle))? else { return Ok(None) };
    Ok(Some(log_led(world, throw, draw, (&trial, angle))? + log_elsewhere(world, throw, &trial.begun)?))
}

impl Recast {
    /// Turns the throw of a trial by an angle, and leads and relabels it; whether it still has that trial.
    fn lead(
        (world, throw): (&Custom, &Throw),
        candidate: &mut Drawn,
        (trial, angle): (&Trial, f64),
        stream: &mut Stream,
    ) -> bool {
        if let Some(course) = throw.handles.course.as_ref().filter(|_| throw.span.is_some()) {
            course.turn(world, candidate, angle);
        }
        if !throw.zones.is_empty() && !happens(LEFT, stream) {
            let zone = &throw.zones[below(stream, throw.zones.len())];
            let (to, end) = (zone.sample(stream), throw.led(world, candidate, trial, angle));
            for (axis, leads) in zone.leads().into_iter().enumerate() {
                if let Some(handle) = throw.handles.place[axis].filter(|_| leads) {
                    handle.add(candidate, to[axis] - end[axis]);
                }
            }
        }
        let mut chosen = None;
        if let Some(turn) = throw.labelled() {
            let weights = throw.weights(trial);
            let label = one_of(weights.iter().copied(), stream).unwrap_or(weights.len() - 1);
            let now = throw.rotations[throw.label(trial, candidate, angle)];
            candidate.turns[turn] = (candidate.turns[turn] * now.conjugate() * throw.rotations[label]).normalize();
            chosen = Some(label);
        }
        // Where rounding leads to another trial, there is no way back.
        throw.shared(world, candidate, angle) == trial.begun
            && chosen.is_none_or(|chosen| throw.label(trial, candidate, angle) == chosen)
    }
}

impl Move<Custom> for Recast {
    fn name(&self) -> &'static str {
        "recast"
    }

    fn propose(&self, at: At<'_, Custom>, candidate: &mut Drawn, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let (world, old) = (at.target, at.state.draw);
        let index = world.choose_throw(at.state, stream);
        let throw = &world.throws()[index];
        for &var in &throw.handles.own {
            renew(world, candidate, var, Recipe::Exact, stream);
        }
        let Some(trial) = throw.trial(world, candidate, 0.0)? else { return Ok(Proposal::Stay) };
        let (after, before) = (throw.angles_after(world, &trial), throw.angles_before(world, old));
        let how = How { throw: index, to: after.sample(stream), from: before.sample(stream) };
        if !Self::lead((world, throw), candidate, (&trial, throw.angle(how.to)), stream) {
            return Ok(Proposal::Stay);
        }
        let to = log_led(world, throw, candidate, (&trial, how.to))? + log_elsewhere(world, throw, &trial.begun)?;
        let from = log_elsewhere(world, throw, &throw.shared(world, old, throw.angle(how.from)))?;
        if to == f64::NEG_INFINITY {
            // Rounding led out of the ends of a law.
            return Ok(Proposal::Stay);
        }
        let turned = throw.angles_before(world, candidate).log(how.to) - before.log(how.from);
        let log_ratio = LogRatio::new(from - to + turned - world.log_chosen(at.state, index))?;
        let most = log_place(world, throw, old, None)? + throw.log_most() + world.log_most_chosen() + SLACK;
        Ok(Proposal::Candidate { log_ratio, path: how.path(), later: Some(LogRatio::new(most)?) })
    }

    fn log_ratio(&self, step: Transition<'_, Custom>) -> Result<LogRatio, ModelError> {
        let (world, how) = (step.target, How::of(step.path));
        let throw = &world.throws()[how.throw];
        let Some(from) = log_q(world, throw, step.from.draw, how.from)? else { return Ok(LogRatio::ZERO) };
        let Some(to) = log_q(world, throw, step.to.draw, how.to)? else { return Ok(LogRatio::ZERO) };
        let before = |draw: &Drawn, angle: u64| throw.angles_before(world, draw).log(angle);
        let turned = before(step.to.draw, how.to) - before(step.from.draw, how.from);
        let chosen = world.log_chosen(step.to, how.throw) - world.log_chosen(step.from, how.throw);
        Ok(LogRatio::new(from - to + turned + chosen)?)
    }

    fn reverse(&self, path: Path) -> Path {
        let how = How::of(path);
        How { to: how.from, from: how.to, ..how }.path()
    }

    fn log_ratio_after(&self, step: Transition<'_, Custom>) -> Result<LogRatio, ModelError> {
        let (world, how) = (step.target, How::of(step.path));
        let throw = &world.throws()[how.throw];
        let Some(trial) = throw.trial(world, step.from.draw, throw.angle(how.from))? else { return Ok(LogRatio::ZERO) };
        let led = log_led(world, throw, step.from.draw, (&trial, how.from))?;
        Ok(LogRatio::new(led + world.log_chosen(step.to, how.throw))?)
    }
}
