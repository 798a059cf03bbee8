//! `plaus submit`

mod engines;
mod local;

use super::asking::How;
use super::job::{self, Description, Engine, Job};
use super::status::{self, Standing};
use super::wanted::Wanted;
use crate::console;
use crate::failure::{Failure, Outcome};
use crate::output;
use engines::in_shell;
use plaus_run::Folder;
use plaus_run::chance::Asking;
use plaus_run::manifest::VERSION;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Which run, in how many pieces, on which engine.
#[derive(clap::Args)]
#[command(args_conflicts_with_subcommands = true)]
pub(crate) struct Args {
    #[command(flatten)]
    wanted: Option<Wanted>,
    /// Engine that runs the pieces
    #[arg(long, value_name = "ENGINE", required_unless_present = "again")]
    to: Option<Engine>,
    /// Number of pieces to cut the run into: at most as many as it has chains, or as `plaus chance` makes batches
    #[arg(long, value_name = "N", required_unless_present = "again", value_parser = clap::value_parser!(u32).range(1..))]
    shards: Option<u32>,
    /// Folder to make for the job, on a disk that all machines share; must not exist
    #[arg(long, value_name = "JOB", required_unless_present = "again")]
    out: Option<PathBuf>,
    /// Submit the pieces of a job that are neither finished nor running: they continue from their checkpoints
    #[arg(long, value_name = "JOB", conflicts_with_all = ["scenario", "to", "shards", "out", "program"])]
    again: Option<PathBuf>,
    /// Estimate a probability, as `plaus chance` does, instead of sampling; `--iterations` then counts those of each
    /// rung
    #[arg(long, conflicts_with = "again")]
    chance: bool,
    /// Submit the job. Without this flag, it is only written and shown
    #[arg(long)]
    go: bool,
    /// Threads of each piece
    #[arg(long, value_name = "T", default_value_t = 1)]
    threads: u16,
    /// Path of `plaus` on the machines that run the pieces [default: its path here]
    #[arg(long, value_name = "PATH")]
    program: Option<PathBuf>,
    /// Further options for the engine's own command, e.g. `-- --partition=long --time=24:00:00`
    #[arg(last = true, value_name = "OPTIONS")]
    options: Vec<String>,
    #[command(flatten, next_help_heading = "With --chance")]
    how: How,
}

impl Args {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let go = self.go;
        let job = match &self.again {
            Some(path) => Job::open(path)?.ok_or_else(|| {
                let is_run = Folder::new(path).manifest().exists();
                let advice = if is_run { "; it is a run, which `plaus resume` continues" } else { "" };
                Failure::Message(format!("{}: this is not a job: it has no job.json{advice}", path.display()))
            })?,
            None => self.create()?,
        };
        let wanted: Vec<u32> = status::of_job(&job)
            .into_iter()
            .filter(|(_, standing)| !matches!(standing.standing, Standing::Done | Standing::Running))
            .map(|(shard, _)| shard.piece())
            .collect();
        if job.merged().exists() {
            console::note_line(&format!("this job is done: {}", job.merged().display()));
            return Ok(Outcome::Done);
        }
        let commands = engines::write(&job, &wanted)?;
        show(&job, &wanted, &commands)?;
        match (go, job.what.engine) {
            (false, _) => {
                let again = in_shell(&["--again".to_owned(), job.path().display().to_string()]);
                console::note_line(&format!(
                    "\nnothing has been submitted yet; to submit it: plaus submit {again} --go"
                ));
                Ok(Outcome::Done)
            }
            (true, Engine::Local) => local::run(&job, &wanted),
            (true, _) => submit(&commands),
        }
    }

    fn create(self) -> Result<Job, Failure> {
        let missing = || Failure::Message("name a scenario; or name a job with `--again`".to_owned());
        let (Some(wanted), Some(engine), Some(pieces), Some(out)) = (self.wanted, self.to, self.shards, self.out)
        else {
            return Err(missing());
        };
        if engine == Engine::Hyperqueue && job::text_of(&out)?.contains("%{") {
            let out = out.display();
            return Err(Failure::Message(format!("{out}: HyperQueue replaces `%{{…}}` in names; choose another")));
        }
        let program = match self.program {
            Some(program) => program,
            None => this_program()?,
        };
        let (recipe, total, chance) = if self.chance {
            let (recipe, iterations) = wanted.of_chance()?;
            let asking = self.how.asking(Asking::new(recipe.plan().seed), iterations);
            let mut words = self.how.words();
            words.extend(iterations.map(|iterations| format!("--iterations={iterations}")));
            (recipe, asking.batches, Some(words))
        } else if let Some(word) = self.how.words().first() {
            return Err(Failure::Message(format!("{word} can only be used with --chance")));
        } else {
            let recipe = wanted.recipe(false)?;
            let chains = recipe.scenario.sampler.chains;
            (recipe, chains, None)
        };
        let what = Description {
            plaus: VERSION.to_owned(),
            engine,
            pieces,
            total,
            scenario: recipe.file.clone(),
            overrides: recipe.overrides.clone(),
            solutions: recipe.solutions,
            chance,
            threads: usize::from(self.threads),
            program: job::text_of(&program)?,
            options: self.options,
        };
        Job::create(&out, &recipe, what)
    }
}

/// The file of the running command. Within another program, such as Python, that file would be Python itself, which
/// does not know our arguments.
fn this_program() -> Result<PathBuf, Failure> {
    let ask = "name the command plaus with `--program`, e.g. `--program \"$(command -v plaus)\"`";
    let program = std::env::current_exe()
        .map_err(|error| Failure::Message(format!("cannot find the program plaus: {error}; {ask}")))?;
    if program.file_stem().is_some_and(|name| name.to_string_lossy().starts_with("plaus")) {
        return Ok(program);
    }
    Err(Failure::Message(format!("plaus is running inside {}: {ask}", program.display())))
}

/// Shows what is, or would be, submitted: on stdout, the files with their contents, then the commands.
fn show(job: &Job, wanted: &[u32], commands: &[Vec<String>]) -> Result<(), Failure> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(job.path().join("submit"))
        .map(|entries| entries.flatten().map(|entry| entry.path()).collect())
        .unwrap_or_default();
    files.sort();
    for file in files {
        output::print(&excerpt(&file))?;
    }
    let pieces = engines::ranges(wanted);
    output::print_line(&format!("# pieces {pieces} of {}, then merge", job.what.pieces))?;
    commands.iter().try_for_each(|command| output::print_line(&in_shell(command)))
}

/// Number of lines of a file that are shown.
const SHOWN_LINES: usize = 40;

fn excerpt(path: &Path) -> String {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let lines = text.lines().count();
    let shown: String = text.lines().take(SHOWN_LINES).map(|line| format!("{line}\n")).collect();
    let more = if lines > SHOWN_LINES { format!("# and {} more lines\n", lines - SHOWN_LINES) } else { String::new() };
    format!("# {}\n{shown}{more}\n", path.display())
}

/// Runs the commands that submit, without a shell.
fn submit(commands: &[Vec<String>]) -> Result<Outcome, Failure> {
    let mut before = String::new();
    for command in commands {
        let words: Vec<String> = command.iter().map(|word| filled(word, &before)).collect();
        let Some((program, arguments)) = words.split_first() else { continue };
        let output = Command::new(program).args(arguments).stderr(Stdio::inherit()).output();
        let output = output.map_err(|error| {
            Failure::Message(match error.kind() {
                ErrorKind::NotFound => format!(
                    "there is no program `{program}` on this machine: submit where it is, or use another engine (`plaus \
                     submit --help`), such as `--to local`"
                ),
                _ => format!("cannot run `{program}`: {error}"),
            })
        })?;
        let said = String::from_utf8_lossy(&output.stdout).trim().to_owned();
        if !output.status.success() {
            return Err(Failure::Message(format!("`{}` failed ({}): {said}", in_shell(&words), output.status)));
        }
        console::note_line(&said);
        // Slurm prints `NUMBER` or `NUMBER;CLUSTER`.
        before = said.split(';').next().unwrap_or_default().to_owned();
    }
    Ok(Outcome::Done)
}

fn filled(word: &str, before: &str) -> String {
    match word.strip_prefix("--dependency=") {
        Some(_) if word.ends_with(engines::PIECES) => word.replace(engines::PIECES, before),
        _ => word.to_owned(),
    }
}
