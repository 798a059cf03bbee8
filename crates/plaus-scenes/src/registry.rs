//! All scenes. A new scene is one line here.

use crate::files::{Assets, Files};
use crate::scene::{ConfigError, Scene};
use plaus_mcmc::{StateRef, StateRefOf, Target};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One of [all](World) scenes: it finds its own type in values that may belong to any scene.
pub(crate) trait Known: Scene {
    fn of(scene: &AnyScene) -> &Self;
    fn draw(draw: &AnyDraw) -> &Self::Draw;
    fn draw_mut(draw: &mut AnyDraw) -> &mut Self::Draw;
    fn outcome(outcome: &AnyOutcome) -> &Self::Outcome;
    /// Replaced by a new one if it belongs to another scene.
    fn scratch(scratch: &mut AnyScratch) -> &mut Self::Scratch;
    /// The memory, if it is this scene's.
    fn scratch_kept(scratch: &AnyScratch) -> Option<&Self::Scratch>;
    fn any(self) -> AnyScene;
    fn any_draw(draw: Self::Draw) -> AnyDraw;
    fn any_outcome(outcome: Self::Outcome) -> AnyOutcome;

    fn state(state: StateRefOf<'_, AnyScene>) -> StateRefOf<'_, Self> {
        let StateRef { draw, outcome, log_prior, log_constraint } = state;
        StateRef { draw: Self::draw(draw), outcome: Self::outcome(outcome), log_prior, log_constraint }
    }
}

/// Not reached, because draws, outcomes and moves are only used with the scene that made them: a run says which scene
/// that is, and is refused if its scenario now makes another one.
fn of_another_scene() -> ! {
    unreachable!("a draw, an outcome or a move of another scene")
}

// `$d` is the dollar sign: a macro made by a macro needs it for its own parameters.
macro_rules! scenes {
    ($d:tt $($(#[$doc:meta])* $name:literal $variant:ident => $module:ident,)+) => {
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

            /// The scene.
            ///
            /// # Errors
            /// [`ConfigError`] if the settings are invalid.
            pub fn scene(&self) -> Result<AnyScene, ConfigError> {
                match self { $(Self::$variant(config) => Ok(crate::$module::$variant::new(config)?.any())),+ }
            }
        }

        /// One of the scenes, if only a scenario says which. Code that samples, reads and shows runs is compiled for
        /// this type alone.
        #[derive(Debug)]
        pub enum AnyScene {
            $($(#[$doc])* $variant(Box<crate::$module::$variant>),)+
        }

        /// A draw of one of the scenes.
        #[derive(Debug, PartialEq, Serialize, Deserialize)]
        #[expect(missing_docs, reason = "its variants are those of `AnyScene`")]
        pub enum AnyDraw {
            $($variant(<crate::$module::$variant as Target>::Draw),)+
        }

        impl Clone for AnyDraw {
            fn clone(&self) -> Self {
                match self { $(Self::$variant(draw) => Self::$variant(draw.clone()),)+ }
            }

            fn clone_from(&mut self, from: &Self) {
                match (self, from) {
                    $((Self::$variant(draw), Self::$variant(from)) => draw.clone_from(from),)+
                    (draw, from) => *draw = from.clone(),
                }
            }
        }

        /// An outcome of one of the scenes.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
        #[expect(missing_docs, reason = "its variants are those of `AnyScene`")]
        pub enum AnyOutcome {
            $($variant(<crate::$module::$variant as Target>::Outcome),)+
        }

        /// Working memory for one of the scenes.
        #[derive(Default)]
        #[expect(missing_docs, reason = "its variants are those of `AnyScene`")]
        pub enum AnyScratch {
            /// Not yet used; any scene may take it.
            #[default]
            New,
            $($variant(Box<<crate::$module::$variant as Target>::Scratch>),)+
        }

        $(impl Known for crate::$module::$variant {
            fn of(scene: &AnyScene) -> &Self {
                if let AnyScene::$variant(scene) = scene { scene } else { of_another_scene() }
            }

            fn draw(draw: &AnyDraw) -> &Self::Draw {
                if let AnyDraw::$variant(draw) = draw { draw } else { of_another_scene() }
            }

            fn draw_mut(draw: &mut AnyDraw) -> &mut Self::Draw {
                if let AnyDraw::$variant(draw) = draw { draw } else { of_another_scene() }
            }

            fn outcome(outcome: &AnyOutcome) -> &Self::Outcome {
                if let AnyOutcome::$variant(outcome) = outcome { outcome } else { of_another_scene() }
            }

            fn scratch(scratch: &mut AnyScratch) -> &mut Self::Scratch {
                if !matches!(scratch, AnyScratch::$variant(_)) {
                    *scratch = AnyScratch::$variant(Box::default());
                }
                if let AnyScratch::$variant(scratch) = scratch { scratch } else { of_another_scene() }
            }

            fn scratch_kept(scratch: &AnyScratch) -> Option<&Self::Scratch> {
                if let AnyScratch::$variant(scratch) = scratch { Some(scratch) } else { None }
            }

            fn any(self) -> AnyScene {
                AnyScene::$variant(Box::new(self))
            }

            fn any_draw(draw: Self::Draw) -> AnyDraw {
                AnyDraw::$variant(draw)
            }

            fn any_outcome(outcome: Self::Outcome) -> AnyOutcome {
                AnyOutcome::$variant(outcome)
            }
        })+

        /// Evaluates the same expression for any of the scenes, in which it may name the scene's type.
        macro_rules! with_scene {
            ($d of:expr, $d scene:ident $d (: $d own:ident)? => $d body:expr) => {
                match $d of {
                    $($crate::registry::AnyScene::$variant($d scene) => {
                        $d (type $d own = $crate::$module::$variant;)?
                        $d body
                    })+
                }
            };
        }
        pub(crate) use with_scene;
    };
}

scenes! {
    $
    /// A ball bounces on a table whose surface normal is uncertain at every bounce; it should come to rest in a given
    /// place.
    "ball2d" Ball2d => ball2d,
    /// A ball is bowled at ten-pins; the chosen pins should be left standing.
    "bowling" Bowling => bowling,
    /// Balls are dropped one after the other into a box of bins, and should come to rest in bins that spell a word.
    "spelling" Spelling => spelling,
    /// Dice are thrown onto a table of random height, restitution and friction, and should come to rest as asked.
    "dice" Dice => dice,
    /// A world of your own: bodies and scenery, what they are made of, and what is uncertain about them.
    "custom" Custom => custom,
}

impl World {
    /// Whether its moves' scales are adapted if a scenario does not say; true for scenes in which that was measured to
    /// be better.
    #[must_use]
    pub fn adapts(&self) -> bool {
        matches!(self, Self::Dice(_) | Self::Bowling(_) | Self::Spelling(_))
    }

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
