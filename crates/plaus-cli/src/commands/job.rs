//! The folder of a job: everything that its pieces need, on a disk that all machines share.
//!
//! | path | what |
//! | --- | --- |
//! | `job.json` | which run, in how many pieces, on which engine |
//! | `scenario/NAME.toml` | the scenario file, as it was |
//! | `submit/` | what the engine is given |
//! | `pieces/3` | a piece: a run of its own |
//! | `logs/` | what the tasks printed |
//! | `run` | the whole run, once it is merged |
//! | `chance.json` | in place of `run`, where the pieces are batches of `plaus chance`: all of them, merged |

use crate::commands::shards::PLACE;
use crate::failure::Failure;
use plaus_run::manifest::VERSION;
use plaus_run::{Folder, Recipe, Shard};
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::{Path, PathBuf};

/// Who runs the pieces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Engine {
    /// Slurm: a job array, and a job that depends on it.
    Slurm,
    /// HyperQueue: a job file of tasks.
    Hyperqueue,
    /// Open Job Description, as AWS Deadline Cloud and `openjd` run it: a template.
    Openjd,
    /// Processes on this machine.
    Local,
}

/// What `job.json` holds.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Description {
    /// Version of plaus that wrote it. Its pieces must have the same.
    pub(super) plaus: String,
    pub(super) engine: Engine,
    pub(super) pieces: u32,
    /// How many chains, or batches, are cut into pieces.
    pub(super) total: u32,
    /// Name of the scenario file in the job's folder `scenario`.
    pub(super) scenario: String,
    pub(super) overrides: Vec<String>,
    pub(super) solutions: Option<u64>,
    /// Flags of `plaus chance`. Absent if the job is a run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) chance: Option<Vec<String>>,
    /// Threads of each piece.
    pub(super) threads: usize,
    /// Path of the program, the same on all machines.
    pub(super) program: String,
    /// Options added to the engine's own command.
    pub(super) options: Vec<String>,
}

/// A job with its folder.
pub(crate) struct Job {
    path: PathBuf,
    pub(super) what: Description,
}

/// A path as text for scripts. It is absolute, because tasks start in folders of their own.
pub(super) fn text_of(path: &Path) -> Result<String, Failure> {
    let absolute = std::path::absolute(path).map_err(|error| refuse(path, &error))?;
    let text = absolute.to_str().map(str::to_owned);
    text.ok_or_else(|| refuse(path, &"its name is not UTF-8 text, which the engines' files must be"))
}

fn refuse(path: &Path, why: &dyn std::fmt::Display) -> Failure {
    Failure::Message(format!("{}: {why}", path.display()))
}

impl Job {
    /// Makes the folder of a job, and writes what does not depend on the engine.
    pub(super) fn create(path: &Path, recipe: &Recipe, what: Description) -> Result<Self, Failure> {
        Shard::new(1, what.pieces)
            .and_then(|first| first.range(what.total))
            .map_err(|error| Failure::Message(format!("--shards {}: {error}", what.pieces)))?;
        text_of(path)?;
        let job = Self { path: std::path::absolute(path).map_err(|error| refuse(path, &error))?, what };
        if let Some(parent) = job.path.parent() {
            fs::create_dir_all(parent).map_err(|error| refuse(parent, &error))?;
        }
        fs::create_dir(&job.path).map_err(|error| match error.kind() {
            std::io::ErrorKind::AlreadyExists => refuse(path, &"already exists; choose another name"),
            _ => refuse(path, &error),
        })?;
        for folder in ["scenario", "submit", "pieces", "logs"] {
            fs::create_dir(job.path.join(folder)).map_err(|error| refuse(path, &error))?;
        }
        let json = serde_json::to_string_pretty(&job.what).map_err(|error| refuse(path, &error))?;
        job.write(&Path::new("scenario").join(&job.what.scenario), &recipe.text)?;
        job.write(Path::new("job.json"), &format!("{json}\n"))?;
        Ok(job)
    }

    /// Opens the folder of a job; `None` if it is not one.
    pub(crate) fn open(path: &Path) -> Result<Option<Self>, Failure> {
        let file = path.join("job.json");
        let json = match fs::read(&file) {
            Err(error) if matches!(error.kind(), std::io::ErrorKind::NotFound | std::io::ErrorKind::NotADirectory) => {
                return Ok(None);
            }
            json => json.map_err(|error| refuse(&file, &error))?,
        };
        let what: Description = serde_json::from_slice(&json).map_err(|error| refuse(&file, &error))?;
        Shard::new(1, what.pieces).map_err(|error| refuse(&file, &error))?;
        if what.plaus != VERSION {
            let why =
                format!("made by plaus {}, but this is {VERSION}: their pieces would not fit together", what.plaus);
            return Err(refuse(path, &why));
        }
        Ok(Some(Self { path: std::path::absolute(path).map_err(|error| refuse(path, &error))?, what }))
    }

    /// Its folder.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Whether its pieces are batches of `plaus chance`, each in a file.
    pub(crate) fn is_chance(&self) -> bool {
        self.what.chance.is_some()
    }

    /// Where all pieces are merged: the folder of a run, or the file of a chance.
    pub(crate) fn merged(&self) -> PathBuf {
        self.path.join(if self.is_chance() { "chance.json" } else { "run" })
    }

    /// The folder of a piece of a run.
    pub(crate) fn piece(&self, shard: Shard) -> Folder {
        Folder::new(self.path.join("pieces").join(shard.piece().to_string()))
    }

    /// The file of a piece of a chance.
    pub(crate) fn batches(&self, shard: Shard) -> PathBuf {
        self.path.join("pieces").join(format!("{}.json", shard.piece()))
    }

    /// Its pieces.
    pub(crate) fn pieces(&self) -> impl Iterator<Item = Shard> {
        Shard::all(self.what.pieces)
    }

    /// Writes a file of its folder.
    pub(super) fn write(&self, name: &Path, text: &str) -> Result<PathBuf, Failure> {
        let path = self.path.join(name);
        fs::write(&path, text).map_err(|error| refuse(&path, &error))?;
        Ok(path)
    }

    /// The command of a piece, one argument each; `piece` is its number, or the engine's placeholder for it.
    pub(super) fn piece_command(&self, piece: &str) -> Result<Vec<String>, Failure> {
        let Description { pieces, scenario, overrides, solutions, chance, threads, program, .. } = &self.what;
        let scenario = text_of(&self.path.join("scenario").join(scenario))?;
        let (verb, end) = if chance.is_some() { ("chance", ".json") } else { ("sample", "") };
        let out = text_of(&self.path.join("pieces").join(format!("{PLACE}{end}")))?;
        let mut words = vec![program.clone(), verb.to_owned(), scenario];
        words.extend(overrides.iter().map(|set| format!("--set={set}")));
        words.extend(solutions.map(|wanted| format!("--solutions={wanted}")));
        words.extend(chance.iter().flatten().cloned());
        words.extend([format!("--shard={piece}/{pieces}"), format!("--out={out}")]);
        // `plaus chance` always continues what is there.
        words.extend(chance.is_none().then(|| "--continue".to_owned()));
        words.extend([format!("--threads={threads}"), "--quiet".to_owned()]);
        Ok(words)
    }

    /// The command that merges the pieces, one argument each.
    pub(super) fn merge_command(&self) -> Result<Vec<String>, Failure> {
        let (pieces, out) = (text_of(&self.path.join("pieces"))?, text_of(&self.merged())?);
        Ok(vec![self.what.program.clone(), "merge".to_owned(), pieces, format!("--out={out}"), "--quiet".to_owned()])
    }
}
