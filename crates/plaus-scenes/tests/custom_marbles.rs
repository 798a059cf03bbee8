//! Marbles in worlds that users describe: they move as balls do that are simulated as bodies that turn, they are shown
//! turning likewise, and scenery has its names.

use plaus_dist::{LogPotential, Purpose, Seed};
use plaus_mcmc::{Simulated, Target};
use plaus_scenes::animation::Motion;
use plaus_scenes::custom::{Custom, Ending, Overlap};
use plaus_scenes::{Scenario, Scene, World};
use std::collections::BTreeSet;

/// A world as bodies that turn, and as marbles.
fn both(text: &str) -> [Custom; 2] {
    ["turning", "marbles"].map(|mechanics| {
        let set = format!("world.custom.mechanics={mechanics}");
        let scenario = Scenario::read("marbles.toml", text, &[set]).unwrap_or_else(|error| panic!("{error}\n{text}"));
        let World::Custom(config) = scenario.world else { panic!("another world") };
        Custom::new(&config).unwrap()
    })
}

fn draw(scene: &Custom, nth: u64) -> <Custom as Target>::Draw {
    scene.start(&mut Seed(31).chain(0).at(nth, Purpose::START))
}

/// A ball thrown among a box, a hull, hills and a leaning wall, over a plane.
const AMONG: &str = "[world.custom]\nduration_s = 3\naccuracy = 'fine'\n\
    materials = [{ name = 'glass', friction = 0.2, restitution = 0.7 },\
    { name = 'oak', friction = 0.4, rolling = 0.02, spinning = 0.01 }]\n\
    fixed = [\
    { name = 'floor', shape = { plane = {} }, material = 'oak' },\
    { name = 'wall', shape = { plane = {} }, material = 'oak', at_mm = [400, 0, 0], turn_deg = [0, -80, 0] },\
    { name = 'block', shape = { box = { size_mm = [150, 120, 90] } }, material = 'oak', at_mm = [150, 0, 30],\
    turn_deg = [20, 10, 30] },\
    { name = 'spike', shape = { hull = { points_mm = [[-60, -60, 0], [60, -60, 0], [0, 60, 0], [0, 0, 150]] } },\
    at_mm = [-150, 0, 0] },\
    { name = 'hills', material = 'glass', at_mm = [0, -250, 0], shape = { heights = { spacing_mm = 80, rows_mm = [\
    [10, 30, 10, 40, 10], [20, 60, 90, 30, 10], [10, 40, 20, 50, 10]] } } }]\n\
    [[world.custom.bodies]]\nname = 'ball'\nshape = { ball = { radius_mm = 20 } }\nmaterial = 'glass'\n\
    at_mm = [{ uniform = [-250, 250] }, { uniform = [-300, 150] }, { uniform = [250, 350] }]\n\
    velocity_m_s = [{ normal = [0, 0.5] }, { normal = [0, 0.5] }, { normal = [0, 1] }]\n\
    spin_deg_s = [{ normal = [0, 900] }, { normal = [0, 900] }, { normal = [0, 900] }]\n";

/// Times and places of impacts, with the scenery. A turning ball that meets an edge may hit both of its triangles.
fn hits(motion: &Motion) -> Vec<(&str, f64, glam::DVec3)> {
    let mut hits: Vec<_> = motion.impacts.iter().map(|hit| (hit.other.as_str(), hit.time, hit.point)).collect();
    hits.dedup_by(|later, hit| later.0 == hit.0 && later.1 == hit.1);
    hits
}

/// Flights and impacts have one closed form for both kinds, but bodies that turn touch at a gap of 5e-9 m, so impacts
/// are 1e-8 s apart, and each bounce off an edge makes that larger, by up to about 30 times. A twin of another
/// restitution is off by far more.
#[test]
fn marbles_bounce_as_balls_that_turn() {
    let [turning, marbles] = both(AMONG);
    let [twin, _] = both(&AMONG.replace("restitution = 0.7", "restitution = 0.71"));
    let (mut worst, mut compared, mut names, mut off) = (0.0_f64, 0, BTreeSet::new(), 0.0_f64);
    for nth in 0..150 {
        let draw = draw(&turning, nth);
        let Ok(one) = turning.motion(&draw) else { continue };
        let (other, twin) = (marbles.motion(&draw).unwrap(), twin.motion(&draw).unwrap());
        let [one, other, twin] = [&one, &other, &twin].map(hits);
        for (&(name, time, point), of_marble) in one.iter().zip(&other).take(3) {
            assert_eq!(name, of_marble.0, "{one:?}\n{other:?}");
            worst = worst.max((time - of_marble.1).abs()).max((point - of_marble.2).length());
            names.insert(name.to_owned());
            compared += 1;
        }
        off = off.max((one[1].1 - twin[1].1).abs());
    }
    assert_eq!(names.len(), 5, "{names:?}");
    assert!(compared > 300, "{compared}");
    assert!(worst < 1e-5, "{worst}");
    assert!(off > 1e-3, "another restitution is not told from it: {off}");
}

/// On a plane, both kinds slide and roll in closed form.
#[test]
fn marbles_slide_and_roll_as_balls_that_turn() {
    let text = "[world.custom]\nduration_s = 4\n\
        materials = [{ name = 'oak', friction = 0.3, rolling = 0.02, spinning = 0.02 }]\n\
        fixed = [{ name = 'floor', shape = { plane = {} }, material = 'oak' }]\n\
        [[world.custom.bodies]]\nname = 'ball'\nshape = { ball = { radius_mm = 30 } }\nmaterial = 'oak'\n\
        at_mm = [0, 0, 30]\nvelocity_m_s = [{ normal = [0, 0.5] }, { normal = [0, 0.5] }, 0]\n\
        spin_deg_s = [{ normal = [0, 900] }, { normal = [0, 900] }, { normal = [0, 900] }]\n";
    let [turning, marbles] = both(text);
    let [twin, _] = both(&text.replace("rolling = 0.02", "rolling = 0.021"));
    let (mut place, mut off) = (0.0_f64, 0.0_f64);
    for nth in 0..60 {
        let draw = draw(&turning, nth);
        let [one, other, twin] = [&turning, &marbles, &twin].map(|scene| scene.motion(&draw).unwrap());
        let [one, other, twin] = [&one, &other, &twin].map(|motion| &motion.tracks[0]);
        for time in (1..=16).map(|k| 0.25 * f64::from(k)) {
            place = place.max((one.position(time) - other.position(time)).length());
        }
        off = off.max((one.position(4.0) - twin.position(4.0)).length());
    }
    assert!(place < 1e-9, "{place}");
    assert!(off > 1e-3, "another resistance is not told from it: {off}");
}

/// A marble that rolls turns by its way over its radius, in a part of a motion by up to 0.1 less or more.
#[test]
fn marbles_are_shown_turning() {
    let [_, marbles] = both(
        "[world.custom]\nduration_s = 4\n\
        materials = [{ name = 'oak', friction = 0.3, rolling = 0.02 }]\n\
        fixed = [{ name = 'floor', shape = { plane = {} }, material = 'oak' }]\n\
        quantities = [{ name = 'v', value = { uniform = [0.1, 1] } }]\n\
        [[world.custom.bodies]]\nname = 'ball'\nshape = { ball = { radius_mm = 30 } }\nmaterial = 'oak'\n\
        at_mm = [0, 0, 30]\nvelocity_m_s = ['v', 0, 0]\nspin_deg_s = [0, 'v / 0.03 * 180 / pi', 0]\n",
    );
    let mut farthest = 0.0_f64;
    for nth in 0..20 {
        let motion = marbles.motion(&draw(&marbles, nth)).unwrap();
        for time in (1..=20).map(|k| 0.2 * f64::from(k)) {
            let track = &motion.tracks[0];
            let angle = track.position(time).x / 0.03;
            // An animation has y up: what rolls along x turns about −z.
            let wanted = glam::DQuat::from_rotation_z(-angle) * track.orientation(0.0);
            assert!(wanted.angle_between(track.orientation(time)) < 0.1, "{angle} at {time} s");
            farthest = farthest.max(angle);
        }
    }
    assert!(farthest > 20.0, "{farthest}");
}

/// What begins inside what, and how deep, in m.
fn overlap(scene: &Custom, nth: u64) -> Option<(u32, u32, f64)> {
    let simulated = scene.simulate(&draw(scene, nth), None, LogPotential::ZERO, &mut Default::default());
    let Simulated::Complete(ending) = simulated.unwrap() else { panic!() };
    if let Ending::Overlap(Overlap { body, other, depth }) = ending { Some((body, other, depth)) } else { None }
}

/// Where a ball begins inside another one, inside a block or in the floor, both kinds say the same.
#[test]
fn overlaps_have_the_same_names_and_depths() {
    let world = |balls: &str| {
        format!(
            "[world.custom]\nduration_s = 0.01\n\
             fixed = [{{ name = 'floor', shape = {{ plane = {{}} }} }},\
             {{ name = 'block', shape = {{ box = {{ size_mm = [100, 100, 100] }} }}, at_mm = [0, 0, 100],\
             turn_deg = [0, 0, 30] }}]\n\
             [[world.custom.bodies]]\nname = 'ball'\nshape = {{ ball = {{ radius_mm = 20 }} }}\n{balls}\n"
        )
    };
    let place = "at_mm = [{ uniform = [-100, 100] }, { uniform = [-100, 100] }, { uniform = [10, 120] }]";
    let two = "count = 2\nat_mm = [{ uniform = [300, 350] }, 0, 50]";
    let mut counts = [0; 3];
    for [turning, marbles] in [place, two].map(|balls| both(&world(balls))) {
        for nth in 0..300 {
            let [one, other] = [&turning, &marbles].map(|scene| overlap(scene, nth));
            assert_eq!(one.is_some(), other.is_some(), "{one:?} {other:?}");
            let Some((one, other)) = one.zip(other) else { continue };
            assert_eq!((one.0, one.1), (other.0, other.1));
            // Worlds of turning bodies call it an overlap from a gap of 5e-9 m on.
            assert!((one.2 - other.2).abs() < 1e-8, "{one:?} {other:?}");
            let all = if turning.cast().bodies.len() == 2 { 2 } else { one.1 as usize - 1 };
            counts[all] += 1;
        }
    }
    assert!(counts.iter().all(|&count| count > 10), "{counts:?}");
}

/// What no marble is, does or meets, and what cannot be asked of it, is refused where it stands.
#[test]
fn what_is_no_world_of_marbles_is_refused() {
    let ball = "[world.custom]\nmechanics = 'marbles'\n[[world.custom.bodies]]\nname = 'ball'\n\
                shape = { ball = { radius_mm = 20 } }\nat_mm = [0, 0, 30]\n";
    let cases = [
        ("asleep = true", "bodies[0].asleep", "marbles feel only gravity"),
        ("damping = 1", "bodies[0].damping", "marbles feel only gravity"),
        ("gravity_scale = { uniform = [0, 1] }", "bodies[0].gravity_scale", "marbles feel only gravity"),
        ("[[world.custom.bodies]]\nname = 'b'\nshape = { box = { size_mm = [9, 9, 9] } }", "bodies[1].shape", "a box"),
        ("[[world.custom.fixed]]\nname = 'f'\nshape = { ball = { radius_mm = 9 } }", "fixed[0].shape", "marbles meet"),
        ("[[world.custom.joints]]\nname = 'j'\nbody = 'ball'\nkind = { ball = {} }", "joints", "cannot be on joints"),
        (
            "[[world.custom.driven]]\nname = 'd'\nshape = { ball = { radius_mm = 9 } }\n\
             keys = [{ at_s = 0, at_mm = [0, 0, 0] }]",
            "driven",
            "driven bodies cannot",
        ),
        ("[[require]]\nspin = { at_least = 1 }", "require[0].spin", "without an orientation"),
        ("[[require]]\nstands = {}", "require[0].stands", "without an orientation"),
        ("[[require]]\nfaces_up = { axis = 'x' }", "require[0].faces_up", "without an orientation"),
    ];
    for (more, key, message) in cases {
        let text = format!("{ball}{more}\n");
        let error = Scenario::read("bad.toml", &text, &[]).and_then(|read| {
            let stage = read.stage();
            stage.map_err(|error| plaus_scenes::scenario::ScenarioError::locate("bad.toml", &text, &error))
        });
        let error = error.map(|_| ()).expect_err(more).to_string();
        assert!(error.contains(key) && error.contains(message) && error.contains("bad.toml:"), "{more}\n{error}");
    }
}
