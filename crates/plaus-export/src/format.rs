//! All formats of animations, one row each: help, completions and documentation are made of [`ALL`].

mod games;
mod heard;
mod layers;
mod tables;

use crate::clip::{Clip, ExportError};
use std::io::Write;
use std::path::Path;

/// What is to be known of a format before anything is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Row {
    /// What `--format` calls it.
    pub name: &'static str,
    /// How names of its files end, without the dot.
    pub ending: &'static str,
    /// What it is, in one line.
    pub about: &'static str,
    /// What a user must know, in a sentence or a few.
    pub help: &'static str,
}

/// A format that animations are written in.
pub trait Exporter: Sync {
    /// What is to be known of it.
    fn row(&self) -> &'static Row;

    /// Begins a file of that name.
    fn begin(&self, path: &Path) -> Box<dyn Collection>;

    /// Whether that file was made here, and may be replaced when asked to.
    fn is_ours(&self, path: &Path) -> bool;

    /// Whether several samples go into one file unasked, which may be the standard output.
    fn is_table(&self) -> bool {
        false
    }

    /// Frames a second unless said otherwise.
    fn fps(&self) -> f64 {
        60.0
    }

    /// The most clips of one file: that of a format which must hold them all in memory has an end.
    fn most(&self) -> usize {
        usize::MAX
    }

    /// What goes beside a file: the end of its name, and its text.
    fn beside(&self, _file: &str) -> Option<(&'static str, String)> {
        None
    }
}

/// A file in the making.
pub trait Collection {
    /// Adds a clip; may write.
    ///
    /// # Errors
    /// [`ExportError`] where the format cannot hold it or `out` refuses.
    fn add(&mut self, clip: &Clip<'_>, out: &mut dyn Write) -> Result<(), ExportError>;

    /// Writes what is left.
    ///
    /// # Errors
    /// As [`Collection::add`].
    fn finish(self: Box<Self>, out: &mut dyn Write) -> Result<(), ExportError>;
}

/// All formats, in the order in which they are listed.
pub const ALL: [&dyn Exporter; 6] =
    [&layers::Gltf, &layers::Usd, &tables::Poses, &tables::Events, &games::Json, &heard::Wav];

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
    fn every_format_is_named_once_and_told_about() {
        let names: BTreeSet<&str> = ALL.iter().map(|format| format.row().name).collect();
        assert_eq!(names.len(), ALL.len());
        for format in ALL {
            let row = format.row();
            assert!(named(row.name).is_some_and(|found| found.row() == row));
            assert!(row.help.ends_with('.') && !row.about.ends_with('.') && !row.ending.contains('.'), "{}", row.name);
        }
        assert!(named("obj").is_none());
    }
}
