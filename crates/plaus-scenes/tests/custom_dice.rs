//! Dice in users' worlds: which face is up, in columns and in requirements.

use plaus_dist::{Purpose, Seed};
use plaus_mcmc::{State, Target};
use plaus_scenes::custom::Custom;
use plaus_scenes::require::Probe;
use plaus_scenes::{Scenario, Scene, World};

/// Two dice that have hardly begun to fall, turned anyhow; the second box is no cube.
const DICE: &str = "[world.custom]\nduration_s = 0.001\n\
    [[world.custom.bodies]]\nname = 'die'\ncount = 2\npips = true\nany_turn = true\n\
    shape = { box = { size_mm = [16, '16 + 4 * i', 16] } }\nat_mm = ['100 * i', 0, 500]\n";

fn read(text: &str) -> Result<Custom, String> {
    let scenario = Scenario::read("dice.toml", text, &[]).map_err(|error| error.to_string())?;
    let World::Custom(config) = scenario.world else { panic!("another world") };
    Custom::new(&config).map_err(|error| error.to_string())
}

#[test]
fn the_column_is_the_face_that_a_requirement_asks_for() {
    let scene = read(DICE).unwrap();
    let scalars = scene.scalars();
    let of = |name: &str| scalars.iter().position(|scalar| scalar.name == name).unwrap();
    let (cast, mut seen) = (scene.cast(), [0; 6]);
    for nth in 0..200 {
        let draw = scene.start(&mut Seed(5).chain(0).at(nth, Purpose::START));
        let motion = scene.motion(&draw).unwrap();
        let state = State::evaluate(&scene, draw, &mut Default::default()).unwrap();
        let mut values = vec![0.0; scalars.len()];
        scene.write_scalars(state.by_ref(), &mut values);
        let up = ["die_1.up", "die_2.up"].map(|name| values[of(name)] as u32);
        let probe = Probe::whole(&motion, &cast);
        let met = |text: String| crate::require_bounds::requirement(&text).reach(&probe).least.met();
        for (name, face) in ["die_1", "die_2"].into_iter().zip(up) {
            // The nearest of six axes is at most acos(1/√3) = 54.74° from upright, and its opposite at least 90°.
            let asked = |face: u32| met(format!("faces_up = {{ body = '{name}', face = {face}, within_deg = 54.8 }}"));
            assert!(asked(face) && !asked(7 - face), "draw {nth}: {name} shows {face}");
            seen[face as usize - 1] += 1;
        }
        let sum = up[0] + up[1];
        let asked = |sum: u32| met(format!("sum = {{ of = 'die_*', at_least = {sum}, at_most = {sum} }}"));
        assert!(asked(sum) && !asked(sum + 1) && !asked(sum - 1), "draw {nth}: {up:?}");
    }
    assert!(seen.iter().all(|&count| count > 0), "{seen:?}");
}

#[test]
fn only_boxes_have_pips() {
    let wrong = read(&DICE.replace("box = { size_mm = [16, '16 + 4 * i', 16] }", "ball = { radius_mm = 8 }"));
    assert!(wrong.unwrap_err().contains("only a box has a die's pips"));
    let none = Scenario::read("plain.toml", &DICE.replace("pips = true\n", ""), &[]).unwrap();
    let World::Custom(config) = none.world else { panic!("another world") };
    assert!(!Custom::new(&config).unwrap().cast().faces);
}
