//! `plaus gallery`

use super::export::until;
use crate::console;
use crate::failure::{Failure, Outcome};
use crate::table::counted;
use crate::waiting::Waiting;
use plaus_export::ours;
use plaus_gallery::{Gallery, HEAD, Options, gallery};
use plaus_run::export::output;
use plaus_run::{Error, RunReader};
use plaus_scenes::Until;
use std::path::{Path, PathBuf};

/// Pages longer than this, in bytes, open slowly.
const LONG: usize = 25 << 20;

/// Which run, how many solutions, and to which file.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Folder of the run
    run: PathBuf,
    /// The page to make: one HTML file that needs nothing else
    #[arg(long, alias = "output", value_name = "FILE.html")]
    out: PathBuf,
    /// Maximum number of solutions to show; they are chosen to differ as much as possible
    #[arg(long, value_name = "N", default_value_t = SHOWN, value_parser = clap::value_parser!(u32).range(1..=5000))]
    count: u32,
    /// Where each animation ends: `rest`, when everything is at rest; `decided`, once it is certain whether it is a
    /// solution, such as which pins stand; or after a time, such as 5s [default: rest; in bowling, decided]
    #[arg(long, value_name = "rest|decided|SECONDSs", value_parser = until)]
    until: Option<Until>,
    /// The page goes on sampling where the run ended, for as long as it is open, and adds what looks clearly different
    #[arg(long)]
    live: bool,
    /// Replace what is there, if `plaus gallery` made it
    #[arg(long)]
    force: bool,
    /// Read a damaged run as far as it is intact, and report what is lost
    #[arg(long)]
    salvage: bool,
}

/// Makes the page of a run, and says meanwhile that it does.
pub(super) fn page(run: &RunReader<'_>, out: &Path, force: bool, options: &Options) -> Result<Gallery, Failure> {
    let name = out.display().to_string();
    let is_ours = |path: &Path| ours::begins_with(path, HEAD.as_bytes());
    let mut made = None;
    let waiting = Waiting::on(format!("simulating and drawing solutions for {name}"));
    let written = output::file(out, force, is_ours, |out| {
        let page = made.insert(gallery(run, options)?);
        out.write_all(page.html.as_bytes()).map_err(Error::Output)
    });
    drop(waiting);
    let made = written.and_then(|()| made.ok_or_else(|| Error::Request("nothing was written".to_owned())));
    made.map_err(|error| Failure::from(error).about(&name))
}

/// Most solutions that a page shows, unless it is told how many.
pub(super) const SHOWN: u32 = 64;

impl Args {
    fn write(&self, run: &RunReader<'_>) -> Result<Gallery, Failure> {
        let options = Options {
            count: self.count as usize,
            run: self.run.display().to_string(),
            until: self.until,
            live: self.live,
        };
        page(run, &self.out, self.force, &options)
    }

    pub(super) fn run(self) -> Result<Outcome, Failure> {
        super::name_fits(&self.out, "a gallery", &["html", "htm"])?;
        let run = super::opened(&self.run, self.salvage, "shows")?;
        let reader = run.reader()?;
        if super::diagnose::draws_that_count(&reader) == 0 {
            return Err(super::no_draws(&reader));
        }
        let out = self.out.display().to_string();
        let made = self.write(&reader)?;
        let (shown, distinct, size) = (made.shown, made.distinct, made.html.len());
        console::note_line(&format!(
            "{out}: {shown} of {}, {:.1} MB; open it in a browser",
            counted(distinct as u64, "distinct solution"),
            size as f64 / 1e6
        ));
        if size > LONG {
            console::note_line("warning: a page of this size opens slowly; choose a smaller --count");
        }
        Ok(Outcome::Done)
    }
}
