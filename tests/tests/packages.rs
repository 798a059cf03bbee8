//! What others would receive: every crate describes itself, and everything that it is built from may be distributed.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use serde_json::Value;
use spdx::{Expression, LicenseReq, Licensee, ParseMode};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

/// Folder of the packages that are distributed. The others are tests and chores; the Python package is distributed as a
/// wheel.
const GIVEN: &str = "crates/";

/// What cargo knows about our packages and everything they are built from, on every platform.
static METADATA: LazyLock<Value> =
    LazyLock::new(|| serde_json::from_str(&cargo("metadata --format-version 1 --all-features")).unwrap());

/// What cargo prints.
fn cargo(words: &str) -> String {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo).args(words.split(' ')).arg("--locked").current_dir(root()).output().unwrap();
    assert!(output.status.success(), "{words}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().unwrap()
}

fn packages() -> &'static [Value] {
    METADATA["packages"].as_array().unwrap()
}

/// The licences that `deny.toml` allows.
fn allowed() -> Vec<Licensee> {
    let policy: toml::Table = toml::from_str(&std::fs::read_to_string(root().join("deny.toml")).unwrap()).unwrap();
    let names = policy["licenses"]["allow"].as_array().unwrap();
    names.iter().map(|name| Licensee::parse(name.as_str().unwrap()).unwrap()).collect()
}

/// Whether a package may be used under licences that are allowed; if not, what is wrong.
fn judge(licence: Option<&str>, allowed: &[Licensee]) -> Result<(), String> {
    let licence = licence.ok_or("states no licence")?;
    let terms = Expression::parse_mode(licence, ParseMode::LAX).map_err(|error| format!("{licence}: {error}"))?;
    let is_allowed = |wanted: &LicenseReq| allowed.iter().any(|licensee| licensee.satisfies(wanted));
    if terms.evaluate(is_allowed) { Ok(()) } else { Err(format!("{licence} is not among what deny.toml allows")) }
}

#[test]
fn everything_may_be_passed_on() {
    let allowed = allowed();
    let others: Vec<&Value> = packages().iter().filter(|package| !package["source"].is_null()).collect();
    assert!(others.len() > 100, "{} packages", others.len());
    let wrong = |package: &&Value| {
        let why = judge(package["license"].as_str(), &allowed).err()?;
        Some(format!("{} {}: {why}", package["name"], package["version"]))
    };
    let wrong: Vec<String> = others.iter().filter_map(wrong).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let from = |package: &&Value| package["source"].as_str().is_some_and(|source| source.contains("crates.io-index"));
    let elsewhere: Vec<&Value> = others.iter().filter(|package| !from(package)).map(|package| &package["id"]).collect();
    assert!(elsewhere.is_empty(), "deny.toml allows no other registry: {elsewhere:?}");
}

/// The check itself refuses what is not allowed, alone and together with other licences.
/// Extensions for Blender have to be under its licence. It ends at that folder: no crate has any of it.
#[test]
fn the_extension_for_blender_alone_has_its_licence() {
    let read = |path: &str| std::fs::read_to_string(root().join(path)).unwrap();
    let manifest: toml::Table =
        toml::from_str(&read("integrations/blender/plaus_blender/blender_manifest.toml")).unwrap();
    assert_eq!(manifest["license"].as_array().unwrap()[..], ["SPDX:GPL-3.0-or-later".into()]);
    assert!(read("integrations/blender/LICENSE").contains("GNU GENERAL PUBLIC LICENSE"));
    let workspace: toml::Table = toml::from_str(&read("Cargo.toml")).unwrap();
    let version = workspace["workspace"]["package"]["version"].as_str();
    assert_eq!(manifest["version"].as_str(), version, "it is released with the wheel that it holds");
    let ours = packages().iter().filter(|package| package["source"].is_null());
    let inside: Vec<_> =
        ours.filter(|package| package["manifest_path"].to_string().contains("/integrations/blender/")).collect();
    assert!(inside.is_empty(), "{inside:?}");
}

#[test]
fn licences_that_are_not_allowed_are_refused() {
    let allowed = allowed();
    for right in ["MIT", "MIT/Apache-2.0", "MIT OR GPL-3.0-only", "(MIT OR Apache-2.0) AND Unicode-3.0"] {
        assert_eq!(judge(Some(right), &allowed), Ok(()), "{right}");
    }
    for wrong in ["GPL-3.0-only", "MIT AND GPL-3.0-only", "MPL-2.0", "no licence at all"] {
        assert!(judge(Some(wrong), &allowed).is_err(), "{wrong}");
    }
    assert!(judge(None, &allowed).is_err());
}

#[test]
fn every_crate_says_what_it_is() {
    let ours = packages().iter().filter(|package| package["source"].is_null());
    let mut seen = 0;
    for package in ours {
        let (name, manifest) = (package["name"].as_str().unwrap(), package["manifest_path"].as_str().unwrap());
        assert!(package["description"].as_str().is_some_and(|text| text.len() > 20), "{name}: no description");
        assert_eq!(package["license"], "MIT OR Apache-2.0", "{name}");
        assert_eq!(package["rust_version"], OLDEST_RUST.as_str(), "{name}");
        let folder = Path::new(manifest).parent().unwrap();
        let within = folder.strip_prefix(root()).unwrap().to_string_lossy().replace('\\', "/") + "/";
        if !within.starts_with(GIVEN) || name == "plaus-python" {
            continue;
        }
        seen += 1;
        let words = |key: &str| package[key].as_array().unwrap().len();
        assert!((1..=5).contains(&words("keywords")), "{name}: keywords");
        assert!((1..=5).contains(&words("categories")), "{name}: categories");
        let readme = folder.join(package["readme"].as_str().unwrap_or("no readme"));
        let text = std::fs::read_to_string(&readme).unwrap_or_else(|error| panic!("{}: {error}", readme.display()));
        assert!(text.starts_with(&format!("# {name}\n")), "{}", readme.display());
        let versions = package["dependencies"].as_array().unwrap().iter().filter(|one| one["kind"].is_null());
        for dependency in versions {
            assert_ne!(
                dependency["req"], "*",
                "{name}: {} has no version, so it could not be published",
                dependency["name"]
            );
        }
    }
    assert!(seen >= 8, "{seen} crates");
}

/// The oldest Rust that is supported, from the root's manifest.
static OLDEST_RUST: LazyLock<String> = LazyLock::new(|| {
    let manifest: toml::Table = toml::from_str(&std::fs::read_to_string(root().join("Cargo.toml")).unwrap()).unwrap();
    manifest["workspace"]["package"]["rust-version"].as_str().unwrap().to_owned()
});

/// A published crate would contain everything it needs, and no file of hundreds of kilobytes by accident.
#[test]
fn every_crate_can_be_packaged() {
    let ours = packages().iter().filter(|package| package["source"].is_null());
    let names = ours.filter_map(|package| package["name"].as_str()).filter(|name| {
        name.starts_with("plaus-") && root().join("crates").join(name).is_dir() && *name != "plaus-python"
    });
    for name in names {
        let files = cargo(&format!("package --list --allow-dirty --package {name}"));
        for wanted in ["Cargo.toml", "README.md", "src/lib.rs"] {
            assert!(files.lines().any(|file| file == wanted), "{name} lacks {wanted}:\n{files}");
        }
    }
}

/// Programs that use only the simulator or the exporter do not build the sampler's random streams.
#[test]
fn packages_that_draw_nothing_build_no_streams() {
    for (name, draws) in [("plaus-sim", false), ("plaus-export", false), ("plaus-mcmc", true)] {
        let built = cargo(&format!("tree --edges normal --prefix none --package {name}"));
        for library in ["blake3", "rand"] {
            let is_built = built.lines().any(|line| line.split(' ').next() == Some(library));
            assert_eq!(is_built, draws, "{name} and {library}:\n{built}");
        }
    }
}

/// Each package with the features that it is built with, and whether more than macros use it: cargo builds it otherwise
/// for those.
fn built(of: &str, edges: &str) -> BTreeSet<(String, bool)> {
    let packages = |edges: &str| -> BTreeSet<String> {
        let tree = cargo(&format!("tree --prefix none --format {{p}}|{{f}} {of} --edges {edges}"));
        let named = tree.lines().map(|line| line.trim_end_matches(" (*)").to_owned());
        named.filter(|line| !line.contains(" (proc-macro)")).collect()
    };
    let beyond_macros = packages(&format!("{edges},no-proc-macro"));
    packages(edges).into_iter().map(|line| (line.clone(), beyond_macros.contains(&line))).collect()
}

/// A wheel that is only tested is made of what the tests were built with: two builds of everything take minutes.
#[test]
fn the_wheel_to_be_tested_shares_the_build_of_the_tests() {
    let others = "--workspace --exclude plaus-tradeoff --exclude plaus-benches --exclude plaus-oracle";
    let tests = built(others, "normal,dev");
    let anew = |own: &str| -> Vec<(String, bool)> {
        let wheel = built(&format!("--package plaus-python{own}"), "normal");
        wheel.difference(&tests).filter(|(name, _)| !name.starts_with("plaus-python ")).cloned().collect()
    };
    assert_eq!(anew(" --features plaus-python/tested"), []);
    assert!(anew("").iter().any(|(name, _)| name.starts_with("plaus-scenes ")), "the feature gives nothing");
}
