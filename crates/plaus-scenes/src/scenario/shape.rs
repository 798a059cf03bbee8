//! The schema in the form that the rest of this folder uses: typed, with references resolved, and with keys in the
//! order of their definition.

use super::bounds::Bounds;
use super::nearest;
use super::schema::given;
use super::tree::{Data, Tree};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::sync::OnceLock;

/// What is allowed at a place of a scenario.
#[derive(Debug, Clone)]
pub(super) struct Shape {
    /// Meaning.
    pub(super) description: String,
    /// Unit, if the value has one.
    pub(super) unit: Option<String>,
    /// A value to show if there is no default.
    pub(super) example: Option<Value>,
    /// `None`: must be given. `Null`: may be left out, and then has a special meaning.
    pub(super) default: Option<Value>,
    pub(super) kind: Kind,
}

/// The kinds of values.
#[derive(Debug, Clone)]
pub(super) enum Kind {
    /// Any of these keys, and no other.
    Table(Vec<(String, Shape)>),
    /// Exactly one of these keys, and no other.
    OneOf(Vec<(String, Shape)>),
    /// One of these words, each with its meaning.
    Words(Vec<(String, String)>),
    Integer(Bounds<i128>),
    Number(Bounds<f64>),
    Boolean,
    Text,
    /// A list of values of one shape, with bounds on its length.
    List(Box<Shape>, Bounds<i128>),
    /// Any of these, distinguished by the kind of value.
    Any(Vec<Shape>),
    /// A shape that contains itself: the one around it that the reference names.
    Again(String),
}

/// The shape of a whole scenario.
pub(super) fn scenario() -> &'static Shape {
    static SHAPE: OnceLock<Shape> = OnceLock::new();
    SHAPE.get_or_init(|| Shape::of_schema(given(), given(), &[]))
}

/// The recursive shape that a reference names.
pub(super) fn again(reference: &str) -> Option<&'static Shape> {
    static SHAPES: OnceLock<BTreeMap<String, Shape>> = OnceLock::new();
    let shapes = SHAPES.get_or_init(|| {
        let schema = given();
        let names = schema.get("$defs").and_then(Value::as_object).into_iter().flat_map(|defs| defs.keys());
        let shape = |name: &String| {
            let reference = format!("#/$defs/{name}");
            let shape = Shape::of_schema(&json!({ "$ref": reference }), schema, &[]);
            (reference, shape)
        };
        names.map(shape).collect()
    });
    shapes.get(reference)
}

impl Shape {
    /// The shape that a part of the schema `root` describes, inside the shapes that the references `open` name.
    pub(super) fn of_schema(part: &Value, root: &Value, open: &[&str]) -> Self {
        let empty = Map::new();
        let part = part.as_object().unwrap_or(&empty);
        let plain = |kind| Self { description: String::new(), unit: None, example: None, default: None, kind };
        let reference = part.get("$ref").and_then(Value::as_str);
        let target = reference.and_then(|path| root.pointer(path.strip_prefix('#')?));
        let mut shape = match (reference.zip(target), nullable(part)) {
            (Some((path, _)), _) if open.contains(&path) => plain(Kind::Again(path.to_owned())),
            (Some((path, target)), _) => Self::of_schema(target, root, &[open, &[path]].concat()),
            (None, Some(inner)) => Self::of_schema(inner, root, open),
            (None, None) => plain(Kind::of_schema(part, root, open)),
        };
        if let Some(description) = part.get("description").and_then(Value::as_str) {
            shape.description = paragraphs(description);
        }
        if let Some(unit) = part.get("x-unit").and_then(Value::as_str) {
            shape.unit = Some(unit.into());
        }
        if let Some(example) = part.get("x-example") {
            shape.example = Some(example.clone());
        }
        if let Some(default) = part.get("default") {
            shape.default = Some(default.clone());
        }
        shape
    }

    /// The keys of a table, or of a choice of tables.
    pub(super) fn keys(&self) -> &[(String, Self)] {
        match &self.kind {
            Kind::Table(keys) | Kind::OneOf(keys) => keys,
            _ => &[],
        }
    }

    /// Whether it can contain keys.
    pub(super) fn is_table(&self) -> bool {
        matches!(self.kind, Kind::Table(_) | Kind::OneOf(_))
    }

    /// The shape of one of its keys.
    pub(super) fn get(&self, key: &str) -> Option<&Self> {
        self.keys().iter().find(|(name, _)| name == key).map(|(_, shape)| shape)
    }

    /// Of several alternatives, the one for this kind of value.
    pub(super) fn alternative(&self, data: &Data) -> Option<&Self> {
        let Kind::Any(all) = &self.kind else { return None };
        all.iter().find(|one| match data {
            Data::Table(_) => one.is_table(),
            Data::List(_) => matches!(one.kind, Kind::List(..)),
            Data::Integer(..) | Data::Float(_) => matches!(one.kind, Kind::Number(_) | Kind::Integer(_)),
            Data::Text(_) => matches!(one.kind, Kind::Text | Kind::Words(_)),
            Data::Boolean(_) => matches!(one.kind, Kind::Boolean),
            Data::Datetime(_) => false,
        })
    }

    /// The shape of a list's entries.
    pub(super) fn item(&self) -> Option<&Self> {
        match &self.kind {
            Kind::List(item, _) => Some(item),
            _ => None,
        }
    }

    /// The shape at a dotted key; `name[]` means the entries of the list `name`.
    pub(super) fn at(&self, key: &str) -> Option<&Self> {
        key.split('.').try_fold(self, |shape, name| match name.strip_suffix("[]") {
            Some(list) => shape.get(list)?.item(),
            None => shape.get(name),
        })
    }

    /// All dotted keys in lists: `constraints[]`, `constraints[].rest_at`, …. If `tree` has made a choice, only the
    /// chosen ones.
    pub(super) fn paths_in_lists(&self, tree: Option<&Tree>) -> Vec<String> {
        let lists = self.paths(tree).into_iter().filter_map(|key| Some((self.at(&key)?.item()?, key)));
        lists.flat_map(|(item, key)| item.paths_of_item(&key)).collect()
    }

    /// The same for the entries of the list `key`, and for lists of numbers in them.
    fn paths_of_item(&self, key: &str) -> Vec<String> {
        let mut paths = vec![format!("{key}[]")];
        for inner in self.paths(None) {
            let path = format!("{key}[].{inner}");
            if self.at(&inner).and_then(Self::item).is_some_and(|item| !item.is_table()) {
                paths.extend([path.clone(), format!("{path}[]")]);
            } else {
                paths.push(path);
            }
        }
        paths
    }

    /// All dotted keys in order, tables before their contents. If `tree` has made a choice, only the chosen ones.
    pub(super) fn paths(&self, tree: Option<&Tree>) -> Vec<String> {
        let chosen = match (&self.kind, tree.map(|tree| &tree.data)) {
            (Kind::OneOf(keys), Some(Data::Table(given))) => {
                let mut known = keys.iter().filter(|(name, _)| given.contains_key(name));
                known.next().filter(|_| known.next().is_none()).map(|(name, _)| name)
            }
            _ => None,
        };
        let mut paths = Vec::new();
        for (name, shape) in self.keys().iter().filter(|(name, _)| chosen.is_none_or(|chosen| chosen == name)) {
            paths.push(name.clone());
            let inner = tree.and_then(|tree| tree.get(name));
            paths.extend(shape.paths(inner).into_iter().map(|path| format!("{name}.{path}")));
        }
        paths
    }

    /// The allowed values in words, without the unit: "from 0 to 90", "\"mixed\" or \"paper\""; empty if
    /// everything is allowed.
    pub(super) fn range(&self) -> String {
        match &self.kind {
            Kind::Integer(bounds) => bounds.words(),
            Kind::Number(bounds) => bounds.words(),
            Kind::Words(words) => nearest::any_of(words.iter().map(|(word, _)| format!("\"{word}\""))),
            Kind::Boolean => "true or false".into(),
            Kind::List(item, _) => item.range(),
            Kind::Any(all) => all.iter().map(Self::range).find(|range| !range.is_empty()).unwrap_or_default(),
            Kind::Table(_) | Kind::OneOf(_) | Kind::Text | Kind::Again(_) => String::new(),
        }
    }

    /// The allowed values with their unit: "from 0 to 90°".
    pub(super) fn range_with_unit(&self) -> String {
        let range = self.range();
        match self.unit.as_deref() {
            Some("degree") if !range.is_empty() => range + "°",
            Some(unit) if !range.is_empty() => range + " " + unit,
            _ => range,
        }
    }

    /// The kind of value, with its article.
    pub(super) fn kind_in_words(&self) -> String {
        match &self.kind {
            Kind::Table(_) => "a table".into(),
            Kind::OneOf(keys) => {
                format!("a table that holds {}", nearest::any_of(keys.iter().map(|(name, _)| name.clone())))
            }
            Kind::Words(_) => "a word".into(),
            Kind::Integer(_) => "an integer".into(),
            Kind::Number(_) => "a number".into(),
            Kind::Boolean => "a boolean".into(),
            Kind::Text => "a string".into(),
            Kind::List(item, _) => format!("a list, each {}", item.kind_in_words()),
            Kind::Any(all) => nearest::any_of(all.iter().map(Self::kind_in_words)),
            Kind::Again(reference) => again(reference).map_or("a value".into(), Self::kind_in_words),
        }
    }
}

impl Kind {
    fn of_schema(part: &Map<String, Value>, root: &Value, open: &[&str]) -> Self {
        let types = match part.get("type") {
            Some(Value::Array(types)) => types.iter().filter_map(Value::as_str).collect(),
            kind => kind.and_then(Value::as_str).into_iter().collect::<Vec<_>>(),
        };
        let named = types.into_iter().find(|kind| *kind != "null");
        match named {
            Some("object") => {
                let keys = part.get("properties").and_then(Value::as_object).into_iter().flatten();
                let keys = keys.map(|(name, inner)| (name.clone(), Shape::of_schema(inner, root, open)));
                // As TOML requires: plain values before tables.
                let (tables, values): (Vec<_>, Vec<_>) = keys.partition(|(_, shape)| shape.is_table());
                let keys = [values, tables].concat();
                if part.contains_key("minProperties") { Self::OneOf(keys) } else { Self::Table(keys) }
            }
            Some("integer") => Self::Integer(Bounds::of_schema(part, ["minimum", "maximum"])),
            Some("number") => Self::Number(Bounds::of_schema(part, ["minimum", "maximum"])),
            Some("boolean") => Self::Boolean,
            Some("array") => {
                let item = part.get("items").map(|item| Shape::of_schema(item, root, open));
                let length = Bounds::of_schema(part, ["minItems", "maxItems"]);
                Self::List(Box::new(item.unwrap_or_else(|| unknown(part))), length)
            }
            None if part.contains_key("anyOf") => Self::any(part, root, open),
            named => match words(part) {
                Some(words) => Self::Words(words),
                None if named == Some("string") => Self::Text,
                None => unknown(part),
            },
        }
    }

    /// The alternatives of an `anyOf`, without null.
    fn any(part: &Map<String, Value>, root: &Value, open: &[&str]) -> Self {
        let all = part.get("anyOf").and_then(Value::as_array).into_iter().flatten();
        let all = all.filter(|one| one.get("type").and_then(Value::as_str) != Some("null"));
        let unit = part.get("x-unit").and_then(Value::as_str);
        let one = |one: &Value| {
            let shape = Shape::of_schema(one, root, open);
            let takes_unit = matches!(shape.kind, Self::Number(_) | Self::Integer(_));
            Shape { unit: shape.unit.clone().or(unit.filter(|_| takes_unit).map(String::from)), ..shape }
        };
        Self::Any(all.map(one).collect())
    }
}

/// Not reached: a key of a type whose schema has other words would make every scenario fail.
fn unknown(part: &Map<String, Value>) -> ! {
    unreachable!("no key of a scenario has a schema like {part:?}")
}

/// The word of a `const`, or those of a `oneOf`, each with its meaning.
fn words(part: &Map<String, Value>) -> Option<Vec<(String, String)>> {
    if let Some(word) = part.get("const") {
        let meaning = part.get("description").and_then(Value::as_str).map(paragraphs).unwrap_or_default();
        return Some(vec![(word.as_str()?.to_owned(), meaning)]);
    }
    let variants = part.get("oneOf")?.as_array()?;
    let lists: Option<Vec<_>> = variants.iter().map(|variant| words(variant.as_object()?)).collect();
    lists.map(|lists| lists.concat())
}

/// The other alternative of an `anyOf` with null: an optional value.
fn nullable(part: &Map<String, Value>) -> Option<&Value> {
    let (mut null, mut rest): (Vec<_>, Vec<_>) =
        part.get("anyOf")?.as_array()?.iter().partition(|one| one.get("type").and_then(Value::as_str) == Some("null"));
    null.pop()?;
    rest.pop().filter(|_| rest.is_empty())
}

/// Joins the lines of each paragraph.
fn paragraphs(text: &str) -> String {
    text.split("\n\n")
        .map(|paragraph| paragraph.split_whitespace().collect::<Vec<_>>().join(" "))
        .collect::<Vec<_>>()
        .join("\n\n")
}
