//! `plaus new`

use crate::console::{self, quoted};
use crate::failure::{Failure, Outcome};
use crate::output;
use plaus_scenes::registry::NAMES;
use plaus_scenes::scenario::{self, SCHEMA_FILE};
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Which scene, and where to.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Name of the scene, e.g. ball2d
    scene: String,
    /// File to write; nothing, or `-`, writes to standard output. Never overwritten
    file: Option<PathBuf>,
}

impl Args {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let unknown = || {
            let near = scenario::nearest(&self.scene, NAMES.iter().copied());
            let near = near.map(|near| format!("did you mean `{near}`? ")).unwrap_or_default();
            Failure::Message(format!("there is no scene `{}`; {near}known: {}", self.scene, NAMES.join(", ")))
        };
        let text = scenario::template(&self.scene).ok_or_else(unknown)?;
        // Editors that know TOML read the schema that this line names.
        let text = format!("#:schema ./{SCHEMA_FILE}\n{text}");
        match self.file.filter(|file| file != Path::new("-")) {
            None => output::print(&text)?,
            Some(file) => {
                let refuse = |error: io::Error| {
                    let advice = match error.kind() {
                        io::ErrorKind::AlreadyExists => "exists already; choose another name".to_owned(),
                        _ => format!("cannot write: {error}"),
                    };
                    Failure::Message(format!("{}: {advice}", file.display()))
                };
                let mut out = File::create_new(&file).map_err(refuse)?;
                out.write_all(text.as_bytes()).map_err(refuse)?;
                write_schema(&file);
                console::note_line(&format!("wrote {0}; next: plaus sample {0} --out run", quoted(&file)));
            }
        }
        Ok(Outcome::Done)
    }
}

/// Writes the schema beside a scenario, where there is none: with it an editor completes and explains keys, without
/// it nothing is lost.
fn write_schema(scenario: &Path) {
    let path = scenario.with_file_name(SCHEMA_FILE);
    if let Ok(mut out) = File::create_new(&path) {
        let written = out.write_all(format!("{:#}\n", scenario::published_schema()).as_bytes());
        if written.is_ok() {
            console::note_line(&format!("wrote {}, which editors complete keys by", quoted(&path)));
        }
    }
}
