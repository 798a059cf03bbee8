//! The paper's figures and claims, sampled anew: `cargo xtask reproduce-figures`.
//!
//! Each scene is a folder of its own that adds figures and rows of the report; [`SCENES`] lists them. Everything but the times that are measured follows from fixed
//! seeds, so the same version makes the same files.

#![allow(clippy::print_stderr, reason = "progress is for the person who waits")]

mod ball2d;
mod dice;
mod sampler;
mod spelling;
mod stats;

use plaus_figures::report::Report;
use plaus_figures::{Result, canvas, lines, plot, render, report};
use std::path::PathBuf;
use std::process::ExitCode;

/// Adds a scene's figures and rows of the report.
type Make = fn(&mut Work) -> Result<()>;

/// Scenes with figures.
const SCENES: &[(&str, Make)] = &[("ball2d", ball2d::make), ("spelling", spelling::make), ("dice", dice::make)];

const USAGE: &str = "usage: cargo xtask reproduce-figures [--out FOLDER] [--quick] [--only SCENE]\n\n\
    --out FOLDER   where the files go, out/figures by default; files of the same names are replaced\n\
    --quick        far shorter runs: shows that everything works, its numbers mean nothing
    --only SCENE   only that scene's figures; SCENE/PART where a scene has parts: only that part's";

/// What a scene works with.
struct Work {
    out: PathBuf,
    quick: bool,
    /// Which part of a scene's figures; all where there is none.
    part: Option<String>,
    report: Report,
}

impl Work {
    /// `full` in earnest, `quick` with `--quick`.
    fn size<N>(&self, full: N, quick: N) -> N {
        if self.quick { quick } else { full }
    }

    /// Writes the report as far as it is.
    fn write_report(&self) -> Result<()> {
        let path = self.out.join("report.md");
        Ok(std::fs::write(&path, self.report.to_markdown()).map_err(|error| format!("{}: {error}", path.display()))?)
    }

    /// Says what is being done.
    fn say(&self, what: impl std::fmt::Display) {
        eprintln!("  {what}");
    }
}

fn main() -> ExitCode {
    let mut out = PathBuf::from("out/figures");
    let (mut quick, mut only) = (false, None);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match (argument.as_str(), arguments.size_hint()) {
            ("--quick", _) => quick = true,
            ("--only", (1.., _)) => only = arguments.next(),
            ("--out", (1.., _)) => out = arguments.next().unwrap_or_default().into(),
            _ => {
                eprintln!("{USAGE}");
                return ExitCode::from(2);
            }
        }
    }
    let (scene, part) = match only.as_deref().map(|only| only.split_once('/').unwrap_or((only, ""))) {
        Some((scene, part)) => (Some(scene), Some(part.to_owned()).filter(|part| !part.is_empty())),
        None => (None, None),
    };
    match run(Work { out, quick, part, report: Report::new(quick) }, scene) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("reproduce-figures: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(mut work: Work, only: Option<&str>) -> Result<()> {
    if let Some(name) = only.filter(|name| !SCENES.iter().any(|(known, _)| known == name)) {
        let known: Vec<&str> = SCENES.iter().map(|(name, _)| *name).collect();
        return Err(format!("there are no figures of `{name}`, only of {}", known.join(", ")).into());
    }
    std::fs::create_dir_all(&work.out).map_err(|error| format!("{}: {error}", work.out.display()))?;
    for (name, make) in SCENES.iter().filter(|(name, _)| only.is_none_or(|only| only == *name)) {
        eprintln!("{name}");
        make(&mut work)?;
    }
    work.write_report()?;
    eprintln!("wrote {}", work.out.join("report.md").display());
    Ok(())
}
