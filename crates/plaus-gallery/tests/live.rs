//! Chains that go on from a run, and what a page keeps of what they find.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use plaus_dist::Seed;
use plaus_gallery::live::{Keeper, Live, Sampler, Saved, World};
use plaus_mcmc::{Plan, Snapshot, State};
use plaus_scenes::Scenario;

const BALL: &str = "[world.ball2d]\ncollisions = 3\nsigma_d = 0.05";

fn live() -> Live {
    let scenario = Scenario::read("inline", BALL, &[]).unwrap();
    let plan = Plan {
        seed: Seed(5),
        chains: 2,
        warmup: 0,
        iterations: 1000,
        thin: 1,
        block: 100,
        solutions: None,
        rungs: 1,
        swap_every: 1,
        adapt_rungs: false,
        adapt: false,
        weigh: false,
        settle: false,
        climbs: 0,
        sampled: false,
    };
    let world = World::of(&scenario).unwrap();
    Live { world, plan, independent: false, until: "rest".into(), chains: Vec::new(), shown: Vec::new() }
}

#[test]
fn how_a_chain_is_cut_changes_nothing() {
    let [mut whole, mut cut] = [live(), live()].map(|live| Sampler::new(live, 3).unwrap());
    while whole.iterations() < 2000 {
        whole.advance(2000 - whole.iterations()).unwrap();
    }
    while cut.iterations() < 2000 {
        cut.advance(37.min(2000 - cut.iterations())).unwrap();
    }
    let text = |sampler: &Sampler| serde_json::to_string(&sampler.state()).unwrap();
    assert_eq!(text(&whole), text(&cut));
}

#[test]
fn chains_go_on_with_numbers_of_their_own() {
    assert!(Sampler::new(live(), 1).is_err_and(|error| error.contains("already")));
    let mut run = Sampler::new(live(), 2).unwrap();
    run.advance(500).unwrap();
    let at = run.state().unwrap();
    // A run whose one chain is there.
    let scenario = Scenario::read("inline", BALL, &[]).unwrap();
    let stage = scenario.stage().unwrap();
    let state = at.state(&stage).unwrap();
    let snapshot = |end_iteration| Snapshot {
        end_iteration,
        state: State {
            draw: state.draw.clone(),
            outcome: (),
            log_prior: state.log_prior,
            log_constraint: state.log_constraint,
        },
        counts: vec![
            Default::default();
            plaus_scenes::Scene::moves(&stage, &scenario.sampler.rules).unwrap().names().len()
        ],
        scales: None,
        failures: Default::default(),
        hits: Default::default(),
        pending: (0, None),
        replicas: None,
    };
    let went = |chain| {
        let live = Live { chains: vec![snapshot(501)], ..live() };
        // As a page holds it.
        let live = Live::read(&serde_json::to_vec(&live).unwrap()).unwrap();
        let mut sampler = Sampler::new(live, chain).unwrap();
        sampler.advance(1).unwrap();
        assert!(sampler.iterations() > 501);
        sampler.advance(300).unwrap();
        serde_json::to_string(&sampler.state().unwrap().draw).unwrap()
    };
    assert_eq!(went(2), went(2));
    assert_ne!(went(2), went(3));
}

#[test]
fn what_is_found_is_kept_saved_and_rebuilt() {
    let (mut sampler, mut keeper) = (Sampler::new(live(), 2).unwrap(), Keeper::new(live()).unwrap());
    let mut added = 0;
    for _ in 0..40 {
        for found in sampler.advance(500).unwrap() {
            let again = serde_json::from_value(serde_json::to_value(&found).unwrap()).unwrap();
            added += usize::from(keeper.add(found).unwrap().is_some());
            assert!(keeper.add(again).unwrap().is_none(), "a solution is added twice");
        }
    }
    assert!(added >= 2, "{added}");
    let saved = Saved::read(&keeper.saved()).unwrap();
    assert_eq!(saved.draws.len(), added);
    let stage = saved.world.scenario().unwrap().stage().unwrap();
    for found in &saved.draws {
        assert!(std::ptr::eq(saved.draw(&found.id()).unwrap(), found));
        found.state(&stage).unwrap();
    }
    // Another number is another draw.
    let mut other: serde_json::Value = serde_json::from_str(&keeper.saved()).unwrap();
    other["draws"][0]["log_prior"] = 1.into();
    let other = Saved::read(&other.to_string()).unwrap();
    assert!(other.draws[0].state(&stage).is_err_and(|error| error.contains("another state")));
    assert!(Saved::read(&keeper.saved().replace("plaus draws 1", "plaus draws 0")).is_err());
    // A chain that begins at a solution.
    let draw = serde_json::from_value(keeper.draw(0).unwrap()).unwrap();
    sampler.begin_at(draw, 9).unwrap();
    sampler.advance(100).unwrap();
    assert!(sampler.state().unwrap().chain == 9 && keeper.draw(added).is_none());
}
