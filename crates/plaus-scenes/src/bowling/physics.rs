//! The start of a draw's motion, for other simulators.

use super::alley::{Alley, GRAVITY};
use super::draw::Shot;
use super::lane::Lane;
use crate::animation::{Collider, Motion, Physics, Solid, Still, upright};
use crate::engines;
use glam::DQuat;
use plaus_sim::WorldError;
use plaus_sim::rigid::StaticShape;

/// The ball where its motion begins, the pins on their spots, and the alley.
pub(super) fn physics(lane: &Lane, draw: &Shot, motion: &Motion) -> Result<Physics, WorldError> {
    let alley = lane.alley(draw);
    let mut left_out = Vec::new();
    let laws = engines::laws(&alley.laws()?, Alley::MATERIALS, &mut left_out);
    left_out.push("that bodies are gone below a height".into());
    if alley.oil > 0.0 {
        left_out.push("lane: the friction of its oil: it is dry".into());
    }
    let specs = alley.bodies(&lane.pin);
    if specs.len() > 1 {
        left_out.push("pins: their hollows: the convex hulls of their outlines".into());
    }
    let spec = |name: &str| (0..specs.len()).find(|&body| lane.name(body) == name).map(|body| &specs[body]);
    let rigid =
        |(track, spec): (_, &plaus_sim::rigid::BodySpec)| engines::rigid(track, &spec.mass, spec.material, GRAVITY);
    let bodies = motion.tracks.iter().filter_map(|track| Some((track, spec(&track.name)?))).map(rigid).collect();
    let still = |(name, part): (&str, &StaticShape)| {
        let (collider, material) = match part {
            StaticShape::Block { bounds, material, .. } => {
                let (at, turn) = (upright(0.5 * (bounds.min + bounds.max)), DQuat::IDENTITY);
                let solid = Solid::Box(upright(bounds.max - bounds.min).abs());
                (Collider { solid, at, turn }, *material)
            }
            StaticShape::Plane(plane) => (engines::plane(plane.offset * plane.normal, plane.normal), plane.material),
            _ => (engines::drawn(), plaus_sim::Material(0)),
        };
        Still { name: name.to_owned(), colliders: vec![collider], material: material.0.into() }
    };
    let parts = alley.parts()?;
    let scenery = Alley::PARTS.into_iter().zip(&parts).map(still).collect();
    Ok(Physics { bodies, scenery, laws, left_out, ..Physics::default() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    /// Each part has the name by which impacts with it are told.
    #[test]
    fn parts_have_the_names_of_what_is_hit() {
        let parts = Alley::default().parts().unwrap();
        assert_eq!(parts.len(), Alley::PARTS.len());
        for (name, part) in Alley::PARTS.into_iter().zip(parts) {
            let (point, normal) = match part {
                StaticShape::Block { bounds, .. } => {
                    (0.5 * (bounds.min + bounds.max).with_z(2.0 * bounds.max.z), DVec3::Z)
                }
                StaticShape::Plane(plane) => {
                    let far = if plane.normal == DVec3::Z { DVec3::Y * 1.2 } else { DVec3::ZERO };
                    (plane.offset * plane.normal + far, plane.normal)
                }
                _ => unreachable!("an alley has blocks and planes"),
            };
            assert_eq!(super::super::props::part(point, normal), name);
        }
    }
}
