//! Standard output. A reader who goes away early is not an error.

use crate::failure::Failure;
use std::io::{self, Write};

/// Writes to stdout and flushes. If the reader has gone, nothing is printed, and the command still ends as it would
/// have.
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
