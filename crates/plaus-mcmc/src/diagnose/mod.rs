//! Convergence diagnostics of one scalar over several chains.
//!
//! Everything is a pure function of the draws, given as chains of one length (`&[Vec<f64>]`, `&[&[f64]]`, `&[[f64;
//! N]]`). [`summarize`] computes the usual table row at once; single functions compute single numbers.
//!
//! ```
//! use plaus_mcmc::diagnose;
//!
//! // Two chains that agree: a deterministic stand-in for draws.
//! let chain = |offset: u32| (0..400).map(|i| f64::from((i * 173 + offset * 57) % 400)).collect::<Vec<f64>>();
//! let row = diagnose::summarize(&[chain(0), chain(1)])?;
//! assert!(row.rhat.is_some_and(|r| r < 1.01));
//! assert!((row.mean - 199.5).abs() < 4.0 * row.mcse_mean);
//!
//! // A chain shifted by one standard deviation is found out.
//! let shifted: Vec<f64> = chain(1).iter().map(|x| x + 115.0).collect();
//! assert!(diagnose::rhat(&[chain(0), shifted])?.is_some_and(|r| r > 1.1));
//! # Ok::<(), diagnose::DiagnoseError>(())
//! ```
//!
//! # What the numbers mean
//!
//! | number | healthy | meaning |
//! | --- | --- | --- |
//! | [`rhat`] | below 1.01 | do the chains, and the two halves of each, agree in location and spread? |
//! | [`ess_bulk`] | above 100 per chain | independent draws that would place the centre as well |
//! | [`ess_tail`] | above 100 per chain | the same for the 5% and 95% quantiles, the worse of the two |
//! | [`mcse_mean`] | small beside what matters | standard error of the mean, autocorrelation included |
//! | [`integrated_autocorrelation_time`] | far below the chain's length | iterations per independent draw |
//!
//! None of them can see a mode that no chain has visited: they only compare the chains with each other.
//!
//! # Source
//!
//! A. Vehtari, A. Gelman, D. Simpson, B. Carpenter, P.-C. Bürkner, "Rank-Normalization, Folding, and Localization: An
//! Improved R̂ for Assessing Convergence of MCMC", Bayesian Analysis 16(2), 2021; C. Geyer, "Practical Markov Chain
//! Monte Carlo", Statistical Science 7, 1992 (initial monotone sequence); A. Sokal, "Monte Carlo Methods in Statistical
//! Mechanics", 1997 (automatic window). The values agree with ArviZ 0.23 on stored draws to 1e-9
//! (`tests/arviz_reference.rs`).
//!
//! Deviation: results do not depend on the unit of the draws. ArviZ treats draws that differ by less than 1e-15 as
//! constant; here draws are constant only if they are all equal, and squares neither overflow at 1e300 nor vanish at
//! 1e-300.
//!
//! # Draws that carry no information
//!
//! * NaN or ±∞ among the draws, fewer than [`MIN_DRAWS`] draws, no chain, chains of different lengths: a
//!   [`DiagnoseError`]. Nothing panics.
//! * All draws equal: R̂, autocorrelation and its time are `None`, because there is no variance to compare; every ESS
//!   is the number of draws (ArviZ's convention), every MCSE is 0. A variable that should move but is like this is
//!   **stuck**: look at `sd` too.
//! * Each chain constant, but not the same constant: R̂ is `Some(+∞)`, ESS about half a draw per chain.
//! * One chain: R̂ is `None` (it compares chains); everything else is defined.
//!
//! The Fourier transforms come from `realfft` without its vector instructions, which would depend on the machine. Their
//! sines are the platform's, so the last bits of ESS, MCSE and autocorrelations may still differ between platforms.
//! They are for reading: nothing that must be reproducible may depend on them.

mod autocorrelation;
mod chains;
mod ess;
mod mcse;
mod moments;
mod rank;
mod rhat;
mod summary;

pub use autocorrelation::{AutocorrelationTime, SOKAL_WINDOW, autocorrelation, integrated_autocorrelation_time};
pub use chains::{DiagnoseError, MIN_DRAWS};
pub use ess::{ess_bulk, ess_mean, ess_tail, ess_where};
pub use mcse::{mcse_mean, mcse_sd};
pub use plaus_dist::normal_quantile;
pub use rhat::rhat;
pub use summary::{Summary, summarize};
