//! Random stacks, lintels, leaning, wedged, pressed and sleeping bodies of many shapes.

use super::*;

/// A world at rest, or nearly.
pub(super) struct Scene {
    pub(super) bodies: Vec<BodySpec>,
    pub(super) parts: Vec<StaticShape>,
    pub(super) starts: Vec<Start>,
    /// A force on the last body.
    pub(super) force: DVec3,
    pub(super) asleep: bool,
    /// The pairs that must be told from the first moment.
    pub(super) bear: Vec<(usize, Partner)>,
    pub(super) friction: f64,
}

impl Scene {
    pub(super) fn new() -> Self {
        let floor = StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, M).unwrap());
        Self {
            bodies: Vec::new(),
            parts: vec![floor],
            starts: Vec::new(),
            force: DVec3::ZERO,
            asleep: false,
            bear: Vec::new(),
            friction: 0.8,
        }
    }

    pub(super) fn add(&mut self, dice: &mut Dice, shape: Shape, at: DVec3, turn: DQuat) {
        self.bodies.push(BodySpec::solid(shape, dice.between(300.0, 3000.0), M));
        self.starts.push(Start { orientation: turn, ..Start::at_rest(at) });
    }

    /// Bodies upon each other; a fifth of the stacks fall by up to a millimetre first.
    pub(super) fn stack(dice: &mut Dice) -> Self {
        Self::tower(dice, false)
    }

    pub(super) fn tower(dice: &mut Dice, asleep: bool) -> Self {
        let (mut scene, mut top) = (Self::new(), 0.0);
        let drop = if !asleep && dice.between(0.0, 1.0) < 0.2 { dice.between(0.0, 1e-3) } else { 0.0 };
        for k in 0..2 + below(dice, 3) {
            let (shape, half) = upright(dice);
            let at = DVec3::new(dice.between(-0.003, 0.003), dice.between(-0.003, 0.003), top + half + drop);
            top += 2.0 * half + drop;
            let turn = DQuat::from_rotation_z(dice.between(0.0, 6.0));
            scene.add(dice, shape, at, turn);
            if drop == 0.0 {
                let (body, under) = (k.saturating_sub(1), if k == 0 { Partner::Part(0) } else { Partner::Body(k) });
                scene.bear.push((body, under));
            }
        }
        scene
    }

    /// A stack that sleeps.
    pub(super) fn sleepers(dice: &mut Dice) -> Self {
        Self { asleep: true, ..Self::tower(dice, true) }
    }

    /// A beam on two or three supports of the same height, perhaps with a load on it.
    pub(super) fn lintel(dice: &mut Dice) -> Self {
        let (mut scene, height) = (Self::new(), dice.between(0.03, 0.1));
        let count = 2 + below(dice, 2);
        for k in 0..count {
            let along = (k as f64 / (count - 1) as f64 - 0.5) * 0.3;
            let width = dice.between(0.02, 0.05);
            let shape = if below(dice, 2) == 0 {
                cuboid(DVec3::new(width, 0.05, 0.5 * height), 0.0)
            } else {
                Shape::from(Frustum::cylinder(width, height).unwrap())
            };
            scene.add(dice, shape, DVec3::new(along, 0.0, 0.5 * height), DQuat::IDENTITY);
            scene.bear.push((k, Partner::Part(0)));
        }
        let half = DVec3::new(0.22, 0.04, 0.015);
        let round = if below(dice, 2) == 0 { 0.0 } else { 0.003 };
        let at = DVec3::new(dice.between(-0.02, 0.02), 0.0, height + half.z);
        scene.add(dice, cuboid(half, round), at, DQuat::IDENTITY);
        // Of three supports, one may be enough for the first steps.
        if count == 2 {
            scene.bear.extend([(0, Partner::Body(count)), (1, Partner::Body(count))]);
        }
        if below(dice, 2) == 0 {
            let (shape, above) = upright(dice);
            let at = DVec3::new(dice.between(-0.05, 0.05), 0.0, height + 2.0 * half.z + above);
            scene.add(dice, shape, at, DQuat::IDENTITY);
            scene.bear.push((count, Partner::Body(count + 1)));
        }
        scene
    }

    /// A plank that leans on a wall. It stays if friction on both is at least half of the tangent of its angle.
    pub(super) fn ladder(dice: &mut Dice) -> Self {
        let mut scene = Self::new();
        scene.parts.push(StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::X, M).unwrap()));
        let (angle, half) = (dice.between(0.1, 0.5), DVec3::new(0.01, 0.05, dice.between(0.1, 0.3)));
        let (s, c) = math::sin_cos(angle);
        let at = DVec3::new(half.z * s + half.x * c, 0.0, half.z * c + half.x * s);
        scene.add(dice, cuboid(half, 0.0), at, DQuat::from_rotation_y(-angle));
        scene.bear.extend([(0, Partner::Part(0)), (0, Partner::Part(1))]);
        scene
    }

    /// A ball or a lying cylinder between two slopes, a box or a plane.
    pub(super) fn groove(dice: &mut Dice) -> Self {
        let mut scene = Self::new();
        scene.parts.clear();
        for sign in [-1.0, 1.0] {
            let angle = sign * dice.between(0.3, 1.2);
            let normal = DQuat::from_rotation_y(angle) * DVec3::Z;
            if below(dice, 2) == 0 {
                scene.parts.push(StaticShape::Plane(Plane::new(DVec3::ZERO, normal, M).unwrap()));
            } else {
                let shape = cuboid(DVec3::new(0.3, 0.3, 0.05), 0.0);
                let turn = DQuat::from_rotation_y(angle);
                scene.parts.push(StaticShape::Solid(Box::new(StaticSolid {
                    at: turn * DVec3::Z * -0.05,
                    turn,
                    shape,
                    material: M,
                })));
            }
        }
        let normals = scene.parts.iter().map(|part| match part {
            StaticShape::Plane(plane) => plane.normal,
            StaticShape::Solid(solid) => solid.turn * DVec3::Z,
            _ => DVec3::Z,
        });
        let [a, b]: [DVec3; 2] = normals.collect::<Vec<_>>().try_into().unwrap();
        // The place at the distance r from both, in the plane y = 0.
        let radius = dice.between(0.01, 0.05);
        let across = a.x * b.z - a.z * b.x;
        let at = DVec3::new(b.z - a.z, 0.0, a.x - b.x) * (radius / across);
        if below(dice, 2) == 0 {
            scene.add(dice, Shape::Ball(radius), at, DQuat::IDENTITY);
        } else {
            let shape = Shape::from(Frustum::cylinder(radius, 0.1).unwrap());
            scene.add(dice, shape, at, DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2));
        }
        scene.bear.extend([(0, Partner::Part(0)), (0, Partner::Part(1))]);
        scene
    }

    /// A box or a ball that a force presses against a wall, on a floor. Half of them slide along it at first.
    pub(super) fn pressed(dice: &mut Dice) -> Self {
        let mut scene = Self::new();
        scene.parts.push(StaticShape::Plane(Plane::new(DVec3::ZERO, -DVec3::X, M).unwrap()));
        let half = dice.between(0.02, 0.06);
        let shape = if below(dice, 2) == 0 { Shape::Ball(half) } else { cuboid(DVec3::splat(half), 0.0) };
        scene.add(dice, shape, DVec3::new(-half, 0.0, half), DQuat::IDENTITY);
        // More than the friction of the floor holds, so that the wall has to bear some.
        let weight = scene.bodies[0].mass.mass * G;
        (scene.force, scene.friction) = (DVec3::X * weight * dice.between(0.5, 2.0), 0.3);
        if below(dice, 2) == 0 {
            scene.starts[0].velocity = DVec3::Y * 0.1;
        }
        scene.bear.extend([(0, Partner::Part(0)), (0, Partner::Part(1))]);
        scene
    }
}

pub(super) fn cuboid(half: DVec3, rounding: f64) -> Shape {
    Shape::Cuboid(Cuboid::new(half * 2.0, rounding).unwrap())
}

/// A whole number below a bound.
pub(super) fn below(dice: &mut Dice, bound: u32) -> usize {
    dice.between(0.0, f64::from(bound)) as usize
}

/// A body that stands on a flat face and has another above, and half its height.
pub(super) fn upright(dice: &mut Dice) -> (Shape, f64) {
    let half = dice.between(0.01, 0.04);
    let wide = dice.between(0.02, 0.04);
    let shape = match below(dice, 4) {
        0 => cuboid(DVec3::new(wide, dice.between(0.02, 0.04), half), 0.0),
        1 => cuboid(DVec3::new(wide, dice.between(0.02, 0.04), half), 0.004),
        2 => Shape::from(Frustum::cylinder(wide, 2.0 * half).unwrap()),
        _ => {
            let corner = |k: u32, z: f64| {
                let (s, c) = math::sin_cos(f64::from(k) * std::f64::consts::FRAC_PI_3);
                DVec3::new(wide * c, wide * s, z)
            };
            let corners: Vec<DVec3> = (0..6).flat_map(|k| [corner(k, -half), corner(k, half)]).collect();
            Shape::Hull(Arc::new(ConvexHull::new(&corners, 0.0).unwrap()))
        }
    };
    (shape, half)
}
