//! The start of a motion for other simulators: what the scenes of the paper share. A body's own axes are those in which
//! y points up where it is not turned.

use crate::animation::{Collider, Rigid, Shape, Solid, Track, UPRIGHT, upright};
use glam::{DQuat, DVec3};
use plaus_sim::shape::MassProperties;
use plaus_sim::{Laws, Material};

/// Gravity of the Earth, in m/s².
pub(crate) const EARTH: f64 = 9.806_65;

/// A rotation, y up.
pub(crate) fn turned(turn: DQuat) -> DQuat {
    (UPRIGHT * turn * UPRIGHT.conjugate()).normalize()
}

/// The convex solid that a body is drawn as, about its middle and along its own axes.
pub(crate) fn solid(shape: &Shape) -> Collider {
    let solid = match shape {
        Shape::Sphere { radius, .. } => Solid::Ball(*radius),
        Shape::Disc { radius, thickness } => Solid::Cylinder([*radius; 2], *thickness),
        Shape::Cuboid { half, .. } => Solid::Box(upright(2.0 * *half).abs()),
        Shape::Revolution { .. } | Shape::Solid { .. } => {
            let (corners, faces) = shape.surface();
            Solid::Hull(corners.into_iter().map(upright).collect(), faces)
        }
    };
    Collider { solid, at: DVec3::ZERO, turn: DQuat::IDENTITY }
}

/// A body as it is at the start of its motion, of the solid that it is drawn as. Its moments of inertia are those about
/// the axes of its shape; `gravity` is in m/s².
pub(crate) fn rigid(track: &Track, mass: &MassProperties, material: Material, gravity: f64) -> Rigid {
    let orientation = track.orientation(0.0);
    let [velocity, spin] = track.piece(0.0).map_or([DVec3::ZERO; 2], |piece| {
        [piece.velocity(0.0), piece.turn.spin + piece.turn.own * (orientation * DVec3::Z)]
    });
    Rigid {
        name: track.name.clone(),
        colliders: vec![solid(&track.shape)],
        material: material.0.into(),
        is_driven: false,
        mass: mass.mass,
        moments: mass.inertia,
        axes: UPRIGHT,
        at: track.position(0.0),
        turn: (orientation * UPRIGHT.conjugate()).normalize(),
        velocity,
        spin,
        gravity: gravity / EARTH,
    }
}

/// All below a plane through a point with a normal, both in the simulator's axes.
pub(crate) fn plane(point: DVec3, normal: DVec3) -> Collider {
    Collider { solid: Solid::Plane, at: upright(point), turn: DQuat::from_rotation_arc(DVec3::Y, upright(normal)) }
}

/// What is drawn of scenery.
pub(crate) fn drawn() -> Collider {
    Collider { solid: Solid::Drawn, at: DVec3::ZERO, turn: DQuat::IDENTITY }
}

/// Friction, restitution and static friction of pairs of so many materials; adds to `left_out` if there is resistance
/// to rolling or spinning.
pub(crate) fn laws(laws: &Laws, count: u16, left_out: &mut Vec<String>) -> Vec<Vec<[f64; 3]>> {
    let law = |a: u16, b: u16| laws.of(Material(a), Material(b));
    let pairs = || (0..count).flat_map(|a| (0..count).map(move |b| (a, b)));
    if pairs().any(|(a, b)| law(a, b).rolling + law(a, b).spinning > 0.0) {
        left_out.push("resistance to rolling and spinning".into());
    }
    let one = |a: u16, b: u16| {
        let law = law(a, b);
        [law.friction, law.restitution, law.static_friction.max(law.friction)]
    };
    (0..count).map(|a| (0..count).map(|b| one(a, b)).collect()).collect()
}
