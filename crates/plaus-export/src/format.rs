//! All formats of animations, one row each: help, completions and documentation follow from [`ALL`].

mod games;
mod heard;
mod layers;
mod state;
mod tables;

use crate::clip::{Clip, ExportError, FPS};
use std::io::Write;
use std::path::Path;

/// What is known of a format before anything is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Row {
    /// Its name for `--format`.
    pub name: &'static str,
    /// The extensions that its files may have, without the dot, the usual one first.
    pub endings: &'static [&'static str],
    /// A description in one line.
    pub about: &'static str,
    /// What a user must know, in one or a few sentences.
    pub help: &'static str,
}

impl Row {
    /// The usual extension of its files, without the dot.
    #[must_use]
    pub fn ending(&self) -> &'static str {
        self.endings.first().copied().unwrap_or_default()
    }
}

/// A format that animations are written in.
pub trait Exporter: Sync {
    /// Its row.
    fn row(&self) -> &'static Row;

    /// Begins a file with this name.
    fn begin(&self, path: &Path) -> Box<dyn Collection>;

    /// Whether that file was made by this program, and so may be replaced on request.
    fn is_ours(&self, path: &Path) -> bool;

    /// Whether several samples go into one file by default; that file may be standard output.
    fn is_table(&self) -> bool {
        false
    }

    /// Frames per second by default.
    fn fps(&self) -> f64 {
        FPS
    }

    /// The most clips in one file; limited for formats that must hold them all in memory.
    fn most(&self) -> usize {
        usize::MAX
    }

    /// A second file that goes beside it: the ending of its name, and its text.
    fn beside(&self, _file: &str) -> Option<(&'static str, String)> {
        None
    }
}

/// An unfinished file.
pub trait Collection {
    /// Adds a clip; may write.
    ///
    /// # Errors
    /// [`ExportError`] if the format cannot hold it or `out` refuses.
    fn add(&mut self, clip: &Clip<'_>, out: &mut dyn Write) -> Result<(), ExportError>;

    /// Writes the rest.
    ///
    /// # Errors
    ///
    /// Those of [`Collection::add`].
    fn finish(self: Box<Self>, out: &mut dyn Write) -> Result<(), ExportError>;
}

/// All formats, in the order in which they are listed.
pub const ALL: [&dyn Exporter; 7] =
    [&layers::Gltf, &layers::Usd, &tables::Poses, &tables::Events, &games::Json, &state::State, &heard::Wav];

/// The format of that name.
#[must_use]
pub fn named(name: &str) -> Option<&'static dyn Exporter> {
    ALL.into_iter().find(|format| format.row().name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_format_has_a_unique_name_and_a_description() {
        let names: BTreeSet<&str> = ALL.iter().map(|format| format.row().name).collect();
        assert_eq!(names.len(), ALL.len());
        for format in ALL {
            let row = format.row();
            assert!(named(row.name).is_some_and(|found| found.row() == row));
            assert!(
                row.help.ends_with('.') && !row.about.ends_with('.') && !row.ending().contains('.'),
                "{}",
                row.name
            );
        }
        assert!(named("obj").is_none());
    }
}
