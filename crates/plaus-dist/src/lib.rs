//! Log densities with samplers that match them.
//!
//! ```
//! use plaus_dist::{Density, Gaussian, Gibbs, Purpose, Sample, Seed};
//! use plaus_dist::LogDensity;
//!
//! // A prior and a goal: the angle is Gaussian, and each of three pins that falls is worth a factor e^2.5.
//! let angle = Gaussian::new(0.0, 10.0)?;
//! let goal = Gibbs::from_ln_lambda(2.5)?;
//! let mut stream = Seed(1).chain(0).at(0, Purpose::START);
//! let draw = angle.sample(&mut stream);
//! let log_p = angle.log_density(&draw)? + goal.log_potential(3);
//! assert!(log_p.value().is_finite());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What is here
//!
//! | law | of | for |
//! | --- | --- | --- |
//! | [`Gaussian`] | a number | angles, speeds, deviations from a goal |
//! | [`TruncatedGaussian`] | a number in an interval | restitution, friction, heights that must clear something |
//! | [`IsotropicGaussian`] | an offset in D dimensions | pins, vertices |
//! | [`Radial`] | the same, by a recipe as printed | reproducing published figures only |
//! | [`Uniform`], [`UniformBox`] | a number, a point | symmetric steps, drop positions |
//! | [`WrappedUniform`] | a point of a ring | moves that wrap around |
//! | [`Triangular`] | a number in an interval | a guess: the least, the likely, the most |
//! | [`LogNormal`] | a positive number | sizes, densities: what is uncertain by a factor |
//! | [`VonMises`] | an angle | headings, on a ring whose ends are joined |
//! | [`Choice`] | one of some numbers | gears, slots |
//! | [`Bernoulli`] | yes or no | balls that may be absent |
//! | [`Gibbs`] | a count of things achieved | goals; unnormalised, has no sampler |
//!
//! Laws of one number implement [`NumberLaw`], for code that need not know which law it is.
//!
//! Around them: [`log`] keeps normalised densities, unnormalised weights and ratios apart, [`stream`] gives every
//! random number its key, [`math`] computes the same bits on every platform, [`param`] lists what a constructor
//! refuses.
//!
//! # Features
//!
//! `laws`, on by default: all of the above except [`math`], with `rand` and `blake3`. A simulator needs only [`math`],
//! which depends on `libm` alone.
//!
//! # Invariants
//!
//! * A law that exists is valid: parameters are checked once, by the constructor or on deserialisation, and errors name
//!   parameter, value and range.
//! * A log density is finite or −∞. NaN as input gives [`NotANumber`], and so does an infinite density, which only the
//!   centre of [`Radial`] has. This holds for scales from 1e-300 to 1e300 and every float x.
//! * Every density is normalised in the unit of its variable, so densities of states of different dimension may be
//!   compared.
//! * The draws of a sampler depend on its stream alone, bit for bit. A change of them is value-breaking, and tests pin
//!   them.

#[cfg(feature = "laws")]
mod laws;
pub mod math;

#[cfg(feature = "laws")]
pub use laws::*;
