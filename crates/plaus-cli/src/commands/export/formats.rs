//! All formats, one row each: tables of draws, written by `plaus_run`, and animations, written by `plaus_export` and
//! `plaus_picture`.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use plaus_export::Exporter;
use plaus_export::format::{ALL, Row};

/// A format of export.
#[derive(Clone, Copy)]
pub(super) enum Format {
    /// A table of draws.
    Csv,
    /// A folder of draws for ArviZ.
    Zarr,
    /// Animations of samples.
    Animation(&'static dyn Exporter),
}

/// Formats of draws.
const DRAWS: [(Format, Row); 2] = [
    (
        Format::Csv,
        Row {
            name: "csv",
            endings: &["csv"],
            about: "a table of draws: one row per chain and draw",
            help: "Columns: chain, draw (from 0), log_p, satisfied (true or false), then one for each scalar of the \
                   scene, in its units; for ball2d: rest_x in ball diameters D, theta_1 ... in degrees.",
        },
    ),
    (
        Format::Zarr,
        Row {
            name: "zarr",
            endings: &["zarr"],
            about: "a Zarr v3 folder of draws for ArviZ and xarray",
            help: "az.from_zarr(PATH) with ArviZ 1.x, \
                az.from_datatree(xarray.open_datatree(PATH, engine=\"zarr\")) with 0.23. \
                Scalars with the same name and different numbers become one variable with a named dimension.",
        },
    ),
];

/// All formats in the order in which they are listed.
pub(super) fn all() -> Vec<(Format, Row)> {
    let animations = ALL.into_iter().chain(plaus_picture::ALL).map(|format| (Format::Animation(format), *format.row()));
    DRAWS.into_iter().chain(animations).collect()
}

/// All endings of files that these formats make.
pub(in super::super) fn endings() -> Vec<&'static str> {
    all().into_iter().flat_map(|(_, row)| row.endings.iter().copied()).collect()
}

/// Whether several samples are tiles of one picture.
pub(super) fn is_picture(name: &str) -> bool {
    plaus_picture::ALL.into_iter().any(|format| format.row().name == name)
}

/// Reads the name of a format; completions and suggestions follow from it.
pub(super) fn parser() -> impl TypedValueParser<Value = Format> {
    let values = all().into_iter().map(|(_, row)| PossibleValue::new(row.name).help(row.about));
    PossibleValuesParser::new(values).try_map(|name| {
        let found = all().into_iter().find(|(_, row)| row.name == name);
        found.map(|(format, _)| format).ok_or_else(|| format!("there is no format {name}"))
    })
}

/// What `--help` says about each.
pub(super) fn help() -> String {
    let rows = all().into_iter().map(|(_, row)| format!("{}: {}. {}", row.name, row.about, row.help));
    let mut text = rows.collect::<Vec<_>>().join("\n");
    text.push_str(
        "\nTimes count from the beginning of --time-range. One sample makes a file; several make a folder, a table, or \
         one file with --into.",
    );
    text
}
