//! Each kind of requirement, judged on a motion that is written down here: two balls and a die, whose answers can be
//! computed by hand.

use glam::{DQuat, DVec3};
use plaus_scenes::Scenario;
use plaus_scenes::animation::{Contact, Impact, Look, Motion, Piece, Shape, Track, Turn, UPRIGHT, upright};
use plaus_scenes::files::Assets;
use plaus_scenes::require::{Cast, FAR, Probe, Require};
use plaus_scenes::spelling::{Bins, Grid, Letters};
use std::f64::consts::TAU;

const G: f64 = 9.806_65;

/// Ball `a` rises at 2 m/s from the origin and goes along x at 1 m/s. It is back at 0.408 s, and rests there, lying on
/// its side. Ball `b` stands upright at (1, 0, 0) m. The die `die_1` lies at (0, 0.5, 0) m; it turns at first, and has
/// its 5 up from 0.1 s on.
fn motion() -> (Motion, Cast) {
    let fall = DVec3::new(0.0, 0.0, -G);
    let landing = 4.0 / G;
    let a = vec![
        Piece::ballistic(0.0, DVec3::ZERO, upright(DVec3::new(1.0, 0.0, 2.0)), upright(fall)),
        Piece::resting(landing, upright(DVec3::X * landing)),
    ];
    // The 5 lies along −y: a quarter turn about x brings it up.
    let five_up = UPRIGHT * DQuat::from_rotation_x(-std::f64::consts::FRAC_PI_2);
    let turning = Turn { orientation: UPRIGHT, spin: DVec3::X * 3.0, own: 0.0 };
    let place = upright(DVec3::Y * 0.5);
    let die =
        vec![Piece::resting(0.0, place).turning(turning), Piece::resting(0.1, place).turning(Turn::still(five_up))];
    let track = |name: &str, shape, pieces| Track::new(name, shape, Look::nth(0), pieces);
    let tracks = vec![
        track("a", Shape::ball(0.1), a),
        track("b", Shape::ball(0.2), vec![Piece::resting(0.0, upright(DVec3::X)).turning(Turn::still(UPRIGHT))]),
        track("die_1", Shape::die(0.016), die),
    ];
    let hit = |time, body: &str, other: &str, speed, impulse| {
        Impact::new(time, body, other, DVec3::ZERO, DVec3::Y).with_strength(speed, impulse)
    };
    let impacts = vec![hit(0.1, "die_1", "floor", 0.5, 0.01), hit(landing, "a", "floor", 2.0, 0.3)];
    let contact = Contact {
        start: 0.1,
        end: 0.2,
        body: "die_1".into(),
        other: "rail".into(),
        point: DVec3::ZERO,
        normal: DVec3::ZERO,
        slip: 0.1,
        roll: 0.0,
        force: 1.0,
    };
    let cast = Cast {
        bodies: ["a", "b", "die_1"].map(String::from).to_vec(),
        fixed: ["floor", "rail"].map(String::from).to_vec(),
        longest: 10.0,
        faces: true,
        ..Cast::default()
    };
    (Motion::new(1.0, tracks, impacts).with_contacts(vec![contact]), cast)
}

#[test]
fn times_that_are_asked_for_have_words() {
    let landing = 4.0 / G;
    type Said<'a> = [(&'a str, Option<f64>)];
    let cases: &[(&str, &Said<'_>)] = &[
        ("impact = { body = 'a', with = 'floor' }", &[("first impact of a with floor", Some(landing))]),
        ("impact = { body = 'a', nth = 2 }", &[("impact 2 of a", None)]),
        ("impact = { body = '*', nth = -2 }", &[("last impact but 1 of *", Some(0.1))]),
        ("rests = { body = 'a' }", &[("rest of a", Some(landing))]),
        (
            "touches = { body = 'die_1', with = 'rail', when = { from_s = 0.15 } }",
            &[("die_1 touches rail", Some(0.15))],
        ),
        (
            "beats = { body = '*', times_s = [0.11, 0.6], each = 'beat' }",
            &[("beat 1", Some(0.1)), ("beat 2", Some(landing))],
        ),
        ("beats = { body = 'die_*', nth = -1, every_s = 0.09, each = 'body' }", &[("last impact of die_1", Some(0.1))]),
        (
            "count = { of = '*', at_least = 1, that = { impact = {} } }",
            &[("first impact of a", Some(landing)), ("first impact of b", None), ("first impact of die_1", Some(0.1))],
        ),
        ("not = { impact = { body = 'a' } }", &[]),
        ("named = { name = 'it lands', that = { impact = { body = 'a' } } }", &[("it lands", Some(landing))]),
        (
            "named = { name = 'in time', that = { beats = { body = '*', times_s = [0.11, 0.6], each = 'beat' } } }",
            &[("in time: beat 1", Some(0.1)), ("in time: beat 2", Some(landing))],
        ),
        ("bounces = { body = '*', at_least = 2 }", &[("impact 2 of *", Some(landing))]),
        ("bounces = { body = '*', at_least = 2, when = { to_s = 0.3 } }", &[("impact 2 of *", None)]),
        ("bounces = { body = '*', at_most = 2 }", &[]),
        (
            "before = { first = { body = 'die_1' }, then = { body = 'a' } }",
            &[("first impact of die_1", Some(0.1)), ("first impact of a", Some(landing))],
        ),
        (
            "order = { bodies = ['die_1', 'b'], each = { what = 'fall' } }",
            &[("fall of die_1", Some(0.1)), ("fall of b", None)],
        ),
        ("speed = { body = 'a', at_least = 1 }", &[("first impact of a", Some(landing))]),
        ("rests_at = { body = 'a' }", &[("rest of a", Some(landing))]),
        ("rests_on = { body = 'a', on = 'floor' }", &[("rest of a", Some(landing))]),
        ("inside = { body = 'a', x_mm = [125, 900], how = 'sometimes' }", &[("a inside", Some(0.125))]),
        ("inside = { body = 'a', x_mm = [125, 900], how = 'always' }", &[]),
        ("inside = { body = 'b', x_mm = [125, 900], how = 'sometimes' }", &[("b inside", None)]),
        ("passes = { body = 'b', x_mm = 1000 }", &[("b passes (1000, 0, 0)", Some(0.0))]),
    ];
    let (motion, cast) = motion();
    for (text, wanted) in cases {
        let require: Require = toml::from_str(text).unwrap();
        let times = require.times(&Probe::whole(&motion, &cast));
        let said: Vec<(&str, Option<f64>)> = times.iter().map(|at| (at.what.as_str(), at.found)).collect();
        // The beginning of being inside is found to a microsecond.
        let close = |a: Option<f64>, b: Option<f64>| match (a, b) {
            (Some(a), Some(b)) => (a - b).abs() < 2e-6,
            (a, b) => a == b,
        };
        let alike = said.iter().zip(*wanted).all(|(a, b)| a.0 == b.0 && close(a.1, b.1));
        assert!(said.len() == wanted.len() && alike, "{text}: {said:?}");
    }
}

/// The margin of the whole motion is the one that is wanted.
fn judged(cases: &[(&str, f64)]) {
    let (motion, cast) = motion();
    for (text, wanted) in cases {
        let one: Require = toml::from_str(text).unwrap_or_else(|error| panic!("{text}: {error}"));
        let found = one.reach(&Probe::whole(&motion, &cast)).most.margin;
        assert!((found - wanted).abs() < 2e-3 * (1.0 + wanted.abs().min(1.0)), "{text}: {found}, not {wanted}");
    }
}

#[test]
fn margins_are_those_computed_by_hand() {
    let landing = 4.0 / G;
    let top = 2.0 * 2.0 / (2.0 * G);
    // Speed along the parabola: ∫ √(1 + (2 − g t)²) dt over the flight, by its antiderivative.
    let arc = |u: f64| 0.5 * (u * (1.0 + u * u).sqrt() + (u + (1.0 + u * u).sqrt()).ln());
    let way = (arc(2.0) - arc(-2.0)) / G;
    judged(&[
        ("impact = { body = 'a', when = { at_s = 0.4, within_ms = 20, scale_ms = 10 } }", (0.42 - landing) / 0.01),
        ("impact = { body = 'a', with = 'b' }", -FAR),
        ("impact = { body = '*', nth = -1, when = { to_s = 0.5, scale_ms = 10 } }", (0.5 - landing) / 0.01),
        ("impact = { body = '*', nth = 2, faster_than = 1.0 }", -FAR),
        ("rests = { body = 'a', when = { from_s = 0.5, scale_ms = 10 } }", (landing - 0.5) / 0.01),
        ("rests = { body = '*', when = { to_s = 1, scale_ms = 100 } }", (1.0 - landing) / 0.1),
        ("bounces = { body = 'a', at_least = 2 }", -1.0),
        ("bounces = { body = '*', at_most = 1, nats_each = 3 }", -1.5),
        ("bounces = { body = '*', at_least = 1, when = { to_s = 0.3 } }", 1.0),
        ("faces_up = { body = 'die_1', face = 5 }", 2.0),
        ("faces_up = { body = 'die_1', face = 1 }", -7.0),
        ("faces_up = { body = 'die_1', axis = 'minus_y' }", 2.0),
        (
            "faces_up = { body = 'die_1', axis = 'z', scale_deg = 1, when = { at_s = 0.05 } }",
            20.0 - 0.15_f64.to_degrees(),
        ),
        // One die shows five.
        ("sum = { of = 'die_*', at_least = 5, at_most = 5 }", 0.5),
        ("sum = { of = 'die_*', at_least = 7, nats_each = 2 }", -3.0),
        ("stands = { body = 'die_1' }", -4.5),
        ("rests_at = { body = 'a', x_mm = 400, within_mm = 10, scale_mm = 1 }", 10.0 - (1e3 * landing - 400.0)),
        ("rests_at = { body = 'die_1', y_mm = 480, z_mm = 0, scale_mm = 5 }", -2.0),
        ("rests_on = { body = 'die_1', on = 'rail' }", 2.0),
        ("rests_on = { body = 'a', on = 'rail' }", -2.0),
        ("inside = { body = 'a', z_mm = [100, 300], how = 'sometimes', scale_mm = 1 }", 100.0),
        ("inside = { body = 'a', z_mm = [-10, 200], how = 'always', scale_mm = 1 }", 200.0 - 1e3 * top),
        ("inside = { body = 'a', z_mm = [100, 300], how = 'never', scale_mm = 1 }", -100.0),
        ("inside = { body = 'a', x_mm = [0, 100], scale_mm = 1 }", 100.0 - 1e3 * landing),
        ("inside = { body = 'b', centre_mm = [1000, 30, 40], radius_mm = 60, how = 'always', scale_mm = 1 }", 10.0),
        ("passes = { body = 'a', x_mm = 203.944, z_mm = 213.944, within_mm = 5, scale_mm = 1 }", -5.0),
        ("touches = { body = 'a', with = 'floor' }", 2.0),
        ("touches = { body = 'die_1', with = 'rail', when = { from_s = 0.15, to_s = 0.16 } }", 2.0),
        // The centres come to within 1 − 0.408 m of each other at the end; the radii are subtracted.
        ("touches = { body = 'a', with = 'b', scale_mm = 1 }", -2.0 - 1e3 * (1.0 - landing - 0.3)),
        ("not = { touches = { body = 'a', with = 'floor' } }", -2.0),
        (
            "before = { first = { body = 'die_1' }, then = { body = 'a' }, by_ms = 300, scale_ms = 1 }",
            1e3 * (landing - 0.1) - 300.0,
        ),
        ("before = { first = { body = 'b' }, then = { body = 'a' } }", -FAR),
        ("before = { first = { body = 'a' }, then = { body = 'b' } }", FAR),
        (
            "apart = { one = { body = 'a' }, other = { body = 'die_1' }, at_most_ms = 300, scale_ms = 1 }",
            300.0 - 1e3 * (landing - 0.1),
        ),
        ("apart = { one = { body = 'a' }, other = { body = 'b' }, at_most_ms = 300 }", -FAR),
        ("beats = { body = 'a', every_s = 0.4, within_ms = 20, scale_ms = 1 }", 20.0 - 1e3 * (landing - 0.4)),
        (
            "beats = { body = '*', each = 'impact', every_s = 0.1, within_ms = 20, scale_ms = 1 }",
            20.0 - 1e3 * (landing - 0.4),
        ),
        ("beats = { body = '*', each = 'beat', times_s = [0.1, 0.2], within_ms = 20, scale_ms = 1 }", -80.0),
        ("speed = { body = 'a', at_least = 2, scale = 1 }", 5.0_f64.sqrt() - 2.0),
        ("speed = { body = 'a', at_most = 0.5, after = true, scale = 1 }", 0.5),
        ("spin = { body = 'die_1', at_least = 2, scale = 1 }", 1.0),
        ("spin = { body = 'die_1', at_most = 1, after = true, scale = 1 }", 1.0),
        ("impulse = { body = 'a', at_most = 0.2, scale = 0.1 }", -5.0),
        ("air_time = { body = 'a', at_least_s = 0.4, scale_ms = 1 }", 1e3 * (landing - 0.4)),
        ("air_time = { body = 'b', at_most_s = 0.1, scale_ms = 100 }", 1.0),
        ("path_length = { body = 'a', at_least_mm = 600, scale_mm = 1 }", 1e3 * way - 600.0),
        ("relative = { body = 'a', to = 'b', x_mm = -600, y_mm = 0, within_mm = 10, scale_mm = 1 }", 2.114),
        ("count = { at_least = 1, that = { stands = {} } }", 4.5),
        ("count = { at_least = 2, that = { stands = {} } }", -4.5),
        ("named = { name = 'none', that = { count = { of = 'b', at_most = 0, that = { stands = {} } } } }", -4.5),
        ("count = { at_most = 1, that = { stands = {} } }", 4.5),
        ("count = { of = 'b', at_most = 0, that = { stands = {} } }", -4.5),
        ("all = [{ touches = { body = 'a', with = 'floor' } }, { stands = { body = 'die_1' } }]", -4.5),
        ("any = [{ touches = { body = 'a', with = 'floor' } }, { stands = { body = 'die_1' } }]", 2.0),
        ("at_least = { count = 1, of = [{ stands = { body = 'die_1' } }, { stands = { body = 'b' } }] }", 4.5),
    ]);
}

/// The same of directions, turns and falls, and of what is greatest or least in a window of time.
#[test]
fn margins_of_turns_and_of_windows_are_those_computed_by_hand() {
    let (landing, top) = (4.0 / G, 2.0 * 2.0 / (2.0 * G));
    // When a body that turns by 3 rad/s leans by 6°.
    let six = 6.0_f64.to_radians() / 3.0;
    judged(&[
        ("points = { body = 'die_1', face = 1, toward = [0, 2, 0] }", 2.0),
        ("points = { body = 'die_1', axis = 'minus_z', toward = [0, -1, 1] }", -2.5),
        ("points = { body = 'b', toward = [0, 0, -3] }", -7.0),
        ("orientation = { body = 'die_1', turn_deg = [270, 0, 0] }", 2.0),
        ("orientation = { body = 'die_1', turn_deg = [-80, 0, 0], within_deg = 4, scale_deg = 1 }", -6.0),
        ("orientation = { body = 'b', turn_deg = [0, 90, 90] }", -10.0),
        ("falls = { body = 'die_1', when = { to_s = 0.3, scale_ms = 10 } }", 20.0),
        ("falls = { body = 'die_1', fallen_deg = 6, when = { to_s = 0.05, scale_ms = 1 } }", 50.0 - 1e3 * six),
        ("falls = { body = '*' }", -FAR),
        ("order = { bodies = ['die_1', 'a'], by_ms = 300, scale_ms = 1 }", 1e3 * (landing - 0.1) - 300.0),
        ("order = { bodies = ['die_*', 'b'], each = { what = 'fall' } }", FAR),
        ("order = { bodies = ['b', 'die_1', 'a'], each = { what = 'rest' }, scale_ms = 1 }", 100.0),
        ("order = { bodies = ['a', 'b'], each = { what = 'rest' }, scale_ms = 1 }", -1e3 * landing),
        ("speed = { body = 'a', at_least = 2, scale = 1, when = { from_s = 0 } }", 5.0_f64.sqrt() - 2.0),
        ("speed = { body = 'a', at_least = 2, which = 'least', scale = 1, when = { to_s = 0.4 } }", -1.0),
        ("speed = { body = 'a', at_most = 1, scale = 1, when = { at_s = 0.1 } }", 1.0 - 1f64.hypot(2.0 - 0.1 * G)),
        ("speed = { body = 'a', at_most = 1, scale = 1, when = { frame = 60, fps = 30 } }", 1.0),
        ("spin = { body = 'die_1', at_least = 2, scale = 1, when = { at_s = 0.05 } }", 1.0),
        ("spin = { body = 'die_1', at_least = 2, which = 'least', scale = 1, when = { from_s = 0 } }", -2.0),
        ("height = { body = 'a', at_least_mm = 200, scale_mm = 1 }", 1e3 * top - 200.0),
        ("height = { body = 'a', at_most_mm = 100, scale_mm = 1, when = { at_s = 0.1 } }", 5.0 * G - 100.0),
        ("height = { body = 'a', at_least_mm = 10, which = 'least', scale_mm = 1 }", -10.0),
        ("turns = { body = 'die_1', at_least = 0.04, scale = 0.001 }", 300.0 / TAU - 40.0),
        ("turns = { body = 'die_1', at_most = 0, about = [-4, 3, 0], scale = 0.001 }", 240.0 / TAU),
        ("turns = { body = 'die_1', at_most = 0, when = { from_s = 0.05, to_s = 0.06 }, scale = 0.001 }", -30.0 / TAU),
    ]);
}

/// Four pins, 38 cm high, and three balls over a box of bins. Pin 1 stays where it is. Pin 2 falls onto its side at
/// 0.5 s. Pin 3 is pushed 30 mm away and stands. Pin 4 sinks by 20 mm, upright, and rises again. Ball 0 rests in the
/// bin of row 0, column 0, ball 1 in that of row 1, column 0, and ball 2 on top of a partition.
fn alley_and_bins() -> (Motion, Cast) {
    let shape = Shape::Revolution { profile: vec![[0.02, -0.15], [0.05, 0.0], [0.01, 0.23]], stripes: Vec::new() };
    let pin = |number: u32, moves: &[(f64, DVec3, DQuat)]| {
        let moves = moves
            .iter()
            .map(|&(time, place, turn)| Piece::resting(time, upright(place)).turning(Turn::still(UPRIGHT * turn)));
        Track::new(format!("pin_{number}"), shape.clone(), Look::nth(0), moves.collect())
    };
    let (up, here) = (DQuat::IDENTITY, DVec3::Z * 0.15);
    let mut tracks = vec![
        pin(1, &[(0.0, here, up)]),
        pin(2, &[(0.0, here, up), (0.5, here, DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2))]),
        pin(3, &[(0.0, here, up), (0.6, here + DVec3::X * 0.03, up)]),
        pin(4, &[(0.0, here, up), (0.3, here - DVec3::Z * 0.02, up), (0.7, here, up)]),
    ];
    let bins = Bins { columns: 1, rows: 2, ..Bins::default() };
    let low = bins.marble + 0.1 * bins.height;
    for (ball, [y, z]) in
        [[1.5 * bins.side, low], [0.5 * bins.side, low], [bins.side, low + bins.height]].iter().enumerate()
    {
        let place = DVec3::new(0.5 * bins.side, *y, *z);
        let piece = Piece::resting(0.0, upright(place));
        tracks.push(Track::new(format!("ball_{ball}"), Shape::ball(bins.marble), Look::nth(0), vec![piece]));
    }
    let bodies = tracks.iter().map(|track| track.name.clone()).collect();
    let bins = Some(Grid { bins, letters: Letters::default() });
    (Motion::new(1.0, tracks, Vec::new()), Cast { bodies, bins, ..Cast::default() })
}

/// Margins and costs of pins and bins: half a thing beyond for the margin, and a pin that should stand and falls costs
/// twice.
#[test]
fn margins_of_pins_and_bins_are_those_computed_by_hand() {
    let (motion, cast) = alley_and_bins();
    for (text, margin, log) in [
        ("leaves = { pins = [1, 3], moved_far_mm = 31, nats_each = 2 }", 1.0, 0.0),
        ("leaves = { pins = [1, 3], moved_far_mm = 29, nats_each = 2 }", -1.0, -2.0),
        ("leaves = { pins = [1], nats_each = 2 }", -1.0, -2.0),
        ("leaves = { pins = [1, 2, 3], moved_far_mm = 31, nats_each = 2 }", -1.0, -4.0),
        ("leaves = { pins = [2, 4], nats_each = 1 }", -3.5, -6.0),
        ("leaves = { nats_each = 1 }", -1.5, -2.0),
        ("leaves = { pins = [1, 2, 3], moved_far_mm = 31, within_deg = 91, nats_each = 2 }", 1.0, 0.0),
        ("spells = { bitmap = \"#\\n#\", nats_each = 3 }", 1.5, 0.0),
        ("spells = { bitmap = '#', nats_each = 3 }", 1.5, 0.0),
        ("not = { spells = { bitmap = '#', nats_each = 3 } }", -1.5, -1.5),
        ("not = { leaves = { pins = [1], nats_each = 2 } }", 1.0, 0.0),
    ] {
        let one: Require = toml::from_str(text).unwrap_or_else(|error| panic!("{text}: {error}"));
        let found = one.reach(&Probe::whole(&motion, &cast)).most;
        assert!((found.margin - margin).abs() < 1e-12 && (found.log - log).abs() < 1e-12, "{text}: {found:?}");
    }
    // The same requirement in a box of another size.
    let one: Require = toml::from_str("spells = { bitmap = \"#\\n#\", nats_each = 3 }").unwrap();
    let wide =
        Cast { bins: cast.bins.map(|grid| Grid { bins: Bins { columns: 3, ..grid.bins }, ..grid }), ..cast.clone() };
    for (cast, margin) in [(&cast, 1.5), (&wide, -4.5), (&cast, 1.5)] {
        assert_eq!(one.reach(&Probe::whole(&motion, cast)).most.margin, margin);
    }
}

/// The cost of several requirements together: the sum for all of them, the least for any of them.
#[test]
fn costs_of_several_add_up() {
    let (motion, cast) = motion();
    let log = |text: &str| {
        let one: Require = toml::from_str(text).unwrap();
        one.reach(&Probe::whole(&motion, &cast)).most.log
    };
    let parts = "[{ stands = { body = 'die_1' } }, { bounces = { body = 'a', at_least = 2 } }]";
    assert!((log(&format!("all = {parts}")) + 5.5).abs() < 1e-12);
    assert!((log(&format!("any = {parts}")) + 1.0).abs() < 1e-12);
    let beats = log("beats = { body = '*', each = 'beat', times_s = [0.1, 0.2, 0.5], within_ms = 20, scale_ms = 10 }");
    assert!((beats - (-8.0 - (92.112 - 20.0) / 10.0)).abs() < 1e-3, "{beats}");
}

/// Beats from a file become a list in the effective scenario, which then no longer needs the file.
#[test]
fn beats_are_read_from_files() {
    let mut files = Assets::default();
    files.insert("drums/hits.csv", b"time,drum\n0.75,snare\n0.25,bass\n".to_vec());
    let text = |beats: &str| format!("[world.ball2d]\n[[require]]\nall = [{{ beats = {{ {beats} }} }}]\n");
    let read = |beats: &str| Scenario::read_with("inline", &text(beats), &[], &files).map_err(|e| e.to_string());
    let scenario = read("times_from = { file = 'drums/hits.csv' }, each = 'beat'").unwrap();
    assert_eq!(scenario, read("times_s = [0.25, 0.75], each = 'beat'").unwrap());
    assert_eq!(Scenario::read("inline", &scenario.to_toml(), &[]).unwrap(), scenario);
    for (beats, wrong) in [
        ("times_from = { file = 'hits.csv' }", "require[0].all[0].beats.times_from.file: hits.csv: it is not among"),
        ("times_from = { file = '../hits.csv' }", "it lies outside the scenario's folder"),
        (
            "times_from = { file = 'drums/hits.csv', column = 'beat' }",
            "it has no column \"beat\"; there are time, drum",
        ),
        ("times_from = { file = 'drums/hits.csv', note = 36 }", "a table has no notes"),
        ("times_from = { file = 'drums/hits.csv' }, every_s = 0.5", "give the beats in one way"),
        ("times_from = { file = 'drums/hits.csv', colum = 'time' }", "did you mean"),
    ] {
        let error = read(beats).unwrap_err();
        assert!(error.contains(wrong), "{beats}: {error}");
    }
}
