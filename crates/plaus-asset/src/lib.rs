//! Files of shapes (GLB, OBJ, STL and, with the feature `usd`, USD) as named objects made of triangles, which may be
//! recognised as solids or cut into convex pieces; models in MJCF and URDF; and times from CSV and MIDI files.
//!
//! ```
//! let obj = b"o wedge\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
//! let content = plaus_asset::read("wedge.obj", obj)?;
//! let wedge = content.object("wedge").expect("it has one");
//! assert_eq!((wedge.triangles.corners.len(), wedge.triangles.faces.len()), (4, 4));
//! # Ok::<(), plaus_asset::AssetError>(())
//! ```
//!
//! Lengths are in the file's own unit and along its own axes, until [`Triangles::upright`] makes z point up. Nothing
//! here reads a disk, and nothing in a file is trusted before it is checked.

mod error;
pub mod glb;
mod mjcf;
pub mod model;
mod obj;
pub mod onsets;
pub mod pieces;
pub mod recognise;
mod stl;
mod triangles;
mod unread;
mod urdf;
#[cfg(feature = "usd")]
pub mod usd;
mod xml;

pub use error::AssetError;
pub use obj::corners as obj_corners;
pub use triangles::{Triangles, Up, upright, upright_turn};

use glam::{DQuat, DVec3};

/// Length in bytes of the longest file that is read: about that of a text STL with the largest allowed number of
/// triangles.
pub const MOST_BYTES: usize = 256 << 20;

/// Most triangles in a file: as many as the simulator accepts in one mesh.
pub const MOST_TRIANGLES: usize = 1 << 20;

/// The known formats.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Binary glTF 2.0: nodes with names, keyframes, materials. Metres, y up. A `.gltf` is read once it is
    /// [`packed`](glb::packed), and so is USD.
    Glb,
    /// Wavefront OBJ: objects and groups with names. No unit; y up in most programs.
    Obj,
    /// STL, binary or text: one object without a name. No unit, mostly millimetres; z up in most programs.
    Stl,
}

impl Format {
    /// The format of a file, from its extension in upper or lower case.
    ///
    /// # Errors
    /// [`AssetError::UnknownFormat`] for any other ending.
    pub fn of(file: &str) -> Result<Self, AssetError> {
        let ending = file.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase());
        match ending.as_deref() {
            Some("glb" | "gltf") => Ok(Self::Glb),
            Some(_) if Self::is_usd(file) => Ok(Self::Glb),
            Some("obj") => Ok(Self::Obj),
            Some("stl") => Ok(Self::Stl),
            _ => Err(AssetError::UnknownFormat),
        }
    }

    /// Whether the name of a file says that it is USD, which is read once a GLB is made of it.
    #[must_use]
    pub fn is_usd(file: &str) -> bool {
        let ending = file.rsplit_once('.').map_or("", |(_, ending)| ending);
        ["usd", "usda", "usdc", "usdz"].iter().any(|known| known.eq_ignore_ascii_case(ending))
    }

    /// The usual length of its unit, in millimetres.
    #[must_use]
    pub fn unit_mm(self) -> f64 {
        match self {
            Self::Glb => 1000.0,
            Self::Obj | Self::Stl => 1.0,
        }
    }

    /// Which axis usually points up in it.
    #[must_use]
    pub fn up(self) -> Up {
        match self {
            Self::Glb | Self::Obj => Up::Y,
            Self::Stl => Up::Z,
        }
    }
}

/// What a file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Content {
    /// Its format.
    pub format: Format,
    /// The objects with triangles, in the order of the file.
    pub objects: Vec<Object>,
}

/// Something in a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    /// Its name, which no other object has; `object_1` and so on, by its index, if the file gives none. In a GLB a
    /// second object called `box` is `box_2`.
    pub name: String,
    /// Where its origin is in the file. Only a GLB places its objects.
    pub at: DVec3,
    /// Turns its axes into those of the file.
    pub turn: DQuat,
    /// Its triangles about its own origin, along its own axes, including its node's scale.
    pub triangles: Triangles,
    /// Its colour, red, green and blue, if the file gives one.
    pub colour: Option<[u8; 3]>,
    /// The name of its material, if the file gives one.
    pub material: Option<String>,
    /// Whether it is part of what the file shows; otherwise only a collider of a GLB has this mesh.
    pub is_drawn: bool,
}

impl Object {
    /// Triangles of a file that has nothing but triangles.
    fn plain(name: String, triangles: Triangles) -> Self {
        let (at, turn, colour, material) = (DVec3::ZERO, DQuat::IDENTITY, None, None);
        Self { name, at, turn, triangles, colour, material, is_drawn: true }
    }
}

impl Content {
    /// The object of that name.
    #[must_use]
    pub fn object(&self, name: &str) -> Option<&Object> {
        self.objects.iter().find(|object| object.name == name)
    }

    /// All objects that are shown, as placed in the file.
    #[must_use]
    pub fn whole(&self) -> Triangles {
        let placed = |object: &Object| object.triangles.moved(|corner| object.at + object.turn * corner);
        Triangles::joined(self.objects.iter().filter(|object| object.is_drawn).map(placed))
    }
}

/// Reads a file called `file`, whose extension tells its format.
///
/// # Errors
///
/// [`AssetError`] for an unknown extension, too many bytes or triangles, an invalid file, a corner that is not finite,
/// and a file without triangles.
pub fn read(file: &str, bytes: &[u8]) -> Result<Content, AssetError> {
    let content = read_any(file, bytes)?;
    if content.objects.is_empty() { Err(AssetError::Empty) } else { Ok(content) }
}

/// The same of a file that may have no triangles, such as a GLB with colliders that are solids.
///
/// # Errors
///
/// As [`read`], but for a file without triangles.
pub fn read_any(file: &str, bytes: &[u8]) -> Result<Content, AssetError> {
    let format = Format::of(file)?;
    if bytes.len() > MOST_BYTES {
        return Err(AssetError::TooLong { bytes: bytes.len() as u64 });
    }
    let objects = match format {
        Format::Glb => glb::Glb::read(bytes)?.objects()?,
        Format::Obj => obj::read(bytes)?,
        Format::Stl => stl::read(bytes)?,
    };
    let objects: Vec<Object> = objects.into_iter().filter(|object| !object.triangles.faces.is_empty()).collect();
    let triangles = objects.iter().map(|object| object.triangles.faces.len()).sum();
    if triangles > MOST_TRIANGLES { Err(AssetError::TooMany { triangles }) } else { Ok(Content { format, objects }) }
}

/// Reads a model in MJCF, the format of MuJoCo, or URDF, that of ROS; `open` reads the files that it includes. Both are
/// XML, and told apart by their root.
///
/// # Errors
/// [`AssetError::Broken`], with line and column, for what is not valid XML, not a model, or says something impossible;
/// [`AssetError::TooLong`] for too many bytes.
pub fn read_model(bytes: &[u8], open: model::Open<'_>) -> Result<model::Model, AssetError> {
    if bytes.len() > MOST_BYTES {
        return Err(AssetError::TooLong { bytes: bytes.len() as u64 });
    }
    let root = xml::root(bytes, &mut *open)?;
    match root.tag.as_str() {
        "mujoco" => mjcf::model(&root),
        "robot" => urdf::model(&root, open),
        other => Err(root
            .place
            .wrong(format!("its root is <{other}>: a model in MJCF begins with <mujoco>, one in URDF with <robot>"))),
    }
}
