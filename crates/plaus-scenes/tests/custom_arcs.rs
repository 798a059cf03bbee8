//! Curved tracks in scenarios: the example of the documentation, and what is refused.

use plaus_dist::{Purpose, Seed};
use plaus_mcmc::{State, Target};
use plaus_scenes::animation::Form;
use plaus_scenes::custom::{Custom, Ending};
use plaus_scenes::{Scenario, Scene, World};

const DOCUMENT: &str = include_str!("../../../docs/worlds.md");

fn scene(text: &str) -> Result<Custom, String> {
    let scenario = Scenario::read("world.toml", text, &[]).map_err(|error| error.to_string())?;
    let World::Custom(config) = &scenario.world else { panic!() };
    Custom::new(config).map_err(|error| error.to_string())
}

/// The example of a section of the documentation.
fn example(section: &str) -> &'static str {
    let text = DOCUMENT.split(section).nth(1).unwrap();
    text.split("```toml\n").nth(1).unwrap().split("```").next().unwrap()
}

/// In every draw of the documentation's example the ball passes the loop, and comes out beside where it went in. On a
/// loop without walls it does not.
#[test]
fn the_ball_of_the_documentation_passes_the_loop() {
    let text = format!("[world.custom]\nduration_s = 1\n{}", example("## Curved tracks"));
    let passes = |text: &str| {
        let scene = scene(text).unwrap();
        let count = (0..10).filter(|&seed| {
            let draw = scene.start(&mut Seed(seed).chain(0).at(0, Purpose::START));
            let state = State::evaluate(&scene, draw, &mut Default::default()).unwrap();
            let Ending::Done(done) = state.outcome else { panic!() };
            let place = done.bodies[0].place;
            place.x > 0.2 && place.y > 0.04 && place.z < 0.02
        });
        count.count()
    };
    assert_eq!(passes(&text), 10);
    assert_eq!(passes(&text.replace(", walls_mm = 10", "")), 0);
}

/// Pictures of a ball that goes through a loop show all of the loop; of one that passes it by, the ball alone.
#[test]
fn a_loop_that_is_gone_through_is_seen_whole() {
    let text = format!("[world.custom]\nduration_s = 1\n{}", example("## Curved tracks"));
    let highest = |text: &str| {
        let scene = scene(text).unwrap();
        let draw = scene.start(&mut Seed(1).chain(0).at(0, Purpose::START));
        scene.animate(&draw).unwrap().view.unwrap().frame.unwrap()[1].y
    };
    assert!(highest(&text) > 0.4);
    assert!(highest(&text.replace("at_mm = [-300, 0, 10]", "at_mm = [-300, 500, 10]")) < 0.1);
}

/// It is drawn with its front on the cylinder, and moves with its place.
#[test]
fn a_track_is_drawn_round() {
    let text = "[[world.custom.fixed]]\nname = 'pipe'\nat_mm = [0, 0, 500]\n\
                shape = { arc = { radius_mm = 500, from_deg = -180, to_deg = 0, width_mm = 300 } }\n";
    let scene = scene(text).unwrap();
    let draw = scene.start(&mut Seed(1).chain(0).at(0, Purpose::START));
    let animation = scene.animate(&draw).unwrap();
    let Form::Mesh { vertices, triangles } = &animation.scenery[0].form else { panic!() };
    let out = |p: &glam::DVec3| (p.x * p.x + (p.y - 0.5) * (p.y - 0.5)).sqrt();
    let on = |radius: f64| vertices.iter().filter(|p| (out(p) - radius).abs() < 1e-12).count();
    assert_eq!((on(0.5), on(0.525), vertices.len()), (130, 130, 260));
    assert_eq!(triangles.len(), 64 * 8 + 4);
}

/// Each refusal names the key, and what would do.
#[test]
fn a_track_that_cannot_be_is_refused() {
    let refused = |keys: &str, words: &[&str]| {
        let text = format!("[[world.custom.fixed]]\nname = 'pipe'\nshape = {{ arc = {{ {keys} }} }}\n");
        let error = scene(&text).map(|_| ()).unwrap_err();
        assert!(words.iter().all(|word| error.contains(word)), "{keys}: {error}");
    };
    let rest = "radius_mm = 200, width_mm = 60";
    refused(&format!("{rest}, from_deg = 90, to_deg = 0"), &["shape.arc.to_deg", "0 is not above from_deg, 90"]);
    refused(
        &format!("{rest}, from_deg = -90, to_deg = 450, pitch_mm = 50"),
        &["shape.arc.pitch_mm", "540 degrees", "at least its width and a wall, 60", "end it at 270"],
    );
    // Of two turns beside each other, each has a wall that is as thick as the track.
    refused(
        &format!("{rest}, from_deg = -90, to_deg = 450, pitch_mm = 65, walls_mm = 10, thickness_mm = 8"),
        &["shape.arc.pitch_mm", "at least its width and a wall, 68"],
    );
    refused(&format!("{rest}, from_deg = -36000, to_deg = 36000, pitch_mm = 80"), &["to_deg", "at most 36000"]);
    refused(&format!("{rest}, from_deg = 0, to_deg = 90, thickness_mm = 0.5"), &["thickness_mm", "at least 1"]);
    refused(&format!("{rest}, from_deg = 0, to_deg = 90, walls_mm = 200"), &["walls_mm", "less than the radius"]);
    refused("width_mm = 60, from_deg = 0, to_deg = 90", &["radius_mm"]);
    refused(
        &format!("{rest}, from_deg = 0, to_deg = {{ uniform = [-10, 90] }}"),
        &["to_deg", "-10 is not above from_deg, 0"],
    );
    let bumps = "[[world.custom.fixed]]\nname = 'pipe'\nbumps = { sd_mm = 1, spacing_mm = 20 }\nshape = { arc = { \
                 radius_mm = 200, width_mm = 60, from_deg = 0, to_deg = 90 } }\n";
    assert!(scene(bumps).map(|_| ()).unwrap_err().contains("bumps"));
    let marbles = "[world.custom]\nmechanics = 'marbles'\n[[world.custom.fixed]]\nname = 'pipe'\nshape = { arc = { \
                   radius_mm = 200, width_mm = 60, from_deg = -90, to_deg = 0 } }\n";
    assert!(scene(marbles).map(|_| ()).unwrap_err().contains("mechanics = \"turning\""));
}
