//! Random bodies and throws: every shape, each number from a stream with its own seed.

use glam::{DQuat, DVec3};
use plaus_dist::{Purpose, Seed, Stream, math, open_unit};
use plaus_sim::rigid::{BodySpec, RigidWorldDesc, Start, StaticShape};
use plaus_sim::scenery::Plane;
use plaus_sim::shape::{Compound, Convex, ConvexHull, Cuboid, Frustum, Member, Profile, Revolution, Shape, Solid};
use plaus_sim::{Accuracy, Law, Laws, Material, Preset};
use std::sync::Arc;

pub const G: f64 = 9.81;
pub const M: Material = Material(0);

/// A kind of body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Ball,
    Cube,
    Cuboid,
    Rounded,
    Pin,
    D4,
    D20,
    Rock,
    Cylinder,
    Cone,
    Capsule,
    Hammer,
    Weighted,
}

impl Kind {
    pub const ALL: [Self; 8] =
        [Self::Ball, Self::Cube, Self::Cuboid, Self::Rounded, Self::Pin, Self::D4, Self::D20, Self::Rock];

    /// The kinds that are made of convex pieces.
    pub const OF_PIECES: [Self; 5] = [Self::Cylinder, Self::Cone, Self::Capsule, Self::Hammer, Self::Weighted];

    /// The kinds that meet each other with their exact shapes.
    pub const MEET: [Self; 5] = [Self::Ball, Self::Cube, Self::Cuboid, Self::D4, Self::Rock];

    /// A body of this kind, a few centimetres large, with random proportions if it has any.
    pub fn body(self, dice: &mut Dice) -> BodySpec {
        let edge = dice.between(0.01, 0.1);
        let sides = DVec3::new(dice.between(0.4, 1.0), dice.between(0.4, 1.0), dice.between(0.4, 1.0)) * edge;
        let cuboid = |edges, rounding| Shape::Cuboid(Cuboid::new(edges, rounding).expect("a cuboid"));
        let shape = match self {
            Self::Ball => Shape::Ball(0.5 * edge),
            Self::Cube => cuboid(DVec3::splat(edge), 0.0),
            Self::Cuboid => cuboid(sides, 0.0),
            Self::Rounded => cuboid(sides, sides.min_element() * dice.between(0.02, 0.45)),
            Self::Pin => Shape::Revolution(Arc::new(Revolution::new(&Profile::pin(), 40).expect("a pin"))),
            Self::D4 => hull(&Solid::Tetrahedron.corners(edge)),
            Self::D20 => hull(&Solid::Icosahedron.corners(0.4 * edge)),
            Self::Rock => hull(&(0..16).map(|_| dice.in_cube() * sides).collect::<Vec<_>>()),
            Self::Cylinder => Frustum::cylinder(0.5 * sides.x, sides.y).expect("a cylinder").into(),
            Self::Cone => Frustum::cone(0.5 * sides.x, sides.y).expect("a cone").into(),
            Self::Capsule => Frustum::capsule(0.5 * sides.x, sides.y).expect("a capsule").into(),
            Self::Hammer => hammer(sides).into(),
            Self::Weighted => {
                Compound::weighted_ball(0.5 * edge, dice.between(0.0, 0.2) * edge).expect("a ball").into()
            }
        };
        BodySpec::solid(shape, 1200.0, M)
    }
}

/// A cylinder as the head, a box as the handle.
fn hammer(sides: DVec3) -> Compound {
    let head = Frustum::cylinder(0.3 * sides.x, sides.y).expect("a head");
    let handle = Cuboid::new(DVec3::new(1.5 * sides.z, 0.2 * sides.x, 0.2 * sides.x), 0.0).expect("a handle");
    Compound::new(&[
        Member { density: 3.0, ..Member::new(Convex::Frustum(head), DVec3::ZERO) },
        Member::new(Convex::Cuboid(handle), DVec3::X * (0.8 * sides.z)),
    ])
    .expect("a hammer")
}

fn hull(points: &[DVec3]) -> Shape {
    Shape::Hull(Arc::new(ConvexHull::new(points, 0.0).expect("a hull")))
}

/// Random numbers of one throw.
pub struct Dice(Stream);

impl Dice {
    pub fn new(seed: u64, throw: u64) -> Self {
        Self(Seed(seed).chain(0).at(throw, Purpose::START))
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * open_unit(&mut self.0)
    }

    /// Every order of magnitude is equally likely.
    pub fn of_any_size(&mut self, low: f64, high: f64) -> f64 {
        low * math::exp(math::ln(high / low) * open_unit(&mut self.0))
    }

    pub fn of<T: Copy>(&mut self, from: &[T]) -> T {
        from[((open_unit(&mut self.0) * from.len() as f64) as usize).min(from.len() - 1)]
    }

    /// Each coordinate between −1 and 1.
    pub fn in_cube(&mut self) -> DVec3 {
        DVec3::new(self.between(-1.0, 1.0), self.between(-1.0, 1.0), self.between(-1.0, 1.0))
    }

    /// All orientations are equally likely: rejection from the ball of quaternions.
    pub fn turn(&mut self) -> DQuat {
        loop {
            let q = DQuat::from_vec4(self.in_cube().extend(self.between(-1.0, 1.0)));
            if (0.01..=1.0).contains(&q.length_squared()) {
                return q.normalize();
            }
        }
    }

    /// A throw of a body from up to three times its size over the floor, with speeds from slow to fast on the scale of
    /// √(g·reach).
    pub fn throw(&mut self, body: &BodySpec) -> Start {
        let reach = body.shape.reach();
        let speed = (G * reach).sqrt();
        let position = DVec3::Z * reach * self.between(1.01, 4.0);
        let way = self.in_cube().with_z(0.0).normalize();
        let velocity = way * speed * self.of_any_size(0.003, 6.0) + DVec3::Z * speed * self.between(-2.0, 1.0);
        let spin = self.in_cube() * (speed / reach) * self.of_any_size(0.003, 6.0);
        Start { position, orientation: self.turn(), velocity, spin, time: 0.0 }
    }
}

/// Bodies over a level floor.
pub fn on_floor(bodies: Vec<BodySpec>, law: Law, preset: Preset) -> RigidWorldDesc {
    RigidWorldDesc {
        bodies,
        parts: vec![StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, M).expect("a plane"))],
        laws: Laws::uniform(law).expect("a law"),
        gravity: DVec3::new(0.0, 0.0, -G),
        accuracy: Accuracy::preset(preset),
        skin: 1.0,
        sink: f64::NEG_INFINITY,
        duration: 1000.0,
    }
}

/// Bodies and nothing else.
pub fn in_space(bodies: Vec<BodySpec>, law: Law, preset: Preset) -> RigidWorldDesc {
    RigidWorldDesc { parts: Vec::new(), gravity: DVec3::ZERO, ..on_floor(bodies, law, preset) }
}

/// One body thrown onto a floor.
pub fn thrown(kind: Kind, throw: u64, law: Law, preset: Preset) -> (RigidWorldDesc, [Start; 1]) {
    let mut dice = Dice::new(7, throw);
    let body = kind.body(&mut dice);
    let start = dice.throw(&body);
    (on_floor(vec![body], law, preset), [start])
}

/// Two bodies flung at each other.
pub fn two(kinds: [Kind; 2], throw: u64) -> (Vec<BodySpec>, [Start; 2]) {
    let mut dice = Dice::new(11, throw);
    let bodies = kinds.map(|k| k.body(&mut dice));
    let apart = 1.05 * (bodies[0].shape.reach() + bodies[1].shape.reach());
    let speed = (G * apart).sqrt() * dice.of_any_size(0.1, 3.0);
    let aside = dice.in_cube().with_x(0.0) * 0.3;
    let starts = [0, 1].map(|k| {
        let side = [-0.5, 0.5][k];
        let spin = dice.in_cube() * (speed / apart) * 2.0;
        let velocity = DVec3::X * (-2.0 * side * speed) + dice.in_cube() * (0.2 * speed);
        let position = DVec3::new(side, 0.0, 0.0) * apart + aside * (side * apart);
        Start { position, orientation: dice.turn(), velocity, spin, time: 0.0 }
    });
    (bodies.to_vec(), starts)
}
