//! What can go wrong with the files of a run.

use crate::codec::{EncodeError, FrameError};
use crate::sample_id::SampleId;
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
#[non_exhaustive]
pub enum RunFileProblem {
    /// The operating system refused.
    #[error("cannot {action}: {source}{}", advice(source))]
    Io {
        /// What was attempted.
        action: &'static str,
        /// What came back.
        source: io::Error,
    },
    /// Something exists already; nothing is overwritten.
    #[error("already exists; choose another name, or continue it with `plaus resume` if it is a run")]
    Exists,
    /// Something took the place while this run was being made; nothing is overwritten.
    #[error("another run started here at the same time and took this name; choose another name, or wait for that run")]
    Taken,
    /// Something exists already; nothing is overwritten unless that is asked for.
    #[error("already exists")]
    OutputExists,
    /// Something that no export made.
    #[error("already exists and was not made by such an export, so it is not replaced")]
    NotOurs,
    /// Nothing is there.
    #[error("there is no such run")]
    Missing,
    /// A folder that is not a run.
    #[error("is not a run: it has no manifest.json")]
    NoRun,
    /// Another process is writing.
    #[error("another process is writing this run; wait until it ends, or stop it")]
    Locked,
    /// The manifest cannot be trusted.
    #[error(
        "the manifest cannot be read: {0}. Without it the records of the chains cannot be read either. To get the same run, sample again with the same scenario, seed and version of plaus"
    )]
    Manifest(String),
    /// The run's copy of a file that its scenario names has changed.
    #[error(
        "this copy of {0}, which the run's scenario names, was changed after the run was made: restore the file, \
         or sample a new run"
    )]
    Asset(String),
    /// A folder that is to be replaced, and is not a run, or holds other things too.
    #[error("holds something other than a run, so it is not replaced: choose another name")]
    Foreign,
    /// The folder holds something other than the run to continue.
    #[error("holds another run: {0}; choose another name")]
    OtherRun(String),
    /// Pieces that do not make a whole.
    #[error("{0}")]
    Pieces(String),
    /// Another version of plaus made the run.
    #[error("made by plaus {made}; this is {present}, which may sample other values: resume it with plaus {made}")]
    OtherVersion {
        /// The version that made it.
        made: String,
        /// This one.
        present: &'static str,
    },
    /// A frame of the records is damaged.
    #[error(
        "{source}. The {intact} draws that the chain recorded before are intact. The same scenario and seed give all of them again"
    )]
    Records {
        /// What and where.
        source: FrameError,
        /// Recorded draws before the damage, warm-up included.
        intact: u64,
    },
    /// A checkpoint is damaged.
    #[error(
        "{source}. The run cannot be continued, but the records are not affected. The same scenario and seed give the run again"
    )]
    Checkpoint {
        /// What and where.
        source: FrameError,
    },
    /// The file of checkpoints is missing.
    #[error(
        "this file is gone: the run cannot be continued. The records are not affected. The same scenario and seed give \
         the run again"
    )]
    Gone,
    /// The parts of the run do not fit each other.
    #[error(
        "{0}: files of different runs, or of different moments of one run, were mixed. The same scenario and seed give the run again"
    )]
    Mixed(String),
    /// This program computes something else from a draw than the stored state.
    #[error("{0}: this plaus computes other values than the one that made the run")]
    Differs(String),
    /// There is no list of confirmed solutions.
    #[error("no solution has been confirmed yet")]
    Unconfirmed,
    /// A list of confirmed solutions that cannot be used.
    #[error("the list of confirmed solutions cannot be used: {0}")]
    List(String),
    /// A value that cannot be stored.
    #[error(transparent)]
    Encode(#[from] EncodeError),
    /// There is nothing to read yet.
    #[error(
        "holds no draws yet: the run ended in its warm-up, which statistics leave out, or before its first checkpoint, \
         or it records so few of its iterations (`thin`) that none was due"
    )]
    Empty,
    /// A sample that does not exist.
    #[error("{0}")]
    NoSample(String),
    /// A sample of a run that ended in its warm-up.
    #[error("there are no draws after the warm-up, whose own draws are {}:w0 to {last}", last.chain)]
    OnlyWarmup {
        /// The last draw.
        last: SampleId,
        /// Whether the run looked for solutions, which may be among them.
        has_solutions: bool,
    },
}

/// What to do where the operating system refuses permission.
fn advice(source: &io::Error) -> &'static str {
    use io::ErrorKind::{PermissionDenied, ReadOnlyFilesystem};
    match source.kind() {
        PermissionDenied | ReadOnlyFilesystem => {
            "; ask whoever owns it for permission, or work in a folder of your own (of a run: on a copy)"
        }
        _ => "",
    }
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

/// Why a run could not be made, read or continued.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file of the run.
    #[error(transparent)]
    File(#[from] RunFileError),
    /// The disk is full. The run is as it was at its last checkpoint.
    #[error("{source}. The run is safe up to iteration {safe}: free some space, then continue with `plaus resume`")]
    DiskFull {
        /// What failed.
        source: RunFileError,
        /// Iterations 0 up to here, exclusive, are kept.
        safe: u64,
    },
    /// The run could not be written any further. It is as it was at its last checkpoint.
    #[error(
        "{source}. The run is safe up to iteration {safe}: once the problem is fixed, continue with `plaus resume`"
    )]
    BrokenOff {
        /// What failed.
        source: RunFileError,
        /// Iterations 0 up to here, exclusive, are kept.
        safe: u64,
    },
    /// The scenario is invalid.
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
        /// The chain.
        chain: u32,
        /// Its error.
        source: ChainError,
        /// Iterations 0 up to here, exclusive, are kept.
        safe: u64,
    },
    /// Sampling could not continue.
    #[error("{0}")]
    Sampling(String),
    /// The output cannot be written.
    #[error("cannot write: {0}")]
    Output(io::Error),
    /// A request that makes no sense for this run.
    #[error("{0}")]
    Request(String),
}

impl Error {
    /// Determines why a run broke off; `safe` iterations are kept.
    pub(crate) fn of_run(error: RunError<RunFileError>, safe: u64) -> Self {
        match error {
            RunError::Sink(source) if source.is_disk_full() => Self::DiskFull { source, safe },
            RunError::Sink(source) => Self::BrokenOff { source, safe },
            RunError::Chain { chain, source } => Self::Chain { chain, source, safe },
            other => Self::Sampling(format!("{other}. The run keeps the first {safe} iterations of each chain")),
        }
    }
}
