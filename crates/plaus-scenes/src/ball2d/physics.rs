//! The start of a draw's motion, for other simulators.

use super::animate::DENSITY;
use super::{Config, GRAVITY};
use crate::animation::{Motion, Physics, Still};
use crate::engines;
use glam::DVec3;
use plaus_sim::Material;
use plaus_sim::shape::{Frustum, Shape};

/// A disc above a level table.
pub(super) fn physics(config: &Config, motion: &Motion) -> Result<Physics, plaus_sim::WorldError> {
    let mut bodies = Vec::new();
    for track in &motion.tracks {
        let crate::animation::Shape::Disc { radius, thickness } = *track.shape else { continue };
        let disc = Shape::from(Frustum::cylinder(radius, thickness)?);
        bodies.push(engines::rigid(track, &disc.mass_properties(DENSITY), Material(0), GRAVITY));
    }
    let table = Still { name: "table".into(), colliders: vec![engines::plane(DVec3::ZERO, DVec3::Z)], material: 0 };
    Ok(Physics {
        bodies,
        scenery: vec![table],
        laws: vec![vec![[0.0, config.restitution, 0.0]]],
        left_out: vec![
            "table: the random normals of bounces: it is level".into(),
            "ball_0: that it moves in a plane and does not turn".into(),
        ],
        ..Physics::default()
    })
}
