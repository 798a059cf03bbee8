//! `cargo xtask validate`: measures the tables of the validation report anew. Each is written into its page of
//! `docs/validation`, between two marks, with the day, commit and machine on which it was measured.

use crate::command::{Command, Failure, cargo, root};
use crate::documented::files;
use crate::{mixing, worlds};
use std::fs;
use std::path::PathBuf;

/// What ends every table that a chore writes.
pub(crate) const END: &str = "<!-- until here -->";

/// A table: its name, its page, and what measures it.
type Part = (&'static str, &'static str, fn() -> Result<String, Failure>);

const PARTS: [Part; 7] = [
    ("accuracy", "accuracy.md", accuracy),
    ("independent", "mixing.md", || mixing::independent("", &["1"])),
    ("first", "mixing.md", || mixing::firsts("")),
    ("different", "mixing.md", || mixing::different("")),
    ("peers", "peers.md", peers),
    ("special-cases", "special_cases.md", special_cases),
    ("tosses", "plausibility.md", tosses),
];

/// Measures all tables, or those that are named; `worlds` is one more, whose rows can be measured alone.
pub(crate) fn run(names: &[&str]) -> Result<(), Failure> {
    let known = || PARTS.iter().map(|(name, ..)| *name).chain(["worlds"]);
    if let Some(name) = names.iter().find(|name| !known().any(|known| known == **name)) {
        return Err(Failure(format!("there is no table {name}; tables: {}", known().collect::<Vec<_>>().join(", "))));
    }
    let is_asked = |name: &str| names.is_empty() || names.contains(&name);
    for (name, page, measure) in PARTS.iter().filter(|(name, ..)| is_asked(name)) {
        eprintln!("{name}");
        let table = measure()?;
        let path = root().join("docs/validation").join(page);
        let text = fs::read_to_string(&path).map_err(Failure::new)?;
        let begin = format!("<!-- `cargo xtask validate {name}` writes this -->");
        let between = format!("\n{}\n\n{}\n", stamp()?, table.trim());
        fs::write(&path, with(&text, &begin, &between).map_err(|why| Failure(format!("{page}: {why}")))?)
            .map_err(Failure::new)?;
        println!("{table}");
    }
    if is_asked("worlds") { worlds::run(&[]) } else { Ok(()) }
}

/// A text with something else between a mark and [`END`].
fn with(text: &str, begin: &str, between: &str) -> Result<String, String> {
    changed(text, begin, |_| between.to_owned())
}

/// A text in which something is made of what stands between a mark and [`END`].
pub(crate) fn changed(text: &str, begin: &str, make: impl FnOnce(&str) -> String) -> Result<String, String> {
    let missing = || format!("it has no line {begin:?}, or none {END:?} after it");
    let (before, rest) = text.split_once(begin).ok_or_else(missing)?;
    let (between, after) = rest.split_once(END).ok_or_else(missing)?;
    Ok(format!("{before}{begin}\n{}{END}{after}", make(between)))
}

/// When, from what, and on what machine.
fn stamp() -> Result<String, Failure> {
    let printed = |program: &str, words: &[&str]| -> Result<String, Failure> {
        let (_, printed) = Command::new(program).args(words).output()?;
        Ok(String::from_utf8_lossy(&printed).trim().to_owned())
    };
    let (day, commit) = (printed("date", &["-u", "+%F"])?, printed("git", &["rev-parse", "--short=8", "HEAD"])?);
    let is_changed = !printed("git", &["status", "--porcelain", "--", "crates", "Cargo.lock"])?.is_empty();
    let changed = if is_changed { " with changes" } else { "" };
    let processors = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = processors.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    let model = model.map_or("an unknown processor", |(_, name)| name);
    let count = std::thread::available_parallelism().map_or(1, usize::from);
    let load = fs::read_to_string("/proc/loadavg").unwrap_or_default();
    let load = load.split(' ').nth(1).unwrap_or("unknown").to_owned();
    Ok(format!("Measured on {day} at commit {commit}{changed}: {model}, {count} cores, load {load}."))
}

/// The rows of a program's table, from the line that begins like this.
fn rows(printed: &str, head: &str) -> Result<String, Failure> {
    let rows = printed.lines().skip_while(|line| !line.starts_with(head)).take_while(|line| line.starts_with('|'));
    let rows: Vec<&str> = rows.collect();
    if rows.is_empty() { Err(Failure(format!("no table begins with {head:?}"))) } else { Ok(rows.join("\n")) }
}

fn accuracy() -> Result<String, Failure> {
    let measuring = ["run", "--release", "--package", "plaus-sim", "--example", "convergence", "--", "20", "20"];
    let (_, printed) = cargo(&measuring).output()?;
    rows(&String::from_utf8_lossy(&printed), "| case |")
}

fn peers() -> Result<String, Failure> {
    let worlds = "dominoes,bowl,shards,seesaw,coin,track,pendulum,cradle";
    let presets = ["--presets", "draft,standard", "--rates", "240,1000", "--draws", "100", "--seconds", "4"];
    let (run, out) = (["run", "--release", "--package", "plaus-tradeoff", "--", "--worlds", worlds], "out/tradeoff");
    cargo(&run).args(presets).args(["--out", out]).run()?;
    rows(&fs::read_to_string(root().join(out).join("report.md")).map_err(Failure::new)?, "| world |")
}

/// Without the worlds of many bodies, in which two draws take a minute for each case.
fn special_cases() -> Result<String, Failure> {
    let own = files("crates/plaus-scenes/examples/special_cases", ".toml")?;
    let heavy = ["cartons", "rubble", "stack", "toys", "tower", "tray"];
    let is_light = |file: &PathBuf| file.file_stem().is_none_or(|stem| heavy.iter().all(|name| *name != stem));
    let worlds = files("scenarios/worlds", ".toml")?.into_iter().filter(is_light);
    let run = ["run", "--release", "--package", "plaus-scenes", "--features", "leave-out", "--example"];
    let (_, printed) =
        cargo(&run).args(["special_cases", "--", "0.05"]).args(own.into_iter().chain(worlds)).output()?;
    rows(&String::from_utf8_lossy(&printed), "| special case |")
}

fn tosses() -> Result<String, Failure> {
    let (run, out) = (["run", "--release", "--package", "plaus-figures", "--", "plausibility"], "out/plausibility");
    cargo(&run).args(["--only", "tosses", "--out", out]).run()?;
    rows(&fs::read_to_string(root().join(out).join("report.md")).map_err(Failure::new)?, "| | distance")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_replaces_what_was_between_its_marks() {
        let text = format!("a\n<!-- b -->\nold\n{END}\nz\n");
        assert_eq!(with(&text, "<!-- b -->", "new\n").unwrap(), format!("a\n<!-- b -->\nnew\n{END}\nz\n"));
        assert!(with(&text, "<!-- c -->", "new\n").unwrap_err().contains("<!-- c -->"));
    }

    #[test]
    fn every_table_has_a_place() {
        for (name, page, _) in PARTS {
            let text = fs::read_to_string(root().join("docs/validation").join(page)).unwrap();
            with(&text, &format!("<!-- `cargo xtask validate {name}` writes this -->"), "").unwrap();
        }
    }
}
