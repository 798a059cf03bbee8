//! Worlds that users describe, described wrongly: each is refused where it stands, in words that help. And what is
//! right is read as it is meant.

use plaus_dist::{Purpose, Seed, math};
use plaus_mcmc::{Target, Variables};
use plaus_scenes::animation::Shape;
use plaus_scenes::custom::Custom;
use plaus_scenes::require::Tally;
use plaus_scenes::scenario::{explain, starter, template};
use plaus_scenes::{Scenario, Scene, World};

const BALL: &str =
    "[[world.custom.bodies]]\nname = 'ball'\nshape = { ball = { radius_mm = 30 } }\nat_mm = [0, 0, 100]\n";

/// What comes after a good ball; with what the place begins that is blamed; parts of the message.
const CASES: &[(&str, &str, &[&str])] = &[
    ("velocity_m_s = [{ unifrom = [0, 1] }, 0, 0]", "unifrom", &["bodies[0].velocity_m_s[0]", "uniform"]),
    ("velocity_m_s = [{ normal = [0, -1] }, 0, 0]", "{ normal", &["velocity_m_s[0]", "standard deviation is -1"]),
    ("velocity_m_s = [{ uniform = [2, 1] }, 0, 0]", "{ uniform", &["high is 1", "above low"]),
    ("velocity_m_s = [{ uniform = [2] }, 0, 0]", "[2]", &["a list of 1", "2"]),
    ("velocity_m_s = [{ von_mises = { mean = 0, concentration = 1 } }, 0, 0]", "{ von", &["is a law for angles"]),
    ("velocity_m_s = [{ choice = { of = [1, 1] } }, 0, 0]", "{ choice", &["value is 1", "given once"]),
    ("velocity_m_s = [1e9, 0, 0]", "1e9", &["out of range", "m/s"]),
    ("velocity_m_s = ['2 * (1 + 3', 0, 0]", "'2", &["cannot be read as arithmetic", "a bracket"]),
    ("velocity_m_s = [true, 0, 0]", "true", &["expected a number", "found the boolean true"]),
    ("velocity_m_s = [0, 0]", "[0, 0]", &["exactly 3 are needed"]),
    (
        "velocity_m_s = ['pusch', 0, 0]\n[[world.custom.quantities]]\nname = 'push'\nvalue = 1",
        "'pusch'",
        &["no quantity \"pusch\"", "did you mean \"push\"?"],
    ),
    ("[[world.custom.regions]]", "[[", &["regions[0]", "which region?"]),
    ("[[world.custom.regions]]\nx_mm = [5, 5]", "[5", &["regions[0].x_mm", "the first number is the smaller"]),
    ("velocity = [0, 0, 0]", "velocity", &["unknown key `velocity`", "did you mean `velocity_m_s`?"]),
    ("release_s = { normal = [1, 0.1] }", "release_s", &["-inf to inf", "at least 0", "`truncated`"]),
    ("material = 'rubber'\n[[world.custom.materials]]\nname = 'ruber'", "'rubber'", &["did you mean \"ruber\"?"]),
    ("[[world.custom.materials]]\nname = 'a'\nrestitution = { uniform = [0, 2] }", "restitution", &["from 0 to 1"]),
    ("[[world.custom.materials]]\nname = 'a'\n[[world.custom.materials]]\nname = 'a'", "'a'", &["already a material"]),
    (
        "[[world.custom.materials]]\nname = 'a'\nfriction = 0.5\nstatic_friction = 0.4",
        "0.4",
        &["materials[0].static_friction", "it may be 0.4 where `friction` is 0.5", "such as 0.5"],
    ),
    (
        "[[world.custom.pairs]]\nbetween = ['', '']\nfriction = { uniform = [0.1, 0.5] }\nstatic_friction = 0.4",
        "0.4",
        &["pairs[0].static_friction", "such as 0.5"],
    ),
    (
        "[[world.custom.pairs]]\nbetween = ['', '']\nstatic_friction = 0.4",
        "0.4",
        &["pairs[0].static_friction", "set `friction` too"],
    ),
    ("[[world.custom.pairs]]\nbetween = ['a', '']", "'a'", &["no material \"a\"", "there are none"]),
    ("[[world.custom.bodies]]\nname = 'ball'\nshape = { ball = { radius_mm = 3 } }", "'ball'", &["already"]),
    ("[[world.custom.bodies]]\nname = 'a b'\nshape = { ball = { radius_mm = 3 } }", "'a b'", &["a name has from 1 to"]),
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
    (
        "[[world.custom.fixed]]\nname = 't'\nshape = { plane = {} }\nbumps = { sd_mm = 1, spacing_mm = 8 }",
        "bumps = {",
        &["fixed[0].bumps", "shape = { table = { bumps_mm"],
    ),
    (
        "[[world.custom.fixed]]\nname = 't'\nshape = { ball = { radius_mm = 9 } }\nbumps = { sd_mm = 1, spacing_mm = 8 }",
        "bumps = {",
        &["fixed[0].bumps", "only a mesh, a box without rounding"],
    ),
    (
        "[[world.custom.fixed]]\nname = 't'\nshape = { table = { bumps_mm = { normal = [1, 1] }, spacing_mm = 8 } }",
        "bumps_mm = { normal",
        &["bumps_mm", "at least 0"],
    ),
    (
        "[[world.custom.fixed]]\nname = 't'\n\
         shape = { table = { bumps_mm = 1, spacing_mm = 8, restitution = { mean = 0.9, sd = 0.2 } } }",
        "restitution = { mean",
        &["table.restitution", "from 0 to 1", "cut off"],
    ),
    (
        "[[world.custom.fixed]]\nname = 't'\nshape = { table = { bumps_mm = 0.1, spacing_mm = 0.5 } }\n\
         [[world.custom.bodies]]\nname = 'b'\nshape = { box = { size_mm = [30, 30, 30] } }\nat_mm = [200, 0, 99]",
        "0.5 }",
        &["spacing_mm", "too fine for a body as large as \"b\"", "1.299 mm"],
    ),
    (
        "[[world.custom.bodies]]\nname = 'b'\nat_mm = [200, 0, 0]\nshape = { revolution = { foot_mm = 9, rim_mm = 1, \
         outline_mm = [[5, 9], [20, 12], [30, 8]], top_mm = 30.05 } }",
        "revolution",
        &["bodies[1].shape", "top", "at least 30.08 mm"],
    ),
    ("within = { bal = { radius_mm = 3 } }", "bal", &["bodies[0].within", "ball"]),
    ("within = { ball = { radius_mm = 0 } }", "0", &["within.ball.radius_mm", "out of range"]),
    ("within = { ball = { radius_mm = { normal = [9, 1] } } }", "radius_mm", &["radius_mm", "`truncated`"]),
    ("velocity_m_s = ['2 * ', 0, 0]", "'2 * '", &["velocity_m_s[0]", "cannot be read as arithmetic"]),
    ("velocity_m_s = ['i * 2', 0, 0]", "'i * 2'", &["\"i\" counts in arrays", "`count`"]),
    ("release_s = '1 - 3'", "'1 - 3'", &["its value is -2", "from 0 to 10000"]),
    ("release_s = 'normal(1, 0.1)'", "'normal", &["-inf to inf", "at least 0", "max("]),
    ("release_s = 'sqrt(uniform(-1, 1))'", "'sqrt", &["may be undefined"]),
    ("velocity_m_s = ['1 / uniform(0, 1)', 0, 0]", "'1 / uni", &["may be undefined", "divides by what may be 0"]),
    ("velocity_m_s = ['uniform(1, 0)', 0, 0]", "'uniform", &["high is 0", "above low"]),
    ("velocity_m_s = ['normal(0, uniform(-1, 2))', 0, 0]", "'normal", &["sd of normal(…)", "-1 to 2", "at least 0"]),
    ("velocity_m_s = ['truncated(0, uniform(1, 2), 0, 1)', 0, 0]", "'trunc", &["truncated(…) must be certain"]),
    (
        "velocity_m_s = ['triangular(0, uniform(1, 3), 2)', 0, 0]",
        "'triang",
        &["the peak of triangular(…) goes from 1 to 3", "outside the ends"],
    ),
    ("[[require]]\nbreaks = { joint = 'glue' }", "'glue'", &["require[0].breaks.joint", "no joints"]),
    ("within = { surface = { of = 'flor' } }", "'flor'", &["surface.of", "did you mean \"floor\"?"]),
    ("within = { surface = { of = 'floor' } }", "'floor'", &["no end", "a mesh"]),
    ("within = { surface = { of = 'floor', abov_mm = 3 } }", "abov_mm", &["did you mean `above_mm`?"]),
    (
        "within = { surface = { of = 'w', facing_deg = 30 } }\n[[world.custom.fixed]]\nname = 'w'\n\
         shape = { hull = { points_mm = [[0, 0, 90], [90, 0, 0], [0, 90, 0], [0, -90, 0]] } }",
        "30",
        &["facing_deg", "no face of \"w\" looks there"],
    ),
    (
        "within = { surface = { of = 'can' } }\n[[world.custom.fixed]]\nname = 'can'\n\
         shape = { cylinder = { radius_mm = 9, height_mm = 9 } }",
        "'can'",
        &["only a mesh, a box without rounding"],
    ),
    ("velocity_m_s = ['unifrom(0, 1)', 0, 0]", "'unifrom", &["no function \"unifrom\"", "did you mean \"uniform\"?"]),
    (
        "[[world.custom.quantities]]\nname = 'a'\nvalue = 'b + 1'\n\
         [[world.custom.quantities]]\nname = 'b'\nvalue = '2 * a'",
        "'b + 1'",
        &["quantities[0].value", "depends on itself: a → b → a"],
    ),
    ("[[world.custom.quantities]]\nname = 'a'\nvalue = 'a'", "'a'", &["depends on itself: a → a"]),
    ("[[world.custom.quantities]]\nname = 'pi'\nvalue = 3", "'pi'", &["has another meaning"]),
    ("[[world.custom.quantities]]\nname = 'a'\nvalue = 'c'", "'c'", &["no quantity \"c\""]),
    ("count = 0", "0", &["bodies[0].count", "out of range"]),
    ("count = 1_000_000", "1_000_000", &["bodies[0].count", "out of range", "4096"]),
    (
        "[[world.custom.bodies]]\nname = 'b'\ncount = 4096\nshape = { ball = { radius_mm = 3 } }\n\
         at_mm = ['9 * i', 0, 900]",
        "4096",
        &["bodies[1].count", "these are 4097 bodies: at most 4096"],
    ),
    (
        "[[world.custom.bodies]]\nname = 'b_2'\nshape = { ball = { radius_mm = 3 } }\n\
         [[world.custom.bodies]]\nname = 'b'\ncount = 2\nshape = { ball = { radius_mm = 3 } }",
        "'b'",
        &["bodies[2].name", "the name \"b_2\" is already used"],
    ),
    (
        "[[world.custom.bodies]]\nname = 'b'\ncount = 3\nshape = { ball = { radius_mm = 30 } }\n\
         at_mm = ['50 * i', 0, 500]",
        "['50 * i'",
        &["bodies[1].at_mm", "\"b_1\" begins 10.000 mm inside \"b_2\""],
    ),
    (
        "[[world.custom.driven]]\nname = 'foot'\nshape = { ball = { radius_mm = 3 } }\n\
         keys = [{ at_s = 'uniform(0, 1)', at_mm = [0, 0, 9] }, { at_s = 0.9, at_mm = [9, 0, 9] }]",
        "0.9",
        &["driven[0].keys[1].at_s", "0.9 to 0.9 s, may come 0.1 s before the one before it"],
    ),
    (
        "[[world.custom.driven]]\nname = 'foot'\nshape = { ball = { radius_mm = 3 } }\nkeys = []",
        "[]",
        &["driven[0].keys", "a list of 0"],
    ),
    (
        "[[world.custom.driven]]\nname = 'ball'\nshape = { ball = { radius_mm = 3 } }\n\
         keys = [{ at_s = 0, at_mm = [0, 0, 9] }]",
        "'ball'",
        &["driven[0].name", "already"],
    ),
    (
        "[[world.custom.joints]]\nname = 'j'\nbody = 'bal'\nkind = { ball = {} }",
        "'bal'",
        &["joints[0].body", "no body \"bal\"", "did you mean \"ball\"?"],
    ),
    (
        "[[world.custom.joints]]\nname = 'j'\nbody = 'ball'\nto = 'flor'\nkind = { ball = {} }",
        "'flor'",
        &["joints[0].to", "no body \"flor\""],
    ),
    (
        "[[world.custom.joints]]\nname = 'j'\nbody = 'ball'\nto = 'ball'\nkind = { ball = {} }",
        "'ball'",
        &["joints[0].to", "held to itself"],
    ),
    (
        "[[world.custom.joints]]\nname = 'j'\nbody = 'ball'\nkind = { hinge = { axis = [0, 0, 0] } }",
        "[0, 0, 0]",
        &["kind.hinge.axis", "needs a length"],
    ),
    (
        "[[world.custom.joints]]\nname = 'j'\nbody = 'ball'\nkind = { hinge = { axis = [0, 0, 1], limits_deg = [10, 20] } }",
        "[10, 20]",
        &["limits_deg", "where the body starts"],
    ),
    (
        "[[world.custom.joints]]\nname = 'j'\nbody = 'ball'\nkind = { hinge = { axis = [0, 0, 1], limits_deg = [-180, 180] } }",
        "[-180",
        &["limits_deg", "340 apart"],
    ),
    (
        "[[world.custom.joints]]\nname = 'j'\nbody = 'ball'\nkind = { weld = { breaks_at_n_s = 0 } }",
        "0",
        &["breaks_at_n_s", "out of range"],
    ),
    (
        "[[world.custom.joints]]\nname = 'j'\nbody = 'ball'\nkind = { ball = {}, weld = {} }",
        "weld",
        &["joints[0].kind", "exactly one must be chosen"],
    ),
    (
        "asleep = true\n[[world.custom.joints]]\nname = 'j'\nbody = 'ball'\nkind = { ball = {} }",
        "'ball'",
        &["joints[0].body", "asleep"],
    ),
    ("asleep = true\nspin_deg_s = [0, 0, 9]", "true", &["bodies[0].asleep", "a body that is asleep does not move"]),
    ("present = 1.5", "1.5", &["bodies[0].present", "out of range", "from 0 to 1"]),
    ("present = 'i'", "'i'", &["bodies[0].present", "`count`"]),
    (
        "present = '3 * push'\n[[world.custom.quantities]]\nname = 'push'\nvalue = 1",
        "'3 * push'",
        &["bodies[0].present", "its value is 3", "from 0 to 1"],
    ),
    ("present = { uniform = [0.6, 0.9] }", "present", &["bodies[0].present", "it always is", "such as 0.7"]),
    ("present = { uniform = [0.1, 0.2] }", "present", &["bodies[0].present", "it never is"]),
    (
        "present = 0.7\n[[world.custom.joints]]\nname = 'j'\nbody = 'ball'\nkind = { ball = {} }",
        "'ball'",
        &["joints[0].body", "not there in every draw", "`present`"],
    ),
    ("damping = -1", "-1", &["bodies[0].damping", "out of range"]),
    ("damping = { normal = [1, 1] }", "damping", &["bodies[0].damping", "must be at least 0"]),
    ("[world.custom.view]\nfrom = [0, 0, 1]", "[0, 0, 1]", &["view.from", "from straight above"]),
    ("[world.custom.view]\nbox_mm = [[0, 0, 0]]", "[[0, 0, 0]]", &["view.box_mm", "two corners"]),
    ("colour = 'red'", "'red'", &["not a colour", "#c04030"]),
    ("any_turn = true\nturn_deg = [0, 0, 1]", "true", &["leave out `turn_deg`"]),
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

/// An array is what its members would be, written one by one; so is arithmetic with certain numbers.
#[test]
fn arrays_and_arithmetic_mean_what_they_say() {
    let array = "[[world.custom.quantities]]\nname = 'gap'\nvalue = '3 * side'\n\
                 [[world.custom.quantities]]\nname = 'side'\nvalue = 20\n\
                 [[world.custom.bodies]]\nname = 'pin'\ncount = 3\nshape = { ball = { radius_mm = 'side / 2' } }\n\
                 at_mm = ['gap * (i - (n - 1) / 2)', { normal = [0, 2] }, 'max(side, 50) + 10 * (i % 2)']\n";
    let one = |name: &str, x: f64, z: f64| {
        format!(
            "[[world.custom.bodies]]\nname = '{name}'\nshape = {{ ball = {{ radius_mm = 10 }} }}\n\
             at_mm = [{x}, {{ normal = [0, 2] }}, {z}]\n"
        )
    };
    let listed = [one("pin_1", -60.0, 50.0), one("pin_2", 0.0, 60.0), one("pin_3", 60.0, 50.0)].concat();
    let seen = |text: &str| {
        let World::Custom(config) = read(text, &[]).world else { panic!("another world") };
        let scene = Custom::new(&config).unwrap();
        let draw = scene.start(&mut Seed(1).chain(0).at(0, Purpose::START));
        let names: Vec<String> = scene.scalars().iter().map(|scalar| scalar.name.clone()).collect();
        (names, scene.animate(&draw).unwrap().motion.tracks)
    };
    let (names, tracks) = seen(array);
    assert_eq!((names.clone(), tracks), seen(&listed));
    assert!(names.contains(&"pin_2.y".to_owned()), "{names:?}");
}

/// What is worked out in the scene is what one works out from its columns.
#[test]
fn computed_quantities_follow_from_the_draw() {
    let text = "[[world.custom.quantities]]\nname = 'wide'\nvalue = '2 * narrow'\n\
                [[world.custom.quantities]]\nname = 'narrow'\nvalue = { uniform = [10, 20] }\n\
                [[world.custom.bodies]]\nname = 'brick'\nshape = { box = { size_mm = ['narrow', 'wide', 9] } }\n\
                at_mm = [0, 'wide + normal(100, 5) * uniform(1, 2)', 200]\n";
    let World::Custom(config) = read(text, &[]).world else { panic!("another world") };
    let scene = Custom::new(&config).unwrap();
    let names: Vec<&str> = scene.vars().iter().map(|var| var.name.as_ref()).collect();
    assert_eq!(names, ["narrow", "brick.y.law", "brick.y.law_2"]);
    for nth in 0..20 {
        let draw = scene.start(&mut Seed(1).chain(0).at(nth, Purpose::START));
        let track = &scene.animate(&draw).unwrap().motion.tracks[0];
        let [narrow, normal, factor] = draw.numbers[..] else { panic!("{draw:?}") };
        let Shape::Cuboid { half, .. } = *track.shape else { panic!("{:?}", track.shape) };
        assert!((half * 2e3 - glam::DVec3::new(narrow, 2.0 * narrow, 9.0)).length() < 1e-9, "{half} {narrow}");
        // An animation's z is the simulator's y, towards the viewer.
        let y = -1e3 * track.pieces[0].position(0.0).z;
        assert!((y - 2.0 * narrow - normal * factor).abs() < 1e-9, "{y}");
    }
}

/// A paddle goes through its keys whatever it hits; what it hits leaves with `1 + e` times its speed.
#[test]
fn driven_bodies_follow_their_keys_and_move_what_they_hit() {
    let world = |between: &str, keys: &str| {
        format!(
            "[world.custom]\ngravity = 0\nduration_s = 3\nfixed = []\n\
             [[world.custom.materials]]\nname = 'm'\nfriction = 0\nrestitution = 0.5\n\
             [[world.custom.bodies]]\nname = 'ball'\nmaterial = 'm'\nshape = {{ ball = {{ radius_mm = 20 }} }}\n\
             at_mm = [530, 0, 0]\n\
             [[world.custom.driven]]\nname = 'paddle'\nmaterial = 'm'\nbetween = '{between}'\n\
             shape = {{ box = {{ size_mm = [20, 300, 300] }} }}\nkeys = [{keys}]\n"
        )
    };
    let seen = |text: &str| {
        let World::Custom(config) = read(text, &[]).world else { panic!("another world") };
        let scene = Custom::new(&config).unwrap();
        assert!(scene.scalars().iter().all(|scalar| !scalar.name.starts_with("paddle")));
        scene.animate(&scene.start(&mut Seed(1).chain(0).at(0, Purpose::START))).unwrap()
    };
    let keys = "{ at_s = 0, at_mm = [0, 0, 0] }, { at_s = 2, at_mm = [2000, 0, 0] }";
    let straight = seen(&world("linear", keys));
    let [ball, paddle] = &straight.motion.tracks[..] else { panic!("{:?}", straight.motion.tracks) };
    // It reaches the ball at 0.5 s with 1 m/s. The gap at which bodies count as touching is far below a millimetre.
    assert!((straight.motion.impacts[0].time - 0.5).abs() < 1e-3, "{:?}", straight.motion.impacts);
    assert!((ball.position(1.5).x - 0.53 - 1.5).abs() < 2e-3, "{}", ball.position(1.5));
    for (time, place) in [(0.25, 0.25), (1.5, 1.5), (2.5, 2.0)] {
        assert!((paddle.position(time).x - place).abs() < 1e-9, "{}", paddle.position(time));
    }
    let turned = "{ at_s = 0, at_mm = [0, 0, 0] }, { at_s = 2, at_mm = [400, 0, 0], turn_deg = [0, 0, 60] }";
    let smooth = seen(&world("smooth", turned));
    let paddle = &smooth.motion.tracks[1];
    // Half of the way at half of the time; of a cubic that begins and ends slowly 5/32 after a quarter.
    for (time, part) in [(0.5, 5.0 / 32.0), (1.0, 0.5), (2.0, 1.0)] {
        // Ways are followed to a tenth of the gap at which bodies touch.
        assert!((paddle.position(time).x - 0.4 * part).abs() < 1e-4, "{time}: {}", paddle.position(time));
    }
    let turn = paddle.orientation(1.0) * paddle.orientation(0.0).inverse();
    assert!((turn.xyz().length() - math::sin(15_f64.to_radians())).abs() < 1e-3, "{turn}");
}

/// A chain of quantities as long as may be is worked out, each once, in whatever order it stands.
#[test]
fn long_chains_of_quantities_are_worked_out_once_each() {
    let one = |k: usize| {
        let value = match k {
            0 | 1 => "'uniform(0.999, 1.001)'".to_owned(),
            _ => format!("'0.5 * q{} + 0.5 * q{}'", k - 1, k - 2),
        };
        format!("[[world.custom.quantities]]\nname = 'q{k}'\nvalue = {value}\n")
    };
    let chain: String = (0..4096).rev().map(one).collect();
    read(&format!("{chain}{BALL}velocity_m_s = ['q4095', 0, 0]\n"), &[]);
}

#[test]
fn keys_are_explained_with_the_laws_they_take() {
    let doc = explain("bodies[].at_mm").unwrap();
    assert!(doc.kind.contains("a number, a string or a table that holds"), "{}", doc.kind);
    assert!(doc.description.contains("von_mises: The bell curve of an angle"), "{}", doc.description);
    assert_eq!(explain("fixed[0].name").unwrap().key, "world.custom.fixed[].name");
}

#[test]
fn a_new_file_is_the_default_world_without_optional_keys() {
    let text = template("custom").unwrap();
    assert_eq!(read(&text, &[]), Scenario::default_of("custom").unwrap());
    assert!(text.contains("{ name = \"floor\", shape = { plane = {} } }"), "{text}");
}

/// The world that `plaus new` writes asks for something that can happen, and differs from the default in nothing else.
#[test]
fn a_file_to_begin_with_asks_for_something() {
    let text = starter("custom").unwrap();
    let (begun, mut default) = (read(&text, &[]), Scenario::default_of("custom").unwrap());
    let World::Custom(world) = &mut default.world else { panic!("not custom") };
    let World::Custom(new) = &begun.world else { panic!("not custom") };
    (world.materials, world.bodies) = (new.materials.clone(), new.bodies.clone());
    default.require = begun.require.clone();
    assert_eq!((begun.require.len(), new.materials.len(), new.bodies.len(), &begun), (1, 1, 1, &default));
    assert_eq!(new.bodies[0].material, "rubber");
    let tally = Tally::of_prior(&begun.stage().unwrap(), 1, 3000, |_| true).unwrap();
    assert!((1..300).contains(&tally.all), "{} of 3,000 draws of the prior", tally.all);
    assert_eq!(starter("dice"), template("dice"));
}

/// A thousand bodies are read and built, and ten thousand are refused, both within seconds.
#[test]
fn many_bodies_are_accepted_and_too_many_are_refused() {
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
