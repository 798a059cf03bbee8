//! How far presets are from truths that do not depend on the simulator: `cargo xtask accuracy`.
//!
//! The example `convergence` of `plaus-sim` does the measuring, and leaves its table in the folder; this program draws
//! the table.

mod plot;

use crate::report::table;
use crate::{Make, Result, Work};

/// The beginning of the report.
pub(crate) const HEADING: &str = "# How exact contact is\n\n\
    Made by one command from fixed seeds; a second run of the same version gives the same numbers:\n\n    cargo xtask accuracy\n\n";

pub(crate) const SCENES: &[(&str, Make)] = &[("contact", make)];

/// The table that the example leaves.
const TABLE: &str = "convergence.csv";

/// A case and how far each preset is off; NaN if it was cut off.
#[derive(Debug, Clone, PartialEq)]
struct Row {
    name: String,
    truth: String,
    measure: String,
    off: [f64; 4],
    /// The uncertainty of the truth.
    unknown: f64,
}

fn make(work: &mut Work) -> Result<()> {
    let path = work.out.join(TABLE);
    let text = std::fs::read_to_string(&path).map_err(|error| {
        format!("{}: {error}; `cargo xtask accuracy` has the example `convergence` write it", path.display())
    })?;
    let rows = text.lines().skip(1).map(|line| row(line).ok_or_else(|| format!("not a row: {line}")));
    let rows = rows.collect::<std::result::Result<Vec<Row>, _>>()?;
    plot::make(work, &rows)?;
    let shown = |off: f64| if off.is_nan() { "cut off".to_owned() } else { format!("{off:.1e}") };
    let cells = rows.iter().map(|row| {
        let mut cells = vec![row.name.clone(), row.truth.clone(), row.measure.clone()];
        cells.extend(row.off.map(shown));
        cells.push(if row.unknown > 0.0 { shown(row.unknown) } else { "–".to_owned() });
        cells
    });
    let head = ["case", "truth", "measured", "draft", "standard", "fine", "reference", "unknown of the truth"];
    work.report.section("Contact", &table(&head, cells));
    Ok(())
}

/// Three texts in quotation marks, then five numbers.
fn row(line: &str) -> Option<Row> {
    let mut texts = line.split('"').skip(1).step_by(2).map(str::to_owned);
    let (name, truth, measure) = (texts.next()?, texts.next()?, texts.next()?);
    let numbers: Vec<f64> =
        line.rsplit_once("\",")?.1.split(',').map(|n| n.parse().ok()).collect::<Option<Vec<f64>>>()?;
    let [draft, standard, fine, reference, unknown] = numbers.try_into().ok()?;
    Some(Row { name, truth, measure, off: [draft, standard, fine, reference], unknown })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_read_as_they_are_written() {
        let line = "\"coin, on its rim\",\"circle, kept\",\"rad\",1e-1,2.5e-2,NaN,0e0,1e-9";
        let read = row(line).expect("a row");
        assert_eq!((read.name.as_str(), read.truth.as_str()), ("coin, on its rim", "circle, kept"));
        assert_eq!((read.off[0], read.off[1], read.off[3], read.unknown), (0.1, 0.025, 0.0, 1e-9));
        assert!(read.off[2].is_nan());
        assert_eq!(row("\"coin\",\"circle\",\"rad\",1,2,3"), None);
    }
}
