//! The meaning of each key: for `plaus explain`, and for the comments of a new file.

use super::Scenario;
use super::overrides::{NoKey, key_of};
use super::shape::{Kind, Shape, scenario};
use super::tree::leaf;
use std::fmt::Write;

/// Columns of a template's comments.
const WIDTH: usize = 100;

/// Most choices whose meanings a template lists. If there are more, it says where they are explained.
const MOST_MEANINGS: usize = 12;

/// What a key means.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeyDoc {
    /// Dotted from the root, e.g. `world.ball2d.sigma_d`.
    pub key: String,
    /// The kind of value, with its article: "a number", "an integer", "a boolean", "a word", "a table".
    pub kind: String,
    /// The default, as TOML; "unset" for a key that may be left out and then has a special meaning; empty for tables.
    pub default: String,
    /// Allowed values, in words, e.g. "from 0 to 90"; empty if all values of the kind are allowed.
    pub range: String,
    /// Unit, if the value has one.
    pub unit: Option<String>,
    /// Meaning. If the value is a word, the meaning of each word follows.
    pub description: String,
}

/// All keys of all scenes that hold a value, in the order of a file; tables are not listed.
#[must_use]
pub fn keys() -> Vec<KeyDoc> {
    let all = scenario().paths(None).into_iter().filter_map(|key| Some((scenario().at(&key)?, key)));
    all.filter(|(shape, _)| !shape.is_table()).map(|(shape, key)| doc(shape, key)).collect()
}

/// The meaning of a key, or of a table. `key` is its full dotted name, or a unique ending of it: `sigma_d`,
/// `weights.aim`, `rest_at`. Any index into a list stands for all: `constraints[0].rest_at` is `constraints[].rest_at`.
///
/// # Errors
///
/// [`NoKey`]: the nearest known key, if one is near; or all keys with this ending.
pub fn explain(key: &str) -> Result<KeyDoc, NoKey> {
    let (found, _) = key_of(key.trim(), scenario(), None)?;
    scenario().at(&found).map(|shape| doc(shape, found)).ok_or(NoKey::Unknown(None))
}

/// Other keys that end as `found` does if `key` is only its ending: those of requirements are left out.
#[must_use]
pub fn namesakes(key: &str, found: &str) -> Vec<String> {
    let ending = format!(".{}", key.trim());
    let all = scenario().paths(None).into_iter().chain(scenario().paths_in_lists(None));
    all.filter(|other| other != found && found != key && other.ends_with(&ending) && !other.starts_with("require[]"))
        .collect()
}

/// The kinds of requirements that have a key of this name, each as `require[].kind`, in alphabetical order.
#[must_use]
pub fn kinds_with(key: &str) -> Vec<String> {
    let ending = format!(".{}", key.trim());
    let is_kind = |kind: &str| kind.strip_prefix("require[].").is_some_and(|name| !name.contains(['.', '[']));
    let all = scenario().paths_in_lists(None).into_iter();
    let mut kinds: Vec<String> = all.filter_map(|path| Some(path.strip_suffix(&ending)?.to_owned())).collect();
    kinds.retain(|kind| is_kind(kind));
    kinds.sort_unstable();
    kinds
}

fn doc(shape: &Shape, key: String) -> KeyDoc {
    let mut description = shape.description.clone();
    // Tables in lists are not among the keys of `keys`.
    let inside = if shape.is_table() && key.contains("[]") { keys_of(shape) } else { Vec::new() };
    for meaning in meanings(shape).into_iter().chain(inside) {
        description += &format!("\n{meaning}");
    }
    KeyDoc {
        kind: shape.kind_in_words(),
        default: if shape.is_table() { String::new() } else { default(shape).unwrap_or_else(|| "unset".into()) },
        range: shape.range(),
        unit: shape.unit.clone(),
        description,
        key,
    }
}

/// The keys of a table: what each holds, whether it may be left out, and its meaning. One line each.
fn keys_of(shape: &Shape) -> Vec<String> {
    let key = |(name, shape): &(String, Shape)| {
        let range = Some(shape.range_with_unit()).filter(|range| !range.is_empty());
        let given = match default(shape) {
            Some(default) if default != "\"\"" => format!("default {default}"),
            Some(_) => "may be left out".to_owned(),
            None if shape.default.is_some() => "may be left out".to_owned(),
            None => "must be given".to_owned(),
        };
        let facts: Vec<String> = [shape.kind_in_words()].into_iter().chain(range).chain([given]).collect();
        format!("{name} ({}): {}", facts.join(", "), shape.description)
    };
    shape.keys().iter().map(key).collect()
}

/// The meanings of words that have one; for a list of tables, what each table may hold. One line each.
fn meanings(shape: &Shape) -> Vec<String> {
    match &shape.kind {
        Kind::Words(words) => {
            let with_meaning = words.iter().filter(|(_, meaning)| !meaning.is_empty());
            with_meaning.map(|(word, meaning)| format!("\"{word}\": {meaning}")).collect()
        }
        Kind::List(item, _) if matches!(item.kind, Kind::Any(_)) => meanings(item),
        // The meaning of each alternative.
        Kind::Any(all) => all.iter().flat_map(choices).collect(),
        Kind::List(item, _) => {
            let key = |(name, shape): &(String, Shape)| match default(shape) {
                Some(default) => {
                    let range = Some(shape.range_with_unit()).filter(|range| !range.is_empty());
                    let facts: Vec<String> = range.into_iter().chain([format!("default {default}")]).collect();
                    format!("{name} ({})", facts.join(", "))
                }
                None => name.clone(),
            };
            let keys = |shape: &Shape| shape.keys().iter().map(key).collect::<Vec<_>>().join(", ");
            let choice = |(name, shape): &(String, Shape)| match keys(shape) {
                keys if keys.is_empty() => format!("{name}: {}", shape.description),
                keys => format!("{name}: {} Keys: {keys}.", shape.description),
            };
            item.keys().iter().map(choice).collect()
        }
        _ => Vec::new(),
    }
}

/// What each key of a choice means.
fn choices(shape: &Shape) -> Vec<String> {
    shape.keys().iter().map(|(name, shape)| format!("{name}: {}", shape.description)).collect()
}

/// The default as TOML, if there is one.
fn default(shape: &Shape) -> Option<String> {
    let default = shape.default.as_ref().filter(|value| !value.is_null())?;
    let number = default.as_f64().filter(|_| matches!(shape.kind, Kind::Number(_))).map(toml::Value::Float);
    let given = number.or_else(|| toml::Value::try_from(without_defaults(shape, default)).ok());
    Some(match given? {
        // One line for each table.
        toml::Value::Array(items) if items.iter().any(toml::Value::is_table) => {
            let lines: Vec<String> = items.iter().map(|item| format!("    {item},\n")).collect();
            format!("[\n{}]", lines.concat())
        }
        value => value.to_string(),
    })
}

/// A list of tables of known keys, without the keys that have their default values.
fn without_defaults(shape: &Shape, value: &serde_json::Value) -> serde_json::Value {
    let item = shape.item().filter(|item| matches!(item.kind, Kind::Table(_)));
    let (Some(item), Some(items)) = (item, value.as_array()) else { return value.clone() };
    let said = |entry: &serde_json::Value| {
        let keys = entry.as_object().into_iter().flatten();
        let said = keys.filter(|(name, value)| item.get(name).and_then(|key| key.default.as_ref()) != Some(*value));
        said.map(|(name, value)| (name.clone(), value.clone())).collect::<serde_json::Map<_, _>>().into()
    };
    items.iter().map(said).collect::<Vec<serde_json::Value>>().into()
}

/// A commented scenario file: every key with its default, meaning, unit and range. Reading it gives the scene's default
/// scenario.
#[must_use]
pub fn template(scene: &str) -> Option<String> {
    let given = Scenario::default_of(scene)?;
    let (tree, _) = super::tree::Tree::parse(&given.to_toml());
    let mut text = format!("# A scenario of `{scene}`. Every key has its default value here, and may be left out.\n");
    for key in scenario().paths(Some(&tree)) {
        let Some(shape) = scenario().at(&key) else { continue };
        if shape.is_table() {
            header(&mut text, shape, &key);
        } else {
            entry(&mut text, shape, leaf(&key));
        }
    }
    Some(text)
}

/// What a new file of a user's world says beyond its defaults: a line of the template, a comment, and the lines in its
/// place.
const STARTER: [[&str; 3]; 5] = [
    [
        "# A scenario of `custom`. Every key has its default value here, and may be left out.",
        "# A world of your own: a ball is thrown, and must come to rest one metre away. Change `require`, \
         `materials` and\n# `bodies`; every other key has its default value here, and may be left out.",
        "",
    ],
    [
        "require = []",
        "# What must happen: the ball comes to rest near this place.",
        "require = [\n    { rests_at = { body = \"ball\", x_mm = 1000, y_mm = 0, within_mm = 100 } },\n]",
    ],
    [
        "materials = []",
        "# `rolling`: without it, a ball on a level floor rolls on for ever.",
        "materials = [\n    { name = \"rubber\", restitution = 0.7, rolling = 0.03 },\n]",
    ],
    [
        "    { at_mm = [0.0, 0.0, 500.0], name = \"ball\", shape",
        "",
        "    { at_mm = [0.0, 0.0, { uniform = [200.0, 800.0] }], name = \"ball\", \
      material = \"rubber\", shape",
    ],
    ["{ normal = [0.0, 0.5] }, 0.0] },", "", "{ normal = [0.0, 0.5] }, { normal = [1.0, 1.0] }] },"],
];

/// A file to begin with: [`template`], for a user's world with something that must happen.
#[must_use]
pub fn starter(scene: &str) -> Option<String> {
    let text = template(scene)?;
    if scene != "custom" {
        return Some(text);
    }
    Some(STARTER.iter().fold(text, |text, [line, comment, instead]| {
        let both = [*comment, *instead].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("\n");
        text.replacen(line, &both, 1)
    }))
}

/// A table's meaning, and its heading unless it only holds a choice of tables.
fn header(text: &mut String, shape: &Shape, key: &str) {
    text.push('\n');
    comment(text, &shape.description);
    if matches!(shape.kind, Kind::Table(_)) {
        let _ = writeln!(text, "[{key}]");
    }
}

fn entry(text: &mut String, shape: &Shape, name: &str) {
    text.push('\n');
    comment(text, &shape.description);
    if let Some(facts) = facts(shape) {
        comment(text, &facts);
    }
    let meanings = meanings(shape);
    if meanings.len() > MOST_MEANINGS {
        let item = shape.item();
        let names = item.map(Shape::keys).unwrap_or_default().iter().map(|(name, _)| name.as_str());
        let word = if item.is_some_and(|item| matches!(item.kind, Kind::Table(_))) { "Each has" } else { "One of" };
        comment(text, &format!("{word} {}: `plaus explain {name}`.", names.collect::<Vec<_>>().join(", ")));
    } else {
        meanings.iter().for_each(|meaning| comment(text, meaning));
    }
    let _ = match default(shape) {
        Some(default) => writeln!(text, "{name} = {default}"),
        None => writeln!(text, "# {name} = {}", example(shape)),
    };
}

/// "A number from 0 to 90. Unit: degree."
fn facts(shape: &Shape) -> Option<String> {
    let kind = match &shape.kind {
        Kind::Number(_) => "A number",
        Kind::Integer(_) => "An integer",
        _ => return shape.unit.as_ref().map(|unit| format!("Unit: {unit}.")),
    };
    let range = shape.range();
    let space = if range.is_empty() { "" } else { " " };
    let unit = shape.unit.as_ref().map(|unit| format!(" Unit: {unit}.")).unwrap_or_default();
    Some(format!("{kind}{space}{range}.{unit}"))
}

/// A value that an unset key could have.
fn example(shape: &Shape) -> String {
    if let Some(example) = &shape.example {
        return example.to_string();
    }
    match &shape.kind {
        Kind::Boolean => "true".into(),
        Kind::Words(words) => words.first().map(|(word, _)| format!("\"{word}\"")).unwrap_or_default(),
        // Of the two ends, the one nearer 0 is always a sensible value.
        Kind::Number(bounds) => {
            let nearest = [bounds.least, bounds.most].into_iter().flatten().min_by(|a, b| a.abs().total_cmp(&b.abs()));
            toml::Value::Float(nearest.unwrap_or(1.0)).to_string()
        }
        _ => "…".into(),
    }
}

/// `words` as comment lines, broken between words.
fn comment(text: &mut String, words: &str) {
    for paragraph in words.lines() {
        let mut line = String::from("#");
        for word in paragraph.split_whitespace() {
            if line.chars().count() + word.chars().count() >= WIDTH {
                let _ = writeln!(text, "{line}");
                line = String::from("#");
            }
            line = line + " " + word;
        }
        let _ = writeln!(text, "{line}");
    }
}
