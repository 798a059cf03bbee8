//! Bounds from a motion that is known in part: for every kind, over many draws and times, the whole motion never
//! exceeds them. Twins that claim to know more than they do are caught.

use plaus_dist::{Purpose, Seed};
use plaus_mcmc::Target;
use plaus_scenes::animation::Motion;
use plaus_scenes::ball2d::Ball2d;
use plaus_scenes::bowling::{self, Bowling};
use plaus_scenes::custom::Custom;
use plaus_scenes::dice::{self, Dice};
use plaus_scenes::require::{Probe, Require};
use plaus_scenes::spelling::{self, Spelling};
use plaus_scenes::{Scenario, Scene, World, ball2d};
use rand::RngExt;

/// At least one of every kind, with numbers that some motions of a ball meet and some do not.
const OF_A_BALL: &[&str] = &[
    "impact = { nth = 2, when = { at_s = 0.6, within_ms = 50 } }",
    "impact = { nth = -1, when = { from_s = 0.9 } }",
    "impact = { with = 'table', faster_than = 1.5, when = { frame = 8 } }",
    "rests = { when = { to_s = 1.1 } }",
    "bounces = { at_least = 2, at_most = 3, when = { to_s = 0.9 } }",
    "bounces = { at_least = 3, faster_than = 1.0 }",
    "rests_at = { x_mm = 50, within_mm = 100, scale_mm = 50 }",
    "rests_on = { on = 'table' }",
    "inside = { x_mm = [20, 200], z_mm = [60, 500], how = 'sometimes', scale_mm = 20 }",
    "inside = { x_mm = [-100, 100], how = 'always', scale_mm = 20 }",
    "inside = { x_mm = [-300, -20], how = 'never', when = { from_s = 0.4, to_s = 1.0 } }",
    "inside = { centre_mm = [50, 0, 50], radius_mm = 100, scale_mm = 20 }",
    "passes = { x_mm = 50, z_mm = 150, within_mm = 30, scale_mm = 20 }",
    "in_view = { how = 'sometimes', when = { from_s = 0.4 }, camera = { at_mm = [0, -900, 150] }, scale_deg = 1 }",
    "in_view = { how = 'always', when = { to_s = 0.9 }, camera = { at_mm = [0, -2000, 150] } }",
    "in_view = { how = 'never', when = { from_s = 0.3, to_s = 0.5 }, camera = { at_mm = [900, 0, 400] } }",
    "touches = { with = 'table', when = { from_s = 0.5, to_s = 0.6 } }",
    "before = { first = { nth = 2 }, then = { nth = 3 }, by_ms = 200, scale_ms = 50 }",
    "before = { first = { nth = 3 }, then = { what = 'rest' }, by_ms = 100 }",
    "apart = { one = { nth = 3 }, other = { nth = 2 }, at_least_ms = 180, at_most_ms = 230, scale_ms = 50 }",
    "apart = { one = { nth = -1 }, other = { what = 'rest' }, at_most_ms = 30 }",
    "beats = { every_s = 0.3, within_ms = 40, scale_ms = 40, each = 'impact' }",
    "beats = { times_s = [0.3, 0.8], within_ms = 40, scale_ms = 40, each = 'beat' }",
    "beats = { nth = 2, every_s = 0.5, within_ms = 40, scale_ms = 40 }",
    "beats = { times_s = [0.3, 0.8], strengths = [2, 1], each = 'beat', within_ms = 400, strength = { within = 0.1 } }",
    "beats = { times_s = [0.3, 0.8], strengths = [2, 1], each = 'impact', strength = { loudest_n_s = 2, power = 2 } }",
    "beats = { times_s = [0.3, 0.8], strengths = [2, 1], nth = 2, within_ms = 400, strength = { loudest_n_s = 1.5 } }",
    "speed = { nth = 2, at_least = 2.0, scale = 0.2 }",
    "speed = { nth = -1, at_most = 1.5, after = true }",
    "speed = { at_most = 3, when = { from_s = 0.2, to_s = 0.9 } }",
    "speed = { at_least = 0.5, which = 'least', when = { from_s = 0.2, to_s = 0.9 } }",
    "height = { at_most_mm = 200, when = { from_s = 0.4 } }",
    "height = { at_least_mm = 60, which = 'least', when = { from_s = 0.5, to_s = 0.7 } }",
    "height = { at_least_mm = 100, when = { at_s = 0.7 } }",
    "impulse = { nth = 2, at_least = 1.5 }",
    "air_time = { at_least_s = 0.8, at_most_s = 1.2 }",
    "path_length = { at_least_mm = 900, at_most_mm = 1100, when = { to_s = 0.8 } }",
    "count = { at_least = 1, that = { rests_at = { x_mm = 50, within_mm = 100 } } }",
    "all = [{ impact = { when = { to_s = 0.4 } } }, { passes = { x_mm = 50, z_mm = 150 } }]",
    "any = [{ impact = { nth = 2, when = { to_s = 0.5 } } }, { inside = { x_mm = [0, 50] } }]",
    "not = { inside = { x_mm = [20, 200], how = 'sometimes' } }",
    "at_least = { count = 2, of = [{ rests = { when = { to_s = 1.0 } } }, { path_length = { at_least_mm = 900 } }, \
     { bounces = { at_least = 3, when = { to_s = 0.9 } } }] }",
    "named = { name = 'late', that = { impact = { nth = -1, when = { from_s = 0.9 } } } }",
];

/// Requirements that need bodies that turn, or several bodies.
const OF_DICE: &[&str] = &[
    "faces_up = { body = 'die_1', face = 6, within_deg = 30 }",
    "faces_up = { body = 'die_2', axis = 'minus_x', within_deg = 60, when = { at_s = 0.2 } }",
    "points = { body = 'die_1', axis = 'y', toward = [1, 1, 0], within_deg = 60, when = { at_s = 0.3 } }",
    "orientation = { body = 'die_1', turn_deg = [0, 0, 90], within_deg = 90 }",
    "falls = { body = 'die_1', when = { from_s = 0.1 } }",
    "falls = { body = 'die_*', fallen_deg = 100, when = { to_s = 0.4 } }",
    "order = { bodies = ['die_2', 'die_1'] }",
    "order = { bodies = ['die_*'], each = { what = 'fall', fallen_deg = 80 } }",
    "turns = { body = 'die_1', at_least = 2, at_most = 3 }",
    "turns = { body = 'die_1', about = [0, 0, 1], at_least = 0, when = { from_s = 0.1, to_s = 0.5 } }",
    "spin = { body = 'die_1', at_most = 60, when = { from_s = 0.2 } }",
    "spin = { body = 'die_1', at_least = 10, which = 'least', when = { to_s = 0.5 } }",
    "sum = { of = 'die_*', at_least = 7, at_most = 7 }",
    "sum = { of = 'die_*', at_most = 5, when = { at_s = 0.3 } }",
    "stands = { body = 'die_1', when = { frame = 6 } }",
    "relative = { body = 'die_1', to = 'die_2', x_mm = 20, y_mm = 0, within_mm = 40, when = { at_s = 0.3 } }",
    "relative = { body = 'die_1', to = 'die_2', z_mm = 0 }",
    "in_view = { body = 'die_1', camera = { at_mm = [0, -600, 20], fov_deg = 10 }, when = { at_s = 0.3 } }",
    "in_view = { body = 'die_2', camera = { at_mm = [0, -600, 20] }, how = 'never' }",
    "touches = { body = 'die_1', with = 'die_2' }",
    "not = { touches = { body = 'die_*', with = 'die_*', when = { to_s = 0.3 } } }",
    "count = { of = 'die_*', at_least = 1, at_most = 1, that = { faces_up = { face = 6 } } }",
    "count = { of = 'die_*', at_most = 1, that = { bounces = { at_least = 4, when = { to_s = 0.4 } } } }",
    "spin = { body = 'die_1', nth = 2, at_least = 10, after = true }",
    "beats = { body = 'die_*', every_s = 0.1, within_ms = 20 }",
    "rests = { body = 'die_*', when = { to_s = 0.9 } }",
    "rests_on = { body = 'die_2', on = 'table' }",
];

/// Those that need pins.
const OF_PINS: &[&str] = &[
    "leaves = { pins = [5] }",
    "leaves = { pins = [2, 5], moved_far_mm = 10, nats_each = 1 }",
    "leaves = {}",
    "not = { leaves = { pins = [5] } }",
    "any = [{ leaves = { pins = [5] } }, { leaves = { pins = [2] } }]",
];

/// Those that need bins.
const OF_BINS: &[&str] = &[
    "spells = { bitmap = '##' }",
    "not = { spells = { bitmap = '#.#', nats_each = 1 } }",
    "spells = { bitmap = \"###\\n###\\n###\" }",
];

/// Those that need joints.
const OF_A_WELD: &[&str] = &[
    "breaks = { joint = 'glue' }",
    "breaks = { when = { from_s = 0.15, to_s = 0.22 } }",
    "not = { breaks = { joint = 'gl*', when = { to_s = 0.2 } } }",
];

pub(super) fn requirement(text: &str) -> Require {
    toml::from_str(text).unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn balls() -> Ball2d {
    Ball2d::new(&ball2d::Config { collisions: 3, sigma_theta_deg: 15.0, ..ball2d::Config::default() }).unwrap()
}

fn two_dice() -> Dice {
    Dice::new(&dice::Config { dice: 2, constraints: Vec::new(), ..dice::Config::default() }).unwrap()
}

/// A shelf on a weld of uncertain strength, onto which a ball drops from an uncertain height.
fn shelf() -> Custom {
    let text = "[world.custom]\nduration_s = 0.4\nfixed = []\n[[world.custom.bodies]]\nname = 'shelf'\n\
                shape = { box = { size_mm = [200, 100, 10] } }\n[[world.custom.bodies]]\nname = 'ball'\n\
                shape = { ball = { radius_mm = 30 } }\nat_mm = [0, 0, { uniform = [60, 400] }]\n\
                [[world.custom.joints]]\nname = 'glue'\nbody = 'shelf'\nat_mm = [-100, 0, 0]\n\
                kind = { weld = { breaks_at_n_s = { uniform = [0.1, 0.6] } } }\n";
    let scenario = Scenario::read("shelf.toml", text, &[]).unwrap_or_else(|error| panic!("{error}"));
    let World::Custom(config) = scenario.world else { panic!("another world") };
    Custom::new(&config).unwrap()
}

fn pins() -> Bowling {
    Bowling::new(&bowling::Config { pins: vec![1, 2, 3, 5], leave: vec![5], ..bowling::Config::default() }).unwrap()
}

fn bins() -> Spelling {
    let (bitmap, balls) = ("##".to_owned(), 9);
    Spelling::new(&spelling::Config { bitmap, balls, ..spelling::Config::default() }).unwrap()
}

/// The part of a motion before `known`, as a simulation that stops there would leave it.
fn beginning(motion: &Motion, known: f64) -> Motion {
    let mut begun = motion.clone();
    for track in &mut begun.tracks {
        let kept = track.pieces.partition_point(|piece| piece.start < known).max(1);
        track.pieces.truncate(kept);
    }
    begun.impacts.retain(|hit| hit.time < known);
    begun.contacts.retain(|contact| contact.start < known);
    begun.breaks.retain(|one| one.time < known);
    begun.duration = begun.duration.min(known);
    begun
}

/// For each text, the number of pairs of a draw and a time for which the bounds hold, and for which they fail.
/// `claimed` turns the time up to which the motion is known into the time up to which it is said to be known.
pub(super) fn bounds<S: Scene>(scene: &S, texts: &[&str], draws: u64, claimed: impl Fn(f64) -> f64) -> Vec<[u32; 2]> {
    let cast = scene.cast();
    let mut seen = vec![[0; 2]; texts.len()];
    let requirements: Vec<Require> = texts.iter().map(|text| requirement(text)).collect();
    for nth in 0..draws {
        let mut stream = Seed(7).chain(0).at(nth, Purpose::START);
        let draw = scene.start(&mut stream);
        let motion = scene.motion(&draw).unwrap();
        for _ in 0..6 {
            let known = stream.random_range(0.0..1.1) * motion.duration;
            let begun = beginning(&motion, known);
            for (one, seen) in requirements.iter().zip(&mut seen) {
                let whole = one.reach(&Probe::whole(&motion, &cast));
                assert_eq!(whole.least, whole.most, "{one:?} is certain of a whole motion");
                let reach = one.reach(&Probe::until(&begun, &cast, claimed(known)));
                let (log, margin) = (whole.most.log, whole.most.margin);
                let holds = within(reach.least.log, log, reach.most.log)
                    && within(reach.least.margin, margin, reach.most.margin);
                seen[usize::from(!holds)] += 1;
            }
        }
    }
    seen
}

/// Up to rounding, because sums over legs that are cut at other places differ.
fn within(least: f64, value: f64, most: f64) -> bool {
    let slack = 1e-9 * (1.0 + value.abs());
    least <= value + slack && value <= most + slack
}

#[test]
fn a_whole_motion_stays_within_the_bounds_of_its_beginning() {
    for (text, [_, failed]) in OF_A_BALL.iter().zip(bounds(&balls(), OF_A_BALL, 150, |known| known)) {
        assert_eq!(failed, 0, "{text}");
    }
    for (text, [_, failed]) in OF_DICE.iter().zip(bounds(&two_dice(), OF_DICE, 12, |known| known)) {
        assert_eq!(failed, 0, "{text}");
    }
    for (text, [_, failed]) in OF_A_WELD.iter().zip(bounds(&shelf(), OF_A_WELD, 40, |known| known)) {
        assert_eq!(failed, 0, "{text}");
    }
    for (text, [_, failed]) in OF_PINS.iter().zip(bounds(&pins(), OF_PINS, 30, |known| known)) {
        assert_eq!(failed, 0, "{text}");
    }
    for (text, [_, failed]) in OF_BINS.iter().zip(bounds(&bins(), OF_BINS, 40, |known| known)) {
        assert_eq!(failed, 0, "{text}");
    }
}

/// A twin that takes a beginning for the whole is caught, for every kind.
#[test]
fn a_twin_that_takes_a_beginning_for_the_whole_is_caught() {
    for (text, [_, failed]) in OF_A_BALL.iter().zip(bounds(&balls(), OF_A_BALL, 150, |_| f64::INFINITY)) {
        assert!(failed > 0, "{text}");
    }
    for (text, [_, failed]) in OF_DICE.iter().zip(bounds(&two_dice(), OF_DICE, 12, |_| f64::INFINITY)) {
        assert!(failed > 0, "{text}");
    }
    for (text, [_, failed]) in OF_A_WELD.iter().zip(bounds(&shelf(), OF_A_WELD, 40, |_| f64::INFINITY)) {
        assert!(failed > 0, "{text}");
    }
    for (text, [_, failed]) in OF_PINS.iter().zip(bounds(&pins(), OF_PINS, 30, |_| f64::INFINITY)) {
        assert!(failed > 0, "{text}");
    }
    for (text, [_, failed]) in OF_BINS.iter().zip(bounds(&bins(), OF_BINS, 40, |_| f64::INFINITY)) {
        assert!(failed > 0, "{text}");
    }
}

/// A requirement for times is met if each time is found within its window, and only then.
#[test]
fn requirements_for_times_are_met_if_the_times_are_found() {
    fn met<S: Scene>(scene: &S, texts: &[&str], draws: u64) {
        let (cast, timely) = (scene.cast(), ["impact", "rests", "falls", "touches", "beats", "breaks"]);
        let mut seen = [0; 2];
        // Strengths are required besides.
        let texts = texts.iter().filter(|text| !text.contains("strength"));
        for one in texts.map(|text| requirement(text)).filter(|one| timely.contains(&one.name())) {
            for nth in 0..draws {
                let draw = scene.start(&mut Seed(8).chain(0).at(nth, Purpose::START));
                let motion = scene.motion(&draw).unwrap();
                let probe = Probe::whole(&motion, &cast);
                let times = one.times(&probe);
                let inside = times.iter().all(|at| at.found.is_some_and(|t| at.wanted.from <= t && t <= at.wanted.to));
                assert_eq!(one.reach(&probe).most.met(), inside, "{one:?}: {times:?}");
                seen[usize::from(inside)] += 1;
            }
        }
        assert!(seen[0] > 0 && seen[1] > 0, "{seen:?}");
    }
    met(&balls(), OF_A_BALL, 150);
    met(&two_dice(), OF_DICE, 12);
    met(&shelf(), OF_A_WELD, 40);
}

/// Each ball fills one bin at most: bins without a ball that might fill them are known to be empty from the beginning.
#[test]
fn balls_that_are_dropped_bound_what_they_can_spell() {
    let (scene, one) = (bins(), requirement("spells = { bitmap = \"###\\n###\\n###\", nats_each = 1 }"));
    let (cast, mut lacking) = (scene.cast(), 0);
    for nth in 0..40 {
        let draw = scene.start(&mut Seed(7).chain(0).at(nth, Purpose::START));
        let begun = beginning(&scene.motion(&draw).unwrap(), 0.01);
        let most = one.reach(&Probe::until(&begun, &cast, 0.01)).most;
        let lacks = 9_usize.saturating_sub(draw.active());
        assert_eq!(most.log, -(lacks as f64));
        lacking += usize::from(lacks > 0);
    }
    assert!(lacking >= 10, "{lacking}");
}

/// Every kind is in one of the lists.
#[test]
fn no_kind_is_left_out() {
    for name in Require::NAMES {
        let all = OF_A_BALL.iter().chain(OF_DICE).chain(OF_A_WELD).chain(OF_PINS).chain(OF_BINS);
        assert!(all.clone().any(|text| requirement(text).name() == *name), "{name}");
    }
}
