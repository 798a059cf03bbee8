//! Scenario keys of worlds that users describe.

use super::amount::{self, Amount, water};
use super::bumpy::SurfaceBumps;
use super::driven::Driven;
use super::finish::Finish;
use super::from_file::{FromFile, Known};
use super::inertia::Inertia;
use super::joints::Joint;
use super::late::Appears;
use super::laws::LawOf;
use super::mechanics::Mechanics;
use super::menu::CustomMoves;
use super::quantity::Quantity;
use super::regions::Region;
use super::rope::Rope;
use super::scattering::Scattering;
use super::shapes::{Ball, EachFile, Plane, Shape, Still};
use super::start_from::StartFrom;
use super::view::Viewpoint;
use super::within::Within;
use crate::accuracy::AccuracyPreset;
use crate::files::{Assets, Files};
use crate::model::Weights;
use crate::scene::ConfigError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A world of your own: bodies and scenery, what they are made of, and what is uncertain about them. `[[require]]` says
/// what must happen in it.
///
/// Places are in millimetres, with x and y level and z up. Any number of a body, a material or a piece of scenery may
/// instead be a law, such as `{ normal = [0, 20] }`; the name of one of the `quantities`, which has the same value
/// wherever it is named; or arithmetic: `"0.5 * width + normal(0, 2)"`. A law written in place is drawn for that number
/// alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    /// Longest duration of a motion. It ends earlier if everything is at rest.
    #[schemars(extend("minimum" = 1e-3, "maximum" = 600.0, "x-unit" = "s"))]
    pub duration_s: f64,
    /// How exact the simulation is.
    pub accuracy: AccuracyPreset,
    /// What bodies are simulated as. Marbles are faster, but only balls can be marbles.
    #[serde(skip_serializing_if = "Mechanics::is_default")]
    #[schemars(extend("default" = "turning"))]
    pub mechanics: Mechanics,
    /// Gravity, straight down.
    #[schemars(extend("minimum" = 0.0, "maximum" = 1000.0, "x-unit" = "m/s²"))]
    pub gravity: f64,
    /// A body that touches something below this height is gone: it stays where it is, and touches nothing any more.
    /// That saves the time of simulating what has fallen off. Unset: no body is ever gone.
    #[schemars(extend("minimum" = -1e6, "maximum" = 1e6, "x-unit" = "mm", "x-example" = -500.0))]
    pub bottom_mm: Option<f64>,
    /// Two solutions are the same if every body ends in the same cell of this width, with the same of its axes
    /// uppermost, and if the same things met for the first time in the same order.
    #[schemars(extend("minimum" = 1e-3, "maximum" = 1e6, "x-unit" = "mm"))]
    pub distinct_mm: f64,
    /// What things are made of. A thing without a material has one with all values at their defaults.
    #[schemars(length(max = 256))]
    pub materials: Vec<Material>,
    /// What happens between two materials, where it does not follow from the two.
    #[schemars(length(max = 4096))]
    pub pairs: Vec<Pair>,
    /// Numbers with names, which other numbers can refer to.
    #[schemars(length(max = 4096))]
    pub quantities: Vec<Quantity>,
    /// Scenery, which stands still. Unset: a level plane at height 0, called `floor`.
    #[schemars(length(max = 4096))]
    pub fixed: Vec<Fixed>,
    /// What moves.
    #[schemars(length(min = 1, max = 4096))]
    pub bodies: Vec<Body>,
    /// Bodies that follow keyframes: a paddle, a tray, a foot.
    #[schemars(length(max = 4096))]
    pub driven: Vec<Driven>,
    /// Joints between bodies, or between a body and the fixed world: a door, a pendulum, a chain.
    #[schemars(length(max = 4096))]
    pub joints: Vec<Joint>,
    /// Ropes and chains: bodies and joints in a row.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 256), extend("default" = []))]
    pub ropes: Vec<Rope>,
    /// Regions, numbered from 1: a column of tables tells in which of them each body ends, 0 if in none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 1000), extend("default" = []))]
    pub regions: Vec<Region>,
    /// Bodies that start as a run, or another program, left them, so that a long machine can be built stage by stage.
    /// Unset: all bodies start as their own keys say.
    #[serde(skip_serializing_if = "StartFrom::is_unset")]
    #[schemars(extend("default" = {}))]
    pub start_from: StartFrom,
    /// From where pictures, videos and galleries look at it.
    pub view: Viewpoint,
    /// Relative weights of the moves.
    pub weights: Weights<CustomMoves>,
}

impl Default for Config {
    fn default() -> Self {
        let aimed = |mean: f64| Amount::of(LawOf::Normal([mean, 0.5]));
        Self {
            duration_s: 10.0,
            accuracy: AccuracyPreset::default(),
            mechanics: Mechanics::default(),
            gravity: 9.806_65,
            bottom_mm: None,
            distinct_mm: 50.0,
            materials: Vec::new(),
            pairs: Vec::new(),
            quantities: Vec::new(),
            fixed: vec![Fixed {
                name: "floor".into(),
                count: None,
                shape: Still::Plane(Plane::default()),
                material: String::new(),
                colour: String::new(),
                at_mm: Default::default(),
                turn_deg: Default::default(),
                bumps: None,
                present: None,
            }],
            bodies: vec![Body {
                name: "ball".into(),
                count: None,
                shape: Shape::Ball(Ball { radius_mm: 30.0.into() }),
                inertia: None,
                material: String::new(),
                pips: false,
                faces: Vec::new(),
                colour: String::new(),
                at_mm: [0.0.into(), 0.0.into(), 500.0.into()],
                within: None,
                turn_deg: Default::default(),
                any_turn: false,
                velocity_m_s: [aimed(1.0), aimed(0.0), 0.0.into()],
                spin_deg_s: Default::default(),
                release_s: Amount::default(),
                appears: None,
                gravity_scale: all(),
                damping: Amount::default(),
                angular_damping: Amount::default(),
                force_n: Default::default(),
                torque_n_m: Default::default(),
                own_force_n: Default::default(),
                own_torque_n_m: Default::default(),
                asleep: false,
                no_contact: Vec::new(),
                present: None,
            }],
            driven: Vec::new(),
            joints: Vec::new(),
            ropes: Vec::new(),
            regions: Vec::new(),
            start_from: StartFrom::default(),
            view: Viewpoint::default(),
            weights: Weights::default(),
        }
    }
}

impl Config {
    /// Reads the files that contain the shapes, and that of the starts.
    pub(crate) fn load(&mut self, files: &dyn Files) -> Result<(), ConfigError> {
        self.start_from.load(files)?;
        let mut known = Known::default();
        self.for_files(&mut |key, wanted, file| file.load(key, wanted, files, &mut known))
    }

    /// The files that were read.
    pub(crate) fn assets(&self) -> Assets {
        let mut assets = Assets::default();
        let add = &mut |_: &str, _, file: &mut FromFile| {
            if let Some(loaded) = &file.loaded {
                assets.insert(file.file.clone(), loaded.asset.bytes.clone());
            }
            Ok(())
        };
        // Nothing is changed: the function is mutable because reading files also goes through it.
        let _ = self.clone().for_files(add); // adding cannot fail
        assets
    }

    /// Visits all files that contain shapes, each with its key from the scenario's root.
    fn for_files(&mut self, each: EachFile<'_>) -> Result<(), ConfigError> {
        let at = |list: &str, index: usize| format!("world.custom.{list}[{index}].shape");
        for (index, fixed) in self.fixed.iter_mut().enumerate() {
            fixed.shape.for_files(&at("fixed", index), each)?;
        }
        for (index, body) in self.bodies.iter_mut().enumerate() {
            body.shape.for_files(&at("bodies", index), each)?;
        }
        for (index, driven) in self.driven.iter_mut().enumerate() {
            driven.shape.for_files(&at("driven", index), each)?;
        }
        Ok(())
    }
}

/// What things are made of. Between two materials, friction and restitution are the geometric means of their values,
/// and the resistances are the arithmetic means, unless `pairs` says otherwise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Its name.
    pub name: String,
    /// Mass over volume.
    #[serde(default = "water")]
    pub density: Amount<amount::Density>,
    /// Coulomb's coefficient of friction. Where rigid bodies wedge, his law may allow no force or several (Painlevé's
    /// paradox: a rod that slides on its tip). A contact then opens if it needs no force; stops at once, as in an
    /// impact, if an impulse within its cone can hold it; and otherwise slides.
    #[serde(default = "half::<amount::Friction>")]
    pub friction: Amount<amount::Friction>,
    /// The coefficient for surfaces that do not slide on each other; at least `friction`. What slides is slowed down by
    /// `friction`, also in an impact; once it has stopped, this is what holds it. Unset: the same as `friction`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = null))]
    pub static_friction: Option<Amount<amount::Friction>>,
    /// Restitution: rebound speed over approach speed.
    #[serde(default = "half::<amount::Restitution>")]
    pub restitution: Amount<amount::Restitution>,
    /// Resistance to rolling: torque over force and radius. Wood: 0.001 to 0.02.
    #[serde(default)]
    pub rolling: Amount<amount::Friction>,
    /// Resistance to spinning on the spot, defined likewise. Unset: the same as `rolling`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = null))]
    pub spinning: Option<Amount<amount::Friction>>,
    /// How much its impacts differ from each other, as those of real, imperfect surfaces do. Unset: not at all.
    #[serde(default, skip_serializing_if = "Scattering::is_unset")]
    #[schemars(extend("default" = {}))]
    pub scatter: Scattering,
    /// Colour as on the web, `#c04030`. Unset: each body has its own colour, each table of scenery its own quiet one.
    #[serde(default)]
    pub colour: String,
    /// How its surface looks.
    #[serde(default)]
    pub finish: Finish,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            density: water(),
            friction: half(),
            static_friction: None,
            restitution: half(),
            rolling: Amount::default(),
            spinning: None,
            scatter: Scattering::default(),
            colour: String::new(),
            finish: Finish::default(),
        }
    }
}

fn all() -> Amount<amount::Scale> {
    1.0.into()
}

fn is_nothing<M>(three: &[Amount<M>; 3]) -> bool {
    three.iter().all(|one| *one == Amount::default())
}

fn half<M>() -> Amount<M> {
    0.5.into()
}

/// What happens between two materials, or between two things of one material.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pair {
    /// Names of the two materials; the same name twice for one material.
    pub between: [String; 2],
    /// Coulomb's coefficient of friction. Unset: the geometric mean of the two.
    #[serde(default)]
    pub friction: Option<Amount<amount::Friction>>,
    /// The coefficient while they do not slide; at least `friction`, which it needs. Unset: `friction` if that is set,
    /// and otherwise the geometric mean of the two.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = null))]
    pub static_friction: Option<Amount<amount::Friction>>,
    /// Restitution. Unset: the geometric mean of the two.
    #[serde(default)]
    pub restitution: Option<Amount<amount::Restitution>>,
    /// Resistance to rolling. Unset: the mean of the two.
    #[serde(default)]
    pub rolling: Option<Amount<amount::Friction>>,
    /// Resistance to spinning on the spot. Unset: the mean of the two.
    #[serde(default)]
    pub spinning: Option<Amount<amount::Friction>>,
}

/// A thing that stands still.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Fixed {
    /// Its name.
    pub name: String,
    /// Makes an array of this many. They are called `peg_1`, `peg_2` and so on. In the arithmetic of its numbers, `i`
    /// is 0 for the first and 1 for the next, and `n` is the count. Unset: only one, called `peg`.
    #[serde(default)]
    #[schemars(range(min = 1, max = 4096))]
    pub count: Option<u32>,
    /// Its shape.
    pub shape: Still,
    /// The name of its material.
    #[serde(default)]
    pub material: String,
    /// Colour as on the web, `#c04030`. Unset: the material's.
    #[serde(default)]
    pub colour: String,
    /// Where its middle is. For a plane, any point on it.
    #[serde(default)]
    pub at_mm: [Amount<amount::Place>; 3],
    /// How it is turned: about the world's x axis, then about y, then about z.
    #[serde(default)]
    pub turn_deg: [Amount<amount::Angle>; 3],
    /// Random bumps on a mesh, a box without rounding, or ground by its heights. Unset: none.
    #[serde(default)]
    pub bumps: Option<SurfaceBumps>,
    /// How likely it is there at all, as for bodies. Unset: it always is.
    #[serde(default)]
    pub present: Option<Amount<amount::Chance>>,
}

/// A body that moves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// Its name, for requirements, tables and exports.
    pub name: String,
    /// Makes an array of this many. They are called `ball_1`, `ball_2` and so on. In the arithmetic of its numbers, `i`
    /// is 0 for the first and 1 for the next, and `n` is the count. Unset: only one, called `ball`.
    #[serde(default)]
    #[schemars(range(min = 1, max = 4096))]
    pub count: Option<u32>,
    /// Its shape.
    pub shape: Shape,
    /// Where its mass is. Unset: all of its shape has one density.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = null))]
    pub inertia: Option<Box<Inertia>>,
    /// The name of its material.
    #[serde(default)]
    pub material: String,
    /// Colour as on the web, `#c04030`. Unset: the material's.
    #[serde(default)]
    pub colour: String,
    /// Whether a box is a die, with pips: 1 along its z axis, 2 along y, 3 along x; opposite faces add up to 7.
    #[serde(default)]
    pub pips: bool,
    /// Marks the faces of any other shape than a ball, numbered from 1: for each its outward direction along the body's
    /// own axes, of any length. The number that counts is that of the face that points up most.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 100), extend("default" = []))]
    pub faces: Vec<[f64; 3]>,
    /// Where its middle starts. For a hull, the origin of its points; for a solid of revolution, its foot's middle.
    #[serde(default)]
    pub at_mm: [Amount<amount::Place>; 3],
    /// A region about `at_mm`: the body starts anywhere in it, all of its volume equally likely. Or the surface of a
    /// piece of scenery.
    #[serde(default)]
    pub within: Option<Within>,
    /// How it is turned at the start: about the world's x axis, then about y, then about z.
    #[serde(default)]
    pub turn_deg: [Amount<amount::Angle>; 3],
    /// Whether it starts in a random orientation instead, with all orientations equally likely.
    #[serde(default)]
    pub any_turn: bool,
    /// Velocity of its centre of gravity at the start.
    #[serde(default)]
    pub velocity_m_s: [Amount<amount::Velocity>; 3],
    /// How fast it turns at the start, about the world's x, y and z axes.
    #[serde(default)]
    pub spin_deg_s: [Amount<amount::Turning>; 3],
    /// When it is released. Before that, it is drawn where it starts, and nothing can touch it.
    #[serde(default)]
    pub release_s: Amount<amount::Moment>,
    /// What makes it appear, such as another body that has come to rest. Unset: it is there from the start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = null))]
    pub appears: Option<Appears>,
    /// How much of the world's gravity it feels: 1 all, 0 none (it floats), below 0 it rises.
    #[serde(default = "all")]
    pub gravity_scale: Amount<amount::Scale>,
    /// Rate at which it loses velocity, as in thick air: by a factor of e in `1/damping` seconds.
    #[serde(default)]
    pub damping: Amount<amount::Rate>,
    /// Rate at which it loses angular momentum.
    #[serde(default)]
    pub angular_damping: Amount<amount::Rate>,
    /// A constant force at its centre of gravity, along the world's axes: wind, a thruster.
    #[serde(default)]
    pub force_n: [Amount<amount::Force>; 3],
    /// A constant torque about its centre of gravity, along the world's axes.
    #[serde(default)]
    pub torque_n_m: [Amount<amount::Torque>; 3],
    /// A force at its centre of gravity along its own axes, which turns with it: a rocket's thrust. Turning costs time:
    /// in flight, each half radian and more is an event.
    #[serde(default, skip_serializing_if = "is_nothing")]
    #[schemars(extend("default" = [0.0, 0.0, 0.0]))]
    pub own_force_n: [Amount<amount::Force>; 3],
    /// A torque along its own axes, which turns with it.
    #[serde(default, skip_serializing_if = "is_nothing")]
    #[schemars(extend("default" = [0.0, 0.0, 0.0]))]
    pub own_torque_n_m: [Amount<amount::Torque>; 3],
    /// Stays where it is, in the air too, until another body hits it.
    #[serde(default)]
    pub asleep: bool,
    /// Groups that it is in: bodies and driven bodies that are in a common one pass through each other.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 64), extend("default" = []))]
    pub no_contact: Vec<String>,
    /// How likely it is there at all; each body of an array for itself. A quantity, law or formula whose value is
    /// uncertain makes it there where the value is at least 0.5, so that bodies can share it. Unset: it always is.
    #[serde(default)]
    pub present: Option<Amount<amount::Chance>>,
}
