//! The start of a draw's motion, for other simulators.

use super::arena::{Arena, BOX, GRAVITY, MATERIALS};
use super::draw::Drops;
use crate::animation::{Motion, Physics, Still};
use crate::engines;
use glam::DVec3;
use plaus_sim::WorldError;
use plaus_sim::scenery::Plane;
use plaus_sim::shape::MassProperties;

/// All balls that are dropped, where that happens, and the box.
pub(super) fn physics(arena: &Arena, draw: &Drops, motion: &Motion) -> Result<Physics, WorldError> {
    let mut left_out = Vec::new();
    let laws = engines::laws(&arena.laws, MATERIALS, &mut left_out);
    let ball = arena.ball();
    let inertia = DVec3::splat(ball.gyration * ball.mass * ball.radius * ball.radius);
    let mass = MassProperties { mass: ball.mass, inertia };
    let rigid = |track| engines::rigid(track, &mass, ball.material, GRAVITY);
    let bodies: Vec<_> = motion.tracks.iter().map(rigid).collect();
    if arena.starts(draw).flatten().any(|start| start.time > 0.0) {
        left_out.push("that balls are dropped one after the other: they begin together, and may overlap".into());
    }
    left_out.push("floor: how round its bowls are: what is drawn of them".into());
    let wall = |plane: &Plane| Still {
        name: super::animate::wall(plane.normal).to_owned(),
        colliders: vec![engines::plane(plane.offset * plane.normal, plane.normal)],
        material: plane.material.0.into(),
    };
    let drawn = |name: &str| Still { name: name.into(), colliders: vec![engines::drawn()], material: BOX.0.into() };
    let scenery = ["partitions", "floor"].map(drawn).into_iter();
    let scenery = scenery.chain(arena.bins.walls()?.iter().map(wall)).collect();
    let all = (0..bodies.len()).collect();
    let no_contact = if arena.touch || bodies.len() < 2 { Vec::new() } else { vec![all] };
    Ok(Physics { bodies, scenery, laws, no_contact, left_out, ..Physics::default() })
}
