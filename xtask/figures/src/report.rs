//! `report.md`: what the paper claims, and what was found.

use std::fmt::Write as _;

/// A row of the table of claims.
pub struct Claim {
    /// What the paper says, and where.
    pub paper: String,
    /// What was found, with its error.
    pub ours: String,
    /// The seed and the number of iterations.
    pub how: String,
    /// Whether they agree, in a word and a reason.
    pub verdict: String,
}

/// The beginning of the report on the paper's figures.
pub const THE_PAPER: &str = "# The paper's figures and claims, sampled anew\n\n\
    S. Chenney, D. A. Forsyth, \"Sampling Plausible Solutions to Multi-body Constraint Problems\", SIGGRAPH 2000.\n\
    This file and the figures beside it are made by one command, from fixed seeds; a second run of the same version \
    gives the same\n\
    bytes, but for times, which are those of the machine:\n\n    cargo xtask reproduce-figures\n\n";

/// The report as it grows.
pub struct Report {
    heading: &'static str,
    quick: bool,
    figures: Vec<(String, String)>,
    claims: Vec<Claim>,
    sections: String,
}

impl Report {
    pub fn new(heading: &'static str, quick: bool) -> Self {
        Self { heading, quick, figures: Vec::new(), claims: Vec::new(), sections: String::new() }
    }

    /// Adds a figure by the name of its files, with its caption.
    pub fn figure(&mut self, name: &str, caption: impl Into<String>) {
        self.figures.push((name.to_owned(), caption.into()));
    }

    pub fn claim(&mut self, claim: Claim) {
        self.claims.push(claim);
    }

    /// Adds a section after the table.
    pub fn section(&mut self, title: &str, text: &str) {
        let _ = write!(self.sections, "\n## {title}\n\n{}\n", text.trim_end()); // writing to a string cannot fail
    }

    pub fn to_markdown(&self) -> String {
        let mut text = self.heading.to_owned();
        if self.quick {
            text += "**Made with `--quick`: the runs are far too short for the numbers to mean anything.**\n\n";
        }
        text += "Numbers after ± are one Monte Carlo standard error.";
        text += &if self.claims.is_empty() { "\n".to_owned() } else { self.claims() };
        if !self.figures.is_empty() {
            text += "\n## Figures\n";
        }
        for (name, caption) in &self.figures {
            let _ = write!(text, "\n![{name}]({name}.png)\n\n**{name}** ([SVG]({name}.svg)). {caption}\n");
        }
        text + &self.sections
    }

    fn claims(&self) -> String {
        let rows = self
            .claims
            .iter()
            .map(|claim| [&claim.paper, &claim.ours, &claim.how, &claim.verdict].map(String::clone).to_vec());
        let table = table(&["The paper's claim", "Our number", "How computed", "Verdict"], rows);
        format!(" ESS is the effective sample size of the bulk (Vehtari et al. 2021).\n\n## Claims\n\n{table}")
    }
}

/// A Markdown table.
pub fn table(head: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let mut text = line(&head.iter().map(|cell| (*cell).to_owned()).collect::<Vec<_>>());
    text += &line(&vec!["---".to_owned(); head.len()]);
    for row in rows {
        text += &line(&row);
    }
    text
}

/// `value` with `digits` significant digits, without an exponent.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let exponent: i64 =
        format!("{value:.*e}", digits - 1).split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0);
    let decimals = (digits as i64 - 1 - exponent).max(0) as usize;
    format!("{value:.decimals$}")
}

/// `1234567` as `1,234,567`.
pub fn thousands(number: u64) -> String {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_readable() {
        assert_eq!([significant(0.2134, 2), significant(61.23, 2), significant(999.6, 3)], ["0.21", "61", "1000"]);
        assert_eq!([thousands(1), thousands(1000), thousands(1_234_567)], ["1", "1,000", "1,234,567"]);
    }
}
