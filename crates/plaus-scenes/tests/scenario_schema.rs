//! The schema is enforced exactly, and everything derived from it agrees with the code.

use crate::common::{BALL2D, Leaf, leaves};
use plaus_scenes::Scenario;
use plaus_scenes::registry::NAMES;
use plaus_scenes::scenario::{self, Method, NoKey, explain, keys, template};
use serde_json::Value;
use std::collections::BTreeSet;

fn with(key: &str, value: &str) -> Result<Scenario, scenario::ScenarioError> {
    let scene = key.strip_prefix("world.").and_then(|rest| rest.split('.').next()).unwrap_or(NAMES[0]);
    Scenario::read("test.toml", &format!("[world.{scene}]"), &[format!("{key}={value}")])
}

/// A value that is refused has one problem, with `leaf`, whose message states the range.
fn refused(leaf: &Leaf, value: &str) {
    let doc = explain(&leaf.key).unwrap();
    let error = with(&leaf.key, value).expect_err(&format!("{}={value}", leaf.key));
    assert_eq!(error.problems.len(), 1, "{error}");
    assert_eq!(error.problems[0].key, leaf.key);
    assert!(!doc.range.is_empty() && error.problems[0].message.contains(&doc.range), "{error} lacks {}", doc.range);
}

/// The value by itself is valid. If it does not fit together with the other keys' defaults (a ball larger than a bin),
/// the message is another one.
fn taken(leaf: &Leaf, value: &str) {
    if let Err(error) = with(&leaf.key, value) {
        let of_the_scene = error.problems.len() == 1 && !error.problems[0].key.starts_with("world.ball2d.");
        let is_range = error.to_string().contains("out of range");
        assert!(of_the_scene && !is_range, "{}={value} is in range, yet: {error}", leaf.key);
    }
}

/// Every key of `keys()` is in the schema, and vice versa. Every number has both ends, each end is enforced to the last
/// bit, and the scene accepts what the schema allows.
#[test]
fn every_range_is_enforced_to_the_last_bit() {
    let leaves = leaves();
    let names = |keys: &mut dyn Iterator<Item = String>| keys.collect::<BTreeSet<_>>();
    assert_eq!(
        names(&mut leaves.iter().map(|leaf| leaf.key.clone())),
        names(&mut keys().into_iter().map(|doc| doc.key))
    );
    for leaf in &leaves {
        match leaf.kind() {
            "number" => {
                let [least, most] = leaf.floats();
                [least, most].iter().for_each(|end| taken(leaf, &format!("{end:e}")));
                let outside = [least.next_down(), most.next_up(), f64::MAX, f64::MIN, f64::NAN, f64::INFINITY];
                outside.iter().for_each(|value| refused(leaf, &format!("{value:?}")));
                ["1e999", "-1e999", "-inf", "true", "\"1\"", "[1.0]", "{}", "1979-05-27", "", "1,5"]
                    .iter()
                    .for_each(|value| refused(leaf, value));
            }
            "integer" => {
                let [least, most] = leaf.integers();
                [least, most].iter().for_each(|end| taken(leaf, &end.to_string()));
                let outside =
                    [i128::from(least) - 1, i128::from(most) + 1, u64::MAX.into(), i64::MIN.into(), i128::MAX];
                outside.iter().for_each(|value| refused(leaf, &value.to_string()));
                ["1e300", "1.0", "1.5", "nan", "0xfffffffffffffffffffffffffffffffff", "true", "1979-05-27", "four"]
                    .iter()
                    .for_each(|value| refused(leaf, value));
            }
            "boolean" => {
                ["true", "false"].iter().for_each(|value| taken(leaf, value));
                ["True", "1", "yes", "\"true\"", "[]"].iter().for_each(|value| refused(leaf, value));
            }
            "word" => {
                leaf.words().iter().for_each(|word| taken(leaf, word));
                ["nonsense", "\"\"", "1", "true", "[]", "{}"].iter().for_each(|value| refused(leaf, value));
            }
            "string" => {
                taken(leaf, "\"###\"");
                ["1", "true", "[]", "{}", "1979-05-27"].iter().for_each(|value| {
                    let error = with(&leaf.key, value).expect_err(value).to_string();
                    assert!(error.contains("expected a string"), "{error}");
                });
            }
            "array" => {
                taken(leaf, &leaf.list());
                ["1", "true", "\"\"", "{}", "1979-05-27"].iter().for_each(|value| {
                    let error = with(&leaf.key, value).expect_err(value).to_string();
                    assert!(error.contains("expected a list"), "{error}");
                });
            }
            kind => panic!("{}: this test, and perhaps the reader, knows no {kind}", leaf.key),
        }
    }
}

/// Any other word would be ignored without a message.
#[test]
fn the_schema_uses_only_words_that_are_enforced() {
    const KNOWN: &[&str] = &[
        "$schema",
        "$defs",
        "$ref",
        "title",
        "description",
        "default",
        "format",
        "x-goal",
        "x-unit",
        "x-example",
        "type",
        "properties",
        "additionalProperties",
        "required",
        "minProperties",
        "maxProperties",
        "minimum",
        "maximum",
        "const",
        "oneOf",
        "anyOf",
        "items",
        "minItems",
        "maxItems",
    ];
    fn walk(schema: &Value, is_names: bool) {
        let Some(object) = schema.as_object() else { return };
        for (name, inner) in object {
            assert!(is_names || KNOWN.contains(&name.as_str()), "{name}");
            match inner {
                _ if name == "default" && !is_names => {}
                Value::Array(parts) => parts.iter().for_each(|part| walk(part, false)),
                inner => walk(inner, !is_names && (name == "properties" || name == "$defs")),
            }
        }
        if object.get("type").and_then(Value::as_str) == Some("object") && !is_names {
            assert_eq!(object.get("additionalProperties"), Some(&false.into()), "open table: {schema}");
        }
    }
    walk(&scenario::schema(), false);
}

/// What programs read is what the types make.
#[test]
fn the_committed_schema_is_that_of_the_types() {
    let same = include_str!("../schema.json") == format!("{:#}\n", scenario::made_schema());
    assert!(same, "schema.json is not what the types make: cargo xtask reference");
}

/// Strict validators refuse words that JSON Schema does not define.
#[test]
fn the_published_schema_has_a_name_and_no_words_of_our_own() {
    fn walk(value: &Value) {
        match value {
            Value::Object(object) => {
                assert!(!object.keys().any(|name| name.starts_with("x-")), "{object:?}");
                assert!(!object.get("format").is_some_and(Value::is_string), "{object:?}");
                object.values().for_each(walk);
            }
            Value::Array(items) => items.iter().for_each(walk),
            _ => {}
        }
    }
    let published = scenario::published_schema();
    walk(&published);
    assert_eq!(published["$id"], scenario::SCHEMA_ID);
    let units = published.to_string().matches("Unit: ").count();
    assert_eq!(units, scenario::schema().to_string().matches("\"x-unit\"").count());
}

#[test]
fn the_world_is_one_object_with_a_property_a_scene() {
    let schema = scenario::schema();
    let world = &schema["$defs"]["World"];
    assert_eq!((&world["minProperties"], &world["maxProperties"]), (&1.into(), &1.into()));
    let names: Vec<_> = world["properties"].as_object().unwrap().keys().map(String::as_str).collect();
    assert_eq!(names, NAMES);
    assert!(world.get("oneOf").is_none() && world.get("required").is_none());
    assert_eq!(schema["$defs"]["Sampler"]["properties"]["seed"]["maximum"], i64::MAX);
}

#[test]
fn defaults_of_schema_template_and_code_agree() {
    for name in NAMES {
        let default = Scenario::default_of(name).unwrap();
        assert_eq!(Scenario::read("minimal", &format!("[world.{name}]"), &[]).unwrap(), default);
        assert_eq!(Scenario::read("template", &template(name).unwrap(), &[]).unwrap(), default);
        let values = serde_json::to_value(&default).unwrap();
        for leaf in leaves() {
            let pointer = format!("/{}", leaf.key.replace('.', "/"));
            if let Some(value) = values.pointer(&pointer) {
                assert_eq!(leaf.schema.get("default"), Some(value), "{}", leaf.key);
                assert!(leaf.allows(value), "{}", leaf.key);
            }
        }
    }
    assert!(Scenario::default_of("nonsense").is_none() && template("nonsense").is_none());
}

/// Every key is in the template, in its table, with its meaning, unit and range above it.
#[test]
fn templates_say_all_about_every_key() {
    for name in NAMES {
        let text = template(name).unwrap();
        // Tables of a list cannot be broken.
        let wide = |line: &str| line.chars().count() > if line.starts_with('#') { 101 } else { 200 };
        assert!(!text.lines().any(wide), "{text}");
        let flat = text.replace("\n#", "");
        for doc in keys().iter().filter(|doc| !doc.key.starts_with("world.") || doc.key.contains(&format!(".{name}.")))
        {
            let leaf = doc.key.rsplit('.').next().unwrap();
            let meaning = doc.description.lines().next().unwrap();
            assert!(flat.contains(meaning), "{}: {meaning}", doc.key);
            let line = format!("\n{leaf} = {}\n", doc.default);
            assert!(text.contains(&line) || text.contains(&format!("\n# {leaf} = ")), "{line}");
            if doc.kind == "a number" || doc.kind == "an integer" {
                assert!(flat.to_lowercase().contains(&format!("{} {}.", doc.kind, doc.range)), "{}", doc.key);
            }
            assert!(doc.unit.iter().all(|unit| text.contains(&format!("Unit: {unit}."))));
        }
        // Optional keys show a value that would be accepted.
        let optional =
            text.lines().filter(|line| line.starts_with("# ") && line.contains(" = ")).map(|line| &line[2..]);
        for line in optional {
            Scenario::read("template", &text, &[line.into()]).unwrap_or_else(|error| panic!("{line}: {error}"));
        }
    }
}

/// The paper samples by chains, which its file says; otherwise a trial decides.
#[test]
fn the_paper_s_scenario_is_the_default_one() {
    let read = Scenario::read("ball2d.toml", BALL2D, &[]).unwrap();
    let mut default = Scenario::default_of("ball2d").unwrap();
    assert_eq!((read.sampler.method, default.sampler.method), (Some(Method::Chain), None));
    default.sampler.method = read.sampler.method;
    assert_eq!(read, default);
}

#[test]
fn keys_are_explained_by_full_name_or_unique_end() {
    let doc = explain("world.ball2d.sigma_theta_deg").unwrap();
    assert_eq!(explain("sigma_theta_deg"), Ok(doc.clone()));
    assert_eq!((doc.kind.as_str(), doc.default.as_str(), doc.range.as_str()), ("a number", "10.0", "from 1e-9 to 90"));
    assert_eq!(doc.unit.as_deref(), Some("degree"));
    assert_eq!(explain("downward").unwrap().default, "\"back\"");
    assert!(
        explain("downward").unwrap().description.contains("\n\"level\": The ball bounces as if the table were level.")
    );
    assert_eq!(explain("symmetric_redraws").unwrap().default, "unset");
    assert_eq!(explain("ball2d.weights").unwrap().kind, "a table");
    assert_eq!(explain("weights.perturb").unwrap().key, "world.ball2d.weights.perturb");
    assert_eq!(explain("sigma_teta_deg"), Err(NoKey::Unknown(Some("world.ball2d.sigma_theta_deg".into()))));
    assert_eq!(explain("sampler.sede"), Err(NoKey::Unknown(Some("sampler.seed".into()))));
    assert_eq!(explain("brightness"), Err(NoKey::Unknown(None)));
    assert_eq!(explain(""), Err(NoKey::Unknown(None)));
    assert!(keys().iter().all(|doc| !doc.description.is_empty()));
}

#[test]
fn keys_in_lists_are_explained_and_ambiguous_ones_named() {
    let doc = explain("rest_at").unwrap();
    assert_eq!((doc.key.as_str(), doc.kind.as_str()), ("world.dice.constraints[].rest_at", "a table"));
    assert_eq!(explain("constraints[0].rest_at"), Ok(doc.clone()));
    assert_eq!(explain("world.dice.constraints[7].rest_at"), Ok(doc));
    assert_eq!(explain("rest_at.x_mm").unwrap().unit.as_deref(), Some("mm"));
    assert_eq!(explain("face_up.face").unwrap().key, "world.dice.constraints[].face_up.face");
    let Err(NoKey::Ambiguous(all)) = explain("ln_lambda") else { panic!("one key") };
    for key in ["world.bowling.ln_lambda", "world.spelling.ln_lambda"] {
        assert!(all.iter().any(|one| one == key), "{key} is not among {all:?}");
    }
    assert_eq!(explain("rest_att"), Err(NoKey::Unknown(Some("world.dice.constraints[].rest_at".into()))));
}
