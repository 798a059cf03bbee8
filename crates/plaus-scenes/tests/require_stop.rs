//! Simulations that requirements end early: a chain has the same states, bit for bit, as a twin whose simulations all
//! go on to their end, in every scene that simulates from event to event. A twin that takes beginnings for whole
//! motions is caught.

use plaus_dist::{LogPotential, Purpose, Seed};
use plaus_mcmc::{Chain, Simulated, Target};
use plaus_scenes::require::{Cast, Require, Stops};
use plaus_scenes::{AnyScratch, Scenario, Scene, Stage};
use std::collections::BTreeSet;

/// Scenarios, with the number of iterations of a chain.
const CASES: &[(&str, u64, &str)] = &[
    (
        "one die",
        150,
        "[world.dice]
        [[require]]
        impact = { nth = 2, when = { at_s = 0.25, within_ms = 20 } }
        [[require]]
        not = { inside = { body = 'die_1', x_mm = [60, 900], how = 'sometimes', scale_mm = 20 } }
        [[require]]
        faces_up = { face = 6, when = { frame = 8 } }",
    ),
    (
        "a die that is no cube",
        120,
        "[world.dice]
        constraints = []
        [world.dice.die]
        edge_z_mm = 10
        [[require]]
        faces_up = { axis = 'z', when = { at_s = 0.2 } }
        [[require]]
        spin = { nth = 2, at_most = 30, after = true }
        [[require]]
        bounces = { at_most = 4 }",
    ),
    (
        "two dice, each on its table",
        120,
        "[world.dice]
        dice = 2
        constraints = []
        [[require]]
        faces_up = { body = 'die_2', face = 6, scale_deg = 1, when = { at_s = 0.08 } }
        [[require]]
        rests = { body = 'die_*', when = { to_s = 0.8 } }",
    ),
    (
        "four dice on one table",
        200,
        "[world.dice]
        dice = 4
        together = true
        constraints = []
        [[require]]
        faces_up = { body = 'die_1', face = 6, scale_deg = 1, when = { at_s = 0.08 } }
        [[require]]
        faces_up = { body = 'die_2', face = 1, scale_deg = 1, when = { at_s = 0.08 } }",
    ),
    (
        "pins",
        40,
        "[world.bowling]
        pins = [1, 2, 3, 6]
        leave = []
        ln_lambda = 1.0
        [[require]]
        inside = { body = 'ball', y_mm = [-9000, 600], how = 'never', when = { from_s = 0.75 }, scale_mm = 200 }
        [[require]]
        stands = { body = 'pin_2', when = { at_s = 0.8 } }
        [[require]]
        touches = { body = 'pin_3', with = 'pin_6', when = { to_s = 1.0 } }",
    ),
    (
        "pins that are left",
        60,
        "[world.bowling]
        pins = [1, 2, 3, 5]
        constrained = false
        [[require]]
        any = [{ leaves = { pins = [3, 5] } }, { leaves = { pins = [2] } }]",
    ),
    (
        "balls over bins",
        250,
        "[world.spelling]
        text = 'HI'
        ln_lambda = 2.0
        [[require]]
        passes = { body = 'ball_0', x_mm = 30, y_mm = 30, z_mm = 60, scale_mm = 0.5, when = { to_s = 0.1 } }
        [[require]]
        not = { touches = { body = 'ball_1', with = 'ball_*' } }",
    ),
    (
        "balls that spell",
        250,
        "[world.spelling]
        bitmap = '###'
        balls = 6
        constrained = false
        [[require]]
        any = [{ spells = { bitmap = \"###\\n#.#\" } }, { spells = { bitmap = '#.#' } }]
        [[require]]
        not = { touches = { body = 'ball_1', with = 'ball_*' } }",
    ),
    (
        "a world of one's own",
        150,
        "[world.custom]
        duration_s = 3
        [[world.custom.fixed]]
        name = 'floor'
        shape = { plane = {} }
        [[world.custom.fixed]]
        name = 'ledge'
        shape = { box = { size_mm = [60, 200, 40] } }
        at_mm = [120, 0, 100]
        [[world.custom.bodies]]
        name = 'ball'
        shape = { ball = { radius_mm = 12 } }
        at_mm = [{ uniform = [-80, 80] }, 0, 300]
        velocity_m_s = [{ normal = [0.3, 0.3] }, 0, 0]
        [[world.custom.bodies]]
        name = 'box'
        shape = { box = { size_mm = [30, 40, 60] } }
        at_mm = [{ uniform = [-20, 180] }, 0, 380]
        turn_deg = [{ uniform = [0, 90] }, 30, 0]
        [[require]]
        touches = { body = 'ball', with = 'ledge', when = { to_s = 0.4 } }
        [[require]]
        impact = { body = 'box', nth = 2, when = { at_s = 0.35, within_ms = 30 } }
        [[require]]
        faces_up = { body = 'box', within_deg = 40, when = { at_s = 0.5 } }
        [[require]]
        spin = { body = 'box', nth = 1, at_least = 5, after = true }",
    ),
];

fn stage(name: &str, text: &str) -> (Stage, Scenario) {
    let scenario = Scenario::read(name, text, &[]).unwrap_or_else(|error| panic!("{name}: {error}"));
    (scenario.stage().unwrap(), scenario)
}

/// The bits of each state of a chain: prior, constraint, outcome; and how many events were simulated.
fn states((name, iterations, text): (&str, u64, &str), stops: Stops) -> (Vec<(u64, u64, String)>, u64) {
    let (stage, scenario) = stage(name, text);
    let stage = stage.stopping(stops);
    let moves = stage.moves(&scenario.sampler.rules).unwrap();
    let mut chain = Chain::start(&stage, &moves, Seed(3).chain(0)).unwrap();
    let before = plaus_sim::work();
    let mut states = Vec::new();
    for _ in 0..iterations {
        chain.step().unwrap();
        let state = chain.state();
        let outcome = serde_json::to_string(&state.outcome).unwrap();
        states.push((state.log_prior.value().to_bits(), state.log_constraint.value().to_bits(), outcome));
    }
    (states, plaus_sim::work() - before)
}

#[test]
fn a_chain_whose_simulations_end_early_has_the_same_states() {
    let mut caught = 0;
    for &case in CASES {
        let (whole, all) = states(case, Stops::Never);
        let (early, some) = states(case, Stops::Soundly);
        let changes = whole.windows(2).filter(|pair| pair[0] != pair[1]).count();
        assert!(changes >= 10, "{}: only {changes} states", case.0);
        assert!(whole == early, "{}: other states", case.0);
        assert!(some < all, "{}: {some} of {all} events", case.0);
        println!("{}: {:.3} of {all} events, {changes} states", case.0, some as f64 / all as f64);
        let (hasty, _) = states(case, Stops::Hastily);
        caught += usize::from(whole != hasty);
    }
    // Where little can be seen early, a hasty twin seldom errs.
    assert!(caught >= 4, "hasty twins: {caught} of {} caught", CASES.len());
}

/// One requirement of each kind about the first bodies and scenery of a cast; where bodies have no orientation, none
/// about that.
fn of_each_kind(cast: &Cast) -> Vec<String> {
    let (one, other, part) = (&cast.bodies[0], cast.bodies.get(1), &cast.fixed[0]);
    let all = [
        "impact = { body = 'ONE', when = { from_s = 0.1 } }",
        "rests = { body = 'ONE', when = { to_s = 1 } }",
        "bounces = { body = 'ONE', at_least = 2 }",
        "faces_up = { body = 'ONE', axis = 'x', when = { at_s = 0.2 } }",
        "points = { body = 'ONE', toward = [0, 1, 0] }",
        "orientation = { body = 'ONE', when = { at_s = 0.25 } }",
        "falls = { body = 'ONE' }",
        "turns = { body = 'ONE', at_most = 3 }",
        "stands = { body = 'ONE', when = { at_s = 0.15 } }",
        "rests_at = { body = 'ONE', x_mm = 10, within_mm = 50 }",
        "rests_on = { body = 'ONE', on = 'PART' }",
        "inside = { body = 'ONE', x_mm = [-10, 50], how = 'sometimes' }",
        "passes = { body = 'ONE', x_mm = 10, z_mm = 20 }",
        "in_view = { body = 'ONE', camera = { at_mm = [0, -900, 300] }, when = { at_s = 0.2 } }",
        "touches = { body = 'ONE', with = 'PART', when = { to_s = 0.3 } }",
        "before = { first = { body = 'ONE' }, then = { body = 'ONE', what = 'rest' } }",
        "apart = { one = { body = 'ONE' }, other = { body = 'ONE', what = 'rest' }, at_most_ms = 900 }",
        "beats = { body = 'ONE', every_s = 0.2 }",
        "speed = { body = 'ONE', at_least = 1 }",
        "spin = { body = 'ONE', at_most = 10, after = true }",
        "impulse = { body = 'ONE', at_least = 0.1 }",
        "height = { body = 'ONE', at_least_mm = 100 }",
        "air_time = { body = 'ONE', at_least_s = 0.2 }",
        "path_length = { body = 'ONE', at_most_mm = 900 }",
        "count = { at_least = 1, that = { rests_at = { x_mm = 10 } } }",
        "all = [{ stands = { body = 'ONE', when = { at_s = 0.15 } } }, { rests_on = { body = 'ONE', on = 'PART' } }]",
        "any = [{ stands = { body = 'ONE' } }, { rests_on = { body = 'ONE', on = 'PART' } }]",
        "not = { touches = { body = 'ONE', with = 'PART' } }",
        "named = { name = 'lands', that = { rests_on = { body = 'ONE', on = 'PART' } } }",
        "at_least = { count = 1, of = [{ stands = { body = 'ONE' } }, { bounces = { body = 'ONE', at_most = 2 } }] }",
    ]
    .map(|line| line.replace("ONE", one).replace("PART", part));
    let turned = ["faces_up", "points", "orientation", "falls", "turns", "spin", "stands"];
    let of_turns = |line: &String| turned.iter().any(|kind| line.starts_with(kind));
    let mut all: Vec<String> = all.into_iter().filter(|line| cast.turns || !of_turns(line)).collect();
    if !cast.turns {
        all.iter_mut().for_each(|line| *line = line.replace("stands =", "rests ="));
    }
    all.extend(cast.faces.then(|| "sum = { at_least = 2 }".to_owned()));
    all.extend(other.map(|other| format!("order = {{ bodies = ['{one}', '{other}'], each = {{ what = 'rest' }} }}")));
    all.extend(other.map(|other| format!("relative = {{ body = '{one}', to = '{other}', x_mm = 10 }}")));
    all
}

/// Every scene takes requirements of every kind, and gives each a margin; but nobody can ask how a body is turned that
/// has no orientation.
#[test]
fn every_scene_takes_every_kind() {
    let mut names = BTreeSet::new();
    let lines = CASES.iter().map(|&(name, _, text)| (name, text.split("[[require]]").next().unwrap()));
    for (name, text) in lines.chain([("a ball", "[world.ball2d]\ntarget = 0.1\n")]) {
        let cast = stage(name, text).0.cast();
        let all = of_each_kind(&cast);
        let tables: Vec<String> = all.iter().map(|line| format!("[[require]]\n{line}\n")).collect();
        let (stage, _) = stage(name, &format!("{text}\n{}", tables.concat()));
        names.extend(stage.requirements().iter().map(Require::name));
        let mut scratch = AnyScratch::default();
        let possible = |nth: u64| {
            let draw = stage.start(&mut Seed(17).chain(0).at(nth, Purpose::START));
            let simulated = stage.simulate(&draw, None, LogPotential::ZERO, &mut scratch).unwrap();
            let Simulated::Complete(answer) = simulated else { panic!("{name}: no floor, but stopped") };
            (!stage.log_constraint(&answer).unwrap().is_zero()).then(|| answer.marks().to_vec())
        };
        let marks = (0..20).find_map(possible).unwrap_or_else(|| panic!("{name}: no draw is possible"));
        assert_eq!(marks.len(), all.len(), "{name}");
        assert!(marks.iter().all(|mark| mark.margin.is_finite() && mark.log.is_finite()), "{name}: {marks:?}");
    }
    // Only worlds that users describe have joints, only bowling has pins, only boxes have bins.
    let somewhere = ["breaks", "leaves", "spells"];
    let left_out: Vec<&&str> =
        Require::NAMES.iter().filter(|name| !names.contains(*name) && !somewhere.contains(*name)).collect();
    assert!(left_out.is_empty(), "{left_out:?}");
}

/// A motion that was kept is, to the last bit, the same as one from a separate simulation, and costs none.
#[test]
fn kept_motions_equal_those_of_a_separate_simulation() {
    for &(name, _, text) in CASES {
        let (stage, _) = stage(name, text);
        let scene = stage.scene();
        let (mut scratch, mut kept) = (AnyScratch::default(), 0);
        for nth in 0..30 {
            if kept == 4 {
                break;
            }
            let draw = scene.start(&mut Seed(13).chain(0).at(nth, Purpose::START));
            // Dice that begin inside each other have prior density 0.
            if scene.log_prior(&draw).unwrap().is_zero() {
                continue;
            }
            scene.keep_motions(&mut scratch, true);
            let simulated = scene.simulate(&draw, None, LogPotential::ZERO, &mut scratch).unwrap();
            let Simulated::Complete(outcome) = simulated else { panic!("{name}: no floor, but stopped") };
            if scene.log_constraint(&outcome).unwrap().is_zero() {
                continue;
            }
            let before = plaus_sim::work();
            let motion = scene.motion_simulated(&draw, &scratch).unwrap();
            kept += u32::from(plaus_sim::work() == before);
            assert!(motion == scene.motion(&draw).unwrap(), "{name}, draw {nth}");
        }
        assert!(kept == 4, "{name}: {kept} motions were kept");
    }
}
