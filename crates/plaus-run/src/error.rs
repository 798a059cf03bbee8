//! What can go wrong with the files of a run.

use crate::codec::{EncodeError, FrameError};
use plaus_mcmc::{ChainError, ModelError, RunError};
use plaus_scenes::ConfigError;
use std::io;
use std::path::{Path, PathBuf};

/// A file of a run, and what is wrong with it.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", .path.display())]
pub struct RunFileError {
    /// The file or folder.
    pub path: PathBuf,
    /// What is wrong, and what can be done.
    pub problem: RunFileProblem,
}

/// What is wrong with a file of a run.
#[derive(Debug, thiserror::Error)]
pub enum RunFileProblem {
    /// The operating system refused.
    #[error("cannot {action}: {source}")]
    Io {
        /// What was attempted.
        action: &'static str,
        /// What came back.
        source: io::Error,
    },
    /// Nothing is overwritten.
    #[error("exists already; choose another name, or `plaus resume` it if it is a run to go on with")]
    Exists,
    /// Nothing is overwritten unasked.
    #[error("exists already; choose another name, or replace it by `--force`")]
    OutputExists,
    /// Something that no export makes.
    #[error("exists already and was not made by such an export: it is not replaced, not even by `--force`")]
    NotOurs,
    /// Nothing is there.
    #[error("there is no such run")]
    Missing,
    /// A folder that is no run.
    #[error("is no run: it has no manifest.json")]
    NoRun,
    /// Another process is writing.
    #[error("another process is writing this run; wait for it, or stop it first")]
    Locked,
    /// The manifest cannot be believed.
    #[error(
        "the manifest cannot be read: {0}. Without it the records of the chains cannot be read either; the same scenario, seed and version of plaus sample the same run again"
    )]
    Manifest(String),
    /// The run's copy of a file that its scenario names is another.
    #[error(
        "this copy of {0}, which the run's scenario names, was changed after the run was made: put it back as it was, \
         or sample a new run"
    )]
    Asset(String),
    /// The folder holds something else than what is to be gone on with.
    #[error("holds another run: {0}; choose another name")]
    OtherRun(String),
    /// Pieces that make no whole.
    #[error("{0}")]
    Pieces(String),
    /// Another version of plaus made the run.
    #[error("made by plaus {made}, this is {present}, which may sample other values: resume it with plaus {made}")]
    OtherVersion {
        /// The version that made it.
        made: String,
        /// This one.
        present: &'static str,
    },
    /// A frame of the records is damaged.
    #[error(
        "{source}. The {intact} recorded draws of the chain before that are intact: `plaus export --salvage` reads what all chains have; the same scenario and seed sample all of them again"
    )]
    Records {
        /// What and where.
        source: FrameError,
        /// Recorded draws before the damage, warm-up included.
        intact: u64,
    },
    /// A checkpoint is damaged.
    #[error(
        "{source}. The run cannot go on from here, but the chain's records are not touched by this: `plaus export --salvage` reads them; the same scenario and seed sample the run again"
    )]
    Checkpoint {
        /// What and where.
        source: FrameError,
    },
    /// The checkpoint of a chain is not there, though those of others are.
    #[error(
        "this checkpoint is gone, while other chains have theirs, of iteration {newest}: the run cannot go on. The records are \
         not touched by this: `plaus export --salvage` and `plaus gallery --salvage` read them; the same scenario and \
         seed sample the run again"
    )]
    Gone {
        /// Iterations that the others' checkpoints cover.
        newest: u64,
    },
    /// The parts of the run do not fit each other.
    #[error(
        "{0}: files of different runs, or of different moments of one run, were mixed; the same scenario and seed sample the run again"
    )]
    Mixed(String),
    /// A stored state is not what this program makes of its draw.
    #[error("{0}: this plaus does not compute what the one that made the run computed")]
    Differs(String),
    /// A list of confirmed solutions that cannot be used.
    #[error("the list of confirmed solutions cannot be used: {0}")]
    List(String),
    /// A value that cannot be stored.
    #[error(transparent)]
    Encode(#[from] EncodeError),
    /// There is nothing to read yet.
    #[error(
        "holds no draws yet: the run was stopped in its warm-up, whose draws are no statistics, or before its first checkpoint \
         (`plaus resume` goes on with it), or it records so few of its iterations (`thin`) that none was due"
    )]
    Empty,
    /// A sample that does not exist.
    #[error("{0}")]
    NoSample(String),
}

impl RunFileError {
    /// Blames `path`.
    pub fn new(path: impl Into<PathBuf>, problem: RunFileProblem) -> Self {
        Self { path: path.into(), problem }
    }

    pub(crate) fn io(path: &Path, action: &'static str) -> impl FnOnce(io::Error) -> Self {
        move |source| Self::new(path, RunFileProblem::Io { action, source })
    }

    /// Whether the disk is full, or a quota used up.
    #[must_use]
    pub fn is_disk_full(&self) -> bool {
        let RunFileProblem::Io { source, .. } = &self.problem else { return false };
        use io::ErrorKind::{FileTooLarge, QuotaExceeded, StorageFull, WriteZero};
        matches!(source.kind(), StorageFull | QuotaExceeded | FileTooLarge | WriteZero)
    }
}

/// Why a run could not be made, read or gone on with.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A file of the run.
    #[error(transparent)]
    File(#[from] RunFileError),
    /// The disk is full. The run is as it was at its last checkpoint.
    #[error(
        "{source}. The run is safe up to iteration {safe}: free some space, then `plaus resume` goes on from there"
    )]
    DiskFull {
        /// What failed.
        source: RunFileError,
        /// Iterations 0 up to here, exclusive, are kept.
        safe: u64,
    },
    /// The run could not be written on. It is as it was at its last checkpoint.
    #[error("{source}. The run is safe up to iteration {safe}: once that is mended, `plaus resume` goes on from there")]
    BrokenOff {
        /// What failed.
        source: RunFileError,
        /// Iterations 0 up to here, exclusive, are kept.
        safe: u64,
    },
    /// The scenario makes no scene.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The scenario stored in the manifest cannot be read by this version.
    #[error("the scenario in the manifest cannot be read: {0}")]
    StoredScenario(String),
    /// The model failed while sampling or replaying.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A chain failed while sampling; the run keeps what came before.
    #[error("chain {chain}: {source}. The run keeps the first {safe} iterations of each chain")]
    Chain {
        /// Which.
        chain: u32,
        /// How.
        source: ChainError,
        /// Iterations 0 up to here, exclusive, are kept.
        safe: u64,
    },
    /// Sampling could not go on.
    #[error("{0}")]
    Sampling(String),
    /// What was asked for cannot be written.
    #[error("cannot write: {0}")]
    Output(io::Error),
    /// A request that makes no sense for this run.
    #[error("{0}")]
    Request(String),
}

impl Error {
    /// Sorts out why a run broke off; `safe` iterations are kept.
    pub(crate) fn of_run(error: RunError<RunFileError>, safe: u64) -> Self {
        match error {
            RunError::Sink(source) if source.is_disk_full() => Self::DiskFull { source, safe },
            RunError::Sink(source) => Self::BrokenOff { source, safe },
            RunError::Chain { chain, source } => Self::Chain { chain, source, safe },
            other => Self::Sampling(format!("{other}. The run keeps the first {safe} iterations of each chain")),
        }
    }
}
