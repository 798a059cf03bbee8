//! Input from users: meshes with faults, sizes from micrometres to a thousand kilometres, forces, sleepers.

use glam::{DQuat, DVec3};
use plaus_dist::math;
use plaus_sim::rigid::{
    BodySpec, Forces, Phase, RigidBodyState, RigidWorld, RigidWorldDesc, Start, StaticShape, StaticSolid,
};
use plaus_sim::scenery::{Mesh, Plane};
use plaus_sim::shape::{Compound, Convex, ConvexHull, Cuboid, Frustum, Member, Shape, Solid};
use plaus_sim::{Accuracy, Law, Laws, Material, Outcome, Scratch, State, WorldError};
use std::sync::Arc;

const M: Material = Material(0);
const G: f64 = 9.81;

fn world(shapes: &[Shape], parts: Vec<StaticShape>) -> Result<RigidWorld, WorldError> {
    RigidWorld::new(RigidWorldDesc {
        bodies: shapes.iter().map(|s| BodySpec::solid(s.clone(), 1000.0, M)).collect(),
        parts,
        laws: Laws::uniform(Law::new(0.4, 0.3).with_resistance(0.01, 0.01))?,
        gravity: DVec3::NEG_Z * G,
        accuracy: Accuracy::default(),
        skin: 1.0,
        sink: f64::NEG_INFINITY,
        duration: 1e5,
    })
}

fn floor() -> StaticShape {
    StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, M).unwrap())
}

/// A level square of `2 n²` triangles about the origin, without those in the squares that are left out.
fn square(edge: f64, n: u32, left_out: &[[u32; 2]]) -> Mesh {
    let along = |k: u32| edge * (f64::from(k) / f64::from(n) - 0.5);
    let vertices = (0..=n).flat_map(|i| (0..=n).map(move |j| DVec3::new(along(i), along(j), 0.0))).collect();
    let at = |i: u32, j: u32| i * (n + 1) + j;
    let mut triangles = Vec::new();
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).filter(|&(i, j)| !left_out.contains(&[i, j])) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        triangles.extend([([a, b, c], M), ([a, c, d], M)]);
    }
    Mesh::new(vertices, &triangles, 0.0).unwrap()
}

fn settled(world: &RigidWorld, starts: &[Start]) -> (Outcome, State<RigidBodyState>) {
    let mut state = world.state(starts).unwrap();
    let outcome = world.run(&mut state, &mut Scratch::default(), 1e5, &mut ()).unwrap();
    (outcome, state)
}

#[test]
fn faults_of_meshes_are_named_by_their_triangle() {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0]];
    let corners = corners.map(DVec3::from_array).to_vec();
    let mesh = |triangles: &[[u32; 3]]| {
        Mesh::new(corners.clone(), &triangles.iter().map(|&t| (t, M)).collect::<Vec<_>>(), 0.0).map(|m| m.len())
    };
    let good = [[0, 1, 2], [0, 2, 3]];
    assert_eq!(mesh(&good), Ok(2));
    // Given twice, turned over, flat, with a corner twice, with a corner that does not exist.
    assert!(matches!(mesh(&[good[0], good[1], [1, 2, 0]]), Err(WorldError::BadEdge { triangle: 2, .. })));
    assert!(matches!(mesh(&[good[0], [0, 3, 2]]), Err(WorldError::BadEdge { triangle: 1, .. })));
    assert!(matches!(mesh(&[good[1], [0, 1, 4]]), Err(WorldError::DegenerateTriangle { triangle: 1, .. })));
    assert!(matches!(
        mesh(&[good[0], [0, 0, 3]]),
        Err(WorldError::DegenerateTriangle { triangle: 1, .. } | WorldError::BadEdge { triangle: 1, .. })
    ));
    assert!(matches!(mesh(&[good[0], [0, 2, 9]]), Err(WorldError::UnknownVertex { triangle: 1, vertex: 9, .. })));
    let mut holed = corners.clone();
    holed[3].y = f64::NAN;
    let error = Mesh::new(holed, &good.map(|t| (t, M)), 0.0).unwrap_err();
    assert!(matches!(error, WorldError::DegenerateTriangle { triangle: 1, .. }), "{error}");
    // Refused before any work on them.
    let error = Mesh::new(corners, &vec![(good[0], M); 10_000_000], 0.0).unwrap_err();
    assert!(error.to_string().contains("number of triangles is 10000000, expected at most 1,048,576"), "{error}");
}

/// A mesh need not be closed: a body over a hole falls through, a body beside it stays.
#[test]
fn bodies_fall_through_holes() {
    let mesh = StaticShape::Mesh(Arc::new(square(1.0, 5, &[[2, 2]])));
    let ball = || Shape::Ball(0.03);
    let world = world(&[ball(), ball(), Frustum::cylinder(0.03, 0.05).unwrap().into()], vec![mesh]).unwrap();
    let at = |x: f64, y: f64| Start::at_rest(DVec3::new(x, y, 0.2));
    let mut state = world.state(&[at(0.0, 0.0), at(0.3, 0.0), at(-0.3, 0.1)]).unwrap();
    world.run(&mut state, &mut Scratch::default(), 2.0, &mut ()).unwrap();
    let z = |k: usize| world.at(k, &state.bodies()[k], 2.0).path.x.z;
    assert!(z(0) < -10.0, "{}", z(0));
    assert!((z(1) - 0.03).abs() < 1e-4 && (z(2) - 0.025).abs() < 1e-4, "{} {}", z(1), z(2));
}

#[test]
fn solids_without_volume_are_refused() {
    assert!(matches!(Frustum::cylinder(0.1, 0.0), Err(WorldError::BadNumber { field: "volume", .. })));
    assert!(matches!(Frustum::cone(0.0, 1.0), Err(WorldError::BadNumber { field: "volume", .. })));
    assert!(Cuboid::new(DVec3::new(1.0, 0.0, 1.0), 0.0).is_err());
    let flat = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
    assert!(matches!(ConvexHull::new(&flat, 0.0), Err(WorldError::FlatHull { .. } | WorldError::FewPoints { .. })));
    let bad = |position: DVec3, turn: DQuat| {
        let solid = StaticSolid { shape: Shape::Ball(0.1), at: position, turn, material: M };
        world(&[Shape::Ball(0.1)], vec![floor(), StaticShape::Solid(Box::new(solid))]).unwrap_err()
    };
    for error in [bad(DVec3::X * f64::NAN, DQuat::IDENTITY), bad(DVec3::Z, DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0))] {
        assert!(matches!(&error, WorldError::BadSurface { surface: plaus_sim::SurfaceId::Part(1), .. }), "{error}");
    }
}

/// Lengths multiplied by 4ⁿ and times by 2ⁿ with the same gravity: the same motion to the last bit, from a micrometre
/// to a thousand kilometres. No tolerance is a length.
#[test]
fn size_does_not_matter() {
    let shapes = |s: f64| -> Vec<Shape> {
        let head = Convex::Frustum(Frustum::cylinder(0.3 * s, 0.8 * s).unwrap());
        let handle = Convex::Cuboid(Cuboid::new(DVec3::new(1.5, 0.2, 0.2) * s, 0.0).unwrap());
        let hammer = Compound::new(&[Member::new(head, DVec3::ZERO), Member::new(handle, DVec3::X * s)]).unwrap();
        vec![
            Frustum::cylinder(0.5 * s, 0.2 * s).unwrap().into(),
            Frustum::cone(0.5 * s, s).unwrap().into(),
            hammer.into(),
            Shape::Hull(Arc::new(ConvexHull::new(&Solid::Dodecahedron.corners(0.5 * s), 0.0).unwrap())),
        ]
    };
    let run = |n: i32| {
        let (length, time) = (math::powi(4.0, n), math::powi(2.0, n));
        let mesh = StaticShape::Mesh(Arc::new(square(8.0 * length, 4, &[])));
        let world = world(&shapes(length), vec![mesh]).unwrap();
        let start = |k: usize| Start {
            position: DVec3::new([-1.6, 1.7][k % 2], [-1.5, 1.6][k / 2], 2.5) * length,
            orientation: DQuat::from_xyzw(0.3, 0.1 * k as f64, -0.2, 0.8).normalize(),
            velocity: DVec3::new(0.5, -0.25, 0.0) * time,
            spin: DVec3::new(1.5, 2.0, -1.0) / time,
            time: 0.0,
        };
        let mut state = world.state(&[0, 1, 2, 3].map(start)).unwrap();
        world.run(&mut state, &mut Scratch::default(), 1.5 * time, &mut ()).unwrap();
        let at = |k: usize| world.at(k, &state.bodies()[k], 1.5 * time);
        ([0, 1, 2, 3].map(|k| (at(k).path.x / length, at(k).turn)), state.counts())
    };
    let usual = run(0);
    assert!(usual.1.impacts > 10, "{:?}", usual.1);
    for n in [-10, 10] {
        assert_eq!(run(n), usual, "lengths by 4^{n}");
    }
}

/// A body that floats, one that rises, one that is pushed: as their closed forms say. A body pushed along the floor is
/// held by friction, or slides.
#[test]
fn forces_act_on_one_body() {
    let mut world = world(&vec![Shape::Ball(0.1); 3], vec![floor()]).unwrap();
    let (push, mass) = (DVec3::new(0.5, 0.0, 3.0), 1000.0 * 4.0 / 3.0 * std::f64::consts::PI * 1e-3);
    world.act_on(0, Forces { gravity: 0.0, ..Forces::default() }).unwrap();
    world.act_on(1, Forces { gravity: -0.5, ..Forces::default() }).unwrap();
    world.act_on(2, Forces { force: push, ..Forces::default() }).unwrap();
    let start = |x: f64| Start { velocity: DVec3::X * 0.1, ..Start::at_rest(DVec3::new(x, 0.0, 5.0)) };
    let mut state = world.state(&[start(0.0), start(1.0), start(2.0)]).unwrap();
    world.run(&mut state, &mut Scratch::default(), 0.5, &mut ()).unwrap();
    for (k, a) in [DVec3::ZERO, DVec3::Z * (0.5 * G), push / mass - DVec3::Z * G].into_iter().enumerate() {
        let expected = start(k as f64).position + DVec3::X * 0.05 + a * 0.125;
        let at = world.at(k, &state.bodies()[k], 0.5).path.x;
        assert!((at - expected).length() < 1e-14 * 10.0, "{k}: {at} for {expected}");
    }
    let bad = Forces { force: DVec3::X * f64::NAN, ..Forces::default() };
    assert!(matches!(world.act_on(1, bad), Err(WorldError::BadBody { body: 1, .. })));
    assert!(world.act_on(3, Forces::default()).is_err());
}

#[test]
fn a_box_pushed_less_than_friction_holds_stays() {
    let cuboid = Shape::Cuboid(Cuboid::new(DVec3::new(0.2, 0.2, 0.1), 0.0).unwrap());
    for (part, moves) in [(0.8, false), (1.5, true)] {
        let mut world = world(std::slice::from_ref(&cuboid), vec![floor()]).unwrap();
        let weight = 1000.0 * 0.004 * G;
        world.act_on(0, Forces { force: DVec3::X * (part * 0.4 * weight), ..Forces::default() }).unwrap();
        let mut state = world.state(&[Start::at_rest(DVec3::Z * 0.0501)]).unwrap();
        let outcome = world.run(&mut state, &mut Scratch::default(), 1.0, &mut ()).unwrap();
        let x = world.at(0, &state.bodies()[0], 1.0).path.x.x;
        assert_eq!(outcome == Outcome::TimeReached, moves, "{outcome:?}");
        // Pushed by half as much again as friction holds: 0.5·0.4·g.
        let expected = if moves { 0.5 * 0.5 * 0.4 * G } else { 0.0 };
        // The tolerance is the effect of a fall of 0.1 mm.
        assert!((x - expected).abs() < 0.02, "{x} for {expected}");
    }
}

/// A sleeper hangs in the air until it is hit.
#[test]
fn a_sleeper_wakes_when_it_is_hit() {
    let world = world(&[Shape::Ball(0.05), Frustum::cylinder(0.05, 0.1).unwrap().into()], vec![floor()]).unwrap();
    let run = |aside: f64| {
        let starts = [Start::at_rest(DVec3::new(aside, 0.0, 2.0)), Start::at_rest(DVec3::Z)];
        let mut state = world.state(&starts).unwrap();
        world.put_to_sleep(&mut state, 1).unwrap();
        world.run(&mut state, &mut Scratch::default(), 3.0, &mut ()).unwrap();
        assert!(world.put_to_sleep(&mut state, 1).is_err());
        (world.at(1, &state.bodies()[1], 3.0).path.x.z, state.bodies()[1].phase)
    };
    assert_eq!(run(0.5), (1.0, Phase::Rest));
    assert!(run(0.01).0 < 0.06, "{:?}", run(0.01));
}

#[test]
fn a_ball_rests_on_a_mesh_of_a_thousand_triangles() {
    let world = world(&[Shape::Ball(0.1)], vec![StaticShape::Mesh(Arc::new(square(4.0, 23, &[])))]).unwrap();
    let start = Start { velocity: DVec3::new(0.7, 0.4, 0.0), ..Start::at_rest(DVec3::new(-1.0, -0.5, 0.3)) };
    let (outcome, state) = settled(&world, &[start]);
    let x = state.bodies()[0].path.x;
    assert!(outcome == Outcome::AllAtRest && (x.z - 0.1).abs() < Accuracy::default().gap * 0.1, "{outcome:?} {x}");
}
