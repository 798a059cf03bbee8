//! Everything that must pass.

use crate::clients;
use crate::command::{Command, Failure, built, cargo, has_subcommand, root, target};
use crate::steps::{self, Done, Step};
use std::fs;

/// Leaves out what is compared with: building it takes longer than all the rest, and clippy looks at our side of it.
const PEERS: [&str; 2] = ["--exclude", "plaus-tradeoff"];

/// What is tried in release. Both packages at once, as in the step that builds everything.
const IN_RELEASE: [&str; 5] = ["--release", "--package", "plaus-cli", "--package", "plaus-tests"];

/// Runs all of it.
pub(crate) fn run() -> Result<(), Failure> {
    let golden = ["--package", "plaus-tests", "--test", "golden"];
    let quick = target().join("figures-quick");
    let figures = Command::new(built("debug", "plaus-figures")).args(["--quick", "--out"]).args([&quick]);
    let plausible = target().join("plausibility-quick");
    let plausible =
        Command::new(built("debug", "plaus-figures")).args(["plausibility", "--quick", "--out"]).args([&plausible]);
    let mut all = vec![
        Step::command("format", cargo(&["fmt", "--all", "--", "--check"])),
        Step::command("clippy", cargo(&["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"])),
        // Everything at once: with a package at a time, cargo would build what they share anew for each choice of features.
        Step::command("build", cargo(&["build", "--workspace", "--all-targets"]).args(PEERS)),
        Step::command("tests", cargo(&["test", "--workspace"]).args(PEERS)),
        Step::command("golden traces, unoptimised", cargo(&["test", "--profile", "unoptimised"]).args(golden)),
        Step::command("release", cargo(&["build"]).args(IN_RELEASE).args(["--bin", "plaus", "--test", "golden"])),
        Step::command("golden traces, release", cargo(&["test"]).args(IN_RELEASE).args(["--test", "golden"])),
        Step::command("docs", cargo(&["doc", "--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "-D warnings")),
        Step::new("examples", examples),
        Step::command("figures, quick", figures),
        Step::command("plausibility, quick", plausible),
        Step::new("ArviZ reads a run", crate::arviz::run),
        Step::new("pieces on engines, quick", crate::engines::quick),
        Step::new("licences and advisories", deny),
    ];
    all.extend(client_steps());
    all.extend(crate::wheel::steps());
    steps::run(all)
}

/// Only what other programs make of exports and galleries.
pub(crate) fn clients() -> Result<(), Failure> {
    let release = cargo(&["build", "--release", "--package", "plaus-cli"]);
    let shapes = cargo(&["build", "--package", "plaus-export", "--example", "tumbling"]);
    let mut all = vec![Step::command("plaus in release", release), Step::command("every shape", shapes)];
    all.extend(client_steps());
    all.push(Step::new("Blender plays them", clients::blender));
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
                found.push(path.file_stem().unwrap_or_default().to_string_lossy().into_owned());
            }
        }
    }
    found.sort();
    for example in &found {
        let command = Command::new(built("debug/examples", example));
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
