//! The uniform law on an axis-aligned box.

use crate::{Density, LogDensity, NotANumber, Sample, Stream, Uniform};

/// Independent uniform coordinates: an interval, a rectangle, a box in `D` dimensions.
///
/// Density 1/volume inside and 0 outside (per unit of length to the power `D`): a ball dropped on a rectangle of area a
/// has density 1/a. Half-open in every axis, like [`Uniform`]; `D` = 0 is the empty product, certainty.
///
/// ```
/// use plaus_dist::{Density, Uniform, UniformBox};
/// let table = UniformBox::new([Uniform::new(0.0, 0.5)?, Uniform::new(0.0, 0.25)?]); // metres
/// assert_eq!(table.log_density(&[0.1, 0.2])?.value(), 3.0 * std::f64::consts::LN_2);
/// assert!(table.log_density(&[0.1, 0.3])?.is_zero());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UniformBox<const D: usize> {
    sides: [Uniform; D],
}

impl<const D: usize> UniformBox<D> {
    /// The box with these sides; each was checked when it was built.
    #[must_use]
    pub fn new(sides: [Uniform; D]) -> Self {
        Self { sides }
    }

    /// The interval along each axis.
    #[inline]
    #[must_use]
    pub fn sides(&self) -> &[Uniform; D] {
        &self.sides
    }
}

impl<const D: usize> Density<[f64; D]> for UniformBox<D> {
    /// # Errors
    /// [`NotANumber`] if a coordinate is NaN, even if another is outside.
    #[inline]
    fn log_density(&self, x: &[f64; D]) -> Result<LogDensity, NotANumber> {
        self.sides.iter().zip(x).try_fold(LogDensity::ONE, |sum, (side, x)| Ok(sum + side.log_density(x)?))
    }
}

impl<const D: usize> Sample for UniformBox<D> {
    type Value = [f64; D];
    #[inline]
    fn sample(&self, stream: &mut Stream) -> [f64; D] {
        self.sides.each_ref().map(|side| side.sample(stream))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{KS_LIMIT, draws, ks};

    #[test]
    fn the_volume_is_the_product_of_the_sides() {
        let side = |low, high| Uniform::new(low, high).unwrap();
        let law = UniformBox::new([side(0.0, 4.0), side(-1.0, 1.0), side(8.0, 16.0)]);
        assert_eq!(law.log_density(&[1.0, 0.0, 9.0]).unwrap().value(), -6.0 * std::f64::consts::LN_2);
        assert!(law.log_density(&[1.0, 1.0, 9.0]).unwrap().is_zero());
        assert!(law.log_density(&[-1.0, 0.0, f64::NAN]).is_err());
        assert_eq!(UniformBox::new([]).log_density(&[]).unwrap(), LogDensity::ONE);
        let tiny = UniformBox::new([side(0.0, 1e-300); 3]);
        assert!((tiny.log_density(&[0.0; 3]).unwrap().value() - 900.0 * std::f64::consts::LN_10).abs() < 1e-9);
    }

    #[test]
    fn coordinates_are_uniform_and_independent() {
        let law = UniformBox::new([Uniform::new(0.0, 1.0).unwrap(); 2]);
        let points = draws(&law, 100_000, 61);
        assert!(ks(points.iter().map(|x| x[1]), |x| x) < KS_LIMIT);
        // The sum of two independent uniforms is triangular; of a coordinate and itself (the wrong twin) it is not.
        let triangle = |s: f64| if s < 1.0 { 0.5 * s * s } else { 1.0 - 0.5 * (2.0 - s) * (2.0 - s) };
        assert!(ks(points.iter().map(|x| x[0] + x[1]), triangle) < KS_LIMIT);
        assert!(ks(points.iter().map(|x| x[0] + x[0]), triangle) > KS_LIMIT);
    }
}
