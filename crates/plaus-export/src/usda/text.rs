//! Text under construction, and what may occur in it.

use crate::glb::unique;
use serde_json::Value;
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// Unfinished text. Writing to a string cannot fail.
#[derive(Default)]
pub(super) struct Text(pub(super) String);

impl Text {
    pub(super) fn line(&mut self, depth: usize, text: &str) {
        let _ = writeln!(self.0, "{:1$}{text}", "", 4 * depth);
    }
}

/// A fact as a typed entry of a dictionary; values without a simple type become text.
pub(super) fn fact(key: &str, value: &Value) -> String {
    let key = quoted(&format!("plaus:{key}"));
    match value {
        Value::Bool(value) => format!("bool {key} = {value}"),
        Value::Number(number) => match number.as_i64().and_then(|whole| i32::try_from(whole).ok()) {
            Some(whole) => format!("int {key} = {whole}"),
            None if number.is_f64() => format!("double {key} = {number}"),
            None => format!("string {key} = \"{number}\""),
        },
        Value::String(text) => format!("string {key} = {}", quoted(text)),
        other => format!("string {key} = {}", quoted(&other.to_string())),
    }
}

pub(super) fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            '\n' => quoted.push_str("\\n"),
            c if c.is_control() => quoted.push(' '),
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}

/// The scope of materials, beside the bodies.
pub(super) const MATERIALS: &str = "Looks";
/// The prim with gravity, beside the bodies.
pub(super) const PHYSICS: &str = "physics";

/// Names of the prims of bodies and scenery: unique; letters, digits and underscores, not beginning with a digit.
pub(super) struct Names(BTreeSet<String>);

impl Default for Names {
    fn default() -> Self {
        Self([MATERIALS, PHYSICS].map(str::to_owned).into())
    }
}

impl Names {
    pub(super) fn unique(&mut self, wanted: &str) -> String {
        let name = unique(&identifier(wanted), "_", |name| self.0.contains(name));
        self.0.insert(name.clone());
        name
    }
}

/// Letters, digits and underscores, not beginning with a digit.
pub(super) fn identifier(wanted: &str) -> String {
    let mut name: String = wanted.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if !name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') {
        name.insert(0, '_');
    }
    name
}
