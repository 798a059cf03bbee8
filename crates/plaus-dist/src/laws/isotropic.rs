//! The isotropic Gaussian in D dimensions.

use crate::gaussian::HALF_LN_TAU;
use crate::normal::standard_normal;
use crate::param::ParamError;
use crate::{Density, LogDensity, NotANumber, Sample, Stream, math};
use serde::{Deserialize, Serialize};

/// Offsets whose `D` Cartesian components are independent N(0, sd).
///
/// Density `exp(−r²/2 sd²) / (sd √2π)^D` per unit of length to the power `D`. It is normalised, so it may be compared
/// between states of different dimension; `D` = 0 is the empty product, certainty. Fresh draws have E[−r²/2 sd²] =
/// −D/2, unlike those of [`Radial`](crate::Radial).
///
/// ```
/// use plaus_dist::{Density, IsotropicGaussian};
/// let vertex = IsotropicGaussian::<3>::new(1e-4)?; // metres per axis
/// let there = vertex.log_density(&[1e-4, 0.0, 0.0])?.value();
/// let centre = vertex.log_density(&[0.0; 3])?.value();
/// assert!((there - centre + 0.5).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Unchecked")]
pub struct IsotropicGaussian<const D: usize> {
    sd: f64,
    #[serde(skip)]
    log_peak: f64,
}

#[derive(Deserialize)]
#[serde(rename = "IsotropicGaussian", deny_unknown_fields)]
struct Unchecked {
    sd: f64,
}

impl<const D: usize> TryFrom<Unchecked> for IsotropicGaussian<D> {
    type Error = ParamError;
    fn try_from(raw: Unchecked) -> Result<Self, ParamError> {
        Self::new(raw.sd)
    }
}

impl<const D: usize> IsotropicGaussian<D> {
    /// Standard deviation `sd` along each axis, in the unit of the offsets.
    ///
    /// # Errors
    /// [`ParamError`] unless 1e-300 ≤ sd ≤ 1e300.
    pub fn new(sd: f64) -> Result<Self, ParamError> {
        ParamError::check_scale("isotropic normal law", "standard deviation", sd)?;
        Ok(Self { sd, log_peak: -(D as f64) * (math::ln(sd) + HALF_LN_TAU) })
    }

    /// The standard deviation along each axis.
    #[inline]
    #[must_use]
    pub fn sd(&self) -> f64 {
        self.sd
    }
}

impl<const D: usize> Density<[f64; D]> for IsotropicGaussian<D> {
    /// # Errors
    /// [`NotANumber`] if a component is NaN. Infinitely far out the density is 0.
    #[inline]
    fn log_density(&self, x: &[f64; D]) -> Result<LogDensity, NotANumber> {
        let squares = x.iter().fold(0.0, |sum, component| sum + math::square(component / self.sd));
        LogDensity::new(self.log_peak - 0.5 * squares)
    }
}

impl<const D: usize> Sample for IsotropicGaussian<D> {
    type Value = [f64; D];
    #[inline]
    fn sample(&self, stream: &mut Stream) -> [f64; D] {
        std::array::from_fn(|_| self.sd * standard_normal(stream))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Radial;
    use crate::testing::{KS_LIMIT, Z_LIMIT, draws, ks, z_score};
    use statrs::distribution::{ChiSquared, ContinuousCDF};

    /// Standard errors by which the mean of r²/2 sd² misses D/2, its value under the Gaussian (χ²_D/2, variance D/2).
    fn misfit<const D: usize>(offsets: &[[f64; D]], sd: f64) -> f64 {
        let halves = offsets.iter().map(|x| 0.5 * x.iter().map(|c| math::square(c / sd)).sum::<f64>());
        z_score(halves, D as f64 / 2.0, (D as f64 / 2.0).sqrt())
    }

    fn compare<const D: usize>(seed: u64) {
        let sd = 0.1;
        let offsets = draws(&IsotropicGaussian::<D>::new(sd).unwrap(), 200_000, seed);
        assert!(misfit(&offsets, sd).abs() < Z_LIMIT);
        let law = ChiSquared::new(D as f64).unwrap();
        let squares = offsets.iter().map(|x| x.iter().map(|c| math::square(c / sd)).sum::<f64>());
        assert!(ks(squares, |s| law.cdf(s)) < KS_LIMIT);
        let same = draws(&Radial::<D>::new(sd).unwrap(), 200_000, seed);
        // The wrong twin: the paper's recipe taken for the Gaussian. In one dimension it is the Gaussian.
        assert_eq!(misfit(&same, sd).abs() < Z_LIMIT, D == 1);
    }

    #[test]
    fn draws_agree_with_the_density_and_radial_ones_do_not() {
        compare::<1>(31);
        compare::<2>(32);
        compare::<3>(33);
    }

    #[test]
    fn it_is_the_product_of_its_axes() {
        let axis = crate::Gaussian::new(0.0, 0.3).unwrap();
        let x = [0.1, -0.7, 2.0];
        let product: LogDensity = x.iter().map(|c| axis.log_density(c).unwrap()).sum();
        let whole = IsotropicGaussian::<3>::new(0.3).unwrap().log_density(&x).unwrap();
        // A dozen roundings of terms below 32.
        assert!((whole.value() - product.value()).abs() < 1e-13);
        assert_eq!(IsotropicGaussian::<0>::new(0.3).unwrap().log_density(&[]).unwrap(), LogDensity::ONE);
    }

    #[test]
    fn extremes_stay_values() {
        for sd in [1e-300, 1.0, 1e300] {
            let law = IsotropicGaussian::<3>::new(sd).unwrap();
            let peak = law.log_density(&[0.0; 3]).unwrap().value();
            assert!((peak + 3.0 * (math::ln(sd) + HALF_LN_TAU)).abs() < 1e-9, "{peak}");
            // 10⁸ standard deviations out along each axis: −½ · 3 · 10¹⁶, to a relative rounding.
            let far = law.log_density(&[1e8 * sd; 3]).unwrap().value();
            assert!((far / -1.5e16 - 1.0).abs() < 1e-12, "{far}");
            assert!(law.log_density(&[0.0, f64::INFINITY, 0.0]).unwrap().is_zero());
            assert!(law.log_density(&[0.0, f64::INFINITY, f64::NAN]).is_err());
            assert!(law.log_density(&[f64::MAX, -f64::MAX, 0.0]).is_ok());
        }
        assert!(IsotropicGaussian::<2>::new(0.0).is_err());
    }

    #[test]
    fn values_are_pinned() {
        let x = draws(&IsotropicGaussian::<3>::new(1.0).unwrap(), 1, 5)[0];
        assert_eq!(
            x.map(f64::to_bits),
            [4_608_094_910_754_368_057, 4_599_889_112_477_106_480, 4_604_847_617_009_688_747]
        );
    }
}
