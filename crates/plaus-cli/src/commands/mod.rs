//! The subcommands, one in each file.

mod asking;
mod attempt;
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
mod moving;
mod new;
mod playground;
mod plot;
mod replay;
mod resume;
mod sample;
mod schema;
mod shards;
mod status;
mod submit;
mod summary;
mod wanted;

use crate::console::{self, quoted};
use crate::failure::{Failure, Outcome};
use crate::scenario_file;
use crate::table::{counted, grouped};
use clap::Subcommand;
use job::Job;
use plaus_run::{Folder, Run, RunReader, Tally};
use std::path::Path;

/// A whole number from 1 on.
fn from_one(text: &str) -> Result<u64, String> {
    text.parse().ok().filter(|&number| number > 0).ok_or_else(|| "it must be a whole number, 1 or more".to_owned())
}

/// Endings of files that plaus does not make, but that someone may ask for.
const FOREIGN: [&str; 16] = [
    "gltf", "usd", "usdc", "usdz", "jpg", "jpeg", "webp", "svg", "webm", "mov", "fbx", "obj", "abc", "bvh", "blend",
    "pdf",
];

/// Whether a path has one of these endings.
fn has_ending(path: &Path, endings: &[&str]) -> bool {
    let end = path.extension().map(|end| end.to_string_lossy().to_lowercase()).unwrap_or_default();
    endings.contains(&end.as_str())
}

/// Refuses the name of a file that has the ending of something else, or none: that is a slip. `endings` are those that
/// fit, the usual one first.
fn name_fits(path: &Path, maker: &str, endings: &[&str]) -> Result<(), Failure> {
    let made = export::endings();
    let is_known = has_ending(path, &made) || has_ending(path, &FOREIGN) || has_ending(path, &["html", "htm"]);
    if has_ending(path, endings) || (path.extension().is_some() && !is_known) {
        return Ok(());
    }
    let usual = endings.first().copied().unwrap_or_default();
    let (shown, right) = (path.display(), path.with_extension(usual));
    let why = match path.extension() {
        Some(end) => format!("{maker} does not make .{}", end.to_string_lossy()),
        None => format!("{maker} makes a file that ends in .{}", endings.join(" or .")),
    };
    Err(Failure::Message(format!("{shown}: {why}; did you mean {}?", right.display())))
}

/// Whether it is not decided yet how a run is sampled: it was stopped before.
fn is_undecided(folder: &Folder) -> Result<bool, Failure> {
    let run = Run::open(folder)?;
    Ok(plaus_run::is_undecided(run.manifest(), run.scenario()))
}

/// The run at a path, or the run of a try there. A job's folder is not one, and holds it.
fn run_at(path: &Path) -> Result<Folder, Failure> {
    let folder = Folder::new(path);
    if folder.manifest().exists() {
        return Ok(folder);
    }
    // A try's folder holds its run.
    let inner = Folder::new(path.join(attempt::RUN));
    if inner.manifest().exists() && !path.join("job.json").exists() {
        return Ok(inner);
    }
    let refuse = |what: String| Err(Failure::Message(format!("{}: {what}", path.display())));
    if path.join("job.json").is_file() {
        let Some(job) = Job::open(path)? else { return Ok(folder) };
        return match job.is_chance() {
            true => refuse("is a job of `plaus chance`, not a run".to_owned()),
            false if job.merged().exists() => {
                refuse(format!("is a job, not a run; its run is {}", quoted(&path.join("run"))))
            }
            false => refuse(format!("is a job that is not merged yet; its progress: plaus status {}", quoted(path))),
        };
    }
    let outer = path.parent().filter(|outer| !path.exists() && outer.join("job.json").is_file());
    match outer {
        Some(job) => refuse(format!("is not merged yet; the job's progress: plaus status {}", quoted(job))),
        None => Ok(folder),
    }
}

/// Why a run has no draws for statistics, or none at all, and how to get them.
fn no_draws(run: &RunReader<'_>) -> Failure {
    let (manifest, path) = (run.run().manifest(), run.run().folder().path());
    let (plan, shown) = (manifest.plan, quoted(path));
    let found = Tally::of(run).map_or(0, |tally| tally.distinct);
    let why = if plan.enough().is_some_and(|wanted| found >= wanted) {
        format!(
            "all {} of this run were found in its warm-up, which statistics leave out. For draws that count: \
             `plaus resume {shown} --solutions all{}`",
            counted(found, "solution"),
            summary::for_a_while(&plan)
        )
    } else if run.iterations() <= plan.warmup {
        format!(
            "holds no draws yet: the run stopped at iteration {} of {}{}; `plaus resume {shown}` continues it",
            grouped(run.iterations()),
            grouped(plan.end()),
            if plan.warmup > 0 { ", in its warm-up, which statistics leave out" } else { "" }
        )
    } else {
        format!(
            "holds no draws: it records one in {} iterations (`thin`), and none was due after the warm-up",
            grouped(plan.thin)
        )
    };
    Failure::Message(format!("{}: {why}", path.display()))
}

/// Opens a run to read it. Tells which of its files were edited, what is left of one that `is_salvaged`, or that it is
/// still being written; `does` is what the command does with its last checkpoint.
fn opened(path: &Path, is_salvaged: bool, does: &str) -> Result<Run, Failure> {
    let run = Run::open(&run_at(path)?)?;
    scenario_file::tell_edited(run.manifest(), path);
    if is_salvaged {
        let run = run.salvaged();
        console::note_line(&salvage(&run.reader()?));
        return Ok(run);
    }
    if run.folder().is_being_written() {
        console::remark(&format!("the run is still being written; this {does} its last checkpoint"));
    }
    Ok(run)
}

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
    /// Sample a scenario, make its page and open it.
    ///
    /// Looks for 12 different solutions, or `--solutions K`, for a minute at most. The next try replaces this one.
    Try(attempt::Args),
    /// Write a commented scenario file for a scene.
    New(new::Args),
    /// Check a scenario file, and show what it says; with `--all`, also all defaults.
    Check(check::Args),
    /// Sample a scenario into a run folder.
    Sample(sample::Args),
    /// Continue a run from its last checkpoint, or make it longer.
    Resume(resume::Args),
    /// Make a page that samples a scenario in the browser, and open it.
    ///
    /// Looks for the first 3 different solutions, or `--solutions K`, for a minute at most. The page then goes on, for
    /// as long as it is open.
    Live(attempt::Live),
    /// Make a page on which scenarios are written and sampled.
    ///
    /// It shows what is wrong with a scenario, and its solutions beside it. A link to the page can carry a scenario.
    Playground(playground::Args),
    /// Make a page that plays the distinct solutions of a run.
    Gallery(gallery::Args),
    /// Write draws as a table, or samples as animations, pictures, sound.
    Export(export::Args),
    /// Rebuild the animation of one sample from its draw.
    Replay(replay::Args),
    /// Plot where things end, or the distribution of a number.
    Plot(plot::Args),
    /// Show whether the chains of a run have converged.
    ///
    /// R-hat, effective sample sizes, acceptance of each move, and signs of poor convergence.
    Diagnose(diagnose::Args),
    /// Estimate the probability that a random draw is a solution.
    Chance(chance::Args),
    /// Split a run across machines and submit it to a scheduler.
    Submit(submit::Args),
    /// Show a job's progress.
    Status(status::Args),
    /// Merge the pieces of a run, or of `plaus chance`, byte for byte.
    ///
    /// The result is what one machine would have made.
    Merge(merge::Args),
    /// Explain a scenario key or a word, or list all keys.
    Explain(explain::Args),
    /// Print the JSON Schema of scenario files.
    Schema,
    /// Print completions for a shell.
    Completions(completions::Args),
}

/// The commands in groups, as `plaus --help` lists them.
const GROUPS: [(&str, &[&str]); 4] = [
    ("Every day", &["try", "new", "check", "sample", "resume", "gallery", "live", "playground", "export", "replay"]),
    ("Statistics", &["plot", "diagnose", "chance"]),
    ("Many machines", &["submit", "status", "merge"]),
    ("Help", &["explain", "schema", "completions", "help"]),
];

/// The help of the program, with its commands in groups.
pub(crate) fn grouped_help(mut program: clap::Command) -> clap::Command {
    program.build();
    let mut text = String::from("{about}\n\n{usage-heading} {usage}\n");
    for (title, names) in GROUPS {
        text += &format!("\n{title}:\n");
        for name in names {
            let about = program.find_subcommand(name).and_then(clap::Command::get_about);
            text += &format!("  {name:<13}{}\n", about.map(ToString::to_string).unwrap_or_default());
        }
    }
    program.help_template(text + "\nOptions:\n{options}{after-help}")
}

impl Command {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<Outcome, Failure> {
        match self {
            Self::Try(args) => args.run(),
            Self::New(args) => args.run(),
            Self::Check(args) => args.run(),
            Self::Sample(args) => args.run(),
            Self::Chance(args) => args.run(),
            Self::Resume(args) => args.run(),
            Self::Merge(args) => args.run(),
            Self::Submit(args) => args.run(),
            Self::Status(args) => args.run(),
            Self::Plot(args) => args.run(),
            Self::Diagnose(args) => args.run(),
            Self::Export(args) => args.run(),
            Self::Gallery(args) => args.run(),
            Self::Live(args) => args.run(),
            Self::Playground(args) => args.run(),
            Self::Replay(args) => args.run(),
            Self::Schema => schema::run(),
            Self::Explain(args) => args.run(),
            Self::Completions(args) => args.run(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_is_in_one_group() {
        let mut program = Command::augment_subcommands(clap::Command::new("plaus"));
        program.build();
        let mut all: Vec<&str> = program.get_subcommands().map(clap::Command::get_name).collect();
        let mut grouped = GROUPS.map(|(_, names)| names).concat();
        all.sort_unstable();
        grouped.sort_unstable();
        assert_eq!(all, grouped);
    }
}
