//! Flat feet of bodies of revolution at the edges and corners of large boxes.

use glam::{DQuat, DVec3};
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_sim::rigid::{BodySpec, Phase, RigidBodyState, RigidWorld, RigidWorldDesc, Start, StaticShape};
use plaus_sim::scenery::Aabb;
use plaus_sim::shape::{Cuboid, Profile, Revolution, Shape};
use plaus_sim::trace::Observer;
use plaus_sim::{Accuracy, Law, Laws, Material, Preset, Scratch};
use std::sync::Arc;

const M: Material = Material(0);
const HALF: f64 = 0.3;

fn among(shapes: Vec<Shape>, parts: Vec<StaticShape>, preset: Preset) -> RigidWorld {
    RigidWorld::new(RigidWorldDesc {
        bodies: shapes.into_iter().map(|s| BodySpec::solid(s, 700.0, M)).collect(),
        parts,
        laws: Laws::uniform(Law::new(0.3, 0.4)).unwrap(),
        accuracy: Accuracy::preset(preset),
        sink: -3.0 * HALF,
        duration: 2.0,
        ..RigidWorldDesc::default()
    })
    .unwrap()
}

/// Measures the depth of the body in a body with the box's shape, whose pieces are compared exactly.
struct Watch<'w> {
    world: &'w RigidWorld,
    exact: &'w RigidWorld,
    block: RigidBodyState,
    energy: f64,
    worst: [f64; 2],
}

impl Observer<RigidWorld> for Watch<'_> {
    fn motion(&mut self, index: usize, body: &RigidBodyState) {
        if body.phase == Phase::Gone {
            return;
        }
        let energy = self.world.energy(index, body);
        let depth = -self.exact.gap([0, 1], [body, &self.block]);
        self.worst = [self.worst[0].max(depth), self.worst[1].max(energy - self.energy)];
        self.energy = energy;
    }
}

/// Skittles that fall on edges and corners of a box, leaning out over them: none sinks into the box by more than a body
/// that is struck may lie in another, a thousandth of its size, and none gains more energy than one that is lifted out of
/// such an overlap.
#[test]
fn feet_do_not_sink_into_edges() {
    let pin = Shape::Revolution(Arc::new(Revolution::new(&Profile::pin(), 40).unwrap()));
    let size = pin.size();
    let bounds = Aabb { min: DVec3::splat(-HALF), max: DVec3::new(HALF, HALF, 0.0) };
    let block = StaticShape::Block { bounds, material: M, sections: Vec::new() };
    let cuboid = Shape::Cuboid(Cuboid::new(bounds.max - bounds.min, 0.0).unwrap());
    let mut report = Vec::new();
    for preset in [Preset::Draft, Preset::Standard] {
        let world = among(vec![pin.clone()], vec![block.clone()], preset);
        let exact = among(vec![pin.clone(), cuboid.clone()], Vec::new(), preset);
        let weight = 9.81 * pin.mass_properties(700.0).mass;
        for throw in 0..150 {
            let mut stream = Seed(41).chain(0).at(throw, Purpose::START);
            let mut between = |low: f64, high: f64| low + (high - low) * open_unit(&mut stream);
            let lean = DVec3::new(between(-0.2, 1.0), between(-0.4, 0.4), 1.0).normalize();
            let turn = DQuat::from_rotation_arc(DVec3::Z, lean) * DQuat::from_rotation_z(between(0.0, 6.0));
            // Over an edge, or over a corner.
            let y = if throw % 3 == 0 { HALF } else { 0.0 };
            let foot = DVec3::new(HALF + between(-0.8, 0.8) * size, y + between(-0.8, 0.8) * size, 2.2 * size);
            let start = Start {
                orientation: turn,
                velocity: DVec3::new(between(-0.2, 0.2), between(-0.2, 0.2), between(-1.0, 0.0)),
                spin: DVec3::new(between(-3.0, 3.0), between(-3.0, 3.0), between(-3.0, 3.0)),
                ..Start::at_rest(foot + lean * 4.0 * size)
            };
            let middle = Start::at_rest(0.5 * (bounds.min + bounds.max));
            let cubes = exact.state(&[Start { time: 1.0, ..start.clone() }, middle]).unwrap();
            let mut state = world.state(&[start]).unwrap();
            let mut watch = Watch {
                world: &world,
                exact: &exact,
                block: cubes.bodies()[1].clone(),
                energy: f64::INFINITY,
                worst: [0.0; 2],
            };
            world.run(&mut state, &mut Scratch::default(), 2.0, &mut watch).unwrap();
            let [deep, rise] = [watch.worst[0] / size, watch.worst[1] / (weight * size)];
            if deep > 1e-3 || rise > 1e-3 {
                report.push(format!("{} {throw}: {deep:.2e} of its size deep, a rise of {rise:.2e}", preset.name()));
            }
        }
    }
    assert!(report.is_empty(), "{} of 300\n{}", report.len(), report.join("\n"));
}
