//! An exact, event-driven rigid-body simulator.
//!
//! Every body has its own clock, and from there a motion in closed form: free flight, sliding, rolling, spinning, rest.
//! The loop takes the earliest event, brings only the bodies concerned to its time, resolves it and looks ahead again.
//! Collisions are found as roots of polynomials, so nothing tunnels at any speed, and there is no time step. Contact
//! that lasts and has no closed form (a marble in a bowl, a pile) advances in steps of its own group.
//!
//! A world is immutable. A [`State`] is data that can be cloned, serialised and resumed to the same bits. A [`Scratch`]
//! is work space for one thread. Units are SI throughout. The same input gives the same bits on every thread and at
//! every optimisation level. One [`Preset`] decides how exact a run is, and what it may cost.
//!
//! ```
//! use plaus_sim::glam::DVec3;
//! use plaus_sim::marbles::{MarbleSpec, MarbleWorld, Marbles, Start};
//! use plaus_sim::scenery::{Mesh, Plane, Scenery};
//! use plaus_sim::{Law, Laws, Material, Outcome, Scratch};
//!
//! let glass = Material(0);
//! let floor = Plane::new(DVec3::ZERO, DVec3::Z, glass)?;
//! let world = Marbles::new(MarbleWorld {
//!     specs: vec![MarbleSpec::solid(0.006, 0.0023, glass); 2],
//!     laws: Laws::uniform(Law::new(0.2, 0.7).with_resistance(0.01, 0.01))?,
//!     scenery: Scenery::new(vec![floor], Mesh::default(), Vec::new(), 0.006)?,
//!     ..MarbleWorld::default()
//! })?;
//! let starts = [Start::at_rest(DVec3::new(0.0, 0.0, 0.1)), Start::at_rest(DVec3::new(0.004, 0.0, 0.2))];
//! let mut state = world.state(&starts)?;
//! let outcome = world.run(&mut state, &mut Scratch::default(), 60.0, &mut ())?;
//! assert_eq!(outcome, Outcome::AllAtRest);
//! for (k, marble) in state.bodies().iter().enumerate() {
//!     assert!((world.at(k, marble, state.time()).path.x.z - 0.006).abs() < 1e-12);
//! }
//! # Ok::<(), plaus_sim::WorldError>(())
//! ```
//!
//! [`rigid`] has worlds of bodies that turn: dice, pins, hulls, compounds, with joints and keyframes. They are said,
//! run and read in the same way: a world with defaults ([`rigid::RigidWorld`]), `state`, `run`, `at`.
//!
//! Listening is optional and otherwise costs nothing: pass a [`trace::Trace`] for all motions and impacts,
//! [`trace::While`] to stop early, or `&mut ()`.
mod accuracy;
mod broad;
mod detect;
mod error;
pub mod field;
mod groups;
mod interrupt;
mod links;
pub mod marbles;
pub mod material;
pub mod mechanics;
pub mod motion;
mod outcome;
mod queue;
pub mod resolve;
pub mod rigid;
mod roll;
pub mod roots;
pub mod scenery;
pub mod shape;
mod simulate;
#[doc(hidden)]
pub mod special_case;
pub mod state;
pub mod trace;
mod work;
pub mod worlds;

pub use accuracy::{Accuracy, Preset};
pub use error::{ProfileError, SurfaceId, WorldError};
pub use glam;
pub use interrupt::{interruptible, is_interrupted};
pub use material::{Law, Laws, Material};
pub use outcome::Outcome;
pub use simulate::Scratch;
pub use state::State;
pub use work::work;
