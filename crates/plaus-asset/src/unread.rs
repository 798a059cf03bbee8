//! What of a model is not read, in words.

use crate::xml::{Attributes, Element, Place};
use std::collections::{BTreeMap, BTreeSet};

/// Most lines that are named for one thing.
const MOST_LINES: usize = 12;

/// All attributes and all that is inside.
pub(super) const EVERY: &[&str] = &["*"];

/// What a format's reader reads.
#[derive(Debug, Clone, Copy)]
pub(super) struct Known {
    /// The root's tag. Of what is directly in it and not read, the parts are listed.
    pub(super) root: &'static str,
    /// Of each element.
    pub(super) read: &'static [(&'static str, &'static [&'static str])],
    /// Whether an attribute has a value that needs no reading.
    pub(super) is_usual: fn(&str, &Attributes) -> bool,
    /// Whether something that is not read has no bearing on motion.
    pub(super) is_harmless: fn(&str) -> bool,
}

/// Kinds of things, each with where they are.
type Found = BTreeMap<String, BTreeSet<Place>>;

/// One sentence for each kind of element, or attribute, that is not read, with its lines; first those that may change
/// motion, then those that have no bearing on it.
pub(super) fn unread(root: &Element, known: &Known) -> [Vec<String>; 2] {
    let mut found = Found::new();
    walk(root, "", known, &mut found);
    let said = |(what, places): (String, BTreeSet<Place>)| {
        let lines: BTreeSet<_> = places.iter().map(Place::line).collect();
        let some: Vec<String> = lines.iter().take(MOST_LINES).map(|(line, file)| format!("{line}{file}")).collect();
        let more = if lines.len() > MOST_LINES { ", …" } else { "" };
        let word = if lines.len() == 1 { "line" } else { "lines" };
        format!("{what} ({word} {}{more})", some.join(", "))
    };
    let (harmless, others): (Vec<_>, Vec<_>) = found.into_iter().partition(|(what, _)| (known.is_harmless)(what));
    [others, harmless].map(|list| list.into_iter().map(said).collect())
}

fn walk(of: &Element, above: &str, known: &Known, found: &mut Found) {
    let mut add = |what: String, place: &Place| {
        found.entry(what).or_default().insert(place.clone());
    };
    match known.read.iter().find(|(tag, _)| *tag == of.tag) {
        Some((_, EVERY)) => return,
        Some((_, read)) => {
            for name in of.attributes.keys() {
                if !read.contains(&name.as_str()) && !(known.is_usual)(name, &of.attributes) {
                    add(format!("{name} of <{}>", of.tag), &of.place);
                }
            }
        }
        None if above == known.root => {
            return of.children.iter().for_each(|part| add(format!("<{}> in <{}>", part.tag, of.tag), &part.place));
        }
        None => return add(format!("<{}>", of.tag), &of.place),
    }
    of.children.iter().for_each(|child| walk(child, &of.tag, known, found));
}
