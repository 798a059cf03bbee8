//! A row of twenty dominoes.

use crate::peer::cast::{cuboid, floor};
use crate::peer::{Cast, Pose};
use crate::staged::Setting;
use crate::world::{Outcome, Reading};
use glam::DVec3;
use plaus_dist::{Stream, open_unit};
use plaus_figures::Result;
use plaus_sim::rigid::{BodySpec, Start};
use plaus_sim::shape::{Cuboid, Shape};
use plaus_sim::{Law, Material};

const COUNT: usize = 20;
const EDGES: DVec3 = DVec3::new(0.008, 0.024, 0.048);
/// Heights of the last domino's middle that are told apart, in strips of this width in m.
const STRIP: f64 = 0.004;
const STRIPS: usize = 8;

pub(crate) struct Dominoes;

impl Setting for Dominoes {
    fn name(&self) -> &'static str {
        "dominoes"
    }

    fn title(&self) -> &'static str {
        "Twenty dominoes"
    }

    fn about(&self) -> String {
        "Twenty dominoes of 8 × 24 × 48 mm with gaps of 0.35 to 0.75 of their height, turned by up to 10°; the first \
         is pushed over; friction 0.3, restitution 0.2. Read: how many fell; how high the last one's middle ends, in strips of 4 mm."
            .into()
    }

    fn cast(&self) -> Result<Cast> {
        let shape = Shape::Cuboid(Cuboid::new(EDGES, 0.0)?);
        Ok(Cast {
            bodies: vec![(BodySpec::solid(shape, 1200.0, Material(0)), cuboid(EDGES)); COUNT],
            parts: vec![floor(0.0)?],
            law: Law::new(0.3, 0.2),
            joints: Vec::new(),
            size: 0.5 * EDGES.x,
        })
    }

    fn starts(&self, stream: &mut Stream) -> Vec<Start> {
        let mut between = |low: f64, high: f64| low + (high - low) * open_unit(stream);
        let mut x = 0.0;
        let mut starts = Vec::with_capacity(COUNT);
        for _ in 0..COUNT {
            let mut start = Start::at_rest(DVec3::new(x, 0.0, 0.5 * EDGES.z));
            start.orientation = glam::DQuat::from_rotation_z(between(-0.17, 0.17));
            starts.push(start);
            x += EDGES.x + between(0.35, 0.75) * EDGES.z;
        }
        // It tips about its lower front edge.
        let first = &mut starts[0];
        let (forward, across) = (first.orientation * DVec3::X, first.orientation * DVec3::Y);
        first.spin = across * between(12.0, 18.0);
        first.velocity = first.spin.cross(forward * (-0.5 * EDGES.x) + DVec3::Z * (0.5 * EDGES.z));
        starts
    }

    fn readings(&self) -> Vec<Reading> {
        let place = Reading { name: "height of the last", categories: STRIPS };
        vec![Reading { name: "fallen", categories: COUNT + 1 }, place]
    }

    fn read(&self, ends: &[Pose]) -> Outcome {
        let fallen = ends.iter().filter(|(_, turn)| (*turn * DVec3::Z).z < 0.8).count();
        let last = ends[COUNT - 1].0;
        // One that lies flat is in the middle of a strip.
        let strip = ((last.z / STRIP).round().max(0.0) as usize).min(STRIPS - 1);
        vec![vec![fallen as u16], vec![strip as u16]]
    }

    fn tolerance(&self) -> f64 {
        0.1 * EDGES.x
    }

    fn duration(&self) -> f64 {
        4.0
    }

    fn patience(&self) -> f64 {
        3.0
    }
}
