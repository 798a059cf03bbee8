//! `plaus new`

use super::moving;
use crate::console::{self, quoted};
use crate::failure::{Failure, Outcome};
use crate::output;
use plaus_run::ScenarioFolder;
use plaus_scenes::import::{self, Choice};
use plaus_scenes::scenario::{self, SCHEMA_FILE};
use std::fs::File;
use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};

/// Which scene, and to which file.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Name of the scene, e.g. ball2d. With --from: the file to write [default: beside the asset, with its name]
    scene: Option<String>,
    /// File to write; it is never overwritten. Without it, or with `-`, writes to standard output
    #[arg(conflicts_with = "from")]
    file: Option<PathBuf>,
    /// Make a world from this file of shapes (.glb, .gltf, .obj, .stl), stage in USD (.usd, .usda, .usdc, .usdz), or
    /// model in MJCF (.xml) or URDF (.urdf), and list what it leaves out
    #[arg(long, value_name = "ASSET")]
    from: Option<PathBuf>,
    /// With --from an .obj or .stl: how many millimetres its unit is [default: 1000 if everything in it is less than 10
    /// units across, otherwise 1]
    #[arg(long, value_name = "MM", requires = "from")]
    unit_mm: Option<f64>,
    /// With --from: write nothing if something that changes motion would be left out or replaced
    #[arg(long, requires = "from")]
    strict: bool,
    /// With --from: objects that move, by name; `*` stands for any text, commas separate several: 'Ball,Can_*'. On a
    /// terminal, `plaus new` asks if the file does not say
    #[arg(long, value_name = "NAMES", value_delimiter = ',', requires = "from")]
    moving: Vec<String>,
    /// With --from: objects that follow their keyframes, likewise
    #[arg(long, value_name = "NAMES", value_delimiter = ',', requires = "from")]
    driven: Vec<String>,
    /// With --from: objects to leave out, likewise
    #[arg(long, value_name = "NAMES", value_delimiter = ',', requires = "from")]
    ignore: Vec<String>,
}

impl Args {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        if let Some(asset) = &self.from {
            let file = self.scene.map_or_else(|| asset.with_extension("toml"), PathBuf::from);
            let choice = Choice { moving: self.moving, driven: self.driven, ignored: self.ignore };
            return of_asset(asset, &file, self.unit_mm, self.strict, choice);
        }
        if let Some(file) = self.file.as_deref().filter(|file| file.extension().is_some_and(|of| of != "toml")) {
            let toml = file.with_extension("toml");
            return Err(Failure::Message(format!(
                "a scenario is a TOML file, and `{}` has another ending; `{}` would do",
                file.display(),
                toml.display()
            )));
        }
        let Some(name) = self.scene else {
            let scenes = plaus_scenes::registry::NAMES.join(", ");
            return Err(Failure::Message(format!("name a scene: {scenes}; or a file of shapes: --from ASSET")));
        };
        let text = scenario::starter(&name).ok_or_else(|| Failure::Message(scenario::no_scene(&name)))?;
        write(&text, self.file.as_deref())
    }
}

/// Writes a scenario made from a file of shapes or a model.
fn of_asset(asset: &Path, file: &Path, unit_mm: Option<f64>, strict: bool, choice: Choice) -> Result<Outcome, Failure> {
    let refuse = |what: String| Failure::Message(format!("{}: {what}", asset.display()));
    let (path, anywhere) = from_folder(asset, file).map_err(|error| refuse(format!("cannot read it: {error}")))?;
    let made = |choice: &Choice| {
        let made = import::chosen(&path, anywhere, unit_mm, choice, &ScenarioFolder::of(file));
        made.map_err(|error| refuse(error.to_string()))
    };
    let mut imported = made(&choice)?;
    if !imported.still.is_empty() {
        let moving = match io::stdin().is_terminal() && console::is_live() {
            true => moving::ask(&imported.still, &mut io::stdin().lock()),
            false => Vec::new(),
        };
        if moving.is_empty() {
            console::note_line(&moving::how_to_say(&imported.still));
        } else {
            let words = console::quoted_word(&moving.join(","));
            console::note_line(&format!("without the question: --moving {words}"));
            imported = made(&Choice { moving, ..choice })?;
        }
    }
    imported.notes.iter().for_each(|note| console::note_line(note));
    for what in imported.left_out.iter().take(MOST_LINES) {
        console::note_line(&format!("not taken over: {what}"));
    }
    let (count, harmless) = (imported.left_out.len(), imported.harmless.len());
    if count > MOST_LINES {
        let more = count - MOST_LINES;
        console::note_line(&format!("not taken over: {more} more, which the scenario lists in its first comment"));
    }
    if count > 0 || harmless > 0 {
        let things = |count: usize| if count == 1 { "1 thing".to_owned() } else { format!("{count} things") };
        console::note_line(&format!(
            "not taken over: {} that may change how things move, and {} of no bearing on that",
            things(count),
            things(harmless)
        ));
    }
    if strict && count > 0 {
        return Err(refuse(format!(
            "--strict: what may change how things move was not taken over ({count}, see above): take it out of the \
             file, or leave out --strict"
        )));
    }
    write(&imported.text, Some(file))
}

/// Most lines about what was left out on a terminal.
const MOST_LINES: usize = 20;

/// The path under which a scenario names an asset: relative to the scenario's folder if it lies there, absolute
/// otherwise.
fn from_folder(asset: &Path, scenario: &Path) -> io::Result<(String, bool)> {
    let folder = scenario.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let (whole, folder) = (asset.canonicalize()?, folder.canonicalize()?);
    let shown = |path: &Path| path.to_string_lossy().replace('\\', "/");
    Ok(whole.strip_prefix(&folder).map_or_else(|_| (shown(&whole), true), |inner| (shown(inner), false)))
}

/// Writes a scenario to a file, or to standard output.
fn write(text: &str, file: Option<&Path>) -> Result<Outcome, Failure> {
    // Editors that know TOML read the schema named in this line.
    let text = format!("#:schema ./{SCHEMA_FILE}\n{text}");
    match file.filter(|file| *file != Path::new("-")) {
        None => output::print(&text)?,
        Some(file) => {
            let refuse = |error: io::Error| {
                let advice = match error.kind() {
                    io::ErrorKind::AlreadyExists => {
                        "already exists; choose another name, or delete it first".to_owned()
                    }
                    _ => format!("cannot write: {error}"),
                };
                Failure::Message(format!("{}: {advice}", file.display()))
            };
            let mut out = File::create_new(file).map_err(refuse)?;
            out.write_all(text.as_bytes()).map_err(refuse)?;
            write_schema(file);
            console::note_line(&format!("wrote {0}; next: plaus try {0}", quoted(file)));
        }
    }
    Ok(Outcome::Done)
}

/// Writes the schema beside a scenario, if there is none yet. Editors use it to complete and explain keys; nothing else
/// needs it.
fn write_schema(scenario: &Path) {
    let path = scenario.with_file_name(SCHEMA_FILE);
    if let Ok(mut out) = File::create_new(&path) {
        let written = out.write_all(format!("{:#}\n", scenario::published_schema()).as_bytes());
        if written.is_ok() {
            console::note_line(&format!("wrote {}: editors use it to complete keys", quoted(&path)));
        }
    }
}
