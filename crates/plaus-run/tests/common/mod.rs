//! Code that the tests of runs share.
#![allow(dead_code)] // each test binary uses a part

use plaus_run::disk::{Disk, RealDisk};
use plaus_run::{ChainPhase, Folder, Recipe, Run};
use plaus_scenes::{Scenario, Scene};
use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use std::sync::Mutex;

const TEXT: &str = "[sampler]\nseed = 11\nchains = 3\nwarmup = 100\niterations = 430\nthin = 3\ncheckpoint_every = 100\nmethod = \"chain\"\n[world.ball2d]\n";

/// A small run: three chains, seven blocks, the last one short.
pub(crate) fn recipe(solutions: Option<u64>) -> Recipe {
    let scenario = Scenario::read("ball.toml", TEXT, &[]).unwrap();
    Recipe { scenario, file: "ball.toml".into(), text: TEXT.into(), overrides: Vec::new(), solutions }
}

/// The same with replicas on three rungs.
pub(crate) fn tempered(solutions: Option<u64>) -> Recipe {
    let overrides = ["rungs=3".to_owned(), "swap_every=7".to_owned()];
    let scenario = Scenario::read("ball.toml", TEXT, &overrides).unwrap();
    Recipe { scenario, overrides: overrides.to_vec(), ..recipe(solutions) }
}

/// The same whose step sizes are adapted in a warm-up of several blocks.
pub(crate) fn adapting(rungs: u32) -> Recipe {
    set(&format!("adapt=true warmup=330 iterations=200 swap_every=7 rungs={rungs}"))
}

/// The same, which also learns how often to make each move.
pub(crate) fn weighing(rungs: u32) -> Recipe {
    set(&format!("adapt=true adapt_weights=true warmup=330 iterations=200 swap_every=7 rungs={rungs}"))
}

fn set(overrides: &str) -> Recipe {
    let overrides: Vec<String> = overrides.split(' ').map(str::to_owned).collect();
    let scenario = Scenario::read("ball.toml", TEXT, &overrides).unwrap();
    Recipe { scenario, overrides, ..recipe(None) }
}

/// Every file of a run.
pub(crate) fn bytes_of(folder: &Folder) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder.path()).unwrap().map(Result::unwrap);
    entries.map(|entry| (entry.file_name().into_string().unwrap(), std::fs::read(entry.path()).unwrap())).collect()
}

/// All draws of a phase, as bits: for each chain and draw, the scalars and log p. Or the first error.
pub(crate) fn all_draws(run: &Run, phase: ChainPhase) -> Result<Vec<Vec<Vec<u64>>>, String> {
    let run = run.reader().map_err(|error| error.to_string())?;
    let chain = |chain| {
        let mut draws = Vec::new();
        let mut values = vec![0.0; run.scene().scalars().len()];
        let walked = run.walk(chain, phase, |repeats| -> Result<(), plaus_run::RunFileError> {
            let state = &repeats.entry.state;
            run.scene().write_scalars(state.by_ref(), &mut values);
            let bits: Vec<u64> = values.iter().chain([&state.log_p().value()]).map(|value| value.to_bits()).collect();
            assert_eq!(repeats.draw, draws.len() as u64);
            draws.extend((0..repeats.draws).map(|_| bits.clone()));
            Ok(())
        });
        walked.map(|()| draws).map_err(|error| error.to_string())
    };
    run.chains().map(chain).collect()
}

/// A disk that has room for a given number of bytes, or whose process dies after a given number of operations.
pub(crate) struct FailingDisk {
    left: Mutex<(u64, u64)>,
    limits: (u64, u64),
    /// If true, nothing works after the first failure; otherwise only operations that need room fail.
    crash: bool,
}

impl FailingDisk {
    pub(crate) fn new(bytes: u64, operations: u64, crash: bool) -> Self {
        Self { left: Mutex::new((bytes, operations)), limits: (bytes, operations), crash }
    }

    /// Number of bytes and of operations so far.
    pub(crate) fn used(&self) -> (u64, u64) {
        let left = self.left.lock().unwrap();
        (self.limits.0 - left.0, self.limits.1 - left.1)
    }

    /// How many of `bytes` can still be written.
    fn take(&self, bytes: usize) -> (usize, io::Result<()>) {
        let mut left = self.left.lock().unwrap();
        if left.1 == 0 && (self.crash || bytes > 0) {
            return (0, Err(io::ErrorKind::StorageFull.into()));
        }
        left.1 = left.1.saturating_sub(1);
        let granted = (bytes as u64).min(left.0);
        left.0 -= granted;
        if granted == bytes as u64 {
            return (bytes, Ok(()));
        }
        left.1 = 0;
        (granted as usize, Err(io::ErrorKind::StorageFull.into()))
    }
}

impl Disk for FailingDisk {
    fn append(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        let (granted, result) = self.take(bytes.len());
        RealDisk.append(path, &bytes[..granted]).and(result)
    }
    fn write(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        let (granted, result) = self.take(bytes.len());
        std::fs::write(path, &bytes[..granted]).and(result)
    }
    fn sync(&self, _: &Path) -> io::Result<()> {
        self.take(0).1
    }
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        self.take(0).1?;
        RealDisk.rename(from, to)
    }
    fn truncate(&self, path: &Path, length: u64) -> io::Result<()> {
        self.take(0).1?;
        RealDisk.truncate(path, length)
    }
    fn remove(&self, path: &Path) -> io::Result<()> {
        self.take(0).1?;
        RealDisk.remove(path)
    }
    fn create_folder(&self, path: &Path) -> io::Result<()> {
        self.take(0).1?;
        RealDisk.create_folder(path)
    }
}
