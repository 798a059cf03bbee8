//! Output to standard error.

use std::io::{self, IsTerminal, Write};
use std::path::Path;

/// Writes to stderr. A failure is ignored: there is nowhere left to report it.
pub(crate) fn note(text: &str) {
    let _ = io::stderr().lock().write_all(text.as_bytes());
}

/// Writes a line to stderr.
pub(crate) fn note_line(text: &str) {
    note(&format!("{text}\n"));
}

/// Whether stderr is a terminal on which lines can be redrawn.
pub(crate) fn is_live() -> bool {
    io::stderr().is_terminal() && std::env::var_os("TERM").is_none_or(|term| term != "dumb")
}

/// Whether messages may be coloured: on a terminal, unless `NO_COLOR` says no.
pub(crate) fn is_coloured() -> bool {
    is_live() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// A path, quoted for a shell.
pub(crate) fn quoted(path: &Path) -> String {
    quoted_word(&path.display().to_string())
}

/// A word, quoted for a shell.
pub(crate) fn quoted_word(text: &str) -> String {
    let plain = !text.is_empty() && text.chars().all(|c| c.is_alphanumeric() || "/._-+=:@,%".contains(c));
    if plain { text.to_owned() } else { format!("'{}'", text.replace('\'', r"'\''")) }
}
