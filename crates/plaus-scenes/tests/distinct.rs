//! Solutions that differ in kind: by the same means in all scenes, and farther apart where `distinct_scale` says so.

use plaus_dist::Seed;
use plaus_mcmc::{Chain, Goal, SolutionClass};
use plaus_scenes::{Scenario, Scene, Stage};
use std::collections::{BTreeMap, BTreeSet};

fn stage(text: &str, scale: &str) -> (Stage, Scenario) {
    let scenario = Scenario::read("inline", &format!("[sampler]\n{scale}\n{text}"), &[]).unwrap();
    (scenario.stage().unwrap(), scenario)
}

/// The classes of the solutions of a chain, as each of some stages has them. The states are the same for all.
fn classes(text: &str, scales: &[&str], iterations: u64) -> Vec<Vec<SolutionClass>> {
    let stages: Vec<Stage> = scales.iter().map(|scale| stage(text, scale).0).collect();
    let (walked, scenario) = stage(text, "");
    let moves = walked.moves(&scenario.sampler.rules).unwrap();
    let mut chain = Chain::start(&walked, &moves, Seed(2).chain(0)).unwrap();
    let mut found = vec![Vec::new(); scales.len()];
    for _ in 0..iterations {
        chain.step().unwrap();
        for (stage, found) in stages.iter().zip(&mut found) {
            found.extend(stage.class(chain.state().by_ref()));
        }
    }
    found
}

fn kinds(classes: &[SolutionClass]) -> usize {
    classes.iter().collect::<BTreeSet<_>>().len()
}

#[test]
fn a_larger_scale_tells_fewer_kinds_apart() {
    let ball = "[world.ball2d]\nsigma_d = 1.0\ntolerance = 1.0";
    let own = "[world.custom]\nduration_s = 2\n[[world.custom.bodies]]\nname = 'ball'\nshape = { ball = { radius_mm = 12 } }\n\
               at_mm = [{ uniform = [-400, 400] }, 0, 100]";
    for (text, iterations) in [(ball, 3000), (own, 200)] {
        let scales = ["", "distinct_scale = 1.0", "distinct_scale = 4.0", "distinct_scale = 0.25"];
        let found = classes(text, &scales, iterations);
        assert!(
            found.iter().all(|classes| classes.len() == found[0].len()),
            "what is a solution does not depend on it"
        );
        assert!(found[0] == found[1], "1 is the default");
        let [usual, coarse, fine] = [0, 2, 3].map(|k| kinds(&found[k]));
        assert!(1 < coarse && coarse < usual && usual < fine, "{coarse} {usual} {fine}: {text}");
        // Cells four times as wide are made of whole cells: what was one kind stays one.
        let mut coarse_of = BTreeMap::new();
        for (one, wide) in found[0].iter().zip(&found[2]) {
            assert_eq!(coarse_of.entry(one).or_insert(wide), &wide, "{text}");
        }
    }
}

/// Bins and pins are counted: no scale makes two of them one.
#[test]
fn what_is_counted_has_no_scale() {
    let text = "[world.spelling]\ntext = 'I'\nln_lambda = 3.0";
    let found = classes(text, &["", "distinct_scale = 100.0"], 2000);
    assert!(found[0] == found[1] && kinds(&found[0]) > 1, "{} kinds", kinds(&found[0]));
}

#[test]
fn a_scale_must_be_a_width() {
    for scale in ["0", "-1", "nan", "1e9", "'wide'"] {
        let text = format!("[sampler]\ndistinct_scale = {scale}\n[world.ball2d]");
        let error = Scenario::read("inline", &text, &[]).unwrap_err().to_string();
        assert!(error.contains("distinct_scale"), "{error}");
    }
}
