//! Checks a tree against the shape of scenarios, and finds all errors at once.

use super::bounds::Bounds;
use super::nearest::{any_of, nearest, nearest_leaf, shown};
use super::problem::{Problem, SHOWN, Source, line_of};
use super::shape::{Kind, Shape, again, scenario};
use super::tree::{Data, Tree, join, leaf};
use super::{value, varying};
use crate::require::{DEEPEST, Formula};
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// The values of `tree` in the form that serde should read, without those in error; and the errors.
pub(super) fn check(shape: &Shape, tree: &Tree) -> (Option<Value>, Vec<Problem>) {
    let mut check = Check { paths: shape.paths(Some(tree)), problems: Vec::new(), formulas: Vec::new(), depth: 0 };
    let value = check.value(shape, tree, "").map(|value| varying::wrapped(value, check.formulas));
    (value, check.problems)
}

/// Most syntax errors reported for one file: later ones usually follow from the first.
const MAX_SYNTAX_PROBLEMS: usize = 10;

/// The syntax errors of the file `text`, of which `tree` could be read.
pub(super) fn syntax_problems(text: &str, tree: &Tree, errors: &[toml::de::Error]) -> Vec<Problem> {
    errors.iter().take(MAX_SYNTAX_PROBLEMS).map(|error| syntax_problem(text, tree, error)).collect()
}

/// A syntax error; a duplicate key is named where its name is known.
fn syntax_problem(text: &str, tree: &Tree, error: &toml::de::Error) -> Problem {
    let span = error.span().unwrap_or(text.len()..text.len());
    let (mut key, mut help) = (String::new(), None);
    if lacks_value(text, span.start) {
        return Problem::new(key, "a value is missing after `=`").at(&Source::File, Some(span));
    }
    if error.message() == "duplicate key" {
        let name = text.get(span.clone()).unwrap_or_default().trim_matches(['"', '\'']);
        help = list_before(text, tree, span.start);
        let paths = scenario().paths(None);
        let mut known = paths.iter().filter(|path| leaf(path) == name);
        key = known.next().filter(|_| known.next().is_none()).cloned().unwrap_or_else(|| shown(name));
    }
    Problem::new(key, error.message()).with_help(help).at(&Source::File, Some(span))
}

/// Whether nothing follows the `=` before this byte in its line.
fn lacks_value(text: &str, at: usize) -> bool {
    let Some((before, after)) = text.split_at_checked(at) else { return false };
    let rest = after.lines().next().unwrap_or_default().trim_start();
    before.trim_end_matches([' ', '\t']).ends_with('=') && (rest.is_empty() || rest.starts_with('#'))
}

/// Advice where a table `[[path]]`, with its header at byte `header`, follows a list `path = […]`, which cannot grow.
fn list_before(text: &str, tree: &Tree, header: usize) -> Option<String> {
    let start = text.get(..header)?.rfind('\n').map_or(0, |end| end + 1);
    let (path, _) = text.get(start..)?.trim_start().strip_prefix("[[")?.split_once("]]")?;
    let (found, list) = tree.nearest(path.trim());
    if found != path.trim() || !matches!(list.data, Data::List(_)) {
        return None;
    }
    let line = line_of(text, list.place.key.as_ref()?.start);
    Some(format!("line {line} gives `{found}` as a list: delete that line, or write every entry between its brackets"))
}

struct Check {
    /// All keys that exist, given the scene that the tree chose.
    paths: Vec<String>,
    problems: Vec<Problem>,
    /// Formulas in place of numbers of requirements, each with its key.
    formulas: Vec<(String, Formula)>,
    /// How many recursive shapes are open.
    depth: usize,
}

impl Check {
    /// The value of `tree`, or `None` if it is wrong as a whole.
    fn value(&mut self, shape: &Shape, tree: &Tree, key: &str) -> Option<Value> {
        match (&shape.kind, &tree.data) {
            (Kind::Table(keys), Data::Table(entries)) => Some(self.table(keys, entries, tree, key)),
            (Kind::OneOf(keys), Data::Table(entries)) => self.one_of(keys, entries, tree, key),
            (Kind::List(item, length), Data::List(items)) => self.list(item, length, items, tree, key),
            (Kind::List(..), Data::Table(_)) => {
                let name = leaf(key);
                let help = format!("write [[{key}]] with two brackets, once for each entry, or `{name} = [ … ]`");
                let problem = Problem::new(key, "expected a list, found a table").with_help(Some(help));
                self.problems.push(tree.place.blame(problem));
                None
            }
            (Kind::Again(reference), _) => self.again(reference, tree, key),
            (Kind::Any(_), data) if shape.alternative(data).is_some() => {
                self.value(shape.alternative(data)?, tree, key)
            }
            (Kind::Number(bounds), Data::Text(text)) if varying::is_formula(text, key) => {
                let ends = [bounds.least.unwrap_or(f64::MIN), bounds.most.unwrap_or(f64::MAX)];
                self.formulas.push((key.to_owned(), Formula { at: String::new(), text: text.clone(), ends }));
                Some(Value::String(text.clone()))
            }
            (_, data) => match value::read(shape, data) {
                Ok(value) => Some(value),
                Err(wrong) => {
                    let problem = Problem::new(key, wrong.message).with_help(wrong.help);
                    self.problems.push(tree.place.blame_value(problem));
                    None
                }
            },
        }
    }

    /// A recursive shape, to a depth that people can still understand.
    fn again(&mut self, reference: &str, tree: &Tree, key: &str) -> Option<Value> {
        if self.depth + 1 >= DEEPEST {
            let message = format!("nested too deeply: at most {DEEPEST} levels");
            self.problems.push(tree.place.blame_value(Problem::new(key, message)));
            return None;
        }
        self.depth += 1;
        let value = self.value(again(reference)?, tree, key);
        self.depth -= 1;
        value
    }

    fn table(&mut self, keys: &[(String, Shape)], entries: &BTreeMap<String, Tree>, tree: &Tree, path: &str) -> Value {
        let (mut table, mut lacks) = (Map::new(), Vec::new());
        for (name, shape) in keys {
            let key = join(path, name);
            match entries.get(name) {
                Some(inner) => table.extend(self.value(shape, inner, &key).map(|value| (name.clone(), value))),
                None if shape.default.is_none() => lacks.push((name.as_str(), missing(shape, &key))),
                None => {}
            }
        }
        for (name, inner) in entries {
            if !keys.iter().any(|(known, _)| known == name) {
                let problem = Problem::new(join(path, &shown(name)), format!("unknown key `{}`", shown(name)));
                // Comparing a name with all others takes time, and nobody reads that much advice.
                let advice = if self.problems.len() < SHOWN { self.advice(keys, name, path) } else { None };
                // A missing key that was only misspelt is not missing.
                let near = nearest(name, lacks.iter().map(|(lacking, _)| *lacking)).map(str::to_owned);
                lacks.retain(|(lacking, _)| Some(*lacking) != near.as_deref());
                self.problems.push(inner.place.blame_key(problem.with_help(advice)));
            }
        }
        self.problems.extend(lacks.into_iter().map(|(_, problem)| tree.place.blame(problem)));
        Value::Object(table)
    }

    /// Where the unknown `name` belongs, which name was probably meant, or which names are known here.
    fn advice(&self, keys: &[(String, Shape)], name: &str, path: &str) -> Option<String> {
        let known = || keys.iter().map(|(known, _)| known.as_str());
        // An element of a list has keys of its own: those elsewhere are of no help.
        let in_list = path.contains('[');
        let elsewhere: Vec<_> = self.paths.iter().filter(|known| !in_list && leaf(known) == name).collect();
        if elsewhere.iter().any(|known| *known == name) {
            return Some(format!("`{name}` belongs to no table: write it above the first line in brackets"));
        }
        if !elsewhere.is_empty() {
            return Some(format!("write it as {}", any_of(elsewhere.iter().map(|known| format!("`{known}`")))));
        }
        if let Some(near) = nearest(name, known()) {
            return Some(match other_unit(name, near) {
                Some(unit) => format!("did you mean `{near}`? Its unit is {unit}"),
                None => format!("did you mean `{near}`?"),
            });
        }
        if let Some(near) = if in_list { None } else { nearest_leaf(name, &self.paths) } {
            return Some(format!("did you mean `{near}`?"));
        }
        let known = known().collect::<Vec<_>>().join(", ");
        Some(if path.is_empty() { format!("known: {known}") } else { format!("known in [{path}]: {known}") })
    }

    /// A table that must hold exactly one of `keys`: which scene.
    fn one_of(
        &mut self,
        keys: &[(String, Shape)],
        entries: &BTreeMap<String, Tree>,
        tree: &Tree,
        path: &str,
    ) -> Option<Value> {
        let names = || keys.iter().map(|(name, _)| name.as_str());
        for (name, inner) in entries.iter().filter(|(name, _)| !names().any(|known| known == *name)) {
            let in_list = path.ends_with(']');
            let what = if in_list { "key" } else { path };
            let message = format!("unknown {what} `{}`", shown(name));
            let near = nearest(name, names());
            if let Some(near) = near.filter(|_| in_list) {
                let problem = Problem::new(path, message).with_help(Some(format!("did you mean `{near}`?")));
                self.problems.push(inner.place.blame_key(problem));
                continue;
            }
            let near = near.map(|near| format!("did you mean `{path}.{near}`? "));
            let belongs = self.paths.iter().find(|known| leaf(known) == name && near.is_none());
            let belongs = belongs.map(|known| format!("did you mean `{known}`? "));
            let help = format!("{}known: {}", near.or(belongs).unwrap_or_default(), any_of(names().map(String::from)));
            let problem = Problem::new(join(path, &shown(name)), message).with_help(Some(help));
            self.problems.push(inner.place.blame_key(problem));
        }
        let chosen: Vec<_> = keys.iter().filter_map(|(name, shape)| Some((name, shape, entries.get(name)?))).collect();
        match *chosen {
            [(name, shape, inner)] => {
                let value = self.value(shape, inner, &join(path, name))?;
                Some(Value::Object(Map::from_iter([(name.clone(), value)])))
            }
            [] if !entries.is_empty() => None,
            [] => {
                let problem = Problem::new(path, NONE_CHOSEN).with_help(Some(add_one(keys, path)));
                self.problems.push(tree.place.blame_key(problem));
                None
            }
            [(first, ..), (second, ..), ..] if path.ends_with(']') => {
                let message = format!("`{first}` and `{second}` in one table: each needs a table of its own");
                let help = format!("write {{ {first} = … }}, {{ {second} = … }}");
                self.problems.push(tree.place.blame_value(Problem::new(path, message).with_help(Some(help))));
                None
            }
            [(first, ..), ..] => {
                for (name, _, inner) in &chosen[1..] {
                    let message = format!("a second {path}, in addition to `{first}`: exactly one must be chosen");
                    let help = format!("remove [{path}.{first}] or [{path}.{name}]");
                    let problem = Problem::new(join(path, name), message).with_help(Some(help));
                    self.problems.push(inner.place.blame_key(problem));
                }
                None
            }
        }
    }

    fn list(&mut self, item: &Shape, length: &Bounds<i128>, items: &[Tree], tree: &Tree, key: &str) -> Option<Value> {
        if !length.contains(items.len() as i128) {
            let message = match length.only() {
                Some(number) => format!("a list of {}: exactly {number} are needed", items.len()),
                None => format!("a list of {} is out of range: its length must be {}", items.len(), length.words()),
            };
            self.problems.push(tree.place.blame_value(Problem::new(key, message)));
        }
        let numbered = items.iter().enumerate();
        let values: Vec<_> = numbered.map(|(i, inner)| self.value(item, inner, &format!("{key}[{i}]"))).collect();
        values.into_iter().collect::<Option<Vec<_>>>().map(Value::Array)
    }
}

/// What is wrong if none of several keys is given.
const NONE_CHOSEN: &str = "missing: exactly one must be chosen";

/// The error for a required key that is missing.
fn missing(shape: &Shape, key: &str) -> Problem {
    match &shape.kind {
        Kind::OneOf(keys) => Problem::new(key, NONE_CHOSEN).with_help(Some(add_one(keys, key))),
        // Of several alternatives, the first is the plain one.
        Kind::Any(all) if !all.is_empty() => {
            Problem::new(key, format!("missing: {} must be given", all[0].kind_in_words()))
        }
        _ => Problem::new(key, format!("missing: {} must be given", shape.kind_in_words())),
    }
}

/// How to choose one of several tables. Within an item of a list, a heading would not do.
fn add_one(keys: &[(String, Shape)], path: &str) -> String {
    let key = path.rsplit('.').next().unwrap_or(path);
    match keys.split_first() {
        Some(((first, _), others)) if path.contains('[') && !others.is_empty() => {
            let others = any_of(others.iter().map(|(name, _)| format!("`{name}`")));
            format!("add `{key} = {{ {first} = {{ … }} }}`, with `{first}` or {others}")
        }
        _ => format!("add a table {}", any_of(keys.iter().map(|(name, _)| format!("[{path}.{name}]")))),
    }
}

/// The unit that the key `known` ends with, if `name` is the same key in another unit.
fn other_unit<'a>(name: &str, known: &'a str) -> Option<&'a str> {
    let ((said, own), (begin, unit)) = (name.rsplit_once('_')?, known.rsplit_once('_')?);
    (said == begin && own != unit).then_some(unit)
}
