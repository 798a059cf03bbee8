//! Every shape thrown into every scenery: closed boxes of planes, of blocks, of solids at an angle and of triangles, a
//! hollow ball of triangles, and a table with bumps between planes.
#![allow(dead_code, unreachable_pub)]

use glam::{DMat3, DQuat, DVec3};
use plaus_dist::math;
use plaus_sim::field::{Grid, Spline};
use plaus_sim::rigid::{
    BodySpec, RigidBodyState, RigidScratch, RigidWorld, RigidWorldDesc, Start, StaticShape, StaticSolid, Table,
};
use plaus_sim::scenery::{Aabb, Mesh, Plane};
use plaus_sim::shape::{Compound, Convex, ConvexHull, Cuboid, Frustum, Member, Profile, Revolution, Shape, Solid};
use plaus_sim::trace::Observer;
use plaus_sim::{Accuracy, Law, Laws, Material, Outcome, Preset, Scratch, WorldError};
use std::sync::Arc;

#[path = "dice.rs"]
mod dice;
pub use dice::Dice;

pub const M: Material = Material(0);
pub const G: f64 = 9.81;

/// Half the edge of the boxes, and the radius of the hollow ball.
pub const HALF: f64 = 0.3;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Body {
    Ball,
    Weighted,
    Cuboid,
    Rounded,
    Cylinder,
    Coin,
    Cone,
    Capsule,
    Frustum,
    Pin,
    Hull,
    Hammer,
    Cross,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    Planes,
    Blocks,
    Solids,
    Mesh,
    HollowBall,
    Table,
}

impl Body {
    pub const ALL: [Self; 13] = [
        Self::Ball,
        Self::Weighted,
        Self::Cuboid,
        Self::Rounded,
        Self::Cylinder,
        Self::Coin,
        Self::Cone,
        Self::Capsule,
        Self::Frustum,
        Self::Pin,
        Self::Hull,
        Self::Hammer,
        Self::Cross,
    ];

    /// A body of this kind, a few centimetres large.
    pub fn shape(self) -> Shape {
        let frustum = |f: Result<Frustum, WorldError>| Shape::from(f.expect("a frustum"));
        let cuboid = |x: f64, y: f64, z: f64, r: f64| Cuboid::new(DVec3::new(x, y, z), r).expect("a cuboid");
        let compound = |members: &[Member]| Shape::from(Compound::new(members).expect("a compound"));
        match self {
            Self::Ball => Shape::Ball(0.02),
            Self::Weighted => Compound::weighted_ball(0.02, 0.006).expect("a ball").into(),
            Self::Cuboid => Shape::Cuboid(cuboid(0.03, 0.04, 0.05, 0.0)),
            Self::Rounded => Shape::Cuboid(cuboid(0.03, 0.04, 0.05, 0.004)),
            Self::Cylinder => frustum(Frustum::cylinder(0.02, 0.05)),
            Self::Coin => frustum(Frustum::cylinder(0.02, 0.004)),
            Self::Cone => frustum(Frustum::cone(0.02, 0.05)),
            Self::Capsule => frustum(Frustum::capsule(0.012, 0.04)),
            Self::Frustum => frustum(Frustum::new([0.02, 0.01], 0.03, 0.003)),
            Self::Pin => {
                let mut profile = Profile::pin();
                let scale = 0.15;
                (profile.foot, profile.rim, profile.top) =
                    (profile.foot * scale, profile.rim * scale, profile.top * scale);
                profile.points.iter_mut().for_each(|p| *p = p.map(|x| x * scale));
                Shape::Revolution(Arc::new(Revolution::new(&profile, 40).expect("a pin")))
            }
            Self::Hull => {
                Shape::Hull(Arc::new(ConvexHull::new(&Solid::Dodecahedron.corners(0.02), 0.0).expect("a hull")))
            }
            Self::Hammer => compound(&[
                Member::new(Convex::Frustum(Frustum::cylinder(0.012, 0.03).expect("a head")), DVec3::ZERO),
                Member::new(Convex::Cuboid(cuboid(0.07, 0.01, 0.008, 0.0)), DVec3::X * 0.04),
            ]),
            Self::Cross => compound(&[
                Member::new(Convex::Cuboid(cuboid(0.06, 0.012, 0.012, 0.001)), DVec3::ZERO),
                Member::new(Convex::Cuboid(cuboid(0.012, 0.06, 0.012, 0.001)), DVec3::ZERO),
                Member::new(Convex::Ball(0.01), DVec3::Z * 0.012),
            ]),
        }
    }

    pub fn spec(self) -> BodySpec {
        BodySpec::solid(self.shape(), 1200.0, M)
    }
}

/// A box seen from inside as a mesh, each side with `n × n` squares.
fn hollow_box(turn: DQuat, n: u32) -> Mesh {
    let (mut vertices, mut triangles) = (Vec::<DVec3>::new(), Vec::new());
    let mut vertex = |p: DVec3| {
        let at = vertices.iter().position(|v| (*v - p).length() < 1e-9);
        at.unwrap_or_else(|| {
            vertices.push(p);
            vertices.len() - 1
        }) as u32
    };
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let (u, v) = (DVec3::AXES[(axis + 1) % 3], DVec3::AXES[(axis + 2) % 3]);
            let base = DVec3::AXES[axis] * sign;
            let along = |i: u32| 2.0 * f64::from(i) / f64::from(n) - 1.0;
            for i in 0..n {
                for j in 0..n {
                    let mut at = |i: u32, j: u32| vertex(turn * ((base + u * along(i) + v * along(j)) * HALF));
                    let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                    // u × v points along the axis; at the upper end, the inside is in the opposite direction.
                    let quads = if sign > 0.0 { [[a, c, b], [a, d, c]] } else { [[a, b, c], [a, c, d]] };
                    triangles.extend(quads.map(|t| (t, M)));
                }
            }
        }
    }
    Mesh::new(vertices, &triangles, 0.0).expect("a mesh")
}

/// A ball of triangles seen from inside.
fn hollow_ball(n: u32) -> Mesh {
    let (mut vertices, mut triangles) = (vec![DVec3::Z * HALF, DVec3::NEG_Z * HALF], Vec::new());
    let turn = std::f64::consts::PI / f64::from(n);
    for i in 1..n {
        for j in 0..2 * n {
            let ((si, ci), (sj, cj)) = (math::sin_cos(f64::from(i) * turn), math::sin_cos(f64::from(j) * turn));
            vertices.push(DVec3::new(si * cj, si * sj, ci) * HALF);
        }
    }
    let at = |i: u32, j: u32| match i {
        0 => 0,
        _ if i == n => 1,
        _ => 2 + (i - 1) * 2 * n + j % (2 * n),
    };
    for i in 0..n {
        for j in 0..2 * n {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            if i + 1 < n {
                triangles.push(([a, c, b], M));
            }
            if i > 0 {
                triangles.push(([a, d, c], M));
            }
        }
    }
    Mesh::new(vertices, &triangles, 0.0).expect("a mesh")
}

impl Place {
    pub const ALL: [Self; 6] = [Self::Planes, Self::Blocks, Self::Solids, Self::Mesh, Self::HollowBall, Self::Table];

    /// The parts, and the box's orientation.
    pub fn parts(self, dice: &mut Dice) -> (Vec<StaticShape>, DQuat) {
        let turn = match self {
            Self::Planes | Self::Solids | Self::Mesh => dice.turn(),
            _ => DQuat::IDENTITY,
        };
        let sides = || (0..3).flat_map(|k| [DVec3::AXES[k], -DVec3::AXES[k]]);
        let plane = |n: DVec3| StaticShape::Plane(Plane::new(turn * n * -HALF, turn * n, M).expect("a plane"));
        let slab = |n: DVec3| (n * (-1.5 * HALF), DVec3::splat(3.0 * HALF) - n.abs() * (2.0 * HALF));
        let parts = match self {
            Self::Planes => sides().map(plane).collect(),
            Self::Blocks => sides()
                .map(|n| {
                    let (at, edges) = slab(n);
                    let bounds = Aabb { min: at - edges * 0.5, max: at + edges * 0.5 };
                    StaticShape::Block { bounds, material: M, sections: Vec::new() }
                })
                .collect(),
            Self::Solids => sides()
                .map(|n| {
                    let (at, edges) = slab(n);
                    let shape = Shape::Cuboid(Cuboid::new(edges, 0.0).expect("a slab"));
                    StaticShape::Solid(Box::new(StaticSolid { shape, at: turn * at, turn, material: M }))
                })
                .collect(),
            Self::Mesh => vec![StaticShape::Mesh(Arc::new(hollow_box(turn, 4)))],
            Self::HollowBall => vec![StaticShape::Mesh(Arc::new(hollow_ball(12)))],
            Self::Table => {
                let grid = Grid { origin: [0.0; 2], spacing: 0.02 };
                let bump = |i: i64, j: i64| -0.5 * HALF + 0.003 * (((i * 7 + j * 13) % 11) as f64 / 5.0 - 1.0);
                let height = Spline::new("height", grid, [-HALF, 0.0], bump).expect("a table");
                let walls = sides().filter(|n| n.z <= 0.0).map(plane);
                walls.chain([StaticShape::Table(Box::new(Table::new(height, M)))]).collect()
            }
        };
        (parts, turn)
    }

    /// How far a point is outside, negative inside.
    pub fn outside(self, turn: DQuat, x: DVec3) -> f64 {
        match self {
            Self::HollowBall => x.length() - HALF,
            Self::Table => (x.abs().max_element() - HALF).max(-0.5 * HALF - 0.006 - x.z),
            _ => (turn.inverse() * x).abs().max_element() - HALF,
        }
    }
}

/// The result of a throw.
#[derive(Debug, Clone, Copy)]
pub struct Fate {
    pub outcome: Outcome,
    /// How far a centre of gravity was outside at most, over the body's size.
    pub out: f64,
    /// How deep bodies were in parts at the ends of their motions at most, over the size.
    pub deep: f64,
    /// The same at the end.
    pub left: f64,
    /// Energy gained over the initial energy (kinetic energy, and the weight times the box).
    pub gain: f64,
    pub events: u64,
}

struct Watch<'w> {
    world: &'w RigidWorld,
    place: Place,
    turn: DQuat,
    sizes: Vec<f64>,
    out: f64,
    deep: f64,
}

impl Observer<RigidWorld> for Watch<'_> {
    fn motion(&mut self, index: usize, body: &RigidBodyState) {
        self.out = self.out.max(self.place.outside(self.turn, body.path.x) / self.sizes[index]);
        self.deep = self.deep.max(self.world.depth(index, body) / self.sizes[index]);
    }
}

/// Throws some bodies into a place for some time; from rest to fast.
pub fn throw(bodies: &[Body], place: Place, throw: u64, preset: Preset, until: f64) -> Fate {
    let mut dice = Dice::new(31, throw);
    let (parts, turn) = place.parts(&mut dice);
    let law = Law::new(dice.between(0.0, 0.8), dice.between(0.0, 0.9)).with_resistance(0.01, 0.01);
    let world = RigidWorldDesc {
        bodies: bodies.iter().map(|b| b.spec()).collect(),
        parts,
        laws: Laws::uniform(law).expect("a law"),
        gravity: DVec3::new(0.0, 0.0, -G),
        accuracy: Accuracy::preset(preset),
        skin: 0.5,
        sink: -10.0 * HALF,
        duration: 1000.0,
    };
    let sizes: Vec<f64> = world.bodies.iter().map(|b| b.shape.size()).collect();
    let world = RigidWorld::new(world).expect("a world");
    // Apart from each other, on a lattice around the middle of the place.
    let start = |k: usize| {
        let lattice = DVec3::new((k % 2) as f64 - 0.5, (k / 2 % 2) as f64 - 0.5, (k / 4) as f64 * 0.9) * 0.12;
        let speed = [0.0, 0.3, 2.0, 20.0][(throw % 4) as usize];
        let position = DMat3::from_quat(turn) * DVec3::ZERO + lattice + dice.in_cube() * 0.005;
        let (velocity, spin) = (dice.in_cube() * speed, dice.in_cube() * (speed / 0.02));
        Start { position, orientation: dice.turn(), velocity, spin, time: 0.0 }
    };
    let starts: Vec<Start> = (0..bodies.len()).map(start).collect();
    let mut state = world.state(&starts).expect("a state");
    let energy = |state: &plaus_sim::State<RigidBodyState>| -> f64 {
        state.bodies().iter().enumerate().map(|(k, b)| world.energy(k, &world.at(k, b, b.path.t))).sum()
    };
    let before = energy(&state);
    let scale: f64 = bodies.iter().map(|b| b.spec().mass.mass * G * HALF).sum::<f64>() + before.abs();
    let mut watch = Watch { world: &world, place, turn, sizes, out: f64::NEG_INFINITY, deep: 0.0 };
    let outcome = world.run(&mut state, &mut Scratch::<RigidScratch>::default(), until, &mut watch).expect("a run");
    let (out, deep) = (watch.out, watch.deep);
    let depth = |(k, b): (usize, &RigidBodyState)| world.depth(k, b) / watch.sizes[k];
    let left = state.bodies().iter().enumerate().map(depth).fold(0.0, f64::max);
    Fate { outcome, out, deep, left, gain: (energy(&state) - before) / scale, events: state.counts().events }
}
