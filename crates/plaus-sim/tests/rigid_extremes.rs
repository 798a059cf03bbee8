//! Turning bodies with extreme numbers: energy never grows, nothing becomes NaN, every run ends in an outcome; and
//! worlds that must behave the same to the last bit.

use crate::common::turning::same_when_relabelled;
use glam::{DQuat, DVec3};
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_sim::rigid::{BodySpec, RigidBodyState, RigidWorld, RigidWorldDesc, Start, StaticShape};
use plaus_sim::scenery::Plane;
use plaus_sim::shape::{Cuboid, Shape};
use plaus_sim::trace::Observer;
use plaus_sim::worlds::DieOnTable;
use plaus_sim::{Accuracy, Law, Laws, Material, Outcome, Preset, Scratch, State};

const M: Material = Material(0);
const G: f64 = 9.81;

fn cuboid(edges: DVec3, rounding: f64, density: f64) -> BodySpec {
    BodySpec::solid(Shape::Cuboid(Cuboid::new(edges, rounding).unwrap()), density, M)
}

fn ball(radius: f64, density: f64) -> BodySpec {
    BodySpec::solid(Shape::Ball(radius), density, M)
}

fn world(bodies: Vec<BodySpec>, law: Law) -> RigidWorldDesc {
    RigidWorldDesc {
        bodies,
        parts: vec![StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, M).unwrap())],
        laws: Laws::uniform(law).unwrap(),
        gravity: DVec3::new(0.0, 0.0, -G),
        accuracy: Accuracy { events: 400, ..Accuracy::preset(Preset::Standard) },
        skin: 1.0,
        sink: f64::NEG_INFINITY,
        duration: 4.0,
    }
}

/// Sums the bodies' energies whenever the time has moved on, each at its own clock: flight conserves energy, and the
/// bodies of a group share a clock.
struct Energy<'w> {
    world: &'w RigidWorld,
    each: Vec<f64>,
    time: f64,
    last: f64,
    /// By how much a sum may seem to grow.
    slack: f64,
}

impl Observer<RigidWorld> for Energy<'_> {
    fn motion(&mut self, index: usize, body: &RigidBodyState) {
        assert!(body.path.x.is_finite() && body.path.v.is_finite() && body.turn.is_finite() && body.spin.is_finite());
        if body.path.t > self.time {
            let sum: f64 = self.each.iter().sum();
            assert!(sum <= self.last + self.slack, "{} to {sum} at {}, may be {}", self.last, self.time, self.slack);
            (self.last, self.time) = (sum, body.path.t);
        }
        self.each[index] = self.world.energy(index, body);
    }
}

/// Runs a world to its end and checks what must always hold.
fn check(world: RigidWorldDesc, starts: &[Start]) -> State<RigidBodyState> {
    let specs: Vec<(f64, f64)> = world.bodies.iter().map(|b| (b.mass.mass, b.shape.reach())).collect();
    let world = RigidWorld::new(world).unwrap();
    let mut state = world.state(starts).unwrap();
    let each: Vec<f64> = state.bodies().iter().enumerate().map(|(k, b)| world.energy(k, b)).collect();
    // The error of a step of lasting contact, as in `common/laws/checks.rs`: a twentieth of the step's square at the
    // standard preset.
    let scale: f64 = specs.iter().map(|(m, r)| m * G * r).sum::<f64>() * (0.4 * 0.4 / 20.0);
    let slack = scale + 1e-12 * each.iter().map(|e| e.abs()).sum::<f64>();
    let mut energy = Energy { world: &world, each, time: 0.0, last: f64::INFINITY, slack };
    let outcome = world.run(&mut state, &mut Scratch::default(), 4.0, &mut energy).unwrap();
    assert!(!matches!(outcome, Outcome::NotFinite { .. } | Outcome::Stopped), "{outcome:?}");
    state
}

/// Two dice and a ball, one above the other, turned and spinning.
fn three(size: f64) -> (Vec<BodySpec>, Vec<Start>) {
    let edges = DVec3::splat(2.0 * size);
    let bodies = vec![cuboid(edges, 0.0, 1000.0), ball(size, 1000.0), cuboid(edges, 0.3 * size, 1000.0)];
    let starts = [(0.0, 2.5), (0.2, 5.5), (-0.3, 8.5)].map(|(x, z)| Start {
        orientation: DQuat::from_xyzw(0.1 * z, 0.3, -0.2, 0.7),
        spin: DVec3::new(3.0, -1.0, 2.0) * (0.01 / size).sqrt(),
        ..Start::at_rest(DVec3::new(x, 0.1 * x, z) * size)
    });
    (bodies, starts.to_vec())
}

#[test]
fn restitution_and_friction_of_every_size() {
    for e in [0.0, 1e-8, 0.5, 1.0] {
        for mu in [0.0, 1e-8, 0.3, 1e8] {
            let (bodies, starts) = three(0.01);
            check(world(bodies, Law::new(mu, e)), &starts);
        }
    }
}

#[test]
fn mass_ratio_of_a_million() {
    for heavy in 0..3 {
        for e in [0.0, 0.5] {
            let (mut bodies, starts) = three(0.01);
            bodies[heavy].mass = bodies[heavy].mass.with_mass(bodies[heavy].mass.mass * 1e6);
            check(world(bodies, Law::new(0.3, e)), &starts);
        }
    }
}

#[test]
fn sizes_from_a_tenth_of_a_millimetre_to_a_hundred_metres() {
    for size in [1e-4, 1e-2, 1.0, 1e2] {
        let (bodies, starts) = three(size);
        check(world(bodies, Law::new(0.3, 0.5)), &starts);
    }
    // All together: a grain, a crate, a house.
    let bodies = [1e-4, 1.0, 1e2].map(|s| cuboid(DVec3::splat(2.0 * s), 0.0, 1000.0)).to_vec();
    let at = |x: f64, z: f64| Start {
        orientation: DQuat::from_xyzw(0.1, 0.2, 0.0, 1.0),
        ..Start::at_rest(DVec3::new(x, 0.0, z))
    };
    check(world(bodies, Law::new(0.3, 0.5)), &[at(0.0, 4.0), at(0.0, 2.0), at(-180.0, 190.0)]);
}

#[test]
fn speeds_up_to_a_kilometre_per_second() {
    for speed in [0.0, 1e-9, 1.0, 1e3] {
        let (bodies, mut starts) = three(0.1);
        for (k, s) in starts.iter_mut().enumerate() {
            s.velocity = DVec3::new(0.1, 0.0, if k == 0 { 1.0 } else { -1.0 }) * speed;
            s.spin = DVec3::ONE * speed;
        }
        check(world(bodies, Law::new(0.3, 0.5)), &starts);
    }
}

#[test]
fn no_body_at_all() {
    let state = check(world(Vec::new(), Law::new(0.3, 0.5)), &[]);
    assert_eq!(state.counts().events, 0);
}

#[test]
fn a_die_exactly_on_an_edge_and_on_a_corner() {
    let die = || vec![cuboid(DVec3::splat(0.02), 0.0, 1000.0)];
    let half = std::f64::consts::FRAC_PI_8;
    let edge = DQuat::from_xyzw(plaus_dist::math::sin(half), 0.0, 0.0, plaus_dist::math::cos(half));
    let corner = DQuat::from_rotation_arc(DVec3::ONE.normalize(), DVec3::Z);
    for (turn, height) in [(edge, 0.01 * 2.0_f64.sqrt()), (corner, 0.01 * 3.0_f64.sqrt())] {
        for above in [1e-7, 0.05] {
            let start = Start { orientation: turn, ..Start::at_rest(DVec3::Z * (height + above)) };
            check(world(die(), Law::new(0.3, 0.5)), &[start]);
        }
    }
}

/// Four dice fly face to face into a fifth at once, which stands exactly on the table: all at the same instant, with
/// all faces parallel.
#[test]
fn exactly_simultaneous_impacts() {
    for e in [0.0, 0.5, 1.0] {
        for mu in [0.0, 0.3] {
            let bodies = vec![cuboid(DVec3::splat(0.02), 0.0, 1000.0); 5];
            let starts = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (0.0, 0.0)].map(|(x, y)| Start {
                velocity: DVec3::new(-x, -y, 0.0),
                ..Start::at_rest(DVec3::new(0.05 * x, 0.05 * y, 0.01))
            });
            check(world(bodies, Law::new(mu, e)), &starts);
        }
    }
}

/// Lengths × 4, times × 2: every number of the result is that of the small world, scaled exactly.
#[test]
fn scaling_keeps_the_bits_of_dice_that_meet() {
    for bumps in [0.0, 0.1] {
        for k in 0..6 {
            let run = |scale: f64, time: f64| {
                let die = DieOnTable { edges: DVec3::splat(0.016 * scale), bumps, ..DieOnTable::default() };
                let world = die.world_of(4, |i, j| ((i * 7 + j * 13) % 11) as f64 / 6.0 - 0.8).unwrap();
                let mut stream = Seed(21).chain(0).at(k, Purpose::START);
                let starts: Vec<Start> = DieOnTable::default()
                    .throw_together(4, || open_unit(&mut stream))
                    .into_iter()
                    .map(|s| Start {
                        position: s.position * scale,
                        velocity: s.velocity * (scale / time),
                        spin: s.spin / time,
                        ..s
                    })
                    .collect();
                let mut state = world.state(&starts).unwrap();
                world.run(&mut state, &mut Scratch::default(), 20.0, &mut ()).unwrap();
                let places: Vec<_> = state.bodies().iter().map(|b| (b.path.x / scale, b.turn)).collect();
                (places, state.time() / time, state.counts())
            };
            assert_eq!(run(1.0, 1.0), run(4.0, 2.0), "throw {k} on bumps {bumps}");
        }
    }
}

/// Two relabelled bodies do the same to the last bit. With more bodies, each other's stale predictions decide where a
/// search starts, and it ends anywhere within the preset's gap.
#[test]
fn relabelling_permutes_flights_and_impacts() {
    let mut impacts = 0;
    for k in 0..40 {
        let edges = [DVec3::new(0.014, 0.016, 0.018), DVec3::new(0.02, 0.015, 0.02)];
        let world = |order: [usize; 2]| {
            let bodies = order.iter().map(|&b| cuboid(edges[b], 0.001 * b as f64, 1000.0)).collect();
            let world = world(bodies, Law::new(0.3, 0.8));
            RigidWorld::new(RigidWorldDesc { parts: Vec::new(), gravity: DVec3::ZERO, ..world }).unwrap()
        };
        let mut stream = Seed(23).chain(0).at(k, Purpose::START);
        let thrown = DieOnTable { edges: DVec3::splat(0.02), ..DieOnTable::default() }
            .throw_together(2, || open_unit(&mut stream));
        let starts = [0, 1].map(|b| Start { velocity: thrown[b].velocity - thrown[b].position * 10.0, ..thrown[b] });
        impacts += same_when_relabelled(world, starts, 0.15, &format!("throw {k}"));
    }
    assert!(impacts > 20, "{impacts}");
}

/// A pile that is saved while it moves goes on to the same bits.
#[test]
fn a_saved_pile_goes_on_to_the_same_bits() {
    let die = DieOnTable::default();
    let world = die.world_of(6, |_, _| 0.0).unwrap();
    let mut stream = Seed(25).chain(0).at(0, Purpose::START);
    let starts = die.throw_together(6, || open_unit(&mut stream));
    let mut whole = world.state(&starts).unwrap();
    world.run(&mut whole, &mut Scratch::default(), 20.0, &mut ()).unwrap();
    for pause in [0.1, 0.3, 0.4] {
        let mut state = world.state(&starts).unwrap();
        world.run(&mut state, &mut Scratch::default(), pause, &mut ()).unwrap();
        let saved = serde_json::to_string(&state).unwrap();
        let mut state: State<RigidBodyState> = serde_json::from_str(&saved).unwrap();
        world.run(&mut state, &mut Scratch::default(), 20.0, &mut ()).unwrap();
        for (a, b) in whole.bodies().iter().zip(state.bodies()) {
            assert_eq!((a.path.x, a.turn, whole.time()), (b.path.x, b.turn, state.time()), "paused at {pause}");
        }
    }
}

/// Faults of a world or a start are named before any stepping.
#[test]
fn bad_numbers_are_named() {
    use plaus_sim::WorldError::{BadBody, BadNumber, BadSurface, BodiesOverlap, OverlapsScenery};
    use plaus_sim::rigid::Section;
    use plaus_sim::scenery::Aabb;
    let good = || world(vec![ball(0.1, 1.0), cuboid(DVec3::splat(0.2), 0.0, 1.0)], Law::new(0.3, 0.5));
    let with = |change: &dyn Fn(&mut RigidWorldDesc)| {
        let mut world = good();
        change(&mut world);
        RigidWorld::new(world).map(|_| ())
    };
    assert!(with(&|_| ()).is_ok());
    for mass in [-1.0, 0.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(with(&|w| w.bodies[1].mass.mass = mass), Err(BadBody { body: 1, field: "mass", .. })));
        assert!(matches!(with(&|w| w.bodies[1].mass.inertia.y = mass), Err(BadBody { body: 1, field: "inertia", .. })));
    }
    assert!(matches!(
        with(&|w| w.bodies[0].shape = Shape::Ball(f64::NAN)),
        Err(BadBody { body: 0, field: "reach", .. })
    ));
    assert!(matches!(with(&|w| w.gravity.x = f64::NAN), Err(BadNumber { field: "gravity", .. })));
    assert!(matches!(with(&|w| w.sink = f64::NAN), Err(BadNumber { field: "sink", .. })));
    assert!(matches!(with(&|w| w.duration = f64::NAN), Err(BadNumber { field: "duration", .. })));
    assert!(matches!(with(&|w| w.accuracy.gap = f64::NAN), Err(BadNumber { field: "gap", .. })));
    let plane = |normal, offset| StaticShape::Plane(Plane { normal, offset, material: M });
    assert!(matches!(with(&|w| w.parts.push(plane(DVec3::Z, f64::NAN))), Err(BadSurface { field: "offset", .. })));
    assert!(matches!(with(&|w| w.parts.push(plane(DVec3::NAN, 0.0))), Err(BadSurface { .. })));
    let block = |high: f64, friction: f64| StaticShape::Block {
        bounds: Aabb { min: DVec3::NEG_ONE, max: DVec3::new(1.0, 1.0, high) },
        material: M,
        sections: vec![Section { from: 0.0, friction: Some(friction) }],
    };
    assert!(with(&|w| w.parts.push(block(0.0, 0.1))).is_ok());
    for (high, friction) in [(f64::NAN, 0.1), (-2.0, 0.1), (0.0, -0.1), (0.0, f64::NAN)] {
        let error = with(&|w| w.parts.push(block(high, friction))).unwrap_err();
        assert!(matches!(&error, BadSurface { surface: plaus_sim::SurfaceId::Part(1), .. }), "{error}");
    }
    let world = RigidWorld::new(good()).unwrap();
    let at = |x: f64, z: f64| Start::at_rest(DVec3::new(x, 0.0, z));
    let starts = |a: Start, b: Start| world.state(&[a, b]).map(|_| ());
    assert!(starts(at(0.0, 0.5), at(0.3, 0.5)).is_ok());
    assert!(matches!(starts(at(0.0, 0.5), at(0.15, 0.5)), Err(BodiesOverlap { a: 0, b: 1, .. })));
    assert!(matches!(starts(at(0.0, 0.5), at(0.0, 0.5)), Err(BodiesOverlap { a: 0, b: 1, .. })));
    assert!(matches!(starts(at(0.0, 0.5), at(0.3, 0.05)), Err(OverlapsScenery { body: 1, .. })));
    let broken = |change: &dyn Fn(&mut Start)| {
        let mut start = at(0.3, 0.5);
        change(&mut start);
        starts(at(0.0, 0.5), start)
    };
    assert!(matches!(broken(&|s| s.velocity.z = f64::NAN), Err(BadBody { body: 1, field: "velocity", .. })));
    assert!(matches!(broken(&|s| s.spin.x = f64::INFINITY), Err(BadBody { body: 1, field: "spin", .. })));
    assert!(matches!(broken(&|s| s.time = -1.0), Err(BadBody { body: 1, field: "start time", .. })));
}
