//! The checks on a ring of places, a walk around it and a fresh draw; wrong twins: a redraw taken for symmetric, a
//! chain that ignores −∞ priors.

// Helpers outside of `#[test]` functions panic and print as tests do.
#![allow(clippy::print_stdout)]

use crate::toys::IgnoresForbidden;
use crate::toys::ring::{Redraw, Ring, Walk};
use plaus_dist::{LogPotential, LogRatio, Seed, Stream};
use plaus_mcmc::check::{
    Balance, BalanceReport, Branch, CheckError, Enumerable, LogP, OneStep, OneStepReport, PriorOnly, Ratios, Statistic,
    any_of, balance, one_step, prior, ratios, rejection, visited,
};
use plaus_mcmc::view::lend;
use plaus_mcmc::{At, Mixture, ModelError, Move, Path, Proposal, State, StateRefOf, Target, Tempered, Transition};

const RIGHT: Redraw = Redraw { symmetric: false };
const SYMMETRIC: Redraw = Redraw { symmetric: true };

/// Exact draws of places cost little, so there are enough to catch a fault of a few per cent.
const PLAN: OneStep = OneStep { seed: Seed(11), samples: 40_000, steps: 1, cells: 16, false_alarm: 1e-6 };

fn place<'a>() -> Statistic<'a, usize, usize> {
    Statistic::new("place", |state: &State<usize, usize>| state.draw as f64)
}

fn balanced(ring: &Ring, redraw: &Redraw) -> BalanceReport {
    let moves: [(f64, &dyn Enumerable<Ring>); 2] = [(0.7, &Walk), (0.3, redraw)];
    balance(ring, ring.all(), &moves, Balance::default()).unwrap()
}

fn stepped_at_the_prior(redraw: Redraw) -> OneStepReport {
    let ring = Ring::of_nine(1.0);
    let flat = PriorOnly::new(&ring);
    let moves = lend::<PriorOnly<'_, Ring>>(Mixture::of(Box::new(redraw))).unwrap();
    one_step(&flat, &moves, prior(&flat), &[place()], PLAN).unwrap()
}

fn stepped(redraw: Redraw, ln_lambda: f64) -> OneStepReport {
    let ring = Ring::of_nine(ln_lambda);
    let moves = Mixture::new(vec![(0.5, Box::new(Walk) as _), (0.5, Box::new(redraw) as _)]).unwrap();
    let bound = LogPotential::new(ln_lambda).unwrap();
    one_step(&ring, &moves, rejection(&ring, bound), &[place()], PLAN).unwrap()
}

#[test]
fn moves_are_in_balance_and_a_symmetric_redraw_is_not() {
    for ln_lambda in [0.0, 1.0, 3.0] {
        let right = balanced(&Ring::of_nine(ln_lambda), &RIGHT);
        assert!(right.passed(), "{right}");
        let wrong = balanced(&Ring::of_nine(ln_lambda), &SYMMETRIC);
        println!("symmetric redraw: {wrong}");
        assert!(!wrong.mixture_passed() && wrong.mixture.value > 1e-3, "{wrong}");
    }
}

/// A move whose list, or whose ratio, does not describe what it does.
struct Lying<'a> {
    listed: &'a dyn Enumerable<Ring>,
    done: &'a dyn Move<Ring>,
}

impl Move<Ring> for Lying<'_> {
    fn name(&self) -> &str {
        "lying"
    }
    fn propose(&self, at: At<'_, Ring>, place: &mut usize, stream: &mut Stream) -> Result<Proposal, ModelError> {
        self.done.propose(at, place, stream)
    }
    fn log_ratio(&self, step: Transition<'_, Ring>) -> Result<LogRatio, ModelError> {
        self.listed.log_ratio(step)
    }
    fn reverse(&self, path: Path) -> Path {
        self.listed.reverse(path)
    }
}

impl Enumerable<Ring> for Lying<'_> {
    fn branches(&self, ring: &Ring, state: StateRefOf<'_, Ring>) -> Result<Vec<Branch<usize>>, ModelError> {
        self.listed.branches(ring, state)
    }
}

#[test]
fn a_list_that_is_not_what_a_move_does_is_caught() {
    let ring = Ring::of_nine(1.0);
    let check = |lying: Lying<'_>| balance(&ring, ring.all(), &[(1.0, &lying)], Balance::default()).unwrap();
    // In perfect balance on paper, but not what is proposed.
    let other_law = check(Lying { listed: &Walk, done: &RIGHT });
    assert!(other_law.mixture.value < 1e-12 && !other_law.passed(), "{other_law}");
    assert_eq!(other_law.moves[0].frequencies.unwrap().p, LogP::ZERO);
    let other_ratio = check(Lying { listed: &RIGHT, done: &SYMMETRIC });
    assert!(other_ratio.mixture.value < 1e-12 && !other_ratio.passed(), "{other_ratio}");
    assert!(other_ratio.moves[0].frequencies.unwrap().gap > 0.1);
    // Slightly different weights: the likeliest place comes up 36 % of the time instead of 32 %.
    let mut tilted = Ring::of_nine(1.0);
    tilted.weights[4] *= 1.15;
    let plan = Balance { tries: 20_000, ..Balance::default() };
    let tilted = balance(&ring, ring.all(), &[(1.0, &Tilted(tilted))], plan).unwrap();
    println!("{tilted}");
    let deviates = tilted.moves[0].frequencies.is_some_and(|found| found.p.value() < plan.false_alarm);
    assert!(tilted.mixture.value < 1e-12 && deviates && !tilted.passed(), "{tilted}");
}

/// A redraw from the prior of another ring, listed as if it were this one's.
struct Tilted(Ring);

impl Move<Ring> for Tilted {
    fn name(&self) -> &str {
        "tilted"
    }
    fn propose(&self, _: At<'_, Ring>, place: &mut usize, stream: &mut Stream) -> Result<Proposal, ModelError> {
        *place = self.0.start(stream);
        Ok(Proposal::SYMMETRIC)
    }
    fn log_ratio(&self, step: Transition<'_, Ring>) -> Result<LogRatio, ModelError> {
        RIGHT.log_ratio(step)
    }
}

impl Enumerable<Ring> for Tilted {
    fn branches(&self, ring: &Ring, state: StateRefOf<'_, Ring>) -> Result<Vec<Branch<usize>>, ModelError> {
        RIGHT.branches(ring, state)
    }
}

#[test]
fn ratios_agree_there_and_back() {
    let ring = Ring::of_nine(1.0);
    for kernel in [&Walk as &dyn Enumerable<Ring>, &RIGHT] {
        let report = ratios(&ring, kernel, prior(&ring), Ratios::default()).unwrap();
        assert!(report.passed(), "{report}");
    }
    let moves = Mixture::of(Box::new(RIGHT) as _);
    let states = visited(&ring, &moves, Seed(3), 2, 100).unwrap();
    let report = ratios(&ring, &Walk, any_of(&states), Ratios::default()).unwrap();
    assert!(report.passed() && report.impossible > 0, "{report}");
}

#[test]
fn a_step_keeps_the_law_and_a_symmetric_redraw_does_not() {
    for (right, wrong) in [
        (stepped_at_the_prior(RIGHT), stepped_at_the_prior(SYMMETRIC)),
        (stepped(RIGHT, 1.0), stepped(SYMMETRIC, 1.0)),
        (stepped(RIGHT, 3.0), stepped(SYMMETRIC, 3.0)),
    ] {
        assert!(right.passed() && right.accepted() > 0, "{right}");
        println!("symmetric redraw: {wrong}");
        assert!(!wrong.passed(), "{wrong}");
    }
}

#[test]
fn a_chain_that_ignores_forbidden_priors_is_caught() {
    let ring = Ring::of_nine(1.0);
    let careless = IgnoresForbidden(&ring);
    let moves = lend::<IgnoresForbidden<'_, Ring>>(Mixture::of(Box::new(Walk))).unwrap();
    let exact = || rejection(&ring, LogPotential::new(1.0).unwrap());
    let wrong = one_step(&careless, &moves, exact(), &[place()], PLAN).unwrap();
    println!("ignores −∞: {wrong}");
    assert!(!wrong.passed(), "{wrong}");
    let right = one_step(&ring, &Mixture::of(Box::new(Walk)), exact(), &[place()], PLAN).unwrap();
    assert!(right.passed(), "{right}");
}

/// At β the chain has the law of λ^β. Its exact draws come from the tempered target itself, by rejection.
#[test]
fn tempering_weakens_the_constraint() {
    let ring = Ring::of_nine(3.0);
    for beta in [0.0, 0.3, 1.0] {
        let tempered = Tempered::new(&ring, beta).unwrap();
        let both = Mixture::new(vec![(0.5, Box::new(Walk) as _), (0.5, Box::new(RIGHT) as _)]).unwrap();
        let moves = lend::<Tempered<'_, Ring>>(both).unwrap();
        let exact = rejection(&tempered, LogPotential::new(3.0 * beta).unwrap());
        let report = one_step(&tempered, &moves, exact, &[place()], PLAN).unwrap();
        assert!(report.passed(), "{report}");

        let weaker = Ring::of_nine(3.0 * beta);
        let moves: [(f64, &dyn Enumerable<Ring>); 1] = [(1.0, &RIGHT)];
        assert!(balance(&weaker, weaker.all(), &moves, Balance::default()).unwrap().passed());
        let states = |state: &State<usize, usize>| (state.draw, state.log_constraint.value());
        let mut draws = plaus_mcmc::check::prior(&tempered);
        let mut same = plaus_mcmc::check::prior(&weaker);
        for iteration in 0..100 {
            let stream = || Seed(5).chain(0).at(iteration, plaus_dist::Purpose(99));
            let (a, b) = (draws(&mut stream()).unwrap(), same(&mut stream()).unwrap());
            assert_eq!(states(&a), states(&b));
        }
    }
    assert!(Tempered::new(&ring, -1.0).is_err());
    assert!(Tempered::new(&ring, f64::NAN).is_err());
}

#[test]
fn misuse_is_an_error() {
    let ring = Ring::of_nine(1.0);
    let moves: [(f64, &dyn Enumerable<Ring>); 1] = [(1.0, &RIGHT)];
    let twice = balance(&ring, vec![0, 1, 2, 0], &moves, Balance::default());
    assert!(matches!(twice, Err(CheckError::Repeated { first: 0, second: 3 })), "{twice:?}");
    let missing = balance(&ring, vec![0, 1, 2], &moves, Balance::default());
    assert!(matches!(missing, Err(CheckError::Unlisted { from: 0, .. })), "{missing:?}");
    let none = balance(&ring, ring.all(), &[], Balance::default());
    assert!(matches!(none, Err(CheckError::Setting { setting: "number of moves", .. })), "{none:?}");

    let low = rejection(&ring, LogPotential::new(0.5).unwrap());
    let mixture = Mixture::of(Box::new(RIGHT) as _);
    let refused = one_step(&ring, &mixture, low, &[], PLAN).unwrap_err();
    assert!(refused.to_string().contains("exceeds the bound 0.5"), "{refused}");
    let infinite = Statistic::new("1/place", |state: &State<usize, usize>| 1.0 / state.draw as f64);
    let refused = one_step(&ring, &mixture, prior(&ring), &[infinite], PLAN).unwrap_err();
    assert!(refused.to_string().starts_with("statistic `1/place` is inf"), "{refused}");
    for plan in [
        OneStep { samples: 10, ..PLAN },
        OneStep { steps: 0, ..PLAN },
        OneStep { cells: 1, ..PLAN },
        OneStep { false_alarm: 0.0, ..PLAN },
        OneStep { false_alarm: f64::NAN, ..PLAN },
    ] {
        assert!(matches!(one_step(&ring, &mixture, prior(&ring), &[], plan), Err(CheckError::Setting { .. })));
    }
}
