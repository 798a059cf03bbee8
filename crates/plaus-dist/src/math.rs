//! Portable float functions: the only access to transcendental functions in the whole project.
//!
//! `f64::sin` and its kin call the platform's C library or a compiler intrinsic, whose last bits differ between
//! systems. Everything here is the pure-Rust `libm` at one pinned version, or a fixed sequence of `+ − × ÷ √`, which
//! IEEE 754 rounds in exactly one way; so the same draw gives the same bits everywhere. Workspace lints forbid the std
//! methods.
//!
//! ```
//! use plaus_dist::math;
//! let (s, c) = math::sin_cos(0.5);
//! assert!((s * s + c * c - 1.0).abs() < 1e-15);
//! assert_eq!(math::powi(2.0, 10), 1024.0);
//! ```

/// Square of `x`.
#[inline]
#[must_use]
pub fn square(x: f64) -> f64 {
    x * x
}

macro_rules! wrap {
    ($($(#[$doc:meta])* $name:ident => $libm:ident ($($arg:ident),+);)+) => {
        $(
            $(#[$doc])*
            #[inline]
            #[must_use]
            pub fn $name($($arg: f64),+) -> f64 {
                libm::$libm($($arg),+)
            }
        )+
    };
}

wrap! {
    /// Sine; `x` in radians.
    sin => sin(x);
    /// Cosine; `x` in radians.
    cos => cos(x);
    /// Tangent; `x` in radians.
    tan => tan(x);
    /// Arc sine in radians, in [−π/2, π/2]; NaN outside [−1, 1].
    asin => asin(x);
    /// Arc cosine in radians, in [0, π]; NaN outside [−1, 1].
    acos => acos(x);
    /// Arc tangent in radians, in (−π/2, π/2).
    atan => atan(x);
    /// Angle of the vector `(x, y)` in radians, in [−π, π].
    atan2 => atan2(y, x);
    /// Natural exponential: +∞ above about 709.8, 0 below about −745.
    exp => exp(x);
    /// `exp(x) − 1`, accurate near 0.
    exp_m1 => expm1(x);
    /// Natural logarithm: −∞ at 0, NaN below.
    ln => log(x);
    /// `ln(1 + x)`, accurate near 0.
    ln_1p => log1p(x);
    /// Logarithm to base 10.
    log10 => log10(x);
    /// `x` to the real power `y`.
    powf => pow(x, y);
    /// Cube root.
    cbrt => cbrt(x);
    /// `√(x² + y²)` without overflow.
    hypot => hypot(x, y);
    /// Hyperbolic sine.
    sinh => sinh(x);
    /// Hyperbolic cosine.
    cosh => cosh(x);
    /// Hyperbolic tangent.
    tanh => tanh(x);
    /// Error function.
    erf => erf(x);
    /// Complementary error function `1 − erf(x)`, accurate far in the upper tail.
    erfc => erfc(x);
    /// `ln |Γ(x)|`.
    ln_gamma => lgamma(x);
}

/// Sine and cosine of `x` radians at once.
#[inline]
#[must_use]
pub fn sin_cos(x: f64) -> (f64, f64) {
    libm::sincos(x)
}

/// `x` to the whole power `n` by repeated squaring in a fixed order; `powi(x, 0)` is 1 for every `x`.
#[must_use]
pub fn powi(x: f64, n: i32) -> f64 {
    let mut base = if n < 0 { 1.0 / x } else { x };
    let mut left = n.unsigned_abs();
    let mut product = 1.0;
    while left > 0 {
        if left & 1 == 1 {
            product *= base;
        }
        base *= base;
        left >>= 1;
    }
    product
}

/// `ln(exp(a) + exp(b))` without overflow; −∞ stands for an empty term.
#[must_use]
pub fn ln_add_exp(a: f64, b: f64) -> f64 {
    let (high, low) = if a > b { (a, b) } else { (b, a) };
    if high == f64::NEG_INFINITY { high } else { high + ln_1p(exp(low - high)) }
}

/// `exp(x²) erfc(x)` for x ≥ 0, which neither overflows nor underflows: about `1/(x √π)` far out. Relative error below
/// 1e-14.
///
/// Below 5 the product itself; above, the continued fraction `1/(x + (1/2)/(x + (2/2)/(x + (3/2)/(x + …))))/√π`
/// (Abramowitz & Stegun 7.1.14), from its 40th term inwards: at x = 5 the rest is below one unit in the last place, and
/// it falls with x.
#[must_use]
pub fn erfc_scaled(x: f64) -> f64 {
    if x < 5.0 {
        return exp(x * x) * erfc(x);
    }
    let denominator = (1..=40).rev().fold(x, |rest, n| x + 0.5 * f64::from(n) / rest);
    0.5 * std::f64::consts::FRAC_2_SQRT_PI / denominator
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against values from Python's mpmath at 50 digits.
    #[test]
    fn scaled_complementary_error_function_is_accurate() {
        let table = [
            (0.0, 1.0),
            (0.5, 0.615_690_344_192_925_9),
            (1.0, 0.427_583_576_155_807),
            (3.0, 0.179_001_151_181_389_95),
            (4.999, 0.110_725_974_564_275_4),
            (5.0, 0.110_704_637_733_068_63),
            (6.0, 0.092_776_567_800_538_35),
            (10.0, 0.056_140_992_743_822_59),
            (30.0, 0.018_795_888_861_416_75),
            (1e8, 5.641_895_835_477_563e-9),
            (1e154, 5.641_895_835_477_563e-155),
        ];
        for (x, expected) in table {
            assert!((erfc_scaled(x) / expected - 1.0).abs() < 1e-14, "{x}: {} {expected}", erfc_scaled(x));
        }
        assert_eq!(erfc_scaled(f64::INFINITY), 0.0);
    }

    #[test]
    fn powers_agree_with_repeated_multiplication() {
        assert_eq!(powi(1.5, 3), 1.5 * 1.5 * 1.5);
        assert_eq!(powi(2.0, -3), 0.125);
        assert_eq!(powi(0.0, 0), 1.0);
    }

    #[test]
    fn adding_exponentials_survives_the_extremes() {
        assert_eq!(ln_add_exp(f64::NEG_INFINITY, f64::NEG_INFINITY), f64::NEG_INFINITY);
        assert_eq!(ln_add_exp(f64::NEG_INFINITY, 3.0), 3.0);
        assert!((ln_add_exp(1e6, 1e6) - (1e6 + ln(2.0))).abs() < 1e-9);
    }

    /// Golden bits: a change of libm would change every golden trace, so it shows here first and by name. Each is
    /// within one unit in the last place of the exact value (checked once against Python's correctly printed
    /// constants).
    #[test]
    fn bits_are_pinned() {
        let bits: Vec<u64> = [sin(1.0), cos(1.0), exp(1.0), ln(3.0), atan2(1.0, 3.0), erfc(2.0), powf(2.5, 1.7)]
            .iter()
            .map(|x| x.to_bits())
            .collect();
        assert_eq!(
            bits,
            [
                0x3fea_ed54_8f09_0cee,
                0x3fe1_4a28_0fb5_068c,
                0x4005_bf0a_8b14_576a,
                0x3ff1_93ea_7aad_030a,
                0x3fd4_978f_a326_9ee1,
                0x3f73_28f5_ec35_0e67,
                0x4012_fdcf_53f3_e6f3,
            ]
        );
    }
}
