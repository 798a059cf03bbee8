//! A paddle that follows keyframes hits a pendulum and a loose box: `cargo run -p plaus-sim --example paddle`.
#![allow(clippy::print_stdout, reason = "an example: it prints")]

use plaus_sim::glam::{DQuat, DVec3};
use plaus_sim::rigid::{BodySpec, Joint, Keyframes, RigidWorld, RigidWorldDesc, Start, StaticShape, Track};
use plaus_sim::scenery::Plane;
use plaus_sim::shape::{Cuboid, Shape};
use plaus_sim::trace::Trace;
use plaus_sim::{Material, Scratch};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let wood = Material(0);
    let cuboid = |x, y, z| Cuboid::new(DVec3::new(x, y, z), 0.0).map(Shape::Cuboid);
    let shapes = [cuboid(0.02, 0.2, 0.1)?, cuboid(0.04, 0.04, 0.3)?, cuboid(0.06, 0.06, 0.06)?];
    let mut world = RigidWorld::new(RigidWorldDesc {
        bodies: shapes.into_iter().map(|shape| BodySpec::solid(shape, 700.0, wood)).collect(),
        parts: vec![StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, wood)?)],
        ..RigidWorldDesc::default()
    })?;
    // The paddle goes 0.5 m along x within half a second, and stays there.
    let path = Track::linear([(0.0, DVec3::new(-0.5, 0.0, 0.06)), (0.5, DVec3::new(0.0, 0.0, 0.06))]);
    world.drive(0, &Keyframes { position: path, rotation: Track::fixed(DQuat::IDENTITY) })?;
    let hangs = Start::at_rest(DVec3::new(-0.2, 0.05, 0.2));
    world.join(Joint::hinge(hangs.position + DVec3::Z * 0.15, DVec3::Y, 1, &hangs).with_friction(0.01))?;
    let lies = Start::at_rest(DVec3::new(-0.1, -0.05, 0.03));

    let mut state = world.state(&[Start::at_rest(DVec3::ZERO), hangs, lies])?;
    let mut trace = Trace::default();
    let outcome = world.run(&mut state, &mut Scratch::default(), 5.0, &mut trace)?;
    println!("{outcome:?} at {:.3} s, {} impacts", state.time(), trace.impacts.len());
    for time in [0.0, 0.25, 0.5, 1.0, 2.0] {
        let bodies = [0, 1, 2].map(|k| trace.body_at(&world, k, time).unwrap_or(world.at(k, &state.bodies()[k], time)));
        let angle = 2.0 * plaus_dist::math::asin(bodies[1].turn.y).to_degrees();
        println!(
            "{time:.2} s: paddle at {:6.1} mm, pendulum at {angle:6.1}°, box at {:6.1} mm",
            1e3 * bodies[0].path.x.x,
            1e3 * bodies[2].path.x.x
        );
    }
    Ok(())
}
