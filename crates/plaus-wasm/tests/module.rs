//! The committed module, run by Node.js, makes the same draws as this machine, bit for bit.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use plaus_dist::Seed;
use plaus_gallery::live::{Keeper, Live, Sampler, World};
use plaus_mcmc::Plan;
use plaus_scenes::{Scenario, Until};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;

/// A scenario, its iterations in each of two steps, and whether draws are independent.
const CASES: &[(&str, u32, bool)] = &[
    ("ball2d", 3000, false),
    ("bowling-strike", 40, false),
    ("bowling-spare-6-7", 20, true),
    ("dice-one", 100, false),
    ("dice-six-together", 10, false),
    ("spelling-hi", 100, false),
    ("worlds/billiards", 10, false),
    ("worlds/boxes", 60, false),
    ("worlds/coin-heads", 30, true),
    ("worlds/dominoes-stop", 4, false),
    ("worlds/kick", 20, false),
    ("worlds/lever", 10, false),
    ("worlds/marble-run", 20, false),
    ("worlds/plinko", 20, true),
    ("worlds/rubble", 2, false),
    ("worlds/stack", 20, true),
    ("worlds/toys", 2, false),
    ("worlds/trick-shot", 100, false),
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn live(name: &str, independent: bool) -> Live {
    let path = root().join(format!("scenarios/{name}.toml"));
    let folder = path.parent().unwrap().to_owned();
    let files = move |file: &str, _: bool| -> Result<Arc<[u8]>, String> {
        std::fs::read(folder.join(file)).map(Into::into).map_err(|error| error.to_string())
    };
    let scenario = Scenario::read_with(name, &std::fs::read_to_string(&path).unwrap(), &[], &files).unwrap();
    let adapt = scenario.adapts() && !independent;
    let plan =
        Plan { seed: Seed(7), chains: 2, warmup: 500, iterations: 1000, thin: 1, block: 64, adapt, ..scenario.plan() };
    let plan = Plan { weigh: false, settle: false, ..plan };
    let (world, until) = (World::of(&scenario).unwrap(), Until::Rest.into());
    Live { world, plan, independent, until, chains: serde_json::json!([]), shown: Vec::new(), known: Vec::new() }
}

/// What a sampler finds, and where it is in the end; and what a keeper makes of what it found.
fn native(text: &[u8], iterations: u32) -> String {
    let mut sampler = Sampler::new(Live::read(text).unwrap(), 2).unwrap();
    let mut keeper = Keeper::new(Live::read(text).unwrap()).unwrap();
    let mut told = String::new();
    for _ in 0..2 {
        let found = sampler.advance(u64::from(iterations)).unwrap();
        told += &format!("{} {}\n", found.len(), serde_json::to_string(&sampler.state()).unwrap());
        for one in found.into_iter().take(2) {
            told += &format!("{}\n", serde_json::to_string(&one).unwrap());
            let added = keeper.add(one).unwrap().unwrap_or_default();
            // A sum that changes with each byte and its place.
            let sum = added.iter().fold(7_u32, |sum, &byte| sum.wrapping_mul(31).wrapping_add(u32::from(byte)));
            told += &format!("{} {sum}\n", added.len());
        }
    }
    told
}

#[test]
#[ignore = "needs Node.js: `cargo xtask clients` runs it"]
fn the_module_makes_the_same_draws() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/module.mjs");
    let module = root().join("crates/plaus-gallery/web/dist/plaus.wasm.gz");
    let schema = folder.join("schema.json");
    std::fs::write(&schema, plaus_scenes::scenario::schema().to_string()).unwrap();
    let mut solved = 0;
    for &(name, iterations, independent) in CASES {
        let text = serde_json::to_vec(&live(name, independent)).unwrap();
        let file = folder.join("live.json");
        std::fs::write(&file, &text).unwrap();
        let mut node = Command::new("node");
        let given = [&script, &module, &schema, &file];
        let ran = node.args(given).arg(iterations.to_string()).output().expect("Node.js runs");
        let told = String::from_utf8(ran.stdout).unwrap();
        assert!(ran.status.success(), "{name}: {told}{}", String::from_utf8_lossy(&ran.stderr));
        let expected = native(&text, iterations);
        assert!(expected == told, "{name}: natively, and by the module\n{expected}\n{told}");
        solved += u32::from(expected.lines().count() > 2);
    }
    assert!(solved >= 3, "only {solved} of these find a solution, so its bytes are hardly compared");
}
