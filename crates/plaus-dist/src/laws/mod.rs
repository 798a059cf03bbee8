//! Distributions, and the streams that they are drawn with.

pub(crate) mod bernoulli;
pub(crate) mod choice;
pub(crate) mod gaussian;
pub(crate) mod gibbs;
pub(crate) mod isotropic;
pub mod log;
pub(crate) mod log_normal;
pub(crate) mod normal;
pub(crate) mod normal_quantile;
pub(crate) mod number;
pub mod param;
pub(crate) mod radial;
pub mod stream;
#[cfg(test)]
pub(crate) mod testing;
pub(crate) mod triangular;
pub(crate) mod truncated;
pub(crate) mod uniform;
pub(crate) mod uniform_box;
pub(crate) mod von_mises;
pub(crate) mod wrapped;

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
    /// [`NotANumber`] if `x` holds a NaN, or the density there is infinite.
    fn log_density(&self, x: &X) -> Result<LogDensity, NotANumber>;
}

/// A law that can be drawn from; if it is also a [`Density`], the two agree.
pub trait Sample {
    /// The type of one draw.
    type Value;
    /// One draw, using only `stream`.
    fn sample(&self, stream: &mut Stream) -> Self::Value;
}
