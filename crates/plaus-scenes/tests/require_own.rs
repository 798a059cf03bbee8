//! What a scene of the paper asks for itself, said as requirements: both agree on every draw, and a scene that asks for
//! nothing itself takes any combination of them. Twins that ask for something else are caught.

use plaus_dist::{LogPotential, Purpose, Seed};
use plaus_mcmc::{Goal, State, Target};
use plaus_scenes::animation::Motion;
use plaus_scenes::require::{FAR, Missed, Probe, Require};
use plaus_scenes::{Scenario, Scene, Stage};

/// A scenario; the same scenario without what it asks for itself; how many draws; a requirement that says something
/// else.
const CASES: &[(&str, &str, u64, &str)] = &[
    (
        "[world.ball2d]\ntolerance = 0.8",
        "[world.ball2d]\nconstrained = false",
        400,
        "rests_at = { x_mm = 0, within_mm = 80 }",
    ),
    (
        "[world.bowling]\npins = [1, 2, 3, 5]\nleave = [5]\nmoved_far_mm = 20",
        "[world.bowling]\npins = [1, 2, 3, 5]\nconstrained = false",
        150,
        "leaves = { pins = [], moved_far_mm = 20 }",
    ),
    (
        "[world.spelling]\nbitmap = '##'\nballs = 9",
        "[world.spelling]\nbitmap = '##'\nballs = 9\nconstrained = false",
        150,
        "spells = { bitmap = '#.#' }",
    ),
    (
        "[world.dice]\nconstraints = [{ rest_at = { within_mm = 150, x_mm = 20 } }, { face_up = { face = 2 } }]",
        "[world.dice]\nconstraints = []",
        150,
        "faces_up = { face = 3 }",
    ),
    (
        "[world.dice]\nconstraints = [{ passes = { within_mm = 60 } }, \
         { first_impact = { time_s = 0.12, within_s = 0.03 } }]",
        "[world.dice]\nconstraints = []",
        150,
        "impact = { when = { at_s = 0.1, within_ms = 30 } }",
    ),
];

fn stage(text: &str) -> Stage {
    Scenario::read("own.toml", text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).stage().unwrap()
}

/// The first draws of a scene that the prior allows and whose simulations end, evaluated, each with its motion.
fn draws(stage: &Stage, count: u64) -> Vec<(plaus_mcmc::StateOf<Stage>, Motion)> {
    let mut scratch = Default::default();
    let one = |nth| {
        let draw = stage.start(&mut Seed(31).chain(0).at(nth, Purpose::START));
        let state = State::evaluate(stage, draw, &mut scratch).unwrap();
        let is_possible = !state.log_prior.is_zero() && !state.log_constraint.is_zero();
        is_possible.then(|| {
            let motion = stage.motion(&state.draw).unwrap();
            (state, motion)
        })
    };
    (0..count).filter_map(one).collect()
}

#[test]
fn requirements_say_what_a_scene_asks_for_itself() {
    for &(own, _, count, other) in CASES {
        let (stage, other) = (stage(own), toml::from_str::<Require>(other).unwrap());
        let said: Vec<Require> = stage.demands().into_iter().map(|(_, one)| one).collect();
        assert!(!said.is_empty(), "{own}");
        let cast = stage.cast();
        let (mut seen, mut caught) = ([0; 2], 0);
        for (state, motion) in draws(&stage, count) {
            let met = stage.class(state.by_ref()).is_some();
            let probe = Probe::whole(&motion, &cast);
            let all = said.iter().all(|one| one.reach(&probe).most.met());
            assert_eq!(met, all, "{own}: {:?}", state.draw);
            seen[usize::from(met)] += 1;
            caught += u32::from(other.reach(&probe).most.met() != met);
            let answers = stage.answers(state.by_ref());
            assert_eq!(answers.iter().all(|mark| mark.met()), met, "{own}");
        }
        assert!(seen[0] >= 5 && seen[1] >= 5 && caught >= 5, "{own}: {seen:?}, {caught}");
    }
}

/// Pins and bins have the paper's law too: log densities differ by the same number for all draws.
#[test]
fn requirements_about_pins_and_bins_have_the_paper_s_law() {
    for (own, nats) in [
        ("[world.bowling]\npins = [1, 2, 3, 5]\nleave = [5]\nmoved_far_mm = 20\nln_lambda = 1.7", 1.7 * 5.0),
        ("[world.spelling]\nbitmap = '##'\nballs = 9\nln_lambda = 1.2", 1.2 * 2.0),
    ] {
        let stage = stage(own);
        let (said, cast) = (stage.demands(), stage.cast());
        let mut different = 0;
        for (state, motion) in draws(&stage, 80) {
            let log = said[0].1.reach(&Probe::whole(&motion, &cast)).most.log;
            assert!((state.log_constraint.value() - nats - log).abs() < 1e-12, "{own}: {log}");
            different += u32::from(log < 0.0);
        }
        assert!(different > 20, "{own}");
    }
}

/// Any of two sets of pins, not a face, at least two of three words: scenes take them all, and judge them as is said.
#[test]
fn scenes_that_ask_for_nothing_themselves_take_any_combination() {
    for (world, text, parts, together) in [
        (
            1,
            "any = [{ leaves = { pins = [5] } }, { leaves = { pins = [2, 5] } }]",
            ["leaves = { pins = [5] }", "leaves = { pins = [2, 5] }"],
            (|a, b| a || b) as fn(bool, bool) -> bool,
        ),
        (
            2,
            "at_least = { count = 2, of = [{ spells = { bitmap = '##' } }, { spells = { bitmap = '#.#' } }] }",
            ["spells = { bitmap = '##' }", "spells = { bitmap = '#.#' }"],
            |a, b| a && b,
        ),
        (
            3,
            "not = { any = [{ faces_up = { face = 6 } }, { faces_up = { face = 1 } }] }",
            ["faces_up = { face = 6 }", "faces_up = { face = 1 }"],
            |a, b| !(a || b),
        ),
        (
            0,
            "all = [{ not = { rests_at = { x_mm = 0, within_mm = 50 } } }, { rests_at = { x_mm = 100, within_mm = 90 } }]",
            ["rests_at = { x_mm = 0, within_mm = 50 }", "rests_at = { x_mm = 100, within_mm = 90 }"],
            |a, b| !a && b,
        ),
    ] {
        let (_, free, count, _) = CASES[world];
        let stage = stage(&format!("{free}\n[[require]]\n{text}\n"));
        let parts = parts.map(|part| toml::from_str::<Require>(part).unwrap());
        let cast = stage.cast();
        let mut seen = [0; 2];
        for (state, motion) in draws(&stage, count) {
            let probe = Probe::whole(&motion, &cast);
            let [a, b] = [0, 1].map(|k| parts[k].reach(&probe).most.met());
            assert_eq!(stage.class(state.by_ref()).is_some(), together(a, b), "{text}");
            seen[usize::from(together(a, b))] += 1;
        }
        assert!(seen[0] > 0 && seen[1] > 0, "{text}: {seen:?}");
    }
}

/// What is lacking is told in pins, bins, diameters, millimetres, milliseconds and faces.
#[test]
fn what_a_scene_misses_is_told_in_its_units() {
    let told = |text: &str, unit: &str, words: &str| {
        let stage = stage(text);
        let (mut units, mut said) = (0, 0);
        for (state, _) in draws(&stage, 40) {
            for (thing, mark) in stage.answers(state.by_ref()).into_iter().enumerate().filter(|(_, mark)| !mark.met()) {
                match stage.missed(thing, mark.margin) {
                    Some(Missed::By(by, found)) => {
                        assert!(by > 0.0 && by < FAR && found == unit, "{text}: {by} {found}");
                        units += 1;
                    }
                    _ => assert!(unit.is_empty(), "{text}: {mark:?}"),
                }
                said += u32::from(!words.is_empty() && stage.lacks(thing, state.by_ref()).contains(words));
            }
        }
        assert!((units > 0) != unit.is_empty() && (said > 0) != words.is_empty(), "{text}: {units}, {said}");
    };
    told("[world.bowling]\n", "pins", " stand");
    told("[world.bowling]\nleave = [10]\n", "pins", "pin 10 falls");
    told("[world.spelling]\n", "bins", "no ball in row 2, column 2");
    told("[world.ball2d]\n", "D", "");
    told("[world.dice]\nconstraints = [{ rest_at = {} }]", "mm", "");
    told("[world.dice]\nconstraints = [{ first_impact = { time_s = 0.5 } }]", "ms", "");
    told("[world.dice]\nconstraints = [{ face_up = {} }]", "", "face 3 is up");
    told("[world.dice]\nconstraints = [{ pose_at = { angle_sd_deg = 10 } }]", "", "degrees too far");
}

/// The most that a scene without constraints of its own can reach is what any of its draws reaches.
#[test]
fn a_scene_without_constraints_is_its_prior() {
    for (_, free, ..) in CASES {
        let stage = stage(free);
        assert_eq!(stage.most(), Some(LogPotential::ONE), "{free}");
        for (state, _) in draws(&stage, 20) {
            assert!(state.log_constraint == LogPotential::ONE && stage.class(state.by_ref()).is_some(), "{free}");
        }
    }
}
