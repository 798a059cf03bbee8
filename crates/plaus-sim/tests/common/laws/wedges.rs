//! Random worlds in which a driven body presses others against whatever stands in its way: bodies on hinges, ball
//! joints and welds, free bodies, a wall. Where it leaves no way, something has to give; nothing may be flung.

use super::worlds::{Dice, G, M, on_floor};
use glam::{DQuat, DVec3};
use plaus_dist::math;
use plaus_sim::rigid::{BodySpec, Joint, Keyframes, RigidBodyState, RigidWorld, Start, StaticShape, Track};
use plaus_sim::scenery::Aabb;
use plaus_sim::shape::{Cuboid, Frustum, Shape};
use plaus_sim::trace::Observer;
use plaus_sim::{Accuracy, Law, Outcome, Preset, Scratch, State};

/// A world, with the driven body first, and how it was made.
pub struct Wedge {
    pub world: RigidWorld,
    pub starts: Vec<Start>,
    reach: Vec<f64>,
    /// Mass of all others over that of the lightest.
    masses: f64,
    /// Speed of the driven body, in m/s.
    pub speed: f64,
    pub restitution: f64,
    pub until: f64,
}

/// Fastest start of a body, in m/s, and how high all begin at most, in m.
const FASTEST: f64 = 1.0;
const HIGHEST: f64 = 0.3;

/// How a body is held.
#[derive(Debug, Clone, Copy)]
enum Held {
    Free,
    Hinge,
    Door,
    Ball,
    Weld,
    Hangs,
    Paired,
}

fn shape(dice: &mut Dice) -> (Shape, f64) {
    let half = dice.between(0.015, 0.04);
    match dice.of(&[0, 1, 2]) {
        0 => (Shape::Ball(half), half),
        1 => {
            let sides = DVec3::new(2.0 * half, dice.between(0.03, 0.08), dice.between(0.03, 0.12));
            (Shape::Cuboid(Cuboid::new(sides, 0.0).expect("a box")), 0.5 * sides.z)
        }
        _ => (Frustum::cylinder(half, 2.0 * half).expect("a cylinder").into(), half),
    }
}

fn joint(held: Held, dice: &mut Dice, body: usize, starts: &[Start]) -> Option<Joint> {
    let (start, last) = (&starts[body], &starts[body - 1]);
    let above = start.position + DVec3::new(dice.between(-0.05, 0.05), 0.0, dice.between(0.02, 0.15));
    let axis = if dice.of(&[true, false]) { DVec3::Y } else { dice.in_cube() };
    let hinge = Joint::hinge(above, axis, body, start);
    let limits = [-dice.between(0.0, 0.7), dice.between(0.05, 0.7)];
    let middle = (start.position + last.position) * 0.5;
    Some(match held {
        Held::Free => return None,
        Held::Hinge => hinge,
        Held::Door => hinge.with_limits(limits, dice.between(0.0, 0.8)),
        Held::Ball => Joint::ball(above, body, start),
        Held::Weld => Joint::weld(above, body, start),
        Held::Hangs => Joint::ball(above, body, start).to(0, &starts[0]),
        Held::Paired if body > 1 => match dice.of(&[0, 1, 2]) {
            0 => Joint::ball(middle, body, start).to(body - 1, last),
            1 => Joint::hinge(middle, axis, body, start).to(body - 1, last),
            _ => Joint::weld(middle, body, start).to(body - 1, last),
        },
        Held::Paired => return None,
    })
}

impl Wedge {
    /// A random world. `None` if bodies overlap at its start.
    pub fn new(seed: u64, preset: Preset) -> Option<Self> {
        let dice = &mut Dice::new(31, seed);
        let count = dice.of(&[2, 3, 4, 6]);
        let paddle = Cuboid::new(DVec3::new(dice.between(0.01, 0.04), 0.12, 0.12), 0.0).expect("a paddle");
        let first = DVec3::new(-0.42, 0.0, dice.between(0.061, 0.08));
        let mut starts = vec![Start::at_rest(first)];
        let mut bodies = vec![BodySpec::solid(Shape::Cuboid(paddle), 1000.0, M)];
        let mut x = -0.34;
        for _ in 0..count {
            let (shape, low) = shape(dice);
            x += dice.between(0.085, 0.13);
            let high = if dice.of(&[true, false]) { low * 1.001 } else { dice.between(low, 0.09) };
            let orientation =
                DQuat::from_rotation_z(if dice.of(&[true, false]) { 0.0 } else { dice.between(0.0, 3.0) });
            let position = DVec3::new(x, dice.between(-0.02, 0.02), high);
            let velocity = DVec3::X * dice.of(&[0.0, -1.0, 1.0]) * dice.between(0.0, FASTEST);
            bodies.push(BodySpec::solid(shape, dice.of(&[100.0, 1000.0, 8000.0]), M));
            starts.push(Start { orientation, velocity, ..Start::at_rest(position) });
        }
        let reach = bodies.iter().map(|b| b.shape.reach()).collect();
        let masses: Vec<f64> = bodies[1..].iter().map(|b| b.mass.mass).collect();
        let masses = masses.iter().sum::<f64>() / masses.iter().copied().fold(f64::INFINITY, f64::min);
        let restitution = dice.of(&[0.0, 0.3, 0.6]);
        let mut world = on_floor(bodies, Law::new(dice.of(&[0.0, 0.1, 0.5]), restitution), preset);
        if dice.of(&[true, false]) {
            let low = DVec3::new(x + dice.between(0.07, 0.15), -0.2, 0.0);
            let bounds = Aabb { min: low, max: low + DVec3::new(0.05, 0.4, dice.between(0.02, 0.2)) };
            world.parts.push(StaticShape::Block { bounds, material: M, sections: Vec::new() });
        }
        world.accuracy.events = Accuracy::preset(preset).events;
        let mut world = RigidWorld::new(world).ok()?;
        let speed = dice.of_any_size(0.1, 4.0);
        let time = 0.75 / speed;
        let keys = Track::linear([(0.0, first), (time, first + DVec3::X * 0.75)]);
        world.drive(0, &Keyframes { position: keys, rotation: Track::fixed(DQuat::IDENTITY) }).ok()?;
        for body in 1..starts.len() {
            let all =
                [Held::Free, Held::Free, Held::Hinge, Held::Door, Held::Ball, Held::Weld, Held::Hangs, Held::Paired];
            if let Some(joint) = joint(dice.of(&all), dice, body, &starts) {
                starts[body].velocity = DVec3::ZERO;
                if let Some(k) = joint.other {
                    starts[k].velocity = DVec3::ZERO;
                }
                world.join(joint).ok()?;
            }
        }
        world.state(&starts).ok()?;
        Some(Self { world, starts, reach, masses, speed, restitution, until: time + 0.3 })
    }

    /// A bound on speeds of the bodies' points, in m/s. Each impact passes on at most `1 + e` times a speed, between
    /// two walls a ball gains up to `1/(1 − e)`, and a long lever turns what is pressed up to `(30 · masses)^⅓` times
    /// as fast, where the driven body's force ends (`DRIVEN_FORCE_LIMIT` in `contact_constraint.rs`).
    pub fn most(&self) -> f64 {
        let n = self.starts.len() as i32 - 1;
        let passed: f64 = (0..n).map(|_| 1.0 + self.restitution).product();
        let lever = math::cbrt(30.0 * self.masses);
        (self.speed + FASTEST + (2.0 * G * HIGHEST).sqrt()) * passed / (1.0 - self.restitution) * lever
    }

    pub fn run(&self, events: u64) -> Went {
        let mut state = self.world.state(&self.starts).expect("a state");
        let mut watch = Watch { world: &self.world, reach: &self.reach, events, fastest: [0.0; 2], at: 0.0 };
        let outcome = self.world.run(&mut state, &mut Scratch::default(), self.until, &mut watch).expect("a run");
        Went { outcome, events: state.counts().events, fastest: watch.fastest, at: watch.at, time: state.time() }
    }
}

/// How a run went: the fastest velocity and the fastest drift of a body, in m/s.
#[derive(Debug)]
pub struct Went {
    pub outcome: Outcome,
    pub events: u64,
    pub fastest: [f64; 2],
    pub at: f64,
    pub time: f64,
}

struct Watch<'w> {
    world: &'w RigidWorld,
    reach: &'w [f64],
    events: u64,
    fastest: [f64; 2],
    at: f64,
}

impl Observer<RigidWorld> for Watch<'_> {
    fn motion(&mut self, index: usize, body: &RigidBodyState) {
        let now = self.world.at(index, body, body.path.t);
        for (fastest, (v, w)) in self.fastest.iter_mut().zip([(now.path.v, now.spin), (body.path.v, body.spin)]) {
            let speed = v.length() + w.length() * self.reach[index];
            if speed > *fastest {
                (*fastest, self.at) = (speed, body.path.t);
            }
        }
    }

    fn proceed(&mut self, state: &State<RigidBodyState>) -> bool {
        state.counts().events < self.events
    }
}
