//! Dependencies between crates, and other properties of the sources that no compiler checks.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod circles;
mod rooms;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// For each of our packages, the others that it may use. The chain knows no bodies; the simulator knows no chain.
const EDGES: &[(&str, &[&str])] = &[
    ("plaus-dist", &[]),
    ("plaus-sim", &["plaus-dist"]),
    ("plaus-mcmc", &["plaus-dist"]),
    ("plaus-animation", &["plaus-dist"]),
    ("plaus-asset", &["plaus-dist"]),
    ("plaus-no-schema", &[]),
    (
        "plaus-scenes",
        &["plaus-animation", "plaus-asset", "plaus-dist", "plaus-mcmc", "plaus-no-schema", "plaus-scenes", "plaus-sim"],
    ),
    ("plaus-run", &["plaus-dist", "plaus-mcmc", "plaus-scenes"]),
    ("plaus-export", &["plaus-animation", "plaus-dist"]),
    ("plaus-picture", &["plaus-animation", "plaus-dist", "plaus-export"]),
    ("plaus-gallery", &["plaus-dist", "plaus-export", "plaus-mcmc", "plaus-run", "plaus-scenes"]),
    ("plaus-wasm", &["plaus-dist", "plaus-gallery", "plaus-mcmc", "plaus-scenes"]),
    (
        "plaus-cli",
        &["plaus-dist", "plaus-export", "plaus-gallery", "plaus-mcmc", "plaus-picture", "plaus-run", "plaus-scenes"],
    ),
    (
        "plaus-python",
        &[
            "plaus-asset",
            "plaus-cli",
            "plaus-dist",
            "plaus-export",
            "plaus-gallery",
            "plaus-mcmc",
            "plaus-run",
            "plaus-scenes",
            "plaus-sim",
        ],
    ),
    ("plaus-figures", &["plaus-dist", "plaus-mcmc", "plaus-picture", "plaus-scenes", "plaus-sim"]),
    ("plaus-tradeoff", &["plaus-dist", "plaus-figures", "plaus-mcmc", "plaus-scenes", "plaus-sim"]),
    ("plaus-benches", &[]),
    ("plaus-oracle", &[]),
    ("plaus-tests", &["plaus-dist"]),
    ("xtask", &[]),
];

/// Crates that only one of our packages, or only one file, may name.
const ONLY_IN: &[(&str, &str)] = &[("bincode", "crates/plaus-run/src/codec.rs")];

/// Largest number of columns of a line in sources and docs; rustfmt is set to the same.
const WIDEST: usize = 120;

/// Largest number of lines of a source file: as many as a reader can keep in mind.
const LONGEST: usize = 450;

/// Files that may be longer, and why.
const LONGER: &[(&str, &str)] =
    &[("crates/plaus-sim/src/rigid/tolerances.rs", "a table: nobody keeps it in mind, and each entry is read alone")];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().unwrap()
}

/// Every file below `folder` whose name ends in `ending`, without build outputs.
fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            if name != "target" && name != "node_modules" && !name.starts_with('.') && name != "out" {
                found.extend(files(&path, ending));
            }
        } else if path.to_string_lossy().replace('\\', "/").ends_with(ending) {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn shown(path: &Path) -> String {
    path.strip_prefix(root()).unwrap().to_string_lossy().replace('\\', "/")
}

/// Our packages: name, folder, and what its `[dependencies]` are.
fn packages() -> BTreeMap<String, (PathBuf, BTreeSet<String>)> {
    let mut packages = BTreeMap::new();
    for path in files(&root(), "Cargo.toml") {
        let manifest: toml::Table = toml::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
        let Some(name) = manifest.get("package").and_then(|package| package["name"].as_str()) else { continue };
        let dependencies = manifest.get("dependencies").and_then(toml::Value::as_table);
        let dependencies = dependencies.map(|table| table.keys().cloned().collect()).unwrap_or_default();
        packages.insert(name.to_owned(), (path.parent().unwrap().to_owned(), dependencies));
    }
    packages
}

#[test]
fn packages_use_each_other_only_along_the_layers() {
    let packages = packages();
    let known: BTreeSet<&str> = EDGES.iter().map(|edge| edge.0).collect();
    let there: BTreeSet<&str> = packages.keys().map(String::as_str).collect();
    assert_eq!(there, known, "packages there are, and packages with edges in this file");
    for &(name, allowed) in EDGES {
        let ours = packages[name].1.iter().map(String::as_str).filter(|used| known.contains(used));
        let forbidden: Vec<&str> = ours.filter(|used| !allowed.contains(used)).collect();
        assert!(forbidden.is_empty(), "{name} may not depend on {forbidden:?}");
    }
}

#[test]
fn a_crate_that_one_file_may_name_is_named_nowhere_else() {
    for &(name, only) in ONLY_IN {
        let using = files(&root(), ".rs").into_iter().filter(|path| {
            let text = std::fs::read_to_string(path).unwrap();
            text.lines().any(|line| !line.trim_start().starts_with("//") && line.contains(&format!("{name}::")))
        });
        let using: Vec<String> = using.map(|path| shown(&path)).collect();
        assert_eq!(using, [only], "files that name {name}");
    }
}

#[test]
fn sources_are_short_enough_to_keep_in_mind() {
    let mut long = Vec::new();
    for path in files(&root(), ".rs") {
        let lines = std::fs::read_to_string(&path).unwrap().lines().count();
        if lines > LONGEST && !LONGER.iter().any(|(longer, _)| shown(&path) == *longer) {
            long.push(format!("{} ({lines} lines)", shown(&path)));
        }
    }
    assert!(long.is_empty(), "longer than {LONGEST} lines: {}", long.join(", "));
}

#[test]
fn pages_link_to_files_that_exist() {
    let mut broken = Vec::new();
    for page in files(&root(), ".md") {
        let text = std::fs::read_to_string(&page).unwrap();
        for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let target = link.split('#').next().unwrap_or_default();
            if target.is_empty() || target.contains("://") || target.contains(char::is_whitespace) {
                continue;
            }
            if !page.parent().unwrap().join(target).exists() {
                broken.push(format!("{}: {link}", shown(&page)));
            }
        }
    }
    assert!(broken.is_empty(), "links that lead nowhere: {}", broken.join(", "));
}

#[test]
fn every_path_named_in_architecture_and_contributing_exists() {
    let named_in = |page: &'static str| {
        let text = std::fs::read_to_string(root().join(page)).unwrap();
        let words: Vec<String> = text.split('`').skip(1).step_by(2).map(str::to_owned).collect();
        words.into_iter().map(move |word| (page, word))
    };
    let named: Vec<_> = ["ARCHITECTURE.md", "CONTRIBUTING.md"].into_iter().flat_map(named_in).collect();
    let is_path = |word: &str| {
        ["crates/", "integrations/", "tests/", "xtask/", "scenarios/"].iter().any(|top| word.starts_with(top))
    };
    let paths: Vec<_> = named.iter().filter(|(_, word)| is_path(word) && !word.contains(['<', '*', '{'])).collect();
    let missing: Vec<_> = paths.iter().filter(|(_, path)| !root().join(path).exists()).collect();
    assert!(missing.is_empty(), "named, but not there: {missing:?}");
    assert!(["ARCHITECTURE.md", "CONTRIBUTING.md"].iter().all(|page| paths.iter().any(|(on, _)| on == page)));
}

/// A file that is not named in its crate's one test program would never run.
#[test]
fn every_test_file_is_part_of_the_program() {
    let mut left_out = Vec::new();
    for program in files(&root().join("crates"), "tests/all.rs") {
        let text = std::fs::read_to_string(&program).unwrap();
        for entry in std::fs::read_dir(program.parent().unwrap()).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_stem().unwrap().to_string_lossy().into_owned();
            let is_test = path.extension().is_some_and(|end| end == "rs") && name != "all";
            if is_test && !text.contains(&format!("mod {name};")) {
                left_out.push(shown(&path));
            }
        }
    }
    assert!(left_out.is_empty(), "not named in all.rs beside them: {left_out:?}");
}

/// A file that no module names is never compiled: a change has left it behind.
#[test]
fn every_source_is_part_of_its_crate() {
    let mut left_out = Vec::new();
    for path in files(&root().join("crates"), ".rs") {
        let (folder, name) = (path.parent().unwrap(), path.file_stem().unwrap().to_string_lossy().into_owned());
        let in_source = path.components().any(|part| part.as_os_str() == "src");
        if !in_source || ["lib", "main", "mod"].contains(&name.as_str()) {
            continue;
        }
        let heads = ["mod.rs", "lib.rs", "main.rs"].map(|head| folder.join(head));
        let texts = heads
            .into_iter()
            .chain([folder.with_extension("rs")])
            .filter_map(|head| std::fs::read_to_string(head).ok());
        if !texts.collect::<Vec<_>>().iter().any(|text| text.contains(&format!("mod {name};"))) {
            left_out.push(shown(&path));
        }
    }
    assert!(left_out.is_empty(), "compiled nowhere: {left_out:?}");
}

/// Rows of tables cannot be broken, and rustfmt does not break strings in code.
#[test]
fn lines_are_narrow_enough_to_read() {
    let mut wide = Vec::new();
    for path in [files(&root(), ".rs"), files(&root(), ".md"), files(&root(), ".toml")].concat() {
        let name = shown(&path);
        for (number, line) in (1..).zip(std::fs::read_to_string(&path).unwrap().lines()) {
            let words = line.trim_start_matches(['/', '!', '#', ' ']);
            let unbroken = words.starts_with('|') || words.contains("](") || line.contains('"');
            if line.chars().count() > WIDEST && !unbroken {
                wide.push(format!("{name}:{number}"));
            }
        }
    }
    assert!(wide.is_empty(), "more than {WIDEST} columns: {}", wide.join(", "));
}
