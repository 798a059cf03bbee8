//! Convex polyhedra: the same as cuboids if they are cuboids; rest, energy, outcomes, scale; against balls, cuboids and
//! each other.

use crate::common::bumps::noise;
use crate::common::turning::{Overlaps, same_when_relabelled};
use glam::{DQuat, DVec3};
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_sim::field::{Grid, Spline};
use plaus_sim::rigid::{BodySpec, Phase, RigidBodyState, RigidWorld, RigidWorldDesc, Start, StaticShape, Table};
use plaus_sim::scenery::Plane;
use plaus_sim::shape::{ConvexHull, Cuboid, Shape, Solid};
use plaus_sim::trace::{Observer, Trace};
use plaus_sim::worlds::DieOnTable;
use plaus_sim::{Accuracy, Law, Laws, Material, Outcome, Preset, Scratch, State, WorldError};

const M: Material = Material(0);
const EDGE: f64 = 0.016;

fn hull(points: &[DVec3], rounding: f64) -> Shape {
    Shape::Hull(ConvexHull::new(points, rounding).unwrap().into())
}

/// With an insphere like a die's, so that all are of about the same size.
fn solid(solid: Solid) -> Shape {
    let unit = hull(&solid.corners(1.0), 0.0);
    hull(&solid.corners(0.5 * EDGE / unit.size()), 0.0)
}

/// A stone: the hull of random points in a cube.
fn rock(seed: u64, scale: f64) -> Shape {
    let mut stream = Seed(17).chain(0).at(seed, Purpose::START);
    let mut side = || 2.0 * open_unit(&mut stream) - 1.0;
    let points: Vec<DVec3> = (0..24).map(|_| DVec3::new(side(), side(), side()) * (1.2 * EDGE * scale)).collect();
    hull(&points, 0.0)
}

fn flat() -> StaticShape {
    StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, M).unwrap())
}

fn bumpy(bumps: f64, scale: f64) -> StaticShape {
    let spacing = 0.5 * EDGE * scale;
    let spread = bumps * spacing;
    let grid = Grid { origin: [0.0; 2], spacing };
    let range = [-8.0 * spread, 8.0 * spread];
    let height = Spline::new("height", grid, range, move |i, j| spread * noise(i, j)).unwrap();
    StaticShape::Table(Box::new(Table::new(height, M)))
}

fn plain(shapes: Vec<Shape>, parts: Vec<StaticShape>, law: Law) -> RigidWorldDesc {
    RigidWorldDesc {
        bodies: shapes.into_iter().map(|s| BodySpec::solid(s, 1200.0, M)).collect(),
        parts,
        laws: Laws::uniform(law).unwrap(),
        gravity: DVec3::new(0.0, 0.0, -9.81),
        accuracy: Accuracy::default(),
        skin: 1.0,
        sink: f64::NEG_INFINITY,
        duration: 20.0,
    }
}

fn world(shapes: Vec<Shape>, parts: Vec<StaticShape>, law: Law) -> RigidWorld {
    RigidWorld::new(plain(shapes, parts, law)).unwrap()
}

const WOOD: Law = Law::new(0.35, 0.5);

fn throws(seed: u64, count: u64) -> impl Iterator<Item = Start> {
    (0..count).map(move |k| {
        let mut stream = Seed(seed).chain(0).at(k, Purpose::START);
        DieOnTable::default().throw(|| open_unit(&mut stream))
    })
}

fn together(seed: u64, count: usize) -> Vec<Start> {
    let mut stream = Seed(19).chain(0).at(seed, Purpose::START);
    // Room for bodies a third larger than a die.
    let die = DieOnTable { edges: DVec3::splat(1.8 * EDGE), ..DieOnTable::default() };
    die.throw_together(count, || open_unit(&mut stream))
}

fn traced(world: &RigidWorld, starts: &[Start], until: f64) -> (Trace<RigidBodyState>, State<RigidBodyState>) {
    let (mut trace, mut state) = (Trace::default(), world.state(starts).unwrap());
    world.run(&mut state, &mut Scratch::default(), until, &mut trace).unwrap();
    (trace, state)
}

/// The hull of a cuboid's corners flies, hits the table and hits another hull just as the cuboid does. Masses and
/// moments differ by rounding, and so do times of impacts with the table: by 1e-12 of 0.1 s. Two bodies are found to
/// touch while their gap is between half the gap of the preset and all of it: which look finds it may be decided by
/// rounding.
#[test]
fn a_cuboid_of_points_moves_as_a_cuboid() {
    for edges in [DVec3::splat(EDGE), DVec3::new(0.9, 1.0, 1.2) * EDGE] {
        let cuboid = Cuboid::new(edges, 0.0).unwrap();
        let shapes = [Shape::Cuboid(cuboid), hull(&cuboid.corners(), 0.0)];
        for start in throws(3, 20) {
            let [(a, end), (b, other)] =
                shapes.clone().map(|s| traced(&world(vec![s], vec![flat()], WOOD), &[start], 20.0));
            let (p, q) = (&a.impacts[0], &b.impacts[0]);
            assert!((p.time - q.time).abs() < 1e-12 && (p.point - q.point).length() < 1e-12, "{p:?} {q:?}");
            assert!((p.impulse - q.impulse).length() < 1e-11 * p.impulse.length(), "{p:?} {q:?}");
            assert!(end.all_resting_bodies() && other.all_resting_bodies());
        }
        let law = Law::new(0.4, 0.8);
        for k in 0..20 {
            let starts = together(k, 2).into_iter().map(|s| Start { velocity: -s.position.with_z(0.0) * 30.0, ..s });
            let starts: Vec<Start> = starts.collect();
            let run =
                |s: &Shape, t: &Shape| traced(&world(vec![s.clone(), t.clone()], Vec::new(), law), &starts, 0.1).0;
            let first = run(&shapes[0], &shapes[0]);
            let Some(p) = first.impacts.first() else { continue };
            for pair in [[1, 1], [0, 1], [1, 0]] {
                let other = run(&shapes[pair[0]], &shapes[pair[1]]);
                let q = &other.impacts[0];
                let late = 0.5 * Accuracy::default().gap * EDGE / p.approach;
                // Angular speeds grow by less than a third, as the largest moment over the least is below 16/9.
                let fastest = starts.iter().map(|s| s.spin.length()).fold(0.0, f64::max) * (4.0 / 3.0);
                assert!((p.time - q.time).abs() < late, "{p:?} {q:?}");
                assert!((p.normal - q.normal).length() < 2.0 * fastest * late, "{p:?} {q:?}");
                // Each of the two corners is less than an edge from its centre.
                let turned = 2.0 * fastest * fastest * EDGE * late;
                assert!((p.approach - q.approach).abs() < turned + 2.0 * fastest * late * p.approach, "{p:?} {q:?}");
            }
        }
    }
}

trait Resting {
    fn all_resting_bodies(&self) -> bool;
}

impl Resting for State<RigidBodyState> {
    fn all_resting_bodies(&self) -> bool {
        self.bodies().iter().all(|b| b.phase == Phase::Rest)
    }
}

/// The face that is down, and how far its plane is from level.
fn down(shape: &Shape, body: &RigidBodyState) -> (usize, f64) {
    let Shape::Hull(h) = shape else { unreachable!() };
    let heights = (0..h.faces().count()).map(|k| (body.turn * h.normal(k).unwrap()).z);
    let (face, z) = heights.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
    (face, 1.0 + z)
}

#[test]
fn regular_dice_land_on_a_face_and_stay() {
    for kind in [Solid::Tetrahedron, Solid::Octahedron, Solid::Dodecahedron, Solid::Icosahedron] {
        let shape = solid(kind);
        let world = world(vec![shape.clone()], vec![flat()], WOOD);
        let mut scratch = Scratch::default();
        let mut faces = vec![0; kind.faces()];
        for start in throws(11, 60) {
            let mut state = world.state(&[start]).unwrap();
            assert_eq!(world.run(&mut state, &mut scratch, 20.0, &mut ()).unwrap(), Outcome::AllAtRest);
            let body = state.bodies()[0].clone();
            let (face, tilt) = down(&shape, &body);
            faces[face] += 1;
            // Flat on it: in the table by rounding at most, off it by no more than the preset's gap of 1e-5 insphere
            // radii.
            assert!(tilt < 1e-10, "{kind:?}: {tilt}");
            let off = body.path.x.z - shape.size();
            assert!((-1e-15..=1e-5 * shape.size()).contains(&off), "{kind:?}: {off}");
            assert!(body.touching().len() >= 3);
            let later = world.at(0, &body, state.time() + 60.0);
            assert_eq!((later.path.x, later.turn), (body.path.x, body.turn));
        }
        assert!(faces.iter().filter(|&&n| n > 0).count() * 2 > faces.len(), "{kind:?}: {faces:?}");
    }
}

#[test]
fn throws_end_in_an_outcome_and_none_goes_through_the_table() {
    for kind in [Solid::Tetrahedron, Solid::Icosahedron] {
        let shape = solid(kind);
        let corners = match &shape {
            Shape::Hull(h) => h.corners().to_vec(),
            _ => unreachable!(),
        };
        let mut scratch = Scratch::default();
        let mut rest = 0;
        for (bumps, count) in [(0.0, 1000), (0.15, 150)] {
            let table = if bumps > 0.0 { bumpy(bumps, 1.0) } else { flat() };
            let world = world(vec![shape.clone()], vec![table], WOOD);
            for start in throws(23, count) {
                let start = Start { position: start.position + DVec3::Z * 0.05, ..start };
                let mut state = world.state(&[start]).unwrap();
                let outcome = world.run(&mut state, &mut scratch, 20.0, &mut ()).unwrap();
                rest += u32::from(outcome == Outcome::AllAtRest);
                assert!(!matches!(outcome, Outcome::NotFinite { .. } | Outcome::Stopped), "{kind:?}: {outcome:?}");
                let body = &state.bodies()[0];
                for &c in &corners {
                    let at = body.path.x + body.turn * c;
                    let ground = match &world.parts()[0] {
                        StaticShape::Table(t) => t.height.value(at.x, at.y),
                        _ => 0.0,
                    };
                    // No corner is in the table by more than the preset's gap.
                    assert!(at.z - ground > -1e-5 * shape.size(), "{kind:?}: {} at {at}", at.z - ground);
                }
            }
        }
        // A tetrahedron on two points of a bumpy table may rock, too little to be seen, for as long as it is followed.
        assert!(rest > 1140, "{kind:?}: {rest} of 1150 at rest");
    }
}

/// Sums the bodies' energies whenever the time has moved on.
struct Energy<'w> {
    world: &'w RigidWorld,
    each: Vec<f64>,
    time: f64,
    last: f64,
    slack: f64,
}

impl Observer<RigidWorld> for Energy<'_> {
    fn motion(&mut self, index: usize, body: &RigidBodyState) {
        if body.path.t > self.time {
            let sum: f64 = self.each.iter().sum();
            assert!(sum <= self.last + self.slack, "{} to {sum} at {}, may be {}", self.last, self.time, self.slack);
            (self.last, self.time) = (sum, body.path.t);
        }
        self.each[index] = self.world.energy(index, body);
    }
}

/// A d20, a ball, a rock and a cuboid above each other, turned and spinning.
fn four() -> (Vec<Shape>, Vec<Start>) {
    let cuboid = Cuboid::new(DVec3::splat(EDGE), 0.1 * EDGE).unwrap();
    let shapes = vec![solid(Solid::Icosahedron), Shape::Ball(0.5 * EDGE), rock(1, 1.0), Shape::Cuboid(cuboid)];
    let starts = [(0.0, 1.0), (0.2, 2.7), (-0.1, 5.0), (0.3, 7.5)].map(|(x, z)| Start {
        orientation: DQuat::from_xyzw(0.1 * z, 0.3, -0.2, 0.7),
        spin: DVec3::new(3.0, -1.0, 2.0),
        ..Start::at_rest(DVec3::new(x, 0.1 * x, z) * EDGE)
    });
    (shapes, starts.to_vec())
}

#[test]
fn energy_never_grows() {
    for e in [0.0, 0.5, 1.0] {
        for mu in [0.0, 1e-8, 0.3, 1e8] {
            let (shapes, starts) = four();
            let mut plain = plain(shapes, vec![flat()], Law::new(mu, e));
            plain.accuracy = Accuracy { events: 400, ..Accuracy::preset(Preset::Standard) };
            // As for dice: bodies that are pushed out of the overlaps that steps leave rise by less than a thousandth
            // of their size.
            let scale: f64 = plain.bodies.iter().map(|b| b.mass.mass * 9.81 * b.shape.reach()).sum::<f64>() * 1e-3;
            let world = RigidWorld::new(plain).unwrap();
            let mut state = world.state(&starts).unwrap();
            let each: Vec<f64> = state.bodies().iter().enumerate().map(|(k, b)| world.energy(k, b)).collect();
            let mut energy = Energy { world: &world, each, time: 0.0, last: f64::INFINITY, slack: scale };
            let outcome = world.run(&mut state, &mut Scratch::default(), 4.0, &mut energy).unwrap();
            assert!(!matches!(outcome, Outcome::NotFinite { .. } | Outcome::Stopped), "{outcome:?} for e {e}, mu {mu}");
        }
    }
}

fn mixed() -> Vec<Shape> {
    let cuboid = Cuboid::new(DVec3::splat(EDGE), 0.0).unwrap();
    let die = Shape::Cuboid(cuboid);
    vec![solid(Solid::Tetrahedron), solid(Solid::Icosahedron), die, Shape::Ball(0.5 * EDGE), rock(2, 1.0), rock(3, 0.8)]
}

/// As for dice: five times the sag that a step of lasting contact may have half way.
#[test]
fn thrown_together_they_come_to_rest_and_are_never_in_each_other() {
    for (bumps, count) in [(0.0, 25), (0.1, 5)] {
        for k in 0..count {
            let table = if bumps > 0.0 { bumpy(bumps, 1.0) } else { flat() };
            let law = Law::new(0.4, 0.4).with_resistance(0.02, 0.02);
            let world = world(mixed(), vec![table], law);
            let mut state = world.state(&together(k, 6)).unwrap();
            let mut overlaps = Overlaps::new(&world, &state);
            let outcome = world.run(&mut state, &mut Scratch::default(), 20.0, &mut overlaps).unwrap();
            assert!(
                matches!(outcome, Outcome::AllAtRest | Outcome::TimeReached),
                "{outcome:?} in throw {k} on bumps {bumps}"
            );
            assert!(overlaps.worst < 5e-3 * 0.5 * EDGE, "{} m in throw {k} on bumps {bumps}", overlaps.worst);
        }
    }
}

/// Lengths × 4, times × 2: every number of the result is that of the small world, scaled exactly.
#[test]
fn scaling_keeps_the_bits() {
    for bumps in [0.0, 0.1] {
        for k in 0..4 {
            let run = |scale: f64, time: f64| {
                let corners = |s: Solid| s.corners(EDGE).into_iter().map(|p| p * scale).collect::<Vec<_>>();
                let shapes = vec![
                    hull(&corners(Solid::Icosahedron), 0.0),
                    hull(&corners(Solid::Tetrahedron), 0.05 * EDGE * scale),
                    rock(k, scale),
                    Shape::Ball(0.5 * EDGE * scale),
                ];
                let table = if bumps > 0.0 { bumpy(bumps, scale) } else { flat() };
                let world = world(shapes, vec![table], WOOD);
                let starts: Vec<Start> = together(k, 4)
                    .into_iter()
                    .map(|s| Start {
                        position: s.position * (1.5 * scale),
                        velocity: s.velocity * (scale / time),
                        spin: s.spin / time,
                        ..s
                    })
                    .collect();
                let mut state = world.state(&starts).unwrap();
                world.run(&mut state, &mut Scratch::default(), 2.0 * time, &mut ()).unwrap();
                let places: Vec<_> = state.bodies().iter().map(|b| (b.path.x / scale, b.turn, b.spin * time)).collect();
                (places, state.time() / time, state.counts())
            };
            assert_eq!(run(1.0, 1.0), run(4.0, 2.0), "throw {k} on bumps {bumps}");
        }
    }
}

/// Two relabelled bodies do the same to the last bit, whichever is a polyhedron.
#[test]
fn relabelling_permutes_flights_and_impacts() {
    let mut impacts = 0;
    for k in 0..60 {
        let all = [rock(k, 1.0), solid(Solid::Octahedron), Shape::Ball(0.5 * EDGE), rock(k + 100, 0.9)];
        let other = 1 + (k as usize) % 3;
        let world = |order: [usize; 2]| {
            let shapes = order.map(|b| all[b * other].clone()).to_vec();
            let world = plain(shapes, Vec::new(), Law::new(0.3, 0.8));
            RigidWorld::new(RigidWorldDesc { gravity: DVec3::ZERO, ..world }).unwrap()
        };
        let thrown = together(k, 2);
        let starts = [0, 1].map(|b| Start { velocity: thrown[b].velocity - thrown[b].position * 20.0, ..thrown[b] });
        impacts += same_when_relabelled(world, starts, 0.12, &format!("throw {k}"));
    }
    assert!(impacts > 20, "{impacts}");
}

/// A ball falls onto the middle of a resting d20's upper face: it meets the face when a ball meets a plane there, and
/// the impact conserves what it must.
#[test]
fn a_ball_meets_a_face_when_it_should() {
    let d20 = solid(Solid::Icosahedron);
    let world = world(vec![d20.clone(), Shape::Ball(0.25 * EDGE)], vec![flat()], Law::new(0.4, 0.5));
    let Shape::Hull(h) = &d20 else { unreachable!() };
    let lying = DQuat::from_rotation_arc(h.normal(0).unwrap(), -DVec3::Z);
    let lower = Start { orientation: lying, ..Start::at_rest(DVec3::Z * d20.size()) };
    let height = 0.05;
    let upper = Start::at_rest(DVec3::Z * (2.0 * d20.size() + 0.25 * EDGE + height));
    let (trace, _) = traced(&world, &[lower, upper], 0.2);
    let hit = trace.impacts.iter().find(|i| i.approach > 0.5).unwrap();
    // Early by less than the time in which the preset's gap for the smaller body closes.
    let (time, speed) = ((2.0 * height / 9.81_f64).sqrt(), (2.0 * height * 9.81_f64).sqrt());
    let gap = 1e-5 * 0.25 * EDGE;
    assert!((-2.0 * gap / speed..=1e-15).contains(&(hit.time - time)), "{hit:?} for {time}");
    assert!(hit.normal.z.abs() > 1.0 - 1e-9 && (hit.approach - speed).abs() < 1e-4 * speed, "{hit:?}");
}

/// A thousand metres a second and ten thousand radians a second, from a tenth of a millimetre to a hundred metres, a
/// million times heavier or lighter: a body on its way into another hits it.
#[test]
fn nothing_fast_or_small_or_heavy_passes() {
    for size in [1e-4, 1e-2, 1.0, 1e2] {
        for (heavy, speed) in [(1.0, 1e3), (1e6, 1e3), (1e-6, 1.0), (1.0, 1e-3)] {
            for (k, target) in [Solid::Icosahedron, Solid::Tetrahedron, Solid::Dodecahedron].into_iter().enumerate() {
                let shapes =
                    vec![hull(&Solid::Tetrahedron.corners(size), 0.0), hull(&target.corners(size), 0.1 * size)];
                let reach: f64 = shapes.iter().map(Shape::reach).sum();
                let mut plain = plain(shapes, Vec::new(), Law::new(0.3, 0.9));
                plain.gravity = DVec3::ZERO;
                plain.bodies[1].mass = plain.bodies[1].mass.with_mass(plain.bodies[0].mass.mass * heavy);
                plain.duration = 1e9;
                let world = RigidWorld::new(plain).unwrap();
                let (far, spin) = (10.0 * size, 10.0 * speed / size);
                let flying = Start {
                    velocity: DVec3::X * speed,
                    spin: DVec3::new(0.3, -0.2 * k as f64, 1.0) * spin,
                    ..Start::at_rest(DVec3::new(-far, 0.1 * size, 0.0))
                };
                let (trace, state) = traced(&world, &[flying, Start::at_rest(DVec3::ZERO)], 20.0 * size / speed);
                let first = trace.impacts.first().expect("an impact");
                assert!(first.time >= (far - reach) / speed && first.time <= far / speed, "{first:?}");
                assert!(state.bodies().iter().all(|b| b.path.v.is_finite() && b.spin.is_finite()));
            }
        }
    }
}

#[test]
fn overlaps_at_the_start_are_reported() {
    // A hull that is in another at the start is named as dice are.
    let world = world(vec![solid(Solid::Octahedron); 2], vec![flat()], WOOD);
    let at = |x: f64| Start::at_rest(DVec3::new(x, 0.0, 0.1));
    assert!(matches!(world.state(&[at(0.0), at(0.5 * EDGE)]), Err(WorldError::BodiesOverlap { a: 0, b: 1, .. })));
    let low = Start::at_rest(DVec3::Z * (0.3 * EDGE));
    assert!(matches!(world.state(&[low, at(0.5)]), Err(WorldError::OverlapsScenery { body: 0, .. })));
}
