//! Runs on disk: sampled, resumed, read back, diagnosed and exported.
//!
//! ```
//! use plaus_run::{Folder, ChainPhase, Recipe, Run, Sampling, Unwatched};
//! use plaus_scenes::Scenario;
//! # let place = tempfile::tempdir()?;
//! # let path = place.path().join("run");
//!
//! // Sample a scene into a folder.
//! let text = "sampler = { chains = 2, warmup = 100, iterations = 900 }\nworld.ball2d = {}";
//! let scenario = Scenario::read("ball.toml", text, &[])?;
//! let recipe = Recipe { scenario, file: "ball.toml".into(), text: text.into(), overrides: vec![], solutions: None };
//! let folder = Folder::new(&path);
//! plaus_run::sample(&folder, &recipe, Sampling::new(1, &mut Unwatched))?;
//!
//! // Read it back, whatever its scene is.
//! let run = Run::open(&folder)?;
//! let mut satisfying = 0;
//! run.reader()?.walk(0, ChainPhase::Sampling, |repeats| -> Result<(), plaus_run::Error> {
//!     satisfying += if repeats.entry.class.is_some() { repeats.draws } else { 0 };
//!     Ok(())
//! })?;
//! assert!((300..900).contains(&satisfying), "{satisfying}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # A run is a folder
//!
//! | file | what |
//! | --- | --- |
//! | `manifest.json` | what the run is: scenario text and hash, version, seed, plan, flags of the acceptance rule, moves, scalars; with a checksum |
//! | `chain-00000.records` | what the chain recorded: one [frame](codec) for each block of iterations, appended |
//! | `checkpoints` | where the chains can continue from: one frame for each, replaced all at once |
//! | `confirmed.json` | made on demand: which distinct solutions hold at another accuracy |
//! | `lock` | empty; locked by the process that writes |
//! | `trail`, `progress.json` | only in a piece: where it could be cut, if it looks for solutions; how far it is, for observers |
//!
//! The bytes of a folder follow from scenario, seed, plan and version: not from the clock, the number of threads, or
//! how often the run was killed and resumed. Records are written first, checkpoints after that. A checkpoint states the
//! length of the records; anything beyond it is cut off when the run is continued. So a process that dies at any moment
//! loses at most the iterations since the last checkpoint.

mod beside;
mod beside_scenario;
pub mod chance;
mod checkpoint;
pub mod codec;
pub mod confirm;
pub mod diagnosis;
pub mod disk;
mod error;
pub mod export;
mod folder;
mod gauge;
pub mod manifest;
pub mod merge;
mod noted;
pub mod pace;
mod read;
mod records;
pub mod replay;
pub mod sample;
mod sample_id;
mod shard;
mod siblings;
mod sink;
pub mod solutions;
mod streamed;
pub mod tally;
mod trail;
mod trial;
mod watch;
mod way;

pub use beside::{Beside, Missed};
pub use beside_scenario::{ScenarioFolder, edited};
pub use confirm::Confirmation;
pub use diagnosis::{Diagnosis, Finding, Independent};
pub use error::{Error, RunFileError, RunFileProblem};
pub use folder::Folder;
pub use gauge::Mixing;
pub use manifest::{Manifest, Recipe};
pub use merge::merge;
pub use read::{Run, RunReader};
pub use sample::{Further, More, Sampling, is_undecided, resume, sample, sample_or_go_on, sample_shard};
pub use sample_id::{ChainPhase, SampleId};
pub use shard::{Shard, ShardError};
pub use solutions::Solution;
pub use tally::Tally;
pub use watch::{Unwatched, Watch};
pub use way::Way;

use plaus_mcmc::Target;
use plaus_scenes::Stage;

/// The draws that runs hold.
pub type Draw = <Stage as Target>::Draw;
/// The outcomes that runs hold.
pub type Outcome = <Stage as Target>::Outcome;
