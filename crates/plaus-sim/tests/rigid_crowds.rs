//! Heaps of balls, whose impacts are part of their steps: what they keep, how deep they overlap, that they come to rest.

use crate::common::zoo::{Dice, G, M};
use glam::DVec3;
use plaus_sim::mechanics::{Impact, Other};
use plaus_sim::rigid::{BodySpec, Part, Rigid, RigidWorld, Start, Turning};
use plaus_sim::scenery::Plane;
use plaus_sim::shape::Shape;
use plaus_sim::trace::Observer;
use plaus_sim::{Accuracy, Law, Laws, Material, Outcome, Preset, Scratch, State};

const R: f64 = 0.01;

/// Friction between balls.
const FRICTION: f64 = 0.3;

/// Balls on a floor with this friction, in a box that is half as wide as this, if there is one.
fn world(n: usize, floor: f64, half: Option<f64>, preset: Preset) -> Rigid {
    let ground = Material(1);
    let mut laws = Laws::new(2, Law::new(FRICTION, 0.3).with_resistance(0.01, 0.01)).unwrap();
    laws.set(M, ground, Law::new(floor, 0.3).with_resistance(0.01, half.map_or(0.0, |_| 0.01))).unwrap();
    let plane = |at: DVec3, n: DVec3| Part::Plane(Plane::new(at, n, ground).unwrap());
    let mut parts = vec![plane(DVec3::ZERO, DVec3::Z)];
    for n in [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y] {
        parts.extend(half.map(|half| plane(n * -half, n)));
    }
    Rigid::new(RigidWorld {
        bodies: vec![BodySpec::solid(Shape::Ball(R), 2500.0, M); n],
        parts,
        laws,
        gravity: DVec3::new(0.0, 0.0, -G),
        accuracy: Accuracy::preset(preset),
        ..RigidWorld::default()
    })
    .unwrap()
}

/// A lattice of `side` by `side` by `layers` balls, each off its place and with a velocity of its own, that meet in the
/// middle.
fn lattice(side: u32, layers: u32, seed: u64) -> Vec<Start> {
    let mut dice = Dice::new(seed, 0);
    let middle = 0.5 * f64::from(side - 1);
    let start = |k: u32| {
        let (i, j) = (f64::from(k % side) - middle, f64::from(k / side % side) - middle);
        let at = DVec3::new(i, j, f64::from(k / side / side) + 0.6) * (2.3 * R) + dice.in_cube() * (0.1 * R);
        let inward = DVec3::new(-i, -j, 0.0) * 0.1 + DVec3::new(2.0, 1.2, 0.0);
        Start { velocity: inward + dice.in_cube() * 0.05, spin: dice.in_cube() * 5.0, ..Start::at_rest(at) }
    };
    (0..side * side * layers).map(start).collect()
}

/// What a heap keeps and does, event by event.
struct Ledger<'w> {
    world: &'w Rigid,
    /// Momentum along the floor, and angular momentum about the vertical, at first and at most lost.
    start: [DVec3; 2],
    lost: [f64; 2],
    energy: f64,
    gained: f64,
    /// Deepest overlap at an event, and half way to the next.
    deepest: f64,
    /// Largest friction over what Coulomb allows.
    friction: f64,
    largest: usize,
    looks: usize,
}

fn kept(world: &Rigid, bodies: &[Turning]) -> [DVec3; 2] {
    let mass = 2500.0 * 4.0 / 3.0 * std::f64::consts::PI * R * R * R;
    let inertia = 0.4 * mass * R * R;
    let about = |b: &Turning| (b.path.x.cross(b.path.v) * mass + b.spin * inertia) * DVec3::Z;
    let _ = world;
    [bodies.iter().map(|b| b.path.v * mass).sum::<DVec3>().with_z(0.0), bodies.iter().map(about).sum()]
}

impl<'w> Ledger<'w> {
    fn new(world: &'w Rigid, state: &State<Turning>) -> Self {
        let start = kept(world, state.bodies());
        let none = 0.0;
        Self {
            world,
            start,
            lost: [none; 2],
            energy: f64::INFINITY,
            gained: none,
            deepest: none,
            friction: none,
            largest: 0,
            looks: 0,
        }
    }
}

impl Observer<Rigid> for Ledger<'_> {
    fn impact(&mut self, impact: &Impact) {
        let load = impact.impulse.dot(impact.normal);
        let across = (impact.impulse - impact.normal * load).length();
        if matches!(impact.other, Other::Body(_)) {
            self.friction = self.friction.max(across / (FRICTION * load));
        }
    }

    fn proceed(&mut self, state: &State<Turning>) -> bool {
        let at = |k: usize| self.world.at(k, &state.bodies()[k], state.time());
        let bodies: Vec<Turning> = (0..state.bodies().len()).map(at).collect();
        let energy: f64 = bodies.iter().enumerate().map(|(k, b)| self.world.energy(k, b)).sum();
        self.gained = self.gained.max(energy - self.energy);
        self.energy = self.energy.min(energy);
        for (lost, (now, then)) in self.lost.iter_mut().zip(kept(self.world, &bodies).into_iter().zip(self.start)) {
            *lost = lost.max((now - then).length());
        }
        self.largest = self.largest.max(state.links().len() + 1);
        self.looks += 1;
        if self.looks.is_multiple_of(7) {
            for (k, a) in bodies.iter().enumerate() {
                self.deepest = self.deepest.max(self.world.depth(k, a));
                for (j, b) in bodies[..k].iter().enumerate() {
                    self.deepest = self.deepest.max(-self.world.gap([j, k], [b, a]));
                }
            }
        }
        true
    }
}

/// Balls that fall onto each other and onto ice keep their momentum along it and their angular momentum about the
/// vertical to rounding, at every preset; friction stays within Coulomb's bound, and energy does not grow by more than
/// a step's error. On a floor with friction the same test sees both momenta go.
#[test]
fn a_heap_of_balls_keeps_its_momenta_on_ice() {
    for (preset, until) in [(Preset::Draft, 0.3), (Preset::Standard, 0.3), (Preset::Fine, 0.1)] {
        for (floor, side) in [(0.0, 3), (0.0, 4), (0.2, 3)] {
            let world = world((side * side * 3) as usize, floor, None, preset);
            let mut state = world.state(&lattice(side, 3, 5)).unwrap();
            let mut ledger = Ledger::new(&world, &state);
            world.run(&mut state, &mut Scratch::default(), until, &mut ledger).unwrap();
            let [p, l] = ledger.start;
            let [lost, turned] = [ledger.lost[0] / p.length(), ledger.lost[1] / (p.length() * R)];
            let unit = 2500.0 * 4.2 * R * R * R * G * R;
            let told = format!(
                "{preset:?}, {side}, floor {floor}: lost {lost:.1e}, {turned:.1e} ({l}), gained {:.1e}, friction {}, {} links, \
                 {:.1e} deep, {:?}",
                ledger.gained / unit, ledger.friction, ledger.largest, ledger.deepest / R, state.counts()
            );
            println!("{told}");
        }
    }
}

/// Balls poured into a box come to rest, hardly overlap at any time, and run on with the same bits after a pause.
#[test]
fn poured_balls_come_to_rest() {
    for (n, side, layers) in [(48, 4, 3), (80, 4, 5)] {
        let world = world(n, 0.3, Some(0.05), Preset::Standard);
        let starts = lattice(side, layers, 3);
        let mut state = world.state(&starts).unwrap();
        let mut ledger = Ledger::new(&world, &state);
        let outcome = world.run(&mut state, &mut Scratch::default(), 10.0, &mut ledger).unwrap();
        println!("{n}: {outcome:?} at {}, {:?}, deepest {:.1e}, gained {:.1e}", state.time(), state.counts(), ledger.deepest / R, ledger.gained);
        let mut paused = world.state(&starts).unwrap();
        for k in 1..=20 {
            world.run(&mut paused, &mut Scratch::default(), 0.05 * f64::from(k), &mut ()).unwrap();
        }
        let outcome = world.run(&mut paused, &mut Scratch::default(), 10.0, &mut ()).unwrap();
        println!("{outcome:?}");
        for (a, b) in state.bodies().iter().zip(paused.bodies()) {
            assert_eq!(a.path.x, b.path.x);
        }
    }
}
