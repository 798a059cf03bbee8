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

/// Where a piece lies: `{shard}` as the last part of `out`, or `{shard}.json`, stands for its number. Nowhere else, so
/// that folders may be called what they like.
pub(super) fn place(out: &Path, shard: Option<Shard>) -> PathBuf {
    let name = out.file_name().and_then(|name| name.to_str());
    match (shard, name.and_then(|name| name.strip_prefix(PLACE))) {
        (Some(shard), Some(end @ ("" | ".json"))) => out.with_file_name(format!("{}{end}", shard.piece())),
        _ => out.to_owned(),
    }
}
