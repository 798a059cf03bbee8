//! Standard output and standard error, written such that a reader who goes away is no accident.

use crate::failure::Failure;
use std::io::{self, IsTerminal, Write};

/// Writes to stdout and flushes. A reader who has gone has seen enough: how the command ends does not depend on it.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Failure::of_output(error)),
        _ => Ok(()),
    }
}

/// Writes a line to stdout.
pub(crate) fn print_line(text: &str) -> Result<(), Failure> {
    print(&format!("{text}\n"))
}

/// Writes to stderr. Nobody is told where that fails: there is nowhere left to tell it.
pub(crate) fn note(text: &str) {
    let _ = io::stderr().lock().write_all(text.as_bytes());
}

/// Writes a line to stderr.
pub(crate) fn note_line(text: &str) {
    note(&format!("{text}\n"));
}

/// Whether stderr is a terminal on which lines can be drawn again.
pub(crate) fn is_live() -> bool {
    io::stderr().is_terminal() && std::env::var_os("TERM").is_none_or(|term| term != "dumb")
}

/// Whether messages may be coloured: on a terminal, unless `NO_COLOR` says no.
pub(crate) fn is_coloured() -> bool {
    is_live() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}
