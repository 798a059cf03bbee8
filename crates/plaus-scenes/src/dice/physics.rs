//! The start of a draw's motion, for other simulators.

use super::Dice;
use super::draw::Field;
use super::surface::{MATERIAL, Surface};
use super::throwing::GRAVITY;
use crate::animation::{Motion, Physics, Still};
use crate::engines;
use glam::DVec3;
use plaus_sim::WorldError;
use plaus_sim::shape::Shape;

/// The dice above the table.
pub(super) fn physics(scene: &Dice, motion: &Motion) -> Result<Physics, WorldError> {
    let plan = &scene.plan;
    let mut left_out = Vec::new();
    let laws = engines::laws(&plan.surface.laws()?, 1, &mut left_out);
    let mass = Shape::Cuboid(plan.cuboid).mass_properties(plan.density);
    let bodies: Vec<_> = motion.tracks.iter().map(|track| engines::rigid(track, &mass, MATERIAL, GRAVITY)).collect();
    if plan.cuboid.rounding() > 0.0 {
        left_out.push("dice: the rounding of their edges".into());
    }
    let still =
        |name: &str, collider| Still { name: name.into(), colliders: vec![collider], material: MATERIAL.0.into() };
    let mut scenery = Vec::new();
    if plan.surface.highest() > 0.0 {
        scenery.extend([still("surface", engines::drawn()), still("table", engines::drawn())]);
        left_out.push("table: that its bumps have no end: those that are drawn".into());
    } else {
        scenery.push(still("table", engines::plane(DVec3::ZERO, DVec3::Z)));
    }
    left_out.extend(varying(&plan.surface).map(|what| format!("table: that its {what} differs from place to place")));
    let all = (0..bodies.len()).collect();
    let no_contact = if plan.together || bodies.len() < 2 { Vec::new() } else { vec![all] };
    if !no_contact.is_empty() {
        left_out.push("that each die has a table of its own: there is one, as it is drawn".into());
    }
    Ok(Physics { bodies, scenery, laws, no_contact, left_out, ..Physics::default() })
}

/// What of a table depends on the place, beside its height.
fn varying(surface: &Surface) -> impl Iterator<Item = &'static str> {
    let fields = [(Field::Restitution, "restitution"), (Field::Friction, "friction")];
    let varies = |field: Field| surface.is_patched() || surface.random.contains(&field);
    fields.into_iter().filter(move |(field, _)| varies(*field)).map(|(_, what)| what)
}
