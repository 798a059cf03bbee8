//! Every key of the scenario schema, read from its JSON by other code than the library's, so that the two check each
//! other.

#![allow(dead_code, reason = "each test uses its own part")]

use plaus_scenes::{Assets, scenario};
use serde_json::{Map, Value};

/// The scenario of the paper's figures 1 and 2.
pub(crate) const BALL2D: &str = include_str!("../../../../scenarios/ball2d.toml");

/// Two slopes that meet in a ridge 120 high along y, each 200 wide: open below.
pub(crate) const ROOF: &str = "o roof\nv -200 -200 0\nv 0 -200 120\nv 200 -200 0\nv -200 200 0\nv 0 200 120\n\
                               v 200 200 0\nf 1 2 5 4\nf 2 3 6 5\n";

/// A prism along y whose ends are triangles, 60 wide, 40 long, 35 high.
pub(crate) const WEDGE: &str = "o wedge\nv -30 -20 -10\nv 30 -20 -10\nv 0 -20 25\nv -30 20 -10\nv 30 20 -10\n\
                                v 0 20 25\nf 1 2 3\nf 4 6 5\nf 1 4 5 2\nf 2 5 6 3\nf 1 3 6 4\n";

/// Files of shapes that scenarios may name.
pub(crate) fn shapes() -> Assets {
    let mut shapes = Assets::default();
    shapes.insert("roof.obj", ROOF.as_bytes());
    shapes.insert("wedge.obj", WEDGE.as_bytes());
    shapes
}

/// Marks a key that takes one of a list of words, or may be left out.
const MAY_BE_UNSET: &str = "may be unset";

/// A key that holds a value.
#[derive(Debug, Clone)]
pub(crate) struct Leaf {
    pub(crate) key: String,
    pub(crate) schema: Map<String, Value>,
}

/// All keys that hold a value.
pub(crate) fn leaves() -> Vec<Leaf> {
    let root = scenario::schema();
    let mut leaves = Vec::new();
    collect(&root, &root, "", &mut leaves);
    leaves
}

fn collect(root: &Value, part: &Value, key: &str, leaves: &mut Vec<Leaf>) {
    let mut schema = part.as_object().unwrap().clone();
    if let Some(Value::String(path)) = schema.remove("$ref") {
        let mut target = root.pointer(&path[1..]).unwrap().as_object().unwrap().clone();
        target.extend(schema);
        return collect(root, &target.into(), key, leaves);
    }
    // One of a list of words, or unset.
    if let Some(Value::Array(either)) = schema.get("anyOf")
        && let [one, unset] = either.as_slice()
        && unset["type"] == "null"
    {
        let mut target = one.as_object().unwrap().clone();
        schema.remove("anyOf");
        target.extend(schema);
        target.insert(MAY_BE_UNSET.into(), true.into());
        return collect(root, &target.into(), key, leaves);
    }
    match schema.get("properties").and_then(Value::as_object) {
        Some(properties) => properties.iter().for_each(|(name, inner)| {
            let key = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
            collect(root, inner, &key, leaves);
        }),
        None => leaves.push(Leaf { key: key.into(), schema }),
    }
}

impl Leaf {
    pub(crate) fn kind(&self) -> &str {
        match &self.schema.get("type") {
            Some(Value::String(kind)) => kind,
            Some(Value::Array(kinds)) => {
                kinds.iter().find_map(|kind| kind.as_str().filter(|kind| *kind != "null")).unwrap()
            }
            _ => "word",
        }
    }

    pub(crate) fn words(&self) -> Vec<String> {
        let variants = self.schema["oneOf"].as_array().unwrap();
        variants.iter().map(|variant| variant["const"].as_str().unwrap().to_owned()).collect()
    }

    /// Smallest and largest allowed float.
    pub(crate) fn floats(&self) -> [f64; 2] {
        ["minimum", "maximum"].map(|name| self.schema[name].as_f64().unwrap_or_else(|| panic!("{}: {name}", self.key)))
    }

    /// Smallest and largest allowed integer.
    pub(crate) fn integers(&self) -> [i64; 2] {
        ["minimum", "maximum"].map(|name| self.schema[name].as_i64().unwrap_or_else(|| panic!("{}: {name}", self.key)))
    }

    /// A list that is allowed: the empty one, or the default if that is too short.
    pub(crate) fn list(&self) -> String {
        if self.schema.contains_key("minItems") { self.schema["default"].to_string() } else { "[]".into() }
    }

    /// Whether a scenario's value, as JSON, is allowed.
    pub(crate) fn allows(&self, value: &Value) -> bool {
        if value.is_null() {
            // Only keys that may be left out have no value.
            let is_null = |kinds: &Value| kinds.as_array().is_some_and(|kinds| kinds.iter().any(|kind| kind == "null"));
            return self.schema.contains_key(MAY_BE_UNSET) || self.schema.get("type").is_some_and(is_null);
        }
        match self.kind() {
            "number" => {
                let [least, most] = self.floats();
                value.as_f64().is_some_and(|value| (least..=most).contains(&value))
            }
            "integer" => {
                let [least, most] = self.integers();
                value.as_i64().is_some_and(|value| (least..=most).contains(&value))
            }
            "boolean" => value.is_boolean(),
            "string" => value.is_string(),
            "array" => value.is_array(),
            "word" => self.words().iter().any(|word| value == word),
            kind => panic!("{}: no test for {kind}", self.key),
        }
    }
}
