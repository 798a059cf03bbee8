//! One chain: choosing moves, decisions, and what happens when a model fails.

// Helpers outside of `#[test]` functions panic as tests do.

use crate::toys::ring::{Redraw, Ring, Walk};
use plaus_dist::{LogDensity, LogPotential, LogRatio, Purpose, Seed, Stream};
use plaus_mcmc::{
    At, Block, Chain, ChainError, Control, Decision, Ending, Goal, Mixture, MixtureError, ModelError, Move, MoveId,
    Path, Plan, Progress, Proposal, RunError, Simulated, Sink, Snapshot, SolutionClass, StateRefOf, Target, Transition,
    run,
};

/// Counts up from its start; some numbers are forbidden or break the model.
#[derive(Clone, Copy)]
struct Counter {
    start: u64,
    forbidden_from: u64,
    prior_fails_at: u64,
    simulation_fails_at: u64,
}

const COUNTER: Counter =
    Counter { start: 0, forbidden_from: u64::MAX, prior_fails_at: u64::MAX, simulation_fails_at: u64::MAX };

impl Target for Counter {
    type Draw = u64;
    type Outcome = u64;
    type Scratch = ();
    fn start(&self, _: &mut Stream) -> u64 {
        self.start
    }
    fn log_prior(&self, draw: &u64) -> Result<LogDensity, ModelError> {
        Ok(LogDensity::new(if *draw == self.prior_fails_at { f64::NAN } else { 0.0 })?)
    }
    fn simulate(
        &self,
        draw: &u64,
        _: Option<StateRefOf<'_, Self>>,
        _: LogPotential,
        (): &mut (),
    ) -> Result<Simulated<u64>, ModelError> {
        if *draw == self.simulation_fails_at {
            return Err(ModelError::new("the ball left the world"));
        }
        Ok(Simulated::Complete(*draw))
    }
    fn log_constraint(&self, outcome: &u64) -> Result<LogPotential, ModelError> {
        Ok(if *outcome < self.forbidden_from { LogPotential::ONE } else { LogPotential::ZERO })
    }
    fn most(&self) -> Option<LogPotential> {
        Some(LogPotential::ONE)
    }
}

impl Goal for Counter {
    fn class(&self, state: StateRefOf<'_, Self>) -> Option<SolutionClass> {
        Some(SolutionClass(*state.draw))
    }
}

/// Adds one, with a ratio that always accepts, or with a ratio known in two parts.
struct Increment {
    first: LogRatio,
    later: Option<(LogRatio, LogRatio)>,
}

const ALWAYS: Increment = Increment { first: LogRatio::ONE, later: None };

impl Move<Counter> for Increment {
    fn name(&self) -> &str {
        "increment"
    }
    fn propose(&self, _: At<'_, Counter>, draw: &mut u64, _: &mut Stream) -> Result<Proposal, ModelError> {
        *draw += 1;
        Ok(Proposal::Candidate { log_ratio: self.first, path: Path(0), later: self.later.map(|(bound, _)| bound) })
    }
    fn log_ratio(&self, _: Transition<'_, Counter>) -> Result<LogRatio, ModelError> {
        Ok(self.first)
    }
    fn log_ratio_after(&self, _: Transition<'_, Counter>) -> Result<LogRatio, ModelError> {
        Ok(self.later.map_or(LogRatio::ONE, |(_, after)| after))
    }
}

fn first_decision(counter: Counter, kernel: Increment) -> Result<Decision, ChainError> {
    let moves = Mixture::of(Box::new(kernel));
    let mut chain = Chain::start(&counter, &moves, Seed(1).chain(0)).unwrap();
    let decision = chain.step()?.decision;
    assert_eq!(chain.state().draw, u64::from(decision == Decision::Accepted));
    Ok(decision)
}

#[test]
fn a_ratio_of_zero_is_a_rejection_wherever_it_comes_from() {
    let two = |first, bound, after| Increment { first, later: Some((bound, after)) };
    let (one, zero) = (LogRatio::ONE, LogRatio::ZERO);
    let decision = |kernel| first_decision(COUNTER, kernel).unwrap();
    assert_eq!(decision(ALWAYS), Decision::Accepted);
    assert_eq!(decision(Increment { first: zero, later: None }), Decision::RejectedByPrior);
    assert_eq!(decision(two(one, one, one)), Decision::Accepted);
    assert_eq!(decision(two(zero, one, one)), Decision::RejectedByPrior);
    assert_eq!(decision(two(one, zero, zero)), Decision::RejectedByPrior);
    assert_eq!(decision(two(one, one, zero)), Decision::Rejected);
    let infinite = LogRatio::ZERO.inverse();
    assert_eq!(decision(Increment { first: infinite, later: None }), Decision::Accepted);
    assert!(first_decision(COUNTER, two(infinite, one, zero)).is_err(), "0 times infinity is no ratio");
}

#[test]
fn a_forbidden_outcome_is_a_rejection_even_at_an_infinite_ratio() {
    let counter = Counter { forbidden_from: 1, ..COUNTER };
    for first in [LogRatio::ONE, LogRatio::ZERO.inverse()] {
        assert_eq!(first_decision(counter, Increment { first, later: None }).unwrap(), Decision::Rejected);
    }
}

/// A ratio of e⁻⁵⁰ is refused whatever the outcome, one of 1 is not: only the latter meets the simulation that fails.
#[test]
fn a_candidate_that_no_outcome_could_save_is_not_simulated() {
    let broken = Counter { simulation_fails_at: 1, ..COUNTER };
    let hopeless = Increment { first: LogRatio::new(-50.0).unwrap(), later: None };
    assert_eq!(first_decision(broken, hopeless).unwrap(), Decision::RejectedEarly);
    assert!(first_decision(broken, ALWAYS).is_err());
}

#[test]
fn a_chain_that_cannot_start_says_so() {
    let moves = Mixture::of(Box::new(ALWAYS) as _);
    let nowhere = Counter { forbidden_from: 0, ..COUNTER };
    let error = Chain::start(&nowhere, &moves, Seed(1).chain(0)).err().unwrap();
    assert!(matches!(error, ChainError::NoStart { .. }), "{error}");
    let broken = Counter { simulation_fails_at: 0, ..COUNTER };
    let error = Chain::start(&broken, &moves, Seed(1).chain(0)).err().unwrap();
    assert_eq!(error.to_string(), "iteration 0: the ball left the world");
}

#[test]
fn a_failing_model_names_iteration_and_move_and_leaves_the_state() {
    let nan = Counter { prior_fails_at: 5, ..COUNTER };
    let lost = Counter { simulation_fails_at: 5, ..COUNTER };
    for (counter, text) in [
        (nan, "iteration 5, move `increment`: log density is NaN: a log density must be finite or -inf"),
        (lost, "iteration 5, move `increment`: the ball left the world"),
    ] {
        let moves = Mixture::of(Box::new(ALWAYS) as _);
        let mut chain = Chain::start(&counter, &moves, Seed(1).chain(0)).unwrap();
        for _ in 0..4 {
            chain.step().unwrap();
        }
        // Repeatedly: retrying does not remove the error, and the state stays intact.
        for _ in 0..2 {
            assert_eq!(chain.step().unwrap_err().to_string(), text);
            assert_eq!((chain.state().draw, chain.iteration()), (4, 4));
        }
    }
}

/// Receives blocks and drops them.
struct Nowhere;

impl<D, O> Sink<D, O> for Nowhere {
    type Error = std::convert::Infallible;
    fn block(&mut self, _: u32, _: Block<D, O>, _: &Snapshot<D, O>) -> Result<(), Self::Error> {
        Ok(())
    }
    fn round(&mut self, _: &Progress<'_>) -> Result<Control, Self::Error> {
        Ok(Control::Continue)
    }
}

#[test]
fn a_run_reports_the_first_failing_chain() {
    let lost = Counter { simulation_fails_at: 5, ..COUNTER };
    let plan = Plan {
        seed: Seed(1),
        chains: 4,
        warmup: 0,
        iterations: 100,
        thin: 1,
        block: 10,
        solutions: None,
        rungs: 1,
        adapt_rungs: false,
        swap_every: 1,
        adapt: false,
        weigh: false,
        settle: false,
        climbs: 0,
        sampled: false,
    };
    for threads in [1, 4] {
        let error = run(&lost, &Mixture::of(Box::new(ALWAYS)), plan, Vec::new(), threads, &mut Nowhere).unwrap_err();
        assert!(matches!(error, RunError::Chain { chain: 0, .. }));
        assert_eq!(error.to_string(), "chain 0: iteration 5, move `increment`: the ball left the world");
    }
}

/// A chain that is ahead of the others may fail at an iteration that the run never reaches.
#[test]
fn a_failure_beyond_the_last_solution_asked_for_does_not_matter() {
    let lost = Counter { simulation_fails_at: 5, ..COUNTER };
    for (wanted, threads, block) in [(3, 1, 10), (3, 4, 10), (5, 2, 100), (5, 4, 1), (6, 1, 100), (6, 4, 10)] {
        let plan = Plan {
            seed: Seed(1),
            chains: 4,
            warmup: 0,
            iterations: 100,
            thin: 1,
            block,
            solutions: Some(wanted),
            rungs: 1,
            adapt_rungs: false,
            swap_every: 1,
            adapt: false,
            weigh: false,
            settle: false,
            climbs: 0,
            sampled: false,
        };
        let ended = run(&lost, &Mixture::of(Box::new(ALWAYS)), plan, Vec::new(), threads, &mut Nowhere);
        // The counters reach a new class in every iteration, and have reached five before they fail.
        match ended {
            Ok(ending) => assert_eq!((ending, wanted < 6), (Ending::EnoughSolutions, true)),
            Err(error) => assert!(wanted == 6 && error.to_string().starts_with("chain 0: iteration 5"), "{error}"),
        }
    }
}

/// A start that satisfies the constraint is a recorded solution, found at iteration 0.
#[test]
fn the_start_counts_as_a_solution() {
    struct Ends(Vec<(u64, usize)>);
    impl Sink<u64, u64> for Ends {
        type Error = std::convert::Infallible;
        fn block(&mut self, _: u32, block: Block<u64, u64>, snapshot: &Snapshot<u64, u64>) -> Result<(), Self::Error> {
            assert_eq!((snapshot.hits.first, snapshot.hits.count), (Some(0), block.end_iteration));
            Ok(())
        }
        fn round(&mut self, progress: &Progress<'_>) -> Result<Control, Self::Error> {
            self.0.push((progress.end_iteration, progress.distinct.firsts().len()));
            Ok(Control::Continue)
        }
    }
    for (wanted, block) in [(1, 1), (1, 100), (3, 1), (3, 100)] {
        let solutions = Some(wanted);
        let plan = Plan {
            seed: Seed(1),
            chains: 1,
            warmup: 0,
            iterations: 50,
            thin: 1,
            block,
            solutions,
            rungs: 1,
            adapt_rungs: false,
            swap_every: 1,
            adapt: false,
            weigh: false,
            settle: false,
            climbs: 0,
            sampled: false,
        };
        let mut ends = Ends(Vec::new());
        run(&COUNTER, &Mixture::of(Box::new(ALWAYS)), plan, Vec::new(), 1, &mut ends).unwrap();
        // The counter reaches a new class in every iteration.
        assert_eq!(ends.0.last(), Some(&(wanted, wanted as usize)));
    }
}

#[test]
fn moves_are_chosen_by_weight() {
    let weights = [3.0, 0.0, 1.0, 4.0];
    let moves = weights.map(|weight| (weight, Box::new(Walk) as Box<dyn Move<Ring>>));
    let mixture = Mixture::new(moves.into_iter().collect()).unwrap();
    assert_eq!(mixture.names().len(), 3, "a move of weight 0 is left out");
    let probabilities: Vec<f64> = mixture.iter().map(|(probability, _)| probability).collect();
    assert_eq!(probabilities, [0.375, 0.125, 0.5]);
    assert_eq!(mixture.get(MoveId(1)).0, 0.125);
    let tries = 400_000;
    let mut counts = [0_u32; 3];
    for iteration in 0..tries {
        let (MoveId(id), _) = mixture.choose(&mut Seed(4).chain(0).at(iteration, Purpose::PROPOSE));
        counts[usize::from(id)] += 1;
    }
    for (count, probability) in counts.iter().zip(probabilities) {
        let expected = probability * tries as f64;
        // Six standard deviations: two-sided false-alarm rate 2e-9 each.
        assert!((f64::from(*count) - expected).abs() < 6.0 * (expected * (1.0 - probability)).sqrt(), "{counts:?}");
    }
}

#[test]
fn bad_weights_are_refused() {
    let mixture = |weight: f64| Mixture::<Ring>::new(vec![(1.0, Box::new(Walk) as _), (weight, Box::new(Walk) as _)]);
    for weight in [-1.0, f64::NAN, f64::INFINITY] {
        let error = mixture(weight).err().unwrap();
        assert!(matches!(&error, MixtureError::Weight { name, .. } if name == "walk"), "{error}");
    }
    assert_eq!(Mixture::<Ring>::new(vec![]).err(), Some(MixtureError::Empty));
    assert_eq!(Mixture::<Ring>::new(vec![(0.0, Box::new(Walk) as _)]).err(), Some(MixtureError::Empty));
    // Even the largest weights make a mixture.
    let huge = Mixture::<Ring>::new(vec![(f64::MAX, Box::new(Walk) as _), (f64::MAX, Box::new(Walk) as _)]);
    let probabilities: Vec<f64> = huge.unwrap().iter().map(|(probability, _)| probability).collect();
    assert_eq!(probabilities, [0.5, 0.5]);
}

#[test]
fn every_iteration_has_one_verdict() {
    let ring = Ring::of_nine(2.0);
    let redraw = Redraw { symmetric: false };
    let moves = Mixture::new(vec![(0.5, Box::new(Walk) as _), (0.5, Box::new(redraw) as _)]).unwrap();
    let mut chain = Chain::start(&ring, &moves, Seed(2).chain(0)).unwrap();
    for _ in 0..10_000 {
        let before = chain.state().clone();
        let step = chain.step().unwrap();
        assert!(step.decision == Decision::Accepted || *chain.state() == before);
        assert!(ring.weights[chain.state().draw] > 0.0, "a forbidden place was entered");
    }
    let [walk, redraw] = chain.counts() else { panic!("two moves") };
    assert_eq!(walk.made() + redraw.made(), 10_000);
    assert!(walk.rejected_by_prior > 0 && walk.rejected > 0 && walk.accepted > 0, "{walk:?}");
    assert!(redraw.rejected_by_prior == 0 && redraw.accepted > 0, "{redraw:?}");
    assert!((0.0..=1.0).contains(&walk.acceptance()));
}

/// The share of iterations at each place follows the target: 200,000 iterations from a start drawn from the prior.
#[test]
fn a_long_chain_has_the_law_of_the_target() {
    let ring = Ring::of_nine(1.0);
    let moves = Mixture::of(Box::new(Redraw { symmetric: false }) as _);
    let mut chain = Chain::start(&ring, &moves, Seed(6).chain(0)).unwrap();
    let iterations = 200_000;
    let mut visits = [0_u32; 9];
    for _ in 0..iterations {
        chain.step().unwrap();
        visits[chain.state().draw] += 1;
    }
    let weight = |place: usize| ring.weights[place] * if place.is_multiple_of(2) { std::f64::consts::E } else { 1.0 };
    let total: f64 = (0..9).map(weight).sum();
    for (place, count) in visits.iter().enumerate() {
        let share = weight(place) / total;
        // An independence sampler whose weights differ by at most a factor e has a relaxation time of at most e. So the
        // ESS is above 200,000 / (2e) = 36,000; six standard deviations.
        let margin = 6.0 * (share * (1.0 - share) / 36_000.0).sqrt();
        assert!((f64::from(*count) / f64::from(iterations) - share).abs() <= margin, "{visits:?}");
    }
}
