//! Newton's cradle: five balls on strings.

use crate::peer::{Cast, Pose};
use crate::staged::Setting;
use crate::world::{Outcome, Reading};
use glam::{DQuat, DVec3};
use plaus_dist::{Stream, open_unit};
use plaus_figures::Result;
use plaus_sim::rigid::{BodySpec, Joint, Start};
use plaus_sim::shape::Shape;
use plaus_sim::{Law, Material};
use rapier3d_f64::prelude::ColliderBuilder;

const COUNT: usize = 5;
const RADIUS: f64 = 0.015;
/// Length of a string from the hinge to the middle of its ball, in m.
const STRING: f64 = 0.15;
/// Distance between two balls that hang, in m.
const GAP: f64 = 1e-4;
/// Angles that are told apart, in radians.
const ANGLE: f64 = 0.1;
const ANGLES: usize = 16;

pub(crate) struct Cradle;

/// The start of a ball that is raised by an angle.
fn raised(ball: usize, angle: f64) -> Start {
    let hinge = DVec3::X * (ball as f64 * (2.0 * RADIUS + GAP));
    let turn = DQuat::from_rotation_y(angle);
    Start { orientation: turn, ..Start::at_rest(hinge + turn * (DVec3::NEG_Z * STRING)) }
}

impl Setting for Cradle {
    fn name(&self) -> &'static str {
        "cradle"
    }

    fn title(&self) -> &'static str {
        "Newton's cradle"
    }

    fn about(&self) -> String {
        "Five balls of radius 15 mm on hinges 150 mm above their middles, 0.1 mm apart; the first is raised by 0.3 to \
         0.9 rad; no friction, restitution 1. Read: the angles of all balls after 2.5 s, in steps of 0.1 rad."
            .into()
    }

    fn cast(&self) -> Result<Cast> {
        let ball = BodySpec::solid(Shape::Ball(RADIUS), 7800.0, Material(0));
        let hinge = |k: usize| {
            let start = raised(k, 0.0);
            Joint::hinge(start.position + DVec3::Z * STRING, DVec3::Y, k, &start)
        };
        Ok(Cast {
            bodies: vec![(ball, ColliderBuilder::ball(RADIUS)); COUNT],
            parts: Vec::new(),
            law: Law::new(0.0, 1.0),
            joints: (0..COUNT).map(hinge).collect(),
            size: RADIUS,
        })
    }

    fn starts(&self, stream: &mut Stream) -> Vec<Start> {
        let angle = 0.3 + 0.6 * open_unit(stream);
        (0..COUNT).map(|k| raised(k, if k == 0 { angle } else { 0.0 })).collect()
    }

    fn readings(&self) -> Vec<Reading> {
        vec![Reading { name: "angle of a ball", categories: ANGLES }]
    }

    fn read(&self, ends: &[Pose]) -> Outcome {
        let angle = |(_, turn): &Pose| {
            let down = *turn * DVec3::NEG_Z;
            let angle = plaus_dist::math::atan2(-down.x, -down.z);
            ((angle / ANGLE + 0.5 * ANGLES as f64).floor().max(0.0) as usize).min(ANGLES - 1) as u16
        };
        vec![ends.iter().map(angle).collect()]
    }

    fn tolerance(&self) -> f64 {
        0.05 * RADIUS
    }

    fn duration(&self) -> f64 {
        2.5
    }

    fn lowest(&self) -> f64 {
        -STRING
    }
}
