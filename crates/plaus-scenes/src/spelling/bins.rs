//! Marbles over bins: thin partitions with tessellated, perturbed tops, and a bowl under each bin.

use glam::DVec3;
use plaus_sim::marbles::{MarbleSpec, MarbleWorld, Marbles, Start};
use plaus_sim::scenery::{Aabb, Dome, Mesh, Plane, Scenery};
use plaus_sim::{Accuracy, Law, Laws, Material, WorldError};

/// Dimensions in metres, after figure 10 of Chenney & Forsyth (2000).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bins {
    /// Bins along x.
    pub columns: usize,
    /// Bins along y.
    pub rows: usize,
    /// Side of a bin, from the middle of one partition to the middle of the next.
    pub side: f64,
    /// Thickness of a partition.
    pub thickness: f64,
    /// Height of the partitions' ridges.
    pub height: f64,
    /// How far the ridge stands above the partition's shoulders; 0 for a flat top.
    pub crown: f64,
    /// Depth of the box, whose walls stand around the bins.
    pub depth: f64,
    /// Radius of the bowl under each bin.
    pub bowl: f64,
    /// Height from which marbles fall.
    pub drop: f64,
    /// Radius of a marble.
    pub marble: f64,
    /// Density of a marble in kg/m³.
    pub density: f64,
    /// The farthest that a vertex will be moved.
    pub margin: f64,
    /// Law between marbles and box.
    pub wall_law: Law,
    /// Law between marbles.
    pub marble_law: Law,
}

impl Default for Bins {
    /// The paper's 20 mm bins with 2 mm × 12 mm partitions, and 12 mm glass marbles.
    fn default() -> Self {
        Self {
            columns: 7,
            rows: 5,
            side: 0.020,
            thickness: 0.002,
            height: 0.012,
            crown: 0.0,
            depth: 0.036,
            bowl: 0.040,
            drop: 0.072,
            marble: 0.006,
            density: 2500.0,
            margin: 0.0008,
            wall_law: Law::new(0.3, 0.5).with_resistance(0.02, 0.01),
            marble_law: Law::new(0.1, 0.8),
        }
    }
}

impl Bins {
    /// Extent along x and y.
    #[must_use]
    pub fn extent(&self) -> (f64, f64) {
        (self.columns as f64 * self.side, self.rows as f64 * self.side)
    }

    /// The bin under a point, if there is one.
    #[must_use]
    pub fn bin_of(&self, x: DVec3) -> Option<(usize, usize)> {
        let (i, j) = (x.x / self.side, x.y / self.side);
        let inside = i >= 0.0 && j >= 0.0 && i < self.columns as f64 && j < self.rows as f64;
        inside.then_some((i as usize, j as usize))
    }

    /// The bin in which a marble at rest lies, given its centre: its lowest point is less than halfway up the
    /// partitions. Bins are numbered as words count them: from the last row along y, and along x within a row.
    #[must_use]
    pub fn holds(&self, centre: DVec3) -> Option<u16> {
        let is_low = centre.z - self.marble < 0.5 * self.height;
        let (column, row) = self.bin_of(centre).filter(|_| is_low)?;
        u16::try_from((self.rows - 1 - row) * self.columns + column).ok()
    }

    /// Indices of the ridge vertices where partitions cross: those that a scene perturbs.
    #[must_use]
    pub fn crossings(&self) -> usize {
        (self.columns + 1) * (self.rows + 1)
    }

    /// Where a ridge vertex stands unperturbed.
    #[must_use]
    pub fn crossing(&self, k: usize) -> DVec3 {
        let (i, j) = (k % (self.columns + 1), k / (self.columns + 1));
        DVec3::new(i as f64 * self.side, j as f64 * self.side, self.height)
    }

    /// Offsets of all ridge vertices, approximately normal (a sum of uniforms) with `sigma` metres per axis; `uniform`
    /// gives numbers in [0, 1).
    pub fn perturbed(&self, sigma: f64, mut uniform: impl FnMut() -> f64) -> Vec<(u32, DVec3)> {
        (0..self.crossings())
            .map(|k| {
                let sum =
                    (0..4).map(|_| DVec3::new(uniform(), uniform(), uniform())).fold(DVec3::splat(-2.0), |a, b| a + b);
                (k as u32, self.crossing(k) + sum * (sigma * 3.0_f64.sqrt()))
            })
            .collect()
    }

    /// The partitions' surface. Vertices `0..crossings()` are the ridge at the crossings; then four shoulder corners
    /// and four foot corners of each crossing.
    ///
    /// # Errors
    /// [`WorldError`] for impossible dimensions.
    pub fn mesh(&self) -> Result<Mesh, WorldError> {
        let (nx, crossings) = (self.columns + 1, self.crossings());
        let half = 0.5 * self.thickness;
        let mut vertices: Vec<DVec3> = (0..crossings).map(|k| self.crossing(k)).collect();
        let shoulder = self.height - self.crown;
        // A foot far enough below the bowls that no marble sees the lower rim of a partition.
        for z in [shoulder, -self.height] {
            for k in 0..crossings {
                let c = self.crossing(k);
                vertices.extend(
                    [(-half, -half), (half, -half), (half, half), (-half, half)]
                        .map(|(x, y)| DVec3::new(c.x + x, c.y + y, z)),
                );
            }
        }
        let top = |k: usize, corner: usize| (crossings + 4 * k + corner) as u32;
        let foot = |k: usize, corner: usize| (5 * crossings + 4 * k + corner) as u32;
        let mut triangles: Vec<[u32; 3]> = Vec::new();
        let mut quad = |a: u32, b: u32, c: u32, d: u32| triangles.extend([[a, b, c], [a, c, d]]);
        let mut caps: Vec<[u32; 3]> = Vec::new();
        for k in 0..crossings {
            let (i, j) = (k % nx, k / nx);
            // Each side of a crossing continues in a partition, or is a piece of wall with a cap triangle.
            let ends = [(j == 0, 0, 1), (i + 1 == nx, 1, 2), (j == self.rows, 2, 3), (i == 0, 3, 0)];
            for (is_end, a, b) in ends {
                if is_end {
                    quad(foot(k, a), foot(k, b), top(k, b), top(k, a));
                    caps.push([top(k, a), top(k, b), k as u32]);
                }
            }
            if i + 1 < nx {
                let east = k + 1;
                quad(foot(k, 1), foot(east, 0), top(east, 0), top(k, 1));
                quad(foot(east, 3), foot(k, 2), top(k, 2), top(east, 3));
                caps.extend([[top(k, 1), top(east, 0), east as u32], [top(k, 1), east as u32, k as u32]]);
                caps.extend([[top(east, 3), top(k, 2), k as u32], [top(east, 3), k as u32, east as u32]]);
            }
            if j < self.rows {
                let north = k + nx;
                quad(foot(north, 0), foot(k, 3), top(k, 3), top(north, 0));
                quad(foot(k, 2), foot(north, 1), top(north, 1), top(k, 2));
                caps.extend([[top(north, 0), top(k, 3), k as u32], [top(north, 0), k as u32, north as u32]]);
                caps.extend([[top(k, 2), top(north, 1), north as u32], [top(k, 2), north as u32, k as u32]]);
            }
        }
        let all: Vec<_> = triangles.into_iter().chain(caps).map(|t| (t, Material(1))).collect();
        let margins = (0..vertices.len()).map(|v| if v < crossings { self.margin } else { 0.0 }).collect();
        Mesh::with_margins(vertices, &all, margins)
    }

    /// The walls of the box.
    ///
    /// # Errors
    /// [`WorldError`] for impossible dimensions.
    pub(super) fn walls(&self) -> Result<Vec<Plane>, WorldError> {
        let (width, breadth) = self.extent();
        let half = 0.5 * self.thickness;
        let wall = |p: DVec3, n: DVec3| Plane::new(p, n, Material(1));
        // The walls stand on the outer partitions' inner sides and count as endless upwards: marbles stay over the
        // bins.
        Ok(vec![
            wall(DVec3::new(half, 0.0, 0.0), DVec3::X)?,
            wall(DVec3::new(width - half, 0.0, 0.0), -DVec3::X)?,
            wall(DVec3::new(0.0, half, 0.0), DVec3::Y)?,
            wall(DVec3::new(0.0, breadth - half, 0.0), -DVec3::Y)?,
        ])
    }

    /// The scenery: partitions, bowls and the walls of the box.
    ///
    /// # Errors
    /// [`WorldError`] for impossible dimensions.
    pub fn scenery(&self) -> Result<Scenery, WorldError> {
        let planes = self.walls()?;
        let mut domes = Vec::new();
        for j in 0..self.rows {
            for i in 0..self.columns {
                let low = DVec3::new(i as f64 * self.side, j as f64 * self.side, -self.height);
                let clip = Aabb { min: low, max: low + DVec3::new(self.side, self.side, 2.0 * self.height) };
                let middle = low + DVec3::new(0.5 * self.side, 0.5 * self.side, 0.0);
                domes.push(Dome::new(DVec3::new(middle.x, middle.y, self.bowl), self.bowl, true, clip, Material(1))?);
            }
        }
        Scenery::new(planes, self.mesh()?, domes, self.marble)
    }

    /// A world of `count` marbles over the bins.
    ///
    /// # Errors
    /// [`WorldError`] for impossible dimensions or laws.
    pub fn world(&self, count: usize, accuracy: Accuracy, duration: f64) -> Result<Marbles, WorldError> {
        let mut laws = Laws::new(2, self.wall_law)?;
        laws.set(Material(0), Material(0), self.marble_law)?;
        let mass = 4.0 / 3.0 * std::f64::consts::PI * self.marble * self.marble * self.marble * self.density;
        let specs = vec![MarbleSpec::solid(self.marble, mass, Material(0)); count];
        Marbles::new(MarbleWorld {
            specs,
            laws,
            scenery: self.scenery()?,
            gravity: DVec3::new(0.0, 0.0, -9.81),
            accuracy,
            duration,
        })
    }
}

/// Random drops: `count` starts at rest, uniform over the bins as far as walls allow, one every `interval` seconds.
/// `uniform` gives numbers in [0, 1).
pub fn drops(bins: &Bins, count: usize, interval: f64, mut uniform: impl FnMut() -> f64) -> Vec<Start> {
    let (width, breadth) = bins.extent();
    let edge = 0.5 * bins.thickness + bins.marble;
    (0..count)
        .map(|k| {
            let x = edge + (width - 2.0 * edge) * uniform();
            let y = edge + (breadth - 2.0 * edge) * uniform();
            Start { time: interval * k as f64, ..Start::at_rest(DVec3::new(x, y, bins.drop)) }
        })
        .collect()
}
