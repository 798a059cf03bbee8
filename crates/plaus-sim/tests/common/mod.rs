//! Small worlds shared by the tests.
#![allow(dead_code, unreachable_pub)]

pub mod bumps;
pub mod smooth;
pub mod turning;
pub mod zoo;

use glam::DVec3;
use plaus_sim::marbles::{Marble, MarbleSpec, MarbleWorld, Marbles, Start};
use plaus_sim::scenery::{Dome, Mesh, Plane, Scenery};
use plaus_sim::{Accuracy, Law, Laws, Material, Outcome, Preset, Scratch, State};

pub const G: f64 = 9.81;
pub const M: Material = Material(0);

pub struct World {
    pub specs: Vec<MarbleSpec>,
    pub law: Law,
    pub planes: Vec<Plane>,
    pub domes: Vec<Dome>,
    pub mesh: Mesh,
    pub gravity: DVec3,
    pub accuracy: Accuracy,
    pub duration: f64,
}

impl World {
    pub fn new(specs: Vec<MarbleSpec>, law: Law) -> Self {
        Self {
            specs,
            law,
            planes: Vec::new(),
            domes: Vec::new(),
            mesh: Mesh::new(Vec::new(), &[], 0.0).unwrap(),
            gravity: DVec3::new(0.0, 0.0, -G),
            accuracy: Accuracy::preset(Preset::Reference),
            duration: 100.0,
        }
    }

    pub fn floor(mut self) -> Self {
        self.planes.push(Plane::new(DVec3::ZERO, DVec3::Z, M).unwrap());
        self
    }

    pub fn build(self) -> Marbles {
        let reach = self.specs.iter().map(|s| s.radius).fold(1e-3, f64::max);
        Marbles::new(MarbleWorld {
            specs: self.specs,
            laws: Laws::uniform(self.law).unwrap(),
            scenery: Scenery::new(self.planes, self.mesh, self.domes, reach).unwrap(),
            gravity: self.gravity,
            accuracy: self.accuracy,
            duration: self.duration,
        })
        .unwrap()
    }
}

pub fn unit_ball() -> MarbleSpec {
    MarbleSpec::solid(0.25, 1.0, M)
}

pub fn moving(position: DVec3, velocity: DVec3, spin: DVec3) -> Start {
    Start { position, velocity, spin, time: 0.0 }
}

/// Runs to `until` and brings every marble there.
pub fn run(world: &Marbles, starts: &[Start], until: f64) -> (Vec<Marble>, Outcome, State<Marble>) {
    use plaus_sim::mechanics::Mechanics;
    let mut state = world.state(starts).unwrap();
    let outcome = world.run(&mut state, &mut Scratch::default(), until, &mut ()).unwrap();
    let at = state
        .bodies()
        .iter()
        .enumerate()
        .map(|(k, b)| {
            let mut b = *b;
            world.advance(k, &mut b, until.min(state.time()));
            b
        })
        .collect();
    (at, outcome, state)
}

pub fn total_energy(world: &Marbles, bodies: &[Marble]) -> f64 {
    bodies.iter().enumerate().map(|(k, b)| world.energy(k, b)).sum()
}
