//! Weights of moves that a scene's chains learn do not depend on what the scene's memory happens to hold. A chain that
//! is interrupted anywhere in the warm-up, and continues without memory, learns the same bits.

use plaus_dist::Seed;
use plaus_mcmc::{Chain, Scales};
use plaus_scenes::{Scenario, Scene};

/// What a chain of a scenario has learnt at the end of its warm-up, with interruptions at `stops`.
fn learnt(file: &str, warmup: u64, stops: &[u64]) -> Scales {
    let path = format!("{}/../../scenarios/{file}", env!("CARGO_MANIFEST_DIR"));
    let scenario = Scenario::read(file, &std::fs::read_to_string(path).unwrap(), &[]).unwrap();
    let scene = scenario.stage().unwrap();
    let (moves, streams) = (scene.moves(&scenario.sampler.rules).unwrap(), || Seed(5).chain(0));
    let mut chain = Chain::start(&scene, &moves, streams()).unwrap().weighing(warmup);
    while chain.iteration() < warmup {
        let at = chain.iteration();
        if stops.contains(&at) {
            let (state, scales) = (chain.state().clone(), chain.scales().unwrap().clone());
            let counts = chain.counts().to_vec();
            chain = Chain::resume(&scene, &moves, streams(), at, state, counts).with_scales(scales);
        }
        chain.step().unwrap();
    }
    chain.scales().unwrap().clone()
}

#[test]
fn learnt_weights_do_not_depend_on_memory() {
    for (file, warmup) in [
        ("spelling-hi.toml", 400),
        ("dice-one.toml", 300),
        ("dice-six-together.toml", 24),
        ("bowling-spare-6-7.toml", 60),
        ("ball2d.toml", 400),
    ] {
        let stops: Vec<u64> = (1..warmup).filter(|at| at % 3 == 0 || at % 7 == 1).collect();
        let (whole, cut) = (learnt(file, warmup, &[]), learnt(file, warmup, &stops));
        assert_eq!(whole.probabilities(), cut.probabilities(), "{file}");
        assert!(whole == cut && whole.probabilities().is_some(), "{file}");
    }
}
