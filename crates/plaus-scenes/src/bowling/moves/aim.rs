//! The ball aimed at the pins in front.

use crate::bowling::{Bowling, Quantity, Shot};
use plaus_dist::stream::below;
use plaus_dist::{Density, LogDensity, LogRatio, NotANumber, Sample, Stream, WrappedUniform, math, open_unit};
use plaus_mcmc::{Law, ModelError, Move, Path, Proposal, Recipe, StateRefOf, Variables, vars};

/// How often the place across the lane is drawn from its law instead, so that places from which no pin is met can be
/// left and reached.
const STRAY: f64 = 0.1;

/// Largest radius of a pin, in m. Only the aim depends on it.
const PIN: f64 = 0.0605;

/// Releases the ball from where it should meet a pin of the first row: with its centre at a uniform distance to the
/// side from that pin, within the distance at which the two touch. To find how far the ball moves to the side on its
/// way, it is first tried on a lane without pins and gutters. With probability `anew`, everything else is drawn from
/// the prior before that; otherwise it stays.
///
/// The density of the place depends on everything else, but not on the previous place, so the ratio is that of the old
/// place and of everything else over that of the new. If its law is not uniform, or a ball does not reach the pins, the
/// chain stays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aim {
    /// Probability that everything else is drawn from the prior.
    pub anew: f64,
}

/// The density of places across the lane, given everything else of a draw.
struct Places {
    law: WrappedUniform,
    /// Places from which the middle of a pin of the first row is met.
    middles: Vec<f64>,
    /// How far to the sides of these the ball still touches.
    reach: f64,
}

impl Places {
    /// `None` if nothing can be aimed.
    fn of(target: &Bowling, draw: &Shot) -> Result<Option<Self>, ModelError> {
        let Law::Uniform(law) = target.vars.get(Quantity::Across as usize).law else { return Ok(None) };
        let row = target.lane.first_row(draw);
        let distances: Vec<f64> = row.iter().map(|spot| spot.y).collect();
        let Some(to_the_side) = target.lane.approach(draw, &distances)? else { return Ok(None) };
        let middles = row.iter().zip(to_the_side).map(|(spot, way)| spot.x - way).collect();
        Ok(Some(Self { law, middles, reach: draw.get(Quantity::Radius) + PIN }))
    }

    fn sample(&self, stream: &mut Stream) -> f64 {
        if open_unit(stream) < STRAY {
            return self.law.sample(stream);
        }
        let middle = self.middles[below(stream, self.middles.len())];
        middle + self.reach * (2.0 * open_unit(stream) - 1.0)
    }

    fn log_density(&self, place: f64) -> Result<LogDensity, NotANumber> {
        let met = self.middles.iter().filter(|middle| (place - **middle).abs() < self.reach).count();
        let aimed = (1.0 - STRAY) * met as f64 / (self.middles.len() as f64 * 2.0 * self.reach);
        let stray = STRAY * math::exp(self.law.log_density(&place)?.value());
        LogDensity::new(math::ln(aimed + stray))
    }
}

/// Log density of everything in a draw except its place across the lane.
fn log_rest(target: &Bowling, draw: &Shot) -> Result<LogDensity, NotANumber> {
    vars::log_density_of(target, draw, (0..target.vars.len()).filter(|&var| var != Quantity::Across as usize))
}

/// Log density of proposing a draw, of what is proposed.
fn log_q(target: &Bowling, draw: &Shot, places: &Places, anew: bool) -> Result<LogDensity, ModelError> {
    let place = places.log_density(draw.get(Quantity::Across))?;
    Ok(if anew { place + log_rest(target, draw)? } else { place })
}

impl Move<Bowling> for Aim {
    fn name(&self) -> &'static str {
        "aim"
    }

    fn propose(
        &self,
        target: &Bowling,
        current: StateRefOf<'_, Bowling>,
        candidate: &mut Shot,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let anew = open_unit(stream) < self.anew;
        if anew {
            target.renew_all(candidate, Recipe::Exact, stream);
        }
        let Some(there) = Places::of(target, candidate)? else { return Ok(Proposal::Stay) };
        candidate.ball[Quantity::Across as usize] = there.sample(stream);
        let to = log_q(target, candidate, &there, anew)?;
        // The places are the same if everything else is.
        let here = if anew { Places::of(target, current.draw)? } else { Some(there) };
        let Some(here) = here else { return Ok(Proposal::Stay) };
        let log_ratio = LogRatio::of(log_q(target, current.draw, &here, anew)?, to)?;
        Ok(Proposal::Candidate { log_ratio, path: Path(u64::from(anew)), later: None })
    }

    fn log_ratio(
        &self,
        target: &Bowling,
        from: StateRefOf<'_, Bowling>,
        to: StateRefOf<'_, Bowling>,
        path: Path,
    ) -> Result<LogRatio, ModelError> {
        let anew = path == Path(1);
        let (Some(here), Some(there)) = (Places::of(target, from.draw)?, Places::of(target, to.draw)?) else {
            return Ok(LogRatio::ZERO);
        };
        Ok(LogRatio::of(log_q(target, from.draw, &here, anew)?, log_q(target, to.draw, &there, anew)?)?)
    }
}
