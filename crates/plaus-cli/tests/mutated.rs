//! Scenario files and run files changed at random: there is no panic, and the exit code says what happened.

use crate::common::{Ended, Place};
use proptest::prelude::*;
use std::sync::LazyLock;

/// Text that people type, and that programs garble.
const SNIPPETS: &[&str] = &[
    "",
    "0",
    "-1",
    "nan",
    "inf",
    "1e400",
    "9223372036854775808",
    "true",
    "\"\"",
    "[",
    "]",
    "[[",
    "{",
    "}",
    "=",
    "\"",
    "'''",
    "#",
    "\n",
    ".",
    "\u{feff}",
    "é",
    "日本",
    "[world.ball2d]\n",
    "[sampler]\n",
    "seed = ",
    "sigma_d = ",
    "moves = \"paper\"\n",
    "1979-05-27",
    "\0",
    "\r",
    "\t",
];

#[derive(Debug, Clone)]
struct Change {
    at: prop::sample::Index,
    cut: usize,
    put: Vec<u8>,
}

fn change() -> impl Strategy<Value = Change> {
    let put = prop_oneof![
        3 => prop::sample::select(SNIPPETS).prop_map(|text| text.as_bytes().to_vec()),
        1 => prop::collection::vec(any::<u8>(), 0..20),
    ];
    (any::<prop::sample::Index>(), 0..12_usize, put).prop_map(|(at, cut, put)| Change { at, cut, put })
}

impl Change {
    fn of(&self, bytes: &mut Vec<u8>) {
        let at = self.at.index(bytes.len() + 1);
        let end = (at + self.cut).min(bytes.len());
        bytes.splice(at..end, self.put.iter().copied());
    }
}

/// Exit code 0 or 1, or 2 with a message.
fn harmless(ended: &Ended, what: &str) -> Result<(), TestCaseError> {
    let fine = match ended.code {
        Some(0 | 1) => true,
        Some(2) => ended.err.contains("error: "),
        _ => false,
    };
    prop_assert!(fine, "{}: {:?}\n{}", what, ended.code, ended.err);
    Ok(())
}

struct Whole {
    place: Place,
    files: Vec<(String, Vec<u8>)>,
    table: String,
}

static WHOLE: LazyLock<Whole> = LazyLock::new(|| {
    let place = Place::new();
    place.ok("sample ball.toml --out run --iterations 300 --chains 2 -q");
    let files = place.bytes("run").into_iter().collect();
    let table = place.ok("export run --format csv --out -").out;
    Whole { place, files, table }
});

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn changed_scenarios_are_survived(changes in prop::collection::vec(change(), 1..4)) {
        let place = Place::new();
        let mut text = crate::common::SCENARIO.as_bytes().to_vec();
        changes.iter().for_each(|change| change.of(&mut text));
        place.write("ball.toml", &text);
        let checked = place.run("check ball.toml");
        harmless(&checked, "check")?;
        // A valid scenario can be sampled; an invalid one makes no folder.
        let sampled = place.run("sample ball.toml --out run --iterations 30 --warmup 5 --chains 2 --set checkpoint_every=10 -q");
        harmless(&sampled, "sample")?;
        if checked.code == Some(0) {
            prop_assert_ne!(sampled.code, Some(2), "{}", sampled.err);
        }
        prop_assert_eq!(place.path("run").exists(), sampled.code != Some(2));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn changed_runs_are_survived(
        file in any::<prop::sample::Index>(),
        changes in prop::collection::vec(change(), 1..3),
        flip in any::<Option<(prop::sample::Index, u8)>>(),
    ) {
        let place = Place::new();
        std::fs::create_dir(place.path("run")).unwrap();
        let (name, _) = file.get(&WHOLE.files);
        for (other, bytes) in &WHOLE.files {
            let mut bytes = bytes.clone();
            match flip {
                _ if other != name => {}
                Some((at, flip)) if !bytes.is_empty() => {
                    let at = at.index(bytes.len());
                    bytes[at] ^= flip;
                }
                _ => changes.iter().for_each(|change| change.of(&mut bytes)),
            }
            place.write(&format!("run/{other}"), bytes);
        }
        let exported = place.run("export run --format csv --out -");
        harmless(&exported, "export")?;
        if exported.code == Some(0) {
            prop_assert_eq!(&exported.out, &WHOLE.table);
        }
        for command in ["diagnose run", "replay run --sample 1:299", "export run --format csv --salvage --out d.csv", "export run --format zarr --out z"] {
            harmless(&place.run(command), command)?;
        }
        let before = place.bytes("run");
        let resumed = place.run("resume run -q");
        harmless(&resumed, "resume")?;
        if resumed.code == Some(2) {
            prop_assert_eq!(place.bytes("run"), before);
        } else {
            let chains = |place: &Place| -> Vec<_> { place.bytes("run").into_iter().filter(|(name, _)| name.starts_with("chain")).collect() };
            prop_assert_eq!(chains(&place), chains(&WHOLE.place));
        }
    }
}
