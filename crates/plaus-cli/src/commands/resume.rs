//! `plaus resume`

use super::sample::Watching;
use crate::failure::{Failure, Outcome};
use plaus_run::Folder;
use std::path::PathBuf;

/// Which run.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Folder of the run
    run: PathBuf,
    /// Make the run longer: iterations of each chain after the warm-up, in all
    #[arg(long)]
    iterations: Option<u64>,
    #[command(flatten)]
    watching: Watching,
}

impl Args {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let folder = Folder::new(&self.run);
        self.watching.watch(&folder, |sampling| Ok(plaus_run::resume(&folder, self.iterations, sampling)?))
    }
}
