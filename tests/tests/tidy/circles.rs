//! No files import each other in a circle, so that each can be read after the files that it builds on.

use super::{files, shown};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A module, as its path within the crate.
type Module = Vec<String>;

/// The module that a file of the folder `source` holds.
pub(super) fn module_of(source: &Path, file: &Path) -> Module {
    let relative = file.strip_prefix(source).unwrap().with_extension("");
    let mut names: Module = relative.iter().map(|name| name.to_string_lossy().into_owned()).collect();
    if names.last().is_some_and(|last| ["lib", "main", "mod"].contains(&last.as_str())) {
        names.pop();
    }
    names
}

/// The paths that a tree of imports names: `a::{b, c::d}` names `a::b` and `a::c::d`.
fn paths_of(tree: &str) -> Vec<Module> {
    let mut found = Vec::new();
    let mut open: Vec<Module> = vec![Vec::new()];
    let mut path: Module = Vec::new();
    let mut word = String::new();
    for c in tree.chars().chain([',']) {
        match c {
            '{' => open.push([open.last().unwrap().as_slice(), &std::mem::take(&mut path)].concat()),
            ':' if !word.is_empty() => path.push(std::mem::take(&mut word)),
            ',' | '}' => {
                let name = std::mem::take(&mut word);
                if !name.is_empty() {
                    path.push(name.split(" as ").next().unwrap_or_default().to_owned());
                }
                if !path.is_empty() {
                    found.push([open.last().unwrap().as_slice(), &std::mem::take(&mut path)].concat());
                }
                if c == '}' {
                    open.pop();
                }
            }
            ':' => {}
            ' ' if word.is_empty() => {}
            c => word.push(c),
        }
    }
    found
}

/// The code of a text: without comments, strings and what follows the first tests.
fn code_of(text: &str) -> String {
    let text = text.split("#[cfg(test)]").next().unwrap_or_default();
    let mut code = String::new();
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        match c {
            '/' if rest.peek() == Some(&'/') => while rest.next_if(|&c| c != '\n').is_some() {},
            '"' => {
                while let Some(c) = rest.next().filter(|&c| c != '"') {
                    if c == '\\' {
                        rest.next();
                    }
                }
            }
            // A quoted character that would begin a string. Lifetimes have no second quote.
            '\'' if rest.peek() == Some(&'"') => {
                rest.next();
            }
            '\'' if rest.peek() == Some(&'\\') => {
                rest.nth(1);
            }
            '\n' => code.push(' '),
            c => code.push(c),
        }
    }
    code
}

/// The paths that code names in `use` lines.
fn paths_used(code: &str) -> Vec<Module> {
    let mut found = Vec::new();
    for statement in code.split(';') {
        let Some(at) = statement.rfind("use ").filter(|&at| at == 0 || statement[..at].ends_with([' ', '}'])) else {
            continue;
        };
        let tree = &statement[at + "use ".len()..];
        if tree.chars().all(|c| c.is_alphanumeric() || "_:{}, *".contains(c)) {
            found.extend(paths_of(tree));
        }
    }
    found
}

/// The paths in the midst of code that begin with `crate`, `self` or `super`.
fn paths_inline(code: &str) -> Vec<Module> {
    let is_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let mut found = Vec::new();
    // Who may see an item is no import: `pub(in crate::a)`.
    for word in code.replace("(in crate::", "(in ").split(|c| !is_path(c)) {
        if ["crate::", "self::", "super::"].iter().any(|start| word.starts_with(start)) {
            found.push(word.split("::").filter(|name| !name.is_empty()).map(str::to_owned).collect());
        }
    }
    found
}

/// The modules of the same crate that the text of `module` imports from, in `use` lines and by paths in its code.
pub(super) fn imports(module: &[String], text: &str, modules: &BTreeSet<Module>) -> BTreeSet<Module> {
    let code = code_of(text);
    let mut found = BTreeSet::new();
    for path in [paths_used(&code), paths_inline(&code)].concat() {
        let mut names = path.iter().map(String::as_str).peekable();
        let mut base: Module = match names.peek() {
            Some(&"crate") => Vec::new(),
            Some(&("self" | "super")) => module.to_vec(),
            Some(first) if modules.contains(&[module, &[(*first).to_owned()]].concat()) => module.to_vec(),
            _ => continue,
        };
        while let Some(name) = names.next_if(|name| ["crate", "self", "super"].contains(name)) {
            if name == "super" {
                base.pop();
            }
        }
        base.extend(names.map(str::to_owned));
        while !modules.contains(&base) {
            base.pop();
        }
        // A module may re-export what its own parts define.
        if !base.starts_with(module) {
            found.insert(base);
        }
    }
    found
}

/// What can be reached from `start`.
fn reached(start: &Module, imports: &BTreeMap<Module, BTreeSet<Module>>) -> BTreeSet<Module> {
    let (mut seen, mut open) = (BTreeSet::new(), vec![start.clone()]);
    while let Some(module) = open.pop() {
        for next in imports.get(&module).into_iter().flatten() {
            if seen.insert(next.clone()) {
                open.push(next.clone());
            }
        }
    }
    seen
}

/// The modules below a folder that are part of a circle, each with the modules that share its circle.
fn circles(sources: &[(Module, String)]) -> Vec<String> {
    let modules: BTreeSet<Module> = sources.iter().map(|(module, _)| module.clone()).collect();
    let graph = sources.iter().map(|(module, text)| (module.clone(), imports(module, text, &modules)));
    let graph: BTreeMap<Module, BTreeSet<Module>> = graph.collect();
    let reach: BTreeMap<&Module, BTreeSet<Module>> =
        graph.keys().map(|module| (module, reached(module, &graph))).collect();
    let in_circle = modules.iter().filter(|module| reach[module].contains(*module));
    in_circle
        .map(|module| {
            let others = reach[module].iter().filter(|other| *other != module && reach[other].contains(module));
            let others: Vec<String> = others.map(|other| other.join("::")).collect();
            format!("{} with {}", module.join("::"), others.join(", "))
        })
        .collect()
}

#[test]
fn no_files_import_each_other() {
    let mut found = Vec::new();
    for library in files(&super::root().join("crates"), "src/lib.rs") {
        let source = library.parent().unwrap();
        let read = |file: &std::path::PathBuf| (module_of(source, file), std::fs::read_to_string(file).unwrap());
        let sources: Vec<(Module, String)> = files(source, ".rs").iter().map(read).collect();
        found.extend(circles(&sources).into_iter().map(|circle| format!("{}: {circle}", shown(source))));
    }
    assert!(found.is_empty(), "files that import each other:\n{}", found.join("\n"));
}

#[test]
fn circles_are_seen() {
    let module = |name: &str| name.split("::").filter(|name| !name.is_empty()).map(str::to_owned).collect::<Module>();
    let source = |name: &str, text: &str| (module(name), text.to_owned());
    let line = [
        source("", "mod a;\nmod b;\npub use a::A;"),
        source(
            "a",
            "//! Words; use crate::b::B;\nuse super::b::{self, B as Other};\n#[cfg(test)]\nmod tests { use super::*; }",
        ),
        source("b", "use std::fmt;\nuse crate::c::{d::{D}, E};"),
        source("c", "pub mod d;\npub use d::D;"),
        source("c::d", "use glam::DVec3;"),
    ];
    assert_eq!(circles(&line), [] as [&str; 0]);
    let mut circle = line.clone();
    circle[4].1 = "pub(crate) use crate::a::{\n    A,\n};".to_owned();
    assert_eq!(circles(&circle).len(), 3, "{:?}", circles(&circle));
    let mut inline = line.clone();
    inline[4].1 = "fn f() -> &'static str {\n    crate::a::A::text('\"', \"// no comment\")\n}".to_owned();
    assert_eq!(circles(&inline).len(), 3, "{:?}", circles(&inline));
    let mut apart = line;
    apart[4].1 = "pub(in crate::a) fn f() -> &'static str {\n    \"crate::a::A\" // crate::a::A\n}".to_owned();
    assert_eq!(circles(&apart), [] as [&str; 0]);
}
