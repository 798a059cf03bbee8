//! Probabilities of goals, compared with exact ones; wrong twins are estimators that only look right.

use plaus_dist::math::{self, powi};
use plaus_dist::stream::below;
use plaus_dist::{Density, Gaussian, LogDensity, LogPotential, LogRatio, Sample, Seed, Stream, open_unit};
use plaus_mcmc::chance::{
    ChanceError, ChancePulse, Estimate, Parts, Splitting, Stoned, Stones, count, disagree, split, stones,
};
use plaus_mcmc::{
    At, Goal, Mixture, ModelError, Move, Proposal, Simulated, SolutionClass, StateRefOf, Target, Transition,
};
use statrs::distribution::{ContinuousCDF, Normal};
use std::sync::Arc;

/// Independent standard normal numbers, the first of which should be at least `past`.
#[derive(Clone, Copy)]
struct Tail {
    past: f64,
    /// Nats lost for each unit short of it.
    slope: f64,
    /// Width of plateaus of the constraint; 0: none.
    plateau: f64,
    /// Draws that fall short by more are forbidden.
    forbidden: f64,
}

fn normal() -> Gaussian {
    Gaussian::new(0.0, 1.0).unwrap()
}

fn tail_of(x: f64) -> f64 {
    Normal::new(0.0, 1.0).unwrap().sf(x)
}

impl Tail {
    const fn beyond(past: f64) -> Self {
        Self { past, slope: 2.0 * past, plateau: 0.0, forbidden: f64::INFINITY }
    }
}

impl Target for Tail {
    type Draw = [f64; 2];
    type Outcome = [f64; 2];
    type Scratch = ();
    fn start(&self, stream: &mut Stream) -> [f64; 2] {
        [normal().sample(stream), normal().sample(stream)]
    }
    fn log_prior(&self, draw: &[f64; 2]) -> Result<LogDensity, ModelError> {
        Ok(normal().log_density(&draw[0])? + normal().log_density(&draw[1])?)
    }
    fn simulate(
        &self,
        draw: &[f64; 2],
        _: Option<StateRefOf<'_, Self>>,
        _: LogPotential,
        (): &mut (),
    ) -> Result<Simulated<[f64; 2]>, ModelError> {
        Ok(Simulated::Complete(*draw))
    }
    fn log_constraint(&self, &outcome: &[f64; 2]) -> Result<LogPotential, ModelError> {
        let short = (self.past - outcome[0]).max(0.0);
        if short > self.forbidden {
            return Ok(LogPotential::ZERO);
        }
        let short = if self.plateau > 0.0 { (short / self.plateau).ceil() * self.plateau } else { short };
        Ok(LogPotential::new(-self.slope * short)?)
    }
}

impl Goal for Tail {
    fn class(&self, state: StateRefOf<'_, Self>) -> Option<SolutionClass> {
        let there = state.draw[0] >= self.past;
        there.then(|| SolutionClass::of([0]))
    }
}

/// Turns the draw a little towards a fresh one: the prior's own step.
struct Turn(f64);

impl Move<Tail> for Turn {
    fn name(&self) -> &str {
        "turn"
    }
    fn propose(&self, at: At<'_, Tail>, candidate: &mut [f64; 2], stream: &mut Stream) -> Result<Proposal, ModelError> {
        for x in candidate.iter_mut() {
            *x = (1.0 - self.0 * self.0).sqrt() * *x + self.0 * normal().sample(stream);
        }
        let there = at.target.log_prior(candidate)?;
        Ok(Proposal::with_ratio(LogRatio::new(at.state.log_prior.value() - there.value())?))
    }
    fn log_ratio(&self, step: Transition<'_, Tail>) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::new(step.from.log_prior.value() - step.to.log_prior.value())?)
    }
}

/// Whether the second number is positive.
const UPPER: Parts<'static, Tail> = Parts { count: 1, met: &|_, state, met| met[0] = state.draw[1] > 0.0 };

fn turns() -> Arc<Mixture<Tail>> {
    Arc::new(Mixture::new(vec![(1.0, Box::new(Turn(0.4)) as _), (1.0, Box::new(Turn(0.12)) as _)]).unwrap())
}

const SPLITTING: Splitting = Splitting { particles: 100, steps: 40, least: 1e-15 };

/// Estimates from batches, and the sum of their simulations.
fn climbed(target: &Tail, seed: u64, batches: u32, splitting: Splitting) -> (Vec<plaus_mcmc::chance::Split>, Estimate) {
    let (moves, pulse) = (turns(), ChancePulse::default());
    let made: Vec<_> = (0..batches)
        .map(|batch| split((target, &moves), UPPER, Seed(seed), batch, splitting, &pulse).unwrap())
        .collect();
    let estimate = Estimate::split(&made, 0).unwrap();
    (made, estimate)
}

/// Relative standard error of the mean of batches of ideal splitting, for a constraint without plateaus.
fn ideal(p: f64, particles: u32, batches: u32) -> f64 {
    ((math::powf(p, -1.0 / f64::from(particles)) - 1.0) / f64::from(batches)).sqrt()
}

/// Gaussian tails down to 1e-12, without plateaus and with them. The textbook's factor for each death is wrong on
/// plateaus.
#[test]
fn splitting_finds_gaussian_tails() {
    for past in [3.090_232, 4.753_424, 5.997_807, 7.034_484] {
        let p = tail_of(past);
        let (batches, smooth) = climbed(&Tail::beyond(past), 1, 10, SPLITTING);
        let error = ideal(p, 100, 10);
        // Five standard errors, with the error that theory gives: a false-alarm rate below 1e-6.
        assert!((smooth.probability / p - 1.0).abs() < 5.0 * error, "{p:e}: {smooth:?}");
        assert!((0.4..2.5).contains(&(smooth.error / p / error)), "{p:e}: {smooth:?}, {error}");
        let textbook = |deaths: u64| powi(0.99, deaths as i32);
        // If every particle dies alone, the two estimators are the same.
        assert!(batches.iter().all(|one| (one.probability[0] / textbook(one.deaths) - 1.0).abs() < 1e-9));

        let stepped = Tail { plateau: 0.8, ..Tail::beyond(past) };
        let (batches, stepped) = climbed(&stepped, 2, 10, SPLITTING);
        assert!((stepped.probability - p).abs() < 6.0 * stepped.error, "{p:e}: {stepped:?}");
        let wrong = batches.iter().map(|one| textbook(one.deaths)).sum::<f64>() / 10.0;
        assert!((wrong - p).abs() > 8.0 * stepped.error, "{p:e}: {wrong:e} passes for right");
    }
}

/// The same particles give the probability of any event, not only of the goal.
#[test]
fn splitting_estimates_parts_too() {
    let (batches, _) = climbed(&Tail::beyond(4.0), 3, 24, SPLITTING);
    let part = Estimate::split(&batches, 1).unwrap();
    assert!((part.probability - 0.5).abs() < 5.0 * part.error && part.error < 0.05, "{part:?}");
    // The particles at the end alone would give another probability, because they are where the goal is.
    assert!(batches.iter().all(|batch| batch.ancestors >= 1 && batch.levels > 100));
}

const STONES: Stones = Stones { rungs: 10, swap_every: 2, warmup: 500, iterations: 3000 };

fn stepped_over(target: &Tail, seed: u64, batches: u32, plan: Stones) -> (Vec<Stoned>, Estimate) {
    let (moves, pulse) = (turns(), ChancePulse::default());
    let made: Vec<_> =
        (0..batches).map(|batch| stones(target, &moves, Seed(seed), batch, plan, &pulse).unwrap()).collect();
    let estimate = Estimate::stones(&made).unwrap();
    (made, estimate)
}

/// The same by stepping stones, also if most of the prior is forbidden. Leaving out a factor is noticed.
#[test]
fn stepping_stones_find_gaussian_tails() {
    for (past, forbidden) in [(3.090_232, f64::INFINITY), (5.997_807, f64::INFINITY), (3.090_232, 3.5)] {
        let p = tail_of(past);
        let (batches, found) = stepped_over(&Tail { forbidden, ..Tail::beyond(past) }, 4, 12, STONES);
        assert!((found.probability - p).abs() < 6.0 * found.error, "{p:e}: {found:?}");
        assert!(found.error < 0.15 * p, "{found:?}");
        // Z alone takes the target for the goal.
        let wrong = batches.iter().map(|one| math::exp(one.log_z)).sum::<f64>() / 12.0;
        assert!((wrong - p).abs() > 6.0 * found.error, "{wrong:e} passes for {p:e}");
        let plateaus = Tail { plateau: 0.8, ..Tail::beyond(past) };
        let (_, plateaus) = stepped_over(&plateaus, 5, 12, STONES);
        assert!((plateaus.probability - p).abs() < 6.0 * plateaus.error, "{p:e}: {plateaus:?}");
        if forbidden.is_finite() {
            // Relative to the allowed part of the prior alone, the probability would be much larger.
            let allowed = tail_of(past - forbidden);
            assert!((found.probability / allowed - p).abs() > 6.0 * found.error, "{found:?}");
        }
    }
}

/// Ten coins that should all show heads: the constraint consists of plateaus only, and all three methods can estimate
/// it.
struct Coins;

impl Target for Coins {
    type Draw = [bool; 10];
    type Outcome = u32;
    type Scratch = ();
    fn start(&self, stream: &mut Stream) -> [bool; 10] {
        std::array::from_fn(|_| open_unit(stream) < 0.7)
    }
    fn log_prior(&self, draw: &[bool; 10]) -> Result<LogDensity, ModelError> {
        let one = |&head: &bool| LogDensity::new(if head { math::ln(0.7) } else { math::ln(0.3) });
        Ok(draw.iter().map(one).try_fold(LogDensity::ONE, |sum, one| one.map(|one| sum + one))?)
    }
    fn simulate(
        &self,
        draw: &[bool; 10],
        _: Option<StateRefOf<'_, Self>>,
        _: LogPotential,
        (): &mut (),
    ) -> Result<Simulated<u32>, ModelError> {
        Ok(Simulated::Complete(draw.iter().map(|&head| u32::from(head)).sum()))
    }
    fn log_constraint(&self, &heads: &u32) -> Result<LogPotential, ModelError> {
        Ok(LogPotential::new(2.0 * f64::from(heads))?)
    }
}

impl Goal for Coins {
    fn class(&self, state: StateRefOf<'_, Self>) -> Option<SolutionClass> {
        (*state.outcome == 10).then(|| SolutionClass::of([0]))
    }
}

const EACH: Parts<'static, Coins> = Parts { count: 10, met: &|_, state, met| met.copy_from_slice(state.draw) };

/// Throws one coin again.
struct Toss;

impl Move<Coins> for Toss {
    fn name(&self) -> &str {
        "toss"
    }
    fn propose(
        &self,
        at: At<'_, Coins>,
        candidate: &mut [bool; 10],
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        candidate[below(stream, 10)] = open_unit(stream) < 0.7;
        let there = at.target.log_prior(candidate)?;
        Ok(Proposal::with_ratio(LogRatio::new(at.state.log_prior.value() - there.value())?))
    }
    fn log_ratio(&self, step: Transition<'_, Coins>) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::new(step.from.log_prior.value() - step.to.log_prior.value())?)
    }
}

#[test]
fn all_methods_agree_on_coins() {
    let (pulse, seed, p) = (ChancePulse::default(), Seed(7), powi(0.7, 10));
    let moves = Arc::new(Mixture::of(Box::new(Toss)));
    let counted: Vec<_> = (0..8).map(|batch| count(&Coins, EACH, seed, batch, 4000, &pulse).unwrap()).collect();
    let particles: Vec<_> =
        (0..24).map(|batch| split((&Coins, &moves), EACH, seed, batch, SPLITTING, &pulse).unwrap()).collect();
    let plan = Stones { rungs: 6, ..STONES };
    let stoned: Vec<_> = (0..12).map(|batch| stones(&Coins, &moves, seed, batch, plan, &pulse).unwrap()).collect();
    let all = [
        Estimate::counted(&counted, 0).unwrap(),
        Estimate::split(&particles, 0).unwrap(),
        Estimate::stones(&stoned).unwrap(),
    ];
    for one in &all {
        assert!((one.probability - p).abs() < 5.0 * one.error && one.error < 0.1 * p, "{one:?} is not {p}");
    }
    assert_eq!(disagree(&all), []);
    for coin in 1..=10 {
        let parts = [Estimate::counted(&counted, coin).unwrap(), Estimate::split(&particles, coin).unwrap()];
        assert!(parts.iter().all(|part| (part.probability - 0.7).abs() < 5.0 * part.error), "{coin}: {parts:?}");
    }
    // The textbook's estimate treats plateaus as slopes.
    let textbook = particles.iter().map(|one| powi(0.99, one.deaths as i32)).sum::<f64>() / 24.0;
    assert!((textbook - p).abs() > 10.0 * all[1].error, "{textbook} passes for {p}");
    // An observer sees every simulation.
    let simulations = all.iter().map(|one| one.simulations).sum::<u64>();
    assert!(pulse.simulations().abs_diff(simulations) <= 12 * 6, "{} of {simulations}", pulse.simulations());
}

#[test]
fn batches_are_functions_of_their_number_and_can_be_stopped() {
    let (moves, pulse) = (turns(), ChancePulse::default());
    let target = Tail::beyond(3.0);
    let one = |batch| split((&target, &moves), UPPER, Seed(3), batch, SPLITTING, &pulse).unwrap();
    assert!(one(2) == one(2) && one(2) != one(3));
    assert!(
        count(&target, UPPER, Seed(3), 2, 100, &pulse).unwrap()
            == count(&target, UPPER, Seed(3), 2, 100, &pulse).unwrap()
    );
    for wrong in [Splitting { particles: 1, ..SPLITTING }, Splitting { steps: 0, ..SPLITTING }] {
        assert!(matches!(split((&target, &moves), UPPER, Seed(3), 0, wrong, &pulse), Err(ChanceError::Plan { .. })));
    }
    assert!(matches!(count(&target, UPPER, Seed(3), 0, 0, &pulse), Err(ChanceError::Plan { name: "draws", .. })));
    let one_rung = Stones { rungs: 1, ..STONES };
    assert!(matches!(stones(&target, &moves, Seed(3), 0, one_rung, &pulse), Err(ChanceError::Plan { .. })));
    pulse.stop();
    assert!(matches!(count(&target, UPPER, Seed(3), 0, 9, &pulse), Err(ChanceError::Stopped)));
    assert!(matches!(stones(&target, &moves, Seed(3), 0, STONES, &pulse), Err(ChanceError::Stopped)));
}

/// A tail that the constraint leads to, and a small square that it leads away from.
#[derive(Clone, Copy)]
struct Hidden {
    tail: Tail,
    /// Half the square's side, and its middle.
    half: f64,
    middle: [f64; 2],
}

impl Hidden {
    fn is_in_square(&self, x: &[f64; 2]) -> bool {
        x.iter().zip(&self.middle).all(|(x, middle)| (x - middle).abs() < self.half)
    }

    fn probability_of_square(&self) -> f64 {
        self.middle.iter().map(|middle| tail_of(middle - self.half) - tail_of(middle + self.half)).product()
    }
}

impl Target for Hidden {
    type Draw = [f64; 2];
    type Outcome = [f64; 2];
    type Scratch = ();
    fn start(&self, stream: &mut Stream) -> [f64; 2] {
        self.tail.start(stream)
    }
    fn log_prior(&self, draw: &[f64; 2]) -> Result<LogDensity, ModelError> {
        self.tail.log_prior(draw)
    }
    fn simulate(
        &self,
        draw: &[f64; 2],
        _: Option<StateRefOf<'_, Self>>,
        _: LogPotential,
        (): &mut (),
    ) -> Result<Simulated<[f64; 2]>, ModelError> {
        Ok(Simulated::Complete(*draw))
    }
    fn log_constraint(&self, outcome: &[f64; 2]) -> Result<LogPotential, ModelError> {
        if self.is_in_square(outcome) { Ok(LogPotential::ONE) } else { self.tail.log_constraint(outcome) }
    }
}

impl Goal for Hidden {
    fn class(&self, state: StateRefOf<'_, Self>) -> Option<SolutionClass> {
        let there = state.draw[0] >= self.tail.past || self.is_in_square(state.draw);
        there.then(|| SolutionClass::of([0]))
    }
}

impl plaus_mcmc::view::View for Hidden {
    type Seen = Tail;
    fn seen(&self) -> &Tail {
        &self.tail
    }
}

/// Two ways to the goal, one of them a needle that nothing points to. Splitting and stones rely on what they have seen,
/// so they miss all of it and agree with each other. Draws from the prior find it, and the disagreement is reported.
#[test]
fn a_mode_that_is_hard_to_find_makes_estimators_disagree() {
    let pulse = ChancePulse::default();
    let found = |half: f64| {
        let target = Hidden { tail: Tail::beyond(5.0), half, middle: [-1.5, 0.0] };
        let moves = Arc::new(plaus_mcmc::view::lend::<Hidden>(turns()).unwrap());
        let draws = (0..16).map(|batch| count(&target, Parts::NONE, Seed(8), batch, 62_500, &pulse).unwrap());
        let particles =
            (0..12).map(|batch| split((&target, &moves), Parts::NONE, Seed(8), batch, SPLITTING, &pulse).unwrap());
        let plan = Stones { warmup: 100, iterations: 600, ..STONES };
        let stoned = (0..12).map(|batch| stones(&target, &moves, Seed(8), batch, plan, &pulse).unwrap());
        let counted = Estimate::counted(&draws.collect::<Vec<_>>(), 0).unwrap();
        let split = Estimate::split(&particles.collect::<Vec<_>>(), 0).unwrap();
        let stoned = Estimate::stones(&stoned.collect::<Vec<_>>()).unwrap();
        (target, counted, split, stoned)
    };
    // About 20 of a million draws are in the square. Of the 1,200 particles, or of the 8,400 draws of the stones' first
    // rungs, most likely none is.
    let (target, counted, split, stoned) = found(0.01);
    let (square, tail) = (target.probability_of_square(), tail_of(5.0));
    assert!(square > 50.0 * tail && (counted.probability - square - tail).abs() < 5.0 * counted.error, "{counted:?}");
    for missed in [split, stoned] {
        assert!((missed.probability - tail).abs() < 6.0 * missed.error, "{missed:?} is not {tail}");
        let found = disagree(&[counted, missed]);
        assert!(found.len() == 1 && found[0].less == missed.method, "{counted:?} {missed:?}");
    }
    assert_eq!(disagree(&[split, stoned]), [], "two that missed the same agree");
    // Without the square all methods agree, although counting finds nothing.
    let (_, counted, split, stoned) = found(0.0);
    assert_eq!(counted.probability, 0.0);
    assert_eq!(disagree(&[counted, split, stoned]), []);
}
