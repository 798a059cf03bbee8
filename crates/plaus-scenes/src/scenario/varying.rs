//! Requirements with formulas in place of numbers: how they are read and written.

use super::value::split_unit;
use crate::require::Formula;
use serde_json::{Value, json};

/// The key under which such a requirement is kept.
const KEY: &str = "varying";

/// Whether a text in place of a number is meant as a formula, not as a number with quotes or with a unit.
pub(super) fn is_formula(text: &str, key: &str) -> bool {
    let is_number = split_unit(text).0.parse::<f64>().is_ok();
    key.starts_with("require[") && !is_number && text.contains(|c: char| c.is_ascii_alphabetic())
}

/// A scenario in which requirements with formulas, which have these keys, are told from others.
pub(super) fn wrapped(mut scenario: Value, formulas: Vec<(String, Formula)>) -> Value {
    for (key, formula) in formulas {
        let pointer = key.trim_start_matches("require").replace(['[', '.'], "/").replace(']', "");
        let Some((index, rest)) = pointer[1..].split_once('/') else { continue };
        let Some(entry) = scenario.pointer_mut(&format!("/require/{index}")) else { continue };
        if entry.get(KEY).is_none() {
            *entry = json!({ KEY: { "entry": entry.take(), "formulas": [] } });
        }
        if let Some(Value::Array(list)) = entry.pointer_mut(&format!("/{KEY}/formulas")) {
            list.push(json!({ "at": format!("/{rest}"), "text": formula.text, "ends": formula.ends }));
        }
    }
    scenario
}

/// The same as files say it.
pub(super) fn unwrapped(scenario: &mut Value) {
    let entries = scenario.get_mut("require").and_then(Value::as_array_mut).into_iter().flatten();
    for entry in entries {
        if let Some(said) = entry.pointer_mut(&format!("/{KEY}/entry")).map(Value::take) {
            *entry = said;
        }
    }
}
