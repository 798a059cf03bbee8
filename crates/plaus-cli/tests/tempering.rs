//! Tempered runs: the same bytes on any number of threads, the report of restarts, and what is refused.

use crate::common::Place;
use serde_json::Value;

const RUNGS: &str = "--set rungs=4 --set swap_every=5";

#[test]
fn restarts_are_reported_and_threads_leave_no_trace() {
    let place = Place::new();
    let ended = place.run(&format!("sample ball.toml --out run1 --threads 1 {RUNGS}"));
    assert!(ended.err.contains("4 chains, 4 rungs each of 900 iterations"), "{}", ended.err);
    assert!(ended.out.contains("tempering: ") && ended.out.contains(" restarts from fresh draws, "), "{}", ended.out);
    for threads in [2, 3] {
        place.run(&format!("sample ball.toml --out run{threads} -q --threads {threads} {RUNGS}"));
        assert_eq!(place.bytes(&format!("run{threads}")), place.bytes("run1"));
    }
    let json: Value = serde_json::from_str(&place.run("diagnose run1 --json").out).unwrap();
    for chain in json["chains"].as_array().unwrap() {
        let (one, betas) = (&chain["tempering"], chain["tempering"]["betas"].as_array().unwrap());
        assert!(one["restarts"].as_u64().unwrap() > 0 && one["round_trips"].as_u64().unwrap() > 0, "{one}");
        assert_eq!((betas.len(), betas[0].as_f64(), betas[3].as_f64()), (4, Some(0.0), Some(1.0)));
        let rejected: f64 = one["rejected"].as_array().unwrap().iter().map(|share| share.as_f64().unwrap()).sum();
        assert!((rejected - one["barrier"].as_f64().unwrap()).abs() < 1e-12);
    }

    // Stopped and continued, in parts whose lengths are no multiples of the swap interval.
    place.run(&format!("sample ball.toml --out short -q {RUNGS} --iterations 333"));
    place.run("resume short -q --iterations 900");
    let table = |run: &str| {
        place.ok(&format!("export {run} --format csv --out {run}.csv"));
        std::fs::read(place.path(&format!("{run}.csv"))).unwrap()
    };
    assert_eq!(table("short"), table("run1"));
    place.ok("replay run1 --sample 2:777");
}

#[test]
fn a_ladder_chooses_its_rungs_and_keeps_them() {
    let place = Place::new();
    let sizing = format!("{RUNGS} --set adapt_rungs=true");
    place.run(&format!("sample ball.toml --out whole -q --threads 1 {sizing}"));
    place.run(&format!("sample ball.toml --out parts -q --threads 3 {sizing} --iterations 250"));
    place.run("resume parts -q --iterations 900");
    let tempering = |run: &str| {
        let json: Value = serde_json::from_str(&place.run(&format!("diagnose {run} --json")).out).unwrap();
        json["chains"].as_array().unwrap().iter().map(|chain| chain["tempering"].clone()).collect::<Vec<_>>()
    };
    assert_eq!(tempering("whole"), tempering("parts"));
    let sizes: Vec<_> = tempering("whole").iter().map(|one| one["betas"].as_array().unwrap().len()).collect();
    assert!(sizes.iter().any(|&size| size != 4), "{sizes:?}");
    place.ok("replay parts --sample 2:777");
}

#[test]
fn runs_that_cannot_be_tempered_are_refused() {
    let place = Place::new();
    place
        .ends("sample ball.toml --out run --set rungs=300", 2)
        .says(&["300 is out of range: it must be from 1 to 256"]);
    place.ends("sample ball.toml --out run --set swap_every=0", 2).says(&["swap_every", "from 1 to 1_000_000"]);
    for tempered in ["rungs=4", "adapt_rungs=true"] {
        let printed = format!("sample ball.toml --out run --set {tempered} --set sampler.rules.preset=as-printed");
        place.ends(&printed, 2).says(&["tempering needs exact acceptance"]);
    }
    assert!(!place.path("run").exists());
}
