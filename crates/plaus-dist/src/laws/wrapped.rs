//! The uniform law on a ring, for moves that wrap around.

use crate::param::ParamError;
use crate::{Density, LogDensity, NotANumber, Sample, Stream, Uniform};
use serde::{Deserialize, Serialize};

/// Equal density on [low, high), where leaving at one end means entering at the other.
///
/// Density `1/(high − low)`, as for [`Uniform`]. In addition there is [`wrap`](Self::wrap): a step `x → wrap(x + d)`
/// with `d` symmetric about 0 is a symmetric move, and leaves this law invariant.
///
/// ```
/// use plaus_dist::WrappedUniform;
/// let turn = WrappedUniform::new(0.0, 360.0)?; // degrees
/// assert_eq!(turn.wrap(-90.0), 270.0);
/// assert_eq!(turn.wrap(360.0), 0.0);
/// assert_eq!(turn.wrap(1e6), 280.0);
/// # Ok::<(), plaus_dist::ParamError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct WrappedUniform(Uniform);

impl WrappedUniform {
    /// On [`low`, `high`), of period `high − low` as a float.
    ///
    /// # Errors
    /// [`ParamError`] unless both are within ±1e300 and low < high.
    pub fn new(low: f64, high: f64) -> Result<Self, ParamError> {
        Uniform::named("uniform law", low, high).map(Self)
    }

    /// The lower end, which belongs to the interval.
    #[inline]
    #[must_use]
    pub fn low(&self) -> f64 {
        self.0.low()
    }

    /// The upper end, which does not: it is `low` again.
    #[inline]
    #[must_use]
    pub fn high(&self) -> f64 {
        self.0.high()
    }

    /// The point of [low, high) that differs from `x` by whole periods; `x` itself if it is inside.
    ///
    /// Remainders are exact. So however far away `x` is, the result differs from the true one by no more than the last
    /// rounding and the rounding of the remainder of `low`. NaN if `x` is NaN or infinite; the density then refuses it.
    #[inline]
    #[must_use]
    pub fn wrap(&self, x: f64) -> f64 {
        let (low, high) = (self.low(), self.high());
        if low <= x && x < high { x } else { wrap_outside(x, low, high) }
    }
}

fn wrap_outside(x: f64, low: f64, high: f64) -> f64 {
    let period = high - low;
    // Each remainder is in (−period, period), so one period brings the difference there too.
    let mut above = x % period - low % period;
    if above.abs() >= period {
        above -= period.copysign(above);
    }
    // Counted from the nearer side of 0, for the sake of the last bit.
    let wrapped = if above < 0.0 { high + above } else { low + above };
    // Rounding may pass either end, and both are `low`. (NaN is neither.)
    if wrapped >= high || wrapped < low { low } else { wrapped }
}

impl Density<f64> for WrappedUniform {
    /// # Errors
    /// [`NotANumber`] if `x` is NaN.
    #[inline]
    fn log_density(&self, x: &f64) -> Result<LogDensity, NotANumber> {
        self.0.log_density(x)
    }
}

impl Sample for WrappedUniform {
    type Value = f64;
    #[inline]
    fn sample(&self, stream: &mut Stream) -> f64 {
        self.0.sample(stream)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{KS_LIMIT, draws, ks, stream};
    use proptest::prelude::*;

    #[test]
    fn every_edge_comes_home() {
        let ring = WrappedUniform::new(-5.0, 5.0).unwrap();
        for (x, expected) in
            [(-5.0, -5.0), (5.0, -5.0), (6.0, -4.0), (-6.0, 4.0), (15.0, -5.0), (-15.0, -5.0), (1e15 + 3.0, 3.0)]
        {
            assert_eq!(ring.wrap(x), expected, "{x}");
        }
        assert_eq!(ring.wrap((-5.0_f64).next_down()), 5.0_f64.next_down());
        // Just below low, where 1 − 10⁻³⁰⁰ rounds to high, which is low.
        assert_eq!(WrappedUniform::new(0.0, 1.0).unwrap().wrap(-1e-300), 0.0);
        assert!(ring.wrap(f64::NAN).is_nan() && ring.wrap(f64::INFINITY).is_nan());
    }

    #[test]
    fn distance_costs_no_accuracy() {
        // 10¹⁸ + 128 is a float; 10¹⁸ mod 360 = 280 by integer arithmetic, and (280 + 128) mod 360 = 48.
        assert_eq!(WrappedUniform::new(0.0, 360.0).unwrap().wrap(1e18 + 128.0), 48.0);
    }

    proptest! {
        /// Whole numbers are exact, so whole-number arithmetic is the reference, with `low` many periods from 0 too.
        #[test]
        fn whole_periods_are_taken_off(
            low in -1_000_000_i64..1_000_000,
            width in 1_i64..1000,
            x in -(1_i64 << 52)..1_i64 << 52,
        ) {
            let ring = WrappedUniform::new(low as f64, (low + width) as f64).unwrap();
            prop_assert_eq!(ring.wrap(x as f64), (low + (x - low).rem_euclid(width)) as f64);
        }

        #[test]
        fn any_finite_value_comes_inside_and_stays(
            low in -1e9..1e9_f64,
            width in 1e-9..1e9_f64,
            x in prop::num::f64::NORMAL | prop::num::f64::ZERO | prop::num::f64::SUBNORMAL,
        ) {
            let ring = WrappedUniform::new(low, low + width);
            prop_assume!(ring.is_ok());
            let ring = ring.unwrap();
            let inside = ring.wrap(x);
            prop_assert!(ring.low() <= inside && inside < ring.high(), "{inside}");
            prop_assert_eq!(ring.wrap(inside), inside);
        }
    }

    /// Steps of up to ±3 on a ring of 10 keep the law; a step that stops at the ends instead does not, and the same
    /// test says so.
    #[test]
    fn wrapped_steps_leave_the_law_invariant() {
        let ring = WrappedUniform::new(-2.0, 8.0).unwrap();
        let step = Uniform::new(-3.0, 3.0).unwrap();
        let mut stream = stream(51);
        let starts = draws(&ring, 100_000, 52);
        let moved: Vec<f64> = starts.iter().map(|x| x + step.sample(&mut stream)).collect();
        let cdf = |x: f64| (x + 2.0) / 10.0;
        assert!(ks(moved.iter().map(|&x| ring.wrap(x)), cdf) < KS_LIMIT);
        assert!(ks(moved.iter().map(|x| x.clamp(-2.0, 8.0)), cdf) > KS_LIMIT);
    }

    #[test]
    fn errors_carry_its_own_name() {
        let error = WrappedUniform::new(3.0, 3.0).unwrap_err();
        assert_eq!(error.to_string(), "uniform law: high is 3, but must be above low");
    }
}
