//! `plaus resume`

use super::confirm::ACCURACY;
use super::sample::Watching;
use crate::failure::{Failure, Outcome};
use plaus_run::{Folder, More, Run};
use std::path::PathBuf;

/// Which run.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Folder of the run
    run: PathBuf,
    /// Make the run longer: iterations of each chain after the warm-up, in total
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    iterations: Option<u64>,
    /// Look for more: stop once K distinct solutions are recorded in total
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u64).range(1..), allow_negative_numbers = true)]
    solutions: Option<u64>,
    #[command(flatten)]
    watching: Watching,
}

impl Args {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let folder = Folder::new(&self.run);
        if self.watching.confirms() {
            plaus_run::confirm::possible(Run::open(&folder)?.scenario(), ACCURACY)?;
        }
        let more = More { iterations: self.iterations, solutions: self.solutions };
        self.watching.watch(&folder, false, |sampling| Ok(plaus_run::resume(&folder, more, sampling)?))
    }
}
