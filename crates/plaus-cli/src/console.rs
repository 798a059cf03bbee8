//! Output to standard error.

use std::io::{self, IsTerminal, Write};
use std::path::Path;

/// Writes to stderr. A failure is ignored: there is nowhere left to report it.
pub(crate) fn note(text: &str) {
    let _ = io::stderr().lock().write_all(text.as_bytes());
}

/// Characters of a quoted text, or of a word without spaces, that messages show at most; longer words than `WORD` are
/// no names that anyone can read.
const QUOTED: usize = 80;
const WORD: usize = 400;

/// A message in which quoted text, between double quotes, and overlong words are cut short.
pub(crate) fn shortened(message: &str) -> String {
    let cut = |text: &str, most: usize| match text.chars().count() > most {
        true => text.chars().take(QUOTED - 1).chain(['…']).collect(),
        false => text.to_owned(),
    };
    let parts = message.split('"').enumerate();
    let parts = parts.map(|(nth, part)| match nth % 2 {
        1 => cut(part, QUOTED),
        _ => part.split(' ').map(|word| cut(word, WORD)).collect::<Vec<_>>().join(" "),
    });
    parts.collect::<Vec<_>>().join("\"")
}

/// Writes a line to stderr.
pub(crate) fn note_line(text: &str) {
    note(&format!("{text}\n"));
}

/// Writes a line to stderr that says what may matter, and is no error.
pub(crate) fn remark(text: &str) {
    note_line(&format!("note: {text}"));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_are_cut_and_others_left() {
        let plain = format!("two bodies are called \"{}\": see `{}`", "b".repeat(QUOTED), "p".repeat(WORD - 2));
        assert_eq!(shortened(&plain), plain);
        let long = format!("a \"{} {}\" b {}", "x".repeat(50_000), "y".repeat(50_000), "z".repeat(WORD + 1));
        let [x, z] = ["x", "z"].map(|letter| letter.repeat(79));
        assert_eq!(shortened(&long), format!("a \"{x}…\" b {z}…"));
    }
}
