//! The same toss by the simulator and in small steps.

use super::body::{Knob, Run, Solid, State};
use crate::laws::worlds::{Dice, G, M, on_floor};
use glam::{DMat3, DQuat, DVec3};
use plaus_sim::rigid::{BodySpec, RigidWorld, Start};
use plaus_sim::shape::{ConvexHull, Cuboid, Profile, Revolution, Shape, Solid as Regular};
use plaus_sim::{Law, Preset, Scratch};
use std::sync::Arc;

/// A body, how it touches the floor, and when it is observed.
#[derive(Debug, Clone)]
pub struct Toss {
    pub name: &'static str,
    pub body: BodySpec,
    pub law: Law,
    pub starts: Vec<Start>,
    /// In s, ascending.
    pub looks: Vec<f64>,
}

/// A body's position and orientation.
#[derive(Debug, Clone, Copy)]
pub struct Look {
    pub x: DVec3,
    pub turn: DQuat,
}

impl Look {
    /// Distance between two looks over a length: of the centres, and of points that turn with them at that distance.
    pub fn off(&self, other: &Self, length: f64) -> f64 {
        // The product is turned by the difference of the two. Twice its vector part is the angle, if that is small.
        let turned = self.turn * other.turn.conjugate();
        let angle = 2.0 * DVec3::new(turned.x, turned.y, turned.z).length();
        (self.x - other.x).length() / length + 0.5 * angle
    }
}

impl Look {
    /// What half the step would have given without its error of first order; `whole` is the result of the whole step.
    fn extrapolated(&self, whole: &Self) -> Self {
        Self { x: self.x * 2.0 - whole.x, turn: self.turn * (whole.turn.conjugate() * self.turn) }
    }
}

impl Toss {
    pub fn length(&self) -> f64 {
        2.0 * self.body.shape.size()
    }

    fn knobs(&self) -> Vec<Knob> {
        let rings = match &self.body.shape {
            Shape::Revolution(r) => r.rings().iter().map(|r| Knob::Ring(r.height, r.circle, r.radius)).collect(),
            _ => Vec::new(),
        };
        let balls = self.body.shape.contact_spheres().into_iter().map(|f| Knob::Ball(f.centre, f.radius));
        balls.chain(rings).collect()
    }

    /// In small steps; also the number of impacts.
    pub fn truth(&self, start: &Start, dt: f64) -> (Vec<Look>, u64) {
        let mass = self.body.mass;
        let solid = Solid {
            mass: mass.mass,
            inertia: mass.inertia,
            knobs: self.knobs(),
            friction: self.law.friction,
            restitution: self.law.restitution,
            gravity: DVec3::new(0.0, 0.0, -G),
        };
        let turn = start.orientation;
        let spin = turn * (mass.inertia * (turn.conjugate() * start.spin));
        let mut run = Run::new(&solid, State { time: 0.0, x: start.position, turn, v: start.velocity, spin });
        let look = |t: &f64| {
            run.go(*t, dt);
            Look { x: run.state.x, turn: run.state.turn }
        };
        let looks = self.looks.iter().map(look).collect();
        (looks, run.impacts)
    }

    /// In small steps, with the error of first order removed (Richardson). Also the distance from the same result for
    /// twice the step, which is its uncertainty, and the number of impacts.
    pub fn truth_and_doubt(&self, start: &Start, dt: f64) -> (Vec<Look>, Vec<Look>, u64) {
        let [(a, _), (b, _), (c, impacts)] = [1.0, 0.5, 0.25].map(|part| self.truth(start, part * dt));
        let best = |p: &[Look], q: &[Look]| p.iter().zip(q).map(|(p, q)| q.extrapolated(p)).collect();
        (best(&b, &c), best(&a, &b), impacts)
    }

    /// By the simulator.
    pub fn ours(&self, start: &Start, preset: Preset) -> Vec<Look> {
        let world = RigidWorld::new(on_floor(vec![self.body.clone()], self.law, preset)).expect("a sound world");
        let (mut state, mut scratch) = (world.state(&[*start]).expect("a sound start"), Scratch::default());
        let look = |t: &f64| {
            world.run(&mut state, &mut scratch, *t, &mut ()).expect("no tables, no faults");
            let body = world.at(0, &state.bodies()[0], *t);
            Look { x: body.path.x, turn: body.turn }
        };
        self.looks.iter().map(look).collect()
    }
}

pub fn cuboid(edges: DVec3) -> BodySpec {
    BodySpec::solid(Shape::Cuboid(Cuboid::new(edges, 0.0).expect("a cuboid")), 400.0, M)
}

fn thrown(k: u64) -> Start {
    let mut dice = Dice::new(17, k);
    let velocity = DVec3::new(dice.between(0.5, 1.5), dice.between(-0.3, 0.3), dice.between(-0.5, 0.5));
    let position = DVec3::Z * dice.between(0.1, 0.15);
    Start { orientation: dice.turn(), velocity, spin: dice.in_cube() * 8.0, ..Start::at_rest(position) }
}

/// Tosses of cubes and a cuboid until they rest.
pub fn wild(count: u64) -> Vec<Toss> {
    let toss = |name, edges, law| Toss {
        name,
        body: cuboid(edges),
        law,
        starts: (0..count).map(thrown).collect(),
        looks: vec![0.15, 0.2, 0.3, 0.4, 0.6, 1.0],
    };
    vec![
        toss("cube, e 0.125, µ 0.18", DVec3::splat(0.1), Law::new(0.18, 0.125)),
        toss("cube, e 0.5, µ 0.35", DVec3::splat(0.1), Law::new(0.35, 0.5)),
        toss("cuboid, e 0.3, µ 0.3", DVec3::new(0.06, 0.08, 0.1), Law::new(0.3, 0.3)),
    ]
}

/// Throws of a die with rounded edges, in the way that hands throw dice.
pub fn dice(count: u64) -> Toss {
    let start = |k: u64| {
        let mut dice = Dice::new(23, k);
        let velocity = DVec3::new(dice.between(0.6, 1.2), dice.between(-0.2, 0.2), dice.between(-0.3, 0.3));
        let position = DVec3::Z * dice.between(0.03, 0.05);
        Start { orientation: dice.turn(), velocity, spin: dice.in_cube() * 25.0, ..Start::at_rest(position) }
    };
    let shape = Shape::Cuboid(Cuboid::new(DVec3::splat(0.016), 0.001).expect("a die"));
    let body = BodySpec::solid(shape, 1200.0, M);
    let starts = (0..count).map(start).collect();
    Toss { name: "die, e 0.5, µ 0.35", body, law: Law::new(0.35, 0.5), starts, looks: vec![0.12, 0.16, 0.2, 1.0] }
}

/// A pin that stands on the rim of its foot and leans too far: it falls over and rolls on the rim as it does so.
pub fn pin() -> Toss {
    let shape = Revolution::new(&Profile::pin(), 40).expect("a pin");
    let body = BodySpec::solid(Shape::Revolution(Arc::new(shape)), 700.0, M);
    let mut toss = Toss { name: "pin falls over", body, law: Law::new(0.25, 0.0), starts: vec![], looks: vec![] };
    let orientation = DQuat::from_rotation_y(0.35) * DQuat::from_rotation_z(0.3);
    let low = toss.knobs().iter().map(|k| k.arm(&DMat3::from_quat(orientation)).z).fold(f64::INFINITY, f64::min);
    let spin = DVec3::Z * 3.0;
    toss.starts = vec![Start { orientation, spin, ..Start::at_rest(DVec3::Z * -low) }];
    toss.looks = vec![0.05, 0.1, 0.15, 0.2];
    toss
}

/// A tetrahedron on a face, at height 0: three points, whose loads are determined.
fn on_a_face() -> (BodySpec, Start) {
    let hull = ConvexHull::new(&Regular::Tetrahedron.corners(0.1), 0.0).expect("a tetrahedron");
    let orientation = DQuat::from_rotation_arc(hull.normal(0).expect("it has faces"), DVec3::NEG_Z);
    let low = hull.corners().iter().map(|c| (orientation * *c).z).fold(f64::INFINITY, f64::min);
    let start = Start { orientation, ..Start::at_rest(DVec3::Z * -low) };
    (BodySpec::solid(Shape::Hull(Arc::new(hull)), 400.0, M), start)
}

/// Contact that lasts throughout and has a unique solution: nothing is struck, nothing is chaotic.
pub fn smooth() -> Vec<Toss> {
    let (d4, lies) = on_a_face();
    let slides = Start { velocity: DVec3::new(0.8, 0.1, 0.0), spin: DVec3::Z * 12.0, ..lies };
    // A box that stands on an edge and tips over: on rough ground, and on ground on which the edge slides.
    let (half, tilt) = (DVec3::new(0.02, 0.03, 0.05), 0.45_f64);
    let orientation = DQuat::from_rotation_y(tilt);
    let low = orientation * DVec3::new(half.x, 0.0, -half.z);
    let tips = Start { orientation, ..Start::at_rest(DVec3::Z * -low.z) };
    let toss = |name, body: &BodySpec, law, start: Start, looks: &[f64]| Toss {
        name,
        body: body.clone(),
        law,
        starts: vec![start],
        looks: looks.to_vec(),
    };
    let block = cuboid(2.0 * half);
    vec![
        toss("d4 slides and spins to rest", &d4, Law::new(0.25, 0.0), slides, &[0.1, 0.2, 0.3, 0.5]),
        toss("box tips over its edge", &block, Law::new(1.0, 0.0), tips, &[0.05, 0.1, 0.15, 0.2]),
        toss("box tips, its edge slides", &block, Law::new(0.1, 0.0), tips, &[0.05, 0.1, 0.15, 0.2]),
    ]
}
