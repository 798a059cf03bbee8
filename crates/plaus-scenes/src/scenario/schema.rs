//! The JSON Schema of scenario files: the one source of their types, ranges, defaults and meanings.

use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::sync::OnceLock;

#[cfg(feature = "schema")]
mod made;
#[cfg(feature = "schema")]
pub use made::made_schema;

/// What [`made_schema`] makes.
#[cfg(not(target_family = "wasm"))]
const SCHEMA: &str = include_str!("../../schema.json");

/// The JSON Schema of scenario files, draft 2020-12, for editors and for [`Scenario::read`](super::Scenario::read)
/// alike.
///
/// An enum of scenes would by itself make a `oneOf` of objects, about which an editor can only say "matches none". Here
/// it is one object with an optional property for each scene and `minProperties = maxProperties = 1`. Units are in
/// `x-unit`; `x-goal` marks what a scene itself asks for, which a page may change. Whole numbers have the bounds of
/// their type, and never exceed 9,223,372,036,854,775,807, the largest that every TOML reader supports.
#[must_use]
pub fn schema() -> Value {
    given().clone()
}

static GIVEN: OnceLock<Value> = OnceLock::new();

/// Has scenarios checked against this: on WebAssembly, where the page that holds the module has the schema too. Must be
/// called before any scenario is read.
pub fn give_schema(schema: Value) {
    let _ = GIVEN.set(schema); // the first one stays
}

/// What scenarios are checked against.
pub(super) fn given() -> &'static Value {
    #[cfg(target_family = "wasm")]
    let schema = Value::default;
    #[cfg(not(target_family = "wasm"))]
    let schema = || serde_json::from_str(SCHEMA).unwrap_or_default();
    GIVEN.get_or_init(schema)
}

/// Name of the schema for this version's scenario files, and of the file to which `plaus new` writes it.
pub const SCHEMA_ID: &str = concat!("urn:plaus:scenario:", env!("CARGO_PKG_VERSION"));
/// See [`SCHEMA_ID`].
pub const SCHEMA_FILE: &str = "plaus.schema.json";

/// [`schema`] in the form for editors and validators: with its name, and without anything that JSON Schema does not
/// define, which strict validators refuse. Units are given in words. Numbers of requirements may be formulas.
#[must_use]
pub fn published_schema() -> Value {
    let mut schema = schema();
    plain(&mut schema);
    let (mut open, mut known) = (vec!["/properties/require".to_owned()], BTreeSet::new());
    while let Some(place) = open.pop() {
        if let Some(part) = schema.pointer_mut(&place).filter(|_| known.insert(place.clone())) {
            take_formulas(part, &mut open);
        }
    }
    if let Some(root) = schema.as_object_mut() {
        root.insert("$id".into(), SCHEMA_ID.into());
    }
    schema
}

/// Lets numbers of requirements be formulas too. Adds the parts of the schema that this one refers to.
fn take_formulas(part: &mut Value, refers: &mut Vec<String>) {
    match part {
        Value::Object(object) => {
            if let Some(Value::String(place)) = object.get("$ref") {
                refers.push(place.trim_start_matches('#').to_owned());
            }
            match object.get_mut("type") {
                Some(kind) if *kind == "number" => *kind = json!(["number", "string"]),
                Some(Value::Array(kinds)) if kinds.iter().any(|kind| kind == "number") => kinds.push("string".into()),
                _ => {}
            }
            object.values_mut().for_each(|inner| take_formulas(inner, refers));
        }
        Value::Array(items) => items.iter_mut().for_each(|inner| take_formulas(inner, refers)),
        _ => {}
    }
}

/// Leaves out formats and keywords that only this program knows.
fn plain(value: &mut Value) {
    match value {
        Value::Object(object) => {
            object.remove("x-goal");
            // The `format` of a schema, not a property that happens to have that name.
            if object.get("format").is_some_and(Value::is_string) {
                object.remove("format");
            }
            if let Some(unit) = object.remove("x-unit") {
                let meaning = object.get("description").and_then(Value::as_str).unwrap_or_default();
                let words = format!("{meaning} Unit: {}.", unit.as_str().unwrap_or_default());
                object.insert("description".into(), words.trim_start().into());
            }
            if let Some(example) = object.remove("x-example") {
                object.insert("examples".into(), vec![example].into());
            }
            object.values_mut().for_each(plain);
        }
        Value::Array(items) => items.iter_mut().for_each(plain),
        _ => {}
    }
}
