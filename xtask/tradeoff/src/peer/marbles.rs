//! Marbles over bins in rapier.

use super::{Steps, half_space, vector};
use crate::world::Places;
use glam::DVec3;
use plaus_figures::Result;
use plaus_scenes::spelling::Bins;
use plaus_sim::Law;
use plaus_sim::marbles::Start;
use plaus_sim::scenery::Mesh;
use rapier3d_f64::prelude as peer;

/// Number of quads along a side of a bin that bowls are made of.
const FACETS: usize = 8;

/// The same partitions and walls, bowls of flat facets, no rolling resistance (rapier has none), continuous collision
/// detection on.
pub(crate) struct MarblePeer {
    steps: Steps,
    starts: Vec<Start>,
    handles: Vec<peer::RigidBodyHandle>,
    ball: peer::ColliderBuilder,
}

impl MarblePeer {
    /// `mesh` holds the partitions, wherever their vertices have been moved.
    pub(crate) fn new(bins: &Bins, mesh: &Mesh, starts: Vec<Start>, rate: f64) -> Result<Self> {
        let mut steps = Steps::new(rate, bins.marble);
        let colliders = &mut steps.world.colliders;
        let corners: Vec<peer::Vector> =
            (0..mesh.len()).filter_map(|k| mesh.triangle(k)).flatten().map(vector).collect();
        let triangles = (0..mesh.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        colliders.insert(dress(peer::ColliderBuilder::trimesh(corners, triangles)?, &bins.wall_law));
        let (floor, facets) = bowls(bins);
        colliders.insert(dress(peer::ColliderBuilder::trimesh(floor, facets)?, &bins.wall_law));
        let (width, breadth) = bins.extent();
        let half = 0.5 * bins.thickness;
        for (p, n) in [(half, DVec3::X), (half - width, -DVec3::X), (half, DVec3::Y), (half - breadth, -DVec3::Y)] {
            colliders.insert(dress(half_space(n * p, n), &bins.wall_law));
        }
        let ball = dress(peer::ColliderBuilder::ball(bins.marble).density(bins.density), &bins.marble_law);
        Ok(Self { steps, starts, handles: Vec::new(), ball })
    }

    /// Steps to `time`, or until everything rests.
    pub(crate) fn run_to(&mut self, time: f64) {
        while self.steps.done < self.steps.until(time) {
            self.release();
            if self.handles.len() == self.starts.len() && self.steps.is_at_rest() {
                return;
            }
            self.steps.step(&());
        }
    }

    /// Adds the marbles whose time has come.
    fn release(&mut self) {
        while let Some(start) = self.starts.get(self.handles.len()).filter(|s| s.time <= self.steps.time() + 1e-9) {
            let world = &mut self.steps.world;
            let body = peer::RigidBodyBuilder::dynamic().translation(vector(start.position)).ccd_enabled(true);
            let handle = world.bodies.insert(body);
            world.colliders.insert_with_parent(self.ball.clone(), handle, &mut world.bodies);
            self.handles.push(handle);
        }
    }

    /// Where all marbles are; for those still to come, where they will be released.
    pub(crate) fn places(&self) -> Places {
        let at = |(k, start): (usize, &Start)| {
            Some(self.handles.get(k).map_or(start.position, |&handle| self.steps.place(handle)))
        };
        self.starts.iter().enumerate().map(at).collect()
    }
}

/// A pair's coefficients are the larger of the two friction values and the smaller restitution, so that marbles may
/// differ among themselves.
fn dress(collider: peer::ColliderBuilder, law: &Law) -> peer::ColliderBuilder {
    collider
        .friction(law.friction)
        .restitution(law.restitution)
        .friction_combine_rule(peer::CoefficientCombineRule::Max)
        .restitution_combine_rule(peer::CoefficientCombineRule::Min)
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
