//! `plaus export`

mod animations;

use crate::console;
use crate::failure::{Failure, Outcome};
use animations::Animations;
use plaus_run::export::{csv, output, zarr};
use plaus_run::{Error, Folder, Run, RunOf, RunVisitor, SampleId};
use plaus_scenes::Scene;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Which run, in which format, where to.
#[derive(clap::Args)]
#[command(
    after_long_help = "csv: one row per chain and draw of the sampling phase, with columns chain, draw (from 0), log_p, \
    satisfied (true or false), then one per scalar of the scene. \
    For ball2d: rest_x in ball diameters D, theta_1 ... in degrees.\n\
    zarr: a Zarr v3 folder for ArviZ: az.from_zarr(PATH) (1.x), or \
    az.from_datatree(xarray.open_datatree(PATH, engine=\"zarr\")) (0.23).\n\
    glb: animated glTF 2.0 with a key at every impact, and beside it PATH.import for Godot. usda: USD as text. \
    One sample makes a file, several make a folder.\n\
    poses: one row per sample, body and key: chain, draw, t (s), body, x, y, z (m, y up), a unit quaternion, \
    and whether it is at an impact.\n\
    events: one row per impact: chain, draw, t (s), the pair, point (m), normal, speed of approach (m/s), \
    impulse (N s; 0 where the scene has no masses). As JSON where PATH ends in .json.\n\
    Times count from the beginning of --time-range."
)]
pub(crate) struct Args {
    /// Folder of the run
    run: PathBuf,
    /// What to write
    #[arg(long, value_enum)]
    format: Format,
    /// File or folder to make; `-` writes csv, poses and events to standard output
    #[arg(long, alias = "output", value_name = "PATH")]
    out: PathBuf,
    /// A sample to animate, its chain and its draw, as in the table, e.g. 0:17; may be given several times
    #[arg(long, value_name = "CHAIN:DRAW")]
    sample: Vec<SampleId>,
    /// Animate one sample of each distinct satisfying solution
    #[arg(long, conflicts_with = "sample")]
    all_distinct: bool,
    /// Animate one sample of each distinct solution that `--confirm` found to hold
    #[arg(long, conflicts_with_all = ["sample", "all_distinct"])]
    confirmed: bool,
    /// Keys per second, besides those at every impact [default: 60]
    #[arg(long)]
    fps: Option<f64>,
    /// Animate only from FROM to TO, in seconds
    #[arg(long, value_name = "FROM:TO", value_parser = range)]
    time_range: Option<(f64, f64)>,
    /// Replace what is there, if such an export made it
    #[arg(long)]
    force: bool,
    /// Read a damaged run as far as it is intact, and say what is lost
    #[arg(long)]
    salvage: bool,
}

/// A format of export.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Format {
    /// A table of draws.
    Csv,
    /// A folder of draws for ArviZ.
    Zarr,
    /// Animated glTF.
    Glb,
    /// Animated USD.
    Usda,
    /// A table of poses.
    Poses,
    /// A list of impacts.
    Events,
}

fn range(text: &str) -> Result<(f64, f64), String> {
    let parts = text.split_once(':').and_then(|(from, to)| Some((from.parse().ok()?, to.parse().ok()?)));
    parts.ok_or_else(|| format!("`{text}` is no range: write FROM:TO in seconds, e.g. 0.5:2"))
}

impl Format {
    fn is_animation(self) -> bool {
        !matches!(self, Self::Csv | Self::Zarr)
    }

    /// What a program would take a file of this name for, and this format is not.
    fn contradicts(self, out: &Path) -> Option<(String, &'static str)> {
        let end = out.extension()?.to_str()?.to_ascii_lowercase();
        let (holds, fits) = match end.as_str() {
            "glb" => ("binary glTF, which --format glb writes", self == Self::Glb),
            "gltf" => ("glTF as text: --format glb writes it as one binary file, .glb", false),
            "usda" => ("USD as text, which --format usda writes", self == Self::Usda),
            "usd" | "usdc" | "usdz" => ("USD in another form: --format usda writes it as text, .usda", false),
            "csv" => ("a table: --format csv, poses or events", !matches!(self, Self::Zarr | Self::Glb | Self::Usda)),
            "json" => ("JSON, which --format events writes", self == Self::Events),
            "zarr" => ("draws for ArviZ, which --format zarr writes", self == Self::Zarr),
            _ => return None,
        };
        (!fits).then_some((end, holds))
    }
}

impl RunVisitor for &Args {
    type Output = Result<(), Error>;
    fn visit<S: Scene>(self, run: RunOf<'_, S>) -> Self::Output {
        match (self.format, self.out == Path::new("-")) {
            (Format::Csv, true) => {
                let mut out = BufWriter::with_capacity(1 << 16, io::stdout().lock());
                csv::write(&run, &mut out)?;
                out.flush().map_err(Error::Output)
            }
            (Format::Csv, false) => output::file(&self.out, self.force, csv::is_ours, |out| csv::write(&run, out)),
            (Format::Zarr, true) => Err(Error::Request("a Zarr export is a folder: name one by --out PATH".to_owned())),
            (Format::Zarr, false) => output::folder(&self.out, self.force, zarr::is_ours, |out| zarr::write(&run, out)),
            _ => Animations::new(&run, self)?.write(),
        }
    }
}

impl Args {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        self.check()?;
        let mut run = Run::open(&Folder::new(&self.run))?;
        if self.salvage {
            run = run.salvaged();
            console::note_line(&run.visit(super::Salvage)?);
        } else if run.folder().is_being_written() {
            console::note_line("note: the run is being written; this exports it as of its last checkpoint");
        }
        if run.visit(super::diagnose::CountDraws)? == 0 {
            return Err(plaus_run::RunFileError::new(&self.run, plaus_run::RunFileProblem::Empty).into());
        }
        let written = run.visit(&self)?;
        let out = self.out.display().to_string();
        written.map_err(|error| Failure::from(error).about(&out))?;
        if self.out != Path::new("-") {
            console::note_line(&format!("wrote {out}"));
        }
        Ok(Outcome::Done)
    }

    /// Whether the flags go together.
    fn check(&self) -> Result<(), Failure> {
        let chosen = !self.sample.is_empty() || self.all_distinct || self.confirmed;
        let timed = self.fps.is_some() || self.time_range.is_some();
        if self.format.is_animation() && !chosen {
            let message = "an animation needs a sample: --sample CHAIN:DRAW, --all-distinct, or --confirmed";
            return Err(Failure::Message(message.to_owned()));
        }
        if let Some((end, holds)) = self.format.contradicts(&self.out) {
            let message =
                format!("{}: a file that ends in .{end} holds {holds}; choose another name", self.out.display());
            return Err(Failure::Message(message));
        }
        if !self.format.is_animation() && (chosen || timed) {
            let message = "--sample, --all-distinct, --confirmed, --fps and --time-range go with glb, usda, poses and events: csv and zarr hold all draws";
            return Err(Failure::Message(message.to_owned()));
        }
        Ok(())
    }
}
