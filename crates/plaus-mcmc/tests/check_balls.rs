//! The checks on balls that are dropped or not. Wrong twins: a change-all taken for symmetric, toggles that leave out
//! the balls they do not toggle, toggles that measure area in another unit, a move that leaves out the part of its
//! ratio that depends on the outcome.

// Helpers outside of `#[test]` functions panic and print as tests do.
#![allow(clippy::print_stdout)]

use crate::toys::balls::{Balls, Drops, active, filled};
use crate::toys::balls_moves::{ChangeAll, Fault, Redrop, Toggle, Ways};
use crate::toys::remembering::Remembering;
use plaus_dist::{LogPotential, Seed};
use plaus_mcmc::check::{
    Balance, BalanceReport, Enumerable, OneStep, OneStepReport, PriorOnly, Ratios, Statistic, balance, early_exit,
    one_step, prior, ratio_pair, ratios, rejection,
};
use plaus_mcmc::view::lend;
use plaus_mcmc::{Mixture, Move, Redraw, StateOf, Tempered};
use std::sync::Arc;

const CHANGE_ALL: ChangeAll = ChangeAll { symmetric: false };
const REDROP: Redrop = Redrop { fault: Fault::None };
/// 5 cm × 5 cm, in m².
const AREA: f64 = 0.0025;

const PLAN: OneStep = OneStep { seed: Seed(7), samples: 40_000, steps: 1, cells: 16, false_alarm: 1e-6 };

fn balanced(balls: &Balls, moves: &[(f64, &dyn Enumerable<Balls>)]) -> BalanceReport {
    balance(balls, balls.all(), moves, Balance { tries: 2_000, ..Balance::default() }).unwrap()
}

fn statistics<'a>() -> [Statistic<'a, Drops, Vec<u32>>; 3] {
    [
        Statistic::new("active", |state: &StateOf<Balls>| active(&state.draw) as f64),
        Statistic::new("filled", |state: &StateOf<Balls>| filled(&state.outcome) as f64),
        Statistic::new("sum of places", |state: &StateOf<Balls>| state.draw.iter().flatten().sum()),
    ]
}

/// One step of a move from exact draws: at λ = 1 from the prior alone, at λ = e and e³ by rejection.
fn stepped(kernel: impl Fn() -> Box<dyn Move<Balls>>, count: usize, bins: usize) -> [OneStepReport; 3] {
    let balls = Balls::anywhere(count, bins, AREA, 1.0);
    let flat = PriorOnly::new(&balls);
    let moves = lend::<PriorOnly<'_, Balls>>(Mixture::of(kernel())).unwrap();
    let at_one = one_step(&flat, &moves, prior(&flat), &statistics(), PLAN).unwrap();
    let [at_e, at_e3] = [1.0, 3.0].map(|ln_lambda| {
        let balls = Balls::anywhere(count, bins, AREA, ln_lambda);
        let bound = LogPotential::new(ln_lambda * bins as f64).unwrap();
        one_step(&balls, &Mixture::of(kernel()), rejection(&balls, bound), &statistics(), PLAN).unwrap()
    });
    [at_one, at_e, at_e3]
}

fn all_pass(reports: &[OneStepReport]) {
    for report in reports {
        assert!(report.passed() && report.accepted() > 0, "{report}");
    }
}

fn all_fail(reports: &[OneStepReport], twin: &str) {
    for report in reports {
        println!("{twin}: p = {}", report.p());
        assert!(!report.passed(), "{twin} went unnoticed: {report}");
    }
}

#[test]
fn every_move_and_the_mixture_are_in_balance() {
    for ln_lambda in [0.0, 1.0, 3.0] {
        let balls = Balls::on_cells(3, 3, 3, ln_lambda);
        let report = balanced(&balls, &[(0.5, &Toggle::RIGHT), (0.3, &CHANGE_ALL), (0.2, &REDROP)]);
        assert!(report.passed(), "{report}");
    }
}

#[test]
fn wrong_twins_are_out_of_balance() {
    let forgetful = Toggle { forgets_untoggled: true, ..Toggle::RIGHT };
    let slipped = Toggle { unit: 1e6, ..Toggle::RIGHT };
    let symmetric = ChangeAll { symmetric: true };
    let hasty = Redrop { fault: Fault::Forgotten };
    let twins: [&dyn Enumerable<Balls>; 4] = [&forgetful, &slipped, &symmetric, &hasty];
    for ln_lambda in [0.0, 1.0, 3.0] {
        for twin in twins {
            let report = balanced(&Balls::on_cells(3, 3, 3, ln_lambda), &[(1.0, twin)]);
            println!("ln λ = {ln_lambda}, wrong `{}`: {:e}", twin.name(), report.mixture.value);
            assert!(!report.mixture_passed() && report.mixture.value > 1e-5, "{report}");
        }
    }
}

/// Activate and deactivate undo each other, so they are in balance only together, and only with equal weights.
#[test]
fn moves_that_undo_each_other_are_in_balance_together() {
    let [activate, deactivate] = [Ways::Activate, Ways::Deactivate].map(|ways| Toggle { ways, ..Toggle::RIGHT });
    let balls = Balls::on_cells(3, 2, 2, 1.0);
    let equal = balanced(&balls, &[(0.3, &activate), (0.3, &deactivate), (0.4, &CHANGE_ALL)]);
    assert!(equal.mixture_passed() && !equal.passed(), "{equal}");
    let unequal = balanced(&balls, &[(0.4, &activate), (0.2, &deactivate)]);
    assert!(!unequal.mixture_passed(), "{unequal}");
}

#[test]
fn ratios_agree_there_and_back() {
    let balls = Balls::anywhere(6, 4, AREA, 1.0);
    for kernel in [&Toggle::RIGHT as &dyn Move<Balls>, &CHANGE_ALL, &REDROP, &Redraw] {
        let report = ratios(&balls, kernel, prior(&balls), Ratios::default()).unwrap();
        assert!(report.passed(), "{report}");
    }
}

#[test]
fn ratios_catch_what_they_can() {
    let balls = Balls::anywhere(6, 4, AREA, 1.0);
    let check = |kernel: &dyn Move<Balls>| ratios(&balls, kernel, prior(&balls), Ratios::default()).unwrap();
    let unannounced = check(&Redrop { fault: Fault::Unannounced });
    assert!(!unannounced.passed() && unannounced.agreement.index.is_some(), "{unannounced}");
    let low = check(&Redrop { fault: Fault::Bound });
    assert!(!low.passed() && low.bound.value > 0.4, "{low}"); // the bound is ln 3 − ln 2 too low
    let index = low.bound.index.unwrap();
    let again = ratio_pair(&balls, &Redrop { fault: Fault::Bound }, prior(&balls), low.plan.seed, index).unwrap();
    assert_eq!(again.ratios.unwrap().excess, low.bound.value);
    // Consistent but wrong: only `one_step` can catch this.
    assert!(check(&Redrop { fault: Fault::Forgotten }).passed());
    assert!(check(&ChangeAll { symmetric: true }).passed());
}

#[test]
fn toggles_keep_the_law_and_their_twins_do_not() {
    all_pass(&stepped(|| Box::new(Toggle::RIGHT), 5, 3));
    all_fail(&stepped(|| Box::new(Toggle { forgets_untoggled: true, ..Toggle::RIGHT }), 5, 3), "missing (1 − η)");
    all_fail(&stepped(|| Box::new(Toggle { unit: 1e6, ..Toggle::RIGHT }), 2, 2), "area in mm²");
}

#[test]
fn change_all_keeps_the_law_and_its_twin_does_not() {
    all_pass(&stepped(|| Box::new(CHANGE_ALL), 5, 3));
    // Tempering's own move, which suits any target.
    all_pass(&stepped(|| Box::new(Redraw), 5, 3));
    all_fail(&stepped(|| Box::new(ChangeAll { symmetric: true }), 5, 3), "symmetric change-all");
}

#[test]
fn a_ratio_known_after_the_simulation_keeps_the_law_and_its_twins_do_not() {
    all_pass(&stepped(|| Box::new(REDROP), 5, 3));
    all_fail(&stepped(|| Box::new(Redrop { fault: Fault::Forgotten }), 5, 3), "forgotten later part");
    all_fail(&stepped(|| Box::new(Redrop { fault: Fault::Unannounced }), 5, 3), "unannounced later part");
}

fn mixture(fault: Fault) -> Arc<Mixture<Balls>> {
    let moves: Vec<(f64, Box<dyn Move<Balls>>)> =
        vec![(0.5, Box::new(Toggle::RIGHT)), (0.2, Box::new(CHANGE_ALL)), (0.3, Box::new(Redrop { fault }))];
    Arc::new(Mixture::new(moves).unwrap())
}

#[test]
fn early_stops_change_nothing_unless_they_are_wrong() {
    let right = early_exit(&Balls::anywhere(6, 4, AREA, 2.0), mixture(Fault::None), Seed(5), 20_000).unwrap();
    assert!(right.passed() && right.stopped_early > 1000, "{right}");
    let hasty = Balls { stops_too_early: true, ..Balls::anywhere(6, 4, AREA, 2.0) };
    let wrong = early_exit(&hasty, mixture(Fault::None), Seed(5), 20_000).unwrap();
    println!("{wrong}");
    assert!(!wrong.passed(), "{wrong}");
}

/// If the bound of a later part is too low, simulations stop that would have been accepted. So the twin and its plain
/// chain part.
#[test]
fn a_bound_that_is_too_low_is_caught() {
    let low = early_exit(&Balls::anywhere(6, 4, AREA, 2.0), mixture(Fault::Bound), Seed(5), 20_000).unwrap();
    println!("{low}");
    assert!(!low.passed(), "{low}");
}

/// A tempered chain stops only simulations that would not have been accepted: the floor is converted without losing a
/// rounding.
#[test]
fn early_stops_survive_tempering() {
    let balls: &'static Balls = Box::leak(Box::new(Balls::anywhere(6, 4, AREA, 2.0)));
    for beta in [0.0, 0.1, 0.37, 1.0, 3.0] {
        let tempered = Tempered::new(balls, beta).unwrap();
        let moves = lend::<Tempered<'static, Balls>>(mixture(Fault::None)).unwrap();
        let report = early_exit(&tempered, Arc::new(moves), Seed(8), 10_000).unwrap();
        assert!(report.passed() && report.stopped_early > 0, "β = {beta}: {report}");
    }
    let moves = lend::<PriorOnly<'static, Balls>>(mixture(Fault::None)).unwrap();
    let report = early_exit(&PriorOnly::new(balls), Arc::new(moves), Seed(8), 10_000).unwrap();
    assert!(report.passed() && report.stopped_early > 0, "{report}");
}

/// Memory about the current state that follows every simulation instead of only the accepted ones.
#[test]
fn reuse_that_goes_stale_is_caught() {
    let right = early_exit(
        &Remembering { balls: Balls::anywhere(4, 3, AREA, 1.0), forgets_verdict: false },
        lent(),
        Seed(9),
        5_000,
    );
    assert!(right.as_ref().unwrap().passed(), "{}", right.unwrap());
    let wrong = early_exit(
        &Remembering { balls: Balls::anywhere(4, 3, AREA, 1.0), forgets_verdict: true },
        lent(),
        Seed(9),
        5_000,
    );
    println!("{}", wrong.as_ref().unwrap());
    assert!(!wrong.unwrap().passed());
}

fn lent() -> Arc<Mixture<Remembering>> {
    let shared = mixture(Fault::None);
    Arc::new(lend::<Remembering>(shared).unwrap())
}
