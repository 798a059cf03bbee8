//! Fixed boxes that lie flush are one floor to what is well inside their outline, and no farther; each tells what it
//! bears.

use crate::common::zoo::{G, M};
use glam::DVec3;
use plaus_sim::mechanics::{ContactForce, Island, Mechanics, Other};
use plaus_sim::rigid::{BodySpec, Phase, RigidScratch, RigidWorld, RigidWorldDesc, Start, StaticShape};
use plaus_sim::scenery::{Aabb, Surface};
use plaus_sim::shape::{Cuboid, Frustum, Shape};
use plaus_sim::trace::Observer;
use plaus_sim::{Accuracy, Law, Laws, Material, Outcome, Preset, Scratch};

const EDGE: f64 = 0.04;

/// A board with its top at z = 0, between two corners.
fn board(from: [f64; 2], to: [f64; 2], material: Material) -> StaticShape {
    let bounds = Aabb { min: DVec3::new(from[0], from[1], -0.02), max: DVec3::new(to[0], to[1], 0.0) };
    StaticShape::Block { bounds, material, sections: Vec::new() }
}

fn world(shape: Shape, parts: Vec<StaticShape>, laws: Laws, preset: Preset) -> RigidWorld {
    RigidWorld::new(RigidWorldDesc {
        bodies: vec![BodySpec::solid(shape, 700.0, M)],
        parts,
        laws,
        gravity: DVec3::Z * -G,
        accuracy: Accuracy::preset(preset),
        duration: 3.0,
        ..RigidWorldDesc::default()
    })
    .unwrap()
}

fn shapes() -> [Shape; 2] {
    [
        Shape::Cuboid(Cuboid::new(DVec3::splat(EDGE), 0.0).unwrap()),
        Shape::from(Frustum::cylinder(0.5 * EDGE, EDGE).unwrap()),
    ]
}

/// What each part bears in the end, in N.
#[derive(Default)]
struct Loads {
    work: RigidScratch,
    bears: [f64; 2],
}

impl Observer<RigidWorld> for Loads {
    fn settled(&mut self, world: &RigidWorld, island: &Island<'_, RigidWorld>) {
        let mut bears = [0.0; 2];
        world.contact_forces(island, &mut self.work, &mut |force: &ContactForce| match force.other {
            Other::Surface(Surface::Part { part, .. } | Surface::Spot { part, .. }) => {
                bears[usize::from(part)] += force.force.z;
            }
            other => panic!("{other:?} in a world without it"),
        });
        self.bears = bears;
    }
}

/// Both boards under a body bear it.
#[test]
fn each_board_tells_what_it_bears() {
    for shape in shapes() {
        for off in [0.0, 0.3, -0.45] {
            let parts = vec![board([-1.0, -1.0], [0.0, 1.0], M), board([0.0, -1.0], [1.0, 1.0], M)];
            let laws = Laws::uniform(Law::new(0.4, 0.0)).unwrap();
            let world = world(shape.clone(), parts, laws, Preset::Standard);
            let at = DVec3::new(off * EDGE, 0.1, 0.5 * EDGE);
            let (mut state, mut loads) = (world.state(&[Start::at_rest(at)]).unwrap(), Loads::default());
            let outcome = world.run(&mut state, &mut Scratch::default(), 3.0, &mut loads).unwrap();
            assert_eq!(outcome, Outcome::AllAtRest);
            let weight = G * shape.mass_properties(700.0).mass;
            let [left, right] = loads.bears;
            // Static equilibrium is found to 1e-6 of the weight at each of four points.
            assert!((left + right - weight).abs() < 4e-6 * weight, "{left} + {right}, {weight}");
            assert!(left > 0.0 && right > 0.0, "{left}, {right} at {off}");
        }
    }
}

/// Where a body that slides along three boards in the shape of an L ends up: on them, or below.
#[test]
fn a_floor_ends_at_its_outline() {
    let cases = [
        // Along the long arm, then over its end; along the short arm, and to rest on it.
        ([-0.3, 0.0], [1.8, 0.0], false),
        ([0.0, 0.0], [0.0, 0.7], true),
        // Across the inner corner, where there is no floor.
        ([0.0, 0.0], [1.2, 1.2], false),
    ];
    for shape in shapes() {
        for preset in [Preset::Draft, Preset::Standard, Preset::Fine] {
            for (from, velocity, stays) in cases {
                let parts = vec![
                    board([-0.4, -0.1], [0.0, 0.1], M),
                    board([0.0, -0.1], [0.3, 0.1], M),
                    board([-0.1, 0.1], [0.1, 0.5], M),
                ];
                let laws = Laws::uniform(Law::new(0.2, 0.3)).unwrap();
                let world = world(shape.clone(), parts, laws, preset);
                let at = DVec3::new(from[0], from[1], 0.5 * EDGE);
                let velocity = DVec3::new(velocity[0], velocity[1], 0.0);
                let mut state = world.state(&[Start { velocity, ..Start::at_rest(at) }]).unwrap();
                world.run(&mut state, &mut Scratch::default(), 3.0, &mut ()).unwrap();
                let body = &state.bodies()[0];
                let end = body.path.x;
                assert_eq!(body.phase == Phase::Rest, stays, "{preset:?} from {from:?}: {end}");
                if stays {
                    // v²/(2 µ g), to the presets' table of a cuboid that slides to rest: 6.5e-5 of its way.
                    let way = velocity.length_squared() / (2.0 * 0.2 * G);
                    assert!((end.y - way).abs() < 1e-3 * way, "{preset:?}: {end}, {way}");
                }
            }
        }
    }
}

/// Boards of two materials are two floors: what slides on is braked by each.
#[test]
fn materials_are_told_apart() {
    let (oak, ice) = (Material(1), Material(2));
    for shape in shapes() {
        let parts = vec![board([-1.0, -1.0], [0.0, 1.0], oak), board([0.0, -1.0], [2.0, 1.0], ice)];
        let mut laws = Laws::new(3, Law::new(0.3, 0.0)).unwrap();
        laws.set(M, ice, Law::new(0.1, 0.0)).unwrap();
        let world = world(shape, parts, laws, Preset::Standard);
        let velocity = DVec3::X * 1.2;
        let start = Start { velocity, ..Start::at_rest(DVec3::new(-0.2, 0.0, 0.5 * EDGE)) };
        let mut state = world.state(&[start]).unwrap();
        world.run(&mut state, &mut Scratch::default(), 3.0, &mut ()).unwrap();
        // The work of friction: 0.3 before the seam, 0.1 behind it, and what the load is of each while the body is
        // across it, which shifts by the moment of friction.
        let way = (velocity.length_squared() / (2.0 * G) - 0.2 * 0.3) / 0.1;
        let end = state.bodies()[0].path.x;
        assert!((end.x - way).abs() < 0.5 * EDGE, "{end}, {way}");
    }
}
