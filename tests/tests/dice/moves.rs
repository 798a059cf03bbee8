//! Every move leaves the prior and the constrained target invariant.

use super::plain::{AnyMove, Plain, Thrown, all_moves, scene, small, statistics};
use super::twins::{Fault, Faulty};
use plaus_dist::{LogPotential, Seed};
use plaus_mcmc::check::{
    OneStep, OneStepReport, PriorOnly, Ratios, Statistic, any_of, early_exit, one_step, prior, ratios, rejection,
    visited,
};
use plaus_mcmc::library::{Sizes, Symmetry};
use plaus_mcmc::view::lend;
use plaus_mcmc::{Chain, Decision, Mixture, State};
use plaus_scenes::dice::{Constraint, Dice, FaceUp, Pick, Point, Recast, RestAt, Shift, Work, component, turn};
use plaus_scenes::{Rules, Scene};

const SAMPLES: u64 = 6_000;

/// One step of `kernel` alone from exact draws of the constrained target.
pub(crate) fn constrained(dice: &Dice, flat: bool, kernel: AnyMove) -> OneStepReport {
    let toy = Plain { dice, flat };
    let moves = lend::<Plain<'_>>(Mixture::of(kernel)).unwrap();
    let plan = OneStep { samples: SAMPLES, ..OneStep::default() };
    one_step(&toy, &moves, rejection(&toy, LogPotential::ONE), &statistics(), plan).unwrap()
}

/// One step from draws of the prior, with the constraint switched off.
pub(crate) fn free(dice: &Dice, flat: bool, kernel: AnyMove) -> OneStepReport {
    let whole = small_without_demands(dice);
    let toy = Plain { dice: &whole, flat };
    let moves = lend::<Plain<'_>>(Mixture::of(kernel)).unwrap();
    let plan = OneStep { samples: SAMPLES, ..OneStep::default() };
    one_step(&toy, &moves, prior(&toy), &statistics(), plan).unwrap()
}

/// The same scene with constraints that have no weight, but are still known to the moves that aim.
fn small_without_demands(dice: &Dice) -> Dice {
    let mut config = dice.config().clone();
    for demand in &mut config.constraints {
        match demand {
            plaus_scenes::dice::Constraint::RestAt(at) => at.sigma_mm = 1e5,
            plaus_scenes::dice::Constraint::FaceUp(up) => up.ln_lambda = 0.0,
            _ => {}
        }
    }
    Dice::new(&config).unwrap()
}

#[test]
fn every_move_leaves_prior_and_target_invariant() {
    // Two tables; one table for both dice; no random field; a puddle.
    let scenes = [
        small(|_| ()),
        small(|config| config.together = true),
        small(|config| (config.table.bumps_mm, config.table.bounce_sd, config.table.grip_sd) = (0.0, 0.0, 0.0)),
        small(|config| config.spilt.radius_mm = 60.0),
    ];
    for (k, dice) in scenes.iter().enumerate() {
        for (index, kernel) in all_moves(dice).into_iter().enumerate() {
            // Moves that know of one die at most, and not of its table, are the same on all tables.
            let concerned: &[usize] = [&[0, 1, 2, 3, 4, 5, 6][..], &[0, 2, 3, 4, 6], &[6], &[3, 6]][k];
            if !concerned.contains(&index) {
                continue;
            }
            let report = constrained(dice, false, kernel);
            assert!(report.passed(), "scene {k}: {report}");
            assert!(report.accepted() > 150, "scene {k}: {report}");
        }
    }
    for kernel in all_moves(&scenes[0]) {
        let report = free(&scenes[0], false, kernel);
        assert!(report.passed(), "{report}");
    }
}

#[test]
fn ratios_agree_with_their_reverse() {
    // Picking takes long, and is tested elsewhere.
    let together = small(|config| {
        config.together = true;
        config.weights.set("pick", 0.0);
    });
    for dice in [small(|_| ()), together] {
        let toy = Plain { dice: &dice, flat: false };
        let mixture = lend::<Plain<'_>>(dice.moves(&Rules::exact()).unwrap()).unwrap();
        let states = visited(&toy, &mixture, Seed(5), 5, 500).unwrap();
        for kernel in all_moves(&dice) {
            let moves = lend::<Plain<'_>>(Mixture::of(kernel)).unwrap();
            let (_, lent) = moves.iter().next().unwrap();
            let report = ratios(&toy, lent, any_of(&states), Ratios { pairs: 2000, ..Ratios::default() }).unwrap();
            assert!(report.passed(), "{report}");
        }
    }
}

/// Real dice on a real table.
#[test]
fn the_mixture_leaves_the_prior_invariant_with_real_dice() {
    let dice = scene(|_| ());
    let free = PriorOnly::new(&dice);
    let moves = lend::<PriorOnly<'_, Dice>>(dice.moves(&Rules::exact()).unwrap()).unwrap();
    let plan = OneStep { samples: 1000, ..OneStep::default() };
    let statistics = [
        Statistic::new("rest x", |state: &Thrown| state.outcome.trips[0].position.x),
        Statistic::new("face", |state: &Thrown| f64::from(state.outcome.faces[0])),
        Statistic::new("impacts", |state: &Thrown| state.outcome.trips[0].impacts.len() as f64),
        Statistic::new("velocity", |state: &Thrown| state.draw.throws[0].velocity.x),
    ];
    let report = one_step(&free, &moves, prior(&free), &statistics, plan).unwrap();
    assert!(report.passed(), "{report}");
}

/// A recast relies on the simulator, so this uses real dice and wide constraints; and a twin without the ratio.
#[test]
fn recasts_leave_the_constrained_target_invariant() {
    let wide = |bumps_mm: f64| {
        scene(|config| {
            (config.table.bumps_mm, config.table.bounce_sd, config.table.grip_sd) = (bumps_mm, 0.0, 0.0);
            (config.throw.place_sd_mm, config.table.grid_mm, config.table.width_mm) = (60.0, 16.0, 600.0);
            config.accuracy = plaus_scenes::AccuracyPreset::Draft;
            let at = RestAt { x_mm: 90.0, sigma_mm: 200.0, ..RestAt::default() };
            config.constraints =
                vec![Constraint::RestAt(at), Constraint::FaceUp(FaceUp { ln_lambda: 0.7, ..FaceUp::default() })];
        })
    };
    let dice = wide(0.0);
    let statistics = [
        Statistic::new("rest x", |state: &Thrown| state.outcome.trips[0].position.x + dice.offset(&state.draw, 0).x),
        Statistic::new("face", |state: &Thrown| f64::from(state.outcome.faces[0] == 6)),
        Statistic::new("x", |state: &Thrown| dice.prior().value(&state.draw, 0, 0)),
        Statistic::new("velocity", |state: &Thrown| state.draw.throws[0].velocity.x),
    ];
    let report = |kernel: AnyMove, steps: u64| {
        let plan = OneStep { samples: 1000, steps, ..OneStep::default() };
        one_step(&dice, &Mixture::of(kernel), rejection(&dice, LogPotential::ONE), &statistics, plan).unwrap()
    };
    let recast = || Recast { sd: 0.08 };
    let right = report(Box::new(recast()), 1);
    assert!(right.passed() && right.accepted() > 150, "{right}");
    let wrong = report(Box::new(Faulty(Box::new(recast()), Fault::Forgets)), 3);
    assert!(!wrong.passed(), "not caught: {wrong}");
    // On a random table, proposals lead where the trial throws led; also on a table with a puddle.
    let mut config = wide(0.1).config().clone();
    config.spilt.radius_mm = 80.0;
    for dice in [wide(0.1), Dice::new(&config).unwrap()] {
        let mixture = Mixture::of(Box::new(recast()) as AnyMove);
        let (_, kernel) = mixture.iter().next().unwrap();
        let plan = Ratios { pairs: 100, ..Ratios::default() };
        let report = ratios(&dice, kernel, prior(&dice), plan).unwrap();
        assert!(report.passed(), "{report}");
    }
}

/// Trips taken from the current state, and simulations that are given up, change no state.
#[test]
fn savings_change_nothing() {
    let dice = scene(|config| config.dice = 2);
    let moves = dice.moves(&Rules::exact()).unwrap();
    let report = early_exit(&dice, std::sync::Arc::new(moves), Seed(3), 150).unwrap();
    assert!(report.passed(), "{report}");
    // On one table: dice of groups that a candidate does not change.
    let dice = scene(|config| {
        (config.dice, config.together, config.accuracy) = (3, true, plaus_scenes::AccuracyPreset::Draft);
        config.throw.place_sd_mm = 20.0;
    });
    let moves = dice.moves(&Rules::exact()).unwrap();
    let report = early_exit(&dice, std::sync::Arc::new(moves), Seed(3), 100).unwrap();
    assert!(report.passed(), "{report}");
}

/// Recasts several dice of one table at once, half of them not led to a place. With the ratio the target stays
/// invariant, without it does not.
#[test]
fn recasts_of_several_dice_leave_the_constrained_target_invariant() {
    let dice = scene(|config| {
        (config.dice, config.together, config.accuracy) = (2, true, plaus_scenes::AccuracyPreset::Draft);
        (config.table.bumps_mm, config.table.bounce_sd, config.table.grip_sd) = (0.0, 0.0, 0.0);
        (config.throw.place_sd_mm, config.table.width_mm) = (60.0, 800.0);
        let at = |die| RestAt { die, x_mm: 90.0, y_mm: 40.0, sigma_mm: 150.0, ..RestAt::default() };
        let up = FaceUp { die: 2, ln_lambda: 0.7, ..FaceUp::default() };
        config.constraints = vec![Constraint::RestAt(at(1)), Constraint::RestAt(at(2)), Constraint::FaceUp(up)];
    });
    let statistics = [
        Statistic::new("rest x", |state: &Thrown| state.outcome.trips[0].position.x),
        Statistic::new("rest y", |state: &Thrown| state.outcome.trips[1].position.y),
        Statistic::new("face", |state: &Thrown| f64::from(state.outcome.faces[1] == 6)),
        Statistic::new("x", |state: &Thrown| dice.prior().value(&state.draw, 0, 0)),
        Statistic::new("velocity", |state: &Thrown| state.draw.throws[1].velocity.x),
    ];
    let report = |kernel: AnyMove, steps: u64| {
        let plan = OneStep { samples: 1000, steps, ..OneStep::default() };
        one_step(&dice, &Mixture::of(kernel), rejection(&dice, LogPotential::ONE), &statistics, plan).unwrap()
    };
    let recast = || Recast { sd: 0.06 };
    let right = report(Box::new(recast()), 1);
    assert!(right.passed() && right.accepted() > 100, "{right}");
    let wrong = report(Box::new(Faulty(Box::new(recast()), Fault::Forgets)), 3);
    assert!(!wrong.passed(), "not caught: {wrong}");
    // The same for throws chosen among many.
    let pick = || Pick { sd: 0.1, near: 0.1 };
    let right = report(Box::new(pick()), 1);
    assert!(right.passed() && right.accepted() > 100, "{right}");
    let wrong = report(Box::new(Faulty(Box::new(pick()), Fault::Forgets)), 2);
    assert!(!wrong.passed(), "not caught: {wrong}");
    // On a random table too, proposals have the stated densities.
    let dice = scene(|config| (config.dice, config.together) = (3, true));
    for kernel in [Box::new(recast()) as AnyMove, Box::new(Pick { sd: 0.06, near: 0.03 })] {
        let mixture = Mixture::of(kernel);
        let (_, kernel) = mixture.iter().next().unwrap();
        let report = ratios(&dice, kernel, prior(&dice), Ratios { pairs: 30, ..Ratios::default() }).unwrap();
        assert!(report.passed(), "{report}");
    }
}

/// Steps near an adapted scale leave the law invariant too.
#[test]
fn adapted_moves_leave_prior_and_target_invariant() {
    let dice = small(|_| ());
    let sizes = Sizes::new(0.01, 1.0);
    let adapted = |kernel: AnyMove| {
        let count = kernel.scales().len();
        assert!(count > 0 && kernel.scales().iter().all(|scale| scale.least < scale.start && scale.start < scale.most));
        kernel.at_scales(&vec![Some(0.4); count]).unwrap()
    };
    for kernel in
        [Box::new(component(&dice, sizes)) as AnyMove, Box::new(Point::anywhere(sizes)), Box::new(Point::near(sizes))]
    {
        let report = constrained(&dice, false, adapted(kernel));
        assert!(report.passed() && report.accepted() > 150, "{report}");
    }
    let wrong = free(&dice, false, Box::new(Faulty(adapted(Box::new(component(&dice, sizes))), Fault::Symmetric)));
    assert!(!wrong.passed(), "not caught: {wrong}");
}

/// Turning the pips changes which face comes up; a shift together with the table changes where the die lies. Neither
/// changes a bit of the motion. A state depends on its draw alone.
#[test]
fn turns_and_shifts_change_no_motion() {
    let dice = scene(|config| {
        config.constraints[0] = Constraint::RestAt(RestAt { sigma_mm: 15.0, ..RestAt::default() });
        config.throw.place_sd_mm = 100.0;
    });
    let turn = Box::new(Symmetry { name: "turn", map: turn });
    let moves: Vec<(f64, AnyMove)> = vec![(0.5, turn), (0.5, Box::new(Shift { sd: 0.03 }))];
    let moves = Mixture::new(moves).unwrap();
    let mut chain = Chain::start(&dice, &moves, Seed(1).chain(0)).unwrap();
    let first = chain.state().outcome.trips[0].clone();
    let mut faces = std::collections::BTreeSet::new();
    for _ in 0..400 {
        if chain.step().unwrap().decision == Decision::Accepted {
            faces.insert(chain.state().outcome.faces[0]);
        }
    }
    assert!(faces.contains(&6) && !faces.contains(&0), "{faces:?}");
    assert_ne!(chain.state().draw.tables[0].shifted, [0; 2]);
    assert_eq!(chain.state().outcome.trips[0], first);
    let again = State::evaluate(&dice, chain.state().draw.clone(), &mut Work::default()).unwrap();
    assert_eq!(&again, chain.state());
}
