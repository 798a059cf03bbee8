//! Cuboids against cuboids: when they touch, what an impact conserves, stacks, piles, and nothing inside anything else.

use crate::common::turning::Overlaps;
use crate::laws::worlds::{Dice, in_space};
use glam::{DQuat, DVec3};
use plaus_dist::{Purpose, Seed, math, open_unit};
use plaus_sim::rigid::{BodySpec, Phase, RigidBodyState, RigidWorld, RigidWorldDesc, Start, StaticShape};
use plaus_sim::scenery::Plane;
use plaus_sim::shape::{Cuboid, Shape};
use plaus_sim::trace::Trace;
use plaus_sim::worlds::DieOnTable;
use plaus_sim::{Accuracy, Law, Laws, Material, Outcome, Preset, Scratch, State, WorldError};

const M: Material = Material(0);

/// Cuboids with these edges and roundings; with a table below if there is gravity.
fn world(edges: &[(DVec3, f64)], law: Law, gravity: f64, preset: Preset) -> RigidWorld {
    let body = |&(edges, r): &(DVec3, f64)| BodySpec::solid(Shape::Cuboid(Cuboid::new(edges, r).unwrap()), 1000.0, M);
    let table = StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, M).unwrap());
    RigidWorld::new(RigidWorldDesc {
        bodies: edges.iter().map(body).collect(),
        parts: if gravity > 0.0 { vec![table] } else { Vec::new() },
        laws: Laws::uniform(law).unwrap(),
        gravity: DVec3::new(0.0, 0.0, -gravity),
        accuracy: Accuracy::preset(preset),
        skin: 1.0,
        sink: f64::NEG_INFINITY,
        duration: 20.0,
    })
    .unwrap()
}

fn dice(count: usize, law: Law) -> RigidWorld {
    world(&vec![(DVec3::splat(0.016), 0.0); count], law, 9.81, Preset::Standard)
}

/// A ball flies past a box that tumbles, as far to the side as it must to touch it by less than a thousandth of the
/// box's size, by the distance of a ball from a box in closed form at many times. It does touch, and not before they
/// meet. A twin that passes by as little touches nothing.
#[test]
fn no_graze_of_a_ball_and_a_box_is_missed() {
    let (edges, radius, until) = (DVec3::new(1.0, 0.6, 0.4), 0.4, 2.4);
    let ball = BodySpec::solid(Shape::Ball(radius), 1000.0, M);
    let block = BodySpec::solid(Shape::Cuboid(Cuboid::new(edges, 0.0).unwrap()), 1000.0, M);
    let two =
        RigidWorldDesc { bodies: vec![ball, block], ..in_space(Vec::new(), Law::new(0.0, 1.0), Preset::Standard) };
    let world = RigidWorld::new(two).unwrap();
    let size = 0.5 * edges.min_element();
    let mut numbers = Dice::new(41, 0);
    for throw in 0..60 {
        let spin = numbers.in_cube() * 8.0;
        let block = Start { orientation: numbers.turn(), spin, ..Start::at_rest(DVec3::ZERO) };
        let aside = numbers.in_cube().with_x(0.0).normalize();
        let ball = |far: f64| Start { velocity: DVec3::X, ..Start::at_rest(DVec3::NEG_X * 1.2 + aside * far) };
        let first_impact = |far: f64| {
            let (mut state, mut trace) = (world.state(&[ball(far), block]).unwrap(), Trace::default());
            world.run(&mut state, &mut Scratch::default(), until, &mut trace).unwrap();
            trace.impacts.first().map(|hit| hit.time)
        };
        // Where the box is turned while nothing meets it.
        let mut alone = world.state(&[ball(9.0), block]).unwrap();
        world.run(&mut alone, &mut Scratch::default(), 1e-9, &mut ()).unwrap();
        let looks: Vec<(f64, DQuat)> = (0..300)
            .map(|k| until * f64::from(k) / 300.0)
            .map(|time| (time, world.at(1, &alone.bodies()[1], time.max(1e-9)).turn.conjugate()))
            .collect();
        let gap = |far: f64, (time, turn): &(f64, DQuat)| {
            let p = *turn * (ball(far).position + DVec3::X * *time);
            (p.abs() - edges * 0.5).max(DVec3::ZERO).length() - radius
        };
        let least = |far: f64| looks.iter().map(|look| gap(far, look)).fold(f64::INFINITY, f64::min);
        let passing = |wanted: f64| {
            let (mut low, mut high) = (0.5, 1.5);
            for _ in 0..40 {
                let middle = 0.5 * (low + high);
                if least(middle) > wanted { high = middle } else { low = middle }
            }
            high
        };
        let depth = size * numbers.of_any_size(3e-5, 1e-3);
        let far = passing(-depth);
        let Some(met) = first_impact(far) else { panic!("throw {throw}: a graze {depth} deep is missed") };
        let early =
            looks.iter().take_while(|look| look.0 < met).map(|look| gap(far, look)).fold(f64::INFINITY, f64::min);
        assert!(early > 0.0, "throw {throw}: {early} before {met}");
        // Between two looks, they may come nearer by the sag of half the time between them.
        assert_eq!(first_impact(passing(0.01 * size)), None, "throw {throw}");
    }
}

/// A cuboid that spins about z with its middle fixed sweeps its corner over a circle. It meets the wall of another
/// cuboid when `ρ cos θ` is the wall's distance.
#[test]
fn a_turning_corner_meets_a_face_when_it_should() {
    for rounding in [0.0, 0.1] {
        for preset in [Preset::Standard, Preset::Reference] {
            let world = world(&[(DVec3::ONE, rounding), (DVec3::splat(4.0), 0.0)], Law::new(0.0, 1.0), 0.0, preset);
            let (core, wall, rate) = (0.5 - rounding, 0.6, 2.0);
            let spin = Start { spin: DVec3::Z * rate, ..Start::at_rest(DVec3::ZERO) };
            let mut state = world.state(&[spin, Start::at_rest(DVec3::X * (wall + 2.0))]).unwrap();
            let mut trace = Trace::default();
            world.run(&mut state, &mut Scratch::default(), 1.0, &mut trace).unwrap();
            let first = &trace.impacts[0];
            let radius = core * 2.0_f64.sqrt();
            let angle = std::f64::consts::FRAC_PI_4 - math::acos((wall - rounding) / radius);
            // The corner closes the preset's gap, a fraction of its half edge, at ρ ω sin θ.
            let gap = Accuracy::preset(preset).gap * 0.5;
            let late = first.time - angle / rate;
            let speed = rate * radius * math::sin(std::f64::consts::FRAC_PI_4 - angle);
            assert!(late <= 0.0 && late > -2.0 * gap / speed, "{late} at {} for rounding {rounding}", first.time);
            assert!((first.normal + DVec3::X).length() < 1e-9 && (first.approach - speed).abs() < 1e-4 * speed);
        }
    }
}

/// Without friction and with restitution 1, an impact conserves energy. Any impact conserves momentum and angular
/// momentum, except for the product of the gap between the two points of contact and a tangential impulse.
#[test]
fn impacts_keep_energy_and_momentum() {
    for (law, rounding) in [(Law::new(0.0, 1.0), 0.0), (Law::new(0.0, 1.0), 0.002), (Law::new(0.4, 0.6), 0.0)] {
        let edges: Vec<_> = (0..6).map(|k| (DVec3::new(0.016, 0.014 + 0.001 * f64::from(k), 0.02), rounding)).collect();
        let world = world(&edges, law, 0.0, Preset::Fine);
        for k in 0..10 {
            let mut stream = Seed(5).chain(0).at(k, Purpose::START);
            let starts: Vec<Start> = DieOnTable { edges: DVec3::splat(0.02), ..DieOnTable::default() }
                .throw_together(6, || open_unit(&mut stream))
                .into_iter()
                .map(|s| Start { velocity: s.velocity - s.position * 20.0, ..s })
                .collect();
            let sums = |state: &State<RigidBodyState>, time: f64| {
                let (mut energy, mut momentum, mut angular) = (0.0, DVec3::ZERO, DVec3::ZERO);
                for (k, b) in state.bodies().iter().enumerate() {
                    let b = world.at(k, b, time);
                    let mass = Shape::Cuboid(Cuboid::new(edges[k].0, rounding).unwrap()).mass_properties(1000.0);
                    energy += world.energy(k, &b);
                    momentum += b.path.v * mass.mass;
                    angular +=
                        b.path.x.cross(b.path.v) * mass.mass + b.turn * (mass.inertia * (b.turn.conjugate() * b.spin));
                }
                (energy, momentum, angular)
            };
            let mut state = world.state(&starts).unwrap();
            let before = sums(&state, 0.0);
            world.run(&mut state, &mut Scratch::default(), 0.2, &mut ()).unwrap();
            assert!(state.counts().impacts > 0);
            let after = sums(&state, state.time());
            let scale = 6.0 * 0.005 * 2.0;
            assert!((after.1 - before.1).length() < 1e-13 * scale, "{before:?} {after:?}");
            // A gap of 1e-6 of 7 mm, times at most the whole momentum, for each impact.
            assert!((after.2 - before.2).length() < 1e-8 * scale * state.counts().impacts as f64);
            if law.friction == 0.0 {
                assert!((after.0 / before.0 - 1.0).abs() < 1e-11, "{before:?} {after:?}");
            } else {
                assert!(after.0 < before.0);
            }
        }
    }
}

/// Where a die ends that is put down gently on the edge of another, with its middle `over` edges away from the other's.
fn put_on(over: f64, turn: f64) -> (State<RigidBodyState>, RigidWorld) {
    let world = dice(2, Law::new(0.4, 0.3));
    let upper =
        Start { orientation: DQuat::from_rotation_z(turn), ..Start::at_rest(DVec3::new(0.016 * over, 0.001, 0.0242)) };
    let mut state = world.state(&[Start::at_rest(DVec3::new(0.0, 0.0, 0.008)), upper]).unwrap();
    let outcome = world.run(&mut state, &mut Scratch::default(), 20.0, &mut ()).unwrap();
    assert_eq!(outcome, Outcome::AllAtRest, "over {over}, turned {turn}");
    (state, world)
}

#[test]
fn a_die_rests_on_another_while_its_middle_is_over_it() {
    for turn in [0.0, 0.3, 0.785] {
        for (over, stays) in [(0.0, true), (0.3, true), (0.47, true), (0.53, false), (0.7, false)] {
            let (state, world) = put_on(over, turn);
            let [lower, upper] = state.bodies() else { unreachable!() };
            assert_eq!((upper.path.x.z - 0.024).abs() < 1e-6, stays, "over {over}: {}", upper.path.x);
            let gap = world.gap([0, 1], [lower, upper]);
            if stays {
                // On it, not in it except for rounding, and not farther off than the preset's gap.
                assert!((-1e-16..=1e-5 * 0.008).contains(&gap), "{gap}");
                assert!((upper.turn * DVec3::Z).z > 1.0 - 1e-9);
                // Not a bit of drift in a minute.
                let later = world.at(1, upper, state.time() + 60.0);
                assert_eq!((later.path.x, later.turn), (upper.path.x, upper.turn));
            }
        }
    }
}

/// A body that rests on a die falls when the die is knocked away, and a die that is hit at rest moves.
#[test]
fn resting_bodies_wake() {
    let world = dice(3, Law::new(0.4, 0.3));
    let ball = Start { velocity: DVec3::X * 3.0, time: 1.0, ..Start::at_rest(DVec3::new(-0.05, 0.0, 0.0085)) };
    let lower = Start::at_rest(DVec3::new(0.0, 0.0, 0.008));
    let upper = Start::at_rest(DVec3::new(0.001, 0.0, 0.0242));
    let mut state = world.state(&[ball, lower, upper]).unwrap();
    world.run(&mut state, &mut Scratch::default(), 0.99, &mut ()).unwrap();
    assert!(state.bodies()[1..].iter().all(|b| b.phase == Phase::Rest));
    let outcome = world.run(&mut state, &mut Scratch::default(), 20.0, &mut ()).unwrap();
    assert_eq!(outcome, Outcome::AllAtRest);
    assert!(state.bodies()[1].path.x.x > 0.01 && state.bodies()[2].path.x.z < 0.02);
}

/// A die pushed along by another: both decelerate by μ g together, and come to rest `v²/(2 μ g)` later, face to face.
#[test]
fn a_die_pushes_another() {
    let (mu, v) = (0.2, 0.3);
    let world = dice(2, Law::new(mu, 0.0));
    let at = |x: f64| Start { velocity: DVec3::X * v, ..Start::at_rest(DVec3::new(x, 0.0, 0.008)) };
    // The second die stands still: the impact leaves both with half of the speed, and their common friction determines
    // the rest of the way.
    let mut state = world.state(&[at(0.0), Start::at_rest(DVec3::new(0.0161, 0.0005, 0.008))]).unwrap();
    let outcome = world.run(&mut state, &mut Scratch::default(), 5.0, &mut ()).unwrap();
    assert_eq!(outcome, Outcome::AllAtRest);
    let way = v * v / 4.0 / (2.0 * mu * 9.81);
    let moved = state.bodies()[1].path.x.x - 0.0161;
    // Not exactly central, and tilted a little by friction below: a tenth is allowed.
    assert!((moved / way - 1.0).abs() < 0.1, "{moved} for {way}");
}

/// The example counts many more. 5e-3 is five times the sag that a step of lasting contact may have half way (`SAG` in
/// the code of the steps).
#[test]
fn thrown_together_dice_end_at_rest_and_are_never_in_each_other() {
    for (bumps, throws) in [(0.0, 40), (0.1, 8)] {
        let die = DieOnTable { bumps, ..DieOnTable::default() };
        for k in 0..throws {
            let world = die.world_of(6, |i, j| ((i * 7 + j * 13) % 11) as f64 / 6.0 - 0.8).unwrap();
            let mut stream = Seed(9).chain(0).at(k, Purpose::START);
            let mut state = world.state(&die.throw_together(6, || open_unit(&mut stream))).unwrap();
            let mut overlaps = Overlaps::new(&world, &state);
            let outcome = world.run(&mut state, &mut Scratch::default(), 20.0, &mut overlaps).unwrap();
            assert_eq!(outcome, Outcome::AllAtRest, "throw {k} on bumps {bumps}");
            assert!(overlaps.worst < 5e-3 * 0.008, "{} m in throw {k} on bumps {bumps}", overlaps.worst);
        }
    }
}

#[test]
fn overlaps_at_the_start_are_named() {
    let world = dice(3, Law::new(0.4, 0.3));
    let at = |x: f64, z: f64| Start::at_rest(DVec3::new(x, 0.0, z));
    let error = world.state(&[at(0.0, 0.02), at(0.1, 0.02), at(0.115, 0.02)]).unwrap_err();
    assert!(
        matches!(error, WorldError::BodiesOverlap { a: 1, b: 2, depth } if (depth - 0.001).abs() < 1e-12),
        "{error}"
    );
    // Bodies that are released at another time are not there yet.
    let later = Start { time: 1.0, ..at(0.115, 0.02) };
    assert!(world.state(&[at(0.0, 0.02), at(0.1, 0.02), later]).is_ok());
    let sunk = world.state(&[at(0.0, 0.02), at(0.1, 0.007), at(0.2, 0.02)]).unwrap_err();
    assert!(matches!(sunk, WorldError::OverlapsScenery { body: 1, .. }), "{sunk}");
}
