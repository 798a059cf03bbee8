//! Contacts of a user's world that are told: all that bear load, from the first moment, at every preset.

use glam::DVec3;
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::{State, Target};
use plaus_scenes::animation::{Animation, Contact};
use plaus_scenes::registry::Stage;
use plaus_scenes::{AccuracyPreset, Scenario, Scene};

/// A box that stands on the floor from the start.
const STANDS: &str = "[world.custom]\nduration_s = 1\n[[world.custom.bodies]]\nname = 'box'\n\
    shape = { box = { size_mm = [100, 100, 100] } }\nat_mm = [0, 0, 50]\n";

/// A ball that a force presses against a wall while it rolls along it, on a floor.
const LEANS: &str = "[world.custom]\nduration_s = 1\n\
    fixed = [{ name = 'floor', shape = { plane = {} } },\
    { name = 'wall', shape = { box = { size_mm = [20, 400, 400] } }, at_mm = [60, 0, 200] }]\n\
    [[world.custom.bodies]]\nname = 'ball'\nshape = { ball = { radius_mm = 50 } }\nat_mm = [0, 0, 50]\n\
    velocity_m_s = [0, 0.2, 0]\nforce_n = [1, 0, 0]\n";

/// A lintel that falls by 2 mm on two blocks.
const LINTEL: &str = "[world.custom]\nduration_s = 1\n\
    [[world.custom.bodies]]\nname = 'a'\nshape = { box = { size_mm = [100, 100, 100] } }\nat_mm = [-150, 0, 50]\n\
    [[world.custom.bodies]]\nname = 'b'\nshape = { box = { size_mm = [100, 100, 100] } }\nat_mm = [150, 0, 50]\n\
    [[world.custom.bodies]]\nname = 'lintel'\nshape = { box = { size_mm = [500, 100, 50] } }\nat_mm = [0, 0, 127]\n";

/// A wall of bricks that sleeps until something hits it, which nothing does.
const SLEEPS: &str = "[world.custom]\nduration_s = 0.5\n\
    [[world.custom.bodies]]\nname = 'low'\nasleep = true\nshape = { box = { size_mm = [100, 100, 100] } }\n\
    at_mm = [0, 0, 50]\n\
    [[world.custom.bodies]]\nname = 'high'\nasleep = true\nshape = { box = { size_mm = [100, 100, 100] } }\n\
    at_mm = [10, 0, 150]\n";

/// Marbles: one at rest from the start, one in a corner of the floor and a slope.
const MARBLES: &str = "[world.custom]\nduration_s = 3\nmechanics = 'marbles'\n\
    materials = [{ name = 'glass', rolling = 0.02 }]\n\
    fixed = [{ name = 'floor', shape = { plane = {} }, material = 'glass' },\
    { name = 'slope', shape = { plane = {} }, material = 'glass', at_mm = [100, 0, 0], turn_deg = [0, -40, 0] }]\n\
    [[world.custom.bodies]]\nname = 'still'\nmaterial = 'glass'\nshape = { ball = { radius_mm = 10 } }\n\
    at_mm = [-100, 0, 10]\n\
    [[world.custom.bodies]]\nname = 'low'\nmaterial = 'glass'\nshape = { ball = { radius_mm = 10 } }\n\
    at_mm = [90, 0, 40]\n";

/// What a world shows at a preset, and which of some requirements it meets, found out by a simulation of a chain, which
/// keeps contacts only because these ask for them.
fn run(text: &str, preset: AccuracyPreset, requirements: &[&str]) -> (Animation, Vec<bool>) {
    let required: String = requirements.iter().map(|one| format!("[[require]]\n{one}\n")).collect();
    let set = format!("world.custom.accuracy={}", preset.name());
    let scenario = Scenario::read("contacts.toml", &format!("{text}{required}"), &[set]);
    let stage: Stage = scenario.unwrap_or_else(|error| panic!("{error}\n{text}")).stage().unwrap();
    let draw = stage.start(&mut Seed(5).chain(0).at(0, Purpose::START));
    let state = State::evaluate(&stage, draw, &mut Default::default()).unwrap();
    let motion = stage.motion(&state.draw).unwrap();
    let met: Vec<bool> = state.outcome.marks().iter().map(|mark| mark.met()).collect();
    let shown: Vec<bool> = stage.judge(&motion).iter().map(|mark| mark.met()).collect();
    assert_eq!(met, shown, "{preset:?}: {requirements:?}");
    (motion, met)
}

/// The contacts of two things, in order.
fn between<'a>(motion: &'a Animation, pair: [&str; 2]) -> Vec<&'a Contact> {
    motion.contacts.iter().filter(|one| pair.iter().all(|name| one.involves(name))).collect()
}

#[test]
fn what_bears_load_is_told_at_every_preset() {
    let touches = |body: &str, with: &str| format!("touches = {{ body = '{body}', with = '{with}' }}");
    let rests = |body: &str, on: &str| format!("rests_on = {{ body = '{body}', on = '{on}' }}");
    let never = |body: &str, with: &str| format!("not = {{ {} }}", touches(body, with));
    let (late, early) = ("when = { from_s = 0.9 }", "when = { to_s = 0.001 }");
    let at = |when: &str| format!("touches = {{ body = 'box', with = 'floor', {when} }}");
    let cases = [
        (STANDS, touches("box", "floor"), true),
        (STANDS, rests("box", "floor"), true),
        (STANDS, never("box", "floor"), false),
        (STANDS, at(late), true),
        (STANDS, at(early), true),
        (LEANS, touches("ball", "wall"), true),
        (LEANS, touches("ball", "floor"), true),
        (LEANS, never("ball", "wall"), false),
        (LEANS, rests("ball", "floor"), true),
        (LEANS, rests("ball", "wall"), false),
        (LINTEL, touches("lintel", "a"), true),
        (LINTEL, touches("lintel", "b"), true),
        (LINTEL, rests("lintel", "a"), true),
        (LINTEL, rests("lintel", "b"), true),
        (LINTEL, rests("a", "lintel"), false),
        (LINTEL, rests("a", "floor"), true),
        (LINTEL, touches("a", "b"), false),
        (SLEEPS, touches("low", "floor"), true),
        (SLEEPS, rests("high", "low"), true),
        (SLEEPS, rests("high", "floor"), false),
        (MARBLES, rests("still", "floor"), true),
        (MARBLES, never("still", "floor"), false),
        (MARBLES, touches("low", "slope"), true),
        (MARBLES, rests("low", "floor"), true),
    ];
    for preset in AccuracyPreset::ALL {
        for (text, require, wanted) in &cases {
            let (_, met) = run(text, preset, &[require]);
            assert_eq!(met, [*wanted], "{preset:?}: {require}\n{text}");
        }
    }
}

/// A box that stands presses with its weight; a lintel with half of it on each side. Static equilibrium is found to 1e-6
/// of the weight.
#[test]
fn forces_are_those_of_the_weight() {
    for preset in AccuracyPreset::ALL {
        let (motion, _) = run(STANDS, preset, &[]);
        let [one] = between(&motion, ["box", "floor"])[..] else { panic!("{:?}", motion.contacts) };
        let weight = one.force;
        assert!((one.start, one.slip, one.roll) == (0.0, 0.0, 0.0) && weight > 1.0, "{one:?}");
        assert!((one.normal - DVec3::Y).length() < 1e-9 && one.point.length() < 1e-6, "{one:?}");
        let (motion, _) = run(LINTEL, preset, &[]);
        for side in ["a", "b"] {
            let last = between(&motion, ["lintel", side]).pop().unwrap();
            let half = 0.5 * weight * 500.0 * 50.0 / 1e4;
            assert!((last.force / half - 1.0).abs() < 1e-5 && last.slip == 0.0, "{preset:?} {last:?} {half}");
            let below = between(&motion, [side, "floor"]);
            assert!(below[0].start == 0.0, "{below:?}");
            let all = below.last().unwrap().force;
            assert!((all / (weight + half) - 1.0).abs() < 1e-5, "{preset:?} {all}");
        }
    }
}

/// A ball that slides along a floor and a wall is told to bear on both all the time, so both are heard; the wall bears
/// what the force has over the friction of the floor.
#[test]
fn a_second_lasting_contact_is_told_and_heard() {
    for preset in AccuracyPreset::ALL {
        let (motion, _) = run(LEANS, preset, &[]);
        for other in ["floor", "wall"] {
            let contacts = between(&motion, ["ball", other]);
            let (first, last) = (contacts.first().unwrap(), contacts.last().unwrap());
            assert!(first.start == 0.0 && last.end == motion.duration, "{preset:?} {other}: {contacts:?}");
            let gaps = contacts.windows(2).filter(|two| two[1].start > two[0].end + 1e-9).count();
            assert_eq!(gaps, 0, "{preset:?} {other}: {contacts:?}");
            assert!(first.slip + first.roll > 1e-3, "{first:?}");
        }
    }
}
