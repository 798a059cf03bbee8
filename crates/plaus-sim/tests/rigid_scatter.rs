//! Impacts that scatter: each has a normal and a restitution of its own, which make no energy and no momentum, leave
//! nothing that approaches, turn with the world, and have the law that they are said to have.

use crate::common::{G, M};
use crate::fuzz::meet::{in_space, meeting};
use crate::laws::checks::{self, Free};
use crate::laws::record::{Facts, Record, record_beside};
use crate::laws::twins;
use crate::laws::worlds::Dice;
use glam::{DQuat, DVec3};
use plaus_dist::{Purpose, Seed, math, standard_normal};
use plaus_sim::material::Scatter;
use plaus_sim::mechanics::{Impact, Other};
use plaus_sim::rigid::{
    BodySpec, ImpactName, ImpactScores, Joint, Partner, RigidBodyState, RigidWorld, RigidWorldDesc, Start, StaticShape,
};
use plaus_sim::scenery::Plane;
use plaus_sim::shape::{Cuboid, Shape};
use plaus_sim::trace::{Observer, While};
use plaus_sim::{Accuracy, Law, Laws, Preset, Scratch, State};
use std::sync::{Arc, Mutex};

/// Strong, so that impacts often leave a body that still approaches the surface.
const STRONG: Scatter = Scatter { tilt: 0.25, restitution: 0.5 };

/// Independent scores, for each impact and each seed.
fn scores(seed: u64) -> ImpactScores {
    ImpactScores::new(move |name| normal(seed, name))
}

fn normal(seed: u64, name: ImpactName) -> [f64; 3] {
    let other = match name.other {
        Partner::Body(k) => u64::from(k),
        Partner::Part(k) => 100 + u64::from(k),
    };
    let at = u64::from(name.body) << 40 | other << 24 | u64::from(name.ordinal);
    let mut stream = Seed(seed).chain(9).at(at, Purpose::START);
    std::array::from_fn(|_| standard_normal(&mut stream))
}

/// A world whose impacts scatter.
fn scattered(mut world: RigidWorldDesc, scatter: Scatter, scores: ImpactScores) -> RigidWorld {
    let law = world.laws.of(M, M).with_scatter(scatter);
    world.laws = Laws::uniform(law).unwrap();
    let mut world = RigidWorld::new(world).unwrap();
    world.scatter_by(scores);
    world
}

fn recorded(world: RigidWorldDesc, starts: &[Start], seed: u64, [until, most]: [f64; 2]) -> (Record, u32) {
    let facts = world.bodies.iter().map(Facts::new).collect();
    let about = (facts, world.gravity, world.accuracy);
    let world = scattered(world, STRONG, scores(seed));
    let mut state = world.state(starts).unwrap();
    let record = record_beside(&world, about, &mut state, [until, most], &mut ());
    (record, count(&world, &state))
}

/// How many impacts of a state scattered.
fn count(world: &RigidWorld, state: &State<RigidBodyState>) -> u32 {
    state.bodies().iter().flat_map(|body| world.scattered(body)).map(|(_, count)| count).sum()
}

/// Every pair of shapes, both moving, in space: momentum, angular momentum and energy. The twins: a record in which one
/// body is lighter by a thousandth, and one with a body that becomes faster. Beyond rounding, energy may grow by what
/// the impulses of several points leave undetermined: 1e-12 (`NO_IMPACT_ENERGY`) of the impulses times the speed, which
/// are up to twice the energy each of the two times that an impact is resolved.
#[test]
fn momentum_is_kept_and_energy_does_not_grow_in_space() {
    let (mut all, mut caught) = (0, [0, 0]);
    for seed in 0..169 {
        let world = in_space(seed, Preset::Reference);
        let (record, count) = recorded(world.rigid(), &world.starts(), seed, [world.until, 5_000.0]);
        all += count;
        let momentum = |record: &Record| {
            let [p, l] = checks::momentum(record, Free::Space);
            p.or(l)
        };
        let (p, found) = (momentum(&record), checks::energy(&record));
        assert!(!p.is_breach(), "seed {seed}: {p:?}");
        assert!(!found.is_breach() || found.size < 4e-12, "seed {seed}: {found:?}");
        let lighter = twins::scaled(&record, 1, 0.999).is_some_and(|twin| momentum(&twin).is_breach());
        let faster = twins::quickened(&record, 0, 0.01, checks::energy_bound(&record));
        caught[0] += u32::from(lighter);
        caught[1] += u32::from(faster.is_some_and(|twin| checks::energy(&twin).is_breach()));
    }
    assert!(all > 150 && caught.iter().all(|caught| *caught > 50), "{all} impacts, twins caught {caught:?}");
}

/// The same shapes over ground of every kind and against fixed solids, some in heaps: energy.
#[test]
fn energy_does_not_grow_over_ground() {
    let (mut all, mut caught) = (0, 0);
    for seed in 0..169 {
        let world = meeting(seed, Preset::Standard);
        let (record, count) = recorded(world.rigid(), &world.starts(), seed, [world.until, 9_000.0]);
        all += count;
        let found = checks::energy(&record);
        assert!(!found.is_breach(), "seed {seed}: {found:?}");
        let faster = twins::quickened(&record, 0, 0.01, checks::energy_bound(&record));
        caught += u32::from(faster.is_some_and(|twin| checks::energy(&twin).is_breach()));
    }
    assert!(all > 300 && caught > 50, "{all} impacts, {caught} twins caught");
}

/// Looks at how fast the two approach at each point that was struck, after all impacts of an event, over the fastest
/// speed; along the surfaces' normal, and along one that is tilted.
struct Approaches<'w> {
    world: &'w RigidWorld,
    now: Vec<Impact>,
    worst: [f64; 2],
    seen: u32,
}

impl Observer<RigidWorld> for Approaches<'_> {
    fn impact(&mut self, impact: &Impact) {
        self.now.push(*impact);
    }

    fn proceed(&mut self, state: &State<RigidBodyState>) -> bool {
        for hit in std::mem::take(&mut self.now) {
            let speed = |k: usize| {
                let body = self.world.at(k, &state.bodies()[k], hit.time);
                body.path.v + body.spin.cross(hit.point - body.path.x)
            };
            let (Other::Body(other), false) = (hit.other, hit.lasting) else { continue };
            let (a, b) = (speed(hit.body), speed(other));
            let fastest = a.length().max(b.length()).max(hit.approach);
            let across = (a - b - hit.normal * (a - b).dot(hit.normal)).normalize_or_zero();
            for (worst, normal) in self.worst.iter_mut().zip([hit.normal, (hit.normal - across * 0.3).normalize()]) {
                *worst = worst.max(-(a - b).dot(normal) / fastest);
            }
            self.seen += 1;
        }
        true
    }
}

/// Two bodies of every pair of shapes that meet in space part along the surfaces' normal, to ten times the approach
/// that counts as none (`GRAZE`). Along a normal that is tilted by 0.3 they do not.
#[test]
fn nothing_approaches_afterwards() {
    let (mut worst, mut seen) = ([0.0_f64; 2], 0);
    for seed in 0..169 {
        let world = in_space(seed, Preset::Fine);
        let rigid = scattered(world.rigid(), STRONG, scores(seed));
        let mut look = Approaches { world: &rigid, now: Vec::new(), worst: [0.0; 2], seen: 0 };
        let mut state = rigid.state(&world.starts()).unwrap();
        rigid.run(&mut state, &mut Scratch::default(), world.until, &mut look).unwrap();
        worst = [0, 1].map(|k| worst[k].max(look.worst[k]));
        seen += look.seen;
    }
    assert!(seen > 150 && worst[0] < 1e-9 && worst[1] > 0.05, "{worst:?} in {seen}");
}

/// How all bodies move after the first impact.
fn after_first(world: &RigidWorld, starts: &[Start]) -> Option<Vec<[DVec3; 2]>> {
    let mut state = world.state(starts).unwrap();
    let stop = &mut While(|state: &State<RigidBodyState>| state.counts().impacts == 0);
    world.run(&mut state, &mut Scratch::default(), 10.0, stop).unwrap();
    let motion = |(k, body): (usize, &RigidBodyState)| {
        let body = world.at(k, body, state.time());
        [body.path.v, body.spin]
    };
    (state.counts().impacts == 1 && count(world, &state) == 1)
        .then(|| state.bodies().iter().enumerate().map(motion).collect())
}

/// A world without gravity that is turned as a whole: what becomes of it turns likewise. Without scatter, the search
/// for the time at which bodies touch makes a difference of 3e-6 at most. The tilt adds to that where there is hardly
/// any slip, whose direction is then less well known: in one of fifty worlds, up to a hundredth. A twin in which the
/// tilt's two parts are exchanged is another motion in most worlds.
#[test]
fn a_turned_world_scatters_likewise() {
    let (mut compared, mut less_well, mut twins) = (0, 0, 0);
    for seed in 0..169 {
        let world = in_space(seed, Preset::Reference);
        let about = Dice::new(5, seed).turn();
        let turn = |start: &Start| Start {
            position: about * start.position,
            velocity: about * start.velocity,
            spin: about * start.spin,
            orientation: about * start.orientation,
            ..*start
        };
        let (starts, turned): (Vec<Start>, Vec<Start>) = world.starts().iter().map(|s| (*s, turn(s))).unzip();
        let swapped = ImpactScores::new(move |name| {
            let [along, across, part] = normal(seed, name);
            [across, along, part]
        });
        let [one, other, twin] = [(scores(seed), &starts), (scores(seed), &turned), (swapped, &turned)]
            .map(|(scores, starts)| after_first(&scattered(world.rigid(), STRONG, scores), starts));
        let (Some(one), Some(other), Some(twin)) = (one, other, twin) else { continue };
        let far = |b: &[[DVec3; 2]]| {
            let apart = one.iter().zip(b).map(|(a, b)| (about * a[0] - b[0]).length() / a[0].length().max(1e-9));
            apart.fold(0.0, f64::max)
        };
        compared += 1;
        less_well += u32::from(far(&other) > 1e-5);
        assert!(far(&other) < 1e-2, "seed {seed}: {}", far(&other));
        twins += u32::from(far(&twin) > 1e-2);
    }
    let told = format!("{less_well} of {compared} are off by more than 1e-5, {twins} twins differ");
    assert!(compared > 100 && less_well <= compared / 50 && twins > compared / 2, "{told}");
}

/// A ball that falls upon a plane at right angles, without gravity and friction, at full restitution.
fn ball_on_plane(normal: DVec3, velocity: DVec3, orientation: DQuat, law: Law) -> (RigidWorldDesc, Start) {
    let world = RigidWorldDesc {
        bodies: vec![BodySpec::solid(Shape::Ball(0.02), 1000.0, M)],
        parts: vec![StaticShape::Plane(Plane::new(DVec3::ZERO, normal, M).unwrap())],
        laws: Laws::uniform(law).unwrap(),
        gravity: DVec3::ZERO,
        accuracy: Accuracy::preset(Preset::Reference),
        ..RigidWorldDesc::default()
    };
    (world, Start { position: normal * 0.05, velocity, orientation, ..Start::at_rest(DVec3::ZERO) })
}

/// Where nothing slides, tilts are told from a direction that is fixed in the ball: it turns with the world, and with
/// the ball alone.
#[test]
fn without_slip_the_tilt_turns_with_the_body() {
    let mut dice = Dice::new(6, 0);
    for seed in 0..50 {
        let (about, own) = (dice.turn(), dice.turn());
        let after = |turn: DQuat, orientation: DQuat| {
            let n = turn * DVec3::Z;
            let (world, start) = ball_on_plane(n, n * -2.0, orientation, Law::new(0.3, 0.9));
            let tilt = Scatter { restitution: 0.0, ..STRONG };
            after_first(&scattered(world, tilt, scores(seed)), &[start]).unwrap()[0][0]
        };
        let plain = after(DQuat::IDENTITY, own);
        let apart = (about * plain - after(about, about * own)).length();
        assert!(apart < 1e-9, "seed {seed}: {apart}");
        // The axis that is most across the normal takes another one's place where it is turned far.
        let (small, axis) = (DQuat::from_rotation_z(0.2), own.conjugate() * DVec3::Z);
        if (0..3).map(|k| axis[k].abs()).fold(f64::INFINITY, f64::min) < 0.3 {
            let apart = (small * plain - after(DQuat::IDENTITY, small * own)).length();
            assert!(apart < 1e-9, "seed {seed}: {apart} with the ball alone");
        }
    }
}

/// Impacts whose law is known exactly: of a ball without friction that meets a plane, the normal is the direction in
/// which its velocity changes. Over 4,000 impacts the mean squares of the tilt's two parts and of the restitution's are
/// those of their laws, and the means and products are 0, within 5.2 standard errors (a false alarm in 5·10⁶). Twins:
/// tilts and restitutions that are larger by a fifth.
#[test]
fn tilts_and_restitutions_have_their_laws() {
    let n = 4_000;
    let measured = |scatter: Scatter| {
        let (mut sums, mut squares, mut product) = ([0.0; 3], [0.0; 3], 0.0);
        for seed in 0..n {
            let slanted = DVec3::new(0.8, 0.0, -2.0);
            let tilt = Scatter { restitution: 0.0, ..scatter };
            let (world, start) = ball_on_plane(DVec3::Z, slanted, DQuat::IDENTITY, Law::new(0.0, 0.9));
            let after = after_first(&scattered(world, tilt, scores(seed)), &[start]).unwrap()[0][0];
            let normal = (after - slanted).normalize();
            let angle = math::acos(normal.z.clamp(-1.0, 1.0));
            let way = normal.truncate().normalize_or_zero() * angle;
            let (world, start) = ball_on_plane(DVec3::Z, DVec3::Z * -2.0, DQuat::IDENTITY, Law::new(0.0, 0.5));
            let rebound = Scatter { tilt: 0.0, ..scatter };
            let after = after_first(&scattered(world, rebound, scores(seed)), &[start]).unwrap()[0][0];
            for (k, value) in [way.x, way.y, after.z / 2.0 / 0.5 - 1.0].into_iter().enumerate() {
                sums[k] += value;
                squares[k] += value * value;
            }
            product += way.x * way.y;
        }
        (sums.map(|sum| sum / n as f64), squares.map(|sum| sum / n as f64), product / n as f64)
    };
    let said = Scatter { tilt: 0.05, restitution: 0.1 };
    let (means, squares, product) = measured(said);
    let sds = [0.05, 0.05, 0.1];
    let is_right = |squares: [f64; 3]| {
        [0, 1, 2].map(|k| (squares[k] / (sds[k] * sds[k]) - 1.0).abs() < 5.2 * (2.0 / n as f64).sqrt())
    };
    assert_eq!(is_right(squares), [true; 3], "{squares:?}");
    assert!((0..3).all(|k| means[k].abs() < 5.2 * sds[k] / (n as f64).sqrt()), "{means:?}");
    assert!(product.abs() < 5.2 * 0.05 * 0.05 / (n as f64).sqrt(), "{product}");
    let (_, wide, _) = measured(Scatter { tilt: 0.06, restitution: 0.12 });
    assert_eq!(is_right(wide), [false; 3], "{wide:?}");
}

/// A box that lands flat is struck at four points at once, each of which has its own name, and turns away; without
/// scatter it rises as it came.
#[test]
fn a_face_has_an_impact_at_each_corner() {
    let shape = Shape::Cuboid(Cuboid::new(DVec3::new(0.06, 0.05, 0.04), 0.0).unwrap());
    let world = RigidWorldDesc {
        bodies: vec![BodySpec::solid(shape, 1000.0, M)],
        parts: vec![StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, M).unwrap())],
        laws: Laws::uniform(Law::new(0.3, 0.6)).unwrap(),
        gravity: DVec3::Z * -G,
        ..RigidWorldDesc::default()
    };
    let start = Start::at_rest(DVec3::Z * 0.3);
    let names = Arc::new(Mutex::new(Vec::new()));
    let told = Arc::clone(&names);
    let listens = ImpactScores::new(move |name| {
        told.lock().unwrap().push((name.body, name.other, name.ordinal));
        normal(3, name)
    });
    for (scatter, points) in [(STRONG, 4), (Scatter::default(), 0)] {
        names.lock().unwrap().clear();
        let world = scattered(world.clone(), scatter, listens.clone());
        let mut state = world.state(&[start]).unwrap();
        let stop = &mut While(|state: &State<RigidBodyState>| state.counts().impacts == 0);
        world.run(&mut state, &mut Scratch::default(), 1.0, stop).unwrap();
        let expected: Vec<_> = (0..points).map(|k| (0, Partner::Part(0), k)).collect();
        assert_eq!(*names.lock().unwrap(), expected);
        assert_eq!(count(&world, &state), points);
        let body = world.at(0, &state.bodies()[0], state.time());
        let (is_turned, is_moved) = (body.spin.length() > 0.1, body.path.v.truncate().length() > 0.01);
        assert_eq!((is_turned, is_moved), (points > 0, points > 0), "{body:?}");
        assert!(body.path.v.z > 0.0);
    }
}

/// Two bodies in space that a ball joint holds together and a third one strikes: no energy is made but for the steps'
/// error (a thousandth, the standard preset's), and momentum is kept to rounding of steps.
#[test]
fn impacts_through_joints_scatter_too() {
    let bar = || {
        let shape = Shape::Cuboid(Cuboid::new(DVec3::new(0.02, 0.02, 0.1), 0.0).unwrap());
        BodySpec::solid(shape, 1000.0, M)
    };
    for seed in 0..30 {
        let mut dice = Dice::new(8, seed);
        let world = RigidWorldDesc {
            bodies: vec![bar(), bar(), BodySpec::solid(Shape::Ball(0.02), 1000.0, M)],
            laws: Laws::uniform(Law::new(0.3, 0.7).with_scatter(STRONG)).unwrap(),
            gravity: DVec3::ZERO,
            accuracy: Accuracy::preset(Preset::Standard),
            ..RigidWorldDesc::default()
        };
        let facts: Vec<Facts> = world.bodies.iter().map(Facts::new).collect();
        let about = (facts, world.gravity, world.accuracy);
        let mut rigid = RigidWorld::new(world).unwrap();
        let starts = [
            Start::at_rest(DVec3::Z * 0.05),
            Start::at_rest(DVec3::Z * -0.05),
            Start {
                velocity: DVec3::new(-1.0, 0.0, 0.0),
                spin: dice.in_cube() * 20.0,
                ..Start::at_rest(DVec3::new(0.1, 0.0, 0.03 + 0.04 * dice.between(0.0, 1.0)))
            },
        ];
        rigid.join(Joint::ball(DVec3::ZERO, 0, &starts[0]).to(1, &starts[1])).unwrap();
        rigid.scatter_by(scores(seed));
        let mut state = rigid.state(&starts).unwrap();
        let before = state.bodies().iter().enumerate().map(|(k, b)| rigid.energy(k, b)).sum::<f64>();
        let record = record_beside(&rigid, about, &mut state, [0.15, 2_000.0], &mut ());
        assert!(count(&rigid, &state) > 0, "seed {seed}: no impact");
        let after = |k: usize| rigid.energy(k, &rigid.at(k, &state.bodies()[k], state.time()));
        let after: f64 = (0..3).map(after).sum();
        assert!(after <= before * (1.0 + 1e-3), "seed {seed}: {before} J to {after} J");
        let sum = |at: usize| -> DVec3 {
            (0..3)
                .map(|k| {
                    record.facts[k].mass * record.moments[k][if at == 0 { 0 } else { record.moments[k].len() - 1 }].v
                })
                .sum()
        };
        let (first, last) = (sum(0), sum(1));
        assert!((first - last).length() < 1e-9 * first.length(), "seed {seed}: {first} to {last}");
    }
}

/// A world without scores, or without scatter, is what it was, bit for bit; with both it is not.
#[test]
fn nothing_scatters_where_nothing_says_so() {
    let mut differ = 0;
    for seed in 0..40 {
        let world = meeting(seed, Preset::Standard);
        let ends = |rigid: &RigidWorld| {
            let mut state = rigid.state(&world.starts()).unwrap();
            rigid
                .run(
                    &mut state,
                    &mut Scratch::default(),
                    world.until,
                    &mut While(|s: &State<_>| s.counts().events < 2_000),
                )
                .unwrap();
            state.bodies().iter().map(|b| [b.path.x, b.path.v, b.spin]).collect::<Vec<_>>()
        };
        let plain = ends(&RigidWorld::new(world.rigid()).unwrap());
        let mut silent = world.rigid();
        silent.laws = Laws::uniform(silent.laws.of(M, M).with_scatter(STRONG)).unwrap();
        assert_eq!(ends(&RigidWorld::new(silent).unwrap()), plain, "seed {seed}: without scores");
        assert_eq!(
            ends(&scattered(world.rigid(), Scatter::default(), scores(seed))),
            plain,
            "seed {seed}: without scatter"
        );
        differ += u32::from(ends(&scattered(world.rigid(), STRONG, scores(seed))) != plain);
    }
    assert!(differ > 20, "{differ} of 40 worlds scatter");
}

/// A state that is written down after some impacts and read again goes on with the same bits: it holds how many impacts
/// each pair has had. A twin that forgets them goes on otherwise.
#[test]
fn a_state_holds_its_impacts() {
    let world = RigidWorldDesc {
        bodies: vec![BodySpec::solid(Shape::Ball(0.02), 1000.0, M); 2],
        parts: vec![StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, M).unwrap())],
        laws: Laws::uniform(Law::new(0.3, 0.8)).unwrap(),
        gravity: DVec3::Z * -G,
        ..RigidWorldDesc::default()
    };
    let world = scattered(world, Scatter { tilt: 0.05, restitution: 0.1 }, scores(1));
    let starts = [DVec3::new(0.0, 0.0, 0.2), DVec3::new(0.005, 0.0, 0.3)].map(Start::at_rest);
    let mut state = world.state(&starts).unwrap();
    world.run(&mut state, &mut Scratch::default(), 0.6, &mut ()).unwrap();
    assert!(count(&world, &state) > 1);
    let saved = serde_json::to_string(&state).unwrap();
    let forgets = saved.replace("\"scattered\":[[", "\"scattered\":[],\"forgotten\":[[");
    assert_ne!(saved, forgets);
    world.run(&mut state, &mut Scratch::default(), 1.5, &mut ()).unwrap();
    let goes_on = |text: &str| {
        let mut state: State<RigidBodyState> = serde_json::from_str(text).unwrap();
        world.run(&mut state, &mut Scratch::default(), 1.5, &mut ()).unwrap();
        state.bodies()[1].path.x
    };
    assert_eq!(goes_on(&saved), state.bodies()[1].path.x);
    assert_ne!(goes_on(&forgets), state.bodies()[1].path.x);
}
