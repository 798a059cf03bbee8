//! Impacts as strong as the notes of a piece: balls that are dropped from such heights, and have such masses, that the
//! closed form m √(2 g h) (1 + e) of their impulses gives the notes' velocities.

use crate::require_bounds::requirement;
use plaus_dist::{Purpose, Seed, Stream};
use plaus_mcmc::Target;
use plaus_scenes::animation::{Impact, Look, Motion, Piece, Shape, Track};
use plaus_scenes::files::Assets;
use plaus_scenes::require::{Cast, Probe};
use plaus_scenes::{Scenario, Scene};
use rand::RngExt;
use rand::seq::SliceRandom;

const G: f64 = 9.806_65;
const RESTITUTION: f64 = 0.5;
const DENSITY: f64 = 1000.0;

/// A note: ticks of 1/960 s from the start, and its velocity.
type Note = (u32, u8);

/// Notes at different times with different velocities.
fn notes(stream: &mut Stream) -> Vec<Note> {
    let mut at = 150;
    let mut velocities: Vec<u8> = (1..=9).map(|k| 14 * k).collect();
    velocities.shuffle(stream);
    let mut next = |velocity| {
        at += stream.random_range(40..90);
        (at, velocity)
    };
    velocities.into_iter().take(6).map(&mut next).collect()
}

/// A piece of 480 ticks a quarter, at 120 quarters a minute.
fn piece(notes: &[Note]) -> Vec<u8> {
    let mut track = Vec::new();
    let mut last = 0;
    for (at, velocity) in notes {
        let after = at - last;
        let delta = if after < 128 { vec![after as u8] } else { vec![0x80 | (after >> 7) as u8, (after & 127) as u8] };
        track.extend(delta.into_iter().chain([0x99, 36, *velocity]));
        last = *at;
    }
    track.extend([0, 0xff, 0x2f, 0]);
    let mut file = b"MThd\0\0\0\x06\0\0\0\x01\x01\xe0MTrk".to_vec();
    file.extend((track.len() as u32).to_be_bytes());
    file.extend(track);
    file
}

/// A ball for each note, that hits the floor at its time with an impulse of so many N s for its velocity.
fn world(notes: &[Note], unit: f64, strength: &str) -> String {
    let mut text = format!(
        "[world.custom]\nduration_s = 1.5\ngravity = {G}\n[[world.custom.materials]]\nname = 'm'\n\
         density = {DENSITY}\nfriction = 0.1\nrestitution = {RESTITUTION}\n"
    );
    for (k, (at, velocity)) in notes.iter().enumerate() {
        let time = f64::from(*at) / 960.0;
        let mass = unit * f64::from(*velocity) / (G * time * (1.0 + RESTITUTION));
        let radius = (0.75 * mass / (DENSITY * std::f64::consts::PI)).cbrt();
        text += &format!(
            "[[world.custom.bodies]]\nname = 'ball_{k}'\nmaterial = 'm'\nshape = {{ ball = {{ radius_mm = {} }} }}\n\
             at_mm = [{}, 0, {}]\n",
            1e3 * radius,
            300 * k,
            1e3 * (radius + 0.5 * G * time * time)
        );
    }
    text + &format!(
        "[[world.custom.fixed]]\nname = 'floor'\nshape = {{ plane = {{}} }}\nmaterial = 'm'\n[[require]]\n\
         beats = {{ body = 'ball_*', with = 'floor', times_from = {{ file = 'song.mid', note = 36 }}, within_ms = 1, \
         strength = {{ {strength} }} }}\n"
    )
}

/// The margin of balls for `notes`, where the piece has `played`.
fn margin(notes: &[Note], played: &[Note], unit: f64, strength: &str) -> f64 {
    let mut files = Assets::default();
    files.insert("song.mid", piece(played));
    let text = world(notes, unit, strength);
    let scenario = Scenario::read_with("a.toml", &text, &[], &files).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(Scenario::read("b.toml", &scenario.to_toml(), &[]).unwrap(), scenario, "the file is no longer needed");
    let stage = scenario.stage().unwrap();
    let draw = stage.start(&mut Seed(1).chain(0).at(0, Purpose::START));
    stage.judge(&stage.motion(&draw).unwrap(), &[])[0].margin
}

#[test]
fn impulses_are_in_proportion_to_velocities() {
    let mut stream = Seed(9).chain(0).at(0, Purpose::START);
    for _ in 0..8 {
        let (notes, unit) = (notes(&mut stream), stream.random_range(1e-5..1e-3));
        let loudest = unit * f64::from(notes.iter().map(|note| note.1).max().unwrap());
        // Nothing but the rounding of numbers in files and of the motion is off; 0.001 is the least that is allowed.
        for (said, is_met) in [
            ("within = 0.001".to_owned(), true),
            (format!("within = 0.001, loudest_n_s = {loudest}"), true),
            (format!("within = 0.001, loudest_n_s = {}", 1.003 * loudest), false),
            (format!("within = 0.005, loudest_n_s = {}", 1.003 * loudest), true),
            ("within = 0.1, power = 2".to_owned(), false),
        ] {
            assert_eq!(margin(&notes, &notes, unit, &said) >= 0.0, is_met, "{notes:?} {said}");
        }
        // A twin of the piece with its velocities in the opposite order.
        let velocities = notes.iter().rev().map(|note| note.1);
        let reversed: Vec<Note> = notes.iter().map(|note| note.0).zip(velocities).collect();
        assert!(margin(&notes, &reversed, unit, "within = 0.1") < -1.0, "{notes:?}");
    }
}

/// Impacts at 0.1, 0.2 and 0.3 s with impulses 1, 2 and 4 N s.
#[test]
fn strengths_are_those_of_the_nearest_beats() {
    let hit = |(k, impulse): (usize, &f64)| {
        Impact::new(0.1 * (k + 1) as f64, "a", "floor", glam::DVec3::ZERO, glam::DVec3::Y).with_strength(1.0, *impulse)
    };
    let impacts = [1.0, 2.0, 4.0].iter().enumerate().map(hit).collect();
    let track = Track::new("a", Shape::ball(0.1), Look::STONE, vec![Piece::resting(0.0, glam::DVec3::ZERO)]);
    let motion = Motion::new(1.0, vec![track], impacts);
    let cast = Cast { bodies: vec!["a".into()], fixed: vec!["floor".into()], ..Cast::default() };
    let nat = 1.1_f64.ln();
    for (said, margin, log) in [
        ("each = 'beat', times_s = [0.1, 0.2, 0.3], strengths = [10, 20, 40]", 1.0, 0.0),
        ("each = 'impact', times_s = [0.1, 0.2, 0.3], strengths = [10, 20, 40]", 1.0, 0.0),
        ("each = 'beat', times_s = [0.3, 0.1], strengths = [4, 1]", 1.0, 0.0),
        ("each = 'body', nth = 2, times_s = [0.1, 0.2, 0.3], strengths = [10, 20, 40]", 1.0, 0.0),
        // Twice as strong as in proportion: the worst is off by the root of 2, and all the cost is that of one.
        (
            "each = 'beat', times_s = [0.1, 0.2, 0.3], strengths = [20, 20, 40]",
            1.0 - 0.5 * 2_f64.ln() / nat,
            2.0 - 2_f64.ln() / nat,
        ),
        ("each = 'impact', times_s = [0.3], strengths = [7]", 1.0 - 2.0 * 2_f64.ln() / (2.0 * nat), f64::NAN),
    ] {
        let text = format!("beats = {{ {said}, within_ms = 500, scale_ms = 500, strength = {{ within = 0.1 }} }}");
        let mark = requirement(&text).reach(&Probe::whole(&motion, &cast)).most;
        assert!((mark.margin - margin.min(1.0)).abs() < 1e-9, "{said}: {mark:?}");
        assert!(log.is_nan() || (mark.log - log).abs() < 1e-9, "{said}: {mark:?}");
    }
}

#[test]
fn strengths_that_nothing_has_or_asks_for_are_refused() {
    let mut files = Assets::default();
    files.insert("a.csv", b"time,force\n0.25,3\n0.5,4\n".to_vec());
    let read = |said: &str| {
        let text = format!("[world.ball2d]\n[[require]]\nbeats = {{ {said} }}\n");
        let scenario = Scenario::read_with("a.toml", &text, &[], &files).map_err(|error| error.to_string())?;
        scenario.stage().map(|_| scenario).map_err(|error| error.to_string())
    };
    let of_file = read("times_from = { file = 'a.csv', strengths = 'force' }, strength = {}").unwrap();
    assert_eq!(of_file, read("times_s = [0.25, 0.5], strengths = [3, 4], strength = {}").unwrap());
    for (said, wrong) in [
        ("times_s = [0.1], strengths = [1]", "beats.strengths: nothing asks for them: add `strength = {}`"),
        ("times_s = [0.1], strength = {}", "beats.strength: the beats have no strengths"),
        ("times_s = [0.1], strengths = [1, 2], strength = {}", "2 strengths of 1 beats"),
        ("times_s = [0.1], strengths = [0], strength = {}", "numbers above 0"),
        ("every_s = 0.5, strength = {}", "regular beats have no strengths"),
        ("times_from = { file = 'a.csv', strengths = 'force' }", "add `strength = {}` beside `times_from`"),
        ("times_from = { file = 'a.csv' }, strengths = [1], strength = {}", "the file has them"),
        ("times_from = { file = 'a.csv', strengths = 'loud' }, strength = {}", "it has no column \"loud\""),
    ] {
        let error = read(said).unwrap_err();
        assert!(error.contains(wrong), "{said}: {error}");
    }
}
