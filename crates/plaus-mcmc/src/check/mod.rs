//! Checks that a target and its moves make a chain that leaves the target invariant, for scenes of your own.
//!
//! | check | what it needs | what it finds |
//! | --- | --- | --- |
//! | [`ratios()`] | any states | a ratio computed two ways that disagree, or that the way back contradicts |
//! | [`balance()`] | a toy small enough to list its states | every deviation from detailed balance, to 1e-12 |
//! | [`one_step()`] | exact draws of the target | a kernel that moves the law of exact draws, at a stated false-alarm rate |
//! | [`early_exit()`] | nothing more | savings (early stops, reuse, scratch memory) that change a state |
//!
//! `ratios` alone proves little: a move that proposes from another law than its ratio assumes can pass it. `one_step`
//! is decisive. At λ = 1 it needs nothing but the prior ([`PriorOnly`], [`prior`]); on a toy, [`rejection`] gives it
//! exact draws at λ > 1.
//!
//! ```
//! use plaus_dist::{Density, Gaussian, LogDensity, LogPotential, LogRatio, Sample, Stream};
//! use plaus_mcmc::check::{OneStep, PriorOnly, Statistic, one_step, prior};
//! use plaus_mcmc::view::lend;
//! # use plaus_mcmc::{At, Mixture, ModelError, Move, Proposal, Simulated, State, StateOf, StateRefOf};
//! # use plaus_mcmc::{Target, Transition};
//! # struct Throw { strength: Gaussian }
//! # impl Target for Throw {
//! #     type Draw = f64;
//! #     type Outcome = f64;
//! #     type Scratch = ();
//! #     fn start(&self, stream: &mut Stream) -> f64 { self.strength.sample(stream) }
//! #     fn log_prior(&self, draw: &f64) -> Result<LogDensity, ModelError> { Ok(self.strength.log_density(draw)?) }
//! #     fn simulate(&self, draw: &f64, _: Option<StateRefOf<'_, Self>>, _: LogPotential, _: &mut ())
//! #         -> Result<Simulated<f64>, ModelError> { Ok(Simulated::Complete(2.0 * draw)) }
//! #     fn log_constraint(&self, landing: &f64) -> Result<LogPotential, ModelError> {
//! #         Ok(LogPotential::new(-0.5 * (landing - 3.0) * (landing - 3.0))?)
//! #     }
//! # }
//! /// Draws the strength anew, and says that this is symmetric: wrong unless the prior is flat.
//! struct Redraw;
//! impl Move<Throw> for Redraw {
//!     fn name(&self) -> &str { "redraw" }
//!     fn propose(&self, at: At<'_, Throw>, candidate: &mut f64, stream: &mut Stream) -> Result<Proposal, ModelError> {
//!         *candidate = at.target.strength.sample(stream);
//!         Ok(Proposal::SYMMETRIC)
//!     }
//!     fn log_ratio(&self, _: Transition<'_, Throw>) -> Result<LogRatio, ModelError> { Ok(LogRatio::ONE) }
//! }
//!
//! let throw = Throw { strength: Gaussian::new(1.0, 1.0)? };
//! let unconstrained = PriorOnly::new(&throw);
//! let moves = lend::<PriorOnly<Throw>>(Mixture::of(Box::new(Redraw)))?;
//! let strength = Statistic::new("strength", |state: &State<f64, f64>| state.draw);
//! let plan = OneStep { samples: 20_000, ..OneStep::default() };
//! let report = one_step(&unconstrained, &moves, prior(&unconstrained), &[strength], plan)?;
//! assert!(!report.passed(), "{report}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod balance;
mod early_exit;
mod exact;
mod laws;
mod one_step;
mod prior_only;
mod proposals;
mod ratios;

pub use balance::{Balance, BalanceReport, MoveBalance, Unbalance, balance};
pub use early_exit::{Difference, EarlyExitReport, NeverEarly, early_exit};
pub use exact::{any_of, prior, rejection, visited};
pub use laws::LogP;
pub use one_step::{OneStep, OneStepReport, Statistic, StatisticReport, one_step};
pub use prior_only::PriorOnly;
pub use proposals::{Branch, Enumerable, Frequencies};
pub use ratios::{Pair, PairRatios, RatioReport, Ratios, Worst, ratio_pair, ratios};

use crate::chain::ChainError;
use crate::target::ModelError;
use plaus_dist::Purpose;

/// Exact draws that start a step, or states that start a pair.
const EXACT: Purpose = Purpose(12);
/// Exact draws to compare with.
const FRESH: Purpose = Purpose(13);
/// Proposals made outside a chain.
const TRY: Purpose = Purpose(14);

/// Why a check could not be carried out. A finding of a check is not an error: it is in the report.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckError {
    /// The model, a move or an exact sampler failed.
    #[error("sample {index}: {source}")]
    Model {
        /// Index of the sample, pair or state.
        index: u64,
        /// The model's error.
        source: ModelError,
    },
    /// A chain failed.
    #[error("sample {index}: {source}")]
    Chain {
        /// Index of the sample; 0 for a check that runs one chain.
        index: u64,
        /// The chain's error.
        source: ChainError,
    },
    /// A statistic is not a finite number.
    #[error("statistic `{name}` is {value} in sample {index}")]
    Statistic {
        /// The statistic.
        name: String,
        /// Its value.
        value: f64,
        /// Index of the sample.
        index: u64,
    },
    /// A setting is outside its range.
    #[error("{setting} is {value}, but must be {allowed}")]
    Setting {
        /// The setting.
        setting: &'static str,
        /// Its value.
        value: f64,
        /// The allowed range.
        allowed: &'static str,
    },
    /// The list of a toy's states contains a state twice.
    #[error("states {first} and {second} of the list are equal")]
    Repeated {
        /// Its first index.
        first: usize,
        /// Its second index.
        second: usize,
    },
    /// A move leads from a listed state to one of positive prior density that is not listed.
    #[error("move `{name}` leads from state {from} to a state of positive density that is not in the list")]
    Unlisted {
        /// The move.
        name: String,
        /// Index of the state where it starts.
        from: usize,
    },
    /// Moves with no positive weight, or a bad one.
    #[error(transparent)]
    Mixture(#[from] crate::moves::MixtureError),
}

impl CheckError {
    /// Adds which sample failed.
    fn model(index: u64) -> impl Fn(ModelError) -> Self {
        move |source| Self::Model { index, source }
    }

    /// `Ok` where `holds`.
    fn unless(holds: bool, setting: &'static str, value: f64, allowed: &'static str) -> Result<(), Self> {
        if holds { Ok(()) } else { Err(Self::Setting { setting, value, allowed }) }
    }

    /// Makes sure that a false-alarm rate is a probability that can be reached.
    fn check_false_alarm(rate: f64) -> Result<(), Self> {
        Self::unless(rate > 0.0 && rate < 1.0, "false_alarm", rate, "above 0 and below 1")
    }
}
