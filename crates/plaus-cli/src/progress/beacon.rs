//! A small file in the folder of a piece that says how far it is: read by `plaus status`, on any machine that sees the
//! folder, and believed by nobody else.

use crate::clock::unix_seconds;
use plaus_mcmc::ChainPulse;
use plaus_run::{Folder, Manifest};
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::PathBuf;

/// Seconds between two signals, at most: of a thousand pieces, a shared disk sees some thirty files a second.
pub(crate) const LONGEST: f64 = 30.0;
/// Seconds between the first two.
const SHORTEST: f64 = 1.0;

/// What became of a piece, as it says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum State {
    /// At work when this was written.
    Running,
    /// At its end.
    Done,
    /// Stopped before its end, with a checkpoint.
    Stopped,
    /// Broken off.
    Failed,
}

/// How far a piece is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Signal {
    /// What became of it.
    pub(crate) state: State,
    /// Why it broke off.
    pub(crate) why: Option<String>,
    /// Which of how many.
    pub(crate) piece: u32,
    pub(crate) of: u32,
    /// Iterations of each chain, as a mean, and those that are planned.
    pub(crate) iteration: u64,
    pub(crate) end: u64,
    /// Satisfying iterations of all its chains.
    pub(crate) hits: u64,
    /// Distinct solutions of its own.
    pub(crate) distinct: u64,
    /// Of all its chains together, since it began or went on.
    pub(crate) iterations_per_second: f64,
    /// How long ago that is, in seconds.
    pub(crate) seconds: f64,
    pub(crate) chains: u32,
    /// Who writes, and when that was, in seconds since 1970.
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

    /// Whether the last signal is old, at so many seconds of the run.
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
        // Nothing hangs on it: a disk that is full, say, has its say where the run is written.
        let next = self.folder.progress().with_extension("json.next");
        let json = serde_json::to_vec_pretty(&self.signal).unwrap_or_default();
        let _ = fs::write(&next, json).and_then(|()| fs::rename(&next, self.folder.progress()));
    }
}

/// What a piece said last; `None` where it has not said anything yet.
pub(crate) fn read(folder: &Folder) -> Option<Signal> {
    serde_json::from_slice(&fs::read(folder.progress()).ok()?).ok()
}

/// Name of this machine, where it says one.
pub(crate) fn host() -> String {
    let names = ["/proc/sys/kernel/hostname", "/etc/hostname"].map(PathBuf::from);
    let read = names.iter().find_map(|path| fs::read_to_string(path).ok());
    read.or_else(|| std::env::var("HOSTNAME").ok()).unwrap_or_default().trim().to_owned()
}
