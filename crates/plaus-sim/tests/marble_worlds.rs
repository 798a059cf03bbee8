//! What random worlds of marbles must keep at every preset. Each check fails for a twin that is slightly wrong.

use crate::common::*;
use glam::DVec3;
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_sim::marbles::{Marble, MarbleSpec, Marbles};
use plaus_sim::mechanics::Mechanics;
use plaus_sim::trace::Observer;
use plaus_sim::{Accuracy, Law, Preset, Scratch, State};

fn at(preset: Preset, mut world: World) -> Marbles {
    world.accuracy = Accuracy::preset(preset);
    world.build()
}

/// The state of a random world after one of its events.
#[derive(Clone, Copy)]
struct Sample {
    time: f64,
    energy: f64,
    momentum: DVec3,
}

struct Recorder<'w> {
    world: &'w Marbles,
    samples: Vec<Sample>,
}

impl Observer<Marbles> for Recorder<'_> {
    fn proceed(&mut self, state: &State<Marble>) -> bool {
        self.samples.push(sample(self.world, state));
        true
    }
}

fn sample(world: &Marbles, state: &State<Marble>) -> Sample {
    let mut sum = Sample { time: state.time(), energy: 0.0, momentum: DVec3::ZERO };
    for (k, b) in state.bodies().iter().enumerate() {
        let mut b = *b;
        world.advance(k, &mut b, state.time());
        sum.energy += world.energy(k, &b);
        sum.momentum += b.path.v * world.specs()[k].mass;
    }
    sum
}

/// A few balls with random sizes and masses, thrown onto a floor. They fall into heaps between walls of balls that come
/// down with them.
struct Throw {
    world: Marbles,
    samples: Vec<Sample>,
    mass: f64,
    /// Σ m g r, and Σ m (|v| + √(g r)): scales of energy and momentum.
    weight: f64,
    motion: f64,
}

fn throw(preset: Preset, seed: u64, friction: f64) -> Throw {
    let mut stream = Seed(3).chain(0).at(seed, Purpose::START);
    let mut u = || open_unit(&mut stream);
    let count = 1 + (u() * 7.0) as usize;
    let e = [0.0, 0.3, 0.5, 0.8, 1.0][(u() * 5.0) as usize];
    let (mut specs, mut starts) = (Vec::new(), Vec::new());
    for k in 0..count {
        let radius = 0.05 + 0.05 * u();
        specs.push(MarbleSpec::solid(radius, 1e3 * radius * radius * radius * (1.0 + 9.0 * u()), M));
        let position = DVec3::new(0.1 * u(), 0.1 * u(), 0.1 + 0.21 * k as f64);
        let vector = |u: &mut dyn FnMut() -> f64| DVec3::new(u() - 0.5, u() - 0.5, u() - 0.5);
        starts.push(moving(position, vector(&mut u), vector(&mut u) * 10.0));
    }
    let world = at(preset, World::new(specs, Law::new(friction, e)).floor());
    let mut state = world.state(&starts).unwrap();
    let mut recorder = Recorder { world: &world, samples: vec![sample(&world, &state)] };
    world.run(&mut state, &mut Scratch::default(), 2.0, &mut recorder).unwrap();
    let samples = recorder.samples;
    let sum = |f: &dyn Fn(usize, &MarbleSpec) -> f64| world.specs().iter().enumerate().map(|(k, s)| f(k, s)).sum();
    let mass = sum(&|_, s| s.mass);
    let weight = sum(&|_, s| s.mass * G * s.radius);
    let motion = sum(&|k, s| s.mass * (starts[k].velocity.length() + (G * s.radius).sqrt()));
    Throw { world, samples, mass, weight, motion }
}

/// Horizontal momentum over a smooth floor is kept to rounding: that of thousands of sums of numbers of the size of
/// `motion`.
fn keeps_momentum(throw: &Throw) -> bool {
    let first = throw.samples[0].momentum;
    throw.samples.iter().all(|s| (s.momentum - first).truncate().length() <= 1e-13 * throw.motion)
}

/// Coulomb's bound over a level floor: friction takes at most µ times the momentum with which the floor has pushed up.
fn keeps_the_bound_of_friction(throw: &Throw, friction: f64) -> bool {
    let first = throw.samples[0];
    throw.samples.iter().all(|s| {
        let change = s.momentum - first.momentum;
        let pushed = throw.mass * G * (s.time - first.time) + change.z;
        change.truncate().length() <= friction * pushed + 1e-9 * throw.motion
    })
}

/// Energy never rises above its earlier values, except within a step. There a centre is off its chord by up to v²
/// h²/8ρ: for balls at the speed √(g r), the fraction step²/8 of a radius.
fn never_gains_energy(throw: &Throw) -> bool {
    let step = Accuracy::preset(preset_of(throw)).step;
    let slack = throw.weight * (step * step / 8.0 + 1e-9);
    let mut least = throw.samples[0].energy;
    throw.samples.iter().all(|s| {
        least = least.min(s.energy);
        s.energy <= least + slack
    })
}

fn preset_of(throw: &Throw) -> Preset {
    let accuracy = throw.world.accuracy();
    Preset::ALL.into_iter().find(|&p| Accuracy::preset(p) == accuracy).unwrap()
}

/// The data with every velocity after the middle multiplied by `factor`.
fn scaled(throw: &Throw, factor: f64) -> Vec<Sample> {
    let middle = throw.samples.len() / 2;
    let scale =
        |(k, s): (usize, &Sample)| Sample { momentum: s.momentum * if k < middle { 1.0 } else { factor }, ..*s };
    throw.samples.iter().enumerate().map(scale).collect()
}

const THROWS: u64 = 60;

#[test]
fn smooth_worlds_keep_their_level_momentum() {
    for preset in Preset::ALL {
        let mut caught = 0;
        for seed in 0..THROWS {
            let mut throw = throw(preset, seed, 0.0);
            assert!(keeps_momentum(&throw), "{preset:?} throw {seed}");
            throw.samples = scaled(&throw, 1.0 - 1e-9);
            caught += u64::from(!keeps_momentum(&throw));
        }
        assert!(caught > THROWS / 2, "{preset:?}: a twin that loses a part in 10⁹ is caught {caught} times");
    }
}

#[test]
fn friction_never_takes_more_than_its_bound() {
    for preset in Preset::ALL {
        let mut caught = 0;
        for seed in 0..THROWS {
            assert!(keeps_the_bound_of_friction(&throw(preset, seed, 0.05), 0.05), "{preset:?} throw {seed}");
            // A world whose friction is larger by a twentieth.
            caught += u64::from(!keeps_the_bound_of_friction(&throw(preset, seed, 0.05 * 1.05), 0.05));
        }
        assert!(caught > THROWS / 4, "{preset:?}: the twin is caught {caught} times");
    }
}

#[test]
fn energy_never_grows() {
    for preset in Preset::ALL {
        let mut caught = 0;
        for seed in 0..THROWS {
            for friction in [0.0, 0.3] {
                let mut throw = throw(preset, seed, friction);
                assert!(never_gains_energy(&throw), "{preset:?} throw {seed} friction {friction}");
                // The twin gains a tenth of the scale in the middle.
                let middle = throw.samples.len() / 2;
                let gain = 0.1 * throw.weight;
                throw.samples[middle..].iter_mut().for_each(|s| s.energy += gain);
                caught += u64::from(!never_gains_energy(&throw));
            }
        }
        assert!(caught > THROWS, "{preset:?}: the twin is caught {caught} times");
    }
}
