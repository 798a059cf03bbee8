//! Numbers and texts as scenarios have them.

use plaus_dist::math::powi;

/// Most digits after the point of a number that is made shorter.
const MOST_DIGITS: i32 = 12;

/// The number with the fewest digits after the point that is no farther than `within` from this one, or this one.
pub(super) fn shortest(value: f64, within: f64) -> f64 {
    let rounded = |digits: i32| (value * powi(10.0, digits)).round() / powi(10.0, digits);
    (0..=MOST_DIGITS).map(rounded).find(|rounded| (rounded - value).abs() <= within).unwrap_or(value)
}

/// A number as a scenario has it, to a millionth.
pub(super) fn number(value: f64) -> String {
    let rounded = (value * 1e6).round() / 1e6;
    // −0 is 0; what is too large to be rounded stays.
    format!("{}", if rounded.is_finite() { rounded + 0.0 } else { value })
}

/// A file as a scenario names it.
pub(super) fn named(path: &str, anywhere: bool) -> String {
    if anywhere { format!("{}, anywhere = true", quoted(path)) } else { quoted(path) }
}

/// The path of a file that is named from a folder, which is empty or ends in `/`.
pub(super) fn joined(folder: &str, file: &str) -> String {
    let mut parts: Vec<&str> = Vec::new();
    let whole = format!("{folder}{file}");
    for part in whole.split('/') {
        match part {
            "." => {}
            ".." if parts.last().is_some_and(|last| !matches!(*last, "" | "..")) => _ = parts.pop(),
            part => parts.push(part),
        }
    }
    parts.join("/")
}

/// A text as a scenario has it.
pub(super) fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// Longest name in a scenario, but for a number that tells it from others.
const LONGEST: usize = 34;

/// A name that is valid in a scenario.
pub(super) fn plain_name(own: &str) -> String {
    let letter = |c: char| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' };
    let plain: String = own.chars().map(letter).take(LONGEST).collect();
    if plain.is_empty() { "thing".to_owned() } else { plain }
}
