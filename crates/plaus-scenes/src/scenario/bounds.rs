//! Ranges of numbers, and how they are worded.

use serde_json::{Map, Value};
use std::fmt::Display;

/// A range of numbers with its ends; each end may be missing.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Bounds<T> {
    pub(super) least: Option<T>,
    pub(super) most: Option<T>,
}

/// A number that a schema can bound.
pub(super) trait Bounded: Copy + PartialOrd + Display {
    /// The bound a schema states.
    fn of_json(value: &Value) -> Option<Self>;
    /// As it may be written in TOML, in a form that is easy to read.
    fn written(self) -> String;
}

impl Bounded for f64 {
    fn of_json(value: &Value) -> Option<Self> {
        value.as_f64()
    }

    fn written(self) -> String {
        let (plain, scientific) = (format!("{self}"), format!("{self:e}"));
        if plain.len() > 6 && scientific.len() < plain.len() { scientific } else { plain }
    }
}

impl Bounded for i128 {
    fn of_json(value: &Value) -> Option<Self> {
        value.as_i64().map(i128::from).or_else(|| value.as_u64().map(i128::from))
    }

    /// With underscores, as TOML allows, from five digits on.
    fn written(self) -> String {
        let digits = self.unsigned_abs().to_string();
        if digits.len() < 5 {
            return self.to_string();
        }
        let mut grouped = String::from(if self < 0 { "-" } else { "" });
        for (index, digit) in digits.chars().enumerate() {
            if index > 0 && (digits.len() - index).is_multiple_of(3) {
                grouped.push('_');
            }
            grouped.push(digit);
        }
        grouped
    }
}

impl<T: Bounded> Bounds<T> {
    /// The range that a schema states by these two words: `minimum` and `maximum`, or `minItems` and `maxItems`.
    pub(super) fn of_schema(schema: &Map<String, Value>, ends: [&str; 2]) -> Self {
        let [least, most] = ends.map(|end| schema.get(end).and_then(T::of_json));
        Self { least, most }
    }

    /// Whether `value` is allowed.
    pub(super) fn contains(&self, value: T) -> bool {
        self.least.is_none_or(|least| value >= least) && self.most.is_none_or(|most| value <= most)
    }

    /// The only value between the bounds, if they are one.
    pub(super) fn only(&self) -> Option<String> {
        self.least.filter(|least| self.most == Some(*least)).map(T::written)
    }

    /// E.g. "from 1 to 64", "at least 0"; empty if there is no bound.
    pub(super) fn words(&self) -> String {
        match (self.least.map(T::written), self.most.map(T::written)) {
            (Some(least), Some(most)) => format!("from {least} to {most}"),
            (Some(least), None) => format!("at least {least}"),
            (None, Some(most)) => format!("at most {most}"),
            (None, None) => String::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn bounds<T: Bounded>(schema: Value) -> Bounds<T> {
        Bounds::of_schema(schema.as_object().unwrap(), ["minimum", "maximum"])
    }

    #[test]
    fn ends_are_allowed() {
        let share = bounds::<f64>(json!({ "minimum": 0.0, "maximum": 90.0 }));
        assert!(share.contains(0.0) && share.contains(-0.0) && !share.contains(-5e-324));
        assert!(share.contains(90.0) && !share.contains(90.000_000_000_000_02) && !share.contains(f64::NAN));
        let whole = bounds::<i128>(json!({ "minimum": 1, "maximum": u64::MAX }));
        assert!(!whole.contains(0) && whole.contains(1) && whole.contains(u64::MAX.into()));
        assert!(!whole.contains(i128::from(u64::MAX) + 1));
    }

    #[test]
    fn ranges_are_put_into_words() {
        assert_eq!(bounds::<f64>(json!({ "minimum": 0.0, "maximum": 1e6 })).words(), "from 0 to 1e6");
        assert_eq!(bounds::<i128>(json!({ "minimum": 1, "maximum": 1_000_000 })).words(), "from 1 to 1_000_000");
        assert_eq!(bounds::<f64>(json!({ "minimum": 0.5 })).words(), "at least 0.5");
        assert_eq!(bounds::<f64>(json!({ "maximum": -1e-9 })).words(), "at most -1e-9");
        assert_eq!(bounds::<f64>(json!({})).words(), "");
        assert_eq!((-12_345_i128).written(), "-12_345");
    }
}
