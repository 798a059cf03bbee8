//! Draws that fail: a run goes on past them, counts them, and says what happened; and what cannot work is told before
//! anything is sampled.

use crate::common::shapes;
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::{Chain, Independent, State, Target};
use plaus_scenes::custom::{Cause, Custom, Ending};
use plaus_scenes::require::{Asked, Ended, Tally};
use plaus_scenes::{Scenario, Scene, World};

/// An egg on the floor under a plate of 60 mm, which comes down to a height of its own. In a fifth of all draws there
/// is no egg.
const PRESS: &str = "
[world.custom]
duration_s = 0.4
[[world.custom.quantities]]
name = 'low'
value = { uniform = [20, 40] }
[[world.custom.fixed]]
name = 'floor'
shape = { plane = {} }
[[world.custom.bodies]]
name = 'stone'
shape = { box = { size_mm = [20, 20, 20] } }
at_mm = [200, 0, 10]
[[world.custom.bodies]]
name = 'egg'
shape = { ball = { radius_mm = 10 } }
at_mm = [{ uniform = [-40, 40] }, 0, 10]
present = 0.8
[[world.custom.driven]]
name = 'plate'
shape = { box = { size_mm = [60, 60, 20] } }
keys = [{ at_s = 0, at_mm = [0, 0, 60] }, { at_s = 0.2, at_mm = [0, 0, 'low'] }]
";

fn read(text: &str) -> Scenario {
    Scenario::read_with("failing.toml", text, &[], &shapes()).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn scene(text: &str) -> Custom {
    let World::Custom(config) = read(text).world else { panic!("another world") };
    Custom::new(&config).unwrap()
}

const DRAWS: u64 = 300;

/// Of an egg well under a plate that leaves it no room, the draw fails; over a plate that does, it does not. `check`
/// counts what fails, and names body, time and cause.
#[test]
fn a_draw_that_is_crushed_fails_and_is_counted() {
    let scene = scene(PRESS);
    let (streams, mut scratch, mut failed, mut certain) = (Seed(3).chain(0), Default::default(), 0, 0);
    for nth in 0..DRAWS {
        let draw = scene.start(&mut streams.at(nth, Purpose::START));
        let state = State::evaluate(&scene, draw, &mut scratch).unwrap();
        let column = |name: &str| {
            let mut values = vec![0.0; scene.scalars().len()];
            scene.write_scalars(state.by_ref(), &mut values);
            values[scene.scalars().iter().position(|scalar| scalar.name == name).unwrap()]
        };
        let (low, there) = (column("low"), column("egg.present") != 0.0);
        let middle = there && column("egg.x").abs() < 20.0;
        match state.outcome {
            Ending::Failed(how) => {
                assert_eq!(how.cause, Cause::Crushed);
                // The plate's underside is 10 mm below its middle; the egg is 20 mm high.
                assert!(there && low < 30.0 && how.time <= 0.2, "{low} {how:?}");
                assert!(state.log_p().is_zero());
                failed += 1;
                let told = scene.failure(&state.outcome).unwrap().to_string();
                assert!(told.starts_with("plate crushes egg at 0.") && told.ends_with(" s: no way out"), "{told}");
                assert_eq!(scene.animate(&state.draw).unwrap_err().to_string(), told);
            }
            // 1 % of the egg's size is allowed.
            _ => assert!(!(middle && low < 29.5), "{low}: {:?}", state.outcome),
        }
        certain += u64::from(middle && low < 29.5);
    }
    // In half of the heights, in half of the places, in four of five draws.
    assert!(failed >= certain && certain > DRAWS / 10, "{failed} {certain}");
    let tally = Tally::of_prior(&scene, 3, DRAWS, |_| true).unwrap();
    assert_eq!((tally.failures.simulated, tally.failures.failed()), (DRAWS, failed));
    let text = tally.failures.to_string();
    let begin = format!("{failed} of {DRAWS} draws failed, and have probability 0: plate crushes egg at 0.");
    assert!(text.starts_with(&begin) && text.ends_with(&format!("no way out (the first of {failed})")), "{text}");
}

/// Under a requirement that no draw that fails could meet, failures are counted as without: the floor under which a
/// candidate is rejected hides none. `rests_on` is judged at the end alone, so no simulation stops before it fails.
#[test]
fn a_floor_hides_no_failure() {
    let plain = scene(PRESS);
    let required = format!("{PRESS}[[require]]\nrests_on = {{ body = 'stone', on = 'floor', nats = 20 }}\n");
    let asked = Asked::new(scene(PRESS), &read(&required).require).unwrap();
    let iterations = 200;
    let (of_plain, of_asked) = (Independent::mixture(), Independent::mixture());
    let mut one = Chain::start(&plain, &of_plain, Seed(8).chain(0)).unwrap();
    let mut other = Chain::start(&asked, &of_asked, Seed(8).chain(0)).unwrap();
    for _ in 0..iterations {
        one.step().unwrap();
        other.step().unwrap();
    }
    assert!(one.failures().failed() > iterations / 10, "{:?}", one.failures());
    assert_eq!(one.failures(), other.failures());
}

/// However fast things are, a draw ends, and its animation stays small: five dominoes that a ball meets at up to a
/// million metres a second.
#[test]
fn however_fast_a_draw_ends_and_stays_small() {
    let text = "
[world.custom]
duration_s = 2
[[world.custom.fixed]]
name = 'floor'
shape = { plane = {} }
[[world.custom.bodies]]
name = 'ball'
shape = { ball = { radius_mm = 30 } }
at_mm = [-300, 0, 30]
velocity_m_s = ['exp(13.8 * e)', 0, 0]
[[world.custom.quantities]]
name = 'e'
value = { uniform = [0, 1] }
[[world.custom.bodies]]
name = 'domino'
count = 5
shape = { box = { size_mm = [14, 24, 48] } }
at_mm = ['30 * i + normal(0, 2)', 'normal(0, 3)', 24]
turn_deg = [0, 0, 'normal(0, 4)']
";
    let scene = scene(text);
    let (streams, mut scratch, mut done) = (Seed(1).chain(0), Default::default(), 0);
    for nth in 0..6 {
        let draw = scene.start(&mut streams.at(nth, Purpose::START));
        let state = State::evaluate(&scene, draw, &mut scratch).unwrap();
        if let Ending::Done(_) = state.outcome {
            let animation = scene.animate(&state.draw).unwrap();
            let pieces: usize = animation.motion.tracks.iter().map(|track| track.pieces.len()).sum();
            // 80 MB in all, of which a piece takes 176 bytes.
            assert!(pieces < 80_000_000 / 176, "{pieces}");
            done += 1;
        } else {
            assert!(matches!(state.outcome, Ending::Failed(_) | Ending::Overlap(_)), "{:?}", state.outcome);
        }
    }
    assert!(done > 0);
}

fn notes(text: &str) -> Vec<String> {
    let scenario = read(text);
    let World::Custom(config) = &scenario.world else { panic!("another world") };
    Asked::new(Custom::new(config).unwrap(), &scenario.require).unwrap().notes()
}

/// A round body without resistance to rolling never rests on level ground: told where a requirement wants it to, and
/// nowhere else.
#[test]
fn what_never_comes_to_rest_is_told() {
    let world = |shape: &str, material: &str, floor: &str, more: &str| {
        format!(
            "[world.custom]\nduration_s = 2\n[[world.custom.materials]]\nname = 'm'\n{material}\n\
             [[world.custom.fixed]]\nname = 'ground'\nshape = {{ plane = {{}} }}\n{floor}\n\
             [[world.custom.bodies]]\nname = 'coin'\nmaterial = 'm'\nshape = {{ {shape} }}\n\
             at_mm = [0, 0, {{ uniform = [60, 90] }}]\n{more}\n"
        )
    };
    let (coin, box_) = ("cylinder = { radius_mm = 12, height_mm = 2 }", "box = { size_mm = [20, 20, 20] }");
    let rests = "[[require]]\nrests_at = { body = 'coin', x_mm = 0, y_mm = 0, within_mm = 50 }";
    let told = |text: &str| {
        notes(text).iter().any(|note| note.contains("\"coin\" to come to rest") && note.contains("\"ground\""))
    };
    for shape in [coin, "ball = { radius_mm = 10 }", "capsule = { radius_mm = 5, length_mm = 20 }"] {
        assert!(told(&world(shape, "", "", rests)), "{shape}");
    }
    for (shape, material, floor, more) in [
        (box_, "", "", rests),
        (coin, "rolling = 0.01", "", rests),
        (coin, "rolling = { uniform = [0, 0.02] }", "", rests),
        (coin, "", "turn_deg = [0, 10, 0]", rests),
        (coin, "", "", ""),
        (coin, "", "", "[[require]]\ntouches = { body = 'coin', with = 'ground' }"),
        (coin, "", "", "[[require]]\nnot = { rests = { body = 'coin', when = { to_s = 1 } } }"),
        (coin, "", "", &format!("damping = 0.1\n{rests}")),
        (coin, "", "", &format!("[[world.custom.pairs]]\nbetween = ['m', '']\nrolling = 0.01\n{rests}")),
    ] {
        let text = world(shape, material, floor, more);
        assert!(!told(&text), "{text}");
    }
}

/// A body that begins inside a closed mesh without touching it is told; beside it, or in an open one, it is not.
#[test]
fn what_begins_inside_a_mesh_is_told() {
    let world = |mesh: &str, at: &str| {
        format!(
            "[world.custom]\nduration_s = 1\n[[world.custom.fixed]]\nname = 'rock'\nat_mm = [50, 0, 300]\n\
             shape = {{ mesh = {{ file = '{mesh}.obj' }} }}\n[[world.custom.bodies]]\nname = 'pea'\n\
             shape = {{ ball = {{ radius_mm = 2 }} }}\nat_mm = [{at}]\n"
        )
    };
    let told =
        |text: &str| notes(text).iter().any(|note| note.contains("\"pea\" begins inside the closed mesh \"rock\""));
    assert!(told(&world("wedge", "50, 0, 300")));
    assert!(told(&world("wedge", "{ uniform = [45, 55] }, 0, 300")));
    assert!(!told(&world("wedge", "90, 0, 300")));
    assert!(!told(&world("roof", "50, 0, 330")));
}

/// A body smaller than sand or faster than sound is told; one that is just neither is not.
#[test]
fn sizes_and_speeds_in_another_unit_are_told() {
    let world = |radius: &str, speed: &str| {
        format!(
            "[world.custom]\nduration_s = 1\n[[world.custom.bodies]]\nname = 'pea'\nat_mm = [0, 0, 100]\n\
             shape = {{ ball = {{ radius_mm = {radius} }} }}\nvelocity_m_s = [{speed}, 0, 0]\n"
        )
    };
    let told = |radius: &str, speed: &str| {
        let notes = notes(&world(radius, speed));
        notes.into_iter().find(|note| note.contains("its unit")).unwrap_or_default()
    };
    assert!(told("0.04", "1").contains("\"pea\" is 0.08 mm large"), "{}", told("0.04", "1"));
    assert!(told("40", "5000").contains("\"pea\" starts at 5000 m/s"), "{}", told("40", "5000"));
    assert_eq!(told("0.26", "339"), "");
}

/// A bad outline is told in millimetres, with the rule that it breaks.
#[test]
fn a_bad_outline_is_told_in_the_files_unit() {
    for (keys, parts) in [
        (
            "outline_mm = [[8, 13], [16, 9], [42, 11]]\ntop_mm = 42.05",
            ["the top is at 42.05 mm", "at least 42.11 mm", "0.11 mm above"],
        ),
        ("outline_mm = [[8, 13], [6, 9], [42, 11]]\ntop_mm = 60", ["at the height 6 mm", "more than 8 mm", "rise"]),
        ("outline_mm = [[8, 13], [16, 9], [42, 11]]\ntop_mm = 40", ["height 42 mm", "less than the top's", "40 mm"]),
    ] {
        let text = format!(
            "[world.custom]\n[[world.custom.bodies]]\nname = 'rook'\n[world.custom.bodies.shape.revolution]\n\
             foot_mm = 12.5\nrim_mm = 1.5\n{keys}\n"
        );
        let error = Scenario::read("rook.toml", &text, &[]).unwrap_err().to_string();
        assert!(error.contains("world.custom.bodies[0].shape.revolution: "), "{error}");
        for part in parts {
            assert!(error.contains(part), "{part}: {error}");
        }
    }
}

/// What never comes to rest, each with what it is said to do, and the body that does it: a top without friction, a ball
/// without resistance, one that misses a shelf, and a plate that crushes half of the eggs. What rests is no cause.
#[test]
fn how_draws_end_is_counted() {
    let world = |more: &str| format!("[world.custom]\nduration_s = 3\n{more}");
    let ball = "[[world.custom.bodies]]\nname = 'ball'\nshape = { ball = { radius_mm = 10 } }\n";
    let slick = "[[world.custom.materials]]\nname = 'slick'\nfriction = 0\n[[world.custom.bodies]]\nname = 'top'\n\
                 material = 'slick'\nshape = { cylinder = { radius_mm = 20, height_mm = 10 } }\nat_mm = [0, 0, 5]\n\
                 spin_deg_s = [0, 0, { uniform = [600, 900] }]\n";
    let shelf = "[[world.custom.fixed]]\nname = 'shelf'\nshape = { box = { size_mm = [100, 100, 20] } }\n\
                 [[world.custom.bodies]]\nname = 'brick'\nshape = { box = { size_mm = [20, 20, 20] } }\n\
                 at_mm = [0, 0, 20]\n";
    let stone = "[[world.custom.bodies]]\nname = 'stone'\nshape = { box = { size_mm = [20, 20, 20] } }\n\
                 at_mm = [0, 900, 10]\n";
    for (text, how, body) in [
        (world(&format!("{slick}{stone}")), "still spinning after 3 s", Some("top")),
        (
            world(&format!("{stone}{ball}at_mm = [0, 0, 10]\nvelocity_m_s = ['normal(1, 0.1)', 0, 0]\n")),
            "still moving after 3 s",
            Some("ball"),
        ),
        (world(&format!("{shelf}{ball}at_mm = ['normal(300, 9)', 0, 500]\n")), "fell out of the scene", Some("ball")),
        (world(stone), Ended::REST, None),
    ] {
        let tally = Tally::of_prior(&scene(&text), 3, 20, |_| true).unwrap();
        assert_eq!((tally.ends.ways(), tally.ends.draws), (vec![(how, 20, body)], 20), "{text}");
        assert_eq!(tally.ends.all_rest(), body.is_none());
    }
    let tally = Tally::of_prior(&scene(PRESS), 3, DRAWS, |_| true).unwrap();
    let ways = tally.ends.ways();
    let crushed = ways.iter().find(|(how, ..)| *how == "no way out").unwrap();
    assert_eq!((crushed.1, crushed.2), (tally.failures.failed(), Some("egg")), "{ways:?}");
    assert_eq!(ways.iter().map(|(_, count, _)| count).sum::<u64>(), DRAWS);
}
