//! Scenario keys of worlds that users describe.

use super::amount::{self, Amount};
use super::driven::Driven;
use super::forms::{Ball, EachFile, Plane, Shape, Still};
use super::from_file::{FromFile, Known};
use super::laws::LawOf;
use super::moves::CustomMoves;
use super::quantity::Quantity;
use crate::accuracy::AccuracyPreset;
use crate::animation;
use crate::files::{Assets, Files};
use crate::model::Weights;
use crate::scene::ConfigError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A world of your own: bodies and scenery, what they are made of, and what is uncertain about them. What must happen
/// in it is said by `[[require]]`.
///
/// Places are in millimetres, x and y level, z up. Any number that a body, a material or a piece of scenery has may be
/// a law instead, as in `{ normal = [0, 20] }`, the name of one of the `quantities`, which then is the same wherever it
/// is named, or arithmetic: `"0.5 * width + normal(0, 2)"`. A law that is written out is drawn for this number alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    /// How long a motion lasts at most. It ends before where everything is at rest.
    #[schemars(extend("minimum" = 1e-3, "maximum" = 600.0, "x-unit" = "s"))]
    pub duration_s: f64,
    /// How exact the simulation is.
    pub accuracy: AccuracyPreset,
    /// Gravity, straight down.
    #[schemars(extend("minimum" = 0.0, "maximum" = 1000.0, "x-unit" = "m/s²"))]
    pub gravity: f64,
    /// Two solutions are the same where every body ends in the same cell of this width, with the same of its axes
    /// uppermost, and the same things first met in the same order.
    #[schemars(extend("minimum" = 1e-3, "maximum" = 1e6, "x-unit" = "mm"))]
    pub distinct_mm: f64,
    /// What things are made of. What names no material is of one with all values at their defaults.
    #[schemars(length(max = 256))]
    pub materials: Vec<Material>,
    /// What happens between two materials, where that does not follow from what each is.
    #[schemars(length(max = 4096))]
    pub pairs: Vec<Pair>,
    /// Numbers with names, which several others can be.
    #[schemars(length(max = 4096))]
    pub quantities: Vec<Quantity>,
    /// What stands still. Where the key is missing: a level plane at height 0, called `floor`.
    #[schemars(length(max = 4096))]
    pub fixed: Vec<Fixed>,
    /// What moves.
    #[schemars(length(min = 1, max = 4096))]
    pub bodies: Vec<Body>,
    /// What goes its own way by keyframes: a paddle, a tray, a foot.
    #[schemars(length(max = 4096))]
    pub driven: Vec<Driven>,
    /// Relative weights of the moves.
    pub weights: Weights<CustomMoves>,
}

impl Default for Config {
    fn default() -> Self {
        let aimed = |mean: f64| Amount::of(LawOf::Normal([mean, 0.5]));
        Self {
            duration_s: 10.0,
            accuracy: AccuracyPreset::default(),
            gravity: 9.806_65,
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
            }],
            bodies: vec![Body {
                name: "ball".into(),
                count: None,
                shape: Shape::Ball(Ball { radius_mm: 30.0.into() }),
                material: String::new(),
                colour: String::new(),
                at_mm: [0.0.into(), 0.0.into(), 500.0.into()],
                turn_deg: Default::default(),
                any_turn: false,
                velocity_m_s: [aimed(1.0), aimed(0.0), 0.0.into()],
                spin_deg_s: Default::default(),
                release_s: Amount::default(),
            }],
            driven: Vec::new(),
            weights: Weights::default(),
        }
    }
}

impl Config {
    /// Reads the files that shapes are in.
    pub(crate) fn load(&mut self, files: &dyn Files) -> Result<(), ConfigError> {
        let mut known = Known::new();
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
        // Only looked at: what goes through files to read them does so mutably.
        let _ = self.clone().for_files(add); // adding cannot fail
        assets
    }

    /// Goes through all files that shapes are in, each with its key from the scenario's root.
    fn for_files(&mut self, each: EachFile<'_>) -> Result<(), ConfigError> {
        let at = |list: &str, index: usize, key: &str| format!("world.custom.{list}[{index}].shape.{key}");
        for (index, fixed) in self.fixed.iter_mut().enumerate() {
            fixed.shape.for_files(&mut |key, wanted, file| each(&at("fixed", index, key), wanted, file))?;
        }
        for (index, body) in self.bodies.iter_mut().enumerate() {
            body.shape.for_files(&mut |key, wanted, file| each(&at("bodies", index, key), wanted, file))?;
        }
        for (index, driven) in self.driven.iter_mut().enumerate() {
            driven.shape.for_files(&mut |key, wanted, file| each(&at("driven", index, key), wanted, file))?;
        }
        Ok(())
    }
}

/// What things are made of. Between two materials friction and restitution are the geometric means of theirs, the
/// resistances the means, unless `pairs` says otherwise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Its name.
    pub name: String,
    /// Mass over volume.
    #[serde(default = "water")]
    pub density: Amount<amount::Density>,
    /// Coulomb's coefficient of friction.
    #[serde(default = "half::<amount::Friction>")]
    pub friction: Amount<amount::Friction>,
    /// How much of the speed an impact gives back.
    #[serde(default = "half::<amount::Restitution>")]
    pub restitution: Amount<amount::Restitution>,
    /// Resistance to rolling: the torque over force and radius. Wood 0.001 to 0.02.
    #[serde(default)]
    pub rolling: Amount<amount::Friction>,
    /// Resistance to spinning on one spot, likewise.
    #[serde(default)]
    pub spinning: Amount<amount::Friction>,
    /// Colour as on the web, `#c04030`. Unset: bodies have one each, scenery is grey.
    #[serde(default)]
    pub colour: String,
    /// What it looks like it is made of.
    #[serde(default)]
    pub finish: Finish,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            density: water(),
            friction: half(),
            restitution: half(),
            rolling: Amount::default(),
            spinning: Amount::default(),
            colour: String::new(),
            finish: Finish::default(),
        }
    }
}

fn water() -> Amount<amount::Density> {
    1000.0.into()
}

fn half<M>() -> Amount<M> {
    0.5.into()
}

/// What things look like they are made of; without influence on how they move.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Finish {
    /// Paper, chalk.
    Matte,
    /// Lacquer, plastic, marbles.
    #[default]
    Glossy,
    /// Lets light through.
    Glass,
    /// Steel.
    Metal,
    /// Planed and varnished.
    Wood,
    /// Cloth.
    Felt,
}

impl Finish {
    pub(super) fn material(self) -> animation::Material {
        match self {
            Self::Matte => animation::Material::Matte,
            Self::Glossy => animation::Material::Glossy,
            Self::Glass => animation::Material::Glass,
            Self::Metal => animation::Material::Metal,
            Self::Wood => animation::Material::Wood,
            Self::Felt => animation::Material::Felt,
        }
    }
}

/// What happens between two materials, or within one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pair {
    /// Names of the two materials; the same twice for one material on itself.
    pub between: [String; 2],
    /// Coulomb's coefficient of friction. Unset: the geometric mean of theirs.
    #[serde(default)]
    pub friction: Option<Amount<amount::Friction>>,
    /// How much of the speed an impact gives back. Unset: the geometric mean of theirs.
    #[serde(default)]
    pub restitution: Option<Amount<amount::Restitution>>,
    /// Resistance to rolling. Unset: the mean of theirs.
    #[serde(default)]
    pub rolling: Option<Amount<amount::Friction>>,
    /// Resistance to spinning on one spot. Unset: the mean of theirs.
    #[serde(default)]
    pub spinning: Option<Amount<amount::Friction>>,
}

/// A thing that stands still.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Fixed {
    /// Its name.
    pub name: String,
    /// How many there are of it: an array. They are called `peg_1`, `peg_2` and so on; in the arithmetic of its numbers
    /// `i` is 0 for the first, 1 for the next, and `n` is how many there are. Unset: one, called `peg`.
    #[serde(default)]
    #[schemars(range(min = 1, max = 4096))]
    pub count: Option<u32>,
    /// Its shape.
    pub shape: Still,
    /// The name of its material.
    #[serde(default)]
    pub material: String,
    /// Colour as on the web, `#c04030`. Unset: that of its material.
    #[serde(default)]
    pub colour: String,
    /// Where its middle is; of a plane any point of it.
    #[serde(default)]
    pub at_mm: [Amount<amount::Place>; 3],
    /// How it is turned: about the world's x axis, then about y, then about z.
    #[serde(default)]
    pub turn_deg: [Amount<amount::Angle>; 3],
}

/// A body that moves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// Its name, for requirements, tables and exports.
    pub name: String,
    /// How many there are of it: an array. They are called `ball_1`, `ball_2` and so on; in the arithmetic of its
    /// numbers `i` is 0 for the first, 1 for the next, and `n` is how many there are. Unset: one, called `ball`.
    #[serde(default)]
    #[schemars(range(min = 1, max = 4096))]
    pub count: Option<u32>,
    /// Its shape.
    pub shape: Shape,
    /// The name of its material.
    #[serde(default)]
    pub material: String,
    /// Colour as on the web, `#c04030`. Unset: that of its material.
    #[serde(default)]
    pub colour: String,
    /// Where its middle starts; of a hull the origin of its points.
    #[serde(default)]
    pub at_mm: [Amount<amount::Place>; 3],
    /// How it is turned at the start: about the world's x axis, then about y, then about z.
    #[serde(default)]
    pub turn_deg: [Amount<amount::Angle>; 3],
    /// Turned at random instead, all orientations alike.
    #[serde(default)]
    pub any_turn: bool,
    /// Its velocity at the start: that of its centre of gravity.
    #[serde(default)]
    pub velocity_m_s: [Amount<amount::Velocity>; 3],
    /// How fast it turns at the start, about the world's x, y and z axes.
    #[serde(default)]
    pub spin_deg_s: [Amount<amount::Turning>; 3],
    /// When it appears; until then nothing can touch it.
    #[serde(default)]
    pub release_s: Amount<amount::Moment>,
}
