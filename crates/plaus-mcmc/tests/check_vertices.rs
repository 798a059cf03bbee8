//! The checks on continuous offsets. Wrong twins: a change-all taken for symmetric, fresh offsets in a random direction
//! with a Gaussian length, both together (the paper's change-all).

// Helpers outside of `#[test]` functions panic and print as tests do.
#![allow(clippy::print_stdout)]

use crate::toys::vertices::{ChangeAll, Fresh, RedrawOne, Vertices, WalkOne, radius};
use plaus_dist::{LogPotential, Seed, math};
use plaus_mcmc::check::{OneStep, OneStepReport, PriorOnly, Ratios, Statistic, one_step, prior, ratios, rejection};
use plaus_mcmc::view::lend;
use plaus_mcmc::{Mixture, Move, StateOf};

type Kernel = fn() -> Box<dyn Move<Vertices>>;

const PLAN: OneStep = OneStep { seed: Seed(3), samples: 40_000, steps: 1, cells: 16, false_alarm: 1e-6 };
const CHANGE_ALL: ChangeAll = ChangeAll { fresh: Fresh::Gaussian, symmetric: false };

fn statistics<'a>(world: &'a Vertices) -> [Statistic<'a, Vec<[f64; 3]>, u64>; 3] {
    [
        Statistic::new("first coordinate / mm", |state: &StateOf<Vertices>| 1e3 * state.draw[0][0]),
        Statistic::new("squared radius", |state: &StateOf<Vertices>| radius(&state.draw, world)),
        Statistic::new("nearest / mm", |state: &StateOf<Vertices>| {
            let norm = |offset: &[f64; 3]| math::hypot(math::hypot(offset[0], offset[1]), offset[2]);
            1e3 * state.draw.iter().map(norm).fold(f64::INFINITY, f64::min)
        }),
    ]
}

/// One step of a move from exact draws at λ = 1 and λ = e.
fn stepped(kernel: impl Fn() -> Box<dyn Move<Vertices>>) -> [OneStepReport; 2] {
    let world = Vertices::new(4, 1.0);
    let flat = PriorOnly::new(&world);
    let moves = lend::<PriorOnly<'_, Vertices>>(Mixture::of(kernel())).unwrap();
    let at_one = one_step(&flat, &moves, prior(&flat), &statistics(&world), PLAN).unwrap();
    let exact = rejection(&world, LogPotential::new(4.0).unwrap());
    let at_e = one_step(&world, &Mixture::of(kernel()), exact, &statistics(&world), PLAN).unwrap();
    [at_one, at_e]
}

#[test]
fn right_moves_keep_the_law() {
    let kernels: [Kernel; 3] = [|| Box::new(CHANGE_ALL), || Box::new(RedrawOne(Fresh::Gaussian)), || Box::new(WalkOne)];
    for report in kernels.iter().flat_map(stepped) {
        assert!(report.passed() && report.accepted() > 0, "{report}");
    }
}

#[test]
fn wrong_twins_are_caught() {
    let twins: [(&str, Kernel); 4] = [
        ("symmetric change-all", || Box::new(ChangeAll { symmetric: true, ..CHANGE_ALL })),
        ("radial change-all", || Box::new(ChangeAll { fresh: Fresh::Radial, ..CHANGE_ALL })),
        ("the paper's change-all", || Box::new(ChangeAll { fresh: Fresh::Radial, symmetric: true })),
        ("radial redraw of one", || Box::new(RedrawOne(Fresh::Radial))),
    ];
    for (name, twin) in twins {
        for report in stepped(twin) {
            println!("{name}: p = {}", report.p());
            assert!(!report.passed(), "{name} went unnoticed: {report}");
        }
    }
}

#[test]
fn ratios_agree_there_and_back() {
    let world = Vertices::new(48, 5.0);
    for kernel in [&CHANGE_ALL as &dyn Move<Vertices>, &RedrawOne(Fresh::Gaussian), &WalkOne] {
        let report = ratios(&world, kernel, prior(&world), Ratios::default()).unwrap();
        assert!(report.passed(), "{report}");
    }
}
