//! Files beside a scenario.

use crate::manifest::Manifest;
use plaus_scenes::Files;
use plaus_scenes::files::{hash_of, whole};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The folder of a scenario, from which [`Scenario::read_with`](plaus_scenes::Scenario::read_with) reads files.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ScenarioFolder(PathBuf);

impl ScenarioFolder {
    /// The folder that the scenario at `path` lies in.
    #[must_use]
    pub fn of(path: &Path) -> Self {
        Self(crate::folder::parent_of(path))
    }
}

impl Files for ScenarioFolder {
    fn bytes(&self, path: &str, anywhere: bool) -> Result<Arc<[u8]>, String> {
        let cannot = |error: std::io::Error| format!("cannot read it: {error}");
        let path = self.0.join(path);
        // The target of a link counts, not its name.
        let whole = path.canonicalize().map_err(cannot)?;
        if !anywhere && !whole.starts_with(self.0.canonicalize().map_err(cannot)?) {
            let outside = whole.display();
            return Err(format!(
                "it leads out of the scenario's folder, to {outside}: to allow that, set `anywhere = true`"
            ));
        }
        let file = File::open(&whole).map_err(cannot)?;
        let about = file.metadata().map_err(cannot)?;
        let most = plaus_scenes::files::MOST_BYTES as u64;
        if !about.is_file() {
            return Err("it is not a file".into());
        }
        if about.len() > most {
            return Err(format!("it has {} bytes: at most {most} are allowed", about.len()));
        }
        let mut bytes = Vec::with_capacity(about.len() as usize);
        file.take(most).read_to_end(&mut bytes).map_err(cannot)?;
        Ok(bytes.into())
    }
}

/// The files of a run that were edited after it began: those in `folder` that differ from the run's copies, the
/// scenario among them. None if the folder does not hold a scenario of that name.
#[must_use]
pub fn edited(manifest: &Manifest, folder: &Path) -> Vec<String> {
    let files = ScenarioFolder(folder.to_owned());
    let Ok(text) = files.bytes(&manifest.scenario.file, true) else { return Vec::new() };
    let scenario = (*text != *manifest.scenario.text.as_bytes()).then(|| manifest.scenario.file.clone());
    let differs = |path: &str, hash: &str| whole(&files, path, true).is_ok_and(|bytes| hash_of(&bytes) != hash);
    let edited = manifest.assets.iter().filter(|(path, hash)| differs(path, hash));
    scenario.into_iter().chain(edited.map(|(path, _)| path.clone())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn files_are_read_beside_the_scenario_and_nowhere_else() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("worlds");
        fs::create_dir_all(folder.join("shapes")).unwrap();
        fs::write(place.path().join("secret.obj"), "secret").unwrap();
        fs::write(folder.join("shapes/cup.obj"), "cup").unwrap();
        let files = ScenarioFolder::of(&folder.join("world.toml"));
        assert_eq!(&*files.bytes("shapes/cup.obj", false).unwrap(), b"cup");
        assert!(files.bytes("shapes", false).unwrap_err().contains("not a file"));
        assert!(files.bytes("cup.obj", false).unwrap_err().contains("cannot read"));
        assert!(files.bytes("../secret.obj", false).unwrap_err().contains("leads out"));
        assert_eq!(&*files.bytes("../secret.obj", true).unwrap(), b"secret");
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("../secret.obj", folder.join("link.obj")).unwrap();
            assert!(files.bytes("link.obj", false).unwrap_err().contains("leads out"));
        }
        let long = fs::File::create(folder.join("long.stl")).unwrap();
        long.set_len(1 << 30).unwrap();
        assert!(files.bytes("long.stl", false).unwrap_err().contains("1073741824 bytes: at most 268435456"));
    }
}
