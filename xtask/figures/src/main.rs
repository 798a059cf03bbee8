//! The paper's figures and claims, sampled anew: `cargo xtask reproduce-figures`.
//!
//! Each scene is a folder of its own that adds figures and rows of the report; [`SCENES`] lists them. Everything follows from fixed seeds, so the same
//! version makes the same files.

#![allow(clippy::print_stderr, reason = "progress is for the person who waits")]

mod ball2d;
mod sampler;
mod stats;

use plaus_figures::report::Report;
use plaus_figures::{Result, canvas, lines, plot, report};
use std::path::PathBuf;
use std::process::ExitCode;

/// Adds a scene's figures and rows of the report.
type Make = fn(&mut Work) -> Result<()>;

/// Scenes with figures.
const SCENES: &[(&str, Make)] = &[("ball2d", ball2d::make)];

const USAGE: &str = "usage: cargo xtask reproduce-figures [--out FOLDER] [--quick]\n\n\
    --out FOLDER   where the files go, out/figures by default; files of the same names are replaced\n\
    --quick        far shorter runs: shows that everything works, its numbers mean nothing";

/// What a scene works with.
struct Work {
    out: PathBuf,
    quick: bool,
    report: Report,
}

impl Work {
    /// `full` in earnest, `quick` with `--quick`.
    fn size<N>(&self, full: N, quick: N) -> N {
        if self.quick { quick } else { full }
    }

    /// Says what is being done.
    fn say(&self, what: impl std::fmt::Display) {
        eprintln!("  {what}");
    }
}

fn main() -> ExitCode {
    let mut out = PathBuf::from("out/figures");
    let mut quick = false;
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match (argument.as_str(), arguments.size_hint()) {
            ("--quick", _) => quick = true,
            ("--out", (1.., _)) => out = arguments.next().unwrap_or_default().into(),
            _ => {
                eprintln!("{USAGE}");
                return ExitCode::from(2);
            }
        }
    }
    match run(Work { out, quick, report: Report::new(quick) }) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("reproduce-figures: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(mut work: Work) -> Result<()> {
    std::fs::create_dir_all(&work.out).map_err(|error| format!("{}: {error}", work.out.display()))?;
    for (name, make) in SCENES {
        eprintln!("{name}");
        make(&mut work)?;
    }
    let path = work.out.join("report.md");
    std::fs::write(&path, work.report.to_markdown()).map_err(|error| format!("{}: {error}", path.display()))?;
    eprintln!("wrote {}", path.display());
    Ok(())
}
