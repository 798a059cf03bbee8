//! Elements of a model, with what it includes in their places.

use crate::AssetError;
use glam::DVec3;
use roxmltree::{Document, Node, ParsingOptions};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// Most elements, attributes and texts of one file.
const MOST_NODES: u32 = 1 << 20;
/// Most elements within each other.
const DEEPEST: usize = 200;

/// Reads a file that a model names, by its path from the model's folder. The error says why not, in words that follow
/// its name.
pub type Open<'a> = &'a mut dyn FnMut(&str) -> Result<Vec<u8>, String>;

/// Where something is: of the model itself, the file's name is empty.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Place {
    file: String,
    line: u32,
    column: u32,
}

impl Place {
    /// An error here.
    pub(super) fn wrong(&self, what: impl fmt::Display) -> AssetError {
        let Self { file, line, column } = self;
        let file = if file.is_empty() { String::new() } else { format!("{file}, ") };
        AssetError::Broken(format!("{file}line {line}, column {column}: {what}"))
    }

    /// The line, and ` of parts.xml` if it is in an included file.
    pub(super) fn line(&self) -> (u32, String) {
        (self.line, if self.file.is_empty() { String::new() } else { format!(" of {}", self.file) })
    }
}

/// Attributes by their names.
pub(super) type Attributes = BTreeMap<String, String>;

/// An element.
#[derive(Debug)]
pub(super) struct Element {
    pub(super) tag: String,
    pub(super) attributes: Attributes,
    pub(super) children: Vec<Element>,
    pub(super) place: Place,
}

impl Element {
    pub(super) fn get(&self, name: &str) -> Option<&str> {
        self.attributes.get(name).map(String::as_str)
    }

    /// The children of this tag.
    pub(super) fn all<'a>(&'a self, tag: &'a str) -> impl Iterator<Item = &'a Element> {
        self.children.iter().filter(move |child| child.tag == tag)
    }
}

/// The root of a model.
pub(super) fn root(bytes: &[u8], open: Open<'_>) -> Result<Element, AssetError> {
    let mut root = file("", bytes, &mut Files { open, seen: BTreeSet::new() })?;
    if root.len() == 1 {
        Ok(root.remove(0))
    } else {
        Err(AssetError::Broken("it is not valid XML: it has no root".into()))
    }
}

/// Files that may be included, each once.
struct Files<'a> {
    open: Open<'a>,
    seen: BTreeSet<String>,
}

/// The root element of a file.
fn file(name: &str, bytes: &[u8], files: &mut Files<'_>) -> Result<Vec<Element>, AssetError> {
    let place = |line, column| Place { file: name.to_owned(), line, column };
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let before = &bytes[..error.valid_up_to()];
        let line = before.iter().filter(|&&byte| byte == b'\n').count() as u32 + 1;
        place(line, 1).wrong("it is not valid XML: a byte that is not UTF-8")
    })?;
    let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| {
        let at = error.pos();
        // The error ends with where it is.
        let what = error.to_string();
        let what = what.rsplit_once(" at ").map_or(what.as_str(), |(what, _)| what);
        place(at.row, at.col).wrong(format!("it is not valid XML: {what}"))
    })?;
    elements(document.root_element(), name, 0, files)
}

/// An element; several in place of one that includes a file.
fn elements(node: Node<'_, '_>, name: &str, depth: usize, files: &mut Files<'_>) -> Result<Vec<Element>, AssetError> {
    let at = node.document().text_pos_at(node.range().start);
    let place = Place { file: name.to_owned(), line: at.row, column: at.col };
    if depth > DEEPEST {
        return Err(place.wrong(format!("more than {DEEPEST} elements within each other")));
    }
    let tag = node.tag_name().name();
    if tag == "include" {
        let Some(file_name) = node.attribute("file") else { return Err(place.wrong("<include> needs a `file`")) };
        if !files.seen.insert(file_name.to_owned()) {
            return Err(place.wrong(format!("{file_name} is included a second time")));
        }
        let bytes = (files.open)(file_name).map_err(|why| place.wrong(format!("{file_name}: {why}")))?;
        // The root of an included file stands for nothing.
        return Ok(file(file_name, &bytes, files)?.into_iter().flat_map(|root| root.children).collect());
    }
    let attributes = node.attributes().map(|one| (one.name().to_owned(), one.value().to_owned())).collect();
    let mut children = Vec::new();
    for child in node.children().filter(Node::is_element) {
        children.extend(elements(child, name, depth + 1, files)?);
    }
    Ok(vec![Element { tag: tag.to_owned(), attributes, children, place }])
}

/// What an element says, its class included.
#[derive(Debug)]
pub(super) struct Words<'a> {
    pub(super) of: &'a Element,
    pub(super) said: Attributes,
}

impl Words<'_> {
    pub(super) fn get(&self, name: &str) -> Option<&str> {
        self.said.get(name).map(String::as_str)
    }

    /// An error about an attribute.
    pub(super) fn wrong(&self, name: &str, what: impl fmt::Display) -> AssetError {
        self.of.place.wrong(format!("{name} of <{}>: {what}", self.of.tag))
    }

    /// Finite numbers, as many as in `count`.
    pub(super) fn numbers(
        &self,
        name: &str,
        count: std::ops::RangeInclusive<usize>,
    ) -> Result<Option<Vec<f64>>, AssetError> {
        let Some(text) = self.get(name) else { return Ok(None) };
        let numbers: Option<Vec<f64>> =
            text.split_whitespace().map(|word| word.parse().ok().filter(|number: &f64| number.is_finite())).collect();
        let Some(numbers) = numbers else { return Err(self.wrong(name, format!("{text:?} are not finite numbers"))) };
        if !count.contains(&numbers.len()) {
            let (least, most) = count.into_inner();
            let wanted = if least == most { least.to_string() } else { format!("{least} to {most}") };
            return Err(self.wrong(name, format!("{wanted} numbers are needed, not {}", numbers.len())));
        }
        Ok(Some(numbers))
    }

    pub(super) fn number(&self, name: &str) -> Result<Option<f64>, AssetError> {
        Ok(self.numbers(name, 1..=1)?.map(|numbers| numbers[0]))
    }

    /// A number that is not negative.
    pub(super) fn amount(&self, name: &str) -> Result<Option<f64>, AssetError> {
        match self.number(name)? {
            Some(number) if number < 0.0 => Err(self.wrong(name, format!("{number} is negative"))),
            other => Ok(other),
        }
    }

    pub(super) fn vector(&self, name: &str) -> Result<Option<DVec3>, AssetError> {
        Ok(self.numbers(name, 3..=3)?.map(|numbers| DVec3::from_slice(&numbers)))
    }

    /// One of these words.
    pub(super) fn one_of<'b>(&self, name: &str, words: &[&'b str]) -> Result<Option<&'b str>, AssetError> {
        let Some(said) = self.get(name) else { return Ok(None) };
        match words.iter().find(|word| **word == said) {
            Some(word) => Ok(Some(word)),
            None => Err(self.wrong(name, format!("{said:?} is unknown: known are {}", words.join(", ")))),
        }
    }
}
