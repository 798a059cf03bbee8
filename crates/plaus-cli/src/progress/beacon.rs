//! A small file in the folder of a piece that says how far the piece is. `plaus status` reads it, on any machine that
//! sees the folder; nothing else relies on it.

use crate::clock::unix_seconds;
use plaus_mcmc::ChainPulse;
use plaus_run::{Folder, Manifest};
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::PathBuf;

/// Most seconds between two signals. A thousand pieces then write about thirty files a second to a shared disk.
pub(crate) const LONGEST: f64 = 30.0;
/// Seconds between the first two.
const SHORTEST: f64 = 1.0;

/// What state a piece is in, by its own account.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum State {
    /// Running when this was written.
    Running,
    /// Finished.
    Done,
    /// Stopped before its end, with a checkpoint.
    Stopped,
    /// Failed.
    Failed,
}

/// How far a piece is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Signal {
    /// Its state.
    pub(crate) state: State,
    /// Why it failed.
    pub(crate) why: Option<String>,
    /// The number of the piece, and of how many.
    pub(crate) piece: u32,
    pub(crate) of: u32,
    /// Iterations that each chain has done, as a mean, and those that are planned.
    pub(crate) iteration: u64,
    pub(crate) end: u64,
    /// Satisfying iterations of all its chains.
    pub(crate) hits: u64,
    /// Distinct solutions that this piece found.
    pub(crate) distinct: u64,
    /// Iterations per second of all its chains together, since it began or was continued.
    pub(crate) iterations_per_second: f64,
    /// Seconds since then.
    pub(crate) seconds: f64,
    pub(crate) chains: u32,
    /// The machine that writes, and the time of writing, in seconds since 1970.
    pub(crate) host: String,
    pub(crate) process: u32,
    pub(crate) time: u64,
}

/// Writes the file.
pub(super) struct Beacon {
    folder: Folder,
    signal: Signal,
    /// Seconds of the run at the last signal.
    sent: Option<f64>,
}

impl Beacon {
    /// The beacon of a piece; whole runs have none.
    pub(super) fn of(manifest: &Manifest, folder: &Folder) -> Option<Self> {
        let shard = manifest.shard?;
        let signal = Signal {
            state: State::Running,
            why: None,
            piece: shard.piece(),
            of: shard.of(),
            iteration: 0,
            end: manifest.plan.end(),
            hits: 0,
            distinct: 0,
            iterations_per_second: 0.0,
            seconds: 0.0,
            chains: manifest.chains().len() as u32,
            host: host(),
            process: std::process::id(),
            time: 0,
        };
        Some(Self { folder: folder.clone(), signal, sent: None })
    }

    /// Whether the last signal is old, `seconds` into the run.
    pub(super) fn is_due(&self, seconds: f64) -> bool {
        self.sent.is_none_or(|sent| seconds - sent >= (0.1 * seconds).clamp(SHORTEST, LONGEST))
    }

    pub(super) fn send(
        &mut self,
        state: State,
        chains: &[ChainPulse],
        distinct: u64,
        (seconds, iterations_per_second): (f64, f64),
        why: Option<String>,
    ) {
        let sum = |of: fn(&ChainPulse) -> u64| chains.iter().map(of).sum::<u64>();
        let iteration = sum(|chain| chain.iterations) / (chains.len() as u64).max(1);
        let (hits, time) = (sum(|chain| chain.hits), unix_seconds());
        self.sent = Some(seconds);
        self.signal = Signal {
            state,
            why,
            iteration,
            hits,
            distinct,
            iterations_per_second,
            seconds,
            time,
            ..self.signal.clone()
        };
        // Nothing depends on it. A full disk, for example, is reported where the run itself is written.
        let next = self.folder.progress().with_extension("json.next");
        let json = serde_json::to_vec_pretty(&self.signal).unwrap_or_default();
        let _ = fs::write(&next, json).and_then(|()| fs::rename(&next, self.folder.progress()));
    }
}

/// The last signal of a piece; `None` if it has not sent one yet.
pub(crate) fn read(folder: &Folder) -> Option<Signal> {
    serde_json::from_slice(&fs::read(folder.progress()).ok()?).ok()
}

/// Name of this machine, if it has one.
pub(crate) fn host() -> String {
    let names = ["/proc/sys/kernel/hostname", "/etc/hostname"].map(PathBuf::from);
    let read = names.iter().find_map(|path| fs::read_to_string(path).ok());
    read.or_else(|| std::env::var("HOSTNAME").ok()).unwrap_or_default().trim().to_owned()
}
