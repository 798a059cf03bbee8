//! Bodies that resistance to rolling holds at rest.

use crate::common::zoo::{G, M};
use glam::{DQuat, DVec3};
use plaus_sim::rigid::{BodySpec, Part, Rigid, RigidWorld, Start};
use plaus_sim::scenery::Plane;
use plaus_sim::shape::{Frustum, Shape};
use plaus_sim::{Accuracy, Law, Laws, Outcome, Preset, Scratch};

const RADIUS: f64 = 0.02;
const HALF: f64 = 0.05;

/// A cylinder lies across a slope with this tangent for a second: how it ends, and how far it has rolled.
fn lie(tangent: f64, law: Law, preset: Preset) -> (Outcome, f64) {
    let shape = Shape::from(Frustum::cylinder(RADIUS, 2.0 * HALF).unwrap());
    let world = Rigid::new(RigidWorld {
        bodies: vec![BodySpec::solid(shape, 700.0, M)],
        parts: vec![Part::Plane(Plane::new(DVec3::ZERO, DVec3::Z, M).unwrap())],
        laws: Laws::uniform(law).unwrap(),
        gravity: DVec3::new(tangent, 0.0, -1.0).normalize() * G,
        accuracy: Accuracy::preset(preset),
        ..RigidWorld::default()
    })
    .unwrap();
    let turn = DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2);
    let start = Start { orientation: turn, ..Start::at_rest(DVec3::Z * RADIUS) };
    let mut state = world.state(&[start]).unwrap();
    let outcome = world.run(&mut state, &mut Scratch::default(), 1.0, &mut ()).unwrap();
    let body = world.at(0, &state.bodies()[0], state.time());
    (outcome, body.path.x.x)
}

/// Resistance ρ acts with the distance of a point from the centre of gravity, which is at least the radius r and at
/// most that of the ends, R. So it holds a cylinder on slopes below ρ and not on slopes above `ρ R/r`. The twin without
/// resistance rolls on both.
#[test]
fn a_cylinder_rests_on_slopes_below_its_resistance() {
    let law = Law::new(0.6, 0.3);
    let bound = 0.02 * (RADIUS * RADIUS + HALF * HALF).sqrt() / RADIUS;
    for preset in Preset::ALL {
        let (outcome, way) = lie(0.9 * 0.02, law.with_resistance(0.02, 0.01), preset);
        let twin_way = 0.5 * (2.0 / 3.0) * 0.9 * 0.02 * G;
        assert!(outcome == Outcome::AllAtRest && way == 0.0, "{preset:?}: {outcome:?}, {way}");
        let (_, way) = lie(1.1 * bound, law.with_resistance(0.02, 0.01), preset);
        // With two thirds of the acceleration that is left, `0.1 ρ R/r g`, it would come this far; half allows for the
        // steps' error.
        let far = 0.5 * (2.0 / 3.0) * 0.1 * bound * G;
        assert!(way > 0.5 * far, "{preset:?}: {way} of {far}");
        let (outcome, twin) = lie(0.9 * 0.02, law, preset);
        let off = (twin / twin_way - 1.0).abs();
        assert!(outcome == Outcome::TimeReached && off < 0.05, "{preset:?}: {twin} of {twin_way}");
    }
}
