//! Worlds whose impacts scatter: moves of one impact keep the prior and answer for their ratios, and a twin that
//! forgets that the new motion has another number of impacts is caught; a draw is the same motion in every scratch;
//! what materials scatter adds up between two; early ends change nothing.

use crate::custom_bumps::Only;
use glam::DVec3;
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::check::{
    EarlyExitReport, OneStep, OneStepReport, PriorOnly, Ratios, Statistic, early_exit, one_step, prior, ratios,
};
use plaus_mcmc::view::lend;
use plaus_mcmc::{Mixture, State, StateOf, Target, Variables};
use plaus_scenes::custom::{Custom, Drawn, Ending, Work};
use plaus_scenes::dice::{Field, Site};
use plaus_scenes::{Rules, Scenario, Scene, World};
use std::sync::Arc;

/// A ball that bounces on a floor, beside a wall: nothing is uncertain but its impacts. How many it has depends on
/// them.
const BOUNCES: &str = "
[world.custom]
duration_s = 1.2
[[world.custom.materials]]
name = 'rubber'
restitution = 0.8
scatter = { normal_deg = 6, restitution = 0.25 }
[[world.custom.bodies]]
name = 'ball'
shape = { ball = { radius_mm = 30 } }
at_mm = [0, 0, 180]
velocity_m_s = [1, 0, 0]
material = 'rubber'
[[world.custom.fixed]]
name = 'floor'
shape = { plane = {} }
[[world.custom.fixed]]
name = 'wall'
shape = { plane = {} }
at_mm = [500, 0, 0]
turn_deg = [0, -90, 0]
";

fn custom(text: &str) -> Custom {
    let scenario = Scenario::read("scatter.toml", text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let World::Custom(config) = scenario.world else { panic!("another") };
    Custom::new(&config).unwrap()
}

fn state(world: &Custom, nth: u64, work: &mut Work) -> StateOf<Custom> {
    let draw = world.start(&mut Seed(2).chain(0).at(nth, Purpose::START));
    State::evaluate(world, draw, work).unwrap()
}

fn impacts(state: &StateOf<Custom>) -> u32 {
    let Ending::Done(done) = &state.outcome else { return 0 };
    done.scattered.iter().map(|(_, count)| count).sum()
}

fn place(state: &StateOf<Custom>) -> DVec3 {
    if let Ending::Done(done) = &state.outcome { done.bodies[0].place } else { DVec3::NAN }
}

/// A move of one impact, with large steps.
fn only(world: &Custom, name: &str, forgets: bool) -> Only {
    let moves = world.moves(&Rules::default()).unwrap();
    let (_, kernel) = moves.iter().find(|(_, kernel)| kernel.name() == name).unwrap();
    Only { kernel: kernel.at_scales(&[(name == "step_impact").then_some(1.0)]).unwrap(), forgets }
}

type Number<'a> = Statistic<'a, Drawn, Ending>;

/// Where the ball ends, how many impacts it has, and scores of the first two on the floor, which is thing 1.
fn statistics<'a>() -> Vec<Number<'a>> {
    let score = |field, ordinal| {
        let site = Site { field, i: 0, j: (1 << 20) + ordinal };
        move |state: &StateOf<Custom>| state.draw.tables[0].score(site)
    };
    vec![
        Statistic::new("x", |state: &StateOf<Custom>| place(state).x),
        Statistic::new("y", |state: &StateOf<Custom>| place(state).y),
        Statistic::new("impacts", |state: &StateOf<Custom>| f64::from(impacts(state))),
        Statistic::new("restitution of the first", score(Field::Restitution, 0)),
        Statistic::new("tilt of the first", score(Field::Height, 0)),
        Statistic::new("tilt of the second across", score(Field::Friction, 1)),
    ]
}

fn report(name: &str, samples: u64, forgets: bool) -> OneStepReport {
    let world = custom(BOUNCES);
    let free = PriorOnly::new(&world);
    let moves = lend::<PriorOnly<'_, Custom>>(Mixture::of(Box::new(only(&world, name, forgets)))).unwrap();
    let plan = OneStep { seed: Seed(7), samples, steps: 16, cells: 8, false_alarm: 1e-6 };
    one_step(&free, &moves, prior(&free), &statistics(), plan).unwrap()
}

#[test]
fn changing_one_impact_keeps_the_prior() {
    for name in ["redraw_impact", "step_impact"] {
        let right = report(name, 5_000, false);
        assert!(right.passed() && right.accepted() > 2_000, "{right}");
        let wrong = report(name, 5_000, true);
        assert!(!wrong.passed(), "{wrong}");
    }
}

#[test]
fn ratios_of_impacts_agree_both_ways() {
    let world = custom(BOUNCES);
    for name in ["redraw_impact", "step_impact"] {
        let plan = Ratios { pairs: 700, ..Ratios::default() };
        let right = ratios(&world, &only(&world, name, false), prior(&world), plan).unwrap();
        assert!(right.passed(), "{right}");
        let wrong = ratios(&world, &only(&world, name, true), prior(&world), plan).unwrap();
        assert!(!wrong.passed(), "{wrong}");
    }
}

/// Scratch memory, early ends and reuse of what was simulated change no state, under a requirement that ends many
/// simulations.
#[test]
fn early_ends_change_nothing() {
    let required = "[[require]]\nrests_at = { body = 'ball', x_mm = 700, within_mm = 20, scale_mm = 40 }\n";
    let text = format!("{BOUNCES}{required}").replace("duration_s = 1.2", "duration_s = 4");
    let scenario = Scenario::read("scatter.toml", &text, &[]).unwrap();
    let stage = scenario.stage().unwrap();
    let moves = stage.moves(&Rules::default()).unwrap();
    let report: EarlyExitReport = early_exit(&stage, Arc::new(moves), Seed(5), 400).unwrap();
    assert!(report.passed(), "{report}");
}

/// The same draws one after the other in one scratch, backwards, and each in a scratch of its own, at both kinds of
/// worlds: that which is the same for all draws, and one that is not. Outcomes are stored with their impacts.
#[test]
fn a_draw_is_one_motion() {
    let uneven = BOUNCES.replace("restitution = 0.8", "restitution = { uniform = [0.7, 0.9] }");
    for text in [BOUNCES, &uneven] {
        let world = custom(text);
        let mut work = Work::default();
        let first: Vec<_> = (0..40).map(|nth| state(&world, nth, &mut work)).collect();
        for nth in (0..40).rev() {
            let (again, own) = (state(&world, nth, &mut work), state(&world, nth, &mut Work::default()));
            assert!(again == first[nth as usize] && own == again);
        }
        let counts: Vec<u32> = first.iter().map(impacts).collect();
        assert!(counts.iter().min() < counts.iter().max(), "{counts:?}");
        let ends = (place(&first[0]), place(&first[1]));
        assert!((ends.0 - ends.1).length() > 1e-3, "{ends:?}");
        for state in &first {
            let stored = serde_json::to_string(&state.outcome).unwrap();
            let read: Ending = serde_json::from_str(&stored).unwrap();
            assert!(stored.contains("Scattered") && read == state.outcome, "{stored}");
        }
    }
}

/// A world without scatter has no such variable and moves, and its outcomes are stored as before there was any.
#[test]
fn worlds_without_scatter_know_nothing_of_it() {
    let plain = BOUNCES.replace("scatter = { normal_deg = 6, restitution = 0.25 }\n", "");
    let zero = BOUNCES.replace("normal_deg = 6, restitution = 0.25", "normal_deg = 0, restitution = 0");
    for text in [plain, zero] {
        let world = custom(&text);
        assert!(world.vars().is_empty());
        let names = world.moves(&Rules::default()).unwrap().names();
        assert!(!names.iter().any(|name| name.ends_with("_impact")), "{names:?}");
        let state = state(&world, 0, &mut Work::default());
        assert!(state.draw.tables.is_empty() && impacts(&state) == 0);
        assert!(!serde_json::to_string(&state.outcome).unwrap().contains("Scattered"));
    }
    let names = custom(BOUNCES).moves(&Rules::default()).unwrap().names();
    assert!(["redraw_impact", "step_impact"].iter().all(|name| names.iter().any(|known| known == name)), "{names:?}");
}

/// Standard deviation of where a ball comes down that falls straight onto a plate, in mm: along one axis.
fn spread(ball_deg: f64, plate_deg: f64) -> f64 {
    let world = custom(&format!(
        "[world.custom]\nduration_s = 0.33\n\
         materials = [{{ name = 'a', restitution = 1, friction = 0, scatter = {{ normal_deg = {ball_deg} }} }},\
         {{ name = 'b', restitution = 1, friction = 0, scatter = {{ normal_deg = {plate_deg} }} }}]\n\
         fixed = [{{ name = 'plate', shape = {{ plane = {{}} }}, material = 'b' }}]\n\
         [[world.custom.bodies]]\nname = 'ball'\nshape = {{ ball = {{ radius_mm = 20 }} }}\nmaterial = 'a'\n\
         at_mm = [0, 0, 220]\n"
    ));
    let (mut work, n) = (Work::default(), 2_000);
    let squares = |nth| {
        let state = state(&world, nth, &mut work);
        assert_eq!(impacts(&state), 1);
        let place = place(&state);
        0.5 * (place.x * place.x + place.y * place.y)
    };
    1e3 * ((0..n).map(squares).sum::<f64>() / n as f64).sqrt()
}

/// After a fall of 0.2 m at 1.98 m/s the ball flies on for 0.128 s; a tilt of the normal by a small angle turns its
/// velocity by twice as much. Between two materials squares add. Of 4,000 numbers a standard deviation is known to
/// 1.1 %, of which 5.2 times are allowed, and 1 % for the angles not being small; a twin in which angles add is farther
/// off.
#[test]
fn scatter_of_two_materials_adds_up() {
    let expected = |deg: f64| 2.0 * deg.to_radians() * 1.981 * (0.33 - 0.2019) * 1e3;
    for (ball, plate) in [(2.0, 0.0), (0.0, 2.0), (1.5, 2.0)] {
        let (seen, root) = (spread(ball, plate), f64::hypot(ball, plate));
        assert!((seen / expected(root) - 1.0).abs() < 0.067, "{ball} {plate}: {seen} instead of {}", expected(root));
    }
    assert!(spread(1.5, 2.0) < 0.8 * expected(3.5));
}

/// What is wrong is refused where it stands.
#[test]
fn wrong_scatter_is_refused() {
    for (said, parts) in [
        ("{ normal_deg = -1 }", &["scatter.normal_deg", "out of range", "0"][..]),
        ("{ normal_deg = 25 }", &["scatter.normal_deg", "20"]),
        ("{ restitution = 1.5 }", &["scatter.restitution", "1"]),
        ("{ restitution = { normal = [0.1, 0.1] } }", &["scatter.restitution", "at least 0"]),
        ("{ normal = 2 }", &["normal", "normal_deg"]),
        ("2", &["scatter"]),
    ] {
        let text = BOUNCES.replace("{ normal_deg = 6, restitution = 0.25 }", said);
        let scenario = Scenario::read("scatter.toml", &text, &[]);
        let error = match scenario {
            Err(error) => error.to_string(),
            Ok(scenario) => scenario.stage().err().unwrap_or_else(|| panic!("{said} is taken")).to_string(),
        };
        assert!(parts.iter().all(|part| error.contains(part)), "{said}: {error}");
    }
    let marbles = BOUNCES.replace("duration_s = 1.2", "duration_s = 1.2\nmechanics = 'marbles'");
    let error = Scenario::read("scatter.toml", &marbles, &[]).unwrap_err().to_string();
    assert!(error.contains("materials[0].scatter") && error.contains("turning"), "{error}");
}
