//! The von Mises law on a ring.

use crate::number::as_number_law;
use crate::param::{LARGEST, ParamError};
use crate::{Density, LogDensity, NotANumber, Sample, Stream, WrappedUniform, math, open_unit};
use std::f64::consts::{PI, TAU};

/// The bell curve of angles: a point of a ring whose ends are joined, most likely at `mean`.
///
/// With `a = 2π (x − mean)/period` the density is `exp(κ cos a)/(period I₀(κ))` per unit of x. κ is the concentration:
/// 0 is uniform, and for a large one the law is nearly Gaussian with a standard deviation of `1/√κ` radians.
///
/// Source of the sampler: D. J. Best and N. I. Fisher, "Efficient simulation of the von Mises distribution", Applied
/// Statistics 28, 1979. At least 2 of 3 proposals are accepted.
///
/// ```
/// use plaus_dist::{Density, VonMises};
/// let heading = VonMises::new(350.0, 8.0, 360.0)?; // degrees
/// let [a, b] = [heading.log_density(&-30.0)?, heading.log_density(&10.0)?];
/// assert!((a.value() - b.value()).abs() < 1e-12, "both are 20° from the mean");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VonMises {
    ring: WrappedUniform,
    mean: f64,
    concentration: f64,
    /// Log density at the mean.
    log_peak: f64,
}

const NAME: &str = "von Mises law";

/// Most points of the sum for the normalisation; the largest concentration needs them.
const MOST_POINTS: f64 = 65_536.0;

/// `ln(I₀(κ) exp(−κ))`: the logarithm of the mean of `exp(κ (cos a − 1))` over the ring. For a periodic function the
/// trapezoidal rule converges faster than any power once its points are closer together than the peak is wide, `1/√κ`.
fn log_scaled_bessel(concentration: f64) -> f64 {
    let points = (64.0 + 24.0 * concentration.sqrt()).ceil().min(MOST_POINTS);
    let term = |k: f64| math::exp(concentration * (math::sin_cos(TAU * k / points).1 - 1.0));
    let sum: f64 = (0..points as u32).map(|k| term(f64::from(k))).sum();
    math::ln(sum / points)
}

impl VonMises {
    /// On a ring of length `period` centred on `mean`.
    ///
    /// # Errors
    /// [`ParamError`] unless the mean is within ±1e300, the concentration from 0 to 1e6 and the period from 1e-9 to
    /// 1e9.
    pub fn new(mean: f64, concentration: f64, period: f64) -> Result<Self, ParamError> {
        ParamError::unless(mean.abs() <= LARGEST, NAME, "mean", mean, "from -1e300 to 1e300")?;
        let holds = (0.0..=1e6).contains(&concentration);
        ParamError::unless(holds, NAME, "concentration", concentration, "from 0 to 1e6")?;
        ParamError::unless((1e-9..=1e9).contains(&period), NAME, "period", period, "from 1e-9 to 1e9")?;
        let ring = WrappedUniform::new(mean - 0.5 * period, mean + 0.5 * period)?;
        let log_peak = -math::ln(period) - log_scaled_bessel(concentration);
        Ok(Self { ring, mean, concentration, log_peak })
    }

    /// The most likely value.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// κ.
    #[must_use]
    pub fn concentration(&self) -> f64 {
        self.concentration
    }

    fn period(&self) -> f64 {
        self.ring.high() - self.ring.low()
    }
}

impl Density<f64> for VonMises {
    /// The same at all values that differ by whole periods.
    ///
    /// # Errors
    /// [`NotANumber`] if `x` is NaN or infinite.
    fn log_density(&self, x: &f64) -> Result<LogDensity, NotANumber> {
        let from_mean = self.ring.wrap(*x) - self.mean;
        // cos a − 1 = −2 sin² (a/2), without cancellation.
        let half = math::sin_cos(PI * from_mean / self.period()).0;
        LogDensity::new(self.log_peak - 2.0 * self.concentration * half * half)
    }
}

impl Sample for VonMises {
    type Value = f64;
    fn sample(&self, stream: &mut Stream) -> f64 {
        // Below this the proposal's own parameter loses its digits, and the law is uniform to within a millionth.
        if self.concentration < 1e-6 {
            return loop {
                let x = self.ring.low() + self.period() * open_unit(stream);
                let part = math::exp(self.log_density(&x).map_or(0.0, LogDensity::value) - self.log_peak);
                if open_unit(stream) < part {
                    break self.ring.wrap(x);
                }
            };
        }
        let k = self.concentration;
        let tau = 1.0 + (1.0 + 4.0 * k * k).sqrt();
        let rho = (tau - (2.0 * tau).sqrt()) / (2.0 * k);
        let r = (1.0 + rho * rho) / (2.0 * rho);
        loop {
            let z = math::sin_cos(PI * open_unit(stream)).1;
            let f = (1.0 + r * z) / (r + z);
            let c = k * (r - f);
            let u = open_unit(stream);
            if c * (2.0 - c) - u > 0.0 || math::ln(c / u) + 1.0 - c >= 0.0 {
                let angle = math::acos(f.clamp(-1.0, 1.0));
                let signed = if open_unit(stream) < 0.5 { -angle } else { angle };
                return self.ring.wrap(self.mean + signed / TAU * self.period());
            }
        }
    }
}

as_number_law!(VonMises {
    fn support(&self) -> [f64; 2] {
        [self.ring.low(), self.ring.high()]
    }

    /// A standard deviation of the nearly Gaussian law, at most a third of the ring.
    fn width(&self) -> f64 {
        self.period() * (1.0 / (TAU * self.concentration.sqrt())).min(1.0 / 3.0)
    }

    /// Around the ring.
    fn step(&self, x: f64, by: f64) -> f64 {
        self.ring.wrap(x + by)
    }
});

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NumberLaw;
    use crate::testing::{KS_LIMIT, draws, integrate, ks};

    /// The distribution function is the density's own integral, which is 1 in total. A sampler with another
    /// concentration does not fit it.
    #[test]
    fn draws_have_the_law_of_their_own_concentration_only() {
        for concentration in [0.0, 1e-7, 0.3, 2.0, 50.0, 1e4] {
            let law = VonMises::new(10.0, concentration, 360.0).unwrap();
            let density = |x: f64| math::exp(law.log_density(&x).unwrap().value());
            let reach = (8.0 * law.width()).min(180.0);
            let mass = integrate(10.0 - reach, 10.0 + reach, density);
            assert!((mass - 1.0).abs() < 1e-9, "{concentration}: {mass}");
            let cells = 400_i32;
            let step = 2.0 * reach / f64::from(cells);
            let mut sums = vec![0.0];
            for k in 0..cells {
                let from = 10.0 - reach + step * f64::from(k);
                sums.push(
                    sums[k.unsigned_abs() as usize]
                        + step / 6.0 * (density(from) + 4.0 * density(from + 0.5 * step) + density(from + step)),
                );
            }
            let cdf = |x: f64| {
                let place = ((x - 10.0 + reach) / step).clamp(0.0, f64::from(cells));
                let cell = (place as usize).min(sums.len() - 2);
                sums[cell] + (sums[cell + 1] - sums[cell]) * (place - cell as f64)
            };
            // The distribution function is taken as straight within a cell of a 50th of the width: at most 1e-4 off.
            assert!(ks(draws(&law, 40_000, 13).into_iter(), cdf) < KS_LIMIT);
            let other = VonMises::new(10.0, 1.15 * concentration + 0.15, 360.0).unwrap();
            assert!(ks(draws(&other, 40_000, 14).into_iter(), cdf) > KS_LIMIT, "{concentration}");
        }
    }

    /// I₀(1) and I₀(10) as Abramowitz and Stegun have them (table 9.8: `e^−x I₀(x)`).
    #[test]
    fn the_normalisation_agrees_with_the_table() {
        for (x, value) in [(0.0, 1.0_f64), (1.0, 0.465_759_607_6), (10.0, 0.127_833_337_2)] {
            assert!((log_scaled_bessel(x) - math::ln(value)).abs() < 1e-9, "{x}");
        }
        // Far out: 1/√(2πκ) (1 + 1/(8κ) + 9/(128κ²)).
        let large = |k: f64| math::ln(1.0 + 1.0 / (8.0 * k) + 9.0 / (128.0 * k * k)) - 0.5 * math::ln(TAU * k);
        for k in [1e3, 1e6] {
            assert!((log_scaled_bessel(k) - large(k)).abs() < 1e-9, "{k}");
        }
    }

    #[test]
    fn bad_numbers_are_refused() {
        let nan = f64::NAN;
        for (mean, k, period) in
            [(0.0, -1.0, 360.0), (0.0, 2e6, 1.0), (nan, 1.0, 1.0), (0.0, 1.0, 0.0), (0.0, nan, 1.0)]
        {
            assert!(VonMises::new(mean, k, period).is_err());
        }
        assert!(VonMises::new(0.0, 1.0, 360.0).unwrap().log_density(&nan).is_err());
    }

    #[test]
    fn values_are_pinned() {
        assert_eq!(
            draws(&VonMises::new(0.0, 4.0, 360.0).unwrap(), 2, 1),
            [-20.421_082_211_310_125, -31.669_905_634_073_98]
        );
    }
}
