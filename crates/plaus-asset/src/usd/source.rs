//! Where a stage reads its layers from: files that the caller opens, and what is in packages.

use super::{crate_file, crate_values, text};
use crate::MOST_BYTES;
use openusd::ar::{self, ResolvedPath};
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::io;
use std::rc::Rc;
use std::sync::mpsc::{Receiver, Sender};

/// Most files of one stage.
const MOST_FILES: usize = 1000;

/// Why files were not read, which the library would not tell in full: the first one, and others.
#[derive(Debug, Default)]
pub(super) struct Whys {
    pub(super) first: Option<String>,
    pub(super) others: Vec<String>,
}

/// The same, shared with the library.
pub(super) type Why = Rc<RefCell<Whys>>;

/// A file's bytes, or why it cannot be read.
type Bytes = Result<Rc<[u8]>, String>;

/// Reads files for a stage. Paths are those from the folder of its root layer.
pub(super) struct Source {
    /// The path of the root layer, which may be in a package.
    root: String,
    ask: Sender<String>,
    answer: Receiver<Result<Vec<u8>, String>>,
    known: RefCell<BTreeMap<String, Bytes>>,
    total: Cell<usize>,
    why: Why,
}

impl Source {
    pub(super) fn new(
        root: (String, Vec<u8>),
        ask: Sender<String>,
        answer: Receiver<Result<Vec<u8>, String>>,
        why: Why,
    ) -> Self {
        let total = Cell::new(root.1.len());
        let layer = super::root(&root.0, &root.1).unwrap_or_else(|_| root.0.clone());
        let source = Self { root: layer, ask, answer, known: RefCell::default(), total, why };
        let checked = source.checked(&root.0, root.1);
        source.known.borrow_mut().insert(root.0, checked);
        source
    }

    /// Bytes that the library may read.
    fn checked(&self, path: &str, bytes: Vec<u8>) -> Bytes {
        let ending = path.trim_end_matches(']').rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase());
        let checked = match ending.as_deref() {
            Some("usdz") => Ok(()),
            Some("usd" | "usda" | "usdc") if bytes.starts_with(crate_file::MAGIC) => crate_values::check(&bytes),
            Some("usdc") => Err("it does not begin with PXR-USDC".to_owned()),
            Some("usd" | "usda") => text::check(&bytes),
            _ => Err("its name must end in .usd, .usda, .usdc or .usdz".to_owned()),
        };
        match checked {
            Ok(()) => Ok(bytes.into()),
            Err(why) => {
                let mut whys = self.why.borrow_mut();
                match path == self.root {
                    true => _ = whys.first.get_or_insert_with(|| why.clone()),
                    false => whys.others.push(format!("{path}: {why}")),
                }
                Err(why)
            }
        }
    }

    /// A file, or what is at `package.usdz[inside]`.
    fn bytes(&self, path: &str) -> Bytes {
        if let Some(known) = self.known.borrow().get(path) {
            return known.clone();
        }
        if self.known.borrow().len() >= MOST_FILES {
            return Err(format!("a stage may have at most {MOST_FILES} files"));
        }
        let read = match ar::split_package_relative_path_outer(path) {
            Some((package, inside)) => {
                self.bytes(&package).and_then(|package| super::package::entry(&package, &inside))
            }
            None => self
                .ask
                .send(path.to_owned())
                .map_err(|error| error.to_string())
                .and_then(|()| self.answer.recv().map_err(|error| error.to_string())?),
        };
        let read = read.and_then(|bytes| {
            self.total.set(self.total.get().saturating_add(bytes.len()));
            if self.total.get() > MOST_BYTES {
                return Err(format!("all files of a stage together may have at most {MOST_BYTES} bytes"));
            }
            self.checked(path, bytes)
        });
        self.known.borrow_mut().insert(path.to_owned(), read.clone());
        read
    }
}

/// A path without `.` and, where it can be, without `..`.
fn plain(path: &str) -> String {
    let path = path.replace('\\', "/");
    let mut parts: Vec<&str> = Vec::new();
    for part in path.split('/') {
        match part {
            "." => {}
            "" if !parts.is_empty() => {}
            ".." if parts.last().is_some_and(|last| !matches!(*last, "" | "..")) => _ = parts.pop(),
            part => parts.push(part),
        }
    }
    parts.join("/")
}

impl ar::Resolver for Source {
    fn create_identifier(&self, path: &str, anchor: Option<&ResolvedPath>) -> String {
        if path.is_empty() {
            return String::new();
        }
        if let Some((package, inside)) = ar::split_package_relative_path_outer(path) {
            return ar::join_package_relative_path(&self.create_identifier(&package, anchor), &inside);
        }
        let is_absolute = path.starts_with('/') || path.as_bytes().get(1) == Some(&b':');
        let Some(anchor) = anchor.filter(|_| !is_absolute).map(ToString::to_string) else { return plain(path) };
        let beside = |file: &str| plain(&format!("{}{path}", file.rfind('/').map_or("", |end| &file[..=end])));
        if let Some((package, inside)) = ar::split_package_relative_path_inner(&anchor) {
            return ar::join_package_relative_path(&package, &beside(&inside));
        }
        if anchor.to_ascii_lowercase().ends_with(".usdz") {
            return ar::join_package_relative_path(&anchor, &plain(path));
        }
        beside(&anchor)
    }

    fn resolve(&self, path: &str) -> Option<ResolvedPath> {
        // Pictures, for example, are not looked for.
        let name = path.trim_end_matches(']');
        let is_layer = [".usd", ".usda", ".usdc", ".usdz"].iter().any(|end| name.to_ascii_lowercase().ends_with(end));
        (is_layer && self.bytes(path).is_ok()).then(|| ResolvedPath::new(path))
    }

    fn resolve_for_new_asset(&self, _: &str) -> Option<ResolvedPath> {
        None
    }

    fn open_asset(&self, path: &ResolvedPath) -> io::Result<Box<dyn ar::Asset>> {
        let bytes = self.bytes(&path.to_string()).map_err(io::Error::other)?;
        Ok(Box::new(io::Cursor::new(bytes.to_vec())))
    }
}
