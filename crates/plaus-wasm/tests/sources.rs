//! The committed module is made of the present sources.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Packages whose code is in it.
const PACKAGES: &[&str] = &[
    "plaus-dist",
    "plaus-mcmc",
    "plaus-sim",
    "plaus-asset",
    "plaus-animation",
    "plaus-scenes",
    "plaus-export",
    "plaus-gallery",
    "plaus-wasm",
];

/// Files of `plaus-gallery` that make pages of runs: these are not in it.
const WITHOUT: &[&str] = &["made.rs", "page.rs", "whole.rs", "words.rs"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => files(&path, found),
            false => found.push(path),
        }
    }
}

/// Versions of all packages that a package may use, by what Cargo.lock says.
fn versions() -> BTreeSet<String> {
    let text = fs::read_to_string(root().join("Cargo.lock")).unwrap();
    let mut all: BTreeMap<&str, (&str, Vec<&str>)> = BTreeMap::new();
    for package in text.split("[[package]]").skip(1) {
        let value = |key: &str| {
            let line = package.lines().find_map(|line| line.strip_prefix(key));
            line.map_or("", |line| line.trim_matches(['"', ' ', '=']))
        };
        let uses = package
            .lines()
            .filter_map(|line| line.strip_prefix(" \""))
            .map(|line| line.trim_end_matches(['"', ',']).split(' ').next().unwrap_or_default());
        all.insert(value("name"), (value("version"), uses.collect()));
    }
    let (mut open, mut seen) = (vec!["plaus-wasm"], BTreeSet::new());
    while let Some(name) = open.pop() {
        let (version, uses) = &all[name];
        // What only pages of runs need is not in the module.
        if name != "plaus-run" && seen.insert(format!("{name} {version}")) {
            open.extend(uses);
        }
    }
    seen
}

fn hash() -> String {
    let mut hasher = blake3::Hasher::new();
    for package in PACKAGES {
        let mut found = Vec::new();
        files(&root().join("crates").join(package).join("src"), &mut found);
        found.retain(|path| *package != "plaus-gallery" || !WITHOUT.iter().any(|without| path.ends_with(without)));
        found.sort();
        for path in found {
            hasher.update(path.strip_prefix(root()).unwrap().to_string_lossy().replace('\\', "/").as_bytes());
            hasher.update(&fs::read(&path).unwrap());
        }
    }
    for version in versions() {
        hasher.update(version.as_bytes());
    }
    for script in ["wasm.py", "order_wasm.py"] {
        hasher.update(&fs::read(root().join("xtask/python").join(script)).unwrap());
    }
    hasher.finalize().to_hex().to_string()
}

/// `cargo xtask wasm` sets `PLAUS_BLESS` once it has built the module.
#[test]
fn the_module_is_made_of_the_present_sources() {
    let path = root().join("crates/plaus-gallery/web/dist/plaus.wasm.sources");
    let now = hash();
    if std::env::var_os("PLAUS_BLESS").is_some_and(|set| !set.is_empty()) {
        fs::write(&path, format!("{now}\n")).unwrap();
    }
    let then = fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(
        then.trim(),
        now,
        "the sources of the sampler in pages have changed: `cargo xtask wasm` builds it anew (Debian, npm; some minutes)"
    );
}
