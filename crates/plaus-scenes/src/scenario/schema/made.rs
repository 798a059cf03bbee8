//! The schema as the types of a scenario make it.

use crate::scenario::Scenario;
use schemars::transform::{Transform, transform_subschemas};
use schemars::{Schema, schema_for};
use serde_json::{Map, Value, json};

/// What [`schema`](super::schema) should be; `cargo xtask reference` commits it.
#[must_use]
pub fn made_schema() -> Value {
    let mut schema = schema_for!(Scenario);
    ForEditors.transform(&mut schema);
    schema.to_value()
}

/// Changes every part of a schema as described at [`schema`](super::schema).
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
