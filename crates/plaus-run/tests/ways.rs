//! Runs by independent draws of the prior, and the trial that chooses between these and chains.

use crate::common::{all_draws, bytes_of, recipe};
use plaus_mcmc::{Control, Progress};
use plaus_run::disk::RealDisk;
use plaus_run::merge::{MergePulse, Merging, merge};
use plaus_run::{
    ChainPhase, Diagnosis, Error, Folder, Manifest, More, Recipe, Run, Sampling, Shard, Unwatched, Watch, resume,
    sample, sample_or_go_on, sample_shard,
};
use plaus_scenes::scenario::{explain, template};
use plaus_scenes::{Role, Scenario};

/// The small run with other keys.
fn with(solutions: Option<u64>, keys: &[&str]) -> Recipe {
    let small = recipe(solutions);
    let overrides: Vec<String> = keys.iter().map(|&key| key.to_owned()).collect();
    let scenario = Scenario::read("ball.toml", &small.text, &overrides).unwrap();
    Recipe { scenario, overrides, ..small }
}

fn sampled(place: &tempfile::TempDir, name: &str, recipe: &Recipe, threads: usize) -> (Folder, Manifest) {
    let folder = Folder::new(place.path().join(name));
    sample(&folder, recipe, Sampling::new(threads, &mut Unwatched)).unwrap();
    let manifest = Manifest::read(&folder).unwrap();
    (folder, manifest)
}

#[test]
fn the_key_explains_itself() {
    let doc = explain("sampler.method").unwrap();
    assert_eq!(doc.default, "unset");
    for word in ["chain", "independent", "auto"] {
        assert!(doc.range.contains(word) && doc.description.matches(word).count() > 0, "{doc:?}");
    }
    let text = template("ball2d").unwrap();
    let read = Scenario::read("new.toml", &text, &[]).unwrap();
    assert!(text.contains("method") && read.sampler.method.is_none());
    let problems = Scenario::read("new.toml", &text, &["method=best".to_owned()]).unwrap_err().problems;
    assert!(problems[0].message.contains("auto"), "{problems:?}");
}

/// Stops once, half-way.
struct Halfway;

impl Watch for Halfway {
    fn round(&mut self, progress: &Progress<'_>) -> Control {
        if progress.end_iteration >= 200 { Control::Stop } else { Control::Continue }
    }
}

const AUTO: &[&str] = &["method=auto", "sigma_d=3", "tolerance=3"];

#[test]
fn any_threads_pieces_and_stops_leave_the_same_bytes() {
    for (keys, solutions) in [(AUTO, None), (AUTO, Some(9)), (&["method=independent"], None)] {
        let place = tempfile::tempdir().unwrap();
        let recipe = with(solutions, keys);
        let (whole, manifest) = sampled(&place, "whole", &recipe, 1);
        assert!(manifest.is_independent() && manifest.exact && manifest.moves == ["draw_prior"], "{manifest:?}");
        let (more, _) = sampled(&place, "more", &recipe, 3);
        assert_eq!(bytes_of(&whole), bytes_of(&more));

        let halved = Folder::new(place.path().join("halved"));
        sample(&halved, &recipe, Sampling::new(2, &mut Halfway)).unwrap();
        resume(&halved, More::default(), Sampling::new(1, &mut Unwatched)).unwrap();
        assert_eq!(bytes_of(&whole), bytes_of(&halved));
        // If the very same run is asked for again, it is continued.
        sample_or_go_on(&halved, &recipe, None, Sampling::new(1, &mut Unwatched)).unwrap();
        assert_eq!(bytes_of(&whole), bytes_of(&halved));

        for shard in Shard::all(2) {
            let folder = Folder::new(place.path().join("pieces").join(shard.piece().to_string()));
            sample_shard(&folder, &recipe, Some(shard), Sampling::new(1, &mut Unwatched)).unwrap();
        }
        let merged = Folder::new(place.path().join("merged"));
        let merging = Merging { threads: 1, disk: &RealDisk, pulse: &MergePulse::default() };
        merge(&[place.path().join("pieces")], &merged, merging).unwrap();
        assert_eq!(bytes_of(&whole), bytes_of(&merged));
    }
}

/// Chains and independent draws have one law: their means agree within their errors. The wrong twin, the prior itself,
/// differs from both.
#[test]
fn both_ways_have_one_law() {
    let place = tempfile::tempdir().unwrap();
    let long = ["sigma_d=0.3", "tolerance=0.3", "iterations=40000", "thin=1", "checkpoint_every=40000", "warmup=1000"];
    let means = |name: &str, keys: &[&str]| {
        let (folder, _) = sampled(&place, name, &with(None, &[long.as_slice(), keys].concat()), 2);
        let diagnosis = Diagnosis::of(&Run::open(&folder).unwrap().reader().unwrap(), None).unwrap();
        let rows = diagnosis.scalars.iter().map(|row| row.summary.unwrap());
        (rows.map(|row| (row.mean, row.mcse_mean)).collect::<Vec<_>>(), diagnosis)
    };
    let (chain, _) = means("chain", &[]);
    let (alone, diagnosis) = means("alone", &["method=independent"]);
    let (prior, _) = means("prior", &["method=independent", "sigma_d=100"]);
    let gap = |one: &[(f64, f64)], other: &[(f64, f64)]| {
        let pairs = one.iter().zip(other);
        pairs.map(|(a, b)| (a.0 - b.0).abs() / (a.1 * a.1 + b.1 * b.1).sqrt()).fold(0.0, f64::max)
    };
    // The largest of a few: five standard errors are a false alarm in 10⁵.
    assert!(gap(&chain, &alone) < 5.0, "{chain:?} {alone:?}");
    assert!(gap(&prior, &alone) > 5.0 && gap(&prior, &chain) > 5.0, "{prior:?}");
    // Solutions are counted one by one; averages weight each solution by how long it is held.
    let found = diagnosis.independent.as_ref().unwrap();
    let counts = diagnosis.tally.counts[0];
    assert!(found.scalar.is_none() && found.ess < counts.accepted as f64, "{found:?} of {counts:?}");
    let held = diagnosis.scalars.iter().filter(|row| row.scalar.role == Role::Draw);
    let ess = held.map(|row| row.summary.unwrap().ess_bulk).fold(f64::INFINITY, f64::min);
    assert!((0.3..0.8).contains(&(ess / counts.accepted as f64)), "{ess} of {counts:?}");
    assert!(diagnosis.is_healthy(), "{:?}", diagnosis.findings);
}

#[test]
fn a_trial_chooses_the_way_that_costs_less() {
    let place = tempfile::tempdir().unwrap();
    let decided = |name: &str, solutions: Option<u64>, keys: &[&str]| {
        let recipe = with(solutions, &[&["method=auto", "iterations=20000"], keys].concat());
        sampled(&place, name, &recipe, 2).1
    };
    // If the prior rarely reaches the target, the trial chooses chains; if it often does, draws of the prior.
    let rare = decided("rare", None, &["sigma_d=0.0001", "tolerance=0.0001"]);
    let way = rare.way.as_ref().unwrap();
    assert!(!way.independent && way.why.starts_with("none of 1206 draws"), "{way:?}");
    assert!(rare.moves.len() > 1, "{:?}", rare.moves);
    let often = decided("often", None, &["sigma_d=3", "tolerance=3"]);
    assert!(often.is_independent(), "{:?}", often.way);
    // In between it depends on the chains, which are tried: moves with steps of a thousandth of a degree get nowhere.
    let between = ["sigma_d=0.04", "tolerance=0.05", "collisions=1", "sigma_theta_deg=20"];
    let quick = decided("quick", None, &between).way.unwrap();
    let slow = decided("slow", None, &[between.as_slice(), &["moves=paper", "step_deg=0.001"]].concat()).way.unwrap();
    assert!(quick.why.contains("a trial of chains") && slow.why.contains("a trial of chains"), "{quick:?} {slow:?}");
    assert!(!quick.independent && slow.independent, "{quick:?} {slow:?}");
    // If only a few solutions are asked for, there is no trial of chains.
    let few = decided("few", Some(3), &between).way.unwrap();
    assert!(!few.why.contains("while a trial of chains"), "{few:?}");
    assert!(decided("some", Some(3), &["sigma_d=3", "tolerance=3"]).is_independent());
    // If the scenario says how, the run reports no trial.
    assert!(sampled(&place, "silent", &with(None, &[]), 1).1.way.is_none());
}

/// A scenario that does not say how is decided by a trial, as if it had asked for one. Not so if it says how chains
/// should work.
#[test]
fn what_is_left_open_is_tried() {
    let place = tempfile::tempdir().unwrap();
    let open = |solutions, keys: &[&str]| {
        let said = with(solutions, &[&["sigma_d=3", "tolerance=3"], keys].concat());
        let text = said.text.replace("method = \"chain\"\n", "");
        let scenario = Scenario::read("ball.toml", &text, &said.overrides).unwrap();
        assert!(scenario.sampler.method.is_none());
        Recipe { scenario, text, ..said }
    };
    let (tried, manifest) = sampled(&place, "open", &open(None, &[]), 1);
    let (asked, _) = sampled(&place, "asked", &with(None, AUTO), 1);
    assert!(manifest.is_independent(), "{:?}", manifest.way);
    let records = |folder: &Folder| all_draws(&Run::open(folder).unwrap(), ChainPhase::Sampling).unwrap();
    assert_eq!(records(&tried), records(&asked));
    sample_or_go_on(&tried, &open(None, &[]), None, Sampling::new(1, &mut Unwatched)).unwrap();
    assert_eq!(records(&tried), records(&asked));
    for (name, recipe) in [
        ("adapts", open(None, &["adapt=false"])),
        ("printed", open(None, &["preset=as-printed"])),
        ("rungs", open(None, &["rungs=2"])),
    ] {
        assert!(sampled(&place, name, &recipe, 1).1.way.is_none(), "{name}");
    }
}

#[test]
fn a_tempered_run_cannot_draw_from_the_prior() {
    for method in ["independent", "auto"] {
        let overrides = [format!("method={method}"), "rungs=3".to_owned()];
        let problems = Scenario::read("ball.toml", &recipe(None).text, &overrides).unwrap_err().problems;
        assert!(problems[0].message.contains("tempering is only for chains"), "{problems:?}");
    }
    // A run with another method is another run.
    let place = tempfile::tempdir().unwrap();
    let (folder, _) = sampled(&place, "chain", &with(None, &["method=chain"]), 1);
    let other = with(None, &["method=independent"]);
    let refused = sample_or_go_on(&folder, &other, None, Sampling::new(1, &mut Unwatched));
    assert!(matches!(refused, Err(Error::File(_))), "{refused:?}");
}

/// Where draws of the prior succeed, a run that looks for some solutions makes these; else each solution has a climb of
/// its own: no climb finds two, whatever the number of threads. Only sampled ones count if that is asked for.
#[test]
fn each_solution_has_a_search_of_its_own() {
    let place = tempfile::tempdir().unwrap();
    let open = |keys: &[&str]| {
        let said = with(Some(6), keys);
        let text = said.text.replace("method = \"chain\"\n", "");
        let scenario = Scenario::read("ball.toml", &text, &said.overrides).unwrap();
        Recipe { scenario, text, ..said }
    };
    let often = sampled(&place, "often", &open(&["sigma_d=3", "tolerance=3"]), 1).1;
    assert!(often.is_independent() && !often.climbs(), "{:?}", often.way);
    let rare = ["sigma_d=0.001", "tolerance=0.001", "iterations=20000"];
    let (folder, manifest) = sampled(&place, "rare", &open(&rare), 1);
    let way = manifest.way.as_ref().unwrap();
    assert!(manifest.climbs() && way.climbs && way.why.contains("draws from the prior give"), "{way:?}");
    let run = Run::open(&folder).unwrap();
    let reader = run.reader().unwrap();
    let found = plaus_run::solutions::distinct(&reader).unwrap();
    assert_eq!(found.len(), 6);
    for chain in reader.chains() {
        let mut climbs = 0;
        let walked = reader.walk(chain, ChainPhase::Warmup, |repeats| -> Result<(), plaus_run::RunFileError> {
            // A state of a solution is recorded once: the next iteration begins anew.
            let is_solution = repeats.entry.class.is_some();
            assert!(!is_solution || repeats.draws == 1, "a climb went on from a solution");
            climbs += u32::from(is_solution);
            Ok(())
        });
        walked.unwrap();
        let own = found.iter().filter(|one| one.sample.chain == chain).count();
        assert!(own as u32 <= climbs, "{own} solutions in {climbs} climbs");
    }
    let records = |folder: &Folder| all_draws(&Run::open(folder).unwrap(), ChainPhase::Warmup).unwrap();
    let (other, _) = sampled(&place, "threads", &open(&rare), 4);
    assert_eq!(records(&folder), records(&other));
    let exact = open(&[rare.as_slice(), &["sampled_only=true"]].concat());
    let (_, manifest) = sampled(&place, "exact", &exact, 2);
    assert!(!manifest.climbs() && manifest.plan.counts_from() == manifest.plan.warmup, "{:?}", manifest.way);
}
