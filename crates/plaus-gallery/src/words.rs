//! Requirements in a few words, as names of columns.

use plaus_scenes::require::Require;
use plaus_scenes::{Role, Scalar};
use serde_json::{Value, json};

/// The numbers of a solution that a page shows: names, units, and whether each is drawn. Those of margins say what is
/// required.
pub(crate) fn columns(scalars: &[Scalar], required: &Value) -> Value {
    let mut names: Vec<String> = scalars.iter().map(|scalar| scalar.name.clone()).collect();
    // The last ones are the margins of the requirements, in order.
    for (name, one) in names.iter_mut().rev().zip(required.as_array().into_iter().flatten().rev()) {
        *name = format!("{name}: {}", words(one));
    }
    let shown = scalars.iter().zip(names).filter(|(scalar, _)| scalar.role != Role::Detail);
    shown.map(|(one, name)| json!({"name": name, "unit": one.unit, "draw": one.role == Role::Draw})).collect()
}

/// Keys of a requirement whose values are names of things.
const NAMING: [&str; 6] = ["body", "with", "on", "to", "of", "joint"];

/// The kind of a requirement and the names in it, such as `not touches cue floor`; or the name that the user gave it.
fn words(require: &Value) -> String {
    let mut words = Vec::new();
    add(require, &mut words);
    words.join(" ")
}

fn add(value: &Value, words: &mut Vec<String>) {
    match value {
        Value::Array(all) => all.iter().for_each(|one| add(one, words)),
        Value::Object(all) => {
            for (key, value) in all {
                match value {
                    Value::Object(named) if key == "named" => words.extend(named["name"].as_str().map(str::to_owned)),
                    Value::String(name) if NAMING.contains(&key.as_str()) && !name.is_empty() => {
                        words.push(name.clone());
                    }
                    Value::Object(_) | Value::Array(_) => {
                        if Require::NAMES.contains(&key.as_str()) {
                            words.push(key.replace('_', " "));
                        }
                        add(value, words);
                    }
                    _ => {}
                }
            }
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requirements_have_words() {
        let cases = [
            (json!({"touches": {"body": "eight", "with": "floor"}}), "touches eight floor"),
            (json!({"not": {"stands": {"body": "can_1"}}}), "not stands can_1"),
            (json!({"impact": {"when": {"at_s": 2}}}), "impact"),
            (json!({"count": {"of": "toy_*", "at_least": 2, "that": {"stands": {}}}}), "count toy_* stands"),
            (
                json!({"any": [{"rests_at": {"body": "a"}}, {"breaks": {"joint": "glue"}}]}),
                "any rests at a breaks glue",
            ),
            (
                json!({"named": {"name": "ring the bell", "that": {"touches": {"body": "a", "with": "bell"}}}}),
                "ring the bell",
            ),
        ];
        for (value, wanted) in cases {
            assert_eq!(words(&value), wanted);
        }
    }
}
