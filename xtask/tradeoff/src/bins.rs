//! Ten marbles dropped one after another into 7 × 5 bins.

use crate::world::{Way, World};
use glam::DVec3;
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_figures::Result;
use plaus_sim::marbles::{MarbleScratch, Marbles, Start};
use plaus_sim::worlds::{Bins, drops};
use plaus_sim::{Accuracy, Preset, Scratch};
use rapier3d_f64::prelude as peer;
use std::time::Instant;

const COUNT: usize = 10;
const INTERVAL: f64 = 0.1;
const DURATION: f64 = 2.0;
/// Quads along a side of a bin by which the peer's bowls are made.
const FACETS: usize = 8;

pub(crate) struct MarblesOverBins {
    bins: Bins,
    worlds: Vec<(Preset, Marbles)>,
    scratch: Scratch<MarbleScratch>,
}

impl MarblesOverBins {
    pub(crate) fn new() -> Result<Self> {
        let bins = Bins::default();
        let world = |preset| Ok((preset, bins.world(COUNT, Accuracy::preset(preset), DURATION)?));
        let worlds = Preset::ALL.into_iter().map(world).collect::<Result<_>>()?;
        Ok(Self { bins, worlds, scratch: Scratch::default() })
    }

    fn starts(&self, draw: u64) -> Vec<Start> {
        let mut stream = Seed(7).chain(0).at(draw, Purpose::START);
        drops(&self.bins, COUNT, INTERVAL, || open_unit(&mut stream))
    }

    /// Number of bins with a marble below the ridges.
    fn filled(&self, at: impl IntoIterator<Item = DVec3>) -> usize {
        let mut filled: Vec<_> =
            at.into_iter().filter(|x| x.z < self.bins.height).filter_map(|x| self.bins.bin_of(x)).collect();
        filled.sort_unstable();
        filled.dedup();
        filled.len()
    }
}

impl World for MarblesOverBins {
    fn name(&self) -> &'static str {
        "bins"
    }

    fn title(&self) -> &'static str {
        "Ten marbles over 7 × 5 bins"
    }

    fn about(&self) -> &'static str {
        "12 mm glass marbles, one every 0.1 s, into 20 mm bins with bowls and 2 mm × 12 mm partitions; 2 s. Outcome: how many bins are filled. The peer has the same \
         partitions and walls, bowls of flat facets, no resistance to rolling (it knows none), continuous collision detection on, and its length unit set to 1 cm; marbles are put in when they are \
         released. Time is that of stepping alone."
    }

    fn outcomes(&self) -> usize {
        COUNT + 1
    }

    fn tolerance(&self) -> f64 {
        0.1 * self.bins.marble
    }

    fn outcome(&mut self, way: Way, draw: u64) -> Result<(usize, f64)> {
        let starts = self.starts(draw);
        let (end, seconds) = match way {
            Way::Preset(preset) => {
                let (_, world) = self.worlds.iter().find(|w| w.0 == preset).ok_or("no such preset")?;
                let mut state = world.state(&starts)?;
                let begin = Instant::now();
                world.run(&mut state, &mut self.scratch, DURATION, &mut ());
                let seconds = begin.elapsed().as_secs_f64();
                let time = state.time();
                (state.bodies().iter().map(|b| b.path.at(time.max(b.path.t))).collect(), seconds)
            }
            Way::Peer(rate) => {
                let mut simulation = Peer::new(&self.bins, &starts, rate)?;
                let begin = Instant::now();
                simulation.run_to(DURATION);
                let seconds = begin.elapsed().as_secs_f64();
                (simulation.positions(), seconds)
            }
        };
        Ok((self.filled(end), seconds))
    }

    fn positions(&mut self, way: Way, draw: u64, times: &[f64]) -> Result<Vec<Vec<DVec3>>> {
        let starts = self.starts(draw);
        match way {
            Way::Preset(preset) => {
                let (_, world) = self.worlds.iter().find(|w| w.0 == preset).ok_or("no such preset")?;
                let mut state = world.state(&starts)?;
                let mut at = |&time: &f64| {
                    world.run(&mut state, &mut self.scratch, time, &mut ());
                    state.bodies().iter().map(|b| if b.path.t > time { b.path.x } else { b.path.at(time) }).collect()
                };
                Ok(times.iter().map(&mut at).collect())
            }
            Way::Peer(rate) => {
                let mut simulation = Peer::new(&self.bins, &starts, rate)?;
                let mut at = |&time: &f64| {
                    simulation.run_to(time);
                    simulation.positions()
                };
                Ok(times.iter().map(&mut at).collect())
            }
        }
    }
}

/// The same world in rapier.
struct Peer {
    world: peer::PhysicsWorld,
    starts: Vec<Start>,
    handles: Vec<peer::RigidBodyHandle>,
    radius: f64,
    density: f64,
    law: (f64, f64),
    rate: f64,
    steps: u64,
}

fn vector(x: DVec3) -> peer::Vector {
    peer::Vector::new(x.x, x.y, x.z)
}

impl Peer {
    fn new(bins: &Bins, starts: &[Start], rate: f64) -> Result<Self> {
        let gravity = peer::Vector::new(0.0, 0.0, -9.81);
        let mut world = peer::PhysicsWorld { gravity, ..Default::default() };
        world.integration_parameters.dt = 1.0 / rate;
        world.integration_parameters.length_unit = 0.01;
        let (mesh, law) = (bins.mesh()?, bins.wall_law);
        // A pair's coefficients: the larger of the two friction values, the smaller restitution, so that marbles can differ among themselves.
        let dress = |c: peer::ColliderBuilder| {
            c.friction(law.friction)
                .restitution(law.restitution)
                .friction_combine_rule(peer::CoefficientCombineRule::Max)
                .restitution_combine_rule(peer::CoefficientCombineRule::Min)
        };
        let corners: Vec<peer::Vector> =
            (0..mesh.len()).filter_map(|k| mesh.triangle(k)).flatten().map(vector).collect();
        let triangles = (0..mesh.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        world.colliders.insert(dress(peer::ColliderBuilder::trimesh(corners, triangles)?));
        let (floor, facets) = bowls(bins);
        world.colliders.insert(dress(peer::ColliderBuilder::trimesh(floor, facets)?));
        let (width, breadth) = bins.extent();
        let half = 0.5 * bins.thickness;
        for (p, n) in [(half, DVec3::X), (half - width, -DVec3::X), (half, DVec3::Y), (half - breadth, -DVec3::Y)] {
            world
                .colliders
                .insert(dress(peer::ColliderBuilder::cuboid(0.5, 0.5, 0.5).translation(vector(n * (p - 0.5)))));
        }
        let law = (bins.marble_law.friction, bins.marble_law.restitution);
        Ok(Self {
            world,
            starts: starts.to_vec(),
            handles: Vec::new(),
            radius: bins.marble,
            density: bins.density,
            law,
            rate,
            steps: 0,
        })
    }

    fn run_to(&mut self, time: f64) {
        let until = (time * self.rate).round() as u64;
        while self.steps < until {
            while self.handles.len() < self.starts.len()
                && self.starts[self.handles.len()].time <= self.steps as f64 / self.rate + 1e-9
            {
                let start = self.starts[self.handles.len()];
                let body = peer::RigidBodyBuilder::dynamic().translation(vector(start.position)).ccd_enabled(true);
                let handle = self.world.bodies.insert(body);
                let ball = peer::ColliderBuilder::ball(self.radius)
                    .density(self.density)
                    .friction(self.law.0)
                    .restitution(self.law.1);
                let ball = ball
                    .friction_combine_rule(peer::CoefficientCombineRule::Max)
                    .restitution_combine_rule(peer::CoefficientCombineRule::Min);
                self.world.colliders.insert_with_parent(ball, handle, &mut self.world.bodies);
                self.handles.push(handle);
            }
            self.world.step();
            self.steps += 1;
        }
    }

    fn positions(&self) -> Vec<DVec3> {
        let at = |(k, start): (usize, &Start)| {
            self.handles.get(k).map_or(start.position, |&h| {
                let p = self.world.bodies[h].translation();
                DVec3::new(p.x, p.y, p.z)
            })
        };
        self.starts.iter().enumerate().map(at).collect()
    }
}

/// The bowls as facets, normals up.
fn bowls(bins: &Bins) -> (Vec<peer::Vector>, Vec<[u32; 3]>) {
    let (mut corners, mut facets) = (Vec::new(), Vec::new());
    let depth = |x: f64| x / FACETS as f64 * bins.side;
    for bin in 0..bins.columns * bins.rows {
        let (i, j) = ((bin % bins.columns) as f64 * bins.side, (bin / bins.columns) as f64 * bins.side);
        let first = corners.len() as u32;
        for b in 0..=FACETS {
            for a in 0..=FACETS {
                let (x, y) = (depth(a as f64), depth(b as f64));
                let (p, q) = (x - 0.5 * bins.side, y - 0.5 * bins.side);
                let z = bins.bowl - (bins.bowl * bins.bowl - p * p - q * q).sqrt();
                corners.push(peer::Vector::new(i + x, j + y, z));
            }
        }
        let row = FACETS as u32 + 1;
        for b in 0..FACETS as u32 {
            for a in 0..FACETS as u32 {
                let k = first + b * row + a;
                facets.extend([[k, k + 1, k + row + 1], [k, k + row + 1, k + row]]);
            }
        }
    }
    (corners, facets)
}
