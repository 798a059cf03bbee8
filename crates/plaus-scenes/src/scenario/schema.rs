//! The JSON Schema of scenario files: the one source of their types, ranges, defaults and meanings.

use schemars::transform::{Transform, transform_subschemas};
use schemars::{Schema, schema_for};
use serde_json::{Map, Value, json};
use std::sync::OnceLock;

/// The JSON Schema of scenario files, draft 2020-12, for editors and for [`Scenario::read`](super::Scenario::read)
/// alike.
///
/// An enum of scenes would by itself make a `oneOf` of objects, about which an editor can only say "matches none". Here
/// it is one object with an optional property for each scene and `minProperties = maxProperties = 1`. Units are in
/// `x-unit`; `x-goal` marks what a scene itself asks for, which a page may change. Whole numbers have the bounds of
/// their type, and never exceed 9,223,372,036,854,775,807, the largest that every TOML reader supports.
#[must_use]
pub fn schema() -> Value {
    let mut schema = schema_for!(super::Scenario);
    ForEditors.transform(&mut schema);
    schema.to_value()
}

static GIVEN: OnceLock<Value> = OnceLock::new();

/// Has scenarios checked against this, which [`schema`] made: for programs that have no room for the code which makes
/// it. Must be called before any scenario is read; on WebAssembly, without it none can be.
pub fn give_schema(schema: Value) {
    let _ = GIVEN.set(schema); // the first one stays
}

/// What scenarios are checked against.
pub(super) fn given() -> &'static Value {
    #[cfg(target_family = "wasm")]
    let schema = Value::default;
    GIVEN.get_or_init(schema)
}

/// Name of the schema for this version's scenario files, and of the file to which `plaus new` writes it.
pub const SCHEMA_ID: &str = concat!("urn:plaus:scenario:", env!("CARGO_PKG_VERSION"));
/// See [`SCHEMA_ID`].
pub const SCHEMA_FILE: &str = "plaus.schema.json";

/// [`schema`] in the form for editors and validators: with its name, and without anything that JSON Schema does not
/// define, which strict validators refuse. Units are given in words.
#[must_use]
pub fn published_schema() -> Value {
    let mut schema = schema();
    plain(&mut schema);
    if let Some(root) = schema.as_object_mut() {
        root.insert("$id".into(), SCHEMA_ID.into());
    }
    schema
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

/// Changes every part of a schema as described at [`schema`].
struct ForEditors;

impl Transform for ForEditors {
    fn transform(&mut self, schema: &mut Schema) {
        transform_subschemas(self, schema);
        if let Some(object) = schema.as_object_mut() {
            merge_variants(object);
            bound_by_type(object);
        }
    }
}

/// Turns `oneOf` objects with one property each into one object with optional properties.
fn merge_variants(schema: &mut Map<String, Value>) {
    let Some(variants) = schema.get("oneOf").and_then(Value::as_array) else { return };
    let Some(properties) = variants.iter().map(only_property).collect::<Option<Map<_, _>>>() else { return };
    schema.remove("oneOf");
    schema.insert("type".into(), "object".into());
    schema.insert("properties".into(), properties.into());
    schema.insert("additionalProperties".into(), false.into());
    schema.insert("minProperties".into(), 1.into());
    schema.insert("maxProperties".into(), 1.into());
}

/// The property of an externally tagged variant, described by the variant.
fn only_property(variant: &Value) -> Option<(String, Value)> {
    let properties = variant.get("properties")?.as_object()?;
    let (name, schema) = properties.iter().next().filter(|_| properties.len() == 1)?;
    let mut schema = schema.as_object()?.clone();
    if let Some(description) = variant.get("description") {
        schema.insert("description".into(), description.clone());
    }
    Some((name.clone(), schema.into()))
}

/// Adds the bounds that follow from an integer's Rust type, of those that keys have, and from TOML.
fn bound_by_type(schema: &mut Map<String, Value>) {
    let (least, most) = match schema.get("format").and_then(Value::as_str) {
        Some("uint8") => (json!(0), json!(u8::MAX)),
        Some("uint32") => (json!(0), json!(u32::MAX)),
        Some("uint64") => (json!(0), json!(i64::MAX)),
        Some("int32") => (json!(i32::MIN), json!(i32::MAX)),
        _ => return,
    };
    schema.entry("minimum").or_insert(least);
    schema.entry("maximum").or_insert(most);
}
