//! The ball aimed at the pins in front.

use crate::bowling::{Bowling, Quantity, Shot};
use plaus_dist::stream::below;
use plaus_dist::{Density, LogDensity, LogRatio, NotANumber, Sample, Stream, WrappedUniform, math, open_unit};
use plaus_mcmc::{At, Fit, Law, ModelError, Move, Path, Proposal, Recipe, StateRefOf, Transition, Variables, vars};
use std::sync::Arc;

/// How often the place across the lane is drawn from its law instead, so that places from which no pin is met can be
/// left and reached.
const STRAY: f64 = 0.1;

/// How often the place where the ball comes to the first pin comes from what was learnt, once something was. The rest
/// reaches solutions that the warm-up did not find, and bounds how long a chain stays at one. From 0.5 to 0.8 the
/// number of independent strikes for their work is nearly the same, as computed from 14,000 simulated shots for chains
/// that make no other move; the less, the shorter the longest stays.
const LEARNT: f64 = 0.6;

/// Largest radius of a pin, in m. Only the aim depends on it.
const PIN: f64 = 0.0605;

/// Releases the ball from where it should meet a pin that no other one stands before: with its centre at a uniform
/// distance to the side from that pin, within the distance at which the two touch. To find how far the ball moves to
/// the side on its way, it is first tried on a lane without pins and gutters. With probability `anew`, everything else
/// is drawn from the prior before that; otherwise it stays.
///
/// From the best shots of the warm-up it learns where balls should be when they come to the first of these pins, given
/// their radius and speed ([`Fit`]); most balls then come there. Two strikes whose releases have nothing in common
/// agree in that place within centimetres, and more closely if the balls are alike. If left and right may be
/// exchanged, it learns the distance from the middle, and each side is as likely.
///
/// The density of the place depends on everything else, but not on the previous place, so the ratio is that of the old
/// place and of everything else over that of the new. If its law is not uniform, or a ball does not reach the pins, the
/// chain stays.
#[derive(Debug, Clone)]
pub struct Aim {
    anew: f64,
    /// Uncertain quantities on which the place depends.
    given: Vec<Quantity>,
    /// Of these quantities and the place at the first pin, each in units of its law's width.
    fit: Option<Arc<Fit>>,
}

impl Aim {
    /// A move that has learnt nothing yet and draws everything else from the prior with probability `anew`.
    #[must_use]
    pub fn new(target: &Bowling, anew: f64) -> Self {
        let is_uncertain = |quantity: &Quantity| target.vars.get(*quantity as usize).law.is_uncertain();
        let given = [Quantity::Radius, Quantity::Speed].into_iter().filter(is_uncertain).collect();
        Self { anew, given, fit: None }
    }

    /// `None` if nothing can be aimed.
    fn places(&self, target: &Bowling, draw: &Shot) -> Result<Option<Places<'_>>, ModelError> {
        let Law::Uniform(law) = target.vars.get(Quantity::Across as usize).law else { return Ok(None) };
        let row = target.lane.foremost(draw);
        let distances: Vec<f64> = row.iter().map(|spot| spot.y).collect();
        let Some(to_the_side) = target.lane.approach(draw, &distances)? else { return Ok(None) };
        let Some(&aside) = to_the_side.first() else { return Ok(None) };
        let middles = row.iter().zip(to_the_side).map(|(spot, way)| spot.x - way).collect();
        let width = |quantity: &Quantity| target.vars.get(*quantity as usize).law.width();
        let given = self.given.iter().map(|quantity| draw.get(*quantity) / width(quantity)).collect();
        let has_sides = target.rack().mirrored().is_none();
        let (reach, fit) = (draw.get(Quantity::Radius) + PIN, self.fit.as_deref());
        Ok(Some(Places { law, middles, reach, aside, given, has_sides, fit }))
    }
}

/// The density of places across the lane, given everything else of a draw.
struct Places<'a> {
    law: WrappedUniform,
    /// Places from which the middle of one of these pins is met.
    middles: Vec<f64>,
    /// How far to the sides of these the ball still touches.
    reach: f64,
    /// How far the ball moves to the side until it comes to the nearest of these pins.
    aside: f64,
    /// The quantities on which what was learnt depends, in units of their laws' widths.
    given: Vec<f64>,
    /// Whether left and right differ.
    has_sides: bool,
    fit: Option<&'a Fit>,
}

impl Places<'_> {
    fn width(&self) -> f64 {
        self.law.high() - self.law.low()
    }

    /// Where a ball from this place comes to the first pin, in units of the law's width.
    fn coming(&self, place: f64) -> f64 {
        (place + self.aside) / self.width()
    }

    /// What a shot from this place teaches.
    fn point(&self, place: f64) -> Vec<f64> {
        let coming = self.coming(place);
        self.point_of(if self.has_sides { coming } else { coming.abs() })
    }

    fn point_of(&self, coming: f64) -> Vec<f64> {
        self.given.iter().copied().chain([coming]).collect()
    }

    fn sample(&self, stream: &mut Stream) -> f64 {
        if let Some(fit) = self.fit
            && open_unit(stream) < LEARNT
        {
            let (_, point) = fit.sample(&self.given, stream);
            let coming = point[self.given.len()];
            let is_mirrored = !self.has_sides && open_unit(stream) < 0.5;
            return (if is_mirrored { -coming } else { coming }) * self.width() - self.aside;
        }
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
        let Some(fit) = self.fit else { return LogDensity::new(math::ln(aimed + stray)) };
        let density = |coming| math::exp(fit.log_density(&self.point_of(coming), self.given.len()));
        let coming = self.coming(place);
        let learnt = if self.has_sides { density(coming) } else { 0.5 * (density(coming) + density(-coming)) };
        LogDensity::new(math::ln(LEARNT * learnt / self.width() + (1.0 - LEARNT) * (aimed + stray)))
    }
}

/// Log density of everything in a draw except its place across the lane.
fn log_rest(target: &Bowling, draw: &Shot) -> Result<LogDensity, NotANumber> {
    vars::log_density_of(target, draw, (0..target.vars.len()).filter(|&var| var != Quantity::Across as usize))
}

/// Log density of proposing a draw, of what is proposed.
fn log_q(target: &Bowling, draw: &Shot, places: &Places<'_>, anew: bool) -> Result<LogDensity, ModelError> {
    let place = places.log_density(draw.get(Quantity::Across))?;
    Ok(if anew { place + log_rest(target, draw)? } else { place })
}

impl Move<Bowling> for Aim {
    fn name(&self) -> &'static str {
        "aim"
    }

    fn propose(&self, at: At<'_, Bowling>, candidate: &mut Shot, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let anew = open_unit(stream) < self.anew;
        if anew {
            at.target.renew_all(candidate, Recipe::Exact, stream);
        }
        let Some(there) = self.places(at.target, candidate)? else { return Ok(Proposal::Stay) };
        candidate.ball[Quantity::Across as usize] = there.sample(stream);
        let to = log_q(at.target, candidate, &there, anew)?;
        // The places are the same if everything else is.
        let here = if anew { self.places(at.target, at.state.draw)? } else { Some(there) };
        let Some(here) = here else { return Ok(Proposal::Stay) };
        let log_ratio = LogRatio::of(log_q(at.target, at.state.draw, &here, anew)?, to)?;
        Ok(Proposal::Candidate { log_ratio, path: Path(u64::from(anew)), later: None })
    }

    fn log_ratio(&self, step: Transition<'_, Bowling>) -> Result<LogRatio, ModelError> {
        let anew = step.path == Path(1);
        let (Some(here), Some(there)) =
            (self.places(step.target, step.from.draw)?, self.places(step.target, step.to.draw)?)
        else {
            return Ok(LogRatio::ZERO);
        };
        Ok(LogRatio::of(
            log_q(step.target, step.from.draw, &here, anew)?,
            log_q(step.target, step.to.draw, &there, anew)?,
        )?)
    }

    fn learns(&self) -> Vec<usize> {
        vec![self.given.len() + 1]
    }

    fn learn_from(&self, target: &Bowling, state: StateRefOf<'_, Bowling>) -> Vec<f64> {
        let point = |places: Places<'_>| places.point(state.draw.get(Quantity::Across));
        // A shot that cannot be aimed teaches nothing; a model that fails does so again when it is simulated.
        self.places(target, state.draw).ok().flatten().map(point).unwrap_or_default()
    }

    /// Pins as they should be: where solutions are rare, most of a chain's shots come to the first pin elsewhere.
    fn merit(&self, _: &Bowling, state: StateRefOf<'_, Bowling>) -> f64 {
        state.log_constraint.value()
    }

    fn at_fits(&self, fits: &[Option<Fit>]) -> Option<Box<dyn Move<Bowling>>> {
        Some(Box::new(Self { fit: fits.first().cloned().flatten().map(Arc::new), ..self.clone() }))
    }
}
