//! Scenario files from the disk.

use crate::console;
use crate::failure::Failure;
use plaus_run::{Error, Manifest, Recipe, ScenarioFolder};
use plaus_scenes::Scenario;
use plaus_scenes::registry::NAMES;
use plaus_scenes::scenario::{ScenarioError, nearest};
use std::collections::BTreeSet;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Longest scenario file that is read, in bytes.
const LONGEST: u64 = 16 << 20;

/// Endings of files from which `plaus new --from` makes scenarios.
const MODELS: [&str; 10] = ["glb", "gltf", "obj", "stl", "usd", "usda", "usdc", "usdz", "xml", "urdf"];

/// Reads a scenario, with overrides applied. The recipe holds the file's name without its folder, so that a run does
/// not depend on the folder it was started in.
pub(crate) fn read(path: &Path, overrides: Vec<String>, solutions: Option<u64>) -> Result<Recipe, Failure> {
    let shown = path.display().to_string();
    let refuse = |what: String| Failure::Message(format!("{shown}: {what}"));
    let ending = path.extension().map(|end| end.to_string_lossy().to_lowercase()).unwrap_or_default();
    if MODELS.contains(&ending.as_str()) {
        return Err(refuse(format!("is a model, not a scenario; `plaus new --from {shown}` makes a scenario of it")));
    }
    let mut bytes = Vec::new();
    let read = File::open(path).and_then(|file| file.take(LONGEST + 1).read_to_end(&mut bytes));
    read.map_err(|error| {
        let known = NAMES.contains(&shown.as_str());
        let advice = match error.kind() {
            _ if known => format!("; `plaus new {shown} {shown}.toml` writes one"),
            std::io::ErrorKind::NotFound if let Some(near) = near(path) => format!("; did you mean `{near}`?"),
            std::io::ErrorKind::NotFound => "; `plaus new custom FILE.toml` writes one to begin with".to_owned(),
            _ => String::new(),
        };
        refuse(format!("cannot read the scenario: {error}{advice}"))
    })?;
    if bytes.len() as u64 > LONGEST {
        return Err(refuse(format!("longer than {LONGEST} bytes, the most that a scenario may have")));
    }
    let text = ScenarioError::decode(&shown, bytes)?;
    let scenario = Scenario::read_with(&shown, &text, &overrides, &ScenarioFolder::of(path))?;
    let file = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    Ok(Recipe { scenario, file, text, overrides, solutions })
}

/// The scenario file in the same folder whose name is most like this one's, if any is.
fn near(path: &Path) -> Option<String> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let names = std::fs::read_dir(folder).ok()?.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let mut stems: Vec<String> = names.filter_map(|name| Some(name.strip_suffix(".toml")?.to_owned())).collect();
    stems.sort_unstable();
    let near = nearest(path.file_stem()?.to_str()?, stems.iter().map(String::as_str))?;
    Some(path.with_file_name(format!("{near}.toml")).display().to_string())
}

/// Where the scenario of a run at `path` may lie: beside the run, in the current folder, in a folder `scenarios` of
/// these, or in a folder of that.
fn folders_of(path: &Path) -> BTreeSet<PathBuf> {
    let beside = path.canonicalize().ok().and_then(|path| path.parent().map(Path::to_owned));
    let mut folders: BTreeSet<PathBuf> = beside.into_iter().chain(std::env::current_dir()).collect();
    let inner: Vec<PathBuf> = folders.iter().map(|folder| folder.join("scenarios")).collect();
    let entries = inner.iter().filter_map(|folder| std::fs::read_dir(folder).ok()).flatten().flatten();
    let deeper = entries.filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_dir())).map(|entry| entry.path());
    folders.extend(deeper.chain(inner.iter().cloned()));
    folders
}

/// Tells which files of a run at `path`, its scenario among them, were edited after it began.
pub(crate) fn tell_edited(manifest: &Manifest, path: &Path) {
    let folders = folders_of(path);
    let edited: BTreeSet<_> = folders.iter().flat_map(|folder| plaus_run::edited(manifest, folder)).collect();
    for file in edited {
        console::remark(&format!(
            "{file} has changed since this run began: the run uses its own copy; `plaus sample` makes a run \
             of the new one"
        ));
    }
}

/// An error, with its line where the scenario is at fault.
pub(crate) fn located(error: Error, scenario: &Path, recipe: &Recipe) -> Failure {
    match error {
        Error::Config(error) => ScenarioError::locate(&scenario.display().to_string(), &recipe.text, &error).into(),
        other => other.into(),
    }
}
