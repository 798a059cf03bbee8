//! How pieces are named on the command line, and where they lie.

use crate::failure::Failure;
use plaus_run::{Shard, ShardError};
use std::env;
use std::path::{Path, PathBuf};

/// Where engines say which task of an array this is: the innermost first, as HyperQueue's workers may run within an
/// array of Slurm.
const TASKS: [&str; 2] = ["HQ_TASK_ID", "SLURM_ARRAY_TASK_ID"];
/// What stands for the number of the piece in `--out`.
pub(super) const PLACE: &str = "{shard}";

/// Reads `3/16`, or `task/16`.
pub(super) fn named(text: &str) -> Result<Shard, Failure> {
    let refuse = |error: &dyn std::fmt::Display| Failure::Message(format!("--shard {text}: {error}"));
    let Some(of) = text.strip_prefix("task/") else {
        return text.parse().map_err(|error: ShardError| refuse(&error));
    };
    let task = TASKS.into_iter().find_map(|name| Some((name, env::var(name).ok()?)));
    let (name, value) = task.ok_or_else(|| refuse(&format!("neither {} nor {} is set", TASKS[0], TASKS[1])))?;
    format!("{value}/{of}").parse().map_err(|error: ShardError| refuse(&format!("{name} is `{value}`: {error}")))
}

/// The folder of a piece: `{shard}` as the last part of `out` is its number. Nowhere else, so that folders may be
/// called what they like.
pub(super) fn folder(out: &Path, shard: Option<Shard>) -> PathBuf {
    match shard {
        Some(shard) if out.file_name().is_some_and(|name| name == PLACE) => {
            out.with_file_name(shard.piece().to_string())
        }
        _ => out.to_owned(),
    }
}
