//! Slanted tables: a world that is turned as a whole, gravity included, moves as it did.

use crate::common::bumps::noise;
use glam::{DQuat, DVec3};
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_sim::field::{Grid, Spline};
use plaus_sim::rigid::{BodySpec, RigidBodyState, RigidWorld, RigidWorldDesc, Start, StaticShape, Table};
use plaus_sim::shape::{ConvexHull, Cuboid, Shape};
use plaus_sim::worlds::DieOnTable;
use plaus_sim::{Accuracy, Law, Laws, Material, Scratch, WorldError};

const SPACING: f64 = 0.01;
/// How long bodies move, in s.
const TIME: f64 = 0.18;

fn shapes() -> Vec<Shape> {
    let corners = [[10.0, 0.0, -6.0], [-9.0, 8.0, -7.0], [-8.0, -9.0, -6.0], [0.0, 1.0, 12.0], [6.0, 7.0, 3.0]];
    let corners: Vec<DVec3> = corners.iter().map(|&corner| DVec3::from_array(corner) * 1e-3).collect();
    vec![
        Shape::Ball(0.008),
        Shape::Cuboid(Cuboid::new(DVec3::splat(0.016), 0.0).unwrap()),
        Shape::Cuboid(Cuboid::new(DVec3::new(0.016, 0.02, 0.012), 0.002).unwrap()),
        Shape::Hull(ConvexHull::new(&corners, 0.0).unwrap().into()),
    ]
}

/// A table with bumps, and friction and restitution that differ from place to place.
fn table() -> Table {
    let field = |name, [low, high]: [f64; 2], shift: i64| {
        let (middle, half) = (0.5 * (low + high), (high - low) / 16.0);
        let grid = Grid { origin: [0.0; 2], spacing: SPACING };
        Spline::new(name, grid, [low, high], move |i, j| middle + half * noise(i + shift, j)).unwrap()
    };
    let mut table = Table::new(field("height", [-0.004, 0.004], 0), Material(0));
    table.friction = Some(field("friction", [0.0, 0.8], 1000));
    table.restitution = Some(field("restitution", [0.1, 0.9], 2000));
    table
}

fn world(shape: &Shape, table: Table, gravity: DVec3) -> Result<RigidWorld, WorldError> {
    RigidWorld::new(RigidWorldDesc {
        bodies: vec![BodySpec::solid(shape.clone(), 1200.0, Material(0))],
        parts: vec![StaticShape::Table(Box::new(table))],
        laws: Laws::uniform(Law::new(0.3, 0.5))?,
        gravity,
        accuracy: Accuracy::default(),
        skin: 1.0,
        sink: f64::NEG_INFINITY,
        duration: 1.0,
    })
}

/// After `time` seconds.
fn after(world: &RigidWorld, start: Start, time: f64) -> RigidBodyState {
    let mut state = world.state(&[start]).unwrap();
    world.run(&mut state, &mut Scratch::default(), time, &mut ()).unwrap();
    world.at(0, &state.bodies()[0], time)
}

/// Throws onto a level table under slanted gravity, and the same turned and moved so that the table is slanted. The
/// numbers are the same but for rounding, which impacts make larger: of most throws it stays below 1e-12 m, of the
/// worst it was 2e-8 m. A table that is turned by 0.1 rad about its own upward axis is told apart.
#[test]
fn a_turned_world_moves_as_it_did() {
    let (mut hits, mut told) = (0, 0);
    for (nth, shape) in shapes().iter().cycle().take(48).enumerate() {
        let mut stream = Seed(21).chain(0).at(nth as u64, Purpose::START);
        let thrown = DieOnTable::default().throw(|| open_unit(&mut stream));
        let around = DieOnTable::default().throw(|| open_unit(&mut stream)).orientation;
        let (moved, lean) = (DVec3::new(0.3, -0.2, 0.7) * nth as f64, open_unit(&mut stream));
        let gravity = DQuat::from_rotation_x(1.2 * lean) * DVec3::new(0.0, 0.0, -9.81);
        let level = after(&world(shape, table(), gravity).unwrap(), thrown, TIME);
        let turned = Start {
            position: moved + around * thrown.position,
            orientation: around * thrown.orientation,
            velocity: around * thrown.velocity,
            spin: around * thrown.spin,
            ..thrown
        };
        let slanted = |turn| world(shape, table().slanted(moved, turn), around * gravity).unwrap();
        let other = after(&slanted(around), turned, TIME);
        let off = (other.path.x - (moved + around * level.path.x)).length();
        assert!(off < 1e-7, "throw {nth}: {off:e} m off");
        hits += usize::from((level.path.v - thrown.velocity - gravity * TIME).length() > 1e-3);
        let wrong = slanted(around * DQuat::from_rotation_z(0.1));
        told += usize::from(
            wrong.state(&[turned]).is_err() || {
                let twin = after(&wrong, turned, TIME);
                (twin.path.x - other.path.x).length() > 1e-5
            },
        );
    }
    assert!(hits >= 40 && told >= 40, "{hits} of 48 struck the table, {told} told a wrong slant");
}

#[test]
fn a_slant_that_is_no_turn_is_refused() {
    for (at, turn) in [(DVec3::splat(f64::NAN), DQuat::IDENTITY), (DVec3::ZERO, DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0))] {
        let made = world(&Shape::Ball(0.01), table().slanted(at, turn), DVec3::ZERO);
        assert!(matches!(made, Err(WorldError::BadSurface { .. })), "{made:?}");
    }
}
