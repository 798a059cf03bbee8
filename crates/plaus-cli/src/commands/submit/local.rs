//! The engine for one machine: one process for each piece, several at a time. A process that is killed is started
//! again.

use super::engines::in_shell;
use crate::clock::Stopwatch;
use crate::commands::job::Job;
use crate::commands::status;
use crate::console;
use crate::failure::{Failure, Outcome};
use crate::interrupt;
use std::collections::VecDeque;
use std::fs::File;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Duration;

/// Time between two checks for processes that have ended.
const TICK: Duration = Duration::from_millis(20);
/// Seconds between two lines of progress.
const EVERY: f64 = 5.0;
/// How often a piece is started before it is given up.
const ATTEMPTS: u32 = 3;

struct Working {
    piece: u32,
    attempt: u32,
    process: Child,
}

/// Runs the pieces numbered `wanted`, as many at a time as there are cores for, then merges.
pub(super) fn run(job: &Job, wanted: &[u32]) -> Result<Outcome, Failure> {
    interrupt::listen()?;
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let slots = (cores / job.what.threads.max(1)).max(1);
    let mut waiting: VecDeque<(u32, u32)> = wanted.iter().map(|&piece| (piece, 1)).collect();
    let (mut working, mut failed) = (Vec::<Working>::new(), Vec::new());
    let mut shown = Stopwatch::start();
    while !(waiting.is_empty() && working.is_empty()) {
        while !interrupt::asked() && working.len() < slots {
            let Some((piece, attempt)) = waiting.pop_front() else { break };
            working.push(Working { piece, attempt, process: start(job, piece)? });
        }
        let mut index = 0;
        while index < working.len() {
            let ended = working[index].process.try_wait();
            let Some(status) = ended.map_err(|error| Failure::Message(format!("cannot wait for a piece: {error}")))?
            else {
                index += 1;
                continue;
            };
            let Working { piece, attempt, .. } = working.swap_remove(index);
            match status.code() {
                Some(0) => {}
                None if attempt < ATTEMPTS && !interrupt::asked() => {
                    console::note_line(&format!(
                        "piece {piece} was killed ({status}): it continues from its checkpoint"
                    ));
                    waiting.push_back((piece, attempt + 1));
                }
                _ => failed.push(piece),
            }
        }
        if interrupt::asked() {
            // They got the same signal, or get it now: they write a checkpoint and end.
            working.iter().for_each(|one| interrupt::pass_on(one.process.id()));
            waiting.clear();
        }
        if shown.seconds() >= EVERY {
            shown = Stopwatch::start();
            console::note_line(&status::in_a_line(job));
        }
        thread::sleep(TICK);
    }
    finish(job, failed)
}

fn start(job: &Job, piece: u32) -> Result<Child, Failure> {
    let words = job.piece_command(&piece.to_string())?;
    let log = job.path().join("logs").join(format!("piece-{piece}.txt"));
    let log = File::options().create(true).append(true).open(&log);
    let log = log.map_err(|error| Failure::Message(format!("logs/piece-{piece}.txt: {error}")))?;
    let mut command = Command::new(&words[0]);
    let started = command.args(&words[1..]).stdin(Stdio::null()).stdout(Stdio::null()).stderr(log).spawn();
    started.map_err(|error| Failure::Message(format!("cannot start `{}`: {error}", in_shell(&words))))
}

fn finish(job: &Job, mut failed: Vec<u32>) -> Result<Outcome, Failure> {
    let again = in_shell(&[job.path().display().to_string()]);
    if interrupt::asked() {
        console::note_line(&format!("interrupted; continue with: plaus submit --again {again} --go"));
        return Ok(Outcome::Interrupted);
    }
    if !failed.is_empty() {
        failed.sort_unstable();
        let pieces = super::engines::ranges(&failed);
        return Err(Failure::Message(format!(
            "pieces {pieces} failed; `plaus status {again}` says why, `plaus submit --again {again} --go` continues \
                 them"
        )));
    }
    let words = job.merge_command()?;
    let merged = Command::new(&words[0]).args(&words[1..]).stdin(Stdio::null()).status();
    let merged = merged.map_err(|error| Failure::Message(format!("cannot start `{}`: {error}", in_shell(&words))))?;
    if !merged.success() {
        return Err(Failure::Message("the pieces could not be merged, see above".to_owned()));
    }
    let look = if job.is_chance() { "chance" } else { "diagnose" };
    console::note_line(&format!("done: plaus {look} {}", in_shell(&[job.merged().display().to_string()])));
    Ok(Outcome::Done)
}
