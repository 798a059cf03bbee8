//! What each preset of the simulator costs and what it gives, beside rapier3d at three time steps: `cargo xtask tradeoff`.
//!
//! A world is one file that implements [`World`]; [`worlds`] lists them. Cases with an exact answer are in `exact`.
#![allow(clippy::print_stderr, reason = "progress is for the person who waits")]
#![allow(clippy::disallowed_methods, reason = "it measures time")]

mod bins;
mod exact;
mod measure;
mod plots;
mod world;

use measure::{Row, measure};
use plaus_figures::Result;
use plaus_figures::report::{significant, table};
use std::fmt::Write as _;
use std::path::PathBuf;
use world::{Way, World};

const USAGE: &str = "usage: cargo xtask tradeoff [--out FOLDER] [--draws N] [--quick]\n\n\
    --out FOLDER   where the files go, out/tradeoff by default\n\
    --draws N      draws per distribution, 2000 by default\n\
    --quick        100 draws: shows that everything works, its numbers mean little";

/// Worlds with a distribution of outcomes.
fn worlds() -> Result<Vec<Box<dyn World>>> {
    Ok(vec![Box::new(bins::MarblesOverBins::new()?)])
}

fn main() -> Result<()> {
    let (mut out, mut draws) = (PathBuf::from("out/tradeoff"), 2000);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--quick" => draws = 100,
            "--out" => out = arguments.next().ok_or(USAGE)?.into(),
            "--draws" => draws = arguments.next().ok_or(USAGE)?.parse()?,
            _ => return Err(USAGE.into()),
        }
    }
    std::fs::create_dir_all(&out)?;
    let mut text = "# What exactness costs\n\nMade by `cargo xtask tradeoff`. Draws and outcomes follow from fixed seeds; times are medians of one core of this machine, in one process.\n".to_owned();
    text += "\n## Against exact answers\n\n";
    text += &exact::report()?;
    for mut world in worlds()? {
        let rows = measure(world.as_mut(), draws)?;
        write!(text, "\n## {}\n\n{}\n\n", world.title(), world.about())?;
        text += &show(&rows, draws);
        plots::cost_and_distance(&out, world.name(), world.title(), &rows)?;
        write!(text, "\n![{0}]({0}.png)\n", world.name())?;
    }
    std::fs::write(out.join("report.md"), &text)?;
    eprintln!("{text}\nwrote {}", out.join("report.md").display());
    Ok(())
}

fn show(rows: &[Row], draws: u64) -> String {
    let millimetres = |x: Option<f64>| x.map_or("–".to_owned(), |x| significant(1000.0 * x, 2));
    let cells = rows.iter().map(|r| {
        vec![
            r.way.name(),
            significant(1000.0 * r.seconds, 3),
            significant(1000.0 * r.early, 2),
            millimetres(r.error),
            r.agreement.map_or("–".to_owned(), |t| significant(t, 3)),
            significant(r.distance, 2),
            significant(r.noise, 2),
        ]
    });
    let text = table(
        &["simulator", "ms, median", "ms, 10%", "error at 0.25 s, mm", "agrees for, s", "distance", "its noise"],
        cells,
    );
    format!(
        "{text}\nError: median over draws of the largest distance of a body from where the reference preset has it, 0.25 s after the start. Agrees for: median time until a body is a tenth of its radius \
         away. Distance: total variation between {draws} outcomes and {draws} of the reference; noise: what two samples of the same law would show on average.\n"
    )
}

impl Way {
    fn name(&self) -> String {
        match self {
            Self::Preset(preset) => format!("plaus-sim, {}", preset.name()),
            Self::Peer(rate) => format!("rapier3d-f64, 1/{rate}"),
        }
    }
}
