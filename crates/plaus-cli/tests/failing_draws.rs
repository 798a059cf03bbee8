//! Draws that fail end no run: `check`, `sample` and `diagnose` count them, and say what happened.

use crate::common::{Ended, Place};
use serde_json::Value;

/// A plate that comes down on an egg, to a height of its own.
const PRESS: &str = "
[sampler]
seed = 3
chains = 2
warmup = 60
iterations = 240
checkpoint_every = 50
[world.custom]
duration_s = 0.3
[[world.custom.fixed]]
name = 'floor'
shape = { plane = {} }
[[world.custom.bodies]]
name = 'egg'
shape = { ball = { radius_mm = 10 } }
at_mm = [{ normal = [0, 5] }, 0, 10]
[[world.custom.driven]]
name = 'plate'
shape = { box = { size_mm = [60, 60, 20] } }
keys = [{ at_s = 0, at_mm = [0, 0, 60] }, { at_s = 0.2, at_mm = [0, 0, { uniform = [20, 40] }] }]
[[require]]
touches = { body = 'egg', with = 'floor' }
";

#[test]
fn failed_draws_are_counted_and_told() {
    let place = Place::new();
    place.write("press.toml", PRESS);
    let why = ["draws failed, and have probability 0: plate crushes egg at 0.", " s: no way out"];
    let says = |ended: Ended| {
        let all = ended.out + &ended.err;
        assert!(why.iter().all(|part| all.contains(part)), "{all}");
    };
    says(place.ok("check press.toml"));
    says(place.ok("check press.toml --draws 40"));
    let json: Value = serde_json::from_str(&place.ok("check press.toml --draws 40 --json").out).unwrap();
    let number = |value: &Value, key: &str| value["failures"][key].as_u64().unwrap();
    // Half of the plates come down too far.
    assert_eq!(number(&json, "simulated"), 40);
    assert!((8..=32).contains(&number(&json, "failed")), "{json}");
    assert_eq!(json["failures"]["kinds"][0]["body"], "egg");
    for method in ["chain", "independent"] {
        let sample = format!("sample press.toml --set method={method} --out");
        says(place.run(&format!("{sample} {method}")));
        says(place.run(&format!("diagnose {method}")));
        let told =
            |run: &str| -> Value { serde_json::from_str(&place.run(&format!("diagnose {run} --json")).out).unwrap() };
        let whole = told(method);
        assert!(number(&whole, "failed") > 20 && number(&whole, "simulated") > 100, "{whole}");
        // In another number of threads, and in two parts.
        place.run(&format!("{sample} {method}-2 --threads 2 --set iterations=100 -q"));
        place.run(&format!("resume {method}-2 --iterations 240 -q"));
        assert_eq!(told(&format!("{method}-2"))["failures"], whole["failures"]);
    }
}
