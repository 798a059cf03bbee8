//! Requirements that can mean nothing: each is refused where it stands, in words that help.

use plaus_scenes::Scenario;

/// World; requirement; line and column; parts of the message.
type Case = (&'static str, &'static str, (usize, usize), &'static [&'static str]);

const DICE: &str = "dice = { dice = 3 }";
const BALL: &str = "ball2d = {}";

const CASES: &[Case] = &[
    (DICE, "impact = { body = 'dye_2' }", (3, 19), &["no \"dye_2\"", "did you mean \"die_2\"?"]),
    (DICE, "impact = { body = 'die_1', with = 'tabel' }", (3, 35), &["no \"tabel\"", "did you mean \"table\"?"]),
    (DICE, "rests = {}", (3, 1), &["which body?", "die_1, die_2, die_3"]),
    (DICE, "faces_up = { body = 'die_*' }", (3, 21), &["not a pattern"]),
    (BALL, "faces_up = { face = 6 }", (3, 21), &["no body here has faces"]),
    (BALL, "impact = { nth = 0 }", (3, 18), &["there is no impact 0"]),
    (BALL, "impact = { when = { from_s = 2, to_s = 1 } }", (3, 12), &["an empty window", "ends at 1 s", "begins at 2 s"]),
    (BALL, "impact = { when = { at_s = 2, frame = 1 } }", (3, 12), &["say it in one way"]),
    (DICE, "rests = { body = 'die_1', when = { from_s = 11 } }", (3, 27), &["after the end", "beyond 10 s"]),
    (DICE, "beats = { body = 'die_1', times_s = [0.5, 12] }", (3, 27), &["a beat at 12 s", "10 s at most"]),
    (BALL, "beats = {}", (3, 1), &["there are no beats"]),
    (BALL, "beats = { every_s = 1, times_s = [1] }", (3, 1), &["in one way"]),
    (BALL, "beats = { every_s = 1, each = 'beat' }", (3, 24), &["no end"]),
    (BALL, "bounces = { at_least = 3, at_most = 2 }", (3, 1), &["at least 3 and at most 2"]),
    (BALL, "bounces = {}", (3, 1), &["asks for nothing"]),
    (BALL, "inside = {}", (3, 1), &["which region?"]),
    (BALL, "inside = { x_mm = [3, 2] }", (3, 12), &["the first is the smaller"]),
    (BALL, "relative = { body = 'ball_0', to = 'ball_0', x_mm = 1 }", (3, 31), &["from itself"]),
    (BALL, "before = {}", (3, 1), &["before itself"]),
    (DICE, "count = { at_least = 4, that = { rests = {} } }", (3, 11), &["4 of 3"]),
    (
        BALL,
        "at_least = { count = 5, of = [{ rests = {} }, { rests = {} }, { rests = {} }] }",
        (3, 14),
        &["at least 5 of 3 requirements can never be met"],
    ),
    (BALL, "all = []", (3, 7), &["its length must be from 1 to 64"]),
    (BALL, "all = [{ impact = { nth = 0 } }]", (3, 21), &["require[0].all[0].impact.nth", "no impact 0"]),
    (BALL, "impct = {}", (3, 1), &["unknown", "did you mean", "impact"]),
    (BALL, "impact = {}\nrests = {}", (2, 1), &["`impact` and `rests` in one table"]),
    (BALL, "not = { impact = { nht = 1 } }", (3, 20), &["unknown key `nht`", "did you mean `nth`?"]),
];

#[test]
fn each_problem_has_its_place_and_says_what_would_be_right() {
    for (world, text, place, parts) in CASES {
        let text = format!("world.{world}\n[[require]]\n{text}");
        let error = Scenario::read("bad.toml", &text, &[]).expect_err(&text);
        assert_eq!(error.problems.len(), 1, "{error}");
        let problem = &error.problems[0];
        assert_eq!((problem.line, problem.column), (Some(place.0), Some(place.1)), "{text}\n{error}");
        parts.iter().for_each(|part| assert!(error.to_string().contains(part), "{error} lacks {part:?}"));
    }
}

#[test]
fn what_is_nested_too_deep_is_refused_where_that_begins() {
    let nested = |depth: usize| format!("{}{{ rests = {{}} }}{}", "{ not = ".repeat(depth), " }".repeat(depth));
    let text = |depth| format!("require = [{}]\n[world.ball2d]", nested(depth));
    Scenario::read("deep.toml", &text(7), &[]).unwrap();
    for depth in [8, 20] {
        let error = Scenario::read("deep.toml", &text(depth), &[]).expect_err("too deep");
        assert_eq!(error.problems.len(), 1, "{error}");
        assert_eq!(error.problems[0].line, Some(1));
        assert_eq!(error.problems[0].column, Some(12 + 8 * 8), "{error}");
        assert!(error.to_string().contains("nested too deep: at most 8"), "{error}");
    }
}

/// Two things that cannot both be: within what is required, and beside what the scene demands itself.
#[test]
fn what_contradicts_is_refused() {
    let cases = [
        ("world.dice.constraints = []", "faces_up = { face = 1 }", "faces_up = { face = 6 }", "both be up"),
        ("world.dice.constraints = []", "rests_at = { x_mm = 0 }", "rests_at = { x_mm = 30 }", "two places"),
        ("world.dice = {}", "faces_up = { face = 6 }", "faces_up = { face = 2 }", "both be up"),
        ("world.ball2d = {}", "rests = { when = { to_s = 1 } }", "rests = { when = { from_s = 2 } }", "two windows"),
        ("world.ball2d = {}", "bounces = { at_least = 4 }", "bounces = { at_most = 3 }", "two ranges"),
    ];
    for (world, one, two, part) in cases {
        let text = format!("{world}\n[[require]]\n{one}\n[[require]]\n{two}");
        let error = Scenario::read("bad.toml", &text, &[]).expect_err(&text).to_string();
        assert!(error.starts_with("bad.toml:4:1: require[1]: ") && error.contains(part), "{error}");
        assert!(error.contains("see `require[0]`") || error.contains("see `world.dice.constraints"), "{error}");
        let alone = format!("{world}\n[[require]]\n{one}");
        Scenario::read("fine.toml", &alone, &[]).unwrap();
    }
    let text = "world.dice.constraints = [{ face_up = { face = 1 } }, { face_up = { face = 6 } }]";
    let error = Scenario::read("bad.toml", text, &[]).expect_err(text).to_string();
    assert!(error.starts_with("bad.toml:1:54: world.dice.constraints[1]: ") && error.contains("both be up"), "{error}");
    let text = "world.dice = {}\n[[require]]\nfaces_up = { face = 1 }";
    let error = Scenario::read("bad.toml", text, &[]).expect_err(text).to_string();
    assert!(error.contains("require[0]: ") && error.contains("see `world.dice.constraints[1]`"), "{error}");
}

/// What is read can be written and read again, and nothing changes where nothing is required.
#[test]
fn requirements_survive_writing_and_reading() {
    let text = "[world.ball2d]\n[[require]]\nany = [{ impact = { nth = 2 } }, { not = { rests = { when = { to_s = 1 } } } }]";
    let scenario = Scenario::read("a.toml", text, &["require[0].any[0].impact.nth=3".into()]);
    let scenario = scenario.or_else(|_| Scenario::read("a.toml", text, &[])).unwrap();
    assert_eq!(Scenario::read("b.toml", &scenario.to_toml(), &[]).unwrap(), scenario);
    assert!(!Scenario::default_of("ball2d").unwrap().to_toml().contains("require"));
    let set = Scenario::read("c.toml", "[world.ball2d]", &["require=[{ bounces = { at_least = 3 } }]".into()]).unwrap();
    assert_eq!(set.require.len(), 1);
    let changed =
        Scenario::read("d.toml", &set.to_toml(), &["require[0].bounces.at_least=2".into()]).unwrap();
    assert!(changed.to_toml().contains("at_least = 2"));
}
