//! Every `plaus` command that README, docs and scenario files show is run as written, and ends as it should.

use crate::command::{Failure, plaus, root, target};
use crate::steps::Done;
use std::fs;
use std::path::{Path, PathBuf};

/// The outcome of a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Outcome {
    /// It does what it should.
    Done,
    /// It may find nothing in so short a time, or find fault with a run: exit code 0 or 1.
    Maybe,
    /// It is not run here, for this reason.
    Elsewhere(&'static str),
}

/// Commands that need not end with 0, by their beginnings.
const OTHERS: [(&str, Outcome); 9] = [
    ("plaus replay dice-live.json", Outcome::Elsewhere("needs what a page has found: `cargo xtask clients`")),
    ("plaus diagnose job", Outcome::Elsewhere("needs what an engine has made: `cargo xtask engines`")),
    ("plaus new --from kitchen.glb", Outcome::Elsewhere("needs a file of one's own: crates/plaus-cli/tests/moving.rs")),
    ("plaus submit --again", Outcome::Elsewhere("needs an engine: `cargo xtask engines`")),
    ("plaus status", Outcome::Maybe),
    ("plaus diagnose", Outcome::Maybe),
    // In so short a time methods may disagree, or find nothing.
    ("plaus chance", Outcome::Maybe),
    // A solution is found once in many thousands of shots.
    ("plaus sample scenarios/bowling-spare-7-10.toml", Outcome::Maybe),
    ("plaus sample scenarios/bowling-spare-7-10-paper.toml", Outcome::Maybe),
];

/// A run of a simulated scene, for commands that make sense only for such a run.
const DIE: &str = "runs/a-die";

/// Runs them all, in a folder of their own.
pub(crate) fn run() -> Result<Done, Failure> {
    let place = target().join("documented");
    if place.exists() {
        fs::remove_dir_all(&place).map_err(Failure::new)?;
    }
    for folder in ["scenarios", "scenarios/worlds"] {
        fs::create_dir_all(place.join(folder)).map_err(Failure::new)?;
        for file in files(folder, "")? {
            let name = file.file_name().unwrap_or_default();
            fs::copy(&file, place.join(folder).join(name)).map_err(Failure::new)?;
        }
    }
    // The world that the README shows, and the one that Getting started builds step by step.
    for (page, name, blocks) in [("README.md", "throw.toml", 1), ("docs/getting-started.md", "trick.toml", usize::MAX)]
    {
        let text = fs::read_to_string(root().join(page)).map_err(Failure::new)?;
        let blocks = text.split("```toml\n").skip(1).take(blocks);
        let world = blocks.filter_map(|rest| rest.split("```").next()).collect::<Vec<&str>>().join("\n");
        fs::write(place.join(name), world).map_err(Failure::new)?;
    }
    let die =
        ["sample", "scenarios/dice-one.toml", "--iterations", "40", "--set", "sampler.thin=1", "--quiet", "--out", DIE];
    plaus(&[]).args(die).within(&place).status()?;
    let commands = all()?;
    let mut wrong = Vec::new();
    for (file, shown) in &commands {
        let outcome = outcome(shown);
        if let Outcome::Elsewhere(why) = outcome {
            println!("- {shown}: {why}");
            continue;
        }
        let words = shortened(shown);
        if ["sample", "submit", "merge"].contains(&words[0].as_str())
            && let Some(out) = words.iter().skip_while(|word| *word != "--out").nth(1)
        {
            let _ = fs::remove_dir_all(place.join(out)); // two files may call a run by one name
        }
        let command = plaus(&[]).args(&words).within(&place);
        println!("$ plaus {}", words.join(" "));
        let code = command.status()?;
        if code > i32::from(outcome == Outcome::Maybe) {
            wrong.push(format!("{file}: `{shown}` ends with exit code {code}"));
        }
    }
    println!("{} commands", commands.len());
    if wrong.is_empty() { Ok(Done::Passed) } else { Err(Failure(wrong.join("\n"))) }
}

fn outcome(command: &str) -> Outcome {
    OTHERS.iter().find(|(start, _)| command.starts_with(start)).map_or(Outcome::Done, |(_, outcome)| *outcome)
}

/// The words after `plaus`. Whole runs are for users; here a run of any scene but `ball2d` ends with its first
/// solution.
fn shortened(command: &str) -> Vec<String> {
    let mut words: Vec<String> =
        command.split_whitespace().skip(1).map(|word| word.trim_matches('\'').to_owned()).collect();
    if ["try", "live"].contains(&words[0].as_str()) {
        words.retain(|word| word != "--watch"); // it would never end
        words.push("--no-open".to_owned());
    }
    if words[0] == "chance" && words[1].ends_with(".toml") {
        let few = "--batches 2 --draws 20 --particles 5 --steps 1 --rungs 2 --iterations 4";
        words.extend(few.split(' ').map(str::to_owned));
    }
    if words[0] != "sample" || words.iter().any(|word| word.contains("ball2d")) {
        return words;
    }
    match words.iter().position(|word| word == "--solutions") {
        Some(at) => words[at + 1] = "1".to_owned(),
        None => words.extend(["--solutions", "1"].map(str::to_owned)),
    }
    if outcome(command) == Outcome::Maybe {
        words.extend(["--iterations", "20"].map(str::to_owned));
    }
    // A solution of the warm-up is not a draw that can be diagnosed.
    words.extend(["--warmup", "0", "--quiet"].map(str::to_owned));
    words
}

/// All commands in the order in which a reader sees them, each once, with the file that shows it first.
fn all() -> Result<Vec<(String, String)>, Failure> {
    let mut found: Vec<(String, String)> = Vec::new();
    let pages = [files("docs", ".md")?, files("docs/validation", ".md")?, files("scenarios", ".toml")?].concat();
    for path in [vec![root().join("README.md")], pages].concat() {
        let text = fs::read_to_string(&path).map_err(Failure::new)?;
        let file = path.strip_prefix(root()).unwrap_or(&path).display().to_string();
        for command in commands(&text) {
            if !found.iter().any(|(_, known)| *known == command) {
                found.push((file.clone(), command));
            }
        }
    }
    Ok(found)
}

/// The commands that a text shows: on lines of their own, indented, and between backticks. A line that ends with a
/// backslash goes on in the next one.
fn commands(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for line in text.replace("\\\n", "").lines() {
        let code = line.strip_prefix("    ").or_else(|| line.strip_prefix("#     "));
        match code.map(|code| code.split(" # ").next().unwrap_or(code).trim()) {
            Some(code) => found.extend(whole(code)),
            None => found.extend(line.split('`').skip(1).step_by(2).filter_map(whole)),
        }
    }
    found
}

/// A command as it can be run; `None` if this is no command, or only names one.
fn whole(code: &str) -> Option<String> {
    let rest = ["plaus ", "$plaus ", "cargo run --release -p plaus-cli -- "].into_iter();
    let rest = rest.filter_map(|start| code.strip_prefix(start)).next()?;
    let words: Vec<&str> = rest.split_whitespace().collect();
    if words.len() < 2 {
        return None;
    }
    let named = |word: &&str| match *word {
        "RUN" if rest.contains("--accuracy") => DIE.to_owned(),
        "RUN" => "runs/ball2d".to_owned(),
        "JOB" => "job".to_owned(),
        "FILE" => "scenarios/ball2d.toml".to_owned(),
        "FOLDER" => "runs/plots".to_owned(),
        "NUMBER" => "rest_x".to_owned(),
        "my.toml" => "throw.toml".to_owned(),
        "my-try/run" => "throw-try/run".to_owned(),
        word => word.to_owned(),
    };
    let mut words: Vec<String> = words.iter().map(named).collect();
    if let Some(gap) = words.iter().position(|word| word == "…") {
        let has = |flag: &str| rest.contains(flag);
        let filled: &[&str] = match words[0].as_str() {
            // Other accuracies exist only for scenes that are simulated; `ball2d` has a closed form.
            "sample" if has("--confirm") => &["scenarios/dice-one.toml", "--out", "runs/again"],
            "replay" if has("--accuracy") => &[DIE, "--sample", "0:17"],
            "sample" if !has("--out") => &["scenarios/ball2d.toml", "--out", "runs/again"],
            "sample" | "submit" => &["scenarios/ball2d.toml", "--chains", "16"],
            "replay" if !has("--sample") => &["runs/ball2d", "--sample", "0:17"],
            _ => &["runs/ball2d"],
        };
        words.splice(gap..=gap, filled.iter().map(|word| (*word).to_owned()));
    }
    Some(format!("plaus {}", words.join(" ")))
}

/// Files of a folder of the workspace whose names have this ending.
pub(crate) fn files(folder: &str, ending: &str) -> Result<Vec<PathBuf>, Failure> {
    let entries = fs::read_dir(root().join(folder)).map_err(Failure::new)?;
    let mut files = entries.map(|entry| entry.map(|entry| entry.path()).map_err(Failure::new));
    let mut files = files.by_ref().collect::<Result<Vec<_>, _>>()?;
    files.retain(|path| path.is_file() && has_ending(path, ending));
    files.sort();
    Ok(files)
}

fn has_ending(path: &Path, ending: &str) -> bool {
    path.to_string_lossy().ends_with(ending)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_found_wherever_they_are_shown() {
        let text = "Text of `plaus resume` and `plaus explain sigma_d`.\n\n    $plaus merge pieces --out runs/both   # all\n\
                    | `plaus sample … --set rungs=8` | again |\n#     plaus check a.toml\n    cargo build\n\
                    \n    plaus check b.toml \\\n        --draws 5\n";
        let wanted = [
            "plaus explain sigma_d",
            "plaus merge pieces --out runs/both",
            "plaus sample scenarios/ball2d.toml --out runs/again --set rungs=8",
            "plaus check a.toml",
            "plaus check b.toml --draws 5",
        ];
        assert_eq!(commands(text), wanted);
    }

    #[test]
    fn those_of_the_project_are_found() {
        let all: Vec<String> = all().map(|all| all.into_iter().map(|one| one.1).collect()).unwrap_or_default();
        for wanted in [
            "plaus sample scenarios/ball2d.toml --out runs/ball2d",
            "plaus sample scenarios/spelling-hi.toml --set text=HELLO --out runs/hello",
            "plaus export runs/ball2d --format zarr --out draws.zarr",
        ] {
            assert!(all.iter().any(|one| one == wanted), "`{wanted}` is not among {all:#?}");
        }
        assert!(OTHERS.iter().all(|(start, _)| all.iter().any(|one| one.starts_with(start))), "{all:#?}");
    }

    #[test]
    fn runs_of_other_scenes_end_with_their_first_solution() {
        let words = shortened("plaus sample scenarios/bowling-strike.toml --solutions 12 --out runs/strike");
        assert_eq!(
            words.join(" "),
            "sample scenarios/bowling-strike.toml --solutions 1 --out runs/strike --warmup 0 --quiet"
        );
        assert_eq!(shortened("plaus check a.toml"), ["check", "a.toml"]);
        assert_eq!(shortened("plaus try a.toml --watch"), ["try", "a.toml", "--no-open"]);
    }
}
