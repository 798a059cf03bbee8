//! Chores of the project. `cargo xtask` without arguments lists them.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "chores talk to the person at the terminal")]

mod archive;
mod arviz;
mod assets;
mod blender;
mod clients;
mod command;
mod documented;
mod engines;
mod examples;
mod fuzz;
mod golden;
mod mixing;
mod reference;
mod registry;
mod site;
mod steps;
mod test;
mod validate;
mod wasm;
mod wheel;
mod worlds;

use command::{Failure, cargo};
use std::process::ExitCode;

const USAGE: &str = "\
usage: cargo xtask CHORE

  test                 the code, without figures and comparisons: clippy, all tests, docs, examples
  test --quick         of that, what says within a minute or so whether a change is sound
  profiles             golden traces without any optimisation, and with all of it
  clients              figures, distances beside another library, and what other programs make of runs, exports and
                       galleries
  blender              whether Blender plays exports as they are, and whether the extension for it does what it should
                       (installs bpy, on Python 3.11 only)
  blender --extension  the extension alone
  blender --every      the extension alone, in every Blender that the Pythons of this machine can install
  blender --zip        the extension with the wheel, as Blender installs it, into target/blender
  ci                   test with figures and comparisons, profiles, and clients: what CI runs
  godot                whether Godot 4 plays exports as they are, where it is on the path
  shown                every command that README, docs and scenario files show, and the pages of reference
  reference            write docs/reference anew: keys of scenarios, and commands
  engines              pieces of runs on HyperQueue, OpenJD and Slurm, with accidents; speed, and what merges cost
  wheel                the Python package, into target/wheel/dist
  wheel --check        the same, tried on every Python there is, with its notebooks
  wheel --measure      the same, with its numbers
  wheel --portable [TRIPLE]
                       the same for Linux of long ago, or for another platform; that of this machine is tried
  archive [TRIPLE]     the command as an archive to download, with its SHA-256 and what it is built of, into
                       target/archive; that of this machine is tried
  site [--out FOLDER] [--quick]
                       the site: pages to try plaus on, documents, interfaces, into target/site; --quick: one page to
                       try, no interfaces
  wheel --licences     write the list of licences that is in it anew
  wasm                 build the sampler of live galleries anew, as WebAssembly (Debian, npm; some minutes)
  wasm --test          the tests of its crates as WebAssembly, where addresses have 32 bits (rustup, Node.js)
  reproduce-figures [--out FOLDER] [--quick] [--only SCENE]
                       the paper's figures and claims, sampled anew, into out/figures
  plausibility [--out FOLDER] [--quick] [--only SCENE]
                       tosses, dice and bowling beside what was published of real ones, into out/plausibility
  accuracy [--out FOLDER] [--quick]
                       how far each preset is from truths of contact, into out/accuracy
  fuzz-worlds --minutes N [--seed S] [--preset P] [--law L]
                       random worlds under the laws of the simulator; writes scenarios of those that break one into
                       out/fuzz-worlds
  validate [TABLE ...] measure the tables of docs/validation anew, and write them with the day, commit and machine
                       (an hour and a half for all)
  mixing [WORD [SEED ...]]
                       independent solutions a minute of one processor, beside draws of the prior, and times to the
                       first solution and to a dozen different ones; WORD chooses rows
  worlds [WORD]        how soon runs find what the worlds in scenarios/worlds ask for, in processor time: writes the
                       table of docs/validation/worlds.md anew, or the rows whose names contain WORD, and takes pictures
  assets               make the shapes anew that worlds in scenarios/worlds name
  golden               compare golden traces with fresh runs
  golden --bless       make golden traces anew
  tradeoff [...]       compare with peers: cargo run --release -p plaus-tradeoff
  bench [...]          cargo bench";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    if arguments.iter().any(|word| ["-h", "--help"].contains(word)) || arguments == ["help"] {
        println!("{USAGE}");
        return ExitCode::SUCCESS;
    }
    let done = match arguments.split_first() {
        Some((&"test", [])) => test::run(),
        Some((&"test", ["--quick"])) => test::quick(),
        Some((&"ci", [])) => test::ci(),
        Some((&"profiles", [])) => test::profiles(),
        Some((&"clients", [])) => test::clients(),
        Some((&"shown", [])) => test::shown(),
        Some((&"reference", [])) => reference::write(),
        Some((&"blender", rest)) => blender::run(rest),
        Some((&"godot", [])) => test::godot(),
        Some((&"engines", [])) => engines::run(),
        Some((&"wasm", rest)) => wasm::run(rest),
        Some((&"wheel", rest)) => wheel::run(rest),
        Some((&"archive", rest)) => archive::run(rest),
        Some((&"site", rest)) => site::run(rest),
        Some((&"reproduce-figures", rest)) => figures(rest),
        Some((&"plausibility", rest)) => plausibility(rest),
        Some((&"accuracy", rest)) => accuracy(rest),
        Some((&"fuzz-worlds", rest)) => fuzz::run(rest),
        Some((&"mixing", rest)) => mixing::run(rest),
        Some((&"validate", rest)) => validate::run(rest),
        Some((&"worlds", rest)) => worlds::run(rest),
        Some((&"assets", [])) => assets::write(),
        Some((&"golden", rest)) => golden::run(rest),
        Some((&"tradeoff", rest)) => cargo(&["run", "--release", "--package", "plaus-tradeoff", "--"]).args(rest).run(),
        Some((&"bench", rest)) => cargo(&["bench", "--package", "plaus-benches"]).args(rest).run(),
        _ => {
            eprintln!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure(message)) => {
            eprintln!("cargo xtask: {message}");
            ExitCode::FAILURE
        }
    }
}

fn figures(arguments: &[&str]) -> Result<(), Failure> {
    cargo(&["run", "--release", "--package", "plaus-figures", "--"]).args(arguments).run()
}

fn plausibility(arguments: &[&str]) -> Result<(), Failure> {
    let program = ["run", "--release", "--package", "plaus-figures", "--", "plausibility"];
    cargo(&program).args(arguments).run()
}

/// Measures with an example of the simulator, which leaves a table; then draws the table.
fn accuracy(arguments: &[&str]) -> Result<(), Failure> {
    let folder = arguments.windows(2).find(|pair| pair[0] == "--out").map_or("out/accuracy", |pair| pair[1]);
    std::fs::create_dir_all(folder).map_err(Failure::new)?;
    let table = format!("{folder}/convergence.csv");
    // Seconds per run by the wall clock, number of throws, and part of a name.
    let [seconds, throws] = if arguments.contains(&"--quick") { ["0.05", "2"] } else { ["20", "20"] };
    let measuring = ["run", "--release", "--package", "plaus-sim", "--example", "convergence", "--"];
    cargo(&measuring).args([seconds, throws, "", &table]).run()?;
    cargo(&["run", "--release", "--package", "plaus-figures", "--", "accuracy"]).args(arguments).run()
}
