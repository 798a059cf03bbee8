//! A table of the sampling phase: one row per chain and draw.
//!
//! Columns: `chain`, `draw` (from 0), `log_p`, `satisfied` (`true` or `false`), then one for each scalar of the scene,
//! in the scene's units. Numbers are the shortest that read back as the same bits; rows are ordered by chain, then
//! draw; lines end with `\n`.

use crate::error::Error;
use crate::read::RunReader;
use crate::sample_id::ChainPhase;
use plaus_scenes::Scene;
use std::fmt::Write as _;
use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;

const HEAD: &str = "chain,draw,log_p,satisfied,";

/// Whether a file was made by [`write()`], and may be replaced.
#[must_use]
pub fn is_ours(path: &Path) -> bool {
    let mut start = [0; HEAD.len()];
    path.is_file()
        && File::open(path).and_then(|mut file| file.read_exact(&mut start)).is_ok()
        && start == HEAD.as_bytes()
}

/// Writes the table.
///
/// # Errors
/// [`Error`] if the records are damaged or `out` refuses.
pub fn write(run: &RunReader<'_>, out: &mut dyn Write) -> Result<(), Error> {
    let scalars = run.scene().scalars();
    let names: Vec<&str> = scalars.iter().map(|scalar| scalar.name.as_str()).collect();
    writeln!(out, "{HEAD}{}", names.join(",")).map_err(Error::Output)?;
    let mut values = vec![0.0; scalars.len()];
    let mut rest = String::new();
    for chain in run.chains() {
        run.walk(chain, ChainPhase::Sampling, |repeats| -> Result<(), Error> {
            run.scene().write_scalars(repeats.entry.state.by_ref(), &mut values);
            rest.clear();
            let state = &repeats.entry.state;
            // Writing to a string cannot fail.
            let _ = write!(rest, "{:?},{}", state.log_p().value(), repeats.entry.class.is_some());
            for value in &values {
                let _ = write!(rest, ",{value:?}");
            }
            let mut draws = repeats.draw..repeats.draw + repeats.draws;
            draws.try_for_each(|draw| writeln!(out, "{chain},{draw},{rest}")).map_err(Error::Output)
        })?;
    }
    Ok(())
}
