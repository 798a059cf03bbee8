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
//! | [`Gibbs`] | a count of wishes met | goals; unnormalised, has no sampler |
//!
//! Those of one number are a [`NumberLaw`] each, for whoever needs not know which.
//!
//! Around them: [`log`] keeps normalised densities, unnormalised weights and ratios apart, [`stream`] gives every
//! random number its key, [`math`] computes the same bits on every platform, [`param`] says what a constructor refuses.
//!
//! # Invariants
//!
//! * A law that is built is sane: parameters are checked once, by the constructor or on deserialisation, and errors
//!   name parameter, value and range.
//! * A log density is finite or −∞; NaN in is [`NotANumber`] out, and so is an infinite density, which only
//!   the centre of [`Radial`] has. This holds for scales from 1e-300 to 1e300 and every float x.
//! * Every density is normalised, in the unit of its variable, so densities of states of different dimension may be
//!   compared.
//! * What a sampler draws depends on its stream alone, bit for bit; a change of it is value-breaking, and
//!   pinned by tests.

mod bernoulli;
mod choice;
mod gaussian;
mod gibbs;
mod isotropic;
pub mod log;
mod log_normal;
pub mod math;
mod normal;
mod normal_quantile;
mod number;
pub mod param;
mod radial;
pub mod stream;
#[cfg(test)]
mod testing;
mod triangular;
mod truncated;
mod uniform;
mod uniform_box;
mod von_mises;
mod wrapped;

pub use bernoulli::Bernoulli;
pub use choice::Choice;
pub use gaussian::Gaussian;
pub use gibbs::Gibbs;
pub use isotropic::IsotropicGaussian;
pub use log::{LogDensity, LogPotential, LogRatio, NotANumber};
pub use log_normal::LogNormal;
pub use normal::standard_normal;
pub use normal_quantile::normal_quantile;
pub use number::NumberLaw;
pub use param::ParamError;
pub use radial::Radial;
pub use stream::{ChainStreams, Purpose, Seed, Stream, open_unit};
pub use triangular::Triangular;
pub use truncated::TruncatedGaussian;
pub use uniform::Uniform;
pub use uniform_box::UniformBox;
pub use von_mises::VonMises;
pub use wrapped::WrappedUniform;

/// A normalised density (or probability mass) over values `X`.
pub trait Density<X: ?Sized> {
    /// Log density at `x`; [`LogDensity::ZERO`] outside the support.
    ///
    /// # Errors
    /// [`NotANumber`] where `x` holds a NaN, or the density there is infinite.
    fn log_density(&self, x: &X) -> Result<LogDensity, NotANumber>;
}

/// A law that can be drawn from; where it is a [`Density`] too, the two agree.
pub trait Sample {
    /// What one draw is.
    type Value;
    /// One draw, using only `stream`.
    fn sample(&self, stream: &mut Stream) -> Self::Value;
}
