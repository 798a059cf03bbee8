//! Builds the sampler of live galleries, and notes of which sources it is made.

use crate::command::{Command, Failure, cargo, target};

/// Where pages take it from.
const PACKED: &str = "crates/plaus-gallery/web/dist/plaus.wasm.gz";

pub(crate) fn build() -> Result<(), Failure> {
    Command::new("python3").args(["xtask/python/wasm.py"]).args([target()]).args([PACKED]).shown_and_run()?;
    let noted = cargo(&["test", "--package", "plaus-wasm", "--test", "sources"]);
    noted.env("PLAUS_BLESS", "1").shown_and_run()
}
