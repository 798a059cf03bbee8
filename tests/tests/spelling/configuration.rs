//! Configurations that describe no world are refused, with the limit; optional settings work.

use super::straight::scene;
use plaus_mcmc::{Chain, Goal, State};
use plaus_scenes::spelling::{Count, Drops, Order, Rest, Spelling, Work};
use plaus_scenes::{Rules, Scenario, Scene, World};

fn refused(overrides: &[&str], said: &[&str]) {
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    let error = Scenario::read("word.toml", "[world.spelling]", &overrides).unwrap_err().to_string();
    for part in said {
        assert!(error.contains(part), "{error}\nlacks: {part}");
    }
}

#[test]
fn errors_name_the_key_and_the_limit() {
    refused(&["text=HELLO", "columns=10"], &["world.spelling.columns", "10 columns are too few", "17 bins wide"]);
    refused(&["rows=2"], &["world.spelling.rows", "2 rows are too few", "3 bins high"]);
    refused(&["text=Ω"], &["world.spelling.text", "lacks 'Ω'", "A to Z"]);
    refused(&["text=\"\""], &["world.spelling.text", "there must be at least one"]);
    refused(&["text=HI", "bitmap=\"#.#\""], &["world.spelling.text", "there is a `bitmap` too"]);
    refused(&["balls=36"], &["world.spelling.balls", "36 balls are more than the 35 bins"]);
    refused(&["balls=9"], &["world.spelling.balls", "9 balls cannot fill 10 bins"]);
    refused(&["ball_radius_mm=8.3"], &["world.spelling.ball_radius_mm", "does not fit a bin", "at most 8.200 mm"]);
    refused(&["box.partition_mm=10"], &["world.spelling.ball_radius_mm", "at most 4.200 mm"]);
    refused(&["drop_height_mm=18"], &["world.spelling.drop_height_mm", "more than 18.800 mm"]);
    refused(&["drop_interval_s=0.04"], &["world.spelling.drop_interval_s", "0.0495 s"]);
    refused(&["sigma_mm=0.5", "box.partition_mm=1"], &["world.spelling.sigma_mm", "0.25 mm"]);
    refused(&["drop_inset_mm=50"], &["world.spelling.drop_inset_mm", "less than 43.000 mm"]);
    refused(&["box.floor_radius_mm=14"], &["world.spelling.box.floor_radius_mm", "more than 14.142 mm"]);
    refused(
        &[
            "weights={change_all=0,change_vertices=0,redraw_vertices=0,change_ball=0,toggle=0,redrop=0,birth_death=0,swap=0}",
        ],
        &["world.spelling.weights"],
    );
}

#[test]
fn the_paper_s_scenarios_are_the_paper_s() {
    let read = |text: &str| match Scenario::read("scenario", text, &[]).unwrap().world {
        World::Spelling(config) => Spelling::new(&config).unwrap(),
        other => panic!("{other:?}"),
    };
    let hi = read(include_str!("../../../scenarios/spelling-hi.toml"));
    let size = |scene: &Spelling| (scene.word().columns(), scene.word().rows(), scene.balls());
    assert_eq!((hi.ln_lambda(), size(&hi)), (5.0, (7, 5, 10)));
    let acm = read(include_str!("../../../scenarios/spelling-acm.toml"));
    assert_eq!((acm.ln_lambda(), size(&acm)), (7.25, (15, 7, 30)));
}

#[test]
fn any_word_is_spelled() {
    // As the file itself suggests: none of its settings are for its own word only.
    for text in ["A", "hello"] {
        let file = include_str!("../../../scenarios/spelling-hi.toml");
        let scenario = Scenario::read("spelling-hi.toml", file, &[format!("text={text}")]).unwrap();
        let World::Spelling(config) = scenario.world else { panic!("another scene") };
        let scene = Spelling::new(&config).unwrap();
        let moves = scene.moves(&Rules::exact()).unwrap();
        let mut chain = Chain::start(&scene, &moves, plaus_dist::Seed(2).chain(0)).unwrap();
        let full = (0..10_000).any(|_| {
            chain.step().unwrap();
            scene.class(chain.state().by_ref()).is_some()
        });
        assert!(full, "{text} was not spelled in 10,000 iterations");
    }
}

#[test]
fn two_balls_in_a_bin_count_once_or_twice() {
    let rest = Rest { bins: vec![Some(8), Some(8), Some(10), Some(0), None], complete: true, failed: None };
    let count = |count| scene(|config| config.count = count).reward(&rest);
    assert_eq!((count(Count::Bins), count(Count::Balls)), (2, 3));
}

#[test]
fn balls_fall_in_their_slots_or_without_gaps() {
    let ends = |order| {
        let scene = scene(|config| (config.order, config.balls_touch) = (order, false));
        let mut balls = vec![None; 10];
        balls[4] = Some([30.0, 30.0]);
        let draw = Drops { offsets: vec![[0.0; 3]; 48], balls };
        scene.animate(&draw).unwrap().motion.tracks[0].pieces[0].start
    };
    assert_eq!((ends(Order::Slots), ends(Order::Queue)), (0.4, 0.0));
}

/// If balls do not touch each other, two that are dropped at one place come to rest in one bin.
#[test]
fn balls_that_do_not_touch_fall_as_if_alone() {
    let scene = scene(|config| config.balls_touch = false);
    let mut balls = vec![None; 10];
    (balls[0], balls[1]) = (Some([33.0, 52.0]), Some([33.0, 52.0]));
    let draw = Drops { offsets: vec![[0.0; 3]; 48], balls };
    let state = State::evaluate(&scene, draw, &mut Work::default()).unwrap();
    assert!(state.outcome.bins[0].is_some() && state.outcome.bins[0] == state.outcome.bins[1]);
}
