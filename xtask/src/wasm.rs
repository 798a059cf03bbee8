//! Builds the sampler of live galleries, and notes of which sources it is made; tests its crates where addresses have
//! 32 bits.

use crate::command::{Command, Failure, cargo, root, target};
use crate::test::ALL;

/// Where pages take it from.
const PACKED: &str = "crates/plaus-gallery/web/dist/plaus.wasm.gz";

/// A platform with addresses of 32 bits on which tests run, in Node.js: it has files, but no threads.
const TRIPLE: &str = "wasm32-wasip1";

/// The crates in the module whose tests need no threads.
const CRATES: [&str; 5] = ["plaus-dist", "plaus-mcmc", "plaus-sim", "plaus-asset", "plaus-animation"];

pub(crate) fn run(arguments: &[&str]) -> Result<(), Failure> {
    match arguments {
        [] => build(),
        ["--test"] => test(),
        _ => Err(Failure("cargo xtask wasm [--test]".to_owned())),
    }
}

/// Their tests as WebAssembly.
fn test() -> Result<(), Failure> {
    Command::new("rustup").args(["target", "add", TRIPLE]).shown_and_run()?;
    let runner = format!("node --no-warnings {}", root().join("xtask/node/wasi.mjs").display());
    let tests = cargo(&["test", "--no-fail-fast", "--lib", "--tests", "--target", TRIPLE]);
    let tests = tests.args(CRATES.iter().flat_map(|name| ["--package", name]));
    tests.env("CARGO_TARGET_WASM32_WASIP1_RUNNER", &runner).shown_and_run()
}

fn build() -> Result<(), Failure> {
    Command::new("python3").args(["xtask/python/wasm.py"]).args([target()]).args([PACKED]).shown_and_run()?;
    let noted = cargo(&["test"]).args(ALL).args(["--test", "sources"]);
    noted.env("PLAUS_BLESS", "1").shown_and_run()
}
