//! Scenarios made from files of shapes: what moves in them, what stands still, what follows keyframes, and what could
//! not be taken over.

mod axes;
mod choice;
mod contact;
mod filters;
mod floor;
mod from_usd;
mod geoms;
mod glb;
mod held;
mod inertia;
mod limits;
mod materials;
mod models;
mod numbers;
mod physics;
mod recognised;
mod solids;
mod split;
mod things;
mod write;

use crate::custom::{self, Custom};
use crate::files::{Files, whole};
use crate::registry::World;
use crate::scenario::{Scenario, ScenarioError};
pub use choice::Choice;
use plaus_asset::{AssetError, Content, Format};
pub use split::{Cut, cut};
use std::collections::BTreeSet;
use things::{NARROWER, Role, Shape, Thing, Things};

/// A scenario made from a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Imported {
    /// Its text: a valid scenario if it is beside the file.
    pub text: String,
    /// What could not be taken over, or was replaced, although it changes motion, or may: one sentence each; these are
    /// also in the text, as comments.
    pub left_out: Vec<String>,
    /// What was not taken over, but has no bearing on motion, such as cameras; also in the text.
    pub harmless: Vec<String>,
    /// What was assumed or changed, such as the file's unit or a name, one sentence each; also in the text.
    pub notes: Vec<String>,
    /// If nothing in a file of shapes moves, and nothing was said of what does: its objects, and whether each is small
    /// enough to be one that moves, less than a quarter of everything together.
    pub still: Vec<(String, bool)>,
}

/// Why no scenario can be made from a file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ImportError {
    /// The file, or one that it names, cannot be read.
    #[error(transparent)]
    Asset(#[from] AssetError),
    /// What is said of its objects does not fit them.
    #[error("{0}")]
    Choice(String),
    /// A unit is given for a file that has one, or it is no length.
    #[error("{0}")]
    Unit(String),
    /// Two bodies begin inside each other, and joints hold them there.
    #[error(
        "{body:?} begins inside {other:?}, and joints hold them there: here all but the two that a joint holds \
         together touch each other, so make them smaller or move them apart in the file"
    )]
    Stuck {
        /// One body.
        body: String,
        /// The other.
        other: String,
    },
    /// Its content does not make a world.
    #[error("the scenario made from it is not valid: {0}")]
    Scenario(ScenarioError),
}

/// Most names of moved bodies in a note.
const SHOWN: usize = 4;

/// A metre, in mm.
const METRE: f64 = 1000.0;

/// If nothing in a file without a unit is this many units across, its unit is assumed to be a metre: a world of a few
/// millimetres is rare, and programs that draw, such as Blender, write metres.
const SMALL: f64 = 10.0;

/// The scenario of the file at `path`, as a scenario beside it would name it; with `anywhere` if that is outside its
/// folder. The file, and those that it names, are among `files`.
///
/// `unit_mm` is the length of the unit of an OBJ or STL file, in mm. If it is not given, the unit is a metre if
/// everything in the file together is less than 10 units across, and a millimetre otherwise.
///
/// In a GLB or in USD, nodes with a mesh are scenery unless something else is said: by `extras` (`plaus`: `body`,
/// `driven`, `fixed`, `ignore`), by the extension `KHR_physics_rigid_bodies` or UsdPhysics, or by an animation. In a
/// model in MJCF or URDF, what has a joint moves. In other formats, a single object is a body that falls, and several
/// are scenery.
///
/// # Errors
///
/// [`ImportError`] if a file cannot be read, `unit_mm` is no length or the file has a unit of its own, or things begin
/// inside each other wherever they are moved.
pub fn scenario(path: &str, anywhere: bool, unit_mm: Option<f64>, files: &dyn Files) -> Result<Imported, ImportError> {
    chosen(path, anywhere, unit_mm, &Choice::default(), files)
}

/// The same where the user says what some objects do. If anything is said, a floor is added under everything, so that
/// nothing falls for ever.
///
/// # Errors
///
/// As [`scenario`]; also if something is said of objects that the file does not have, or cannot be.
pub fn chosen(
    path: &str,
    anywhere: bool,
    unit_mm: Option<f64>,
    choice: &Choice,
    files: &dyn Files,
) -> Result<Imported, ImportError> {
    if let Some(unit) = unit_mm.filter(|unit| !(unit.is_finite() && *unit > 0.0)) {
        return Err(ImportError::Unit(format!("a unit is a length in millimetres, more than 0, not {unit}")));
    }
    let metres =
        || unit_mm.map_or(Ok(()), |_| Err(ImportError::Unit("its unit is the metre: give it no other".into())));
    let bytes = whole(files, path, anywhere).map_err(AssetError::Broken)?;
    let is_model = |ending: &str| ["xml", "urdf"].iter().any(|of| ending.eq_ignore_ascii_case(of));
    if path.rsplit_once('.').is_some_and(|(_, ending)| is_model(ending)) {
        metres()?;
        if !choice.is_empty() {
            let what = "a model in MJCF or URDF says itself what moves: give its bodies joints".to_owned();
            return Err(ImportError::Choice(what));
        }
        let mut things = models::things(path, anywhere, &bytes, files)?;
        things.check_inertias(path, files)?;
        return apart(&things, path, files);
    }
    let content = plaus_asset::read_any(path, &bytes).map_err(|error| match error {
        AssetError::UnknownFormat => AssetError::Broken(
            "its name must end in .glb, .gltf, .obj, .stl, .usd, .usda, .usdc, .usdz, .urdf or .xml".into(),
        ),
        other => other,
    })?;
    if content.objects.is_empty() && content.format != Format::Glb {
        return Err(AssetError::Empty.into());
    }
    let file = numbers::named(path, anywhere);
    let mut things = match content.format {
        Format::Glb => {
            metres()?;
            let things = glb::things(file, &content, &bytes, choice)?;
            if things.all.is_empty() && content.objects.is_empty() {
                return Err(AssetError::Broken(
                    "it has no triangles, and no colliders that are solids: give a node of its scene a mesh".into(),
                )
                .into());
            }
            things
        }
        Format::Obj | Format::Stl => plain(file, path, &content, unit_mm, choice)?,
    };
    things.splits = !choice.is_empty();
    if things.splits {
        things.add_floor();
    }
    let still = if choice.is_empty() { things.still() } else { Vec::new() };
    things.try_shapes();
    things.check_masses();
    things.name_all();
    things.sway_with_joints();
    things.check_inertias(path, files)?;
    Ok(Imported { still, ..apart(&things, path, files)? })
}

/// The scenario of some things, moved so that none begins inside another, with places that are as uncertain as they can
/// be with half of all draws free of overlap, or less.
fn apart(things: &Things<'_>, path: &str, files: &dyn Files) -> Result<Imported, ImportError> {
    let mut things = things.clone();
    let sides = move_apart(&mut things, path, files)?;
    let mut made = written(&things, path, files);
    let is_free = |made: &Result<(Imported, f64), ImportError>| made.as_ref().is_ok_and(|(_, free)| *free >= 0.5);
    let try_other = |made: &mut Result<(Imported, f64), ImportError>, other: Things<'_>| {
        if !is_free(made) {
            let other = written(&other, path, files);
            if other.is_ok() {
                *made = other;
            }
        }
    };
    for spread in NARROWER {
        let mut narrow = things.clone();
        narrow.spread = spread;
        let note = format!("places are uncertain by {spread} mm only: with more, things begin inside each other");
        narrow.notes.push(note);
        try_other(&mut made, narrow);
    }
    if !sides.is_empty() {
        let mut joined = things.clone();
        joined.join_sides(&sides);
        joined.notes.push("things that touch at their sides share what is uncertain about their places".to_owned());
        try_other(&mut made, joined);
    }
    made.map(|(made, _)| made)
}

/// In which share of draws of a scenario nothing begins inside another.
fn free_share(scenario: &Scenario) -> f64 {
    let World::Custom(config) = &scenario.world else { return 1.0 };
    Custom::new(config).map_or(0.0, |world| world.free_share())
}

/// The scenario of some things, and in which share of draws none begins inside another.
fn written(things: &Things<'_>, path: &str, files: &dyn Files) -> Result<(Imported, f64), ImportError> {
    let text = things.text(path);
    let scenario = Scenario::read_with(path, &text, &[], files).map_err(ImportError::Scenario)?;
    let made = Imported {
        text,
        left_out: things.left_out.clone(),
        harmless: things.harmless.clone(),
        notes: things.notes.clone(),
        still: Vec::new(),
    };
    Ok((made, free_share(&scenario)))
}

/// Moves things so that none begins inside another; returns which bodies then touch others, or scenery, at their sides.
fn move_apart(
    things: &mut Things<'_>,
    path: &str,
    files: &dyn Files,
) -> Result<Vec<(usize, Option<usize>)>, ImportError> {
    loop {
        let text = things.text(path);
        let groups = things.groups();
        let move_apart = |scenario: &Scenario| match &scenario.world {
            World::Custom(config) => custom::apart(config, &groups).map(Some),
            _ => Ok(None),
        };
        let moved = Scenario::read_and(path, &text, &[], files, move_apart);
        let Some(apart) = moved.map_err(ImportError::Scenario)?.1 else { return Ok(Vec::new()) };
        let bodies: Vec<usize> = things.bodies().collect();
        let stuck = apart.stuck.as_ref().and_then(|(body, name)| {
            let is_other = |thing: &Thing| thing.role != Role::Gone && thing.name == *name;
            Some((*bodies.get(*body)?, things.all.iter().position(is_other)?))
        });
        if let Some((body, other)) = stuck {
            things.part(body, other)?;
            continue;
        }
        let (mut names, farthest) = things.shift(&bodies, &groups, &apart.by);
        if !names.is_empty() {
            let more = names.len().saturating_sub(SHOWN);
            names.truncate(SHOWN);
            let more = if more > 0 { format!(" and {more} more") } else { String::new() };
            let (names, farthest) = (names.join(", "), numbers::number(numbers::shortest(farthest, 1e-3 * farthest)));
            let note = format!("{names}{more}: moved by up to {farthest} mm, out of what they began inside of");
            things.notes.push(note);
        }
        // Bodies that the file does not have, and driven ones, stand still.
        let of = |body: &usize| bodies.get(*body).copied();
        let side = |(body, other): &(usize, Option<usize>)| Some((of(body)?, other.as_ref().and_then(of)));
        return Ok(apart.sides.iter().filter_map(side).collect());
    }
}

/// The contents of a file without nodes and without a unit.
fn plain<'a>(
    file: String,
    path: &str,
    content: &'a Content,
    unit_mm: Option<f64>,
    choice: &Choice,
) -> Result<Things<'a>, ImportError> {
    let whole = path.rsplit(['/', '\\']).next().unwrap_or(path);
    let stem = whole.rsplit_once('.').map_or("shape", |(stem, _)| stem);
    let usual = content.format.unit_mm();
    let [low, high] = content.whole().upright(content.format.up()).ends();
    let is_small = (high - low).max_element() < SMALL;
    let unit = unit_mm.unwrap_or(if is_small { METRE } else { usual });
    let mut things = Things::of_shapes(format!("{file}, unit_mm = {unit}"), content, unit);
    things.notes.extend(unit_mm.is_none().then(|| {
        let size =
            (unit * (high - low)).to_array().map(|mm| numbers::number(numbers::shortest(mm, 1e-3 * mm))).join(" × ");
        let why = if is_small { format!(", as it is less than {SMALL} units across") } else { String::new() };
        let [unit, other] = if is_small { ["metre", "millimetre"] } else { ["millimetre", "metre"] };
        let length = if is_small { usual } else { METRE };
        format!(
            "{whole} is {size} mm: it has no unit, so 1 is read as a {unit}{why}; if it is a {other}, use --unit-mm \
             {length}, which sets unit_mm"
        )
    }));
    let several = content.objects.len() > 1;
    let mut seen = BTreeSet::new();
    for object in &content.objects {
        if !seen.insert(&object.name) {
            continue;
        }
        let (name, role) = if several { (object.name.as_str(), Role::Fixed) } else { (stem, Role::Body) };
        let shape = Shape::File { object: several.then(|| object.name.clone()) };
        let role = choice.of(name).unwrap_or(role);
        if role == Role::Driven {
            return Err(ImportError::Choice(format!("{name} has no keyframes to follow: its format has none")));
        }
        things.all.push(Thing::new(name, role, shape));
    }
    let names: Vec<&str> = things.all.iter().map(|thing| thing.name.as_str()).collect();
    choice.check(&names)?;
    if several && choice.is_empty() {
        things.left_out.push("which objects move: the file does not say, so all stand still".into());
    }
    Ok(things)
}
