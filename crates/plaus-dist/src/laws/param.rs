//! Errors of parameters, and the range that all locations and scales share.

/// Smallest standard deviation, in the units of the variable. Its reciprocal and its log are ordinary floats.
pub const SMALLEST_SCALE: f64 = 1e-300;
/// Largest standard deviation, and largest magnitude of a mean or a finite bound. Sums of a few of them cannot
/// overflow.
pub const LARGEST: f64 = 1e300;

/// A parameter outside its range: which, what it was, and what is allowed.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{distribution}: {parameter} is {value}, but must be {allowed}")]
pub struct ParamError {
    /// The distribution that was to be built, in words.
    pub distribution: &'static str,
    /// The parameter at fault.
    pub parameter: &'static str,
    /// The value it had.
    pub value: f64,
    /// The allowed range, in words that complete "must be ...".
    pub allowed: &'static str,
}

impl ParamError {
    /// `Ok` where `holds`, else the error.
    pub(crate) fn unless(
        holds: bool,
        distribution: &'static str,
        parameter: &'static str,
        value: f64,
        allowed: &'static str,
    ) -> Result<(), Self> {
        if holds { Ok(()) } else { Err(Self { distribution, parameter, value, allowed }) }
    }

    /// A standard deviation or the like.
    pub(crate) fn check_scale(distribution: &'static str, parameter: &'static str, value: f64) -> Result<(), Self> {
        let holds = (SMALLEST_SCALE..=LARGEST).contains(&value);
        Self::unless(holds, distribution, parameter, value, "from 1e-300 to 1e300")
    }

    /// A mean, or a bound that must be finite.
    pub(crate) fn check_location(distribution: &'static str, parameter: &'static str, value: f64) -> Result<(), Self> {
        Self::unless(value.abs() <= LARGEST, distribution, parameter, value, "from -1e300 to 1e300")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_message_names_parameter_value_and_range() {
        let error = ParamError::check_scale("normal law", "standard deviation", -2.0).unwrap_err();
        assert_eq!(error.to_string(), "normal law: standard deviation is -2, but must be from 1e-300 to 1e300");
        assert!(ParamError::check_scale("normal law", "standard deviation", f64::NAN).is_err());
        assert!(ParamError::check_location("normal law", "mean", f64::NAN).is_err());
        assert!(ParamError::check_location("normal law", "mean", -1e300).is_ok());
    }
}
