//! The laws that a number of a scenario may have. A new one needs a file in `plaus-dist`, a variant here, and a line in
//! [`LawOf::law`].

use super::domain::Domain;
use plaus_dist::WrappedUniform;
use plaus_dist::{Choice, Gaussian, LogNormal, NumberLaw, ParamError, Triangular, TruncatedGaussian, VonMises};
use plaus_mcmc::Law;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The law of an uncertain number, in the unit of its key.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LawOf {
    /// All values from the first number to the second are equally likely.
    Uniform(#[schemars(inner(range(min = -1e9, max = 1e9)))] [f64; 2]),
    /// The bell curve: mean and standard deviation.
    Normal(#[schemars(inner(range(min = -1e9, max = 1e9)))] [f64; 2]),
    /// The bell curve between two ends.
    Truncated(Truncated),
    /// A positive number that is uncertain by a factor.
    LogNormal(Factor),
    /// The least, the likeliest and the largest value; the density is a straight line in between.
    Triangular(#[schemars(inner(range(min = -1e9, max = 1e9)))] [f64; 3]),
    /// The bell curve of an angle in degrees; angles that differ by whole turns are the same.
    VonMises(Heading),
    /// One of several values.
    Choice(Several),
}

/// The bell curve between two ends.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Truncated {
    /// The mean before the ends are cut off.
    #[schemars(range(min = -1e9, max = 1e9))]
    pub mean: f64,
    /// The standard deviation before the ends are cut off.
    #[schemars(range(min = 1e-9, max = 1e9))]
    pub sd: f64,
    /// The least value.
    #[schemars(range(min = -1e9, max = 1e9))]
    pub from: f64,
    /// The largest value.
    #[schemars(range(min = -1e9, max = 1e9))]
    pub to: f64,
}

/// A positive number that is uncertain by a factor.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Factor {
    /// The median: half of all values are above it.
    #[schemars(range(min = 1e-9, max = 1e9))]
    pub median: f64,
    /// Standard deviation of the logarithm. With 0.1, two thirds of all values are within about 10 % of the median.
    #[schemars(range(min = 1e-6, max = 3.0))]
    pub spread: f64,
}

/// The bell curve of an angle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Heading {
    /// The likeliest angle.
    #[schemars(extend("minimum" = -36000.0, "maximum" = 36000.0, "x-unit" = "degree"))]
    pub mean: f64,
    /// The concentration κ. 0: all angles are equally likely. If it is large, the standard deviation is 57.3°/√κ.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub concentration: f64,
}

/// One of several values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Several {
    /// The values, all different.
    #[schemars(length(min = 1, max = 1000), inner(range(min = -1e9, max = 1e9)))]
    pub of: Vec<f64>,
    /// A weight for each value. Empty: all are equally likely.
    #[serde(default)]
    #[schemars(length(min = 0, max = 1000), inner(range(min = 1e-9, max = 1e9)))]
    pub weights: Vec<f64>,
}

/// Degrees of a whole turn.
const TURN: f64 = 360.0;

impl LawOf {
    /// The law for moves, and between which values it lies.
    ///
    /// # Errors
    /// What is wrong with its numbers, or with their use for what is measured.
    pub(super) fn law(&self, domain: Domain) -> Result<(Law, [f64; 2]), String> {
        let words = |error: ParamError| error.to_string();
        let number = |law: Arc<dyn NumberLaw>| {
            let support = law.support();
            (Law::Number(law), support)
        };
        Ok(match self {
            Self::Uniform([low, high]) => {
                let law = WrappedUniform::new(*low, *high).map_err(words)?;
                (Law::Uniform(law), [*low, *high])
            }
            Self::Normal([mean, sd]) => {
                let law = Gaussian::new(*mean, *sd).map_err(words)?;
                (Law::Gaussian(law), [f64::NEG_INFINITY, f64::INFINITY])
            }
            Self::Truncated(Truncated { mean, sd, from, to }) => {
                let law = TruncatedGaussian::new(*mean, *sd, *from, *to).map_err(words)?;
                (Law::Truncated(law), [*from, *to])
            }
            Self::LogNormal(Factor { median, spread }) => {
                number(Arc::new(LogNormal::new(*median, *spread).map_err(words)?))
            }
            Self::Triangular([low, peak, high]) => {
                number(Arc::new(Triangular::new(*low, *peak, *high).map_err(words)?))
            }
            Self::VonMises(_) if !matches!(domain, Domain::Turn | Domain::Plain) => {
                return Err("von_mises is a law for angles, and this is not an angle".into());
            }
            Self::VonMises(Heading { mean, concentration }) => {
                number(Arc::new(VonMises::new(*mean, *concentration, TURN).map_err(words)?))
            }
            Self::Choice(Several { of, weights }) => number(Arc::new(Choice::new(of, weights).map_err(words)?)),
        })
    }

    /// What a law of this kind that stays in bounds is called.
    pub(super) fn bounded(&self) -> &'static str {
        match self {
            Self::Normal(_) => "use `truncated`, a normal law with ends",
            _ => "choose ends inside that range",
        }
    }

    /// A value in its middle, for what must be shown without a draw.
    pub(super) fn centre(&self) -> f64 {
        match self {
            Self::Uniform([low, high]) => 0.5 * (low + high),
            Self::Normal([mean, _]) => *mean,
            Self::Truncated(Truncated { mean, from, to, .. }) => mean.clamp(*from, *to),
            Self::LogNormal(Factor { median, .. }) => *median,
            Self::Triangular([_, peak, _]) => *peak,
            Self::VonMises(Heading { mean, .. }) => *mean,
            Self::Choice(Several { of, .. }) => of.first().copied().unwrap_or_default(),
        }
    }
}
