//! Plain text tables: the first column to the left, numbers to the right.

/// Lays out rows; the first is the heading.
pub(crate) fn lay_out(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max();
    let widths: Vec<usize> = (0..columns).map(|column| width(column).unwrap_or(0)).collect();
    let mut text = String::new();
    for row in rows {
        let cells = row.iter().zip(&widths).enumerate().map(|(index, (cell, &width))| match index {
            0 => format!("{cell:<width$}"),
            _ => format!("{cell:>width$}"),
        });
        text += cells.collect::<Vec<_>>().join("  ").trim_end();
        text.push('\n');
    }
    text
}

/// A number of at least 0, rounded; `-` if it is not a number.
pub(crate) fn rounded(number: f64) -> String {
    if number >= 0.0 { grouped(number.round() as u64) } else { "-".to_owned() }
}

/// A whole number with commas between thousands.
pub(crate) fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// So many of a thing, in the singular or plural: `1 piece`, `1,000 pieces`.
pub(crate) fn counted(number: u64, thing: &str) -> String {
    let end = if number == 1 {
        ""
    } else if thing.ends_with("ch") {
        "es"
    } else {
        "s"
    };
    format!("{} {thing}{end}", grouped(number))
}

/// An amount, with commas between thousands if it is large.
pub(crate) fn amount(number: f64) -> String {
    if (1e3..1e15).contains(&number) { grouped(number.round() as u64) } else { short(number) }
}

/// A number in about five characters.
pub(crate) fn short(number: f64) -> String {
    match number.abs() {
        0.0 => "0".to_owned(),
        size if !(1e-4..1e7).contains(&size) => format!("{number:.2e}"),
        size if size < 0.1 => format!("{number:.4}"),
        size if size < 10.0 => format!("{number:.3}"),
        size if size < 1000.0 => format!("{number:.1}"),
        _ => format!("{number:.0}"),
    }
}

/// Iterations per second.
pub(crate) fn rate(per_second: f64) -> String {
    match per_second {
        rate if !rate.is_finite() => "?".to_owned(),
        rate if rate >= 1e6 => format!("{:.2} M/s", rate / 1e6),
        rate if rate >= 1e4 => format!("{:.0} k/s", rate / 1e3),
        rate => format!("{rate:.0} /s"),
    }
}

/// A share in percent.
pub(crate) fn percent(share: f64) -> String {
    if share.is_finite() { format!("{:.1}%", 100.0 * share) } else { "-".to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_readable() {
        assert_eq!([grouped(7), grouped(1_000), grouped(12_345_678)], ["7", "1,000", "12,345,678"]);
        assert_eq!(
            [counted(1, "piece"), counted(2_000, "piece"), counted(0, "batch")],
            ["1 piece", "2,000 pieces", "0 batches"]
        );
        assert_eq!([short(0.0), short(1.0), short(-12.345), short(1e-9)], ["0", "1.000", "-12.3", "1.00e-9"]);
        assert_eq!([rate(3.21e6), rate(45_678.0), rate(12.3)], ["3.21 M/s", "46 k/s", "12 /s"]);
    }

    #[test]
    fn columns_line_up() {
        let rows = [vec!["name".to_owned(), "n".to_owned()], vec!["é".to_owned(), "100".to_owned()]];
        assert_eq!(lay_out(&rows), "name    n\né     100\n");
    }
}
