//! All scenes there are. A new scene is one line here.

use crate::files::{Assets, Files};
use crate::scene::{ConfigError, Scene};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Something to do with a scene whose type is known only from the scenario file.
pub trait Visitor {
    /// What comes of it.
    type Output;
    /// Does it.
    fn visit<S: Scene>(self, scene: S) -> Self::Output;
}

macro_rules! scenes {
    ($($(#[$doc:meta])* $name:literal $variant:ident => $module:ident,)+) => {
        /// The world of a scenario: which scene, and its settings.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
        pub enum World {
            $($(#[$doc])* #[serde(rename = $name)] $variant(Box<crate::$module::Config>),)+
        }

        /// Names of all scenes, as in `[world.NAME]`.
        pub const NAMES: &[&str] = &[$($name),+];

        impl World {
            /// The scene's name.
            #[must_use]
            pub fn name(&self) -> &'static str {
                match self { $(Self::$variant(_) => $name),+ }
            }

            /// The world of a scene with all settings at their defaults.
            #[must_use]
            pub fn default_of(name: &str) -> Option<Self> {
                match name { $($name => Some(Self::$variant(Box::default())),)+ _ => None }
            }

            /// Whether its moves' scales are adapted where a scenario does not say.
            #[must_use]
            pub fn adapts(&self) -> bool {
                match self { $(Self::$variant(_) => <crate::$module::$variant as Scene>::ADAPTS),+ }
            }

            /// Builds the scene and hands it to `visitor`.
            ///
            /// # Errors
            /// [`ConfigError`] where the settings make no scene.
            pub fn visit<V: Visitor>(&self, visitor: V) -> Result<V::Output, ConfigError> {
                match self { $(Self::$variant(config) => Ok(visitor.visit(crate::$module::$variant::new(config)?))),+ }
            }
        }
    };
}

scenes! {
    /// A ball bounces on a table whose surface normal is uncertain at every bounce; it should come to rest in a given
    /// place.
    "ball2d" Ball2d => ball2d,
    /// A ball is bowled at ten-pins; those pins should be left standing that are asked for.
    "bowling" Bowling => bowling,
    /// Balls are dropped one after the other into a box of bins and should come to rest so that they spell a word.
    "spelling" Spelling => spelling,
    /// Dice are thrown onto a table of random height, restitution and friction, and should come to rest where and as
    /// demanded.
    "dice" Dice => dice,
    /// A world of your own: bodies and scenery, what they are made of, and what is uncertain about them.
    "custom" Custom => custom,
}

impl World {
    /// Reads the files that it names.
    pub(crate) fn load(&mut self, files: &dyn Files) -> Result<(), ConfigError> {
        match self {
            Self::Custom(config) => config.load(files),
            _ => Ok(()),
        }
    }

    /// The files that it names, as they were read.
    #[must_use]
    pub fn assets(&self) -> Assets {
        match self {
            Self::Custom(config) => config.assets(),
            _ => Assets::default(),
        }
    }
}
