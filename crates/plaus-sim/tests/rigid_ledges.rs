//! Convex polyhedra at edges and corners of boxes, away from their own corners: posts, walls and ledges.

use glam::{DQuat, DVec3};
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_sim::rigid::{BodySpec, Phase, RigidBodyState, RigidWorld, RigidWorldDesc, Start, StaticShape};
use plaus_sim::scenery::Aabb;
use plaus_sim::shape::{ConvexHull, Shape, Solid};
use plaus_sim::trace::{Observer, Trace};
use plaus_sim::worlds::DieOnTable;
use plaus_sim::{Accuracy, Law, Laws, Material, Outcome, Scratch};

const M: Material = Material(0);
const EDGE: f64 = 0.016;

fn block(min: [f64; 3], max: [f64; 3]) -> StaticShape {
    let bounds = Aabb { min: DVec3::from(min) * EDGE, max: DVec3::from(max) * EDGE };
    StaticShape::Block { bounds, material: M, sections: Vec::new() }
}

fn solid(solid: Solid) -> Shape {
    Shape::Hull(ConvexHull::new(&solid.corners(EDGE), 0.0).unwrap().into())
}

fn world(shapes: Vec<Shape>, parts: Vec<StaticShape>, law: Law) -> Result<RigidWorld, plaus_sim::WorldError> {
    RigidWorld::new(RigidWorldDesc {
        bodies: shapes.into_iter().map(|s| BodySpec::solid(s, 1200.0, M)).collect(),
        parts,
        laws: Laws::uniform(law).unwrap(),
        gravity: DVec3::new(0.0, 0.0, -9.81),
        accuracy: Accuracy::default(),
        skin: 1.0,
        sink: f64::NEG_INFINITY,
        duration: 20.0,
    })
}

/// A cube put down on a wall or a post narrower than itself has no corner on it, but still rests on it.
#[test]
fn a_cube_rests_on_a_narrower_support() {
    let wall = block([-0.1, -4.0, -2.0], [0.1, 4.0, 0.0]);
    let post = block([-0.3, -0.2, -2.0], [0.2, 0.3, 0.0]);
    for (part, turn) in [(wall.clone(), 0.0), (wall, 0.4), (post.clone(), 0.0), (post, 0.5)] {
        let world = world(vec![solid(Solid::Cube)], vec![part], Law::new(0.4, 0.3)).unwrap();
        let start = Start { orientation: DQuat::from_rotation_z(turn), ..Start::at_rest(DVec3::Z * (0.7 * EDGE)) };
        let (mut state, mut trace) = (world.state(&[start]).unwrap(), Trace::default());
        let outcome = world.run(&mut state, &mut Scratch::default(), 20.0, &mut trace).unwrap();
        assert_eq!(outcome, Outcome::AllAtRest, "turned {turn}");
        let body = &state.bodies()[0];
        assert!((body.path.x.z - 0.5 * EDGE).abs() < 1e-5 * EDGE && (body.turn * DVec3::Z).z > 1.0 - 1e-9, "{body:?}");
        assert!(body.touching().len() >= 3);
        // If it comes down level, it does so when a cube comes down on a plane, early by the preset's gap at most.
        let first = &trace.impacts[0];
        let (height, gap) = (0.2 * EDGE, 1e-5 * 0.5 * EDGE);
        let late = first.time - (2.0 * height / 9.81_f64).sqrt();
        assert!(late <= 1e-15 && late > -2.0 * gap / (2.0 * height * 9.81_f64).sqrt(), "{late} {first:?}");
        assert!(first.normal.z > 1.0 - 1e-9);
    }
}

/// The face of a tilted cube comes down on the corner of a post, at the time and with the normal that follow from the
/// plane of the face.
#[test]
fn a_corner_of_a_box_meets_a_face() {
    let post = block([-0.5, -0.5, -2.0], [0.0, 0.0, 0.0]);
    let world = world(vec![solid(Solid::Cube)], vec![post], Law::new(0.2, 0.5)).unwrap();
    // The lower face leans out over the corner, which is at the origin.
    let turn = DQuat::from_rotation_arc(-DVec3::Z, -DVec3::new(0.2, 0.3, 1.0).normalize());
    let normal = turn * DVec3::Z;
    let height = 0.3 * EDGE;
    // The face's plane passes through the origin after a fall by `height`.
    let position = DVec3::new(0.0, 0.0, 0.5 * EDGE / normal.z + height);
    let start = Start { orientation: turn, ..Start::at_rest(position) };
    let (mut state, mut trace) = (world.state(&[start]).unwrap(), Trace::default());
    world.run(&mut state, &mut Scratch::default(), 0.1, &mut trace).unwrap();
    let first = &trace.impacts[0];
    assert!((first.normal - normal).length() < 1e-12 && first.point.length() < 1e-4 * EDGE, "{first:?}");
    let (time, speed) = ((2.0 * height / 9.81_f64).sqrt(), (2.0 * height * 9.81_f64).sqrt());
    let gap = 1e-5 * 0.5 * EDGE / normal.z;
    assert!((-2.0 * gap / speed..=1e-15).contains(&(first.time - time)), "{first:?} for {time}");
}

/// At every new motion and half way before it, checks how deep bodies are in the parts.
struct Depths<'w> {
    world: &'w RigidWorld,
    last: Vec<RigidBodyState>,
    worst: f64,
}

impl Observer<RigidWorld> for Depths<'_> {
    fn motion(&mut self, index: usize, body: &RigidBodyState) {
        let half = self.world.at(index, &self.last[index], 0.5 * (self.last[index].path.t + body.path.t));
        for b in [&half, body] {
            if b.phase != Phase::Waiting {
                self.worst = self.worst.max(self.world.depth(index, b));
            }
        }
        self.last[index] = body.clone();
    }
}

/// Posts in rows before a wall: all dice end, none deep in anything. Half way through a step of lasting contact a
/// corner that turns at ω is `(ω h)²/8` of its arm in what it touches: up to three hundredths of the size in a run that
/// comes to rest, and three tenths in one that jams. A d20 that wedges itself between two posts and the wall a little
/// deeper than bodies may lie (1e-3 of its size; 1.7e-3 was seen) stands still there without being called at rest.
#[test]
fn dice_among_posts_are_never_in_them() {
    let mut parts = vec![block([-40.0, -40.0, -4.0], [40.0, 40.0, -2.0])];
    for k in 0..12 {
        let (x, y) = (f64::from(k % 4) * 1.1 + 1.0, f64::from(k / 4) * 1.2 - 1.4);
        parts.push(block([x, y, -2.0], [x + 0.25, y + 0.35, 0.3 * f64::from(k % 3) - 0.6]));
    }
    parts.push(block([6.0, -40.0, -2.0], [40.0, 40.0, 1.0]));
    let mut rest = 0;
    for (k, kind) in [Solid::Tetrahedron, Solid::Cube, Solid::Octahedron, Solid::Icosahedron].into_iter().enumerate() {
        let shape = solid(kind);
        let world = world(vec![shape.clone()], parts.clone(), Law::new(0.35, 0.5)).unwrap();
        for throw in 0..25 {
            let mut stream = Seed(29).chain(k as u64).at(throw, Purpose::START);
            let start = DieOnTable::default().throw(|| open_unit(&mut stream));
            let start = Start { velocity: start.velocity * 0.5, ..start };
            let mut state = world.state(&[start]).unwrap();
            let mut depths = Depths { world: &world, last: state.bodies().to_vec(), worst: 0.0 };
            let outcome = world.run(&mut state, &mut Scratch::default(), 20.0, &mut depths).unwrap();
            let deep = depths.worst / shape.size();
            if outcome == Outcome::AllAtRest {
                rest += 1;
                assert!(deep < 3e-2, "{kind:?} {throw}: {deep} of its size deep");
            } else {
                assert!(
                    matches!(outcome, Outcome::OutOfEvents | Outcome::TimeReached) && deep < 0.3,
                    "{kind:?} {throw}: {deep}, {outcome:?}"
                );
            }
        }
    }
    assert!(rest >= 96, "{rest} of 100 at rest");
}

/// An endless box is as good as a plane.
#[test]
fn endless_boxes_hold_what_lies_on_them() {
    let all = f64::INFINITY;
    let part = block([-all, -all, -all], [all, all, 0.0]);
    let world = world(vec![solid(Solid::Cube)], vec![part], Law::new(0.5, 0.2)).unwrap();
    let mut state = world.state(&[Start::at_rest(DVec3::new(3.0, -2.0, 0.6 * EDGE))]).unwrap();
    assert_eq!(world.run(&mut state, &mut Scratch::default(), 5.0, &mut ()).unwrap(), Outcome::AllAtRest);
    // The gap at which bodies touch.
    assert!((state.bodies()[0].path.x.z - 0.5 * EDGE).abs() < 1e-5 * EDGE);
}
