//! `plaus export`

use crate::console;
use crate::failure::{Failure, Outcome};
use plaus_run::export::{csv, output, zarr};
use plaus_run::{Error, Folder, Run, RunOf, RunVisitor};
use plaus_scenes::Scene;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Which run, in which format, where to.
#[derive(clap::Args)]
#[command(
    after_long_help = "csv: one row per chain and draw of the sampling phase, with columns chain, draw (from 0), log_p, satisfied (true or \
    false), then one per scalar of the scene. For ball2d: rest_x in ball diameters D, theta_1 ... in degrees.\n\
    zarr: a Zarr v3 folder for ArviZ: az.from_zarr(PATH) (1.x), or az.from_datatree(xarray.open_datatree(PATH, engine=\"zarr\")) (0.23)."
)]
pub(crate) struct Args {
    /// Folder of the run
    run: PathBuf,
    /// csv or zarr
    #[arg(long, value_enum)]
    format: Format,
    /// File or folder to make; `-` writes csv to standard output
    #[arg(long, value_name = "PATH")]
    out: PathBuf,
    /// Replace what is there, if such an export made it
    #[arg(long)]
    force: bool,
    /// Read a damaged run up to its first damage
    #[arg(long)]
    salvage: bool,
}

/// A format of export.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Format {
    /// A table.
    Csv,
    /// A folder for ArviZ.
    Zarr,
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
        }
    }
}

impl Args {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let mut run = Run::open(&Folder::new(&self.run))?;
        if self.salvage {
            run = run.salvaged();
        } else if run.folder().is_being_written() {
            console::note_line("note: the run is being written; this exports it as of its last checkpoint");
        }
        if run.visit(super::diagnose::CountDraws)? == 0 {
            return Err(plaus_run::RunFileError::new(&self.run, plaus_run::RunFileProblem::Empty).into());
        }
        let written = run.visit(&self)?;
        written.map_err(|error| Failure::from(error).about(&self.out.display().to_string()))?;
        Ok(Outcome::Done)
    }
}
