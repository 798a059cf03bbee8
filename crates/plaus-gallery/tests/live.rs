//! Chains that go on from a run, and what a page keeps of what they find.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use plaus_dist::Seed;
use plaus_gallery::live::{Edit, Keeper, Live, Sampler, Saved, World, begun, problems};
use plaus_mcmc::{Plan, Snapshot, State};
use plaus_scenes::{Scenario, Until};
use serde_json::json;

const BALL: &str = "[world.ball2d]\ncollisions = 3\nsigma_d = 0.05";

fn live() -> Live {
    let scenario = Scenario::read("inline", BALL, &[]).unwrap();
    let plan =
        Plan { seed: Seed(5), chains: 2, warmup: 0, iterations: 1000, block: 100, adapt: false, ..scenario.plan() };
    let plan = Plan { settle: false, ..plan };
    let world = World::of(&scenario).unwrap();
    Live {
        world,
        plan,
        independent: false,
        until: Until::Rest.into(),
        chains: serde_json::json!([]),
        shown: Vec::new(),
        known: Vec::new(),
    }
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
        let live = Live { chains: serde_json::to_value([snapshot(501)]).unwrap(), ..live() };
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

fn edits(at: &str, value: serde_json::Value) -> Vec<Edit> {
    Edit::read(json!([{"at": at, "value": value}]).to_string().as_bytes()).unwrap()
}

#[test]
fn other_values_are_sampled_from_the_states_known() {
    let (mut sampler, mut keeper) = (Sampler::new(live(), 2).unwrap(), Keeper::new(live()).unwrap());
    for found in (0..20).flat_map(|_| sampler.advance(500).unwrap()) {
        keeper.add(found).unwrap();
    }
    let count = (0..).find(|&number| keeper.draw(number).is_none()).unwrap();
    assert!(count >= 2, "{count}");
    let draws: Vec<_> = (0..count).map(|number| keeper.draw(number).unwrap()).collect();
    let changed = keeper.edited(edits("/world/ball2d/target", json!(1.25))).unwrap();
    assert!(changed.shown.is_empty() && !changed.known.is_empty());
    let scenario = changed.world.scenario().unwrap();
    let other = Scenario::read("inline", &format!("{BALL}\ntarget = 1.25"), &[]).unwrap();
    assert_eq!(scenario, other);
    // They are draws of the page, the most likely first.
    let stage = scenario.stage().unwrap();
    let evaluate = |draw: &plaus_scenes::AnyDraw| {
        State::evaluate(&stage, draw.clone(), &mut Default::default()).unwrap().log_p().value()
    };
    let likely: Vec<f64> = changed.known.iter().map(evaluate).collect();
    assert!(likely.is_sorted_by(|a, b| a >= b), "{likely:?}");
    for draw in &changed.known {
        assert!(draws.contains(&serde_json::to_value(draw).unwrap()));
    }
    // A chain begins at one, and finds solutions of the new scenario.
    let text = serde_json::to_vec(&changed).unwrap();
    let mut sampler = Sampler::new(Live::read(&text).unwrap(), 3).unwrap();
    assert_eq!(
        serde_json::to_value(&sampler.state().unwrap().draw).unwrap(),
        serde_json::to_value(&changed.known[1 % changed.known.len()]).unwrap()
    );
    let mut keeper = Keeper::new(changed).unwrap();
    let found: Vec<_> = (0..40).flat_map(|_| sampler.advance(500).unwrap()).collect();
    assert!(!found.is_empty());
    for one in found {
        one.state(&stage).unwrap();
        keeper.add(one).unwrap();
    }
    assert_eq!(keeper.about()["scenario"]["world"]["ball2d"]["target"], 1.25);
}

#[test]
fn values_that_are_wrong_are_refused() {
    let keeper = Keeper::new(live()).unwrap();
    let refused = |at: &str, value| {
        let told = problems(&keeper.edited(edits(at, value)).unwrap_err());
        (told[0]["key"].as_str().unwrap().to_owned(), told[0]["message"].as_str().unwrap().to_owned())
    };
    for (value, part) in [(json!(1e7), "out of range"), (json!("left"), "expected a number"), (json!([1]), "a list")] {
        let (key, message) = refused("/world/ball2d/target", value);
        assert!(key == "world.ball2d.target" && message.contains(part), "{key}: {message}");
    }
    let (key, message) = refused("/world/ball2d/collisions", json!(0.5));
    assert!(key == "world.ball2d.collisions" && message.contains("expected an integer"), "{key}: {message}");
}

#[test]
fn draws_are_carried_to_a_world_with_other_variables() {
    let (mut sampler, mut keeper) = (Sampler::new(live(), 2).unwrap(), Keeper::new(live()).unwrap());
    for found in (0..20).flat_map(|_| sampler.advance(500).unwrap()) {
        keeper.add(found).unwrap();
    }
    // One collision more, and one less, than draws have.
    for collisions in [4, 2] {
        let changed = keeper.edited(edits("/world/ball2d/collisions", json!(collisions))).unwrap();
        assert!(!changed.known.is_empty());
        for draw in &changed.known {
            assert_eq!(serde_json::to_string(draw).unwrap().matches(',').count() + 1, collisions);
        }
        let chain = changed.plan.chains;
        Sampler::new(changed, chain).unwrap().advance(100).unwrap();
    }
}

#[test]
fn a_text_is_sampled_without_a_run() {
    let chained = format!("[sampler]\nmethod = \"chain\"\nwarmup = 50\n{BALL}");
    // As the scenario says, and by climbs where it does not say.
    for (text, climbs) in [(chained.as_str(), false), (BALL, true)] {
        let live = begun("mine", text, Vec::new()).unwrap();
        assert_eq!(live.plan.climbs > 0, climbs);
        let chain = live.plan.chains;
        let mut keeper = Keeper::new(begun("mine", text, Vec::new()).unwrap()).unwrap();
        let mut sampler = Sampler::new(live, chain).unwrap();
        let found: Vec<_> = (0..40).flat_map(|_| sampler.advance(500).unwrap()).collect();
        assert!(!found.is_empty(), "{text}");
        assert!(found.into_iter().any(|one| keeper.add(one).unwrap().is_some()));
    }
    let told = problems(&begun("mine", "[world.ball2d]\nsigma_d = -1\ncolisions = 3", Vec::new()).unwrap_err());
    assert_eq!(told[0]["line"], 2);
    assert!(told[0]["message"].as_str().unwrap().contains("out of range"));
    assert_eq!((&told[1]["line"], &told[1]["column"]), (&json!(3), &json!(1)));
    assert!(told[1]["message"].as_str().unwrap().contains("did you mean `collisions`?"));
}
