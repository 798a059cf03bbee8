//! Contacts of a user's world that are told: all that bear load, from the first moment, at every preset.

use glam::DVec3;
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::{State, Target};
use plaus_scenes::animation::{Contact, Motion};
use plaus_scenes::custom::Custom;
use plaus_scenes::{AccuracyPreset, Scenario, Scene, Stage, World};

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

/// Marbles: one at rest from the start, one that falls on a slope and rolls down onto the floor.
const MARBLES: &str = "[world.custom]\nduration_s = 3\nmechanics = 'marbles'\n\
    materials = [{ name = 'glass', rolling = 0.02 }]\n\
    fixed = [{ name = 'floor', shape = { plane = {} }, material = 'glass' },\
    { name = 'slope', shape = { plane = {} }, material = 'glass', at_mm = [100, 0, 0], turn_deg = [0, -40, 0] }]\n\
    [[world.custom.bodies]]\nname = 'still'\nmaterial = 'glass'\nshape = { ball = { radius_mm = 10 } }\n\
    at_mm = [-100, 0, 10]\n\
    [[world.custom.bodies]]\nname = 'low'\nmaterial = 'glass'\nshape = { ball = { radius_mm = 10 } }\n\
    at_mm = [110, 0, 40]\n";

/// What a world shows at a preset, and which of some requirements it meets, found out by a simulation of a chain, which
/// keeps contacts only because these ask for them.
fn run(text: &str, preset: AccuracyPreset, requirements: &[&str]) -> (Motion, Vec<bool>) {
    let required: String = requirements.iter().map(|one| format!("[[require]]\n{one}\n")).collect();
    let set = format!("world.custom.accuracy={}", preset.name());
    let scenario = Scenario::read("contacts.toml", &format!("{text}{required}"), &[set]);
    let stage: Stage = scenario.unwrap_or_else(|error| panic!("{error}\n{text}")).stage().unwrap();
    let draw = stage.start(&mut Seed(5).chain(0).at(0, Purpose::START));
    let state = State::evaluate(&stage, draw, &mut Default::default()).unwrap();
    let motion = stage.motion(&state.draw).unwrap();
    let met: Vec<bool> = state.outcome.marks().iter().map(|mark| mark.met()).collect();
    let shown: Vec<bool> = stage.judge(&motion, &[]).iter().map(|mark| mark.met()).collect();
    assert_eq!(met, shown, "{preset:?}: {requirements:?}");
    (motion, met)
}

/// The contacts of two things, in order.
fn between<'a>(motion: &'a Motion, pair: [&str; 2]) -> Vec<&'a Contact> {
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

/// A box that stands presses with its weight, and a lintel on two blocks with about half of it on each: how the
/// corners of
/// a block's top share that is left open, so the halves differ. Together they are the whole, to the 1e-6 of the
/// weight to
/// which static equilibrium is found, for each body; friction that the two may push against each other adds its square,
/// of which 1e-3 is allowed.
#[test]
fn forces_are_those_of_the_weight() {
    for preset in AccuracyPreset::ALL {
        let (motion, _) = run(STANDS, preset, &[]);
        let [one] = between(&motion, ["box", "floor"])[..] else { panic!("{:?}", motion.contacts) };
        let weight = one.force;
        assert!((one.start, one.slip, one.roll) == (0.0, 0.0, 0.0) && weight > 1.0, "{one:?}");
        assert!((one.normal - DVec3::Y).length() < 1e-9 && one.point.length() < 1e-6, "{one:?}");
        let (motion, _) = run(LINTEL, preset, &[]);
        let whole = 2.5 * weight;
        let halves = ["a", "b"].map(|side| {
            let last = between(&motion, ["lintel", side]).pop().unwrap();
            assert!(last.slip == 0.0 && last.end == motion.duration, "{last:?}");
            // Nearly all of a block's top is at 0.1 m to 0.2 m from the middle.
            assert!(last.force > whole / 3.0, "{preset:?}: {last:?}");
            let below = between(&motion, [side, "floor"]);
            assert!(below[0].start == 0.0, "{below:?}");
            let all = below.last().unwrap().force / (weight + last.force);
            assert!((all - 1.0).abs() < 1e-3, "{below:?}");
            last.force
        });
        let all = (halves[0] + halves[1]) / whole;
        assert!((1.0 - 1e-5..1.001).contains(&all), "{preset:?}: {halves:?}");
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
            // Between two steps of 50 ms, draft has some of 1 ms in which the ball is off the wall.
            let off: f64 = contacts.windows(2).map(|two| two[1].start - two[0].end).sum();
            assert!(off < 0.03, "{preset:?} {other}: {off}");
            assert!(first.slip + first.roll > 1e-3, "{first:?}");
        }
    }
}

/// Crates on planks at 26.6°, by materials, by a pair, and by quantities: they stay if the larger of the two
/// coefficients holds them, and slide by the smaller one, `s = g (sin θ − µ cos θ) t²/2`, if it does not.
#[test]
fn what_does_not_slide_is_held_by_the_static_friction() {
    let slid = |materials: &str| {
        let text = format!(
            "[world.custom]\nduration_s = 0.5\n{materials}\n\
             [[world.custom.fixed]]\nname = 'plank'\nmaterial = 'wood'\nshape = {{ plane = {{}} }}\n\
             turn_deg = [0, 26.565051177, 0]\n\
             [[world.custom.bodies]]\nname = 'crate'\nmaterial = 'wood'\nturn_deg = [0, 26.565051177, 0]\n\
             shape = {{ box = {{ size_mm = [80, 60, 20] }} }}\n\
             at_mm = ['10 * sin(26.565051177)', 0, '10 * cos(26.565051177)']\n"
        );
        let scenario = Scenario::read("a.toml", &text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}"));
        let World::Custom(config) = scenario.world else { panic!("another world") };
        let scene = Custom::new(&config).unwrap();
        let film = scene.animate(&scene.start(&mut Seed(1).chain(0).at(0, Purpose::START))).unwrap();
        film.motion.tracks[0].position(0.5).distance(film.motion.tracks[0].position(0.0))
    };
    let wood = |said: &str| format!("[[world.custom.materials]]\nname = 'wood'\nrestitution = 0\n{said}\n");
    let pair = |said: &str| wood("") + "[[world.custom.pairs]]\nbetween = ['wood', 'wood']\n" + said;
    let quantity = "[[world.custom.quantities]]\nname = 'mu'\nvalue = { uniform = [0.4, 0.4001] }";
    for stays in [
        wood("friction = 0.4\nstatic_friction = 0.6"),
        pair("friction = 0.4\nstatic_friction = 0.6"),
        wood("friction = 'mu'\nstatic_friction = '1.5 * mu'") + quantity,
    ] {
        assert!(slid(&stays) < 1e-6, "{stays}: {}", slid(&stays));
    }
    let way = 0.125 * 9.806_65 * (0.5 - 0.4) / 1.25_f64.sqrt();
    for slides in [wood("friction = 0.4"), wood("friction = 0.4\nstatic_friction = 0.45"), pair("friction = 0.4")] {
        // The first steps, until it is faster than what counts as still, have the larger friction.
        let found = slid(&slides);
        assert!((found - way).abs() < 0.05 * way, "{slides}: {found} for {way}");
    }
}
