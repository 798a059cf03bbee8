//! The interface of every law of one number, for code that need not know which law it is.

use crate::{Density, LogDensity, NotANumber, Sample, Stream};
use std::fmt::Debug;

/// A law of one number, with everything that moves of a chain need of it.
///
/// [`step`](Self::step) is symmetric: if `by` is as likely as `−by`, a step from `x` to `y` is as likely as one from
/// `y` to `x`, per unit of the variable. It may leave the support, where the density is 0.
///
/// ```
/// use plaus_dist::{NumberLaw, Triangular};
/// let law: Box<dyn NumberLaw> = Box::new(Triangular::new(0.0, 1.0, 4.0)?);
/// assert_eq!(law.support(), [0.0, 4.0]);
/// assert_eq!(law.step(3.0, 0.5), 3.5);
/// # Ok::<(), plaus_dist::ParamError>(())
/// ```
pub trait NumberLaw: Debug + Send + Sync {
    /// A draw.
    fn draw(&self, stream: &mut Stream) -> f64;

    /// Log density at a value.
    ///
    /// # Errors
    /// [`NotANumber`] if it is NaN.
    fn log_density_at(&self, x: f64) -> Result<LogDensity, NotANumber>;

    /// The interval in which all draws lie; an end is infinite if there is none.
    fn support(&self) -> [f64; 2];

    /// Whether it has a density; otherwise each value has a probability.
    fn is_continuous(&self) -> bool {
        true
    }

    /// The unit of a step of usual size, above 0.
    fn width(&self) -> f64;

    /// The value that is `by` from `x`.
    fn step(&self, x: f64, by: f64) -> f64 {
        x + by
    }
}

/// Implements the trait for a law that has a density and a sampler.
macro_rules! as_number_law {
    ($law:ty { $($rest:item)* }) => {
        impl crate::NumberLaw for $law {
            fn draw(&self, stream: &mut crate::Stream) -> f64 {
                crate::number::drawn(self, stream)
            }

            fn log_density_at(&self, x: f64) -> Result<crate::LogDensity, crate::NotANumber> {
                crate::number::density(self, x)
            }

            $($rest)*
        }
    };
}
pub(crate) use as_number_law;

pub(crate) fn drawn(law: &impl Sample<Value = f64>, stream: &mut Stream) -> f64 {
    law.sample(stream)
}

pub(crate) fn density(law: &impl Density<f64>, x: f64) -> Result<LogDensity, NotANumber> {
    law.log_density(&x)
}
