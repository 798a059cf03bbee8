//! Scenes to sample plausible animations of, and the scenario files that describe them.
//!
//! ```
//! use plaus_dist::Seed;
//! use plaus_mcmc::{Chain, Goal};
//! use plaus_scenes::{Scenario, Scene, World, ball2d::Ball2d};
//!
//! // A ball bounces three times and should come to rest two diameters to the right.
//! let text = "[world.ball2d]\ncollisions = 3\nsigma_d = 0.05";
//! let scenario = Scenario::read("inline", text, &["target=2".into()])?;
//! let World::Ball2d(config) = &scenario.world else { return Ok(()) };
//! let ball = Ball2d::new(config)?;
//! let moves = ball.moves(&scenario.sampler.rules)?;
//! let mut chain = Chain::start(&ball, &moves, Seed(scenario.sampler.seed).chain(0))?;
//! while ball.class(chain.state().by_ref()).is_none() {
//!     chain.step()?;
//! }
//! let animation = ball.animate(&chain.state().draw)?;
//! assert_eq!(animation.motion.impacts.len(), 3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A [`Scene`] is a target with a goal, moves and animations; [`registry`] lists all there are; [`scenario`] reads the
//! files; [`require`] has what can be required of any of them; [`rules`] says whether acceptance is exact or as the
//! paper prints it.

#[cfg(not(feature = "schema"))]
extern crate plaus_no_schema as schemars;

mod accuracy;
mod any;
pub mod ball2d;
pub mod bowling;
pub mod custom;
pub mod dice;
mod engines;
mod failed;
pub mod files;
mod film;
pub mod import;
mod in_place;
mod loads;
mod look;
pub mod model;
pub mod registry;
pub mod require;
pub mod rules;
pub mod scenario;
mod scene;
mod settings;
pub mod spelling;
mod touch;
mod turns;
mod uneven;
mod way;
mod words;
mod world;

pub use accuracy::AccuracyPreset;
pub use files::{Assets, Files};
pub use model::{Member, Moves, Role, Scalar, Weights};
pub use plaus_animation as animation;
pub use plaus_animation::{Animation, Motion};
pub use registry::{AnyDraw, AnyOutcome, AnyScene, AnyScratch, World};
pub use require::{Answer, Asked};
pub use rules::Rules;
pub use scenario::Scenario;
pub use scene::{ConfigError, Scene, Until};
pub use world::{Physical, PlainWorld};

/// The scene of a scenario, under what is required besides: ready to be sampled. Made by [`Scenario::stage`].
pub type Stage = Asked<AnyScene>;
