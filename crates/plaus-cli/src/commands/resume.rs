//! `plaus resume`

use super::confirm::ACCURACY;
use super::sample::{Watched, Watching};
use crate::failure::{Failure, Outcome};
use plaus_mcmc::Plan;
use plaus_run::{More, Run};
use std::path::PathBuf;

/// Which run.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Folder of the run
    run: PathBuf,
    /// Make the run longer: iterations of each chain after the warm-up, in total
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    iterations: Option<u64>,
    /// Look for more: stop once K distinct solutions are recorded in total; `all`: do not stop
    /// at any number of solutions, but go on to the planned iterations, which statistics need
    #[arg(long, value_name = "K", value_parser = solutions, allow_negative_numbers = true)]
    solutions: Option<u64>,
    #[command(flatten)]
    watching: Watching,
}

/// A number of solutions, or the word for all of them.
fn solutions(word: &str) -> Result<u64, String> {
    match word {
        "all" => Ok(Plan::ALL),
        _ => super::from_one(word).map_err(|why| format!("{why}, or `all`")),
    }
}

/// What more is asked for, as words of a command line.
fn in_words(more: More) -> String {
    let iterations = more.iterations.map(|count| format!(" --iterations {count}"));
    let solutions = more.solutions.map(|count| match count {
        Plan::ALL => " --solutions all".to_owned(),
        count => format!(" --solutions {count}"),
    });
    iterations.into_iter().chain(solutions).collect()
}

impl Args {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let folder = super::run_at(&self.run)?;
        if self.watching.confirms() {
            plaus_run::confirm::possible(Run::open(&folder)?.scenario(), ACCURACY)?;
        }
        let more = More { iterations: self.iterations, solutions: self.solutions };
        let watched = Watched { folder: &folder, waits: false, scenario: None, more: in_words(more) };
        self.watching.watch(watched, |sampling| Ok(plaus_run::resume(&folder, more, sampling)?))
    }
}
