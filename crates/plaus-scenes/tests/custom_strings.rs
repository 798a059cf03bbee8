//! Strings of a user's world: the yo-yo of the guide, what is drawn of it, and what is wrong with a string.

use glam::DVec3;
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::Target;
use plaus_scenes::animation::{Animation, Shape};
use plaus_scenes::{Scenario, Scene, World, custom::Custom};

const GRAVITY: f64 = 9.806_65;

fn motion(text: &str) -> Animation {
    let scenario = Scenario::read("strings.toml", text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let World::Custom(config) = scenario.world else { panic!("another world") };
    let scene = Custom::new(&config).unwrap();
    let start = scene.start(&mut Seed(5).chain(0).at(0, Purpose::START));
    scene.animate(&start).unwrap()
}

/// The example of the guide's chapter on strings.
fn yoyo() -> String {
    let guide = include_str!("../../../docs/worlds.md");
    let chapter = guide.split("\n## Strings\n").nth(1).unwrap();
    let example = chapter.split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
    format!("[world.custom]\nduration_s = 2\nfixed = []\n{example}")
}

/// The guide's yo-yo falls as the closed form says: to the gap at which bodies touch, and the middle of a step. A twin
/// has none of the moment of inertia. Its drawn string goes from the drum to where it is held, and grows with the fall.
#[test]
fn the_yoyo_of_the_guide_falls_and_climbs() {
    let animation = motion(&yoyo());
    let body = &animation.motion.tracks[0];
    let (r, big) = (0.008, 0.03);
    let a = GRAVITY / (1.0 + 0.5 * big * big / (r * r));
    for time in [0.3, 0.8, 1.1] {
        let fallen = body.position(0.0).y - body.position(time).y;
        let allowed = a * 0.01 * 0.01;
        assert!((fallen - 0.5 * a * time * time).abs() < allowed, "{time}: {fallen} {}", 0.5 * a * time * time);
        assert!(fallen < 0.3 * 0.5 * GRAVITY * time * time, "{time}: {fallen}");
        let rods: Vec<_> = animation.motion.tracks.iter().filter(|track| track.name.starts_with("cord")).collect();
        let Shape::Solid { vertices, .. } = &*rods[0].shape else { panic!("{:?}", rods[0].shape) };
        let part = vertices.iter().map(|vertex| vertex.z).fold(0.0, f64::max);
        let end = |nth: usize, at: f64| rods[nth].position(time) + rods[nth].orientation(time) * DVec3::Z * at;
        let (low, high) = (end(0, 0.0), end(rods.len() - 1, part));
        // The animation's y points up; the scenario's y is its −z.
        assert!((high - DVec3::new(-0.008, 1.3, -2.0)).length() < 1e-3, "{time}: {high}");
        assert!((low - body.position(time) - DVec3::X * -r).length() < 1e-3, "{time}: {low}");
    }
    // All is off after 1.15 s.
    let fallen = body.position(0.0).y - body.position(1.9).y;
    assert!(fallen > 0.0 && fallen < 0.2, "{fallen}");
}

/// A string that becomes taut breaks at the impulse that this takes, which a requirement can ask for; one that is
/// stronger holds.
#[test]
fn a_string_breaks_when_it_becomes_taut() {
    let mass = 1000.0 * 4.0 / 3.0 * std::f64::consts::PI * (0.03 * 0.03 * 0.03);
    let impulse = mass * (2.0 * GRAVITY * 0.2_f64).sqrt();
    for (part, breaks) in [(0.95, 1), (1.05, 0)] {
        let animation = motion(&format!(
            "[world.custom]\nduration_s = 0.5\nfixed = []\n\
             [[world.custom.bodies]]\nname = 'ball'\nshape = {{ ball = {{ radius_mm = 30 }} }}\nat_mm = [0, 0, -100]\n\
             [[world.custom.joints]]\nname = 'thread'\nbody = 'ball'\nat_mm = [0, 0, -100]\n\
             kind = {{ string = {{ to_mm = [0, 0, 0], slack_mm = 200, breaks_at_n_s = {} }} }}\n",
            part * impulse
        ));
        assert_eq!(animation.motion.breaks.len(), breaks, "{part}");
        let low = animation.motion.tracks[0].position(0.5).y;
        assert!((low < -0.4) == (breaks == 1), "{part}: {low}");
    }
}

/// What is wrong with a string is told with its place, its key, and what would be right.
#[test]
fn bad_strings_are_told() {
    for (kind, key, what) in [
        ("string = {}", "string", "to_mm"),
        ("string = { to_mm = [0, 0, 0] }", "kind.string.to_mm", "slack_mm"),
        ("string = { to_mm = [0, 0, 9], spring = {} }", "spring", "slack_mm"),
        ("string = { to_mm = [0, 0, 9], slack_mm = -1 }", "slack_mm", "out of range"),
        ("string = { to_mm = [0, 0, 9], wound = { axis = [0, 0, 0], radius_mm = 5 } }", "wound.axis", "needs a length"),
        ("string = { to_mm = [0, 0, 9], wound = { axis = [0, 1, 0] } }", "wound", "radius_mm"),
        ("string = { to_mm = [0, 0, 9], wound = { axis = [0, 1, 0], radius_mm = 20 } }", "to_mm", "9 mm from the axis"),
        ("string = { to_mm = [0, 0, 9], breaks_at_n_s = 0 }", "breaks_at_n_s", "out of range"),
    ] {
        let text = format!(
            "[[world.custom.bodies]]\nname = 'ball'\nshape = {{ ball = {{ radius_mm = 30 }} }}\n\
             [[world.custom.joints]]\nname = 'j'\nbody = 'ball'\nkind = {{ {kind} }}\n"
        );
        let error = Scenario::read("bad.toml", &text, &[]).expect_err(&text);
        let [problem] = &error.problems[..] else { panic!("{error}") };
        assert!(problem.line.is_some(), "{error}");
        assert!([key, what].iter().all(|part| error.to_string().contains(part)), "{error}: {key}, {what}");
    }
}
