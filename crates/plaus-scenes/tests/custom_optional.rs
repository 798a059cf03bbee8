//! Bodies that only some draws have: how often they are there, that nothing is left of those that are not, and what
//! requirements make of them.

use crate::require_bounds::{bounds, requirement};
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::{Goal, State, StateOf, Target};
use plaus_scenes::animation::Motion;
use plaus_scenes::custom::{Custom, Done, Ending};
use plaus_scenes::require::{Cast, FAR, Probe};
use plaus_scenes::{Scenario, Scene, World};
use rand::RngExt;
use std::collections::{BTreeMap, BTreeSet};

fn scene(text: &str) -> Custom {
    let scenario = Scenario::read("optional.toml", text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let World::Custom(config) = scenario.world else { panic!("another world") };
    Custom::new(&config).unwrap()
}

fn draw(scene: &Custom, nth: u64) -> <Custom as Target>::Draw {
    scene.start(&mut Seed(21).chain(0).at(nth, Purpose::START))
}

fn state(scene: &Custom, nth: u64) -> StateOf<Custom> {
    State::evaluate(scene, draw(scene, nth), &mut Default::default()).unwrap()
}

/// The columns of a state, by name.
fn columns(scene: &Custom, state: &StateOf<Custom>) -> BTreeMap<String, f64> {
    let scalars = scene.scalars();
    let mut values = vec![0.0; scalars.len()];
    scene.write_scalars(state.by_ref(), &mut values);
    scalars.into_iter().map(|scalar| scalar.name).zip(values).collect()
}

/// The names of the bodies that an animation has.
fn names(animation: &Motion) -> BTreeSet<String> {
    animation.tracks.iter().map(|track| track.name.clone()).collect()
}

/// A body of 20 mm, 100 mm from the last one, in the air.
fn ball(name: &str, at: u32, keys: &str) -> String {
    format!(
        "[[world.custom.bodies]]\nname = '{name}'\nshape = {{ ball = {{ radius_mm = 10 }} }}\n\
         at_mm = ['{at} + 30 * n * i', 0, 50]\ncount = 2\n{keys}\n"
    )
}

/// Frequencies agree with probabilities within this many standard errors. Of ten right ones, one exceeds it for one
/// choice of seeds in 1,500.
const LIMIT: f64 = 4.0;
const DRAWS: u64 = 3_000;

/// What may be so in a draw, where the argument tells whether a body is there.
type Event = dyn Fn(&dyn Fn(&str) -> bool) -> bool;

/// Standard errors by which the frequency of an event in the animations of a world is off `chance`.
fn off(seen: &[BTreeSet<String>], chance: f64, event: &Event) -> f64 {
    let found = seen.iter().filter(|names| event(&|name| names.contains(name))).count() as f64;
    let n = seen.len() as f64;
    (found / n - chance).abs() / (chance * (1.0 - chance) / n).sqrt()
}

#[test]
fn bodies_are_there_as_often_as_is_said() {
    let world = scene(&format!(
        "[world.custom]\nduration_s = 0.001\n\
         [[world.custom.quantities]]\nname = 'pair'\nvalue = {{ choice = {{ of = [0, 1], weights = [3, 1] }} }}\n\
         [[world.custom.quantities]]\nname = 'many'\nvalue = {{ choice = {{ of = [0, 1, 2] }} }}\n{}{}{}{}",
        ball("own", 0, "present = 0.7"),
        ball("both", 1000, "present = 'pair'"),
        ball("first", 2000, "present = 'many - i'"),
        ball("computed", 3000, "present = 'i'"),
    ));
    let seen: Vec<_> = (0..DRAWS).map(|nth| names(&world.motion(&draw(&world, nth)).unwrap())).collect();
    let cases: [(&str, f64, &Event); 6] = [
        ("own_1", 0.7, &|has| has("own_1")),
        ("each for itself", 0.49, &|has| has("own_1") && has("own_2")),
        ("both_1", 0.25, &|has| has("both_1")),
        ("one of three numbers", 1.0 / 3.0, &|has| has("first_1") && !has("first_2")),
        ("two of three numbers", 1.0 / 3.0, &|has| has("first_2")),
        ("independent", 0.7 * 0.25, &|has| has("own_2") && has("both_2")),
    ];
    for (what, chance, event) in cases {
        let z = off(&seen, chance, event);
        assert!(z < LIMIT, "{what}: {z} standard errors");
    }
    let twin = off(&seen, 0.7 * 0.7, &|has| has("own_1"));
    assert!(twin > LIMIT, "a wrong probability is only {twin} standard errors off");
    for names in &seen {
        assert_eq!(names.contains("both_1"), names.contains("both_2"), "bodies that share a quantity: {names:?}");
        assert!(names.contains("first_1") || !names.contains("first_2"), "{names:?}");
        assert!(names.contains("computed_2") && !names.contains("computed_1"), "0 is never and 1 always: {names:?}");
    }
    // The numbers of a body that is not there keep their law; where it ends is no number.
    let (mut absent, mut names) = (0, BTreeSet::new());
    for nth in 0..100 {
        let columns = columns(&world, &state(&world, nth));
        names.extend(columns.keys().cloned());
        let is_there = columns["own_1.present"] == 1.0;
        assert_eq!(columns["own_1.end_x"].is_nan(), !is_there);
        absent += u32::from(!is_there);
    }
    assert!(absent > 10);
    assert!(!names.contains("both_1.present") && !names.contains("computed_2.present"), "{names:?}");
}

/// Tables of a random world in which things meet, each with whether it is optional: shapes, sleepers, a door, a body
/// that goes its own way, a wall.
fn tables(nth: u64) -> Vec<(bool, String)> {
    let mut stream = Seed(22).chain(0).at(nth, Purpose::START);
    let mut tables = Vec::new();
    for k in 0..6 {
        let mut number = |low: f64, high: f64| stream.random_range(low..high);
        let size = number(20.0, 40.0);
        let shape = match k % 3 {
            0 => format!("{{ ball = {{ radius_mm = {size} }} }}"),
            1 => format!("{{ box = {{ size_mm = [{size}, {size}, {}] }} }}", 2.0 * size),
            _ => format!("{{ cylinder = {{ radius_mm = {size}, height_mm = {size} }} }}"),
        };
        let moves = match k {
            4 => "asleep = true".to_owned(),
            _ => format!("velocity_m_s = [{}, {}, 0]", number(-2.0, 2.0), number(-0.2, 0.2)),
        };
        let place = [120.0 * f64::from(k) - 300.0, number(-10.0, 10.0), number(60.0, 120.0)];
        let body = format!(
            "[[world.custom.bodies]]\nname = 'body_{k}'\ncolour = '#808080'\nmaterial = 'kind_{}'\n\
             shape = {shape}\nat_mm = {place:?}\n{moves}\n",
            k % 4
        );
        tables.push((k != 3, body));
    }
    tables.push((
        true,
        "[[world.custom.driven]]\nname = 'paddle'\ncolour = '#808080'\nshape = { box = { size_mm = [10, 90, 60] } }\n\
         keys = [{ at_s = 0, at_mm = [-420, 0, 40] }, { at_s = 0.8, at_mm = [300, 0, 40] }]\n"
            .into(),
    ));
    tables.push((
        false,
        "[[world.custom.joints]]\nname = 'pin'\nbody = 'body_3'\nat_mm = [60, 0, 150]\n\
         kind = { hinge = { axis = [0, 1, 0] } }\n\
         [[world.custom.fixed]]\nname = 'floor'\nshape = { plane = {} }\n"
            .into(),
    ));
    tables.push((
        true,
        "[[world.custom.fixed]]\nname = 'wall'\nshape = { box = { size_mm = [20, 200, 100] } }\nat_mm = [420, 0, 50]\n"
            .into(),
    ));
    tables
}

/// Materials of different densities, so that the force of a contact tells whose it is.
fn settings() -> String {
    let material = |k: u32| {
        format!("[[world.custom.materials]]\nname = 'kind_{k}'\ndensity = {}\nfriction = 0.1\n", 400 * (k + 1))
    };
    format!("[world.custom]\nduration_s = 0.5\n{}", (0..4).map(material).collect::<String>())
}

/// In random worlds, a draw without some things is the same, bit for bit, as the world whose file does not have them.
#[test]
fn nothing_is_left_of_what_is_not_there() {
    let (mut met, mut compared, mut different) = (0, 0, 0);
    for world in 0..12 {
        let tables = tables(world);
        let present = |optional: bool| if optional { "present = 0.5\n" } else { "" };
        let all: String = tables.iter().map(|(optional, text)| format!("{text}{}", present(*optional))).collect();
        let all = scene(&format!("{}{all}", settings()));
        let mut classes = BTreeMap::new();
        for nth in 0..6 {
            let whole = state(&all, nth);
            let columns_of_all = columns(&all, &whole);
            let is_there = |name: &str| columns_of_all.get(&format!("{name}.present")) != Some(&0.0);
            let name = |text: &str| text.split('\'').nth(1).unwrap().to_owned();
            let kept = tables.iter().filter(|(_, text)| is_there(&name(text)));
            let kept: String = kept.map(|(_, text)| text.as_str()).collect();
            let cut = scene(&format!("{}{kept}", settings()));
            let (one, other) = match (all.animate(&whole.draw), cut.animate(&draw(&cut, 0))) {
                (Ok(one), Ok(other)) => (one, other),
                // The paddle has crushed a body, at the same time in both.
                (Err(one), Err(other)) => {
                    assert!(matches!(whole.outcome, Ending::Failed(_)), "{:?}", whole.outcome);
                    assert_eq!(one.to_string(), other.to_string(), "world {world}, draw {nth}");
                    continue;
                }
                (one, other) => panic!("world {world}, draw {nth}: {:?} {:?}", one.err(), other.err()),
            };
            assert!(one == other, "world {world}, draw {nth}: {:?} {:?}", names(&one.motion), names(&other.motion));
            for (name, value) in columns(&cut, &state(&cut, 0)) {
                assert_eq!(value.to_bits(), columns_of_all[&name].to_bits(), "{name}");
            }
            // What met first is listed by the right numbers.
            let Ending::Done(Done { met: pairs, .. }) = &whole.outcome else { panic!("{:?}", whole.outcome) };
            let cast = all.cast();
            let called = |index: u32| cast.bodies.iter().chain(&cast.fixed).nth(index as usize).unwrap().as_str();
            let pairs: BTreeSet<_> = pairs.iter().map(|[a, b]| BTreeSet::from([called(*a), called(*b)])).collect();
            let seen = one.motion.impacts.iter().map(|hit| BTreeSet::from([hit.body.as_str(), hit.other.as_str()]));
            assert_eq!(pairs, seen.collect(), "world {world}, draw {nth}");
            met += one.motion.impacts.len();
            compared += 1;
            // Draws that differ in what is there differ as solutions; the numbers of what is not there do not count.
            let class = all.class(whole.by_ref()).unwrap();
            let before = classes.insert(kept.clone(), class);
            assert!(before.is_none_or(|before| before == class), "world {world}, draw {nth}");
            // A twin that takes the bodies of another draw is told from this one.
            let twin = all.animate(&draw(&all, nth + 1)).ok();
            different += u32::from(twin.is_none_or(|twin| names(&twin.motion) != names(&one.motion) && twin != one));
        }
        assert_eq!(classes.values().collect::<BTreeSet<_>>().len(), classes.len(), "world {world}");
    }
    assert!(met > 200 && different > compared / 2, "{met} impacts, {different} of {compared}");
}

/// Two things begin inside each other, with a body before them that is not there: both have their names.
#[test]
fn overlaps_are_told_by_the_right_names() {
    for (more, says) in [
        (ball("c", 0, ""), "\"b_1\" begins 20.000 mm inside \"c_1\""),
        (
            "[[world.custom.fixed]]\nname = 'floor'\nshape = { plane = {} }\n[[world.custom.fixed]]\nname = 'step'\n\
             shape = { box = { size_mm = [100, 100, 45] } }\nat_mm = [0, 0, 22.5]\n"
                .into(),
            "\"b_1\" begins 5.000 mm inside \"step\"",
        ),
    ] {
        let text = format!("{}{}{more}", ball("a", 500, "present = 0"), ball("b", 0, ""));
        let error = Scenario::read("optional.toml", &text, &[]).unwrap_err().to_string();
        assert!(error.contains(says) && error.contains("bodies[1].at_mm"), "{error}");
    }
    // What is not there begins inside nothing.
    scene(&format!("{}{}", ball("a", 0, "present = 0"), ball("b", 0, "")));
}

/// One of two bodies is there, in the same place, and touches nothing: what tells the solutions apart is which it is.
#[test]
fn solutions_with_different_bodies_are_distinct() {
    let text = format!(
        "[world.custom]\nduration_s = 0.1\ngravity = 0\nfixed = []\n[[world.custom.quantities]]\nname = 'pick'\n\
         value = {{ choice = {{ of = [0, 1] }} }}\n{}{}",
        ball("a", 0, "present = 'pick'"),
        ball("b", 0, "present = '1 - pick'"),
    );
    let world = scene(&text);
    let states: Vec<_> = (0..20).map(|nth| state(&world, nth)).collect();
    let classes: BTreeSet<_> = states.iter().map(|state| world.class(state.by_ref()).unwrap()).collect();
    assert_eq!(classes.len(), 2);
    let ends = |state: &StateOf<Custom>| match &state.outcome {
        Ending::Done(done) => done.bodies.iter().map(|last| last.place.to_array()).collect::<Vec<_>>(),
        other => panic!("{other:?}"),
    };
    assert!(states.iter().all(|state| ends(state) == ends(&states[0])), "a class without the names would be one");
}

/// A chain's memory of its last draw, which may have had other bodies, changes nothing.
#[test]
fn other_bodies_before_change_nothing() {
    let world = pair("present = 0.5");
    let (mut scratch, mut counts) = (Default::default(), BTreeSet::new());
    for nth in 0..20 {
        let alone = state(&world, nth);
        let after = State::evaluate(&world, draw(&world, nth), &mut scratch).unwrap();
        assert_eq!(alone.outcome, after.outcome, "draw {nth}");
        let Ending::Done(done) = &alone.outcome else { panic!("{:?}", alone.outcome) };
        counts.insert(done.bodies.len());
    }
    assert_eq!(counts, BTreeSet::from([1, 2]));
}

/// A world without any body at all can be simulated and shown.
#[test]
fn nothing_may_be_there() {
    let world = scene(&ball("a", 0, "present = 0"));
    let state = state(&world, 0);
    assert!(world.class(state.by_ref()).is_some() && state.log_constraint.value() == 0.0);
    let animation = world.animate(&state.draw).unwrap();
    assert_eq!((animation.motion.tracks.len(), animation.motion.impacts.len(), animation.scenery.len()), (0, 0, 1));
    assert!(animation.motion.duration >= 0.0 && animation.view.is_some_and(|view| view.frame.is_none()));
}

/// A ball `a` that may be there, and a ball `b` that is.
fn pair(present: &str) -> Custom {
    scene(&format!(
        "[world.custom]\nduration_s = 0.4\n{}{}",
        ball("a", 0, present).replace("count = 2\n", "").replace("'0 + 30 * n * i'", "0"),
        ball("b", 100, "").replace("count = 2\n", "").replace("'100 + 30 * n * i'", "100"),
    ))
}

/// At least one requirement of every kind that is about one body.
const ABOUT_A: &[&str] = &[
    "impact = { body = 'a', when = { to_s = 0.3 } }",
    "rests = { body = 'a' }",
    "bounces = { body = 'a', at_most = 3 }",
    "faces_up = { body = 'a', within_deg = 180 }",
    "points = { body = 'a', toward = [0, 1, 0] }",
    "orientation = { body = 'a', within_deg = 180 }",
    "turns = { body = 'a', at_most = 9 }",
    "height = { body = 'a', at_least_mm = 0 }",
    "speed = { body = 'a', at_most = 9, when = { from_s = 0 } }",
    "stands = { body = 'a', within_deg = 180 }",
    "rests_at = { body = 'a', within_mm = 10000 }",
    "rests_on = { body = 'a', on = 'floor' }",
    "inside = { body = 'a', x_mm = [-500, 500] }",
    "in_view = { body = 'a', camera = { at_mm = [0, -900, 400], look_at_mm = [0, 0, 0] } }",
    "inside = { body = 'a', x_mm = [-500, 500], how = 'always' }",
    "passes = { body = 'a', x_mm = 0, y_mm = 0, z_mm = 30, within_mm = 40 }",
    "touches = { body = 'a', with = 'floor' }",
    "beats = { body = 'a', every_s = 0.1 }",
    "beats = { body = 'a', every_s = 0.1, each = 'impact' }",
    "speed = { body = 'a', at_most = 9 }",
    "spin = { body = 'a', at_most = 9 }",
    "impulse = { body = 'a', at_most = 9 }",
    "air_time = { body = 'a', at_most_s = 9 }",
    "path_length = { body = 'a', at_most_mm = 9000 }",
    "relative = { body = 'a', to = 'b', x_mm = 0, within_mm = 500 }",
    "relative = { body = 'b', to = 'a', x_mm = 0, within_mm = 500 }",
    "count = { of = 'a', at_least = 1, that = { inside = { x_mm = [-500, 500] } } }",
    "count = { of = '*', at_least = 2, that = { not = { touches = { with = 'b' } } } }",
    "named = { name = 'it flies', that = { air_time = { body = 'a', at_most_s = 9 } } }",
];

/// Others, with the margins that they have if `a` is not there; `None`: the same as of the line after it.
const OTHERS: &[(&str, Option<f64>)] = &[
    ("inside = { body = 'a', x_mm = [-500, 500], how = 'never' }", Some(1.0)),
    ("touches = { body = 'b', with = 'a' }", Some(-2.0)),
    ("bounces = { body = 'b', with = 'a', at_most = 0 }", Some(1.0)),
    ("before = { first = { body = 'b' }, then = { body = 'a' } }", Some(FAR)),
    ("before = { first = { body = 'a' }, then = { body = 'b' } }", Some(-FAR)),
    ("apart = { one = { body = 'a' }, other = { body = 'b' }, at_most_ms = 300 }", Some(-FAR)),
    ("order = { bodies = ['a', 'b'] }", Some(-FAR)),
    ("order = { bodies = ['b', 'a'] }", Some(FAR)),
    ("order = { bodies = ['*'] }", Some(FAR)),
    ("falls = { body = '*', when = { at_s = 0.3 } }", None),
    ("falls = { body = 'b', when = { at_s = 0.3 } }", None),
    ("rests = { body = '*', when = { at_s = 0.3 } }", None),
    ("rests = { body = 'b', when = { at_s = 0.3 } }", None),
    ("beats = { body = '*', every_s = 0.07 }", None),
    ("beats = { body = 'b', every_s = 0.07 }", None),
    ("count = { of = '*', at_least = 1, that = { impact = { when = { to_s = 0.3 } } } }", None),
    ("impact = { body = 'b', when = { to_s = 0.3 } }", None),
    // No pips are there in either case.
    ("sum = { of = '*', at_most = 0 }", Some(0.5)),
    ("count = { of = '*', at_most = 1, that = { stands = { within_deg = 180 } } }", Some(FAR)),
];

#[test]
fn requirements_about_a_body_that_is_not_there_are_not_met() {
    let [without, with] = ["present = 0", "present = 1"].map(pair);
    let margin = |world: &Custom, text: &str| {
        let motion = world.motion(&draw(world, 0)).unwrap();
        let reach = requirement(text).reach(&Probe::whole(&motion, &world.cast()));
        assert_eq!(reach.least, reach.most, "{text}");
        reach.most
    };
    for text in ABOUT_A {
        let mark = margin(&without, text);
        assert_eq!((mark.margin, mark.log), (-FAR, -FAR), "{text}");
        assert!(margin(&without, &format!("not = {{ {text} }}")).met(), "not {text}");
        assert!(margin(&with, text).margin > -FAR || text.starts_with("rests"), "{text}: it is there, if not at rest");
    }
    for (k, (text, expected)) in OTHERS.iter().enumerate() {
        let found = margin(&without, text).margin;
        let same = || margin(&without, OTHERS.get(k + 1).map_or(text, |(next, _)| next)).margin;
        match expected {
            Some(expected) => assert_eq!(found, *expected, "{text}"),
            None if text.contains('*') => assert_eq!(found, same(), "{text}"),
            None => {}
        }
    }
    let kinds = ABOUT_A.iter().chain(OTHERS.iter().map(|(text, _)| text)).map(|text| requirement(text).name());
    let kinds: BTreeSet<&str> = kinds.collect();
    // Joints break, not bodies; pins and bins are not what this world has.
    let combining = ["all", "any", "not", "at_least", "breaks", "leaves", "spells"];
    for name in plaus_scenes::require::Require::NAMES {
        assert!(kinds.contains(name) || combining.contains(name), "{name}");
    }
}

/// What is said before anything is simulated, or from a beginning, holds whether the body is there or not. A twin that
/// does not know that it may be missing is caught.
#[test]
fn bounds_hold_whether_a_body_is_there_or_not() {
    let world = pair("present = 0.5");
    let opposite: Vec<String> = ABOUT_A.iter().map(|text| format!("not = {{ {text} }}")).collect();
    let others = OTHERS.iter().map(|(text, _)| *text);
    let all: Vec<&str> = ABOUT_A.iter().copied().chain(others).chain(opposite.iter().map(String::as_str)).collect();
    for (text, [held, failed]) in all.iter().zip(bounds(&world, &all, 20, |known| known)) {
        assert!(held > 0 && failed == 0, "{text}: {failed}");
    }
    let cast = world.cast();
    let blind = Cast { optional: Vec::new(), ..cast.clone() };
    let nothing = Motion::new(0.0, Vec::new(), Vec::new());
    let mut caught = 0;
    for (text, nth) in all.iter().flat_map(|text| (0..10).map(move |nth| (text, nth))) {
        let motion = world.motion(&draw(&world, nth)).unwrap();
        let found = requirement(text).reach(&Probe::whole(&motion, &cast)).most;
        let exceeds = |cast: &Cast| {
            let reach = requirement(text).reach(&Probe::until(&nothing, cast, 0.0));
            found.log > reach.most.log || found.margin < reach.least.margin
        };
        assert!(!exceeds(&cast), "{text}, draw {nth}");
        caught += u32::from(exceeds(&blind));
    }
    assert!(caught > 0);
}
