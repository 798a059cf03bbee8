//! Laws whose numbers are uncertain: `normal(0, uniform(1, 2))`.
//!
//! Such a law is written over a standard law, whose draws do not depend on its numbers. So every move over variables is
//! exact, and the ranges of results follow from those of the numbers.

use super::domain::Domain;
use super::formula::Formula;
use super::laws::{LawOf, Several};
use super::values::{Collector, Value};
use std::sync::Arc;

/// A law over standard ones.
struct Over {
    law: &'static str,
    /// Names of its numbers, and which of them must be positive, or at least 0.
    numbers: &'static [(&'static str, Sign)],
    /// Standard normal, or uniform from 0 to 1.
    is_normal: bool,
    /// How many of these are drawn: `u` and `v`.
    draws: usize,
    text: &'static str,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Sign {
    Any,
    NotNegative,
    Positive,
}

/// All but `choice`. The mean of the smaller and the larger of two uniform numbers, weighted by how far the peak is
/// from the ends, is triangular. Rounding may not lead out of the ends.
const OVER: &[Over] = &[
    Over {
        law: "uniform",
        numbers: &[("a", Sign::Any), ("b", Sign::Any)],
        is_normal: false,
        draws: 1,
        text: "max(min(a, b), min(max(a, b), a + (b - a) * u))",
    },
    Over {
        law: "normal",
        numbers: &[("mean", Sign::Any), ("sd", Sign::NotNegative)],
        is_normal: true,
        draws: 1,
        text: "mean + sd * u",
    },
    Over {
        law: "log_normal",
        numbers: &[("median", Sign::Positive), ("spread", Sign::NotNegative)],
        is_normal: true,
        draws: 1,
        text: "median * exp(spread * u)",
    },
    Over {
        law: "triangular",
        numbers: &[("a", Sign::Any), ("peak", Sign::Any), ("b", Sign::Any)],
        is_normal: false,
        draws: 2,
        text: "max(a, min(b, a + (b - a) * min(u, v) + (peak - a) * abs(u - v)))",
    },
];

impl Collector {
    /// The value of a formula's law, given the values of its names and of the laws before it. Its standard draws have
    /// the columns `name` and, if there are two, `name_v`.
    ///
    /// # Errors
    /// Laws that cannot be written so, and numbers that may be too small.
    pub(super) fn given(
        &mut self,
        formula: &Formula,
        place: usize,
        values: &[Value],
        name: &str,
    ) -> Result<Value, String> {
        let (law, numbers) = formula.numbers_of(place);
        let mut known = Vec::with_capacity(numbers.len());
        for number in numbers {
            let value = self.step(Arc::new(number), values.to_vec())?;
            let (low, high) = self.ends(value);
            known.push(if low == high { Value::Fixed(low) } else { value });
        }
        if law == "choice" {
            let places =
                LawOf::Choice(Several { of: (0..known.len()).map(|k| k as f64).collect(), weights: Vec::new() });
            let count = known.len();
            known.insert(0, self.drawn(&places, name.to_owned(), "", Domain::Any)?);
            return self.step(Arc::new(Formula::one_of(count)), known);
        }
        let Some(over) = OVER.iter().find(|over| over.law == law) else {
            return Err(format!("the numbers in {law}(…) must be certain"));
        };
        for ((number, sign), value) in over.numbers.iter().zip(&known) {
            let (low, high) = self.ends(*value);
            let must = match sign {
                Sign::NotNegative if low < 0.0 => "at least 0",
                Sign::Positive if low <= 0.0 => "positive",
                _ => continue,
            };
            return Err(format!("{number} of {law}(…) goes from {low} to {high}, and must be {must}"));
        }
        self.check_peak(law, &known)?;
        let standard = if over.is_normal { LawOf::Normal([0.0, 1.0]) } else { LawOf::Uniform([0.0, 1.0]) };
        let mut means: Vec<(&str, Value)> = over.numbers.iter().map(|(number, _)| *number).zip(known).collect();
        for (letter, ending) in [("u", ""), ("v", "_v")].into_iter().take(over.draws) {
            means.push((letter, self.drawn(&standard, format!("{name}{ending}"), "", Domain::Any)?));
        }
        self.follows(over.text, &means)
    }

    /// Refuses a peak that may be outside the ends.
    fn check_peak(&self, law: &str, numbers: &[Value]) -> Result<(), String> {
        let [least, peak, most] = numbers else { return Ok(()) };
        let (low, high) = self.ends(*peak);
        if self.ends(*least).1 <= low && high <= self.ends(*most).0 {
            return Ok(());
        }
        Err(format!(
            "the peak of {law}(…) goes from {low} to {high}, and may be outside the ends: where they shift together, \
             write `x + {law}(…)`"
        ))
    }
}
