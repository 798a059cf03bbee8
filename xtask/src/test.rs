//! Everything that must pass.

use crate::clients;
use crate::command::{Failure, cargo, has_subcommand, root, target};
use crate::steps::{self, Done, Step};
use std::fs;

/// Runs all of it.
pub(crate) fn run() -> Result<(), Failure> {
    let golden = ["--package", "plaus-tests", "--test", "golden"];
    let quick = target().join("figures-quick");
    let figures = cargo(&["run", "--quiet", "--package", "plaus-figures", "--", "--quick", "--out"]).args([&quick]);
    let mut all = vec![
        Step::command("format", cargo(&["fmt", "--all", "--", "--check"])),
        Step::command("clippy", cargo(&["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"])),
        Step::command("tests", cargo(&["test", "--workspace"])),
        Step::command("golden traces, unoptimised", cargo(&["test", "--profile", "unoptimised"]).args(golden)),
        Step::command("golden traces, release", cargo(&["test", "--release"]).args(golden)),
        Step::command("docs", cargo(&["doc", "--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "-D warnings")),
        Step::new("examples", examples),
        Step::command("figures, quick", figures),
        Step::command("plaus in release", cargo(&["build", "--release", "--package", "plaus-cli"])),
        Step::new("ArviZ reads a run", crate::arviz::run),
        Step::new("licences and advisories", deny),
    ];
    all.extend(client_steps());
    steps::run(all)
}

/// Only what other programs make of exports and galleries.
pub(crate) fn clients() -> Result<(), Failure> {
    let release = cargo(&["build", "--release", "--package", "plaus-cli"]);
    let mut all = vec![Step::command("plaus in release", release)];
    all.extend(client_steps());
    steps::run(all)
}

fn client_steps() -> Vec<Step> {
    vec![
        Step::new("exports of every scene", clients::export),
        Step::new("glTF validator and three.js read them", clients::gltf),
        Step::new("USD reads them", clients::usd),
        Step::new("galleries in a browser", clients::gallery),
        Step::new("the committed three.js is what its script makes", clients::bundle),
    ]
}

/// Runs every example of every crate.
fn examples() -> Result<Done, Failure> {
    let mut found = Vec::new();
    let crates = fs::read_dir(root().join("crates")).map_err(Failure::new)?;
    for package in crates {
        let package = package.map_err(Failure::new)?;
        let Ok(examples) = fs::read_dir(package.path().join("examples")) else { continue };
        for example in examples {
            let path = example.map_err(Failure::new)?.path();
            if path.extension().is_some_and(|extension| extension == "rs") {
                let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
                found.push((package.file_name().to_string_lossy().into_owned(), name));
            }
        }
    }
    found.sort();
    for (package, example) in &found {
        let command = cargo(&["run", "--quiet", "--package", package, "--example", example]);
        println!("$ {}", command.shown());
        command.run()?;
    }
    println!("{} examples ran", found.len());
    Ok(Done::Passed)
}

/// Checks `deny.toml` where the tool is there: building it takes longer than all the rest.
fn deny() -> Result<Done, Failure> {
    if !has_subcommand("deny") {
        return Ok(Done::Skipped("cargo-deny is not installed here (`cargo install cargo-deny`)".to_owned()));
    }
    cargo(&["deny", "check"]).run().map(|()| Done::Passed)
}
