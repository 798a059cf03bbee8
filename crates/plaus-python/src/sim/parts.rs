//! Worlds as Python describes them.

use super::wrong;
use crate::errors::WorldError;
use glam::DVec3;
use plaus_scenes::Physical;
use plaus_sim::field::{Grid, Spline};
use plaus_sim::marbles::{MarbleSpec, MarbleWorld, Marbles};
use plaus_sim::rigid::{BodySpec, RigidWorld, RigidWorldDesc, StaticShape, Table};
use plaus_sim::scenery::{Aabb, Dome, Mesh, Plane, Scenery};
use plaus_sim::shape::{ConvexHull, Cuboid, MassProperties, Profile, Revolution, Shape};
use plaus_sim::{Accuracy, Laws, Material};
use pyo3::prelude::*;
use std::f64::consts::PI;
use std::sync::Arc;

/// A body.
#[derive(FromPyObject)]
pub(super) struct Body {
    #[pyo3(item)]
    kind: String,
    /// Radius, or edges.
    #[pyo3(item)]
    size: Vec<f64>,
    /// Points of a hull.
    #[pyo3(item)]
    points: Vec<[f64; 3]>,
    #[pyo3(item)]
    rounding: f64,
    #[pyo3(item)]
    density: Option<f64>,
    #[pyo3(item)]
    mass: Option<f64>,
    #[pyo3(item)]
    material: u16,
}

/// Number of balls that make up the skin of a pin, as in the simulator's own alley.
const STATIONS: usize = 40;

/// A piece of scenery.
#[derive(FromPyObject)]
pub(super) struct Surface {
    #[pyo3(item)]
    kind: String,
    #[pyo3(item)]
    vectors: Vec<[f64; 3]>,
    #[pyo3(item)]
    triangles: Vec<[u32; 3]>,
    #[pyo3(item)]
    radius: f64,
    #[pyo3(item)]
    hollow: bool,
    /// Control heights of a table, row by row; their spacing is in `radius`.
    #[pyo3(item)]
    heights: Vec<Vec<f64>>,
    #[pyo3(item)]
    material: u16,
}

/// What happens where two materials touch.
#[derive(FromPyObject)]
pub(super) struct Law {
    #[pyo3(item)]
    a: u16,
    #[pyo3(item)]
    b: u16,
    #[pyo3(item)]
    friction: f64,
    #[pyo3(item)]
    static_friction: f64,
    #[pyo3(item)]
    restitution: f64,
    #[pyo3(item)]
    tangential: f64,
    #[pyo3(item)]
    rolling: f64,
    #[pyo3(item)]
    spinning: f64,
}

/// A whole world.
pub(super) struct Whole {
    pub(super) bodies: Vec<Body>,
    pub(super) surfaces: Vec<Surface>,
    pub(super) laws: Vec<Law>,
    pub(super) materials: u16,
    pub(super) gravity: [f64; 3],
    pub(super) duration: f64,
    pub(super) accuracy: Accuracy,
}

fn refuse<T>(message: impl Into<String>) -> PyResult<T> {
    Err(WorldError::new_err(message.into()))
}

/// The value at `index`, if Python gave one.
fn at<T: Copy>(all: &[T], index: usize, what: &str) -> PyResult<T> {
    all.get(index).copied().map_or_else(|| refuse(format!("{what} is missing")), Ok)
}

impl Whole {
    fn laws(&self) -> PyResult<Laws> {
        let mut laws = Laws::new(self.materials, plaus_sim::Law::new(0.0, 0.0)).map_err(wrong)?;
        for law in &self.laws {
            let values = plaus_sim::Law::new(law.friction, law.restitution)
                .with_static_friction(law.static_friction)
                .with_resistance(law.rolling, law.spinning)
                .with_tangential(law.tangential);
            laws.set(Material(law.a), Material(law.b), values).map_err(wrong)?;
        }
        Ok(laws)
    }

    /// A world of balls among planes, triangles and caps of spheres.
    pub(super) fn marbles(self) -> PyResult<Physical> {
        let laws = self.laws()?;
        let specs = self.bodies.iter().map(Body::marble).collect::<PyResult<Vec<_>>>()?;
        let reach = specs.iter().map(|spec| spec.radius).fold(0.0, f64::max);
        let (mut planes, mut domes, mut vertices, mut triangles) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for surface in &self.surfaces {
            let material = Material(surface.material);
            match surface.kind.as_str() {
                "plane" => planes.push(surface.plane()?),
                "cap" => {
                    let clip = Aabb { min: surface.vector(1)?, max: surface.vector(2)? };
                    let cap = Dome::new(surface.vector(0)?, surface.radius, surface.hollow, clip, material);
                    domes.push(cap.map_err(wrong)?);
                }
                "mesh" => {
                    let first = vertices.len() as u32;
                    vertices.extend(surface.vectors.iter().map(|&vector| DVec3::from_array(vector)));
                    triangles.extend(surface.triangles.iter().map(|corners| (corners.map(|c| c + first), material)));
                }
                other => {
                    return refuse(format!("worlds of marbles cannot have a {other}, only planes, meshes and caps"));
                }
            }
        }
        let mesh = Mesh::new(vertices, &triangles, 0.0).map_err(wrong)?;
        let scenery = Scenery::new(planes, mesh, domes, reach).map_err(wrong)?;
        let gravity = DVec3::from_array(self.gravity);
        let (accuracy, duration) = (self.accuracy, self.duration);
        let world = Marbles::new(MarbleWorld { specs, laws, scenery, gravity, accuracy, duration });
        world.map(|world| Physical::Marbles(Box::new(world))).map_err(wrong)
    }

    /// A world of bodies that turn, among planes, blocks and tables.
    pub(super) fn rigid(self) -> PyResult<Physical> {
        let laws = self.laws()?;
        let bodies = self.bodies.iter().map(Body::spec).collect::<PyResult<Vec<_>>>()?;
        let parts = self.surfaces.iter().map(Surface::part).collect::<PyResult<Vec<_>>>()?;
        let world = RigidWorld::new(RigidWorldDesc {
            bodies,
            parts,
            laws,
            gravity: DVec3::from_array(self.gravity),
            accuracy: self.accuracy,
            skin: 0.5,
            sink: f64::NEG_INFINITY,
            duration: self.duration,
        });
        world.map(|world| Physical::Rigid(Box::new(world))).map_err(wrong)
    }
}

impl Body {
    fn density(&self) -> f64 {
        // With a given mass, the density does not matter: only ratios of moments remain.
        self.density.unwrap_or(1000.0)
    }

    fn marble(&self) -> PyResult<MarbleSpec> {
        if self.kind != "ball" {
            return refuse(format!("worlds of marbles cannot have a {}, only balls", self.kind));
        }
        let radius = at(&self.size, 0, "the radius of a ball")?;
        let mass = self.mass.unwrap_or(4.0 / 3.0 * PI * radius * radius * radius * self.density());
        Ok(MarbleSpec::solid(radius, mass, Material(self.material)))
    }

    fn shape(&self) -> PyResult<Shape> {
        let size = |index| at(&self.size, index, "a size");
        let edges = || Ok::<_, PyErr>(DVec3::new(size(0)?, size(1)?, size(2)?));
        Ok(match self.kind.as_str() {
            "ball" => Shape::Ball(size(0)?),
            "cuboid" => Shape::Cuboid(Cuboid::new(edges()?, self.rounding).map_err(wrong)?),
            "hull" => {
                let points: Vec<DVec3> = self.points.iter().map(|&point| DVec3::from_array(point)).collect();
                Shape::Hull(Arc::new(ConvexHull::new(&points, self.rounding).map_err(wrong)?))
            }
            "pin" => Shape::Revolution(Arc::new(Revolution::new(&Profile::pin(), STATIONS).map_err(wrong)?)),
            other => return refuse(format!("there is no body `{other}`")),
        })
    }

    fn spec(&self) -> PyResult<BodySpec> {
        let spec = BodySpec::solid(self.shape()?, self.density(), Material(self.material));
        let mass: MassProperties = self.mass.map_or(spec.mass, |mass| spec.mass.with_mass(mass));
        Ok(BodySpec { mass, ..spec })
    }
}

impl Surface {
    fn vector(&self, index: usize) -> PyResult<DVec3> {
        at(&self.vectors, index, "a vector of a surface").map(DVec3::from_array)
    }

    fn plane(&self) -> PyResult<Plane> {
        Plane::new(self.vector(0)?, self.vector(1)?, Material(self.material)).map_err(wrong)
    }

    fn part(&self) -> PyResult<StaticShape> {
        let material = Material(self.material);
        Ok(match self.kind.as_str() {
            "plane" => StaticShape::Plane(self.plane()?),
            "block" => {
                let bounds = Aabb { min: self.vector(0)?, max: self.vector(1)? };
                StaticShape::Block { bounds, material, sections: Vec::new() }
            }
            "table" => StaticShape::Table(Box::new(Table::new(self.table()?, material))),
            other => {
                return refuse(format!(
                    "only worlds of marbles can have a {other}; others can have planes, blocks and tables"
                ));
            }
        })
    }

    /// A spline through control heights; beyond them, it is level with the nearest one.
    fn table(&self) -> PyResult<Spline> {
        let heights = self.heights.clone();
        let (rows, columns) = (heights.len(), heights.first().map_or(0, Vec::len));
        if columns == 0 || heights.iter().any(|row| row.len() != columns) {
            return refuse("heights: a table needs rows of equally many control heights, at least one");
        }
        let all = heights.iter().flatten();
        if let Some(height) = all.clone().find(|height| !height.is_finite()) {
            return refuse(format!("heights: {height} is not a finite number"));
        }
        let low = all.clone().copied().fold(f64::INFINITY, f64::min);
        let high = all.copied().fold(f64::NEG_INFINITY, f64::max);
        let near = |index: i64, count: usize| usize::try_from(index).map_or(0, |index| index.min(count - 1));
        let origin = self.vector(0)?;
        let grid = Grid { origin: [origin.x, origin.y], spacing: self.radius };
        let height = move |i, j| heights[near(i, rows)][near(j, columns)];
        Spline::new("height", grid, [low, high], height).map_err(wrong)
    }
}
