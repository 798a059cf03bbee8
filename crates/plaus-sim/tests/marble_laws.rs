//! What marbles in lasting contact must do at every preset.

use crate::common::*;
use glam::DVec3;
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_sim::marbles::{Marble, MarbleSpec, Marbles, Phase, Start};
use plaus_sim::mechanics::{Impact, Other};
use plaus_sim::scenery::{Aabb, Dome, Plane, Surface};
use plaus_sim::trace::Observer;
use plaus_sim::{Accuracy, Law, Outcome, Preset, Scratch, State};

fn at(preset: Preset, mut world: World) -> Marbles {
    world.accuracy = Accuracy::preset(preset);
    world.build()
}

/// The deepest overlap over the smaller radius after any event, and the number of impacts of balls with each other and
/// with upright planes.
struct Deepest<'w> {
    world: &'w Marbles,
    depth: f64,
    sideways: usize,
}

impl Observer<Marbles> for Deepest<'_> {
    fn impact(&mut self, impact: &Impact) {
        let floor = matches!(impact.other, Other::Surface(_)) && impact.normal.z > 0.5;
        self.sideways += usize::from(!floor);
    }

    fn proceed(&mut self, state: &State<Marble>) -> bool {
        let radius = |k: usize| self.world.specs()[k].radius;
        let places: Vec<DVec3> = state.bodies().iter().map(|b| b.path.at(state.time())).collect();
        for (i, &x) in places.iter().enumerate() {
            let sunk = self.world.scenery().deepest_overlap(x, radius(i)).map_or(0.0, |(_, depth)| depth / radius(i));
            let others = places[..i]
                .iter()
                .enumerate()
                .map(|(j, &y)| (radius(i) + radius(j) - (x - y).length()) / radius(i).min(radius(j)));
            self.depth = others.fold(self.depth.max(sunk), f64::max);
        }
        true
    }
}

fn deepest<'w>(world: &'w Marbles, starts: &[Start], until: f64) -> (Deepest<'w>, Outcome, State<Marble>) {
    let mut state = world.state(starts).unwrap();
    let mut watch = Deepest { world, depth: 0.0, sideways: 0 };
    let outcome = world.run(&mut state, &mut Scratch::default(), until, &mut watch).unwrap();
    (watch, outcome, state)
}

#[test]
fn a_heavy_ball_comes_to_rest_on_a_light_one() {
    for preset in Preset::ALL {
        for ratio in [1e2, 1e3, 1e4, 1e6, 1e9] {
            for e in [0.0, 0.5, 0.9] {
                let specs = [1.0, ratio].map(|m| MarbleSpec::solid(0.1, m, M)).to_vec();
                let world = at(preset, World::new(specs, Law::new(0.3, e)).floor());
                let starts = [0.1, 0.8].map(|z| Start::at_rest(DVec3::Z * z));
                let (watch, outcome, state) = deepest(&world, &starts, 3.0);
                assert_eq!(outcome, Outcome::AllAtRest, "{preset:?} {ratio:e} {e}");
                // The path of a step may dip by less than 1e-4 radii; the requirement is less than 1 %.
                assert!(watch.depth < 1e-4, "{preset:?} {ratio:e} {e}: {:e}", watch.depth);
                assert!((state.bodies()[1].path.x.z - 0.3).abs() < 1e-5, "{preset:?} {ratio:e} {e}");
            }
        }
    }
}

#[test]
fn a_column_of_very_unequal_balls_between_walls_stands() {
    let masses = [1.0, 1e3, 1e-1, 1e2, 1.0, 1e4];
    for preset in Preset::ALL {
        let specs = masses.map(|m| MarbleSpec::solid(0.1, m, M)).to_vec();
        let mut world = World::new(specs, Law::new(0.3, 0.4)).floor();
        // A shaft a little wider than the balls: they lean against its sides in turn.
        for (p, n) in [(-0.105, DVec3::X), (0.105, -DVec3::X), (-0.1, DVec3::Y), (0.1, -DVec3::Y)] {
            world.planes.push(Plane::new(n.abs() * p, n, M).unwrap());
        }
        let world = at(preset, world);
        let side = |k: usize| if k.is_multiple_of(2) { -0.005 } else { 0.005 };
        let rise = (0.04_f64 - 0.0001).sqrt();
        let starts: Vec<Start> =
            (0..6).map(|k| Start::at_rest(DVec3::new(side(k), 0.0, 0.1 + rise * k as f64))).collect();
        let (watch, outcome, _) = deepest(&world, &starts, 2.0);
        assert_eq!(outcome, Outcome::AllAtRest, "{preset:?}");
        assert!(watch.depth < 1e-4, "{preset:?}: {:e}", watch.depth);
    }
}

/// Loads of three balls on a smooth floor that carry a fourth, as the accelerations that the loads cause: from three
/// equations that keep the gaps closed.
fn loads(balls: &[(f64, DVec3)], heavy: f64, rise: f64) -> Vec<DVec3> {
    let normals: Vec<DVec3> = balls.iter().map(|(_, x)| (DVec3::Z * rise - *x).normalize()).collect();
    // (a_H − a_k)·n_k = 0 with a_H = g + Σ N n/M and a_k = −N_k n_k's level part/m_k.
    let level = |n: DVec3| n.with_z(0.0).length_squared();
    let entry = |k: usize, j: usize| {
        normals[k].dot(normals[j]) / heavy + if j == k { level(normals[k]) / balls[k].0 } else { 0.0 }
    };
    let column = |j: usize| DVec3::new(entry(0, j), entry(1, j), entry(2, j));
    let right = DVec3::new(normals[0].z, normals[1].z, normals[2].z) * G;
    let found = glam::DMat3::from_cols(column(0), column(1), column(2)).inverse() * right;
    (0..3).map(|k| normals[k].with_z(0.0) * (-found[k] / balls[k].0)).collect()
}

#[test]
fn balls_share_a_load_as_they_must() {
    for ratio in [1.0, 1e3, 1e6] {
        let balls = [(1.0, 0.0_f64), (2.0, 1.9), (0.5, 4.0)].map(|(m, about)| {
            let (s, c) = plaus_dist::math::sin_cos(about);
            (m, DVec3::new(c, s, 0.0) * 0.13)
        });
        let rise = (0.04_f64 - 0.0169).sqrt();
        let specs = balls.iter().map(|b| b.0).chain([ratio]).map(|m| MarbleSpec::solid(0.1, m, M)).collect();
        let mut world = World::new(specs, Law::new(0.0, 0.5)).floor();
        // Sweeps and their tolerance as in the standard preset, and a step so short that the balls stay where they are.
        world.accuracy = Accuracy { step: 1e-3, ..Accuracy::default() };
        let world = world.build();
        let places = balls.iter().map(|b| b.1 + DVec3::Z * 0.1).chain([DVec3::Z * (0.1 + rise)]);
        let starts: Vec<Start> = places.map(Start::at_rest).collect();
        let time = 5e-4 * (0.1 / G).sqrt();
        let (bodies, _, _) = run(&world, &starts, time);
        for (k, exact) in loads(&balls, ratio, rise).into_iter().enumerate() {
            let found = bodies[k].path.v / time;
            assert!((found - exact).length() < 0.01 * exact.length(), "ratio {ratio:e}, ball {k}: {found} for {exact}");
        }
    }
}

/// Galperin's billiard: a ball with 100^n times the mass drives a light one against a wall. The number of impacts shows
/// the digits of π.
#[test]
fn balls_and_a_wall_count_the_digits_of_pi() {
    for preset in Preset::ALL {
        for (mass, exact) in [(1.0, 3), (1e2, 31), (1e4, 314), (1e6, 3141), (1e8, 31415)] {
            for gravity in [G, 0.0] {
                let specs = [1.0, mass].map(|m| MarbleSpec::solid(0.1, m, M)).to_vec();
                let mut world = World::new(specs, Law::new(0.0, 1.0)).floor();
                world.planes.push(Plane::new(DVec3::ZERO, DVec3::X, M).unwrap());
                world.gravity = DVec3::Z * -gravity;
                let world = at(preset, world);
                let z = DVec3::Z * 0.1;
                let starts = [Start::at_rest(DVec3::X * 0.5 + z), moving(DVec3::X * 1.5 + z, -DVec3::X, DVec3::ZERO)];
                let (watch, outcome, _) = deepest(&world, &starts, 30.0);
                assert_eq!((watch.sideways, outcome), (exact, Outcome::TimeReached), "{preset:?} {mass:e} {gravity}");
            }
        }
    }
}

/// Newton's cradle on a floor: as many balls leave as come in, because impacts at one instant are resolved pair by pair
/// (see `resolve`).
#[test]
fn as_many_leave_a_cradle_as_come_in() {
    for preset in Preset::ALL {
        for coming in 1..5 {
            for (friction, gap, radius) in [(0.0, 0.3, 0.1), (0.0, 0.0, 0.037), (0.3, 0.0, 0.1), (0.3, 0.0, 0.25)] {
                let specs = vec![MarbleSpec::solid(radius, 1.0, M); 5];
                let world = at(preset, World::new(specs, Law::new(friction, 1.0)).floor());
                let starts: Vec<Start> = (0..5)
                    .map(|k| {
                        let comes = k < coming;
                        let x = 2.0 * radius * f64::from(k) - if comes { gap } else { 0.0 };
                        moving(DVec3::new(x, 0.0, radius), if comes { DVec3::X } else { DVec3::ZERO }, DVec3::ZERO)
                    })
                    .collect();
                let (bodies, outcome, _) = run(&world, &starts, gap + 1e-6);
                assert_eq!(outcome, Outcome::TimeReached);
                for (k, b) in bodies.iter().enumerate() {
                    let exact = if k >= 5 - coming as usize { 1.0 } else { 0.0 };
                    // Friction acts for a millionth of a second.
                    let lost = friction * G * 1e-6;
                    assert!((b.path.v.x - exact).abs() <= lost + 1e-14, "{preset:?} {coming} ball {k}: {}", b.path.v);
                }
            }
        }
    }
}

#[test]
fn an_elastic_ball_that_lies_stays_and_one_that_falls_bounces_on() {
    for preset in Preset::ALL {
        for tilt in [0.0, 0.1, 0.3, 0.7] {
            let (s, c) = plaus_dist::math::sin_cos(tilt);
            let (n, point) = (DVec3::new(s, 0.0, c), DVec3::new(0.1, 0.2, 0.3));
            let mut world = World::new(vec![MarbleSpec::solid(0.1, 1.0, M)], Law::new(0.9, 1.0));
            world.planes.push(Plane::new(point, n, M).unwrap());
            let world = at(preset, world);
            let (bodies, _, state) = run(&world, &[Start::at_rest(point + n * 0.1)], 2.0);
            let down = DVec3::new(c, 0.0, -s) * (0.5 * 5.0 / 7.0 * G * s * 4.0);
            assert!(state.counts().impacts <= 1, "{preset:?} {tilt}: {:?}", state.counts());
            assert!((bodies[0].path.x - point - n * 0.1 - down).length() < 1e-13, "{preset:?} {tilt}");
        }
        let world = at(preset, World::new(vec![MarbleSpec::solid(0.1, 1.0, M)], Law::new(0.3, 1.0)).floor());
        // A bounce of a thousandth of a radius, a thousand times.
        let (bodies, _, state) = run(&world, &[Start::at_rest(DVec3::Z * 0.1001)], 9.0);
        assert!(state.counts().impacts > 900, "{preset:?} {:?}", state.counts());
        let height = bodies[0].path.x.z + bodies[0].path.v.length_squared() / (2.0 * G);
        assert!((height - 0.1001).abs() < 1e-13, "{preset:?}: {height}");
    }
}

#[test]
fn an_elastic_ball_rolls_to_and_fro_in_a_bowl() {
    for preset in Preset::ALL {
        let mut world = World::new(vec![MarbleSpec::solid(0.1, 1.0, M)], Law::new(0.3, 1.0));
        let clip = Aabb { min: DVec3::splat(-2.0), max: DVec3::splat(0.9) };
        world.domes.push(Dome::new(DVec3::Z, 1.0, true, clip, M).unwrap());
        let world = at(preset, world);
        let start = Start::at_rest(DVec3::new(0.9 * 0.6, 0.0, 1.0 - 0.9 * 0.8));
        let (bodies, outcome, state) = run(&world, &[start], 20.0);
        assert_eq!(outcome, Outcome::TimeReached);
        assert!(state.counts().impacts <= 1, "{preset:?} {:?}", state.counts());
        let lost = 1.0 - world.energy(0, &bodies[0]) / (G * start.position.z);
        // Ten swings, in each of which the steps may lose energy of the second order.
        let step = Accuracy::preset(preset).step;
        assert!((-1e-12..step * step).contains(&lost), "{preset:?} {lost}");
    }
}

/// A slope a millionth steeper than the angle of friction, for a ball that cannot roll, because of its inertia or
/// because its resistance to rolling exceeds that to sliding.
#[test]
fn a_slope_a_millionth_too_steep_lets_a_ball_slide_a_millionth() {
    let friction = 0.3_f64;
    for preset in Preset::ALL {
        for (gyration, rolling) in [(1e12, 0.0), (0.4, 1.0)] {
            for excess in [1e-6, -1e-6] {
                let slope: f64 = friction * (1.0 + excess);
                let c = 1.0 / (1.0 + slope * slope).sqrt();
                let n = DVec3::new(slope * c, 0.0, c);
                let spec = MarbleSpec { gyration, ..MarbleSpec::solid(0.1, 1.0, M) };
                let law = Law::new(friction, 0.5).with_resistance(rolling, 0.0);
                let mut world = World::new(vec![spec], law);
                world.planes.push(Plane::new(DVec3::ZERO, n, M).unwrap());
                let world = at(preset, world);
                let (bodies, _, _) = run(&world, &[Start::at_rest(n * 0.1)], 10.0);
                let way = (bodies[0].path.x - n * 0.1).length();
                // A ball that is only hard to turn rolls by 1e-12 of its fall in that time.
                let exact = if excess > 0.0 { 0.5 * G * c * friction * excess * 100.0 } else { 0.0 };
                assert!((way - exact).abs() < 1e-9, "{preset:?} {gyration:e} {excess:e}: {way:e} for {exact:e}");
            }
        }
    }
}

/// Ten balls with masses from 1 to 1000 in a bowl: balls that are said to be at rest do not overlap, and they rest on
/// something.
#[test]
fn bodies_at_rest_do_not_overlap() {
    for preset in [Preset::Draft, Preset::Standard] {
        for seed in 0..10 {
            let mut stream = Seed(5).chain(0).at(seed, Purpose::START);
            let mut u = || open_unit(&mut stream);
            let specs: Vec<MarbleSpec> = (0..10)
                .map(|_| MarbleSpec::solid(0.05 + 0.03 * u(), plaus_dist::math::powf(10.0, 3.0 * u()), M))
                .collect();
            let law = Law::new(0.4, 0.3).with_resistance(0.05, 0.05);
            let mut world = World::new(specs, law);
            let clip = Aabb { min: DVec3::splat(-2.0), max: DVec3::splat(0.6) };
            world.domes.push(Dome::new(DVec3::Z * 0.6, 0.6, true, clip, M).unwrap());
            let world = at(preset, world);
            let starts: Vec<Start> =
                (0..10).map(|k| Start::at_rest(DVec3::new(0.1 * u(), 0.1 * u(), 0.2 + 0.17 * f64::from(k)))).collect();
            let (watch, outcome, state) = deepest(&world, &starts, 20.0);
            assert!(matches!(outcome, Outcome::AllAtRest | Outcome::TimeReached), "{preset:?} {seed}: {outcome:?}");
            // Between the ends of a step a parabola leaves the bowl by step³ · 2/81 · 3 v v'/g, here about a tenth of
            // the bowl's radius, which is ten of the ball's: third order.
            let step = Accuracy::preset(preset).step;
            assert!(watch.depth < step * step * step, "{preset:?} {seed}: {:e}", watch.depth);
            let (bodies, resting) = (state.bodies(), |b: &&Marble| b.phase == Phase::Rest);
            for b in bodies.iter().filter(resting) {
                let k = bodies.iter().position(|c| c.path == b.path).unwrap();
                let sunk = world.scenery().deepest_overlap(b.path.x, world.specs()[k].radius);
                // The overlap that rest may keep, 2e-5 of a radius.
                assert!(
                    sunk.is_none_or(|(_, d): (Surface, f64)| d <= 2e-5 * world.specs()[k].radius),
                    "{preset:?} {seed}: {sunk:?}"
                );
            }
        }
    }
}

#[test]
fn errors_name_what_is_wrong_by_its_value() {
    let build = |change: &dyn Fn(&mut World)| {
        let mut world = World::new(vec![MarbleSpec::solid(0.1, 1.0, M)], Law::new(0.3, 0.5)).floor();
        change(&mut world);
        let scenery = plaus_sim::scenery::Scenery::new(world.planes, world.mesh, world.domes, 1.0).unwrap();
        let laws = plaus_sim::Laws::uniform(world.law);
        let (specs, gravity, accuracy, duration) = (world.specs, world.gravity, world.accuracy, world.duration);
        laws.and_then(|laws| {
            Marbles::new(plaus_sim::marbles::MarbleWorld { specs, laws, scenery, gravity, accuracy, duration })
        })
    };
    let said = |change: &dyn Fn(&mut World)| build(change).unwrap_err().to_string();
    let endless = f64::INFINITY;
    assert_eq!(said(&|w| w.gravity.z = -endless), "gravity is -inf, expected finite components");
    assert_eq!(said(&|w| w.specs[0].radius = endless), "body 0: radius is inf, expected a positive, finite number");
    assert_eq!(said(&|w| w.duration = endless), "duration is inf, expected a positive, finite time");
    assert_eq!(said(&|w| w.law.friction = endless), "law between materials 0 and 0: friction is inf, out of its range");
    let plane = Plane::new(DVec3::X * endless, DVec3::Z, M).unwrap_err().to_string();
    assert_eq!(plane, "plane: point is inf, expected finite coordinates");
    let clip = Aabb { min: DVec3::splat(-endless), max: DVec3::ONE };
    let dome = Dome::new(DVec3::ZERO, 1.0, true, clip, M).unwrap_err().to_string();
    assert_eq!(dome, "dome: clip is -inf, expected finite coordinates");
    let world = build(&|w| w.specs.push(MarbleSpec::solid(0.1, 1.0, M))).unwrap();
    let start = |heights: [f64; 2]| heights.map(|z| Start::at_rest(DVec3::Z * z)).to_vec();
    let both = world.state(&start([0.5, 0.625])).unwrap_err().to_string();
    assert_eq!(both, "bodies 0 and 1 overlap by 0.07500000000000001 m at the start");
    let sunk = world.state(&start([0.0625, 1.0])).unwrap_err().to_string();
    assert_eq!(sunk, "body 0 overlaps plane 0 by 0.037500000000000006 m at the start");
}
