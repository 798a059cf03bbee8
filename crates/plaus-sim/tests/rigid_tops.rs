//! Tops that stand on a corner which friction holds: their motion against Euler's equations about that corner.

use crate::common::{G, M};
use crate::laws::worlds::on_floor;
use glam::{DMat3, DQuat, DVec3};
use plaus_dist::math;
use plaus_sim::rigid::{BodySpec, RigidWorld, Start};
use plaus_sim::shape::{ConvexHull, Shape};
use plaus_sim::{Law, Preset, Scratch};
use std::f64::consts::FRAC_PI_4;
use std::sync::Arc;

/// A pyramid of eight sides on its tip, whose base is off its middle by this much in m, along x and y.
fn top(off: [f64; 2]) -> ConvexHull {
    let base = |k: usize| {
        let (s, c) = math::sin_cos(FRAC_PI_4 * k as f64);
        DVec3::new(0.03 * c + off[0], 0.03 * s + off[1], 0.06)
    };
    let points: Vec<DVec3> = (0..8).map(base).chain([DVec3::ZERO]).collect();
    ConvexHull::new(&points, 0.0).unwrap()
}

/// Orientation of the axes of the given points, and angular velocity along them.
#[derive(Clone, Copy)]
struct Spin {
    turn: DQuat,
    w: DVec3,
}

/// Euler's equations about the tip, in axes of the body, by the Runge–Kutta method of fourth order.
struct Tip {
    inertia: DMat3,
    inverse: DMat3,
    /// Mass times the centre of gravity from the tip.
    lever: DVec3,
}

impl Tip {
    fn of(hull: &ConvexHull, density: f64) -> Self {
        let (mass, c) = (hull.mass_properties(density), hull.centre());
        let turn = DMat3::from_quat(hull.turn());
        let about =
            DMat3::from_diagonal(DVec3::splat(c.length_squared())) - DMat3::from_cols(c * c.x, c * c.y, c * c.z);
        let inertia = turn * DMat3::from_diagonal(mass.inertia) * turn.transpose() + about * mass.mass;
        Self { inertia, inverse: inertia.inverse(), lever: c * mass.mass }
    }

    fn rates(&self, s: &Spin) -> (DQuat, DVec3) {
        let down = s.turn.conjugate() * (DVec3::NEG_Z * G);
        let w = self.inverse * (self.lever.cross(down) - s.w.cross(self.inertia * s.w));
        (s.turn * DQuat::from_vec4(s.w.extend(0.0)) * 0.5, w)
    }

    fn after(&self, mut s: Spin, time: f64, steps: usize) -> Spin {
        let h = time / steps as f64;
        let add = |s: &Spin, k: &(DQuat, DVec3), h: f64| Spin { turn: s.turn + k.0 * h, w: s.w + k.1 * h };
        for _ in 0..steps {
            let a = self.rates(&s);
            let b = self.rates(&add(&s, &a, 0.5 * h));
            let c = self.rates(&add(&s, &b, 0.5 * h));
            let d = self.rates(&add(&s, &c, h));
            for (k, part) in [(a, 1.0), (b, 2.0), (c, 2.0), (d, 1.0)] {
                s = add(&s, &k, part * h / 6.0);
            }
            s.turn = s.turn.normalize();
        }
        s
    }
}

/// A run of a fixed number of steps is compared with one of twice as many: what is left is the truth's error.
#[test]
fn tops_on_a_tip_obey_eulers_equations() {
    const DENSITY: f64 = 1000.0;
    for (off, tilt, spin) in [([0.0, 0.0], 0.1, 30.0), ([0.004, 0.0], 0.1, 30.0), ([0.003, -0.002], 0.2, 20.0)] {
        let hull = top(off);
        let tip = Tip::of(&hull, DENSITY);
        let first = Spin { turn: DQuat::from_rotation_y(tilt), w: DVec3::Z * spin };
        // No side of it comes down in this time.
        let time = 0.1;
        let axis = |s: &Spin| s.turn * DVec3::Z;
        // Two to six times the worst that was measured: 5.6e-3, 2.5e-3, 1.7e-5, 1.7e-7, of the second top.
        for (preset, enough) in Preset::ALL.into_iter().zip([1e-2, 5e-3, 1e-4, 1e-6]) {
            let shape = Shape::Hull(Arc::new(hull.clone()));
            let body = BodySpec::solid(shape, DENSITY, M);
            let world = RigidWorld::new(on_floor(vec![body], Law::new(2.0, 0.0), preset)).unwrap();
            let w = first.turn * first.w;
            let place = first.turn * hull.centre();
            let start = Start {
                orientation: first.turn * hull.turn(),
                spin: w,
                velocity: w.cross(place),
                ..Start::at_rest(place)
            };
            let mut state = world.state(&[start]).unwrap();
            world.run(&mut state, &mut Scratch::default(), time, &mut ()).unwrap();
            // Where its last step begins: within a step, it only turns freely.
            let body = &state.bodies()[0];
            let [right, doubt] = [4000, 8000].map(|steps| tip.after(first, body.path.t, steps));
            assert!(body.path.t > 0.5 * time && (axis(&right) - axis(&doubt)).length() < 1e-9);
            let found = body.turn * hull.turn().conjugate() * DVec3::Z;
            let off_by = (found - axis(&doubt)).length();
            println!(
                "{off:?} {}: tilt {:.4} for {:.4}, axis off by {off_by:.1e}, {:?}",
                preset.name(),
                math::acos(found.z),
                math::acos(axis(&doubt).z),
                state.counts()
            );
            assert!(off_by < enough, "{off:?} {}: {off_by:.1e}", preset.name());
        }
    }
}
