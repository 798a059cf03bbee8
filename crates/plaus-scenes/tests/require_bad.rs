//! Requirements that cannot mean anything: each is refused at its place, in words that help.

use plaus_scenes::Scenario;

/// World; requirement; the text at the place that is blamed; parts of the message.
type Case = (&'static str, &'static str, &'static str, &'static [&'static str]);

const DICE: &str = "dice = { dice = 3 }";
const BALL: &str = "ball2d = {}";

const PINS: &str = "bowling = { constrained = false, pins = [1, 2, 6] }";
const BINS: &str = "spelling = { constrained = false, text = 'I' }";

const CASES: &[Case] = &[
    (PINS, "leaves = { pins = [7] }", "[7]", &["no \"pin_7\"", "pin_1, pin_2, pin_6"]),
    (PINS, "leaves = { pins = [6, 6] }", "[6", &["pin 6 is named twice"]),
    (PINS, "leave = [6]", "leave", &["unknown", "did you mean `leaves`?"]),
    (PINS, "all = [{ leaves = { pins = [6] } }, { leaves = {} }]", "[", &["pin 6 cannot both stand and fall"]),
    (DICE, "leaves = {}", "leaves", &["there are no pins here"]),
    (DICE, "face_up = { face = 6 }", "face_up", &["unknown", "did you mean `faces_up`?"]),
    (DICE, "rest_at = { x_mm = 6 }", "rest_at", &["unknown", "did you mean `rests_at`?"]),
    (DICE, "spells = { text = 'I' }", "spells", &["no bins"]),
    (BINS, "spells = { text = 'HI' }", "'HI'", &["takes 5 × 3 bins", "has 3 × 5"]),
    (BINS, "spells = { text = 'ß' }", "'ß'", &["the font lacks 'ß'"]),
    (BINS, "spells = {}", "spells", &["no bin to fill"]),
    (BINS, "spells = { text = 'I', bitmap = '#' }", "'I'", &["there is a `bitmap` too"]),
    (BINS, "spells = { bitmap = \"##\\n##\" }", "\"##", &["3 balls cannot fill 4 bins"]),
    (DICE, "impact = { body = 'dye_2' }", "'dye_2'", &["no \"dye_2\"", "did you mean \"die_2\"?"]),
    (DICE, "impact = { body = 'die_1', with = 'tabel' }", "'tabel'", &["no \"tabel\"", "did you mean \"table\"?"]),
    (DICE, "rests = {}", "rests", &["name a body", "die_1, die_2, die_3"]),
    (DICE, "faces_up = { body = 'die_*' }", "'die_*'", &["not a pattern"]),
    (BALL, "faces_up = { face = 6 }", "6", &["no body here has faces"]),
    (BALL, "spin = { at_least = 1 }", "spin", &["without an orientation"]),
    (BALL, "impact = { nth = 0 }", "0", &["there is no impact 0"]),
    (
        BALL,
        "impact = { when = { from_s = 2, to_s = 1 } }",
        "when",
        &["an empty window", "ends at 1 s", "begins at 2 s"],
    ),
    (BALL, "impact = { when = { at_s = 2, frame = 1 } }", "when", &["give the time in one way"]),
    (DICE, "rests = { body = 'die_1', when = { from_s = 11 } }", "when", &["but every motion ends by 10 s"]),
    (DICE, "beats = { body = 'die_1', times_s = [0.5, 12] }", "[0.5", &["a beat at 12 s", "10 s at most"]),
    (BALL, "beats = {}", "beats", &["there are no beats"]),
    (BALL, "beats = { every_s = 1, times_s = [1] }", "beats", &["in one way"]),
    (BALL, "beats = { every_s = 1, each = 'beat' }", "'beat'", &["never end"]),
    (BALL, "bounces = { at_least = 3, at_most = 2 }", "bounces", &["at least 3 and at most 2"]),
    (BALL, "bounces = {}", "bounces", &["asks for nothing"]),
    (BALL, "inside = {}", "inside", &["which region?"]),
    (BALL, "inside = { x_mm = [3, 2] }", "[3", &["the first number is the smaller"]),
    (BALL, "relative = { body = 'ball_0', to = 'ball_0', x_mm = 1 }", "'ball_0', x_mm", &["the same body"]),
    (BALL, "before = {}", "before", &["before itself"]),
    (BALL, "apart = { at_most_ms = 20 }", "apart", &["an event and itself"]),
    (BALL, "apart = { one = { nth = 2 } }", "apart", &["asks for nothing"]),
    (DICE, "count = { at_least = 4, that = { rests = {} } }", "4", &["only 3 bodies"]),
    (
        BALL,
        "at_least = { count = 5, of = [{ rests = {} }, { rests = {} }, { rests = {} }] }",
        "5",
        &["at least 5 of 3 requirements can never be met"],
    ),
    (BALL, "named = { name = ' ', that = { rests = {} } }", "' '", &["a name has 1 to 60 characters"]),
    (BALL, "named = { name = 'a', that = { impact = { nth = 0 } } }", "0", &["require[0].named.that.impact.nth"]),
    (DICE, "points = { body = 'die_1', toward = [0, 0, 0] }", "[0", &["toward: a direction", "not all of them 0"]),
    (DICE, "turns = { body = 'die_1', about = [0, 0, 0], at_most = 1 }", "[0", &["about: a direction"]),
    (DICE, "turns = { body = 'die_1' }", "turns", &["asks for nothing"]),
    (DICE, "points = { body = 'die_1', axis = 'z' }", "points", &["180° apart, cannot point in directions 90° apart"]),
    (
        DICE,
        "orientation = { body = 'die_1', turn_deg = [90, 0, 0] }",
        "orientation",
        &["two sides of die_1, 90° apart"],
    ),
    (DICE, "order = { bodies = ['die_1'] }", "['die_1'", &["takes two bodies"]),
    (DICE, "order = { bodies = ['die_*', 'die_2'] }", "['die_*'", &["die_2 is there twice"]),
    (DICE, "order = { bodies = ['die_1', 'dye_2'] }", "'dye_2'", &["did you mean \"die_2\"?"]),
    (DICE, "order = { bodies = ['die_*'], each = { body = 'die_1' } }", "'die_1'", &["leave this out"]),
    (BALL, "falls = {}", "falls", &["without an orientation"]),
    (BALL, "height = {}", "height", &["asks for nothing"]),
    (BALL, "speed = { at_most = 1, which = 'least' }", "'least'", &["of which window?"]),
    (BALL, "speed = { at_most = 1, nth = 2, when = { at_s = 1 } }", "when", &["at a time, or at an impact?"]),
    (DICE, "spin = { body = 'die_*', at_most = 1, when = { at_s = 1 } }", "'die_*'", &["not a pattern"]),
    (BALL, "all = []", "[]", &["its length must be from 1 to 64"]),
    (BALL, "all = [{ impact = { nth = 0 } }]", "0", &["require[0].all[0].impact.nth", "no impact 0"]),
    (BALL, "impct = {}", "impct", &["unknown", "did you mean", "impact"]),
    (BALL, "impact = {}\nrests = {}", "[[", &["`impact` and `rests` in one table"]),
    (BALL, "not = { impact = { nht = 1 } }", "nht", &["unknown key `nht`", "did you mean `nth`?"]),
];

#[test]
fn each_problem_has_its_place_and_says_what_would_be_right() {
    for (world, text, place, parts) in CASES {
        let text = format!("world.{world}\n[[require]]\n{text}");
        let error = Scenario::read("bad.toml", &text, &[]).expect_err(&text);
        assert_eq!(error.problems.len(), 1, "{error}");
        let problem = &error.problems[0];
        let (line, column) = (problem.line.unwrap(), problem.column.unwrap());
        let there: String = text.lines().nth(line - 1).unwrap().chars().skip(column - 1).collect();
        assert!(there.starts_with(place), "{text}\n{error}");
        parts.iter().for_each(|part| assert!(error.to_string().contains(part), "{error} lacks {part:?}"));
    }
}

#[test]
fn requirements_nested_too_deeply_are_refused_where_the_excess_begins() {
    let nested = |depth: usize| format!("{}{{ rests = {{}} }}{}", "{ not = ".repeat(depth), " }".repeat(depth));
    let text = |depth| format!("require = [{}]\n[world.ball2d]", nested(depth));
    Scenario::read("deep.toml", &text(7), &[]).unwrap();
    for depth in [8, 20] {
        let error = Scenario::read("deep.toml", &text(depth), &[]).expect_err("too deep");
        assert_eq!(error.problems.len(), 1, "{error}");
        assert_eq!(error.problems[0].line, Some(1));
        assert_eq!(error.problems[0].column, Some(12 + 8 * 8), "{error}");
        assert!(error.to_string().contains("nested too deeply: at most 8"), "{error}");
    }
}

/// Two things that cannot both hold: among the requirements, and between a requirement and the scene's own constraints.
#[test]
fn contradictions_are_refused() {
    let cases = [
        ("world.dice.constraints = []", "faces_up = { face = 1 }", "faces_up = { face = 6 }", "both be up"),
        ("world.dice.constraints = []", "rests_at = { x_mm = 0 }", "rests_at = { x_mm = 30 }", "two places"),
        ("world.dice = {}", "faces_up = { face = 6 }", "faces_up = { face = 2 }", "both be up"),
        ("world.ball2d = {}", "rests_at = { x_mm = 100 }", "rests_at = { x_mm = 300 }", "two places"),
        ("world.ball2d = {}", "rests = { when = { to_s = 1 } }", "rests = { when = { from_s = 2 } }", "two windows"),
        ("world.ball2d = {}", "bounces = { at_least = 4 }", "bounces = { at_most = 3 }", "two ranges"),
    ];
    for (world, one, two, part) in cases {
        let text = format!("{world}\n[[require]]\n{one}\n[[require]]\n{two}");
        let error = Scenario::read("bad.toml", &text, &[]).expect_err(&text).to_string();
        assert!(error.starts_with("bad.toml:5:1: require[1].") && error.contains(part), "{error}");
        assert!(error.contains(": see `require[0].") || error.contains(": see `world."), "{error}");
        let alone = format!("{world}\n[[require]]\n{one}");
        Scenario::read("fine.toml", &alone, &[]).unwrap();
    }
    let text = "world.dice.constraints = [{ face_up = { face = 1 } }, { face_up = { face = 6 } }]";
    let error = Scenario::read("bad.toml", text, &[]).expect_err(text).to_string();
    assert!(error.contains(": world.dice.constraints[1].face_up: ") && error.contains("both be up"), "{error}");
    assert!(error.starts_with(&format!("bad.toml:1:{}:", 1 + text.rfind("face_up").unwrap())), "{error}");
    let text = "world.dice = {}\n[[require]]\nfaces_up = { face = 1 }";
    let error = Scenario::read("bad.toml", text, &[]).expect_err(text).to_string();
    assert!(
        error.starts_with("bad.toml:3:1: require[0].faces_up: ")
            && error.contains("see `world.dice.constraints[1].face_up`"),
        "{error}"
    );
}

/// A scenario that was read can be written and read again. A scenario without requirements is written without them.
#[test]
fn requirements_survive_writing_and_reading() {
    let text =
        "[world.ball2d]\n[[require]]\nany = [{ impact = { nth = 2 } }, { not = { rests = { when = { to_s = 1 } } } }]";
    let scenario = Scenario::read("a.toml", text, &["require[0].any[0].impact.nth=3".into()]);
    let scenario = scenario.or_else(|_| Scenario::read("a.toml", text, &[])).unwrap();
    assert_eq!(Scenario::read("b.toml", &scenario.to_toml(), &[]).unwrap(), scenario);
    assert!(!Scenario::default_of("ball2d").unwrap().to_toml().contains("require"));
    let set = Scenario::read("c.toml", "[world.ball2d]", &["require=[{ bounces = { at_least = 3 } }]".into()]).unwrap();
    assert_eq!(set.require.len(), 1);
    let changed = Scenario::read("d.toml", &set.to_toml(), &["require[0].bounces.at_least=2".into()]).unwrap();
    assert!(changed.to_toml().contains("at_least = 2"));
}
