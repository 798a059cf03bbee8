//! Ranges of numbers, and how they are worded.

use serde_json::{Map, Value};
use std::fmt::Display;

/// A range of numbers; each end may be missing, and may be excluded.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Bounds<T> {
    pub(super) lower: Option<End<T>>,
    pub(super) upper: Option<End<T>>,
}

/// An end of a range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct End<T> {
    pub(super) value: T,
    /// Whether the end itself is allowed.
    pub(super) closed: bool,
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
    /// The range that a schema states by `minimum`, `maximum` and their exclusive variants; if both are present, the
    /// tighter one counts.
    pub(super) fn of_schema(schema: &Map<String, Value>) -> Self {
        let end = |key: &str, closed| schema.get(key).and_then(T::of_json).map(|value| End { value, closed });
        let tighter = |closed: Option<End<T>>, open: Option<End<T>>, is_tighter: fn(T, T) -> bool| match (closed, open)
        {
            (Some(a), Some(b)) => Some(if is_tighter(a.value, b.value) { a } else { b }),
            (a, b) => a.or(b),
        };
        Self {
            lower: tighter(end("minimum", true), end("exclusiveMinimum", false), |a, b| a > b),
            upper: tighter(end("maximum", true), end("exclusiveMaximum", false), |a, b| a < b),
        }
    }

    /// Whether `value` is allowed.
    pub(super) fn contains(&self, value: T) -> bool {
        self.lower.is_none_or(|end| value > end.value || (end.closed && value == end.value))
            && self.upper.is_none_or(|end| value < end.value || (end.closed && value == end.value))
    }

    /// The only value between the bounds, if they are one.
    pub(super) fn only(&self) -> Option<String> {
        let (lower, upper) = (self.lower?, self.upper?);
        let same = lower.closed && upper.closed && lower.value == upper.value;
        same.then(|| lower.value.written())
    }

    /// E.g. "from 1 to 64", "above 0 and at most 90"; empty if there is no bound.
    pub(super) fn words(&self) -> String {
        let lower = self.lower.map(|end| (if end.closed { "at least" } else { "above" }, end));
        let upper = self.upper.map(|end| (if end.closed { "at most" } else { "below" }, end));
        match (lower, upper) {
            (Some((_, a)), Some((_, b))) if a.closed && b.closed => {
                format!("from {} to {}", a.value.written(), b.value.written())
            }
            (Some((above, a)), Some((below, b))) => {
                format!("{above} {} and {below} {}", a.value.written(), b.value.written())
            }
            (Some((word, end)), None) | (None, Some((word, end))) => format!("{word} {}", end.value.written()),
            (None, None) => String::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn bounds<T: Bounded>(schema: Value) -> Bounds<T> {
        Bounds::of_schema(schema.as_object().unwrap())
    }

    #[test]
    fn ends_are_in_or_out_as_stated() {
        let half_open = bounds::<f64>(json!({ "exclusiveMinimum": 0.0, "maximum": 90.0 }));
        assert!(!half_open.contains(0.0) && !half_open.contains(-0.0) && half_open.contains(5e-324));
        assert!(
            half_open.contains(90.0) && !half_open.contains(90.000_000_000_000_02) && !half_open.contains(f64::NAN)
        );
        let both = bounds::<i128>(json!({ "minimum": 0, "exclusiveMinimum": 0, "maximum": u64::MAX }));
        assert!(!both.contains(0) && both.contains(1) && both.contains(u64::MAX.into()));
        assert!(!both.contains(i128::from(u64::MAX) + 1));
    }

    #[test]
    fn ranges_are_put_into_words() {
        assert_eq!(
            bounds::<f64>(json!({ "exclusiveMinimum": 0.0, "maximum": 1e6 })).words(),
            "above 0 and at most 1e6"
        );
        assert_eq!(bounds::<i128>(json!({ "minimum": 1, "maximum": 1_000_000 })).words(), "from 1 to 1_000_000");
        assert_eq!(bounds::<f64>(json!({ "minimum": 0.5 })).words(), "at least 0.5");
        assert_eq!(bounds::<f64>(json!({ "exclusiveMaximum": -1e-9 })).words(), "below -1e-9");
        assert_eq!(bounds::<f64>(json!({})).words(), "");
        assert_eq!((-12_345_i128).written(), "-12_345");
    }
}
