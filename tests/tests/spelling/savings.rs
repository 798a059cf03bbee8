//! Work that a simulation saves changes no bit.

use super::straight::scene;
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::check::early_exit;
use plaus_mcmc::{Chain, Target};
use plaus_scenes::spelling::{Letters, Savings, Spelling, Weights};
use plaus_scenes::{Rules, Scene};
use std::sync::Arc;

fn agrees_with_its_twin(scene: &Spelling, seed: u64, iterations: u64) {
    let moves = Arc::new(scene.moves(&Rules::exact()).unwrap());
    let report = early_exit(scene, moves, Seed(seed), iterations).unwrap();
    assert!(report.passed(), "{report}");
    assert!(report.stopped_early > 0, "no early stop was tested: {report}");
}

/// Compared with a twin that simulates every candidate from scratch: the same decisions, the same states. (100,000
/// iterations of both scenarios: `spelling_twin`.)
#[test]
fn a_chain_has_the_bits_of_its_plain_twin() {
    agrees_with_its_twin(&scene(|_| ()), 1, 1000);
    // Vertices move in every other iteration.
    let often = |config: &mut plaus_scenes::spelling::Config| {
        config.weights = Weights::default().with("change_vertices", 1.0);
        config.sigma_mm = 0.3;
    };
    agrees_with_its_twin(&scene(often), 2, 500);
    agrees_with_its_twin(&scene(|config| (config.text, config.letters) = (Some("ACM".into()), Letters::Tall)), 3, 100);
}

#[test]
fn what_a_chain_remembers_does_not_matter() {
    let scene = scene(|_| ());
    let moves = scene.moves(&Rules::exact()).unwrap();
    let mut chain = Chain::start(&scene, &moves, Seed(4).chain(0)).unwrap();
    (0..300).for_each(|_| {
        chain.step().unwrap();
    });
    // A chain that is resumed here remembers nothing about its current state.
    let counts = chain.counts().to_vec();
    let mut resumed = Chain::resume(&scene, &moves, Seed(4).chain(0), chain.iteration(), chain.state().clone(), counts);
    for _ in 0..300 {
        assert_eq!(chain.step().unwrap(), resumed.step().unwrap());
        assert_eq!(chain.state(), resumed.state());
    }
}

#[test]
fn switching_savings_off_leaves_the_chain_unchanged() {
    let walk = |savings| {
        let scene = scene(|_| ()).with_savings(savings);
        let moves = scene.moves(&Rules::exact()).unwrap();
        let mut chain = Chain::start(&scene, &moves, Seed(6).chain(0)).unwrap();
        let mut states = Vec::new();
        for _ in 0..150 {
            chain.step().unwrap();
            states.push(chain.state().clone());
        }
        states
    };
    let all = walk(Savings::ALL);
    for savings in [Savings::NONE, Savings { bound: false, ..Savings::ALL }, Savings { reuse: false, ..Savings::ALL }] {
        assert!(walk(savings) == all, "{savings:?}");
    }
}

/// Every ball that a draw drops ends in a bin, on a partition or on another ball, and is animated until then.
#[test]
fn animations_end_where_the_outcome_says() {
    let scene = scene(|_| ());
    let mut stream = Seed(9).chain(0).at(0, Purpose::START);
    for _ in 0..20 {
        let draw = scene.start(&mut stream);
        let state =
            plaus_mcmc::State::evaluate(&scene, draw.clone(), &mut <Spelling as Target>::Scratch::default()).unwrap();
        let animation = scene.animate(&draw).unwrap();
        assert_eq!(animation.motion.tracks.len(), draw.active());
        for track in &animation.motion.tracks {
            let ball: usize = track.name.strip_prefix("ball_").unwrap().parse().unwrap();
            let [x, y] = draw.balls[ball].unwrap();
            let start = track.position(0.0);
            let expected = [x * 1e-3, 0.072, -y * 1e-3];
            assert!(start.to_array().iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{start} {expected:?}");
            let end = track.position(animation.motion.duration);
            if let Some(bin) = state.outcome.bins[ball] {
                let cell = scene.over(bin).unwrap();
                let at = [end.x * 1e3, -end.z * 1e3];
                assert!((0..2).all(|k| cell[k][0] - 7.0 <= at[k] && at[k] <= cell[k][1] + 7.0), "{at:?} {cell:?}");
                assert!(end.y < 0.012, "{end}");
            }
        }
        assert!(animation.motion.impacts.is_sorted_by(|a, b| a.time <= b.time));
    }
}
