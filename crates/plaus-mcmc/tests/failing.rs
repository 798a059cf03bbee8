//! Draws whose simulation fails: runs go on, and count them.

use plaus_dist::{Density, Gaussian, LogDensity, LogPotential, LogRatio, Sample, Seed, Stream};
use plaus_mcmc::{
    At, Block, Chain, ChainError, Control, Failure, Failures, Goal, Independent, Mixture, ModelError, Move, Plan,
    Progress, Proposal, Simulated, Sink, Snapshot, SolutionClass, Start, StateRefOf, Target, Transition, run,
};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// A number that is simulated to itself, unless its second digit is one of some.
struct Brittle {
    law: Gaussian,
    /// Second digits of numbers whose simulation fails.
    bad: std::ops::Range<i64>,
    /// How many simulations there were, and how many of them failed, by its own count.
    made: AtomicU64,
    broken: AtomicU64,
    /// The twin hides them, as if the constraint alone forbade these draws.
    tells: bool,
}

impl Brittle {
    fn new(bad: std::ops::Range<i64>) -> Self {
        let law = Gaussian::new(0.0, 1.0).unwrap();
        Self { law, bad, made: AtomicU64::new(0), broken: AtomicU64::new(0), tells: true }
    }

    fn digit(draw: f64) -> i64 {
        (draw * 100.0).floor().rem_euclid(10.0) as i64
    }
}

impl Target for Brittle {
    type Draw = f64;
    type Outcome = Result<f64, i64>;
    type Scratch = ();

    fn start(&self, stream: &mut Stream) -> f64 {
        self.law.sample(stream)
    }

    fn log_prior(&self, draw: &f64) -> Result<LogDensity, ModelError> {
        Ok(self.law.log_density(draw)?)
    }

    fn simulate(
        &self,
        draw: &f64,
        _: Option<StateRefOf<'_, Self>>,
        _: LogPotential,
        (): &mut (),
    ) -> Result<Simulated<Result<f64, i64>>, ModelError> {
        let digit = Self::digit(*draw);
        let fails = self.bad.contains(&digit);
        self.made.fetch_add(1, Relaxed);
        self.broken.fetch_add(u64::from(fails), Relaxed);
        Ok(Simulated::Complete(if fails { Err(digit) } else { Ok(*draw) }))
    }

    fn log_constraint(&self, outcome: &Result<f64, i64>) -> Result<LogPotential, ModelError> {
        Ok(if outcome.is_ok() { LogPotential::ONE } else { LogPotential::ZERO })
    }

    fn failure(&self, outcome: &Result<f64, i64>) -> Option<Failure> {
        let digit = outcome.err().filter(|_| self.tells)?;
        let body = format!("ball_{digit}");
        Some(Failure { doing: format!("{body} touches wall"), body, time: 0.31, cause: "not finite".into() })
    }

    fn most(&self) -> Option<LogPotential> {
        Some(LogPotential::ONE)
    }
}

impl Goal for Brittle {
    fn class(&self, state: StateRefOf<'_, Self>) -> Option<SolutionClass> {
        Some(SolutionClass::of([(state.draw * 4.0).floor() as i64]))
    }
}

/// A symmetric step.
struct Step(Gaussian);

impl Move<Brittle> for Step {
    fn name(&self) -> &str {
        "step"
    }

    fn propose(&self, _: At<'_, Brittle>, candidate: &mut f64, stream: &mut Stream) -> Result<Proposal, ModelError> {
        *candidate += self.0.sample(stream);
        Ok(Proposal::SYMMETRIC)
    }

    fn log_ratio(&self, _: Transition<'_, Brittle>) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::ONE)
    }
}

fn steps() -> Mixture<Brittle> {
    Mixture::of(Box::new(Step(Gaussian::new(0.0, 0.5).unwrap())))
}

const PLAN: Plan = Plan {
    seed: Seed(5),
    chains: 3,
    warmup: 100,
    iterations: 900,
    thin: 1,
    block: 64,
    solutions: None,
    rungs: 1,
    adapt_rungs: false,
    swap_every: 7,
    adapt: false,
    weigh: false,
    settle: false,
    climbs: 0,
    sampled: false,
};

/// Keeps the last snapshot of each chain; stops after some rounds.
#[derive(Default)]
struct Last {
    snapshots: Vec<Option<Snapshot<f64, Result<f64, i64>>>>,
    rounds: usize,
    stop_after: Option<usize>,
}

impl Sink<f64, Result<f64, i64>> for Last {
    type Error = String;

    fn block(
        &mut self,
        chain: u32,
        _: Block<f64, Result<f64, i64>>,
        snapshot: &Snapshot<f64, Result<f64, i64>>,
    ) -> Result<(), String> {
        self.snapshots.resize(self.snapshots.len().max(chain as usize + 1), None);
        self.snapshots[chain as usize] = Some(snapshot.clone());
        Ok(())
    }

    fn round(&mut self, _: &Progress<'_>) -> Result<Control, String> {
        self.rounds += 1;
        Ok(if Some(self.rounds) == self.stop_after { Control::Stop } else { Control::Continue })
    }
}

impl Last {
    fn failures(&self) -> Failures {
        let mut all = Failures::default();
        self.snapshots.iter().flatten().for_each(|snapshot| all.add(&snapshot.failures));
        all
    }
}

/// Runs a plan, in pieces of some rounds if it is interrupted; gives the failures of each chain.
fn failures(target: &Brittle, moves: &Mixture<Brittle>, plan: Plan, threads: usize, rounds: Option<usize>) -> Last {
    let mut starts: Vec<Start<f64, Result<f64, i64>>> = Vec::new();
    loop {
        let mut last = Last { stop_after: rounds, ..Last::default() };
        let ended = run(target, moves, plan, std::mem::take(&mut starts), threads, &mut last);
        if ended.unwrap() != plaus_mcmc::Ending::Stopped {
            return last;
        }
        let start = |snapshot: Snapshot<_, _>| Start { snapshot, distinct: plaus_mcmc::Distinct::default() };
        starts = last.snapshots.into_iter().flatten().map(start).collect();
    }
}

/// A run goes on past failures, and its counts are those of the target itself, with one chain or replicas, whatever the
/// threads and interruptions; a twin that keeps them to itself is caught.
#[test]
fn failures_are_counted_and_end_nothing() {
    for rungs in [1, 4] {
        let plan = Plan { rungs, ..PLAN };
        let target = Brittle::new(3..5);
        let whole = failures(&target, &steps(), plan, 1, None);
        let counted = whole.failures();
        assert_eq!(counted.simulated, target.made.load(Relaxed));
        assert_eq!(counted.failed(), target.broken.load(Relaxed));
        // A fifth of some thousand draws: five standard deviations.
        let share = counted.failed() as f64 / counted.simulated as f64;
        assert!((share - 0.2).abs() < 5.0 * (0.16 / counted.simulated as f64).sqrt(), "{share}");
        assert_eq!(counted.kinds().len(), 2, "two bodies, one cause");
        assert!(counted.to_string().contains("touches wall at 0.31 s: not finite (the first of "), "{counted}");
        for (threads, rounds) in [(4, None), (1, Some(1)), (3, Some(2))] {
            let again = failures(&Brittle::new(3..5), &steps(), plan, threads, rounds);
            let last = |last: &Last| last.snapshots.iter().map(|s| s.clone().unwrap()).collect::<Vec<_>>();
            assert_eq!(last(&again), last(&whole), "{rungs} rungs, {threads} threads, {rounds:?}");
        }
        let silent = Brittle { tells: false, ..Brittle::new(3..5) };
        let told = failures(&silent, &steps(), plan, 1, None).failures();
        assert_eq!(told.simulated, silent.made.load(Relaxed));
        assert_ne!(told.failed(), silent.broken.load(Relaxed), "the twin");
    }
}

/// Independent draws count theirs too.
#[test]
fn independent_draws_that_fail_are_counted() {
    let target = Brittle::new(0..9);
    let counted = failures(&target, &Independent::mixture(), PLAN, 2, Some(1)).failures();
    assert_eq!((counted.simulated, counted.failed()), (target.made.into_inner(), target.broken.into_inner()));
    assert!(counted.failed() > counted.simulated / 2);
}

/// A start that fails is drawn again; if all fail, the error says what happened.
#[test]
fn a_start_that_fails_is_drawn_again() {
    let (target, moves) = (Brittle::new(0..9), steps());
    let chain = Chain::start(&target, &moves, Seed(4).chain(0)).unwrap();
    assert_eq!(Brittle::digit(chain.state().draw), 9);
    assert_eq!(chain.failures().failed() + 1, chain.failures().simulated);
    let never = Brittle::new(0..10);
    let error = Chain::start(&never, &moves, Seed(4).chain(0)).err().unwrap();
    assert!(matches!(&error, ChainError::NoStart { failures } if failures.failed() == 10_000), "{error}");
    assert!(error.to_string().contains("10000 of 10000 draws failed, and have probability 0: ball_"), "{error}");
}
