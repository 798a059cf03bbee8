//! Single values: whether one fits its shape, and the message if it does not.

use super::bounds::{Bounded, Bounds};
use super::nearest::nearest;
use super::shape::{Kind, Shape};
use super::tree::Data;
use serde_json::Value;

/// What is wrong with a value, wherever it is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Wrong {
    pub(super) message: String,
    pub(super) help: Option<String>,
}

impl Wrong {
    fn new(message: String) -> Self {
        Self { message, help: None }
    }
}

/// The value in the form that serde should read.
///
/// # Errors
///
/// [`Wrong`] if its type or size does not match the shape.
pub(super) fn read(shape: &Shape, data: &Data) -> Result<Value, Wrong> {
    match (&shape.kind, data) {
        (Kind::Words(words), Data::Text(text)) => word(words, text, shape),
        (Kind::Integer(bounds), Data::Integer(digits, radix)) => integer(bounds, digits, *radix, shape),
        (Kind::Number(bounds), Data::Integer(digits, radix)) => number_of_integer(bounds, digits, *radix, shape),
        (Kind::Number(bounds), Data::Float(digits)) => number(bounds, digits, shape),
        (Kind::Boolean, Data::Boolean(value)) => Ok(Value::Bool(*value)),
        (Kind::Text, Data::Text(text)) => Ok(Value::String(text.clone())),
        (_, data) => Err(wrong_type(shape, data)),
    }
}

fn word(words: &[(String, String)], text: &str, shape: &Shape) -> Result<Value, Wrong> {
    if words.iter().any(|(word, _)| word == text) {
        return Ok(Value::String(text.into()));
    }
    let help =
        nearest(text, words.iter().map(|(word, _)| word.as_str())).map(|near| format!("did you mean \"{near}\"?"));
    Err(Wrong { message: format!("{} is not allowed: it must be {}", quoted(text), shape.range()), help })
}

fn integer(bounds: &Bounds<i128>, digits: &str, radix: u32, shape: &Shape) -> Result<Value, Wrong> {
    let value = i128::from_str_radix(digits, radix).ok().filter(|value| bounds.contains(*value));
    let value = value.and_then(|value| i64::try_from(value).ok());
    value.map(Value::from).ok_or_else(|| out_of_range(&written(digits, radix), shape))
}

/// An integer is also a number.
fn number_of_integer(bounds: &Bounds<f64>, digits: &str, radix: u32, shape: &Shape) -> Result<Value, Wrong> {
    let exact = i128::from_str_radix(digits, radix).ok().map(|value| value as f64);
    let value = exact.or_else(|| digits.parse().ok().filter(|_| radix == 10));
    let value = value.filter(|value: &f64| value.is_finite() && bounds.contains(*value));
    value.map(Value::from).ok_or_else(|| out_of_range(&written(digits, radix), shape))
}

fn number(bounds: &Bounds<f64>, digits: &str, shape: &Shape) -> Result<Value, Wrong> {
    let value = digits.parse::<f64>().ok();
    let value = value.filter(|value| value.is_finite() && bounds.contains(*value));
    value.map(Value::from).ok_or_else(|| out_of_range(digits, shape))
}

/// States the allowed range, with its unit.
fn out_of_range(value: &str, shape: &Shape) -> Wrong {
    let range = shape.range_with_unit();
    let value = clipped(value);
    if range.is_empty() {
        return Wrong::new(format!("{value} is not a finite number"));
    }
    Wrong::new(format!("{value} is out of range: it must be {range}"))
}

fn wrong_type(shape: &Shape, data: &Data) -> Wrong {
    let mut expected = shape.kind_in_words();
    let range = shape.range_with_unit();
    if !range.is_empty() {
        expected = format!("{expected}, {range}");
    }
    let help = match (&shape.kind, data) {
        (Kind::Integer(bounds), Data::Float(text) | Data::Text(text)) => {
            let whole = text.parse::<f64>().ok().filter(|value| value.fract() == 0.0 && value.abs() < 1e15);
            whole.map(|value| value as i128).filter(|value| bounds.contains(*value)).map(Bounded::written)
        }
        (Kind::Number(bounds), Data::Text(text)) => {
            let (digits, unit) = split_unit(text);
            let number = digits.parse::<f64>().ok().filter(|value| value.is_finite() && bounds.contains(*value));
            number.map(|number| match (unit, &shape.unit) {
                ("", _) | (_, None) => number.written(),
                (_, Some(unit)) => format!("{}, a plain number: its unit is {unit}", number.written()),
            })
        }
        (Kind::Boolean, Data::Text(text)) => Some(text.to_lowercase()).filter(|text| text == "true" || text == "false"),
        _ => None,
    };
    let help = help.map(|value| format!("write {value}"));
    Wrong { message: format!("expected {expected}, found {}", data.in_words()), help }
}

/// A number and the unit after it: `30 mm` is `30` and `mm`. Without a unit, the whole text and nothing.
pub(crate) fn split_unit(text: &str) -> (&str, &str) {
    let text = text.trim();
    let is_unit = |c: char| c.is_alphabetic() || "°/%²³".contains(c);
    let digits = text.trim_end_matches(is_unit).trim_end();
    if digits.parse::<f64>().is_ok() { (digits, text[digits.len()..].trim_start()) } else { (text, "") }
}

impl Data {
    /// The kind of value and, if it is short, the value.
    fn in_words(&self) -> String {
        match self {
            Self::Table(_) => "a table".into(),
            Self::List(_) => "a list".into(),
            Self::Integer(digits, radix) => format!("the integer {}", clipped(&written(digits, *radix))),
            Self::Float(digits) => format!("the number {}", clipped(digits)),
            Self::Text(text) => format!("the string {}", quoted(text)),
            Self::Boolean(value) => format!("the boolean {value}"),
            Self::Datetime(text) => format!("the date or time {text}"),
        }
    }
}

/// An integer in TOML's form.
fn written(digits: &str, radix: u32) -> String {
    let prefix = match radix {
        2 => "0b",
        8 => "0o",
        16 => "0x",
        _ => "",
    };
    format!("{prefix}{digits}")
}

/// A string in a form that can be shown.
fn quoted(text: &str) -> String {
    format!("{:?}", clipped(text))
}

/// At most 40 characters.
fn clipped(text: &str) -> String {
    let short: String = text.chars().take(40).collect();
    if short.len() < text.len() { short + "…" } else { short }
}
