//! The simulator by itself: digests of where marbles, dice, pins, polyhedra and dominoes end, and of every impact on
//! the way. They hold at every optimisation level, on every thread, and however often a work space has been used.

use glam::DVec3;
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_scenes::bowling::Alley;
use plaus_scenes::spelling::{Bins, drops};
use plaus_sim::mechanics::{Impact, Mechanics};
use plaus_sim::rigid::{BodySpec, RigidWorld, RigidWorldDesc, Start, StaticShape};
use plaus_sim::scenery::{Aabb, Plane};
use plaus_sim::shape::{ConvexHull, Cuboid, Shape, Solid};
use plaus_sim::trace::Observer;
use plaus_sim::worlds::DieOnTable;
use plaus_sim::{Accuracy, Law, Laws, Material, Preset, Scratch};
use std::fmt::Write as _;
use std::path::PathBuf;

/// FNV-1a, 64 bits.
struct Digest(u64);

impl Digest {
    fn add(&mut self, bits: u64) {
        for byte in bits.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    fn vector(&mut self, v: DVec3) {
        v.to_array().iter().for_each(|x| self.add(x.to_bits()));
    }
}

/// Digests impacts as they come.
struct Impacts(Digest);

impl<M: Mechanics> Observer<M> for Impacts {
    fn impact(&mut self, impact: &Impact) {
        self.0.add(impact.time.to_bits());
        self.0.vector(impact.point);
        self.0.vector(impact.impulse);
    }
}

fn impacts() -> Impacts {
    Impacts(Digest(0xcbf2_9ce4_8422_2325))
}

/// Ten marbles over bins with perturbed ridges.
fn marbles(preset: Preset, draws: u64) -> u64 {
    let bins = Bins::default();
    let mut world = bins.world(10, Accuracy::preset(preset), 2.0).unwrap();
    let (mut seen, mut scratch) = (impacts(), Scratch::default());
    for draw in 0..draws {
        let mut stream = Seed(3).chain(0).at(draw, Purpose::START);
        let mut uniform = || open_unit(&mut stream);
        world.move_vertices(&bins.perturbed(1e-4, &mut uniform)).unwrap();
        let mut state = world.state(&drops(&bins, 10, 0.1, &mut uniform)).unwrap();
        world.run(&mut state, &mut scratch, 2.0, &mut seen).unwrap();
        for body in state.bodies() {
            seen.0.vector(body.path.x);
            seen.0.vector(body.spin);
        }
    }
    seen.0.0
}

/// Throws of a die onto a table, flat or bumpy.
fn dice(preset: Preset, bumps: f64, draws: u64) -> u64 {
    let die = DieOnTable { bumps, accuracy: Accuracy::preset(preset), ..DieOnTable::default() };
    let (mut seen, mut scratch) = (impacts(), Scratch::default());
    for draw in 0..draws {
        let mut stream = Seed(4).chain(0).at(draw, Purpose::START);
        let start = die.throw(|| open_unit(&mut stream));
        let heights = |i: i64, j: i64| ((i * 7 + j * 3).rem_euclid(11) - 5) as f64 / 5.0;
        let world = die.world(heights).unwrap();
        let mut state = world.state(&[start]).unwrap();
        world.run(&mut state, &mut scratch, 20.0, &mut seen).unwrap();
        let body = &state.bodies()[0];
        seen.0.vector(body.path.x);
        body.turn.to_array().iter().for_each(|x| seen.0.add(x.to_bits()));
    }
    seen.0.0
}

/// A ball at ten pins: the first second and a half.
fn pins(preset: Preset, draws: u64) -> u64 {
    let alley = Alley { accuracy: Accuracy::preset(preset), duration: 1.5, ..Alley::default() };
    let world = alley.world().unwrap();
    let (mut seen, mut scratch) = (impacts(), Scratch::default());
    for draw in 0..draws {
        let velocity = DVec3::new(-0.1 * draw as f64, 8.0, 0.0);
        let spin = DVec3::new(-velocity.y, velocity.x, 0.0) / alley.ball_radius;
        let starts = alley.starts(1.0, 0.03 + 0.02 * draw as f64, velocity, spin).unwrap();
        let mut state = world.state(&starts).unwrap();
        world.run(&mut state, &mut scratch, 1.5, &mut seen).unwrap();
        for body in state.bodies() {
            seen.0.vector(body.path.x);
            body.turn.to_array().iter().for_each(|x| seen.0.add(x.to_bits()));
        }
    }
    seen.0.0
}

/// A d20, a rounded rock, a ball and a cuboid thrown together onto a table with a step.
fn polyhedra(preset: Preset, draws: u64) -> u64 {
    let (edge, material) = (0.016, Material(0));
    let hull = |points: &[DVec3], rounding: f64| Shape::Hull(ConvexHull::new(points, rounding).unwrap().into());
    let rock: Vec<DVec3> = (0..30_u32)
        .map(|k| {
            let part = |prime: u32| f64::from(k * k * prime % 31) / 15.0 - 1.0;
            DVec3::new(part(1), part(3), 0.7 * part(7)) * (0.8 * edge)
        })
        .collect();
    let shapes = [
        hull(&Solid::Icosahedron.corners(0.7 * edge), 0.0),
        hull(&rock, 0.05 * edge),
        Shape::Ball(0.5 * edge),
        Shape::Cuboid(Cuboid::new(DVec3::splat(edge), 0.0).unwrap()),
    ];
    let step = Aabb { min: DVec3::new(0.02, -1.0, 0.0), max: DVec3::new(0.06, 1.0, 0.01) };
    let world = RigidWorld::new(RigidWorldDesc {
        bodies: shapes.into_iter().map(|s| BodySpec::solid(s, 1200.0, material)).collect(),
        parts: vec![
            StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, material).unwrap()),
            StaticShape::Block { bounds: step, material, sections: Vec::new() },
        ],
        laws: Laws::uniform(Law::new(0.35, 0.5).with_resistance(0.02, 0.02)).unwrap(),
        gravity: DVec3::new(0.0, 0.0, -9.81),
        accuracy: Accuracy::preset(preset),
        skin: 1.0,
        sink: f64::NEG_INFINITY,
        duration: 1.0,
    })
    .unwrap();
    let die = DieOnTable { edges: DVec3::splat(2.0 * edge), ..DieOnTable::default() };
    let (mut seen, mut scratch) = (impacts(), Scratch::default());
    for draw in 0..draws {
        let mut stream = Seed(6).chain(0).at(draw, Purpose::START);
        let mut state = world.state(&die.throw_together(4, || open_unit(&mut stream))).unwrap();
        world.run(&mut state, &mut scratch, 1.0, &mut seen).unwrap();
        for body in state.bodies() {
            seen.0.vector(body.path.x);
            body.turn.to_array().iter().for_each(|x| seen.0.add(x.to_bits()));
        }
    }
    seen.0.0
}

/// Eight dominoes that fall over: a crowd, which moves in substeps at the draft and standard presets.
fn dominoes(preset: Preset, draws: u64) -> u64 {
    let (edges, material) = (DVec3::new(0.008, 0.024, 0.048), Material(0));
    let spec = BodySpec::solid(Shape::Cuboid(Cuboid::new(edges, 0.0).unwrap()), 1200.0, material);
    let world = RigidWorld::new(RigidWorldDesc {
        bodies: vec![spec; 8],
        parts: vec![StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, material).unwrap())],
        laws: Laws::uniform(Law::new(0.3, 0.2)).unwrap(),
        gravity: DVec3::new(0.0, 0.0, -9.81),
        accuracy: Accuracy::preset(preset),
        skin: 0.5,
        sink: f64::NEG_INFINITY,
        duration: 1.0,
    })
    .unwrap();
    let (mut seen, mut scratch) = (impacts(), Scratch::default());
    for draw in 0..draws {
        let place = |k: usize| DVec3::new(0.03 * k as f64, 0.001 * (draw as f64 + 1.0) * (k % 3) as f64, 0.024);
        let mut starts: Vec<Start> = (0..8).map(|k| Start::at_rest(place(k))).collect();
        starts[0].spin = DVec3::Y * 15.0;
        starts[0].velocity = starts[0].spin.cross(DVec3::new(-0.5 * edges.x, 0.0, 0.5 * edges.z));
        let mut state = world.state(&starts).unwrap();
        world.run(&mut state, &mut scratch, 1.0, &mut seen).unwrap();
        for body in state.bodies() {
            seen.0.vector(body.path.x);
            body.turn.to_array().iter().for_each(|x| seen.0.add(x.to_bits()));
        }
    }
    seen.0.0
}

/// One line per world and preset.
fn digests() -> String {
    let mut text = String::new();
    let mut line = |name: &str, preset: Preset, digest: u64| {
        writeln!(text, "{name}, {}: {digest:016x}", preset.name()).unwrap();
    };
    for (preset, draws) in [(Preset::Draft, 10), (Preset::Standard, 10), (Preset::Fine, 2)] {
        line("ten marbles", preset, marbles(preset, draws));
        line("a die on a flat table", preset, dice(preset, 0.0, draws));
        line("a die on a bumpy table", preset, dice(preset, 0.1, draws));
    }
    line("ten pins", Preset::Draft, pins(Preset::Draft, 2));
    line("ten pins", Preset::Standard, pins(Preset::Standard, 1));
    line("polyhedra", Preset::Standard, polyhedra(Preset::Standard, 3));
    line("polyhedra", Preset::Fine, polyhedra(Preset::Fine, 1));
    line("dominoes", Preset::Draft, dominoes(Preset::Draft, 2));
    line("dominoes", Preset::Standard, dominoes(Preset::Standard, 1));
    text
}

fn file() -> PathBuf {
    super::root().join("tests/golden/simulator.digests")
}

#[test]
fn golden_traces_have_the_same_bits_in_the_simulator() {
    compare();
}

/// Compares all digests with fresh ones, or writes them anew.
pub(crate) fn compare() {
    // Two threads at once, each with its own work space.
    let other = std::thread::spawn(digests);
    let found = digests();
    assert_eq!(found, other.join().unwrap(), "one thread and another");
    if std::env::var_os("PLAUS_BLESS").is_some_and(|set| !set.is_empty()) {
        std::fs::write(file(), found).unwrap();
        return;
    }
    let stored = std::fs::read_to_string(file()).unwrap_or_default();
    assert_eq!(stored, found, "stored, and found now. Where that is meant: cargo xtask golden --bless");
}

#[test]
fn a_digest_notices_a_single_bit() {
    let of = |x: f64| {
        let mut digest = Digest(0);
        digest.vector(DVec3::new(1.0, x, 3.0));
        digest.0
    };
    assert_ne!(of(2.0), of(f64::from_bits(2.0_f64.to_bits() + 1)));
    assert_eq!(of(2.0), of(2.0));
}
