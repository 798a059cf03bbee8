//! Flat feet of bodies of revolution at the edges and corners of large boxes.

use glam::{DQuat, DVec3};
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_sim::rigid::{BodySpec, RigidWorld, RigidWorldDesc, Start, StaticShape};
use plaus_sim::scenery::Aabb;
use plaus_sim::shape::{Profile, Revolution, Shape};
use plaus_sim::trace::Trace;
use plaus_sim::{Accuracy, Law, Laws, Material, Scratch};
use std::sync::Arc;

const M: Material = Material(0);
const EDGE: f64 = 0.6;

/// A skittle falls without spin on an edge or a corner of a box that comes under the flat of its foot: it is struck when
/// the foot's plane has fallen to the edge's highest point, along the skittle's axis. Without the foot's points only the
/// rim would be struck, later.
#[test]
fn a_foot_that_falls_on_an_edge_is_struck_in_time() {
    let skittle = Arc::new(Revolution::new(&Profile::pin(), 40).unwrap());
    let (ring, shape) = (skittle.rings()[0], Shape::Revolution(Arc::clone(&skittle)));
    let accuracy = Accuracy::default();
    for fall in 0..200 {
        let is_corner = fall % 2 == 0;
        let end = if is_corner { 0.0 } else { EDGE };
        let bounds = Aabb { min: DVec3::splat(-EDGE), max: DVec3::new(0.0, end, 0.0) };
        let world = RigidWorld::new(RigidWorldDesc {
            bodies: vec![BodySpec::solid(shape.clone(), 700.0, M)],
            parts: vec![StaticShape::Block { bounds, material: M, sections: Vec::new() }],
            laws: Laws::uniform(Law::new(0.3, 0.4)).unwrap(),
            accuracy,
            duration: 2.0,
            ..RigidWorldDesc::default()
        })
        .unwrap();
        let mut stream = Seed(41).chain(0).at(fall, Purpose::START);
        let mut between = |low: f64, high: f64| low + (high - low) * open_unit(&mut stream);
        // Out over the edge, which is parallel to the foot, or over all three edges of the corner.
        let lean = DVec3::new(between(0.05, 0.6), if is_corner { between(0.05, 0.6) } else { 0.0 }, 1.0).normalize();
        let turn = DQuat::from_rotation_arc(DVec3::Z, lean) * DQuat::from_rotation_z(between(0.0, 6.0));
        let (height, off) = (between(0.2, 1.0) * ring.circle, DVec3::new(between(-0.6, 0.6), between(-0.6, 0.6), 0.0));
        // The disc within the rim, raised by the fall, has its place `off` over the corner.
        let foot = lean * ring.radius - turn * (off * ring.circle) + DVec3::Z * height;
        let start = Start { orientation: turn, ..Start::at_rest(foot - lean * ring.height) };
        let (mut state, mut trace) = (world.state(&[start]).unwrap(), Trace::default());
        world.run(&mut state, &mut Scratch::default(), 0.3, &mut trace).unwrap();
        let first = &trace.impacts[0];
        let (time, speed) = ((2.0 * height / 9.81_f64).sqrt(), (2.0 * height * 9.81_f64).sqrt());
        // Early by the preset's gap at most.
        let early = 2.0 * accuracy.gap * shape.size() / (lean.z * speed);
        assert!((-early..=1e-12).contains(&(first.time - time)), "fall {fall}: {first:?} for {time}");
        assert!((first.normal - lean).length() < 1e-9, "fall {fall}: {first:?} for {lean}");
    }
}
