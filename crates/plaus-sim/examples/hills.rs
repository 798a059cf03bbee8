//! A ball, a coin and a hammer let go on hills given by their heights: `cargo run -p plaus-sim --example hills`.
#![allow(clippy::print_stdout, reason = "an example: it prints")]

use plaus_dist::math;
use plaus_sim::glam::{DQuat, DVec3};
use plaus_sim::rigid::{BodySpec, RigidWorld, RigidWorldDesc, Start, StaticShape};
use plaus_sim::scenery::Heights;
use plaus_sim::shape::{Compound, Convex, Frustum, Member, Shape};
use plaus_sim::{Law, Laws, Material, Scratch};
use std::error::Error;
use std::sync::Arc;

fn main() -> Result<(), Box<dyn Error>> {
    let (wood, points, spacing) = (Material(0), 41_u32, 0.02);
    let along = |k: u32| (f64::from(k) - 0.5 * f64::from(points - 1)) * spacing;
    let height = |x: f64, y: f64| 0.04 * math::sin(9.0 * x) * math::cos(7.0 * y);
    let row = |j: u32| (0..points).map(|i| height(along(i), along(j))).collect();
    let hills = Heights::new([spacing; 2], &(0..points).map(row).collect::<Vec<_>>())?;

    let [head, handle] = [Frustum::cylinder(0.012, 0.04)?, Frustum::cylinder(0.005, 0.1)?].map(Convex::Frustum);
    let hammer = Compound::new(&[
        Member { density: 5.0, turn: DQuat::from_rotation_y(1.57), ..Member::new(head, DVec3::ZERO) },
        Member::new(handle, DVec3::Z * -0.05),
    ])?;
    let bodies =
        [("ball", Shape::Ball(0.02)), ("coin", Frustum::cylinder(0.02, 0.003)?.into()), ("hammer", hammer.into())];
    let world = RigidWorld::new(RigidWorldDesc {
        bodies: bodies.iter().map(|(_, shape)| BodySpec::solid(shape.clone(), 900.0, wood)).collect(),
        parts: vec![StaticShape::Mesh(Arc::new(hills.mesh(DVec3::ZERO, DQuat::IDENTITY, wood)?))],
        laws: Laws::uniform(Law::new(0.5, 0.3).with_resistance(0.02, 0.02))?,
        sink: -1.0,
        ..RigidWorldDesc::default()
    })?;
    let start = |k: u32| Start::at_rest(DVec3::new(0.12 * f64::from(k) - 0.15, 0.03, 0.15));
    let mut state = world.state(&[0, 1, 2].map(start))?;
    let outcome = world.run(&mut state, &mut Scratch::default(), 10.0, &mut ())?;
    println!("{outcome:?} at {:.3} s, {:?}", state.time(), state.counts());
    for (k, (name, _)) in bodies.iter().enumerate() {
        let body = world.at(k, &state.bodies()[k], state.time());
        let x = body.path.x;
        let above =
            hills.height(x.x, x.y).map_or("beside the hills".into(), |h| format!("{:.1} mm above", 1e3 * (x.z - h)));
        println!("{name:>7} {:?} at {:.1} {:.1} mm, {above}", body.phase, 1e3 * x.x, 1e3 * x.y);
    }
    Ok(())
}
