//! Bodies that appear when something has happened.

use glam::DVec3;
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::{State, Target};
use plaus_scenes::animation::{Animation, Track};
use plaus_scenes::custom::{Custom, Ending};
use plaus_scenes::{AnyScratch, Scenario, Scene, Stage, World};

const G: f64 = 9.806_65;

fn stage(text: &str) -> Stage {
    let scenario = Scenario::read("late.toml", text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}"));
    scenario.stage().unwrap()
}

fn scene(text: &str) -> Custom {
    let scenario = Scenario::read("late.toml", text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let World::Custom(config) = scenario.world else { panic!("another world") };
    Custom::new(&config).unwrap()
}

fn draw(world: &Custom, nth: u64) -> <Custom as Target>::Draw {
    world.start(&mut Seed(3).chain(0).at(nth, Purpose::START))
}

fn track<'a>(animation: &'a Animation, name: &str) -> Option<&'a Track> {
    animation.motion.tracks.iter().find(|track| track.name == name)
}

/// A ball that falls, and what appears after it.
fn falling(appears: &str) -> String {
    format!(
        "[world.custom]\nduration_s = 6\n[[world.custom.materials]]\nname = 'felt'\nrolling = 0.05\nrestitution = 0.3\n\
         [[world.custom.bodies]]\nname = 'first'\nmaterial = 'felt'\nshape = {{ ball = {{ radius_mm = 30 }} }}\n\
         at_mm = [0, 0, {{ uniform = [100, 400] }}]\nvelocity_m_s = [0.3, 0, 0]\n\
         [[world.custom.bodies]]\nname = 'second'\nmaterial = 'felt'\nshape = {{ ball = {{ radius_mm = 30 }} }}\n\
         at_mm = [-900, 0, 700]\nvelocity_m_s = [{{ normal = [0.1, 0.2] }}, 0, 0.5]\nappears = {appears}\n"
    )
}

/// Gap in m at which bodies touch, at most, in all presets.
const GAP: f64 = 1e-5;

/// It follows its parabola from the very moment on, to rounding.
#[test]
fn a_second_throw_comes_when_the_first_rests() {
    let world = scene(&falling("{ when_rests = 'first', after_s = { uniform = [0, 0.5] } }"));
    let mut of_twin = 0.0_f64;
    for nth in 0..20 {
        let draw = draw(&world, nth);
        let [_, vx, after] = draw.numbers[..] else { panic!("{draw:?}") };
        let animation = world.animate(&draw).unwrap();
        let (first, second) = (track(&animation, "first").unwrap(), track(&animation, "second").unwrap());
        let appears = second.appears().unwrap();
        let rests = first.pieces.iter().find(|piece| piece.rests()).unwrap().start;
        assert!((appears - rests - after).abs() < 1e-12, "{appears}, {rests}, {after}");
        assert!(!second.is_there(appears.next_down()) && second.is_there(appears) && first.is_there(0.0));
        for t in [0.0, 0.1, 0.3] {
            let place = DVec3::new(-0.9 + vx * t, 0.7 + 0.5 * t - 0.5 * G * t * t, 0.0);
            assert!(second.position(appears + t).distance(place) < 1e-12, "{nth} at {t}");
            // A ball that had been there from the start would lie on the floor by then.
            of_twin = of_twin.max(second.position(appears + t).distance(DVec3::new(-0.9, 0.03, 0.0)));
        }
        let lands = animation.motion.impacts.iter().find(|hit| hit.involves("second")).unwrap().time;
        let fall = (0.5 + (0.25_f64 + 2.0 * G * 0.67).sqrt()) / G;
        assert!((lands - appears - fall).abs() < GAP / 3.0, "{lands}, {appears}, {fall}: it falls at more than 3 m/s");
    }
    assert!(of_twin > 0.6);
}

/// A ball appears in the way of another one: momentum and, at restitution 1, energy stay.
#[test]
fn what_appears_meets_the_others() {
    let world = scene(
        "[world.custom]\nduration_s = 2\ngravity = 0\nfixed = []\n\
         [[world.custom.materials]]\nname = 'steel'\nrestitution = 1\nfriction = 0\n\
         [[world.custom.bodies]]\nname = 'runner'\nmaterial = 'steel'\nshape = { ball = { radius_mm = 20 } }\n\
         at_mm = [0, 0, 0]\nvelocity_m_s = [{ uniform = [1, 2] }, 0, 0]\n\
         [[world.custom.bodies]]\nname = 'block'\nmaterial = 'steel'\nshape = { ball = { radius_mm = 20 } }\n\
         at_mm = [500, 0, 0]\nappears = { after_s = 0.1 }\n\
         [[world.custom.bodies]]\nname = 'echo'\nmaterial = 'steel'\nshape = { ball = { radius_mm = 20 } }\n\
         at_mm = [500, 300, 0]\nvelocity_m_s = [0, 1, 0]\n\
         appears = { when_touches = ['block', 'runner'], after_s = 0.2 }\n",
    );
    for nth in 0..10 {
        let draw = draw(&world, nth);
        let animation = world.animate(&draw).unwrap();
        let hits: Vec<f64> = animation.motion.impacts.iter().map(|hit| hit.time).collect();
        let meets = 0.46 / draw.numbers[0];
        assert!(hits.len() == 1 && (hits[0] - meets).abs() < GAP / draw.numbers[0], "{hits:?}, {meets}");
        let end = |name: &str| track(&animation, name).unwrap().pieces.last().unwrap().velocity.x;
        assert!(end("runner").abs() < 1e-9 && (end("block") - draw.numbers[0]).abs() < 1e-9);
        assert_eq!(track(&animation, "block").unwrap().appears(), Some(0.1));
        assert!((track(&animation, "echo").unwrap().appears().unwrap() - hits[0] - 0.2).abs() < 1e-12);
    }
}

/// A chain of them: each waits for the one before, and the last for what never happens.
#[test]
fn what_never_appears_is_missing() {
    let text = falling("{ when_rests = 'first' }")
        + "[[world.custom.bodies]]\nname = 'third'\nshape = { box = { size_mm = [60, 60, 60] } }\n\
           at_mm = [0, 900, 300]\nappears = { when_rests = 'second' }\n\
           [[world.custom.bodies]]\nname = 'never'\nshape = { ball = { radius_mm = 30 } }\nat_mm = [0, 1900, 300]\n\
           appears = { when_touches = ['first', 'third'] }\n";
    let world = scene(&text);
    let draw = draw(&world, 0);
    let animation = world.animate(&draw).unwrap();
    let names: Vec<&str> = animation.motion.tracks.iter().map(|track| track.name.as_str()).collect();
    assert_eq!(names, ["first", "second", "third"]);
    let times: Vec<f64> = animation.motion.tracks.iter().filter_map(Track::appears).collect();
    assert!(
        times[0] < times[1] && animation.motion.duration > times[1] && animation.motion.duration < 6.0,
        "{times:?}"
    );
    let state = State::evaluate(&world, draw, &mut plaus_scenes::custom::Work::default()).unwrap();
    let mut values = vec![0.0; world.scalars().len()];
    world.write_scalars(state.by_ref(), &mut values);
    let value = |name: &str| {
        let place = world.scalars().iter().position(|scalar| scalar.name == name).unwrap();
        values[place]
    };
    assert!(value("never.end_z").is_nan() && (value("third.end_z") - 30.0).abs() < 0.1 && value("second.end_z") > 29.0);
    let require = |what: &str| {
        let stage = stage(&format!("{text}[[require]]\n{what}\n"));
        let draw = stage.start(&mut Seed(3).chain(0).at(0, Purpose::START));
        State::evaluate(&stage, draw, &mut AnyScratch::default()).unwrap().outcome.marks()[0].margin
    };
    assert_eq!(require("rests = { body = 'never' }"), -1e6);
    assert!(require("not = { rests = { body = 'never' } }") >= 0.0);
    assert!(require("inside = { body = 'never', z_mm = [0, 1], how = 'never' }") >= 0.0);
    assert!(require("rests = { body = 'third', when = { to_s = 5 } }") >= 0.0);
    assert!(
        require("all = [{ rests = { body = 'second' } }, { touches = { body = 'second', with = 'floor' } }]") >= 0.0
    );
}

/// The second ball appears where the first has come to lie, in some draws: these fail, and say so.
#[test]
fn what_appears_inside_another_fails_its_draw() {
    let text = falling("{ when_rests = 'first' }")
        .replace("at_mm = [-900, 0, 700]", "at_mm = [{ uniform = [0, 400] }, 0, 50]");
    let world = scene(&text.replace("velocity_m_s = [{ normal = [0.1, 0.2] }, 0, 0.5]\n", ""));
    let mut failed = 0;
    for nth in 0..60 {
        let draw = draw(&world, nth);
        let state = State::evaluate(&world, draw.clone(), &mut plaus_scenes::custom::Work::default()).unwrap();
        match world.failure(&state.outcome) {
            Some(failure) => {
                let text = failure.to_string();
                assert!(text.starts_with("second appears inside first at ") && text.ends_with(" s: no room to appear"));
                assert!(state.log_p().value() == f64::NEG_INFINITY);
                failed += 1;
            }
            None => assert!(matches!(state.outcome, Ending::Done(_)), "{:?}", state.outcome),
        }
    }
    assert!((3..57).contains(&failed), "{failed}");
}

/// Stopping early for a requirement changes no decision, though bodies are still to come: a twin that takes what has
/// not appeared for missing does.
#[test]
fn hopeless_motions_are_stopped_only_if_nothing_can_appear_that_helps() {
    use plaus_dist::LogPotential;
    use plaus_mcmc::Simulated;
    use plaus_scenes::require::Stops;
    let text = falling("{ when_rests = 'first' }")
        + "[[require]]\nimpact = { body = 'second', with = 'floor', when = { from_s = 1, to_s = 2.5 } }\n\
           [[require]]\nimpact = { body = 'first', with = 'floor', when = { to_s = 0.2, scale_ms = 5 } }\n";
    let (mut stopped, mut wrong) = (0, 0);
    let twins = [Stops::Never, Stops::Soundly, Stops::Hastily].map(|stops| stage(&text).stopping(stops));
    for nth in 0..60 {
        let floor = LogPotential::new(-3.0).unwrap();
        let [whole, sound, hasty] = twins.each_ref().map(|stage| {
            let draw = stage.start(&mut Seed(3).chain(0).at(nth, Purpose::START));
            match stage.simulate(&draw, None, floor, &mut AnyScratch::default()).unwrap() {
                Simulated::Complete(answer) => stage.log_constraint(&answer).unwrap().value(),
                Simulated::CannotExceedFloor => f64::NEG_INFINITY,
            }
        });
        assert_eq!(whole > -3.0, sound > -3.0, "{nth}: {whole}, {sound}");
        stopped += u32::from(sound < whole);
        wrong += u32::from((whole > -3.0) != (hasty > -3.0));
    }
    assert!(stopped > 0 && wrong > 0, "{stopped}, {wrong}");
}

#[test]
fn what_cannot_appear_later_is_refused() {
    for (appears, expected) in [
        ("{ when_rests = 'frist' }", "there is no \"frist\"; did you mean \"first\"?"),
        ("{ when_rests = 'second' }", "cannot wait for itself"),
        ("{ when_rests = 'floor' }", "there is no \"floor\""),
        ("{ when_touches = ['first', 'flor'] }", "did you mean \"floor\"?"),
        ("{ when_rests = 'first', when_touches = ['first'] }", "it waits for one thing"),
        ("{ after_s = { normal = [0, 1] } }", "after_s"),
        ("{ when_rests = 'first' }\nrelease_s = 1", "`appears` says when"),
    ] {
        let error = Scenario::read("late.toml", &falling(appears), &[]).unwrap_err().to_string();
        assert!(error.contains(expected), "{appears}: {error}");
    }
    let marbles =
        falling("{ when_rests = 'first' }").replace("duration_s = 6", "duration_s = 6\nmechanics = 'marbles'");
    let error = Scenario::read("late.toml", &marbles, &[]).unwrap_err().to_string();
    assert!(error.contains("bodies[1].appears"), "{error}");
    let joint = falling("{ when_rests = 'first' }")
        + "[[world.custom.joints]]\nname = 'rod'\nbody = 'second'\nkind = { ball = {} }\n";
    let error = Scenario::read("late.toml", &joint, &[]).unwrap_err().to_string();
    assert!(error.contains("a joint cannot hold it"), "{error}");
}

/// Rods that are drawn of a joint move with the body that it holds, also where a body before it never appears.
#[test]
fn a_rod_goes_with_its_own_body() {
    let world = scene(
        "[world.custom]\nduration_s = 1\n\
         [[world.custom.bodies]]\nname = 'late'\nshape = { ball = { radius_mm = 10 } }\nat_mm = [900, 0, 100]\n\
         appears = { after_s = 5 }\n\
         [[world.custom.bodies]]\nname = 'bob'\nshape = { ball = { radius_mm = 30 } }\nat_mm = [200, 0, 500]\n\
         [[world.custom.bodies]]\nname = 'other'\nshape = { ball = { radius_mm = 30 } }\nat_mm = [-600, 0, 100]\n\
         velocity_m_s = [0, 0.3, 0]\n\
         [[world.custom.joints]]\nname = 'string'\nbody = 'bob'\nat_mm = [0, 0, 500]\nkind = { ball = {} }\ndrawn_mm = 2\n",
    );
    let animation = world.animate(&draw(&world, 0)).unwrap();
    assert!(track(&animation, "late").is_none());
    let [bob, other, rod] = ["bob", "other", "string"].map(|name| track(&animation, name).unwrap());
    for time in [0.0, 0.4, 0.9] {
        assert_eq!((rod.position(time), rod.orientation(time)), (bob.position(time), bob.orientation(time)));
        assert!(rod.position(time).distance(other.position(time)) > 0.1);
    }
    // From the middle of the bob to the joint, 200 mm away.
    let plaus_scenes::animation::Shape::Solid { vertices, .. } = &*rod.shape else { panic!("{:?}", rod.shape) };
    let longest = vertices.iter().map(|vertex| vertex.length()).fold(0.0, f64::max);
    assert!((longest - 0.2_f64.hypot(0.002)).abs() < 1e-12, "{longest}");
}
