//! The paper's figures and claims, sampled anew: `cargo xtask reproduce-figures`. What is simulated, compared with what
//! was published about real things: `cargo xtask plausibility`. How exact contact is: `cargo xtask accuracy`.
//!
//! Each scene is a folder of its own that adds figures and rows of the report. [`SCENES`] lists the scenes of the first
//! command, [`plausibility::SCENES`] those of the second. Everything except measured times follows from fixed seeds, so
//! the same version makes the same files.

#![allow(clippy::print_stderr, reason = "progress is for the person who waits")]

mod accuracy;
mod ball2d;
mod bowling;
mod dice;
mod plausibility;
mod sampler;
mod spelling;
mod stats;

use plaus_figures::report::Report;
use plaus_figures::{Result, canvas, clock, lines, plot, render, report};
use std::path::PathBuf;
use std::process::ExitCode;

/// Adds a scene's figures and rows of the report.
type Make = fn(&mut Work) -> Result<()>;

/// Scenes with figures.
const SCENES: &[(&str, Make)] =
    &[("ball2d", ball2d::make), ("spelling", spelling::make), ("bowling", bowling::make), ("dice", dice::make)];

/// A command of this program.
struct Chore {
    name: &'static str,
    /// The folder of its files, unless told otherwise.
    folder: &'static str,
    heading: &'static str,
    scenes: &'static [(&'static str, Make)],
}

const FIGURES: Chore =
    Chore { name: "reproduce-figures", folder: "out/figures", heading: report::THE_PAPER, scenes: SCENES };

const PLAUSIBILITY: Chore = Chore {
    name: "plausibility",
    folder: "out/plausibility",
    heading: plausibility::HEADING,
    scenes: plausibility::SCENES,
};

const ACCURACY: Chore =
    Chore { name: "accuracy", folder: "out/accuracy", heading: accuracy::HEADING, scenes: accuracy::SCENES };

impl Chore {
    fn usage(&self) -> String {
        format!(
            "usage: cargo xtask {} [--out FOLDER] [--quick] [--only SCENE]\n\n\
            --out FOLDER   where the files go, {} by default; files of the same names are replaced\n\
            --quick        far shorter runs: shows that everything works, its numbers mean nothing\n\
            --only SCENE   only that scene's figures; SCENE/PART where a scene has parts: only that part's",
            self.name, self.folder
        )
    }
}

/// What a scene needs to add its figures.
struct Work {
    out: PathBuf,
    quick: bool,
    /// The part of a scene's figures to make; all if there is none.
    part: Option<String>,
    report: Report,
}

impl Work {
    /// `full` normally, `quick` with `--quick`.
    fn size<N>(&self, full: N, quick: N) -> N {
        if self.quick { quick } else { full }
    }

    /// Writes the report as far as it has come.
    fn write_report(&self) -> Result<()> {
        let path = self.out.join("report.md");
        Ok(std::fs::write(&path, self.report.to_markdown()).map_err(|error| format!("{}: {error}", path.display()))?)
    }

    /// Makes a scene's parts, or the one that is asked for. The report can be read after each part.
    fn make_parts(&mut self, scene: &str, parts: &[(&str, Make)]) -> Result<()> {
        let wanted = self.part.clone();
        if let Some(wanted) = wanted.as_ref().filter(|wanted| !parts.iter().any(|(name, _)| name == wanted)) {
            let known: Vec<&str> = parts.iter().map(|(name, _)| *name).collect();
            return Err(format!("{scene} has no part `{wanted}`, only {}", known.join(", ")).into());
        }
        for (name, part) in parts.iter().filter(|(name, _)| wanted.as_deref().is_none_or(|wanted| wanted == *name)) {
            self.say(format_args!("part {name}"));
            part(self)?;
            self.write_report()?;
        }
        Ok(())
    }

    /// Says what is being done.
    fn say(&self, what: impl std::fmt::Display) {
        eprintln!("  {what}");
    }
}

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1).peekable();
    let named = [PLAUSIBILITY, ACCURACY].into_iter().find(|chore| arguments.peek().is_some_and(|a| a == chore.name));
    let chore = named.unwrap_or(FIGURES);
    arguments.next_if(|first| first == chore.name);
    let mut out = PathBuf::from(chore.folder);
    let (mut quick, mut only) = (false, None);
    while let Some(argument) = arguments.next() {
        match (argument.as_str(), arguments.peek()) {
            ("--quick", _) => quick = true,
            ("--only", Some(_)) => only = arguments.next(),
            ("--out", Some(_)) => out = arguments.next().unwrap_or_default().into(),
            ("--help" | "-h", _) => {
                eprintln!("{}", chore.usage());
                return ExitCode::SUCCESS;
            }
            _ => {
                eprintln!("{}", chore.usage());
                return ExitCode::from(2);
            }
        }
    }
    let (scene, part) = match only.as_deref().map(|only| only.split_once('/').unwrap_or((only, ""))) {
        Some((scene, part)) => (Some(scene), Some(part.to_owned()).filter(|part| !part.is_empty())),
        None => (None, None),
    };
    match run(&chore, Work { out, quick, part, report: Report::new(chore.heading, quick) }, scene) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{}: {error}", chore.name);
            ExitCode::FAILURE
        }
    }
}

fn run(chore: &Chore, mut work: Work, only: Option<&str>) -> Result<()> {
    let scenes = chore.scenes;
    if let Some(name) = only.filter(|name| !scenes.iter().any(|(known, _)| known == name)) {
        let known: Vec<&str> = scenes.iter().map(|(name, _)| *name).collect();
        return Err(format!("there are no figures of `{name}`, only of {}", known.join(", ")).into());
    }
    std::fs::create_dir_all(&work.out).map_err(|error| format!("{}: {error}", work.out.display()))?;
    for (name, make) in scenes.iter().filter(|(name, _)| only.is_none_or(|only| only == *name)) {
        eprintln!("{name}");
        make(&mut work)?;
        work.write_report()?;
    }
    eprintln!("wrote {}", work.out.join("report.md").display());
    Ok(())
}
