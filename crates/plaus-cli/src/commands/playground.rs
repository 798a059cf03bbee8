//! `plaus playground`

use crate::failure::{Failure, Outcome};
use crate::{console, scenario_file};
use plaus_export::ours;
use plaus_gallery::{HEAD, playground};
use plaus_run::Error;
use plaus_run::export::output;
use std::path::{Path, PathBuf};

/// Which scenario to begin with, and to which file.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Scenario file whose text the page begins with; files of shapes that it names go with it
    scenario: PathBuf,
    /// The page to make: one HTML file that needs nothing else
    #[arg(long, alias = "output", value_name = "FILE.html")]
    out: PathBuf,
    /// Replace what is there, if plaus made it
    #[arg(long)]
    force: bool,
}

impl Args {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        super::name_fits(&self.out, "a page", &["html", "htm"])?;
        let recipe = scenario_file::read(&self.scenario, Vec::new(), None)?;
        let page = playground(&recipe.text, &recipe.scenario).map_err(Failure::Message)?;
        let name = self.out.display().to_string();
        let is_ours = |path: &Path| ours::begins_with(path, HEAD.as_bytes());
        output::file(&self.out, self.force, is_ours, |out| out.write_all(page.as_bytes()).map_err(Error::Output))
            .map_err(|error| Failure::from(error).about(&name))?;
        console::note_line(&format!("{name}: {:.1} MB; open it in a browser", page.len() as f64 / 1e6));
        Ok(Outcome::Done)
    }
}
