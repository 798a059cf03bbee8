//! Files that a scenario names, such as shapes. The reader of the scenario decides where they come from.

pub use plaus_asset::{AssetError, Content, Format, MOST_BYTES, Object, Triangles};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

/// Where the files that a scenario names are read from.
pub trait Files {
    /// The bytes of the file at `path`, as written in the scenario: relative to the scenario's folder, with `/` between
    /// folders. It must not leave that folder unless `anywhere` allows it.
    ///
    /// # Errors
    ///
    /// Why it cannot be read, in words that follow its name.
    fn bytes(&self, path: &str, anywhere: bool) -> Result<Arc<[u8]>, String>;

    /// The shapes in the file at `path`. Programs without readers of such files have what was read of them before.
    ///
    /// # Errors
    ///
    /// Why it cannot be read, in words that follow its name.
    fn asset(&self, path: &str, anywhere: bool) -> Result<Asset, String> {
        Asset::read(path, whole(self, path, anywhere)?).map_err(|error| error.to_string())
    }
}

impl<F: Fn(&str, bool) -> Result<Arc<[u8]>, String>> Files for F {
    fn bytes(&self, path: &str, anywhere: bool) -> Result<Arc<[u8]>, String> {
        self(path, anywhere)
    }
}

/// No files at all, for scenarios that are only text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NoFiles;

impl Files for NoFiles {
    fn bytes(&self, _: &str, _: bool) -> Result<Arc<[u8]>, String> {
        Err("a scenario that is read only as text cannot name files".into())
    }
}

/// Files in memory, by their paths: all that a scenario names.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Assets(BTreeMap<String, Arc<[u8]>>);

impl Assets {
    /// Adds a file; another of the same path is replaced.
    pub fn insert(&mut self, path: impl Into<String>, bytes: impl Into<Arc<[u8]>>) {
        self.0.insert(path.into(), bytes.into());
    }

    /// All paths, each with its bytes.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &Arc<[u8]>)> {
        self.0.iter().map(|(path, bytes)| (path.as_str(), bytes))
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl Files for Assets {
    fn bytes(&self, path: &str, _: bool) -> Result<Arc<[u8]>, String> {
        self.0.get(path).cloned().ok_or_else(|| "it is not among the files that came with the scenario".into())
    }
}

/// A file of shapes that was read.
#[derive(Clone)]
pub struct Asset {
    /// Its bytes; none if only what was read of them is known.
    pub bytes: Arc<[u8]>,
    /// BLAKE3 of its bytes, in hexadecimal digits.
    pub hash: String,
    /// What was read of it.
    pub content: Content,
}

impl Asset {
    /// Reads a file whose name tells its format.
    ///
    /// # Errors
    ///
    /// [`AssetError`] as of [`plaus_asset::read`].
    pub fn read(path: &str, bytes: Arc<[u8]>) -> Result<Self, AssetError> {
        let content = plaus_asset::read(path, &bytes)?;
        Ok(Self { hash: hash_of(&bytes), bytes, content })
    }
}

impl fmt::Debug for Asset {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Asset({})", self.hash)
    }
}

/// The bytes of a file of shapes: of a `.gltf`, a GLB of it and of its buffers, which are files beside it; of USD, a
/// GLB of what its layers have together.
///
/// # Errors
///
/// Why it, or a file that it names, cannot be read, in words that follow its name.
pub fn whole(files: &(impl Files + ?Sized), path: &str, anywhere: bool) -> Result<Arc<[u8]>, String> {
    let bytes = files.bytes(path, anywhere)?;
    let ending = path.rsplit_once('.').map_or("", |(_, ending)| ending);
    let is_gltf = ending.eq_ignore_ascii_case("gltf");
    if (!is_gltf && !Format::is_usd(path)) || bytes.starts_with(b"glTF") {
        return Ok(bytes);
    }
    let folder = path.rfind(['/', '\\']).map_or("", |end| &path[..=end]);
    let mut open = |file: &str| {
        let is_absolute = file.starts_with('/') || file.as_bytes().get(1) == Some(&b':');
        let file = if is_absolute { file.to_owned() } else { format!("{folder}{file}") };
        inside(&file, anywhere)?;
        files.bytes(&file, anywhere).map(|bytes| bytes.to_vec())
    };
    if !is_gltf {
        return of_usd(&path[folder.len()..], &bytes, &mut open);
    }
    match plaus_asset::glb::packed(&bytes, &mut open).map_err(|error| error.to_string())? {
        Cow::Borrowed(_) => Ok(bytes),
        Cow::Owned(packed) => Ok(packed.into()),
    }
}

#[cfg(feature = "usd")]
fn of_usd(name: &str, bytes: &[u8], open: plaus_asset::model::Open<'_>) -> Result<Arc<[u8]>, String> {
    plaus_asset::usd::packed(name, bytes, open).map(Into::into).map_err(|error| error.to_string())
}

#[cfg(not(feature = "usd"))]
fn of_usd(_: &str, _: &[u8], _: plaus_asset::model::Open<'_>) -> Result<Arc<[u8]>, String> {
    Err("this program was built without USD: build it with the feature `usd`, or take a released one".into())
}

/// BLAKE3 of a file's bytes, in hexadecimal digits: the value of a scenario's `hash`.
#[must_use]
pub fn hash_of(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

/// Why a path does not stay in the scenario's folder; `None` if it does, judging by its text.
#[must_use]
pub fn leaves_folder(path: &str) -> Option<String> {
    let is_absolute = path.starts_with(['/', '\\']) || path.as_bytes().get(1) == Some(&b':');
    let goes_up = path.split(['/', '\\']).any(|name| name == "..");
    (is_absolute || goes_up).then(|| {
        "it lies outside the scenario's folder: move it there, or allow it by `anywhere = true` in its table".into()
    })
}

/// Refuses a path that leaves the scenario's folder, unless that is allowed.
pub(crate) fn inside(path: &str, anywhere: bool) -> Result<(), String> {
    leaves_folder(path).filter(|_| !anywhere).map_or(Ok(()), Err)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_that_leave_the_folder_are_known() {
        for path in ["/etc/cup.obj", "../cup.obj", "a/../../cup.obj", "C:/cup.obj", "\\\\host\\cup.obj", "a\\..\\b.obj"]
        {
            assert!(leaves_folder(path).is_some(), "{path}");
        }
        for path in ["cup.obj", "shapes/cup.obj", "./cup.obj", "cup..obj", "…/cup.obj"] {
            assert_eq!(leaves_folder(path), None, "{path}");
        }
    }
}
