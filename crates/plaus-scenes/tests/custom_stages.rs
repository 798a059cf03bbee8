//! Worlds that start from a state that another one was left in.

use glam::DVec3;
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::Target;
use plaus_scenes::animation::Left;
use plaus_scenes::custom::{BodyState, Config, Custom, StartFrom};
use plaus_scenes::{Assets, Scenario, Scene, Until, World};

fn config(text: &str) -> Config {
    let scenario = Scenario::read("stage.toml", text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let World::Custom(config) = scenario.world else { panic!("another world") };
    *config
}

/// What `plaus export --format state` writes of it.
fn written(left: &[Left]) -> Vec<BodyState> {
    let body = |left: &Left| BodyState {
        name: left.name.clone(),
        at_mm: (left.position * 1e3).to_array(),
        orientation: left.orientation.to_array(),
        velocity_m_s: left.velocity.to_array(),
        spin_deg_s: left.spin.to_array().map(f64::to_degrees),
    };
    left.iter().map(body).collect()
}

/// How far bodies are apart, at most: of three points of each, so that turns count.
fn apart(a: &[Left], b: &[Left]) -> f64 {
    let points =
        |left: &Left| [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| left.position + left.orientation * axis * 0.05);
    assert!(a.len() == b.len() && !a.is_empty());
    let of =
        |(a, b): (&Left, &Left)| points(a).into_iter().zip(points(b)).map(|(p, q)| p.distance(q)).fold(0.0, f64::max);
    a.iter().zip(b).map(of).fold(0.0, f64::max)
}

/// The first draw of a world's own.
fn drawn(world: &Custom, nth: u64) -> <Custom as Target>::Draw {
    world.start(&mut Seed(5).chain(0).at(nth, Purpose::START))
}

/// Runs a world at once, and in two stages that are `cut` and `rest` long; gives how far the ends are apart, and how
/// far they are if the second stage starts without velocities.
fn in_stages(text: &str, nth: u64, [cut, rest]: [f64; 2]) -> [f64; 2] {
    let first = config(text);
    let world = Custom::new(&first).unwrap();
    let draw = drawn(&world, nth);
    let whole = world.animate_until(&draw, Until::Time(cut + rest)).unwrap();
    let from = written(&world.animate_until(&draw, Until::Time(cut)).unwrap().left);
    let mut still = from.clone();
    still.iter_mut().for_each(|body| (body.velocity_m_s, body.spin_deg_s) = ([0.0; 3], [0.0; 3]));
    [from, still].map(|from| {
        let mut second = first.clone();
        second.bodies.iter_mut().for_each(|body| {
            (body.velocity_m_s, body.spin_deg_s, body.any_turn) = Default::default();
        });
        let stage = Custom::new(&Config { start_from: StartFrom::of(&from), ..second }).unwrap();
        let draw = drawn(&stage, 0);
        let ended = stage.animate_until(&draw, Until::Time(rest)).unwrap();
        apart(&whole.left, &ended.left)
    })
}

/// In flight, both are closed forms of the same motion. From another point of it they have other rounding, so the bits
/// differ.
#[test]
fn flights_go_on_where_a_stage_ended() {
    let text = "[world.custom]\nfixed = []\nduration_s = 2\n\
        [[world.custom.bodies]]\nname = 'ball'\nshape = { ball = { radius_mm = 30 } }\n\
        velocity_m_s = [{ normal = [1, 1] }, 0, { normal = [2, 1] }]\nspin_deg_s = [0, { normal = [0, 90] }, 0]\n\
        [[world.custom.bodies]]\nname = 'book'\nshape = { box = { size_mm = [200, 140, 30] } }\nat_mm = [0, 900, 0]\n\
        any_turn = true\nvelocity_m_s = [{ normal = [1, 1] }, 0, 1]\n\
        spin_deg_s = [{ normal = [0, 200] }, { normal = [0, 200] }, { normal = [0, 200] }]\n";
    for nth in 0..10 {
        let [same, still] = in_stages(text, nth, [0.37, 0.5]);
        assert!(same < 1e-14 && still > 0.1, "{nth}: {same:e}, {still}");
    }
}

/// Steps begin anew where a stage begins. At `standard`, what slides and spins to rest is 5.8e-3 of its size off (the
/// table of `docs/validation/accuracy.md`); the book's is 0.1 m.
#[test]
fn motions_in_contact_go_on_where_a_stage_ended() {
    let text = "[world.custom]\nduration_s = 3\n\
        [[world.custom.materials]]\nname = 'felt'\nrolling = 0.01\n\
        [[world.custom.bodies]]\nname = 'ball'\nmaterial = 'felt'\nshape = { ball = { radius_mm = 30 } }\n\
        at_mm = [0, 0, 30]\nvelocity_m_s = [1, 0.2, 0]\n\
        [[world.custom.bodies]]\nname = 'book'\nshape = { box = { size_mm = [200, 140, 30] } }\nat_mm = [0, 900, 15]\n\
        velocity_m_s = [1.5, 0, 0]\nspin_deg_s = [0, 0, 100]\n\
        [[world.custom.bodies]]\nname = 'door'\nshape = { box = { size_mm = [400, 20, 800] } }\n\
        at_mm = [200, -900, 410]\nspin_deg_s = [0, 0, 40]\nvelocity_m_s = [0, 0.1396263401595464, 0]\n\
        [[world.custom.joints]]\nname = 'hinges'\nbody = 'door'\nat_mm = [0, -900, 410]\n\
        kind = { hinge = { axis = [0, 0, 1], limits_deg = [-5, 100], friction_n_m = 0.05 } }\n";
    for cut in [0.1, 0.25, 0.4] {
        let [same, still] = in_stages(text, 0, [cut, 0.4]);
        assert!(same < 5.8e-4 && still > 0.01, "{cut}: {same:e}, {still}");
    }
}

/// Two balls, of which files say how the first starts.
const BALLS: &str = "[world.custom]\nfixed = []\nduration_s = 1\nstart_from = { file = 'FILE' }\n\
    [[world.custom.bodies]]\nname = 'ball'\nshape = { ball = { radius_mm = 30 } }\nrelease_s = 0.5\n\
    [[world.custom.bodies]]\nname = 'other'\nshape = { ball = { radius_mm = 30 } }\nat_mm = [0, 0, 500]\n";

fn read(file: &str, content: &str, scenario: &str) -> Result<Scenario, String> {
    let mut files = Assets::default();
    files.insert(file, content.as_bytes());
    let text = scenario.replace("FILE", file);
    Scenario::read_with("stage.toml", &text, &[], &files).map_err(|error| error.to_string())
}

/// A run stores what a file says: the scenario that it writes needs no file.
#[test]
fn files_of_other_programs_are_read() {
    let json = "\u{feff}{\"made_by\": [1], \"bodies\": [{\"name\": \"ball\", \"at_mm\": [100, 0, 0.1], \
                \"velocity_m_s\": [1, 0, 0], \"orientation\": [0, 0, 3, 4]}, \
                {\"name\": \"lost\", \"at_mm\": [0, 0, 0]}]}";
    let toml = "[[bodies]]\nname = 'ball'\nat_mm = [100, 0, 0.1]\nvelocity_m_s = [1, 0, 0]\n\
                orientation = [0, 0, 3, 4]\n\
                [[bodies]]\nname = 'lost'\nat_mm = [0, 0, 0]\n";
    let [json, toml] = [("end.json", json), ("end.toml", toml)].map(|(file, text)| read(file, text, BALLS).unwrap());
    assert_eq!(json, toml);
    let again = Scenario::read("stored.toml", &json.to_toml(), &[]).unwrap();
    assert_eq!(again, json);
    let stage = again.stage().unwrap();
    assert!(stage.notes().iter().any(|note| note.contains("lost")), "{:?}", stage.notes());
    let animation = stage.animate(&stage.start(&mut Seed(1).chain(0).at(0, Purpose::START))).unwrap();
    let ball = &animation.motion.tracks[0];
    // It keeps its own time of release. An animation has y up; a quaternion of any length turns.
    assert_eq!(ball.position(0.5), DVec3::new(0.1, 1e-4, 0.0));
    assert!((ball.position(1.0).x - 0.6).abs() < 1e-12);
    let turned = ball.orientation(0.2) * DVec3::Y;
    assert!(
        (turned - animation.motion.tracks[1].orientation(0.2) * DVec3::new(-0.96, 0.28, 0.0)).length() < 1e-12,
        "{turned}"
    );
    assert_eq!(animation.motion.tracks[1].position(0.0).y, 0.5);
}

#[test]
fn what_is_no_state_is_refused_by_name_and_place() {
    let ball = |rest: &str| format!("{{\"bodies\": [{{\"name\": \"ball\", \"at_mm\": [0, 0, 0]{rest}}}]}}");
    let cases = [
        ("{}".to_owned(), "end.json: it has no list `bodies`"),
        ("[".to_owned(), "end.json: EOF"),
        (ball(", \"velocity\": [1, 0, 0]"), "bodies[0]: unknown field `velocity`"),
        (ball(", \"orientation\": [0, 0, 0, 0]"), "ball: orientation: a quaternion that is not 0"),
        (ball(", \"velocity_m_s\": [0, 2e4, 0]"), "ball: velocity_m_s: 20000 must be from -10000 to 10000 m/s"),
        (ball("}, {\"name\": \"ball\", \"at_mm\": [0, 0, 0]"), "\"ball\" is there twice"),
        (ball("").replace("ball", "bal"), "there is no \"bal\"; did you mean \"ball\"?"),
        ("{\"bodies\": []}".to_owned(), "which bodies?"),
    ];
    for (content, expected) in cases {
        let error = read("end.json", &content, BALLS).unwrap_err();
        assert!(error.contains(expected) && error.contains("start_from"), "{expected}: {error}");
    }
    let error = Scenario::read("a.toml", &BALLS.replace("FILE", "end.json"), &[]).unwrap_err().to_string();
    assert!(error.contains("cannot name files"), "{error}");
    let error = read("../end.json", &ball(""), BALLS).unwrap_err();
    assert!(error.contains("outside the scenario's folder"), "{error}");
}

/// A law that had no influence would be a column that means nothing.
#[test]
fn what_a_file_says_cannot_be_uncertain_as_well() {
    let content = "{\"bodies\": [{\"name\": \"ball\", \"at_mm\": [0, 0, 0]}]}";
    for (key, value) in [
        ("at_mm", "[{ normal = [0, 1] }, 0, 0]"),
        ("velocity_m_s", "['normal(0, 1)', 0, 0]"),
        ("spin_deg_s", "[0, 0, { uniform = [0, 9] }]"),
        ("turn_deg", "[0, 0, { uniform = [0, 9] }]"),
        ("any_turn", "true"),
        ("within", "{ ball = { radius_mm = 10 } }"),
    ] {
        let scenario = BALLS.replace("release_s = 0.5", &format!("{key} = {value}"));
        let error = read("end.json", content, &scenario).unwrap_err();
        assert!(error.contains(&format!("bodies[0].{key}")) && error.contains("leave it out"), "{key}: {error}");
    }
    // Numbers that are certain say what joints mean; the file says where bodies are.
    let fixed = BALLS.replace("release_s = 0.5", "at_mm = [0, 0, 700]\nvelocity_m_s = [3, 0, 0]");
    assert!(read("end.json", content, &fixed).is_ok());
}
