//! The same worlds in rapier3d-f64.

mod alley;
pub(crate) mod cast;
mod die;
mod marbles;

pub(crate) use alley::{AlleyParts, AlleyPeer};
pub(crate) use cast::{Cast, CastPeer, Pose};
pub(crate) use die::{DiePeer, Ground};
pub(crate) use marbles::MarblePeer;

use glam::DVec3;
use rapier3d_f64::prelude as peer;

pub(crate) const GRAVITY: f64 = 9.81;

/// A world that is simulated in steps, and ends early if everything is at rest.
struct Steps {
    world: peer::PhysicsWorld,
    rate: f64,
    done: u64,
    /// Speed in m/s, also of a turning surface, below which a body counts as still; and the bodies' size in m.
    slow: f64,
    size: f64,
    still: u64,
}

/// Speed over √(g · size) below which a body counts as still: about the speed at which our standard preset lets bodies
/// rest.
const SLOW: f64 = 0.03;
/// How long everything has to be still, in s.
const STILL: f64 = 0.1;

impl Steps {
    /// A world for bodies of about `size` metres.
    fn new(rate: f64, size: f64) -> Self {
        let gravity = peer::Vector::new(0.0, 0.0, -GRAVITY);
        let mut world = peer::PhysicsWorld { gravity, ..Default::default() };
        world.integration_parameters.dt = 1.0 / rate;
        // The length to which its tolerances are relative.
        world.integration_parameters.length_unit = 2.0 * size;
        // Speeds beyond 400 such lengths a second would be cut off: bodies that fall would stop to accelerate.
        world.integration_parameters.normalized_max_linear_velocity = f64::MAX;
        world.integration_parameters.friction_model = peer::FrictionModel::Coulomb;
        Self { world, rate, done: 0, slow: SLOW * (GRAVITY * size).sqrt(), size, still: 0 }
    }

    /// Time of the world in s.
    fn time(&self) -> f64 {
        self.done as f64 / self.rate
    }

    /// Steps that end at `time`.
    fn until(&self, time: f64) -> u64 {
        (time * self.rate).round() as u64
    }

    fn step(&mut self, hooks: &dyn peer::PhysicsHooks) {
        self.world.step_with_events(hooks, &());
        self.done += 1;
        let is_still = |body: &peer::RigidBody| {
            !body.is_dynamic()
                || body.is_sleeping()
                || body.linvel().length() < self.slow && body.angvel().length() * self.size < self.slow
        };
        self.still = if self.world.bodies.iter().all(|(_, body)| is_still(body)) { self.still + 1 } else { 0 };
    }

    /// Whether everything has been still for a while.
    fn is_at_rest(&self) -> bool {
        self.still as f64 >= STILL * self.rate
    }

    fn place(&self, body: peer::RigidBodyHandle) -> DVec3 {
        let p = self.world.bodies[body].translation();
        DVec3::new(p.x, p.y, p.z)
    }
}

fn vector(x: DVec3) -> peer::Vector {
    peer::Vector::new(x.x, x.y, x.z)
}

/// A box that fills the space behind a plane, as far as any body gets.
fn half_space(point: DVec3, normal: DVec3) -> peer::ColliderBuilder {
    const FAR: f64 = 30.0;
    const DEEP: f64 = 0.5;
    let half = DVec3::splat(FAR) - normal.abs() * (FAR - DEEP);
    peer::ColliderBuilder::cuboid(half.x, half.y, half.z).translation(vector(point - normal * DEEP))
}
