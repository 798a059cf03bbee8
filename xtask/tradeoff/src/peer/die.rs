//! A die on a table in rapier.

use super::{Steps, half_space, vector};
use glam::{DQuat, DVec3};
use plaus_figures::Result;
use plaus_sim::rigid::{Start, StaticShape};
use plaus_sim::worlds::DieOnTable;
use rapier3d_f64::prelude as peer;

/// A table in rapier's terms.
pub(crate) struct Ground(peer::ColliderBuilder);

/// The part of a bumpy table that is made, and the distance between its points, in m.
const EXTENT: [[f64; 2]; 2] = [[-0.5, 1.7], [-0.7, 0.7]];
const POINTS: f64 = 0.002;

impl Ground {
    pub(crate) fn of(part: &StaticShape) -> Result<Self> {
        let StaticShape::Table(table) = part else {
            return Ok(Self(half_space(DVec3::ZERO, DVec3::Z)));
        };
        let [[west, east], [south, north]] = EXTENT;
        let count = |low: f64, high: f64| ((high - low) / POINTS).round() as usize;
        let (columns, rows) = (count(west, east), count(south, north));
        let mut heights = peer::Array2::zeros(rows + 1, columns + 1);
        // A height field lies over x and z with y up: turned by a right angle about x, its z points against our y.
        for row in 0..=rows {
            for column in 0..=columns {
                let (x, y) = (west + column as f64 * POINTS, north - row as f64 * POINTS);
                heights[(row, column)] = table.height.value(x, y);
            }
        }
        let scale = peer::Vector::new(east - west, 1.0, north - south);
        let middle = peer::Vector::new(0.5 * (west + east), 0.5 * (south + north), 0.0);
        let upright = peer::AngVector::new(std::f64::consts::FRAC_PI_2, 0.0, 0.0);
        Ok(Self(peer::ColliderBuilder::heightfield(heights, scale).translation(middle).rotation(upright)))
    }
}

pub(crate) struct DiePeer {
    steps: Steps,
    handle: peer::RigidBodyHandle,
}

impl DiePeer {
    pub(crate) fn new(die: &DieOnTable, ground: &Ground, start: &Start, rate: f64) -> Self {
        let mut steps = Steps::new(rate, 0.5 * die.edges.x);
        let world = &mut steps.world;
        let dress = |c: peer::ColliderBuilder| c.friction(die.law.friction).restitution(die.law.restitution);
        world.colliders.insert(dress(ground.0.clone()));
        let q = start.orientation;
        let pose = peer::Pose::from_parts(vector(start.position), peer::Rotation::from_xyzw(q.x, q.y, q.z, q.w));
        let body = peer::RigidBodyBuilder::dynamic()
            .pose(pose)
            .linvel(vector(start.velocity))
            .angvel(vector(start.spin))
            .ccd_enabled(true);
        let handle = world.bodies.insert(body);
        let half = 0.5 * die.edges;
        let cube = dress(peer::ColliderBuilder::cuboid(half.x, half.y, half.z).density(die.density));
        world.colliders.insert_with_parent(cube, handle, &mut world.bodies);
        Self { steps, handle }
    }

    /// Steps to `time`, or until the die rests.
    pub(crate) fn run_to(&mut self, time: f64) {
        while self.steps.done < self.steps.until(time) && !self.steps.is_at_rest() {
            self.steps.step(&());
        }
    }

    /// Centre, and rotation from body axes to world axes.
    pub(crate) fn pose(&self) -> (DVec3, DQuat) {
        let q = self.steps.world.bodies[self.handle].rotation();
        (self.steps.place(self.handle), DQuat::from_xyzw(q.x, q.y, q.z, q.w))
    }
}
