//! The paper's printed recipe for new offsets: a random direction and a Gaussian length.

use crate::gaussian::HALF_LN_TAU;
use crate::normal::standard_normal;
use crate::param::ParamError;
use crate::{Density, LogDensity, NotANumber, Sample, Stream, math};
use serde::{Deserialize, Serialize};

/// Offsets in a uniformly random direction whose signed length is N(0, sd).
///
/// Density `2 φ_sd(r) / (S r^(D−1))` on Cartesian offsets, per unit of length to the power `D`, where `φ_sd` is the
/// Gaussian density and `S` the surface of the unit sphere in `D` dimensions: 2, 2π, 4π for `D` = 1, 2, 3. The length
/// is folded (a direction and its opposite are equally likely, hence the 2) and spread over a sphere of surface `S
/// r^(D−1)`.
///
/// It is **not** the Gaussian `exp(−r²/2 sd²)` except for `D` = 1: its density is infinite at the centre for `D` ≥ 2,
/// and fresh draws have E[−r²/2 sd²] = −1/2 in every dimension. Use it only to reproduce published figures; the
/// Gaussian is [`IsotropicGaussian`](crate::IsotropicGaussian).
///
/// Source: Chenney & Forsyth, "Sampling plausible solutions to multi-body constraint problems", SIGGRAPH 2000,
/// appendices A.2 and B.2.
///
/// ```
/// use plaus_dist::{Density, Radial};
/// let fresh = Radial::<2>::new(1.0)?;
/// let at = |r: f64| fresh.log_density(&[r, 0.0]);
/// // Twice as far: the Gaussian factor e^(−3/2), spread over twice the circle.
/// let expected = -1.5 - std::f64::consts::LN_2;
/// assert!((at(2.0)?.value() - at(1.0)?.value() - expected).abs() < 1e-12);
/// assert!(at(0.0).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Unchecked")]
pub struct Radial<const D: usize> {
    sd: f64,
    /// ln(2 / (sd √2π S)).
    #[serde(skip)]
    log_scale: f64,
}

#[derive(Deserialize)]
#[serde(rename = "Radial", deny_unknown_fields)]
struct Unchecked {
    sd: f64,
}

impl<const D: usize> TryFrom<Unchecked> for Radial<D> {
    type Error = ParamError;
    fn try_from(raw: Unchecked) -> Result<Self, ParamError> {
        Self::new(raw.sd)
    }
}

impl<const D: usize> Radial<D> {
    /// Standard deviation `sd` of the signed length, in the unit of the offsets. `D` = 0 does not compile.
    ///
    /// # Errors
    /// [`ParamError`] unless 1e-300 ≤ sd ≤ 1e300.
    pub fn new(sd: f64) -> Result<Self, ParamError> {
        const { assert!(D > 0, "there is no direction in zero dimensions") };
        ParamError::check_scale("radial law", "standard deviation", sd)?;
        let half = 0.5 * D as f64;
        // S = 2 π^(D/2) / Γ(D/2); its 2 cancels the 2 of the folded length.
        let log_half_surface = half * math::ln(std::f64::consts::PI) - math::ln_gamma(half);
        Ok(Self { sd, log_scale: -math::ln(sd) - HALF_LN_TAU - log_half_surface })
    }

    /// The standard deviation of the signed length.
    #[inline]
    #[must_use]
    pub fn sd(&self) -> f64 {
        self.sd
    }
}

impl<const D: usize> Density<[f64; D]> for Radial<D> {
    /// # Errors
    /// [`NotANumber`] if a component is NaN, and at the centre itself for `D` ≥ 2, if the density is infinite.
    /// Infinitely far out it is 0.
    fn log_density(&self, x: &[f64; D]) -> Result<LogDensity, NotANumber> {
        if let Some(&nan) = x.iter().find(|component| component.is_nan()) {
            return LogDensity::new(nan);
        }
        // The longest component is divided out, so that neither r² nor r/sd loses small or large offsets.
        let longest = x.iter().fold(0.0_f64, |longest, component| longest.max(component.abs()));
        if longest == f64::INFINITY {
            return Ok(LogDensity::ZERO);
        }
        if longest == 0.0 {
            let at_centre = if D == 1 { self.log_scale } else { f64::INFINITY };
            return LogDensity::new(at_centre);
        }
        let squares = x.iter().fold(0.0, |sum, component| sum + math::square(component / longest));
        let log_distance = math::ln(longest) + 0.5 * math::ln(squares);
        let z = longest / self.sd * squares.sqrt();
        LogDensity::new(self.log_scale - 0.5 * math::square(z) - (D - 1) as f64 * log_distance)
    }
}

impl<const D: usize> Sample for Radial<D> {
    type Value = [f64; D];
    /// The direction is that of `D` independent Gaussians, which never are all 0.
    #[inline]
    fn sample(&self, stream: &mut Stream) -> [f64; D] {
        let direction: [f64; D] = std::array::from_fn(|_| standard_normal(stream));
        let norm = direction.iter().fold(0.0, |sum, component| sum + math::square(*component)).sqrt();
        let length = self.sd * standard_normal(stream);
        direction.map(|component| component / norm * length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{KS_LIMIT, Z_LIMIT, draws, integrate, ks, z_score};
    use crate::{Gaussian, IsotropicGaussian};
    use std::f64::consts::{PI, TAU};

    #[test]
    fn one_dimension_is_the_gaussian() {
        let (radial, gaussian) = (Radial::<1>::new(0.2).unwrap(), Gaussian::new(0.0, 0.2).unwrap());
        for x in [0.0, 1e-9, -0.3, 5.0] {
            let difference = radial.log_density(&[x]).unwrap().value() - gaussian.log_density(&x).unwrap().value();
            // A few roundings of terms below 313.
            assert!(difference.abs() < 1e-12);
        }
    }

    /// Over shells: ∫ density · S r^(D−1) dr = 1, by a rule exact to 1e-13 for this smooth integrand, the mass past 12
    /// sd (1e-32) left out.
    #[test]
    fn it_is_normalised() {
        let sd = 0.5;
        let flat = Radial::<2>::new(sd).unwrap();
        let disc =
            integrate(0.0, 12.0 * sd, |r| math::exp(flat.log_density(&[0.6 * r, -0.8 * r]).unwrap().value()) * TAU * r);
        assert!((disc - 1.0).abs() < 1e-12, "{disc}");
        let solid = Radial::<3>::new(sd).unwrap();
        let ball = integrate(0.0, 12.0 * sd, |r| {
            math::exp(solid.log_density(&[0.6 * r, 0.0, -0.8 * r]).unwrap().value()) * 2.0 * TAU * r * r
        });
        assert!((ball - 1.0).abs() < 1e-12, "{ball}");
    }

    /// Standard errors by which the mean of (Gaussian density / radial density) misses 1, as it does not when `offsets`
    /// are radial. The ratio is r√(π/2)/sd in the plane (variance π/2 − 1) and r²/sd² in space (variance 2).
    fn misfit<const D: usize>(offsets: &[[f64; D]], sd: f64, variance: f64) -> f64 {
        let (radial, gaussian) = (Radial::<D>::new(sd).unwrap(), IsotropicGaussian::<D>::new(sd).unwrap());
        let ratio =
            |x: &[f64; D]| math::exp(gaussian.log_density(x).unwrap().value() - radial.log_density(x).unwrap().value());
        z_score(offsets.iter().map(ratio), 1.0, variance.sqrt())
    }

    #[test]
    fn draws_agree_with_the_density_and_gaussian_ones_do_not() {
        let (sd, n) = (0.1, 100_000);
        let flat = draws(&Radial::<2>::new(sd).unwrap(), n, 41);
        assert!(misfit(&flat, sd, PI / 2.0 - 1.0).abs() < Z_LIMIT);
        let solid = draws(&Radial::<3>::new(sd).unwrap(), n, 42);
        assert!(misfit(&solid, sd, 2.0).abs() < Z_LIMIT);
        // The wrong twins: Gaussian offsets taken for radial ones.
        assert!(misfit(&draws(&IsotropicGaussian::<2>::new(sd).unwrap(), n, 43), sd, PI / 2.0 - 1.0) > Z_LIMIT);
        assert!(misfit(&draws(&IsotropicGaussian::<3>::new(sd).unwrap(), n, 44), sd, 2.0) > Z_LIMIT);
    }

    #[test]
    fn lengths_are_half_normal_and_directions_uniform() {
        let norm = |x: &[f64; 3]| x.iter().map(|c| c * c).sum::<f64>().sqrt();
        let solid = draws(&Radial::<3>::new(2.0).unwrap(), 100_000, 45);
        assert!(ks(solid.iter().map(norm), |r| math::erf(r / 2.0 * std::f64::consts::FRAC_1_SQRT_2)) < KS_LIMIT);
        // Archimedes: the height of a uniform point on the sphere is uniform.
        for axis in 0..3 {
            assert!(ks(solid.iter().map(|x| x[axis] / norm(x)), |h| 0.5 + 0.5 * h) < KS_LIMIT);
        }
        let flat = draws(&Radial::<2>::new(2.0).unwrap(), 100_000, 46);
        assert!(ks(flat.iter().map(|x| math::atan2(x[1], x[0])), |angle| 0.5 + angle / TAU) < KS_LIMIT);
    }

    #[test]
    fn extremes_stay_values() {
        for sd in [1e-300, 1.0, 1e300] {
            let law = Radial::<3>::new(sd).unwrap();
            assert!(law.log_density(&[0.0; 3]).is_err());
            // r = sd: −½ − 3 ln sd + ln 2 − ½ ln 2π − ln 4π, of roundings below 1e-12 each.
            let expected = -0.5 - 3.0 * math::ln(sd) + math::ln(2.0) - HALF_LN_TAU - math::ln(4.0 * PI);
            let at_sd = law.log_density(&[0.0, -sd, 0.0]).unwrap().value();
            assert!((at_sd - expected).abs() < 1e-9, "{at_sd} {expected}");
            let far = law.log_density(&[1e8 * sd, 0.0, 0.0]).unwrap().value();
            assert!((far / -5e15 - 1.0).abs() < 1e-12, "{far}");
            assert!(law.log_density(&[f64::MAX; 3]).is_ok());
            assert!(law.log_density(&[5e-324, 0.0, 0.0]).unwrap().value().is_finite());
            assert!(law.log_density(&[f64::INFINITY, 0.0, 1.0]).unwrap().is_zero());
            assert!(law.log_density(&[f64::INFINITY, f64::NAN, 1.0]).is_err());
        }
        assert!(Radial::<2>::new(f64::NAN).is_err());
    }

    #[test]
    fn values_are_pinned() {
        let x = draws(&Radial::<2>::new(1.0).unwrap(), 1, 5)[0];
        assert_eq!(x.map(f64::to_bits), [4_604_588_720_975_169_029, 4_596_530_506_101_033_401]);
    }
}
