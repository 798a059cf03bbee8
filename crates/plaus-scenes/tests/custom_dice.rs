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

/// Dice of every kind, and an octahedron as a compound with a weight in a corner: turned anyhow, they fall about as far
/// as their own size. They are so far apart that none comes to lean on another.
fn falling() -> String {
    let die = |(nth, sides): (usize, &u32)| {
        format!(
            "[[world.custom.bodies]]\nname = 'd{sides}'\nany_turn = true\nat_mm = [{}, 0, 40]\n\
             shape = {{ die = {{ sides = {sides}, size_mm = 20, rounding_mm = 0.5 }} }}\n",
            1000 * nth
        )
    };
    let dice: String = [4, 8, 10, 12, 20].iter().enumerate().map(die).collect();
    let faces: Vec<[i32; 3]> = (0..8).map(|k| [1 - (k & 1) * 2, 1 - (k & 2), 1 - (k >> 2) * 2]).collect();
    let points = "[[10, 0, 0], [-10, 0, 0], [0, 10, 0], [0, -10, 0], [0, 0, 10], [0, 0, -10]]";
    format!(
        "[world.custom]\nduration_s = 5\naccuracy = 'draft'\n{dice}\
         [[world.custom.bodies]]\nname = 'loaded'\nany_turn = true\nat_mm = [9000, 0, 40]\nfaces = {faces:?}\n\
         shape = {{ compound = {{ pieces = [ {{ shape = {{ hull = {{ points_mm = {points} }} }} }},\n\
         {{ shape = {{ ball = {{ radius_mm = 2 }} }}, at_mm = [0, 0, 6], density = 40 }} ] }} }}\n"
    )
}

/// A die whose symmetries take each face to each other one shows all of them equally often, if it is turned anyhow. So
/// do these, at a level of 1 in 10,000 each; a loaded one does not. Requirements read the same faces.
#[test]
fn dice_of_every_kind_are_fair_and_a_loaded_one_is_not() {
    let scene = read(&falling()).unwrap();
    let (scalars, cast, mut scratch) = (scene.scalars(), scene.cast(), Default::default());
    let of = |name: &str| scalars.iter().position(|scalar| scalar.name == name).unwrap();
    // The last numbers are what χ² with one degree of freedom less than there are faces exceeds once in 10,000 times.
    let dice = [("d4", 4, 21.11), ("d8", 8, 29.88), ("d10", 10, 33.72), ("d12", 12, 37.37), ("d20", 20, 50.80)];
    let dice = dice.into_iter().chain([("loaded", 8, 29.88)]);
    let mut counts: Vec<_> = dice.map(|(name, faces, most)| (name, vec![0_u32; faces], most)).collect();
    const DRAWS: u64 = 2000;
    for nth in 0..DRAWS {
        let draw = scene.start(&mut Seed(7).chain(0).at(nth, Purpose::START));
        let state = State::evaluate(&scene, draw, &mut scratch).unwrap();
        let mut values = vec![0.0; scalars.len()];
        scene.write_scalars(state.by_ref(), &mut values);
        let motion = (nth < 20).then(|| scene.motion_simulated(&state.draw, &scratch).unwrap());
        for (name, counts, _) in &mut counts {
            let up = values[of(&format!("{name}.up"))] as usize;
            counts[up - 1] += 1;
            let Some(motion) = &motion else { continue };
            // Neighbouring faces are at least 41.8° apart (those of a d20), so no other one is within 20° of up.
            let asked = |face: usize| {
                let text = format!("faces_up = {{ body = '{name}', face = {face}, within_deg = 20 }}");
                crate::require_bounds::requirement(&text).reach(&Probe::whole(motion, &cast)).least.met()
            };
            let met: Vec<usize> = (1..=counts.len()).filter(|&face| asked(face)).collect();
            assert_eq!(met, [up], "draw {nth}: {name}");
            // The quaternion turns the body's axes into the scenario's: of length 1, and it puts that face on top.
            let [x, y, z, w] = ["qx", "qy", "qz", "qw"].map(|part| values[of(&format!("{name}.{part}"))]);
            assert!((x * x + y * y + z * z + w * w - 1.0).abs() < 1e-12);
            let local = [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)];
            let top = cast.marks[*name][up - 1].to_array();
            let cosine: f64 = local.iter().zip(top).map(|(a, b)| a * b).sum();
            assert!(cosine > 20.0_f64.to_radians().cos(), "draw {nth}: {name}");
        }
    }
    for (name, counts, most) in counts {
        let expected = DRAWS as f64 / counts.len() as f64;
        let square: f64 = counts.iter().map(|&count| (f64::from(count) - expected).powi(2) / expected).sum();
        assert_eq!(square < most, name != "loaded", "{name}: χ² {square}, {counts:?}");
    }
}

#[test]
fn marks_that_make_no_sense_are_refused() {
    let cone = "[[world.custom.bodies]]\nname = 'top'\nshape = { cone = { radius_mm = 9, height_mm = 20 } }\n\
                at_mm = [0, 0, 99]\n";
    let marked = |faces: &str| read(&format!("[world.custom]\n{cone}faces = {faces}\n"));
    assert_eq!(marked("[[0, 0, -2], [1, 0, 1]]").unwrap().cast().marks["top"].len(), 2);
    for (faces, says) in [("[[0, 0, 0]]", "must be finite and not 0"), ("[[0, 0, 1], [0, 0, 5]]", "same direction")] {
        assert!(marked(faces).unwrap_err().contains(says));
    }
    let six = falling().replace("sides = 8,", "sides = 6,");
    assert!(read(&six).unwrap_err().contains("with 6 it is a box with `pips = true`"));
    assert!(read(&falling().replace("rounding_mm = 0.5", "rounding_mm = 6")).unwrap_err().contains("rounding"));
    let beyond = format!("{}[[require]]\nfaces_up = {{ body = 'd8', face = 9 }}\n", falling());
    let refused = Scenario::read("dice.toml", &beyond, &[]).unwrap_err().to_string();
    assert!(refused.contains("its faces are numbered from 1 to 8"), "{refused}");
}
