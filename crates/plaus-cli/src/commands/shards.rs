//! How pieces are named on the command line, and where they lie.

use crate::failure::Failure;
use plaus_run::{Shard, ShardError};
use std::env;
use std::path::{Path, PathBuf};

/// Variables in which engines give the number of this task in its array. The innermost comes first, because
/// HyperQueue's workers may run within an array of Slurm.
const TASKS: [&str; 2] = ["HQ_TASK_ID", "SLURM_ARRAY_TASK_ID"];
/// Placeholder in `--out` for the number of the piece.
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

/// Where a piece lies: a last part `{shard}` or `{shard}.json` of `out` gets its number. Nothing else is replaced, so
/// that folders may have any name.
pub(super) fn place(out: &Path, shard: Option<Shard>) -> PathBuf {
    let name = out.file_name().and_then(|name| name.to_str());
    match (shard, name.and_then(|name| name.strip_prefix(PLACE))) {
        (Some(shard), Some(end @ ("" | ".json"))) => out.with_file_name(format!("{}{end}", shard.piece())),
        _ => out.to_owned(),
    }
}
