//! How soon runs find what the worlds in `scenarios/worlds` ask for: the table of `docs/validation/worlds.md`; and
//! pictures of what they find.

use crate::clients::node;
use crate::command::{Command, Failure, plaus, root, target};
use crate::documented::files;
use crate::mixing::{anew, numbers, processor_seconds};
use crate::steps;
use crate::validate::changed;
use std::fs;
use std::path::Path;

/// Between these lines of the document is the table.
const BEGIN: &str = "<!-- `cargo xtask worlds` writes these rows -->";
const HEAD: &str = "\
| file | what must happen | a draw takes | draws that succeed | first solution | ten distinct ones | hold at reference |
| --- | --- | --- | --- | --- | --- | --- |";

/// Draws of the prior, and the seconds that they may take together.
const DRAWS: f64 = 200.0;
const SECONDS: f64 = 10.0;
/// Number of solutions that are waited for, and for how long.
const WANTED: &str = "10";
const PATIENCE: &str = "10m";
/// For how long they are simulated at reference accuracy; heaps of many bodies take longer there.
const CONFIRMING: &str = "1m";

/// Measures the worlds whose names contain `word`, and writes their rows anew and takes their pictures; other rows stay
/// as they are.
pub(crate) fn run(arguments: &[&str]) -> Result<(), Failure> {
    let word = arguments.first().copied().unwrap_or_default();
    steps::release().run()?;
    let (document, mut pages) = (root().join("docs/validation/worlds.md"), Vec::new());
    for file in files("scenarios/worlds", ".toml")? {
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if name.contains(word) {
            let row = row(&file, &name)?;
            println!("{row}");
            let text = fs::read_to_string(&document).map_err(Failure::new)?;
            fs::write(&document, with_row(&text, &name, &row)?).map_err(Failure::new)?;
            let page = target().join("worlds").join(&name).with_extension("html").to_string_lossy().into_owned();
            if plaus(&["gallery", &run_of(&name), "--out", &page, "--force"]).output()?.0 == 0 {
                pages.push(page);
            }
        }
    }
    let Some(node) = node()? else { return Err(Failure::new("no pictures: npm cannot install their packages")) };
    Command::new("node").args([node.join("world_pictures.mjs"), root().join("docs/pictures")]).args(pages).run()
}

/// The document with another row for the world of that name. Rows are in alphabetic order.
fn with_row(text: &str, name: &str, row: &str) -> Result<String, Failure> {
    let own = format!("| `{name}.toml` |");
    let is_other = |line: &&str| line.starts_with("| `") && !line.starts_with(&own);
    let table = |table: &str| {
        let mut rows: Vec<&str> = table.lines().filter(is_other).chain([row]).collect();
        rows.sort_unstable();
        format!("{HEAD}\n{}\n", rows.join("\n"))
    };
    changed(text, BEGIN, table).map_err(|why| Failure(format!("docs/validation/worlds.md: {why}")))
}

/// All cells of a world, each time in seconds of a processor.
fn row(file: &Path, name: &str) -> Result<String, Failure> {
    let text = fs::read_to_string(file).map_err(Failure::new)?;
    let comment = text.lines().map_while(|line| line.strip_prefix("# "));
    let what = comment.collect::<Vec<_>>().join(" ");
    let path = file.to_string_lossy();
    let draws = |count: f64| {
        let (printed, seconds) = timed(plaus(&["check", &path, "--json", "--draws", &count.to_string()]))?;
        let of = |key| numbers(&printed, key).next().unwrap_or(0.0);
        Ok::<_, Failure>((of("states"), of("all"), seconds))
    };
    let (few, _, seconds) = draws(4.0)?;
    let (states, all, seconds) = draws((SECONDS / (seconds / few)).floor().clamp(4.0, DRAWS))?;
    let run = run_of(name);
    let sample = |wanted| {
        let words =
            ["sample", &path, "--out", &anew(Path::new(&run))?, "--threads", "2", "--quiet", "--solutions", wanted];
        timed(plaus(&words).args(["--max-time", PATIENCE]))
    };
    let (_, first) = sample("1")?;
    let (_, ten) = sample(WANTED)?;
    plaus(&["resume", &run, "--confirm", "--solutions", WANTED, "--max-time", CONFIRMING]).output()?;
    let confirmed = fs::read_to_string(Path::new(&run).join("confirmed.json")).unwrap_or_default();
    let of = confirmed.matches("\"holds\":").count();
    let confirmed = numbers(&confirmed, "held").next().map_or("–".into(), |held| format!("{held} of {of}"));
    Ok(format!(
        "| `{name}.toml` | {what} | {} | {all} of {states} | {first:.1} s | {ten:.1} s | {confirmed} |",
        each(seconds / states)
    ))
}

/// The folder of a world's run.
fn run_of(name: &str) -> String {
    target().join("worlds").join(name).to_string_lossy().into_owned()
}

/// Seconds, with two digits or so.
fn each(seconds: f64) -> String {
    match 1e3 * seconds {
        milliseconds if milliseconds < 10.0 => format!("{milliseconds:.1} ms"),
        milliseconds => format!("{milliseconds:.0} ms"),
    }
}

/// What a command prints, and the seconds of a processor that it takes.
fn timed(command: Command) -> Result<(String, f64), Failure> {
    let seconds = || processor_seconds().ok_or_else(|| Failure::new("this system does not tell processor time"));
    let before = seconds()?;
    let (_, printed) = command.output()?;
    Ok((String::from_utf8_lossy(&printed).into_owned(), seconds()? - before))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::validate::END;

    #[test]
    fn a_row_replaces_its_own() {
        let text = format!("a\n{BEGIN}\n{HEAD}\n| `b.toml` | 1 |\n| `d.toml` | 1 |\n{END}\nz\n");
        let new = with_row(&text, "b", "| `b.toml` | 2 |").unwrap();
        let new = with_row(&new, "c", "| `c.toml` | 3 |").unwrap();
        let rows = "| `b.toml` | 2 |\n| `c.toml` | 3 |\n| `d.toml` | 1 |\n";
        assert_eq!(new, format!("a\n{BEGIN}\n{HEAD}\n{rows}{END}\nz\n"));
    }
}
