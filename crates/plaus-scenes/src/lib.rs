//! Scenes to sample plausible animations of, and the scenario files that describe them.

pub mod animation;
pub mod ball2d;
pub mod registry;
pub mod rules;
pub mod scenario;
pub mod scene;

pub use animation::Animation;
pub use registry::{Visitor, World};
pub use rules::Rules;
pub use scenario::Scenario;
pub use scene::{ConfigError, Role, Scalar, Scene};
