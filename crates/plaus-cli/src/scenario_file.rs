//! Scenario files from the disk.

use crate::failure::Failure;
use plaus_run::Recipe;
use plaus_scenes::Scenario;
use plaus_scenes::registry::NAMES;
use plaus_scenes::scenario::ScenarioError;
use std::path::Path;

/// Longest scenario file that is read, in bytes.
const LONGEST: u64 = 16 << 20;

/// Reads a scenario, with overrides in force. The name of the file in the recipe is without its folder, so that a run does not depend on where
/// it was started.
pub(crate) fn read(path: &Path, overrides: Vec<String>, solutions: Option<u64>) -> Result<Recipe, Failure> {
    let shown = path.display().to_string();
    let refuse = |what: String| Failure::Message(format!("{shown}: {what}"));
    let meta = std::fs::metadata(path).map_err(|error| {
        let known = NAMES.contains(&shown.as_str());
        let advice = if known { format!("; `plaus new {shown} {shown}.toml` writes one") } else { String::new() };
        refuse(format!("cannot read the scenario: {error}{advice}"))
    })?;
    if meta.len() > LONGEST {
        return Err(refuse(format!("{} bytes are too many for a scenario", meta.len())));
    }
    let bytes = std::fs::read(path).map_err(|error| refuse(format!("cannot read the scenario: {error}")))?;
    let text = ScenarioError::decode(&shown, bytes)?;
    let scenario = Scenario::read(&shown, &text, &overrides)?;
    let file = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    Ok(Recipe { scenario, file, text, overrides, solutions })
}
