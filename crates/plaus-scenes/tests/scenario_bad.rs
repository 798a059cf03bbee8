//! Bad scenario files: each problem is reported at its place, with its key, the allowed range and the nearest known
//! name.

use plaus_scenes::registry::NAMES;
use plaus_scenes::scenario::{Problem, ScenarioError, Source};
use plaus_scenes::{ConfigError, Scenario};

fn error(text: &str, overrides: &[&str]) -> ScenarioError {
    let overrides: Vec<String> = overrides.iter().map(|said| (*said).to_owned()).collect();
    Scenario::read("bad.toml", text, &overrides).expect_err(text)
}

fn only(text: &str, overrides: &[&str]) -> Problem {
    let mut error = error(text, overrides);
    assert_eq!(error.problems.len(), 1, "{error}");
    error.problems.remove(0)
}

/// Text; line and column; key; parts of the message and the help.
type Case = (&'static str, (usize, usize), &'static str, &'static [&'static str]);

#[test]
#[expect(clippy::too_many_lines, reason = "one table")]
fn each_problem_has_its_place_key_range_and_nearest_name() {
    let cases: &[Case] = &[
        // Unknown keys.
        ("[world.ball2d]\nsgima_d = 1", (2, 1), "world.ball2d.sgima_d", &["unknown key", "did you mean `sigma_d`?"]),
        ("[world.ball2d]\nsigma_theta = 1", (2, 1), "world.ball2d.sigma_theta", &["did you mean `sigma_theta_deg`?"]),
        (
            "[world.ball2d]\n\"\" = 1",
            (2, 1),
            "world.ball2d.\"\"",
            &["unknown key", "known in [world.ball2d]: drop_height"],
        ),
        ("seed = 1\n[world.ball2d]", (1, 1), "seed", &["unknown key", "write it as `sampler.seed`"]),
        ("[world.ball2d]\nrequire = []", (2, 1), "world.ball2d.require", &["above the first line in brackets"]),
        ("[sampler]\nsigma_d = 1\n[world.ball2d]", (2, 1), "sampler.sigma_d", &["write it as `world.ball2d.sigma_d`"]),
        (
            "[sampler]\nsgima_d = 1\n[world.ball2d]",
            (2, 1),
            "sampler.sgima_d",
            &["did you mean `world.ball2d.sigma_d`?"],
        ),
        (
            "[sampler.tempering]\nrungs = 0\n[world.ball2d]",
            (2, 9),
            "sampler.tempering.rungs",
            &["0 is out of range", "from 1 to 256"],
        ),
        (
            "[sampler]\nrules.preset = \"as-printed\"\ntempering.rungs = 8\n[world.ball2d]",
            (3, 19),
            "sampler.tempering.rungs",
            &["tempering needs exact acceptance", "set sampler.rules.preset = \"exact\", or rungs = 1"],
        ),
        (
            "[sampler]\nadapt = false\nadapt_weights = true\n[world.ball2d]",
            (3, 17),
            "sampler.adapt_weights",
            &["only where scales are adapted", "set sampler.adapt = true"],
        ),
        ("[sampeler]\nseed = 1\n[world.ball2d]", (1, 2), "sampeler", &["did you mean `sampler`?"]),
        ("[world.ball2d.weights]\naimm = 1", (2, 1), "world.ball2d.weights.aimm", &["did you mean `aim`?"]),
        // Wrong types.
        (
            "[world.ball2d]\ntarget = \"1\"",
            (2, 10),
            "world.ball2d.target",
            &["expected a number, from -1e6 to 1e6 D", "string \"1\"", "write 1"],
        ),
        (
            "[world.ball2d]\ncollisions = 5.0",
            (2, 14),
            "world.ball2d.collisions",
            &["an integer, from 1 to 64", "5.0", "write 5"],
        ),
        ("[world.ball2d]\ncollisions = 5.5", (2, 14), "world.ball2d.collisions", &["an integer, from 1 to 64", "5.5"]),
        ("[world.ball2d]\nweights = 1", (2, 11), "world.ball2d.weights", &["expected a table, found the integer 1"]),
        (
            "[world.ball2d]\nsigma_d = [0.1,\n 0.2]",
            (2, 11),
            "world.ball2d.sigma_d",
            &["expected a number", "found a list"],
        ),
        ("[world.ball2d]\nsigma_d = {}", (2, 11), "world.ball2d.sigma_d", &["found a table"]),
        (
            "[world.ball2d]\nsigma_d = 1979-05-27",
            (2, 11),
            "world.ball2d.sigma_d",
            &["found the date or time 1979-05-27"],
        ),
        ("sampler = 3\n[world.ball2d]", (1, 11), "sampler", &["expected a table, found the integer 3"]),
        ("world = 3", (1, 9), "world", &["expected a table that holds ball2d"]),
        ("[[world]]\nball2d = {}", (1, 1), "world", &["found a list"]),
        (
            "[sampler.rules]\nsymmetric_redraws = 1\n[world.ball2d]",
            (2, 21),
            "sampler.rules.symmetric_redraws",
            &["a boolean", "integer 1"],
        ),
        // Out of range.
        (
            "[world.ball2d]\nsigma_d = -0.1",
            (2, 11),
            "world.ball2d.sigma_d",
            &["-0.1 is out of range: it must be from 1e-9 to 1e6 D"],
        ),
        (
            "[world.ball2d]\nsigma_theta_deg = 0",
            (2, 19),
            "world.ball2d.sigma_theta_deg",
            &["0 is out of range", "from 1e-9 to 90°"],
        ),
        (
            "[world.ball2d]\ncollisions = 0",
            (2, 14),
            "world.ball2d.collisions",
            &["0 is out of range: it must be from 1 to 64"],
        ),
        (
            "[world.ball2d]\ncollisions = 65",
            (2, 14),
            "world.ball2d.collisions",
            &["65 is out of range: it must be from 1 to 64"],
        ),
        ("[world.ball2d]\nrestitution = 1.0000000000000002", (2, 15), "world.ball2d.restitution", &["from 0 to 1"]),
        (
            "[sampler]\nchains = -1\n[world.ball2d]",
            (2, 10),
            "sampler.chains",
            &["-1 is out of range: it must be from 1 to 100_000"],
        ),
        // Numbers that are not finite, or too large for their type.
        ("[world.ball2d]\nsigma_d = nan", (2, 11), "world.ball2d.sigma_d", &["nan is out of range", "1e6 D"]),
        ("[world.ball2d]\ntarget = -inf", (2, 10), "world.ball2d.target", &["-inf is out of range"]),
        ("[world.ball2d]\ndrop_height = 1e309", (2, 15), "world.ball2d.drop_height", &["1e309 is out of range"]),
        ("[world.ball2d]\nsigma_d = 1e-400", (2, 11), "world.ball2d.sigma_d", &["1e-400 is out of range"]),
        (
            "[sampler]\nseed = 9223372036854775808\n[world.ball2d]",
            (2, 8),
            "sampler.seed",
            &["from 0 to 9_223_372_036_854_775_807"],
        ),
        (
            "[sampler]\nseed = 0xffffffffffffffffffffffffffffffffffff\n[world.ball2d]",
            (2, 8),
            "sampler.seed",
            &["0xffff", "out of range"],
        ),
        (
            "[sampler]\nchains = 1e300\n[world.ball2d]",
            (2, 10),
            "sampler.chains",
            &["expected an integer, from 1 to 100_000"],
        ),
        (
            "[world.ball2d]\ntarget = 100000000000000000000000000000000000000000",
            (2, 10),
            "world.ball2d.target",
            &["from -1e6 to 1e6 D"],
        ),
        // Misspelt words.
        (
            "[world.ball2d]\ndownward = \"miror\"",
            (2, 12),
            "world.ball2d.downward",
            &["\"mirror\", \"reject\", \"zero\", \"level\" or \"back\"", "did you mean \"mirror\"?"],
        ),
        (
            "[sampler.rules]\npreset = \"as_printed\"\n[world.ball2d]",
            (2, 10),
            "sampler.rules.preset",
            &["did you mean \"as-printed\"?"],
        ),
        (
            "[world.ball2d]\nmoves = true",
            (2, 9),
            "world.ball2d.moves",
            &["expected a word, \"mixed\" or \"paper\", found the boolean true"],
        ),
        // Worlds.
        (
            "[world.bal2d]\nsigma_d = 1",
            (1, 8),
            "world.bal2d",
            &["unknown world `bal2d`", "did you mean `world.ball2d`?", "known: ball2d"],
        ),
        ("[world]", (1, 2), "world", &["missing: exactly one", "add a table [world.ball2d]"]),
        ("world.ball2d = {}\nworld.billiards = {}", (2, 7), "world.billiards", &["unknown world `billiards`"]),
        (
            "[world.ball2d]\n[world.dice]",
            (2, 8),
            "world.dice",
            &["a second world, in addition to `ball2d`", "remove [world.ball2d] or [world.dice]"],
        ),
        // A key of another world, one that must be given, one of a list.
        ("[world.ball2d]\ntogether = true", (2, 1), "world.ball2d.together", &["known in [world.ball2d]: drop_height"]),
        ("together = true\n[world.dice]", (1, 1), "together", &["write it as `world.dice.together`"]),
        (
            "[world.custom]\nquantities = [{ name = \"a\" }]",
            (2, 15),
            "world.custom.quantities[0].value",
            &["missing: a number must be given"],
        ),
        // Keys that are each right, but wrong together.
        (
            "[world.ball2d]\n[world.ball2d.weights]\naim=0\nredraw=0\nperturb=0",
            (2, 15),
            "world.ball2d.weights",
            &["no move has a positive weight"],
        ),
        // Not TOML.
        ("[world.ball2d]\nsigma_d = # later\n", (2, 11), "", &["a value is missing after `=`"]),
        ("[world.ball2d]\nsigma_d = 1\nsigma_d = 2", (3, 1), "world.ball2d.sigma_d", &["duplicate key"]),
        ("[world.ball2d]\n[world.ball2d]", (2, 8), "world.ball2d", &["duplicate key"]),
        ("[world.ball2d]\n[[require]]\n[sampler]\n[require]", (4, 2), "require", &["require: duplicate key"]),
        (
            "# What must happen\n require=[]\n[world.ball2d]\n[[require]]\nat_rest = {}",
            (4, 3),
            "require",
            &["duplicate key; line 2 gives `require` as a list: delete that line"],
        ),
        (
            "[world.custom]\nnote = '''\nbodies = ['''\nbodies = []\n[[ world.custom.bodies ]]",
            (5, 17),
            "world.custom.bodies",
            &["duplicate key; line 4 gives `world.custom.bodies` as a list"],
        ),
        ("[world.ball2d]\nsigma_d = \"0.1", (2, 15), "", &["invalid basic string"]),
        ("[world.ball2d]\nsigma_d 0.1", (2, 9), "", &["expected `=`"]),
        ("[world.ball2d]\nsigma_d = 0,1", (2, 12), "", &["expected newline"]),
        // Windows line ends, byte order marks, and columns that count characters.
        ("\u{feff}[world.ball2d]\r\ncollisions = 0\r\n", (2, 14), "world.ball2d.collisions", &["from 1 to 64"]),
        ("\u{feff}sead = 1\r\n[world.ball2d]", (1, 1), "sead", &["did you mean `sampler.seed`?"]),
        ("world.ball2d = { 'größe' = 1, target = 'ä' }", (1, 18), "world.ball2d.\"größe\"", &["unknown key"]),
        (
            "world.ball2d = { restitution = 1,\n# ä\n sigma_d = 0 }",
            (3, 12),
            "world.ball2d.sigma_d",
            &["0 is out of range"],
        ),
    ];
    for (text, place, key, said) in cases {
        let error = error(text, &[]);
        let problem = &error.problems[0];
        assert_eq!((problem.line, problem.column), (Some(place.0), Some(place.1)), "{text}\n{error}");
        assert_eq!(problem.key, *key, "{text}\n{error}");
        let line = error.to_string().lines().next().unwrap().to_owned();
        assert!(line.starts_with(&format!("bad.toml:{}:{}: ", place.0, place.1)), "{line}");
        said.iter().for_each(|part| assert!(line.contains(part), "{part}\n{line}"));
        assert!(text.get(problem.span.clone().unwrap()).is_some(), "{text}");
    }
}

#[test]
fn all_problems_are_found_at_once_in_the_order_of_the_file() {
    let text = "sead = 1\n[sampler]\nchains = 0\n[world.ball2d]\nmoves = \"papr\"\ntarget = nan\n[world.ball2d.weights]\naimm = 1\naim = -1";
    let places: Vec<_> = error(text, &["step_deg=0"]).problems.iter().map(|problem| problem.line).collect();
    assert_eq!(places, [Some(1), Some(3), Some(5), Some(6), Some(8), Some(9), None]);
}

#[test]
fn spans_are_what_is_wrong() {
    let text = "[world.ball2d]\nsigma_d = -0.1 # strict\nsgima = [1]\n";
    let said: Vec<_> =
        error(text, &[]).problems.iter().map(|problem| text[problem.span.clone().unwrap()].to_owned()).collect();
    assert_eq!(said, ["-0.1", "sgima"]);
}

#[test]
fn a_file_without_a_world_says_how_to_add_one() {
    for text in ["", "\u{feff}", "\n\n", "# nothing\r\n", "[sampler]\nseed = 2"] {
        let problem = only(text, &[]);
        assert_eq!((problem.span.as_ref(), problem.line, problem.key.as_str()), (None, None, "world"));
        let tables: Vec<String> = NAMES.iter().map(|name| format!("[world.{name}]")).collect();
        let (last, others) = tables.split_last().unwrap();
        let begin =
            if text.contains("sampler") { "" } else { "; `plaus new custom FILE.toml` writes a file to begin with" };
        assert_eq!(problem.help, Some(format!("add a table {} or {last}{begin}", others.join(", "))));
    }
    assert!(error("", &[]).to_string().starts_with("bad.toml: world: missing"));
}

#[test]
fn binary_garbage_and_deep_nesting_are_refused() {
    let garbage: String =
        (0..2000_u32).filter_map(|i| char::from_u32(i.wrapping_mul(2_654_435_761) % 0x2_0000)).collect();
    assert!(error(&garbage, &[]).problems.len() <= 10);
    for part in ["[", "a=[", "a={a=", "a.", "{", "[a.", "[[", "a=[{a=", "[a]\n", "x=\"\"\"", "\""] {
        for start in ["", "x=", "["] {
            let error = error(&(start.to_owned() + &part.repeat(100_000)), &[]);
            assert!((1..=10).contains(&error.problems.len()), "{part}");
            assert!(error.to_string().len() < 4000, "{part}");
        }
    }
    let nested = format!("[world.ball2d]\nsigma_d = {}{}", "[".repeat(200), "]".repeat(200));
    assert_eq!(error(&nested, &[]).problems[0].line, Some(2));
}

#[test]
fn bytes_that_are_no_text_are_refused_where_the_text_breaks_off() {
    let error = ScenarioError::decode("run.bin", b"[world.ball2d]\n\xff\xfe = 1".to_vec()).unwrap_err();
    assert_eq!(error.to_string(), "run.bin:2:1: byte 15 (0xff) is not UTF-8 text; a scenario is a TOML file");
    assert_eq!(ScenarioError::decode("good.toml", b"a = 1".to_vec()).as_deref(), Ok("a = 1"));
}

#[test]
fn overrides_take_full_names_and_unique_ends() {
    let text = "[world.ball2d]\nsigma_d = 0.2\nsigma_theta_deg = -1";
    let read = |overrides: &[&str]| {
        let overrides: Vec<String> = overrides.iter().map(|said| (*said).to_owned()).collect();
        Scenario::read("good.toml", text, &overrides).unwrap_or_else(|error| panic!("{error}"))
    };
    // The last override counts, and also replaces what is wrong in the file. Missing tables are made, words need no
    // quotes, and tables are replaced as a whole.
    let mended = "world.ball2d.sigma_theta_deg=10";
    let read = read(&[
        mended,
        "sigma_d=1",
        " sigma_d = 5e-2 ",
        "moves=paper",
        "preset=\"as-printed\"",
        "weights={aim=1}",
        "weights.redraw=0",
    ]);
    let expected = "[sampler.rules]\npreset='as-printed'\n[world.ball2d]\nsigma_d=0.05\nmoves='paper'\nweights={aim=1.0, redraw=0}";
    assert_eq!(read, Scenario::read("expected.toml", expected, &[]).unwrap());
}

#[test]
fn overrides_are_blamed_by_their_own_words() {
    let known =
        format!("--set world.billiards.x=1: world.billiards.x: unknown key; known in [world]: {}", NAMES.join(", "));
    let cases: &[(&str, &str)] = &[
        ("sigma_d=-1", "--set sigma_d=-1: world.ball2d.sigma_d: -1 is out of range: it must be from 1e-9 to 1e6 D"),
        (
            "moves=papr",
            "--set moves=papr: world.ball2d.moves: \"papr\" is not allowed: it must be \"mixed\" or \"paper\"; did you mean \"paper\"?",
        ),
        ("sgima_d=1", "--set sgima_d=1: sgima_d: unknown key; did you mean `world.ball2d.sigma_d`?"),
        ("sampler.sede=1", "--set sampler.sede=1: sampler.sede: unknown key; did you mean `sampler.seed`?"),
        ("world.billiards.x=1", &known),
        ("gravity=1", "--set gravity=1: gravity: unknown key"),
        ("seed", "--set seed: seed: an override has the form `key=value`, but this has no `=`"),
        ("=1", "--set =1: unknown key"),
        ("aim=nan", "--set aim=nan: world.ball2d.weights.aim: nan is out of range: it must be from 0 to 1e6"),
        (
            "weights={aim=0, redraw=0, perturb=0}",
            "--set weights={aim=0, redraw=0, perturb=0}: world.ball2d.weights: no move has a positive weight",
        ),
        (
            "weights={aim=0, rdraw=0}",
            "--set weights={aim=0, rdraw=0}: world.ball2d.weights.rdraw: unknown key `rdraw`; did you mean `redraw`?",
        ),
    ];
    for (said, line) in cases {
        let problem = only("[world.ball2d]", &[said]);
        assert_eq!(
            (problem.span.clone(), problem.line, problem.source.clone()),
            (None, None, Source::Override((*said).into()))
        );
        assert_eq!(error("[world.ball2d]", &[said]).to_string(), *line);
    }
}

#[test]
fn later_errors_are_blamed_on_their_key_or_on_the_table_that_lacks_it() {
    let text = "[world.ball2d]\nsigma_d = 0.1\n";
    for (key, place, line) in [
        ("world.ball2d.sigma_d", Some("0.1"), "bad.toml:2:11: world.ball2d.sigma_d: no"),
        ("world.ball2d.weights.aim", Some("ball2d"), "bad.toml:1:8: world.ball2d.weights.aim: no"),
        ("sampler.rules", None, "bad.toml: sampler.rules: no"),
        ("", None, "bad.toml: no"),
    ] {
        let error = ScenarioError::locate("bad.toml", text, &ConfigError::new(key, "no"));
        assert_eq!(error.problems[0].span.clone().map(|span| &text[span]), place);
        assert_eq!(error.to_string(), line);
    }
}

/// Two constraints, so that a kind alone can tell which one is meant.
const DICE: &str = "[world.dice]\nconstraints = [\n    { rest_at = { x_mm = 1.0, y_mm = 2.0 } },\n    { face_up = { face = 6 } },\n]\n";

#[test]
fn overrides_reach_into_lists() {
    let read =
        |text: &str, said: &str| Scenario::read("dice.toml", text, &[said.to_owned()]).map(|read| read.to_toml());
    let moved = DICE.replace("x_mm = 1.0", "x_mm = 20.0");
    let wanted = Scenario::read("dice.toml", &moved, &[]).map(|read| read.to_toml());
    for said in ["constraints[0].rest_at.x_mm=20", "world.dice.constraints[0].rest_at.x_mm=20", "rest_at.x_mm=20"] {
        assert_eq!(read(DICE, said), wanted, "{said}");
    }
    let whole = "constraints[0]={ rest_at = { x_mm = 20, y_mm = 2 } }";
    assert_eq!(read(DICE, whole), wanted, "a whole table");
    // A list that the file leaves out has the entries of its default.
    assert!(read("[world.dice]", "constraints[0].rest_at.x_mm=20").is_ok_and(|read| read.contains("x_mm = 20.0")));
}

#[test]
fn overrides_of_missing_places_say_which_exist() {
    let said = |said| only(DICE, &[said]).to_string();
    let beyond = said("constraints[2].rest_at.x_mm=20");
    assert!(beyond.contains("`constraints` has 2 entries, `constraints[0]` to `constraints[1]`"), "{beyond}");
    let other = said("constraints[1].rest_at.x_mm=20");
    assert!(other.contains("`world.dice.constraints[1]` is `face_up`, not `rest_at`"), "{other}");
    let none = said("spilled.x_mm=20");
    assert!(none.contains("unknown key"), "{none}");
    let two = DICE.replace("{ face_up = { face = 6 } }", "{ rest_at = { x_mm = 3.0, y_mm = 4.0 } }");
    let which = only(&two, &["rest_at.x_mm=20"]).to_string();
    let choice = "`world.dice.constraints[0].rest_at.x_mm` or `world.dice.constraints[1].rest_at.x_mm`";
    assert!(which.contains(choice), "{which}");
}

#[test]
fn two_constraints_in_one_table_are_refused() {
    let text = "[world.dice]\nconstraints = [{ rest_at = { x_mm = 1.0, y_mm = 2.0 }, face_up = { face = 6 } }]";
    let problem = only(text, &[]);
    assert_eq!(problem.message, "`rest_at` and `face_up` in one table: each needs a table of its own");
    assert_eq!(problem.help.as_deref(), Some("write { rest_at = … }, { face_up = … }"));
}

/// Each key used to be compared with all others, and each line counted from the top, so 200,000 unknown keys took
/// minutes.
#[test]
fn unknown_keys_beyond_number_are_counted() {
    let mut text = String::from("[world.ball2d]\n");
    for key in 0..200_000 {
        text += &format!("unknown_key_{key} = 1\n");
    }
    let error = error(&text, &[]);
    assert_eq!(error.problems.len(), 200_000);
    assert_eq!((error.problems[199_999].line, error.problems[199_999].column), (Some(200_001), Some(1)));
    let said = error.to_string();
    assert_eq!(said.lines().count(), 21, "{said}");
    assert!(said.ends_with("and 199980 more problems"), "{said}");
}
