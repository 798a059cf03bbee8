//! The subcommands, one in each file.

mod asking;
mod chance;
mod check;
mod compare;
mod completions;
mod confirm;
mod diagnose;
mod explain;
mod export;
mod gallery;
mod job;
mod merge;
mod new;
mod replay;
mod resume;
mod sample;
mod schema;
mod shards;
mod status;
mod submit;
mod summary;
mod wanted;

use crate::failure::{Failure, Outcome};
use crate::table::grouped;
use clap::Subcommand;
use plaus_run::RunReader;

/// What is left of a run that is read for salvage, and what is lost.
fn salvage(run: &RunReader<'_>) -> String {
    let (kept, planned) = (run.iterations(), run.run().manifest().plan.end());
    let lost = run.lost();
    let chains: Vec<String> =
        lost.iter().take(8).map(|(chain, bytes)| format!("{} bytes of chain {chain}", grouped(*bytes))).collect();
    let others = lost.len() - chains.len();
    let more = if others > 0 { format!(" and of {others} more") } else { String::new() };
    let damage = if lost.is_empty() {
        "no damage in the records".to_owned()
    } else {
        format!("lost: {}{more}", chains.join(", "))
    };
    format!("salvaged the first {} of {} iterations of each chain; {damage}", grouped(kept), grouped(planned))
}

/// What to do.
#[derive(Subcommand)]
pub(crate) enum Command {
    /// Write a commented scenario file for a scene.
    New(new::Args),
    /// Check a scenario file, and show it with all defaults.
    Check(check::Args),
    /// Sample a scenario into a run folder.
    Sample(sample::Args),
    /// Estimate how likely it is that a random animation does what the scenario asks for.
    Chance(chance::Args),
    /// Continue an interrupted run from its last checkpoint, or make it longer.
    Resume(resume::Args),
    /// Merge the pieces of a run, or of a chance, into what one machine would have made, byte for byte.
    Merge(merge::Args),
    /// Write the job that samples a run in pieces on many machines, and submit it.
    Submit(submit::Args),
    /// Show how far the pieces of a run are.
    Status(status::Args),
    /// Show whether the chains of a run have converged: R-hat, effective sample sizes, acceptance.
    Diagnose(diagnose::Args),
    /// Write the draws of a run as a table or for ArviZ, or samples as animations: glTF, USD, poses, impacts.
    Export(export::Args),
    /// Make a page that plays the distinct solutions of a run.
    Gallery(gallery::Args),
    /// Rebuild the animation of one sample from its draw.
    Replay(replay::Args),
    /// Print the JSON Schema of scenario files.
    Schema,
    /// Explain a scenario key or a word, or list all keys.
    Explain(explain::Args),
    /// Print completions for a shell.
    Completions(completions::Args),
}

impl Command {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<Outcome, Failure> {
        match self {
            Self::New(args) => args.run(),
            Self::Check(args) => args.run(),
            Self::Sample(args) => args.run(),
            Self::Chance(args) => args.run(),
            Self::Resume(args) => args.run(),
            Self::Merge(args) => args.run(),
            Self::Submit(args) => args.run(),
            Self::Status(args) => args.run(),
            Self::Diagnose(args) => args.run(),
            Self::Export(args) => args.run(),
            Self::Gallery(args) => args.run(),
            Self::Replay(args) => args.run(),
            Self::Schema => schema::run(),
            Self::Explain(args) => args.run(),
            Self::Completions(args) => args.run(),
        }
    }
}
