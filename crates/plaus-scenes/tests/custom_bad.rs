//! Worlds that users describe, described wrongly: each is refused where it stands, in words that help. And what is
//! right is read as it is meant.

use plaus_scenes::scenario::{explain, template};
use plaus_scenes::{Scenario, World};

const BALL: &str =
    "[[world.custom.bodies]]\nname = 'ball'\nshape = { ball = { radius_mm = 30 } }\nat_mm = [0, 0, 100]\n";

/// What comes after a good ball; with what the place begins that is blamed; parts of the message.
const CASES: &[(&str, &str, &[&str])] = &[
    ("velocity_m_s = [{ unifrom = [0, 1] }, 0, 0]", "unifrom", &["bodies[0].velocity_m_s[0]", "uniform"]),
    ("velocity_m_s = [{ normal = [0, -1] }, 0, 0]", "{ normal", &["velocity_m_s[0]", "sd is -1"]),
    ("velocity_m_s = [{ uniform = [2, 1] }, 0, 0]", "{ uniform", &["high is 1", "above low"]),
    ("velocity_m_s = [{ uniform = [2] }, 0, 0]", "[2]", &["a list of 1", "2"]),
    ("velocity_m_s = [{ von_mises = { mean = 0, concentration = 1 } }, 0, 0]", "{ von", &["is a law of angles"]),
    ("velocity_m_s = [{ choice = { of = [1, 1] } }, 0, 0]", "{ choice", &["value is 1", "given once"]),
    ("velocity_m_s = [1e9, 0, 0]", "1e9", &["out of range", "m/s"]),
    ("velocity_m_s = [true, 0, 0]", "true", &["expected a number", "found the boolean true"]),
    ("velocity_m_s = [0, 0]", "[0, 0]", &["its length must be from 3 to 3"]),
    (
        "velocity_m_s = ['pusch', 0, 0]\n[[world.custom.quantities]]\nname = 'push'\nvalue = 1",
        "'pusch'",
        &["no quantity \"pusch\"", "did you mean \"push\"?"],
    ),
    ("velocity = [0, 0, 0]", "velocity", &["unknown key `velocity`", "did you mean `velocity_m_s`?"]),
    ("release_s = { normal = [1, 0.1] }", "release_s", &["-inf to inf", "at least 0", "`truncated`"]),
    ("material = 'rubber'\n[[world.custom.materials]]\nname = 'ruber'", "'rubber'", &["did you mean \"ruber\"?"]),
    ("[[world.custom.materials]]\nname = 'a'\nrestitution = { uniform = [0, 2] }", "restitution", &["from 0 to 1"]),
    ("[[world.custom.materials]]\nname = 'a'\n[[world.custom.materials]]\nname = 'a'", "'a'", &["a second material"]),
    ("[[world.custom.pairs]]\nbetween = ['a', '']", "'a'", &["no material \"a\"", "there are none"]),
    ("[[world.custom.bodies]]\nname = 'ball'\nshape = { ball = { radius_mm = 3 } }", "'ball'", &["already"]),
    ("[[world.custom.bodies]]\nname = 'a b'\nshape = { ball = { radius_mm = 3 } }", "'a b'", &["a name is from 1 to"]),
    ("[[world.custom.bodies]]\nshape = { ball = { radius_mm = 3 } }", "[[", &["bodies[1].name", "missing"]),
    ("[[world.custom.bodies]]\nname = 'b'\nshape = { boll = { radius_mm = 3 } }", "boll", &["ball"]),
    (
        "[[world.custom.bodies]]\nname = 'b'\nshape = { hull = { points_mm = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]] } }",
        "shape",
        &["bodies[1].shape", "one plane"],
    ),
    (
        "[[world.custom.bodies]]\nname = 'b'\nshape = { box = { size_mm = [9, 9, 9], rounding_mm = 5 } }",
        "shape",
        &["bodies[1].shape", "rounding is 0.005"],
    ),
    (
        "[[world.custom.bodies]]\nname = 'b'\nshape = { ball = { radius_mm = 30 } }\nat_mm = [0, 50, 100]",
        "[0, 0, 100]",
        &["bodies[0].at_mm", "begin inside each other", "\"ball\" begins 10.000 mm inside \"b\""],
    ),
    ("colour = 'red'", "'red'", &["no colour", "#c04030"]),
    ("any_turn = true\nturn_deg = [0, 0, 1]", "true", &["leave `turn_deg` out"]),
    ("[[require]]\nrests = { body = 'bal' }", "'bal'", &["no \"bal\"", "did you mean \"ball\"?"]),
    ("[[require]]\ntouches = { body = 'ball', with = 'flor' }", "'flor'", &["did you mean \"floor\"?"]),
];

#[test]
fn each_problem_has_its_place_and_says_what_would_be_right() {
    for (text, place, parts) in CASES {
        let text = format!("{BALL}{text}\n");
        let error = Scenario::read("bad.toml", &text, &[]).expect_err(&text);
        assert_eq!(error.problems.len(), 1, "{error}");
        let problem = &error.problems[0];
        let (Some(line), Some(column)) = (problem.line, problem.column) else { panic!("{error}\n{text}") };
        let there: String = text.lines().nth(line - 1).unwrap().chars().skip(column - 1).collect();
        assert!(there.starts_with(place), "{there}\n{text}\n{error}");
        parts.iter().for_each(|part| assert!(error.to_string().contains(part), "{error} lacks {part:?}"));
    }
}

fn read(text: &str, overrides: &[&str]) -> Scenario {
    let overrides: Vec<String> = overrides.iter().map(|said| (*said).to_owned()).collect();
    Scenario::read("world.toml", text, &overrides).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn overrides_reach_into_lists_and_laws() {
    let scenario = read(
        BALL,
        &[
            "bodies[0].at_mm[2]={ normal = [300, 20] }",
            "bodies[0].shape.ball.radius_mm=25",
            "bodies[0].colour=#102030",
            "duration_s=2",
        ],
    );
    let World::Custom(config) = &scenario.world else { panic!("another world") };
    assert_eq!(config.duration_s, 2.0);
    let text = scenario.to_toml();
    assert!(text.contains("radius_mm = 25.0") && text.contains("#102030") && text.contains("[300.0, 20.0]"), "{text}");
    assert_eq!(read(&text, &[]), scenario, "what is written is read as it was");
    let pair = format!("[[world.custom.pairs]]\nbetween = ['', '']\nrestitution = {{ uniform = [0.1, 0.2] }}\n{BALL}");
    let scenario = read(&pair, &[]);
    assert_eq!(read(&scenario.to_toml(), &[]), scenario, "what a pair leaves open stays open");
}

#[test]
fn keys_are_explained_with_the_laws_they_take() {
    let doc = explain("bodies[].at_mm").unwrap();
    assert!(doc.kind.contains("a number, a string or a table that holds"), "{}", doc.kind);
    assert!(doc.description.contains("von_mises: The bell curve of an angle"), "{}", doc.description);
    assert_eq!(explain("fixed[0].name").unwrap().key, "world.custom.fixed[].name");
}

#[test]
fn a_new_file_is_the_default_world_without_what_need_not_be_said() {
    let text = template("custom").unwrap();
    assert_eq!(read(&text, &[]), Scenario::default_of("custom").unwrap());
    assert!(text.contains("{ name = \"floor\", shape = { plane = {} } }"), "{text}");
}

/// A thousand bodies are read and built, and ten thousand are refused, both within seconds.
#[test]
fn many_bodies_are_a_world_and_too_many_are_none() {
    let many = |count: usize| {
        let one = |k: usize| {
            let (x, y) = (80 * (k % 100), 80 * (k / 100));
            format!(
                "[[world.custom.bodies]]\nname = 'b{k}'\nshape = {{ ball = {{ radius_mm = 30 }} }}\nat_mm = [{x}, {y}, 100]\n"
            )
        };
        (0..count).map(one).collect::<String>()
    };
    assert_eq!(Scenario::read("many.toml", &many(1000), &[]).map(|_| ()), Ok(()));
    let error = Scenario::read("many.toml", &many(10_000), &[]).unwrap_err();
    assert!(error.to_string().contains("a list of 10000 is out of range"), "{error}");
}
