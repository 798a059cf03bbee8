//! Scales adapted in the warm-up: `plaus diagnose` shows them, and `adapt` is a key like any other.

use crate::common::Place;
use serde_json::Value;

#[test]
fn scales_are_shown_and_kept() {
    let place = Place::new();
    let said = |run: &str| place.run(&format!("diagnose {run}")).out;
    let scales = |run: &str| {
        let json: Value = serde_json::from_str(&place.run(&format!("diagnose {run} --json")).out).unwrap();
        json["chains"].as_array().unwrap().iter().map(|chain| chain["scales"].clone()).collect::<Vec<_>>()
    };
    place.run("sample ball.toml --out adapted -q --warmup 800 --set adapt=true");
    let table = said("adapted");
    assert!(table.contains("scales, kept since the warm-up") && table.contains("perturb step"), "{table}");
    let kept = scales("adapted");
    for chain in &kept {
        let one = &chain[0];
        assert_eq!((one["move"].as_str(), one["scale"].as_str()), (Some("perturb"), Some("step")));
        assert!(one["frozen"].as_bool().unwrap() && one["value"].as_f64().unwrap() > 0.0, "{one}");
        assert!(one["tried"].as_u64().unwrap() >= one["accepted"].as_u64().unwrap());
    }
    place.run("resume adapted -q --iterations 1500");
    let values = |all: &[Value]| all.iter().map(|chain| chain[0]["value"].clone()).collect::<Vec<_>>();
    assert_eq!(values(&scales("adapted")), values(&kept), "a longer run keeps them");

    // Its warm-up is shorter than asked for unless told not to be; what follows has the planned length.
    let learnt_in = |run: &str| {
        let json: Value = serde_json::from_str(&place.run(&format!("diagnose {run} --json")).out).unwrap();
        let all = json["chains"].as_array().unwrap().iter().map(|chain| chain["learnt_in"].as_u64());
        (all.collect::<Vec<_>>(), json["iterations"].as_u64().unwrap())
    };
    place.run("sample ball.toml --out settled -q --warmup 8000 --set adapt=true");
    place.run("sample ball.toml --out whole -q --warmup 8000 --set adapt=true --set settle=false");
    let ((settled, iterations), (whole, as_many)) = (learnt_in("settled"), learnt_in("whole"));
    let ends = [500, 1000, 2000, 4000];
    assert!(settled.iter().all(|until| ends.contains(&until.unwrap())), "{settled:?}");
    assert!(whole.iter().all(|until| *until == Some(8000)) && iterations == as_many, "{whole:?}");
    assert!(said("whole").contains("kept since the warm-up of 8,000"), "{}", said("whole"));

    // After too short a warm-up moves stay as configured. Balls adapt nothing unless told to.
    place.run("sample ball.toml --out short -q --warmup 5 --set adapt=true");
    assert!(said("short").contains("as configured"));
    place.run("sample ball.toml --out plain -q --warmup 800");
    assert!(!said("plain").contains("scales") && scales("plain").iter().all(|one| one.as_array().unwrap().is_empty()));
    assert!(!said("plain").contains("learnt weight"));
    place.run("sample ball.toml --out weighed -q --warmup 800 --set adapt=true --set adapt_weights=true");
    assert!(said("weighed").contains("learnt weight"));
    let json: Value = serde_json::from_str(&place.run("diagnose weighed --json").out).unwrap();
    for chain in json["chains"].as_array().unwrap() {
        let sum: f64 = chain["weights"].as_array().unwrap().iter().map(|one| one.as_f64().unwrap()).sum();
        assert!((sum - 1.0).abs() < 1e-12, "{chain}");
    }
    place.ends("sample ball.toml --out bad --set adapt=often", 2).says(&["--set adapt=often", "true or false"]);
}
