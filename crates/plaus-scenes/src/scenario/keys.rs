//! What each key means.

/// What a key means, for `plaus explain`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeyDoc {
    /// Dotted from the root, e.g. `world.ball2d.sigma_d`.
    pub key: String,
    /// Kind of value: "number", "integer", "boolean", "one of several words".
    pub kind: String,
    /// The default, as TOML; "unset" for a key that may be left out and then means something of its own.
    pub default: String,
    /// Allowed values, in words.
    pub range: String,
    /// Unit, where the value has one.
    pub unit: Option<String>,
    /// Meaning.
    pub description: String,
}

/// All keys of all scenes.
#[must_use]
pub fn keys() -> Vec<KeyDoc> {
    Vec::new()
}

/// What `key` means.
///
/// # Errors
/// The nearest known key, if any is near.
pub fn explain(key: &str) -> Result<KeyDoc, Option<String>> {
    let _ = key;
    Err(None)
}

/// A commented scenario file.
#[must_use]
pub fn template(scene: &str) -> Option<String> {
    super::Scenario::default_of(scene).map(|scenario| scenario.to_toml())
}

/// The JSON Schema.
#[must_use]
pub fn schema() -> serde_json::Value {
    schemars::schema_for!(super::Scenario).to_value()
}
