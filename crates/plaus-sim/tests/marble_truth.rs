//! Lasting contact of marbles compared with an independent integrator. Where there is no closed form, finer presets are
//! nearer to the truth, by the square of the step.

use crate::common::smooth::{Ball, Friction, Smooth, Touch, With};
use crate::common::*;
use glam::DVec3;
use plaus_sim::marbles::{MarbleSpec, Start};
use plaus_sim::scenery::{Aabb, Dome};
use plaus_sim::{Accuracy, Law, Preset};

const BOWL: f64 = 1.0;

/// A motion of balls of radius 0.1 m and more in contacts that stay as they are for `time` seconds.
struct Case {
    name: &'static str,
    balls: Vec<Ball>,
    touches: Vec<Touch>,
    friction: f64,
    bowl: bool,
    time: f64,
}

impl Case {
    /// Distances from the truth over the radius, for the ball that is farthest off; draft first. Also the error of the
    /// truth itself.
    fn errors(&self) -> ([f64; 4], f64) {
        let smooth = Smooth { gravity: DVec3::new(0.0, 0.0, -G), touches: self.touches.clone() };
        let truth = smooth.run(&self.balls, self.time, 4000);
        let half = smooth.run(&self.balls, self.time, 2000);
        let apart = |a: DVec3, b: DVec3, k: usize| (a - b).length() / self.balls[k].radius;
        let doubt = truth.iter().zip(&half).enumerate().map(|(k, (a, b))| apart(a.x, b.x, k)).fold(0.0, f64::max);
        let errors = Preset::ALL.map(|preset| {
            let found = self.simulate(preset);
            found.iter().zip(&truth).enumerate().map(|(k, (&a, b))| apart(a, b.x, k)).fold(0.0, f64::max)
        });
        (errors, doubt)
    }

    fn simulate(&self, preset: Preset) -> Vec<DVec3> {
        let specs = self.balls.iter().map(|b| MarbleSpec::solid(b.radius, b.mass, M)).collect();
        let mut world = World::new(specs, Law::new(self.friction, 0.0));
        if self.bowl {
            let clip = Aabb { min: DVec3::splat(-2.0), max: DVec3::splat(0.9) };
            world.domes.push(Dome::new(DVec3::Z * BOWL, BOWL, true, clip, M).unwrap());
        } else {
            world = world.floor();
        }
        // No rest at a turning point: that depends on another tolerance.
        world.accuracy = Accuracy { rest_speed: 1e-12, ..Accuracy::preset(preset) };
        let world = world.build();
        let starts: Vec<Start> = self.balls.iter().map(|b| moving(b.x, b.v, b.w)).collect();
        let (at, _, state) = run(&world, &starts, self.time);
        assert_eq!(state.time(), self.time, "{}", self.name);
        at.iter().map(|b| b.path.x).collect()
    }
}

fn ball(radius: f64, mass: f64, x: DVec3, v: DVec3, w: DVec3) -> Ball {
    Ball { x, v, w, mass, radius }
}

/// A place in the bowl, by its angle from the axis and its angle about it, and the direction downhill.
fn in_bowl(radius: f64, angle: f64, about: f64) -> (DVec3, DVec3) {
    let ((s, c), (t, d)) = (plaus_dist::math::sin_cos(angle), plaus_dist::math::sin_cos(about));
    let outward = DVec3::new(s * d, s * t, -c);
    (DVec3::Z * BOWL + outward * (BOWL - radius), DVec3::new(-c * d, -c * t, -s))
}

fn cases() -> Vec<Case> {
    let bowl = |a, friction| Touch { a, with: With::Bowl { centre: DVec3::Z * BOWL }, friction };
    let floor = |a, friction| Touch { a, with: With::Plane(DVec3::Z), friction };
    let pair = |a, b, friction| Touch { a, with: With::Ball(b), friction };
    let (side, down) = in_bowl(0.1, 0.6, 0.3);
    let across = down.cross(side - DVec3::Z * BOWL).normalize();
    let normal = (DVec3::Z * BOWL - side).normalize();
    // Rolling: the touching point stands still.
    let rolling = |v: DVec3, r: f64| normal.cross(v) / r;
    let glide = across * 1.1 + down * 0.4;
    // Two balls of unequal size, side by side in the bowl: both touch the bowl and each other.
    let (p, q) = (0.12, 0.08);
    let (far, near, reach) = (BOWL - p, BOWL - q, p + q);
    let gap = plaus_dist::math::acos((far * far + near * near - reach * reach) / (2.0 * far * near));
    let two = [in_bowl(p, 0.5, 0.0).0, in_bowl(q, 0.5 - gap, 0.0).0];
    let tilt = plaus_dist::math::sin_cos(0.35);
    let (lean, up) = (DVec3::new(tilt.0, 0.0, tilt.1), DVec3::Z);
    let heavy = [0.0, 2.1, 4.2].map(|a| {
        let (s, c) = plaus_dist::math::sin_cos(a);
        DVec3::new(c, s, 0.0)
    });
    let still = DVec3::ZERO;
    vec![
        Case {
            name: "a smooth ball glides around a bowl",
            balls: vec![ball(0.1, 1.0, side, glide, still)],
            touches: vec![bowl(0, Friction::None)],
            friction: 0.0,
            bowl: true,
            time: 2.0,
        },
        Case {
            name: "a ball rolls around a bowl, spinning",
            balls: vec![ball(0.1, 1.0, side, glide, rolling(glide, 0.1) + normal * 8.0)],
            touches: vec![bowl(0, Friction::Sticks)],
            friction: 10.0,
            bowl: true,
            time: 2.0,
        },
        Case {
            name: "a ball slides down a bowl",
            balls: vec![ball(0.1, 1.0, side, glide, still)],
            touches: vec![bowl(0, Friction::Slips(0.1))],
            friction: 0.1,
            bowl: true,
            time: 0.5,
        },
        Case {
            name: "two smooth balls swing in a bowl together",
            balls: vec![ball(p, 2.0, two[0], still, still), ball(q, 1.0, two[1], still, still)],
            touches: vec![bowl(0, Friction::None), bowl(1, Friction::None), pair(0, 1, Friction::None)],
            friction: 0.0,
            bowl: true,
            time: 0.5,
        },
        Case {
            name: "a ball rolls off another that rolls away",
            balls: vec![
                ball(0.15, 1.0, up * 0.15, still, still),
                ball(0.1, 1.0, up * 0.15 + lean * 0.25, still, still),
            ],
            touches: vec![floor(0, Friction::Sticks), pair(1, 0, Friction::Sticks)],
            friction: 100.0,
            bowl: false,
            time: 0.2,
        },
        Case {
            name: "a ball presses three apart",
            balls: [(1.0, heavy[0]), (2.0, heavy[1]), (3.0, heavy[2])]
                .map(|(mass, out)| ball(0.1, mass, out * 0.12 + up * 0.1, still, still))
                .into_iter()
                .chain([ball(0.1, 5.0, up * (0.1 + (0.04_f64 - 0.0144).sqrt()), still, still)])
                .collect(),
            touches: (0..3)
                .map(|k| floor(k, Friction::None))
                .chain((0..3).map(|k| pair(3, k, Friction::None)))
                .collect(),
            friction: 0.0,
            bowl: false,
            time: 0.08,
        },
    ]
}

#[test]
fn finer_presets_are_nearer_to_the_truth_by_the_square_of_the_step() {
    for case in cases() {
        let (errors, doubt) = case.errors();
        let [_, standard, fine, reference] = errors;
        // Steps shrink by 4 and by 5, so errors of second order shrink by 16 and by 25. The test asks for half of that,
        // because steps follow the motion and errors may cancel by chance.
        assert!(doubt < 0.02 * reference, "{}: the truth is known to {doubt:e} only", case.name);
        assert!(standard > 8.0 * fine && fine > 12.0 * reference, "{}: {errors:?}", case.name);
    }
}
