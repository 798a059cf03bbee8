//! Every move leaves the prior and the constrained target invariant.

use super::straight::{AnyMove, Straight, all_moves, small, statistics};
use plaus_dist::LogPotential;
use plaus_mcmc::check::{
    OneStep, OneStepReport, PriorOnly, Ratios, any_of, one_step, prior, ratios, rejection, visited,
};
use plaus_mcmc::view::lend;
use plaus_mcmc::{At, Mixture, State, Target};
use plaus_scenes::spelling::Spelling;
use plaus_scenes::{Rules, Scene};

const SAMPLES: u64 = 20_000;

/// One step of `kernel` alone from draws of the prior, with the constraint switched off.
pub(crate) fn free(scene: &Spelling, kernel: AnyMove) -> OneStepReport {
    // λ = 1: every outcome is as good as any other.
    assert!(scene.ln_lambda() == 0.0);
    let toy = Straight(scene);
    let moves = lend::<Straight>(Mixture::of(kernel)).unwrap();
    let plan = OneStep { samples: SAMPLES, ..OneStep::default() };
    one_step(&toy, &moves, prior(&toy), &statistics(scene), plan).unwrap()
}

/// One step of `kernel` alone from exact draws with the constraint on.
pub(crate) fn constrained(scene: &Spelling, kernel: AnyMove) -> OneStepReport {
    let toy = Straight(scene);
    let moves = lend::<Straight>(Mixture::of(kernel)).unwrap();
    let plan = OneStep { samples: SAMPLES, ..OneStep::default() };
    let bound = LogPotential::new(scene.ln_lambda() * scene.word().designated().len() as f64).unwrap();
    one_step(&toy, &moves, rejection(&toy, bound), &statistics(scene), plan).unwrap()
}

#[test]
fn every_move_leaves_the_prior_invariant() {
    let scene = small(0.0);
    for kernel in all_moves(&scene) {
        let report = free(&scene, kernel);
        assert!(report.passed(), "{report}");
        assert!(report.accepted() > 500, "{report}");
    }
}

#[test]
fn every_move_leaves_the_constrained_target_invariant() {
    for ln_lambda in [0.5, 1.0] {
        let scene = small(ln_lambda);
        for kernel in all_moves(&scene) {
            let report = constrained(&scene, kernel);
            assert!(report.passed(), "{report}");
            assert!(report.accepted() > 500, "{report}");
        }
    }
}

/// Uses the simulator itself, because the moves that aim look at its outcomes.
#[test]
fn the_mixture_leaves_the_prior_invariant_with_real_balls() {
    let scene = small(2.0);
    let free = PriorOnly::new(&scene);
    let moves = lend::<PriorOnly<Spelling>>(scene.moves(&Rules::exact()).unwrap()).unwrap();
    let plan = OneStep { samples: 4000, steps: 3, ..OneStep::default() };
    let report = one_step(&free, &moves, prior(&free), &statistics(&scene), plan).unwrap();
    assert!(report.passed(), "{report}");
}

#[test]
fn ratios_agree_with_their_reverse() {
    let scene = small(1.0);
    let toy = Straight(&scene);
    let mixture = lend::<Straight>(scene.moves(&Rules::exact()).unwrap()).unwrap();
    let states = visited(&toy, &mixture, plaus_dist::Seed(5), 5, 2000).unwrap();
    for kernel in all_moves(&scene) {
        let moves = lend::<Straight>(Mixture::of(kernel)).unwrap();
        let (_, lent) = moves.iter().next().unwrap();
        let report = ratios(&toy, lent, any_of(&states), Ratios::default()).unwrap();
        assert!(report.passed(), "{report}");
    }
}

/// The ratios agree with those derived in the module heads of the moves.
#[test]
fn ratios_are_those_of_the_model() {
    let scene = small(1.0);
    let toy = Straight(&scene);
    let state = |dropped: usize| {
        let balls = (0..4).map(|ball| (ball < dropped).then_some([30.0 + 10.0 * ball as f64, 30.0])).collect();
        let draw = plaus_scenes::spelling::Drops { offsets: vec![[0.0; 3]; 12], balls };
        State::evaluate(&toy, draw, &mut ()).unwrap()
    };
    let moves = lend::<Straight>(Mixture::of(Box::new(super::straight::toggle(&scene, false)))).unwrap();
    let kernel = moves.iter().next().unwrap().1;
    for (n, m) in [(0, 1), (0, 4), (1, 3), (2, 3)] {
        let [less, more] = [n, m].map(state);
        let prior = |s: &plaus_mcmc::StateOf<Straight>| toy.log_prior(&s.draw).unwrap().value();
        let log_ratio = kernel.log_ratio(At::new(&toy, &less).to(more.by_ref(), plaus_mcmc::Path(0))).unwrap().value();
        let alpha = log_ratio + prior(&more) - prior(&less);
        // (1−η)^(n+n'−N).
        let expected = (n + m) as f64 * plaus_dist::math::ln(0.75) - 4.0 * plaus_dist::math::ln(0.75);
        assert!((alpha - expected).abs() < 1e-12, "{n} → {m}: {alpha}, not {expected}");
    }
}
