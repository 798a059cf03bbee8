//! A double pendulum of two rods.

use crate::peer::cast::cuboid;
use crate::peer::{Cast, Pose};
use crate::staged::Setting;
use crate::world::{Outcome, Reading};
use glam::{DQuat, DVec3};
use plaus_dist::{Stream, math, open_unit};
use plaus_figures::Result;
use plaus_sim::rigid::{BodySpec, Joint, Start};
use plaus_sim::shape::{Cuboid, Shape};
use plaus_sim::{Law, Material};

/// Edges of the rods in m; they hang from the ends of each other.
const RODS: [DVec3; 2] = [DVec3::new(0.06, 0.1, 0.5), DVec3::new(0.05, 0.06, 0.4)];
/// Angles that are told apart, in radians.
const ANGLE: f64 = 0.2;
const ANGLES: usize = 32;

pub(crate) struct Pendulum;

/// Starts of rods at these angles from hanging down, and where the second hangs on the first.
fn hanging(angles: [f64; 2]) -> ([Start; 2], DVec3) {
    let turns = angles.map(|angle| DQuat::from_rotation_y(-angle));
    let elbow = turns[0] * DVec3::NEG_Z * RODS[0].z;
    let at = [0.5 * elbow, elbow + turns[1] * DVec3::NEG_Z * (0.5 * RODS[1].z)];
    ([0, 1].map(|k| Start { orientation: turns[k], ..Start::at_rest(at[k]) }), elbow)
}

impl Setting for Pendulum {
    fn name(&self) -> &'static str {
        "pendulum"
    }

    fn title(&self) -> &'static str {
        "A double pendulum"
    }

    fn about(&self) -> String {
        "Two rods, 500 and 400 mm long, on hinges, let go at 0.5 to 1.5 and −1 to 2 rad. Read: the angles of both rods \
         after 2.5 s, in steps of 0.2 rad."
            .into()
    }

    fn cast(&self) -> Result<Cast> {
        let body = |edges: DVec3| -> Result<_> {
            let shape = Shape::Cuboid(Cuboid::new(edges, 0.0)?);
            Ok((BodySpec::solid(shape, 1000.0, Material(0)), cuboid(edges)))
        };
        let (starts, elbow) = hanging([0.0; 2]);
        let joints = vec![
            Joint::hinge(DVec3::ZERO, DVec3::Y, 0, &starts[0]),
            Joint::hinge(elbow, DVec3::Y, 0, &starts[0]).to(1, &starts[1]),
        ];
        let bodies = vec![body(RODS[0])?, body(RODS[1])?];
        Ok(Cast { bodies, parts: Vec::new(), law: Law::new(0.0, 1.0), joints, size: 0.03 })
    }

    fn starts(&self, stream: &mut Stream) -> Vec<Start> {
        let mut between = |low: f64, high: f64| low + (high - low) * open_unit(stream);
        hanging([between(0.5, 1.5), between(-1.0, 2.0)]).0.to_vec()
    }

    fn readings(&self) -> Vec<Reading> {
        let second = Reading { name: "angle of the second", categories: ANGLES };
        vec![Reading { name: "angle of the first", categories: ANGLES }, second]
    }

    fn read(&self, ends: &[Pose]) -> Outcome {
        let angle = |(_, turn): &Pose| {
            let down = *turn * DVec3::NEG_Z;
            let angle = math::atan2(down.x, -down.z);
            ((angle / ANGLE + 0.5 * ANGLES as f64).floor().max(0.0) as usize).min(ANGLES - 1) as u16
        };
        ends.iter().map(|end| vec![angle(end)]).collect()
    }

    fn tolerance(&self) -> f64 {
        0.005
    }

    fn duration(&self) -> f64 {
        2.5
    }

    fn lowest(&self) -> f64 {
        let masses = RODS.map(|r| r.x * r.y * r.z);
        -(masses[0] * 0.5 * RODS[0].z + masses[1] * (RODS[0].z + 0.5 * RODS[1].z)) / (masses[0] + masses[1])
    }
}
