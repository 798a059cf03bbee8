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

/// With the distance R of its ends' points as the radius, resistance ρ holds a cylinder of radius r on slopes up to
/// `ρ R/r`. On steeper ones it rolls with two thirds of the acceleration that is left. The twin without resistance
/// rolls on both.
#[test]
fn a_cylinder_rests_on_a_slope_up_to_its_resistance() {
    let law = Law::new(0.6, 0.3);
    let bound = 0.02 * (RADIUS * RADIUS + HALF * HALF).sqrt() / RADIUS;
    for preset in [Preset::Draft, Preset::Standard, Preset::Fine] {
        let (outcome, way) = lie(0.95 * bound, law.with_resistance(0.02, 0.01), preset);
        assert!(outcome == Outcome::AllAtRest && way.abs() < 1e-6 * RADIUS, "{preset:?}: {outcome:?}, {way}");
        let (_, way) = lie(1.1 * bound, law.with_resistance(0.02, 0.01), preset);
        let exact = G * 0.1 * bound / (1.0 + 1.21 * bound * bound).sqrt() / 3.0;
        // The steps' error, and the gap at which it starts.
        assert!((way / exact - 1.0).abs() < 0.02, "{preset:?}: {way} for {exact}");
        let (outcome, twin) = lie(0.95 * bound, law, preset);
        assert!(outcome == Outcome::TimeReached && twin > 0.1, "{preset:?}: {twin}");
    }
}
