//! Both kinds of worlds, behind one interface for batches.

use glam::{DQuat, DVec3};
use plaus_scenes::Physical;
use plaus_sim::marbles::{self, Marble, Marbles};
use plaus_sim::mechanics::Mechanics;
use plaus_sim::rigid::{self, RigidBodyState, RigidWorld};
use plaus_sim::trace::Observer;
use plaus_sim::{Outcome, Scratch, State, WorldError};

/// How many bodies a world has.
pub(super) fn bodies(world: &Physical) -> usize {
    match world {
        Physical::Marbles(world) => world.specs().len(),
        Physical::Rigid(world) => world.count(),
    }
}

/// The start of a body of any kind.
#[derive(Debug, Clone, Copy)]
pub(super) struct Start {
    pub(super) position: DVec3,
    pub(super) velocity: DVec3,
    pub(super) spin: DVec3,
    pub(super) orientation: DQuat,
    pub(super) release: f64,
}

/// Where a body is and how it moves.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pose {
    pub(super) position: DVec3,
    pub(super) velocity: DVec3,
    pub(super) spin: DVec3,
    pub(super) orientation: DQuat,
}

/// What a batch asks of a world.
pub(super) trait Engine: Mechanics + Sized {
    fn begin(&self, starts: &[Start]) -> Result<State<Self::Body>, WorldError>;

    fn go(
        &self,
        state: &mut State<Self::Body>,
        scratch: &mut Scratch<Self::Scratch>,
        until: f64,
        observer: &mut impl Observer<Self>,
    ) -> Result<Outcome, WorldError>;

    fn pose(body: &Self::Body) -> Pose;

    /// The pose of the body at a time within its motion.
    fn pose_at(&self, index: usize, body: &Self::Body, time: f64) -> Pose {
        let mut moved = body.clone();
        if self.is_present(body) && self.is_finite(body) {
            self.advance(index, &mut moved, time.max(self.clock(body)));
        }
        Self::pose(&moved)
    }
}

impl Engine for Marbles {
    fn begin(&self, starts: &[Start]) -> Result<State<Marble>, WorldError> {
        let start =
            |s: &Start| marbles::Start { position: s.position, velocity: s.velocity, spin: s.spin, time: s.release };
        self.state(&starts.iter().map(start).collect::<Vec<_>>())
    }

    fn go(
        &self,
        state: &mut State<Marble>,
        scratch: &mut Scratch<Self::Scratch>,
        until: f64,
        observer: &mut impl Observer<Self>,
    ) -> Result<Outcome, WorldError> {
        self.run(state, scratch, until, observer)
    }

    fn pose(body: &Marble) -> Pose {
        let (path, spin) = (body.path, body.spin);
        Pose { position: path.x, velocity: path.v, spin, orientation: DQuat::IDENTITY }
    }
}

impl Engine for RigidWorld {
    fn begin(&self, starts: &[Start]) -> Result<State<RigidBodyState>, WorldError> {
        let start = |s: &Start| rigid::Start {
            position: s.position,
            orientation: s.orientation,
            velocity: s.velocity,
            spin: s.spin,
            time: s.release,
        };
        self.state(&starts.iter().map(start).collect::<Vec<_>>())
    }

    fn go(
        &self,
        state: &mut State<RigidBodyState>,
        scratch: &mut Scratch<Self::Scratch>,
        until: f64,
        observer: &mut impl Observer<Self>,
    ) -> Result<Outcome, WorldError> {
        self.run(state, scratch, until, observer)
    }

    fn pose(body: &RigidBodyState) -> Pose {
        Pose { position: body.path.x, velocity: body.path.v, spin: body.spin, orientation: body.turn }
    }
}
