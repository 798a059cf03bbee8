//! A random world as plain numbers, from which the simulator's world, the judge's pieces and a scenario are made.

use super::exact::{Core, Piece};
use super::form::Form;
use glam::{DQuat, DVec3};
use plaus_sim::field::{Grid, Spline};
use plaus_sim::rigid::{BodySpec, RigidWorldDesc, Start, StaticShape, StaticSolid, Table};
use plaus_sim::scenery::{Aabb, Mesh, Plane};
use plaus_sim::{Accuracy, Law, Laws, Material, Preset};
use std::sync::Arc;

/// As scenarios have it, in m/s².
pub const G: f64 = 9.80665;
/// In kg/m³.
pub const DENSITY: f64 = 1000.0;
const M: Material = Material(0);

/// What moves.
#[derive(Debug, Clone)]
pub struct Mover {
    pub form: Form,
    /// Where the form's origin is, and how its axes are turned.
    pub at: DVec3,
    pub turn: DQuat,
    /// Of the centre of gravity, in m/s, and about the world's axes, in rad/s.
    pub velocity: DVec3,
    pub spin: DVec3,
}

/// What stands still, and how it is said.
#[derive(Debug, Clone)]
pub enum Fixed {
    /// The level ground at this height.
    Plane(f64),
    /// A level table at this height whose control points are higher or lower by up to this much, `spacing` apart.
    Table { level: f64, bumps: f64, spacing: f64 },
    /// A box that is not turned: middle and edges.
    Block { at: DVec3, edges: DVec3 },
    /// Any shape.
    Solid { form: Form, at: DVec3, turn: DQuat },
    /// A box as a mesh whose faces are cut into `n × n` squares.
    Mesh { edges: DVec3, at: DVec3, turn: DQuat, n: u32 },
}

/// All of a world.
#[derive(Debug, Clone)]
pub struct World {
    pub movers: Vec<Mover>,
    pub fixed: Vec<Fixed>,
    pub law: Law,
    /// In m/s², downwards.
    pub gravity: f64,
    pub preset: Preset,
    /// How long it is followed, in s.
    pub until: f64,
    /// What must happen, as lines of a scenario.
    pub wanted: Vec<String>,
}

impl Mover {
    /// At rest, not turned, with the lowest point at a height.
    pub fn standing(form: Form, on: DVec3) -> Self {
        let at = on - DVec3::Z * form.foot();
        Self { form, at, turn: DQuat::IDENTITY, velocity: DVec3::ZERO, spin: DVec3::ZERO }
    }

    pub fn start(&self) -> Start {
        let (_, centre, turn) = self.form.shape();
        Start {
            position: self.at + self.turn * centre,
            orientation: (self.turn * turn).normalize(),
            velocity: self.velocity,
            spin: self.spin,
            time: 0.0,
        }
    }

    /// The judge's pieces about the centre of gravity and along the simulator's axes.
    pub fn pieces(&self) -> Vec<Piece> {
        let (_, centre, turn) = self.form.shape();
        let back = turn.inverse();
        self.form.pieces().iter().map(|p| p.moved(back * -centre, back)).collect()
    }
}

/// Corners and triangles of a box whose faces are cut into `n × n` squares, seen from outside.
pub fn box_mesh(edges: DVec3, n: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (mut vertices, mut triangles) = (Vec::<DVec3>::new(), Vec::new());
    let mut vertex = |p: DVec3| {
        let known = vertices.iter().position(|v| (*v - p).length() < 1e-9 * edges.max_element());
        known.unwrap_or_else(|| {
            vertices.push(p);
            vertices.len() - 1
        }) as u32
    };
    let along = |i: u32| f64::from(i) / f64::from(n) - 0.5;
    for axis in 0..3 {
        let [w, u, v] = [0, 1, 2].map(|k| DVec3::AXES[(axis + k) % 3]);
        for side in [-0.5, 0.5] {
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                let mut at = |i: u32, j: u32| vertex((w * side + u * along(i) + v * along(j)) * edges);
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                triangles.extend(if side > 0.0 { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
            }
        }
    }
    (vertices, triangles)
}

/// A control point of a table, between −1 and 1.
pub fn bump(i: i64, j: i64) -> f64 {
    ((i * 7 + j * 13).rem_euclid(11) as f64 / 5.0 - 1.0) * if (i + j).rem_euclid(3) == 0 { 0.4 } else { 1.0 }
}

impl Fixed {
    fn part(&self) -> StaticShape {
        match self {
            Self::Plane(level) => StaticShape::Plane(Plane::new(DVec3::Z * *level, DVec3::Z, M).expect("a plane")),
            &Self::Table { level, bumps, spacing } => {
                let grid = Grid { origin: [0.0; 2], spacing };
                let range = [level - bumps, level + bumps];
                let height = Spline::new("height", grid, range, move |i, j| level + bumps * bump(i, j));
                StaticShape::Table(Box::new(Table::new(height.expect("a table"), M)))
            }
            Self::Block { at, edges } => {
                let bounds = Aabb { min: *at - 0.5 * *edges, max: *at + 0.5 * *edges };
                StaticShape::Block { bounds, material: M, sections: Vec::new() }
            }
            Self::Solid { form, at, turn } => {
                let (shape, centre, own) = form.shape();
                let (at, turn) = (*at + *turn * centre, (*turn * own).normalize());
                StaticShape::Solid(Box::new(StaticSolid { shape, at, turn, material: M }))
            }
            Self::Mesh { edges, at, turn, n } => {
                let (vertices, triangles) = box_mesh(*edges, *n);
                let vertices = vertices.into_iter().map(|v| *at + *turn * v).collect();
                let triangles: Vec<_> = triangles.into_iter().map(|t| (t, M)).collect();
                StaticShape::Mesh(Arc::new(Mesh::new(vertices, &triangles, 0.0).expect("a mesh")))
            }
        }
    }

    /// In a few words, with sizes in mm.
    pub fn told(&self) -> String {
        let turned = |turn: &DQuat| if *turn == DQuat::IDENTITY { "" } else { "turned " };
        match self {
            Self::Plane(_) => "plane".into(),
            Self::Table { bumps, .. } => format!("table with bumps of {:.1}", 1e3 * bumps),
            Self::Block { edges, .. } => format!("block {}", Form::Cuboid { edges: *edges, rounding: 0.0 }.told()),
            Self::Solid { form, turn, .. } => format!("{}solid {}", turned(turn), form.told()),
            Self::Mesh { edges, turn, n, .. } => {
                let form = Form::Cuboid { edges: *edges, rounding: 0.0 };
                format!("{}mesh {n} x {n} of {}", turned(turn), form.told())
            }
        }
    }

    /// The judge's pieces in the world. A table with bumps is judged by its lowest height.
    pub fn pieces(&self) -> Vec<Piece> {
        let half = |level: f64| vec![Piece::new(Core::Half, 0.0).moved(DVec3::Z * level, DQuat::IDENTITY)];
        let cuboid =
            |edges: DVec3, at: DVec3, turn: DQuat| vec![Piece::new(Core::Cuboid(0.5 * edges), 0.0).moved(at, turn)];
        match self {
            Self::Plane(level) => half(*level),
            Self::Table { level, bumps, .. } => half(level - bumps),
            Self::Block { at, edges } => cuboid(*edges, *at, DQuat::IDENTITY),
            Self::Solid { form, at, turn } => form.pieces().iter().map(|p| p.moved(*at, *turn)).collect(),
            Self::Mesh { edges, at, turn, .. } => cuboid(*edges, *at, *turn),
        }
    }
}

impl World {
    pub fn rigid(&self) -> RigidWorldDesc {
        RigidWorldDesc {
            bodies: self.movers.iter().map(|m| BodySpec::solid(m.form.shape().0, DENSITY, M)).collect(),
            parts: self.fixed.iter().map(Fixed::part).collect(),
            laws: Laws::uniform(self.law).expect("a law"),
            gravity: DVec3::Z * -self.gravity,
            accuracy: Accuracy::preset(self.preset),
            skin: 0.5,
            sink: f64::NEG_INFINITY,
            duration: self.until,
        }
    }

    pub fn starts(&self) -> Vec<Start> {
        self.movers.iter().map(Mover::start).collect()
    }

    /// Unit of length of each body's tolerances, in m.
    pub fn sizes(&self) -> Vec<f64> {
        self.movers.iter().map(|m| m.form.shape().0.size()).collect()
    }
}

/// Ways to say a fixed box that has this middle, edges and turn. What is not turned may be a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Saying {
    Block,
    /// Turned by a quarter about z, with its edges changed about.
    Quarter,
    Hull,
    Mesh,
    /// One solid of two halves.
    Halves,
    /// Two parts that touch: blocks.
    Blocks,
    /// Two parts that touch: turned by a quarter.
    Quarters,
    /// Two parts that touch: meshes.
    Meshes,
}

impl Saying {
    pub const ALL: [Self; 8] =
        [Self::Block, Self::Quarter, Self::Hull, Self::Mesh, Self::Halves, Self::Blocks, Self::Quarters, Self::Meshes];

    /// The parts that make up a box. A block is a solid if it is turned. Two halves meet at `seam` along x, as a
    /// fraction of the box from its lower end.
    pub fn parts(self, at: DVec3, edges: DVec3, turn: DQuat, seam: f64) -> Vec<Fixed> {
        let is_level = turn == DQuat::IDENTITY;
        let quarter = DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2);
        let swapped = |e: DVec3| DVec3::new(e.y, e.x, e.z);
        let solid = |form: Form, at: DVec3, turn: DQuat| Fixed::Solid { form, at, turn };
        let cuboid = |edges: DVec3| Form::Cuboid { edges, rounding: 0.0 };
        let halves = [0.5 * seam - 0.5, 0.5 * seam].map(|x| DVec3::X * (edges.x * x));
        let of = [seam, 1.0 - seam].map(|part| edges.with_x(edges.x * part));
        let two = |say: &dyn Fn(DVec3, DVec3) -> Fixed| (0..2).map(|k| say(at + turn * halves[k], of[k])).collect();
        match self {
            Self::Block if is_level => vec![Fixed::Block { at, edges }],
            Self::Blocks if is_level => two(&|at, edges| Fixed::Block { at, edges }),
            Self::Block => vec![solid(cuboid(edges), at, turn)],
            Self::Blocks => two(&|at, edges| solid(cuboid(edges), at, turn)),
            Self::Quarter => vec![solid(cuboid(swapped(edges)), at, turn * quarter)],
            Self::Quarters => two(&|at, edges| solid(cuboid(swapped(edges)), at, turn * quarter)),
            Self::Hull => vec![solid(Form::Hull(Form::corners(edges)), at, turn)],
            Self::Mesh => vec![Fixed::Mesh { edges, at, turn, n: 2 }],
            Self::Meshes => two(&|at, edges| Fixed::Mesh { edges, at, turn, n: 1 }),
            Self::Halves => {
                let pieces = (0..2).map(|k| (cuboid(of[k]), halves[k])).collect();
                vec![solid(Form::Compound(pieces), at, turn)]
            }
        }
    }
}
