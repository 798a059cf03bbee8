//! Scenarios made from files of shapes: what moves in them, what stands still, what follows keyframes, and what could
//! not be taken over.

mod glb;
mod physics;
mod write;

use crate::files::Assets;
use crate::scenario::{Scenario, ScenarioError};
use plaus_asset::{AssetError, Content, Format};
use std::collections::BTreeSet;
use write::{Role, Shape, Thing, Things};

/// A scenario made from a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Imported {
    /// Its text: a valid scenario if it is beside the file.
    pub text: String,
    /// What could not be taken over, one sentence each; these are also in the text, as comments.
    pub left_out: Vec<String>,
}

/// Why no scenario can be made from a file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ImportError {
    /// The file cannot be read.
    #[error(transparent)]
    Asset(#[from] AssetError),
    /// Its content does not make a world.
    #[error("the scenario made from it is not valid, which is a bug: {0}")]
    Scenario(ScenarioError),
}

/// How often a thing that begins inside another is lifted, each time twice as far: from a tenth of a millimetre to
/// farther than a scenario reaches.
const LIFTS: u32 = 24;

/// Least lift, in mm.
const LIFT: f64 = 0.1;

/// The scenario of the file at `path`, as a scenario beside it would name it; with `anywhere` if that is outside its
/// folder.
///
/// In a GLB, nodes with a mesh are scenery unless something else is said: by `extras` (`plaus`: `body`, `driven`,
/// `fixed`, `ignore`), by the extension `KHR_physics_rigid_bodies`, or by an animation. In other formats, a single
/// object is a body that falls, and several are scenery.
///
/// # Errors
///
/// [`ImportError`] if the file cannot be read, or things begin inside each other however far they are lifted.
pub fn scenario(path: &str, anywhere: bool, bytes: &[u8]) -> Result<Imported, ImportError> {
    let content = plaus_asset::read(path, bytes)?;
    let mut things = match content.format {
        Format::Glb => glb::things(&content, bytes)?,
        Format::Obj | Format::Stl => plain(path, &content),
    };
    things.try_shapes(&content);
    things.name_all();
    let mut files = Assets::default();
    files.insert(path, bytes);
    let mut lifts = vec![0_u32; things.all.len()];
    loop {
        let text = things.text(path, anywhere, &content);
        let scenario = match Scenario::read_with(path, &text, &[], &files) {
            Ok(_) => return Ok(Imported { text, left_out: things.left_out }),
            Err(error) => error,
        };
        let blamed = scenario.problems.first().and_then(|problem| lifted(&problem.key, &problem.message));
        let body = blamed.and_then(|nth| things.bodies().nth(nth)).filter(|&index| lifts[index] < LIFTS);
        let Some(index) = body else { return Err(ImportError::Scenario(scenario)) };
        let by = LIFT * f64::from(1_u32 << lifts[index]);
        lifts[index] += 1;
        things.lift(index, by);
    }
}

/// Which body begins inside something.
fn lifted(key: &str, message: &str) -> Option<usize> {
    let place = key.strip_prefix("world.custom.bodies[")?.strip_suffix("].at_mm")?;
    message.starts_with("things begin inside each other").then(|| place.parse().ok())?
}

/// The contents of a file without nodes.
fn plain(path: &str, content: &Content) -> Things {
    let stem = path.rsplit(['/', '\\']).next().and_then(|name| name.rsplit_once('.')).map_or("shape", |(stem, _)| stem);
    let mut things = Things::new(content);
    let several = content.objects.len() > 1;
    let mut seen = BTreeSet::new();
    for object in &content.objects {
        if !seen.insert(&object.name) {
            continue;
        }
        let (name, role) = if several { (object.name.as_str(), Role::Fixed) } else { (stem, Role::Body) };
        let shape = Shape::File { object: several.then(|| object.name.clone()) };
        things.all.push(Thing::new(name, role, shape));
    }
    if several {
        things.left_out.push("which objects move: the file does not say, so all stand still".into());
    }
    things
}
