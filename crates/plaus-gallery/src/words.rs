//! Requirements in a few words, as names of columns.

use plaus_scenes::require::Require;
use serde_json::Value;

/// Keys of a requirement whose values are names of things.
const NAMING: [&str; 6] = ["body", "with", "on", "to", "of", "joint"];

/// The kind of a requirement and the names in it, such as `not touches cue floor`; or the name that the user gave it.
pub(crate) fn words(require: &Require) -> String {
    let mut words = Vec::new();
    if let Ok(value) = serde_json::to_value(require) {
        add(&value, &mut words);
    }
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
    use serde_json::json;

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
            assert_eq!(words(&serde_json::from_value(value).unwrap()), wanted);
        }
    }
}
