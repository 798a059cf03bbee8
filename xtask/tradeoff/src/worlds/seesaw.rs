//! A seesaw: a weight falls on one end and throws up the one on the other.

use crate::peer::cast::{cuboid, floor};
use crate::peer::{Cast, Pose};
use crate::staged::Setting;
use crate::world::{Outcome, Reading};
use glam::{DQuat, DVec3};
use plaus_dist::{Stream, open_unit};
use plaus_figures::Result;
use plaus_sim::rigid::{BodySpec, Joint, Start};
use plaus_sim::shape::{Cuboid, Shape};
use plaus_sim::{Law, Material};

const PLANK: DVec3 = DVec3::new(0.4, 0.06, 0.01);
const WEIGHT: f64 = 0.04;
/// Height of the axle in m, and the angle at which the plank's lower end is just above the floor.
const AXLE: f64 = 0.06;
const TILT: f64 = 0.24;
/// Strips of this width in m, across which the thrown weight can end.
const STRIP: f64 = 0.1;
const STRIPS: usize = 16;

pub(crate) struct Seesaw;

fn plank() -> Start {
    Start { orientation: DQuat::from_rotation_y(-TILT), ..Start::at_rest(DVec3::Z * AXLE) }
}

impl Setting for Seesaw {
    fn name(&self) -> &'static str {
        "seesaw"
    }

    fn title(&self) -> &'static str {
        "A seesaw"
    }

    fn about(&self) -> String {
        "A plank of 400 mm on a hinge 60 mm above the floor; a cube of 40 mm lies on its lower end, another falls on \
         the upper one from 0.2 to 0.5 m; friction 0.5, restitution 0.2. Read: where the first cube ends along the \
         plank, in strips of 100 mm; where the second."
            .into()
    }

    fn cast(&self) -> Result<Cast> {
        let body = |edges: DVec3, density: f64| -> Result<_> {
            let shape = Shape::Cuboid(Cuboid::new(edges, 0.0)?);
            Ok((BodySpec::solid(shape, density, Material(0)), cuboid(edges)))
        };
        let cube = DVec3::splat(WEIGHT);
        Ok(Cast {
            bodies: vec![body(PLANK, 600.0)?, body(cube, 800.0)?, body(cube, 2400.0)?],
            parts: vec![floor(0.0)?],
            law: Law::new(0.5, 0.2),
            joints: vec![Joint::hinge(DVec3::Z * AXLE, DVec3::Y, 0, &plank())],
            size: 0.5 * WEIGHT,
        })
    }

    fn starts(&self, stream: &mut Stream) -> Vec<Start> {
        let mut between = |low: f64, high: f64| low + (high - low) * open_unit(stream);
        let plank = plank();
        // Turned by −TILT about y, the end at −x is the lower one.
        let above = 0.5 * (PLANK.z + WEIGHT) + 1e-4;
        let lies = plank.position + plank.orientation * DVec3::new(-between(0.15, 0.17), between(-0.01, 0.01), above);
        let turn = DQuat::from_rotation_z(between(-0.5, 0.5));
        let falls = DVec3::new(between(0.13, 0.18), between(-0.01, 0.01), AXLE + between(0.2, 0.5));
        let lying = Start { orientation: plank.orientation, ..Start::at_rest(lies) };
        vec![plank, lying, Start { orientation: turn, ..Start::at_rest(falls) }]
    }

    fn readings(&self) -> Vec<Reading> {
        let second = Reading { name: "place of the second", categories: STRIPS };
        vec![Reading { name: "place of the first", categories: STRIPS }, second]
    }

    fn read(&self, ends: &[Pose]) -> Outcome {
        let strip = |x: f64| ((x / STRIP + 0.5 * STRIPS as f64).floor().max(0.0) as usize).min(STRIPS - 1) as u16;
        vec![vec![strip(ends[1].0.x)], vec![strip(ends[2].0.x)]]
    }

    fn tolerance(&self) -> f64 {
        0.1 * WEIGHT
    }

    fn duration(&self) -> f64 {
        4.0
    }
}
