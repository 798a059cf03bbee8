//! Markov chain Monte Carlo over an opaque draw.
//!
//! A [`Target`] says how likely a draw is, simulates it, and judges the outcome. [`Move`]s propose; a [`Chain`] accepts
//! in a way that leaves the target invariant; [`run()`] advances many chains at once.
//!
//! ```
//! use plaus_dist::{Density, Gaussian, LogDensity, LogPotential, LogRatio, Sample, Seed, Stream};
//! use plaus_mcmc::{At, Chain, Mixture, ModelError, Move, Proposal, Simulated, StateOf, StateRefOf};
//! use plaus_mcmc::{Target, Transition};
//!
//! /// A throw of unknown strength that should land at 3.
//! struct Throw { strength: Gaussian }
//!
//! impl Target for Throw {
//!     type Draw = f64;
//!     type Outcome = f64;
//!     type Scratch = ();
//!     fn start(&self, stream: &mut Stream) -> f64 { self.strength.sample(stream) }
//!     fn log_prior(&self, draw: &f64) -> Result<LogDensity, ModelError> { Ok(self.strength.log_density(draw)?) }
//!     fn simulate(&self, draw: &f64, _: Option<StateRefOf<'_, Self>>, _: LogPotential, _: &mut ())
//!         -> Result<Simulated<f64>, ModelError> { Ok(Simulated::Complete(2.0 * draw)) }
//!     fn log_constraint(&self, landing: &f64) -> Result<LogPotential, ModelError> {
//!         Ok(LogPotential::new(-0.5 * ((landing - 3.0) / 0.1) * ((landing - 3.0) / 0.1))?)
//!     }
//! }
//!
//! /// Adds a symmetric step.
//! struct Nudge(Gaussian);
//! impl Move<Throw> for Nudge {
//!     fn name(&self) -> &str { "nudge" }
//!     fn propose(&self, _: At<'_, Throw>, candidate: &mut f64, stream: &mut Stream) -> Result<Proposal, ModelError> {
//!         *candidate += self.0.sample(stream);
//!         Ok(Proposal::SYMMETRIC)
//!     }
//!     fn log_ratio(&self, _: Transition<'_, Throw>) -> Result<LogRatio, ModelError> { Ok(LogRatio::ONE) }
//! }
//!
//! let target = Throw { strength: Gaussian::new(1.0, 1.0)? };
//! let moves = Mixture::of(Box::new(Nudge(Gaussian::new(0.0, 0.1)?)));
//! let mut chain = Chain::start(&target, &moves, Seed(1).chain(0))?;
//! for _ in 0..1000 { chain.step()?; }
//! assert!((chain.state().outcome - 3.0).abs() < 0.6); // six standard deviations of the constraint
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A target that declares its draws' variables ([`vars`]) gets moves over them from the [`library`]. The crate knows no
//! bodies and does no input or output.

pub mod adapt;
mod chain;
pub mod chance;
pub mod check;
mod counts;
pub mod diagnose;
mod failures;
pub mod fit;
mod independent;
mod ladder;
mod law;
pub mod library;
mod look;
mod moves;
pub mod parallel;
mod record;
mod redraw;
mod replicas;
pub mod run;
mod scale;
mod solutions;
mod target;
mod tempered;
pub mod vars;
pub mod view;
pub mod weigh;

pub use adapt::{Adapted, Scales};
pub use chain::{Chain, ChainError, Step};
pub use counts::{Decision, MoveCounts};
pub use failures::{Failure, FailureKind, Failures};
pub use fit::{Fit, Learning};
pub use independent::{Independent, Tried, keep_draws, try_draws};
pub use ladder::{Ladder, MOST_RUNGS};
pub use law::{Law, Offset, Recipe, Rectangle};
pub use look::Look;
pub use moves::{At, Mixture, MixtureError, Move, MoveId, Path, Proposal, Transition};
pub use record::{Block, Entry};
pub use redraw::Redraw;
pub use replicas::{Climb, Course, Replicas, ReplicasSnapshot, RungStatistics, Tempering, TopStep};
pub use run::{
    ChainPulse, Control, Ending, Plan, PlanError, Progress, Pulse, RunError, Sink, Snapshot, Start, run, run_some,
    run_watched, useful_threads,
};
pub use scale::Scale;
pub use solutions::{Distinct, FirstOfClass, Hits, Sighting};
pub use target::{
    Goal, Interrupted, ModelError, Simulated, SolutionClass, State, StateOf, StateRef, StateRefOf, Target,
};
pub use tempered::Tempered;
pub use vars::{Member, Var, Variables, Vars};
pub use weigh::Weighing;
