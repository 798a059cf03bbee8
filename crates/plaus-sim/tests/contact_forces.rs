//! The contacts that are told carry what the bodies weigh: over random stacks, lintels, leaning, wedged, pressed and
//! sleeping bodies of many shapes, at every preset.

use crate::common::zoo::{Dice, G, M};
use glam::{DQuat, DVec3};
use plaus_dist::math;
use plaus_sim::marbles::{MarbleSpec, MarbleWorld, Marbles};
use plaus_sim::mechanics::{ContactForce, Island, Mechanics, Other};
use plaus_sim::rigid::{
    BodySpec, Forces, Phase, RigidScratch, RigidWorld, RigidWorldDesc, Start, StaticShape, StaticSolid,
};
use plaus_sim::scenery::{Mesh, Plane, Scenery, Surface};
use plaus_sim::shape::{ConvexHull, Cuboid, Frustum, Shape};
use plaus_sim::trace::Observer;
use plaus_sim::{Accuracy, Law, Laws, Outcome, Preset, Scratch};
use std::collections::BTreeMap;
use std::sync::Arc;

#[path = "common/contact_scenes.rs"]
mod scenes;
use scenes::*;

/// Force and torque over the weight, and the weight times the reach, that may be missing. Static equilibrium is found
/// to a velocity of 1e-6 g times the kick, and loads below 1e-6 of the weight are not told: of up to ten points each.
const MISSING: f64 = 1e-5;

/// What a pair carries from when on, told by an island that has settled.
#[derive(Debug, Clone)]
struct Told {
    pair: (usize, Partner),
    points: Vec<ContactForce>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Partner {
    Body(usize),
    Part(u32),
}

fn partner(other: Other) -> Partner {
    match other {
        Other::Body(body) => Partner::Body(body),
        Other::Surface(Surface::Part { part, .. } | Surface::Spot { part, .. }) => Partner::Part(u32::from(part)),
        Other::Surface(Surface::Plane(plane)) => Partner::Part(plane),
        Other::Surface(other) => panic!("{other:?} in a world without it"),
    }
}

/// How a listener may be wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Twin {
    None,
    /// Of all that a body touches, it keeps only what is told first.
    OnePartner,
    /// It keeps only one point of each pair.
    OnePoint,
}

/// Keeps what bears on what now, and when each pair was first told.
struct Listener<M: Mechanics> {
    work: M::Scratch,
    twin: Twin,
    now: Vec<Told>,
    first: BTreeMap<(usize, Partner), f64>,
}

impl<M: Mechanics> Listener<M> {
    fn new(twin: Twin) -> Self {
        Self { work: M::Scratch::default(), twin, now: Vec::new(), first: BTreeMap::new() }
    }
}

impl<M: Mechanics> Observer<M> for Listener<M> {
    fn settled(&mut self, mechanics: &M, island: &Island<'_, M>) {
        let time = mechanics.clock(&island.bodies[island.members[0] as usize]);
        let mut told: BTreeMap<(usize, Partner), Vec<ContactForce>> = BTreeMap::new();
        let twin = self.twin;
        mechanics.contact_forces(island, &mut self.work, &mut |force| {
            let pair = (force.body, partner(force.other));
            let known = told.keys().any(|other| other.0 == pair.0 && *other != pair);
            let points = if twin == Twin::OnePartner && known { return } else { told.entry(pair).or_default() };
            if twin != Twin::OnePoint || points.is_empty() {
                points.push(*force);
            }
        });
        let concerns = |(body, other): (usize, Partner), k: usize| body == k || other == Partner::Body(k);
        let concerned: Vec<usize> = island.members.iter().map(|&k| k as usize).collect();
        let again = |pair| concerned.iter().any(|&k| concerns(pair, k)) || told.contains_key(&pair);
        self.now.retain(|old| !again(old.pair));
        for (pair, points) in told {
            self.first.entry(pair).or_insert(time);
            self.now.push(Told { pair, points });
        }
    }
}

impl<M: Mechanics> Listener<M> {
    /// The force and the torque on a body that is at `x`.
    fn on(&self, body: usize, x: DVec3) -> [DVec3; 2] {
        let mut sum = [DVec3::ZERO; 2];
        for point in self.now.iter().flat_map(|told| &told.points) {
            let sign = if point.body == body {
                1.0
            } else if point.other == Other::Body(body) {
                -1.0
            } else {
                continue;
            };
            sum[0] += point.force * sign;
            sum[1] += (point.point - x).cross(point.force * sign);
        }
        sum
    }
}

/// What is wrong with what a run tells.
#[derive(Debug, Default)]
struct Faults {
    /// Bodies at rest whose contacts do not carry them, and how many were looked at.
    uncarried: Vec<String>,
    carried: u32,
    /// Pairs that are not told from the first moment.
    late: Vec<String>,
    /// Points that are farther apart than the preset's gap.
    apart: Vec<String>,
    /// The most that was missing.
    most: f64,
}

fn check(scene: &Scene, preset: Preset, twin: Twin, name: &str, faults: &mut Faults) {
    let accuracy = Accuracy::preset(preset);
    let mut world = RigidWorld::new(RigidWorldDesc {
        bodies: scene.bodies.clone(),
        parts: scene.parts.clone(),
        laws: Laws::uniform(Law::new(scene.friction, 0.2).with_resistance(1e-3, 1e-3)).unwrap(),
        accuracy,
        ..RigidWorldDesc::default()
    })
    .unwrap();
    let last = scene.bodies.len() - 1;
    world.act_on(last, Forces { force: scene.force, ..Forces::default() }).unwrap();
    let mut state = world.state(&scene.starts).unwrap();
    for body in (0..=last).filter(|_| scene.asleep) {
        world.put_to_sleep(&mut state, body).unwrap();
    }
    let mut scratch = Scratch::<RigidScratch>::default();
    let mut listener = Listener::<RigidWorld>::new(twin);
    let outcome = world.run(&mut state, &mut scratch, 1.0, &mut listener).unwrap();
    assert!(matches!(outcome, Outcome::AllAtRest | Outcome::TimeReached), "{name}: {outcome:?}");
    for pair in &scene.bear {
        match listener.first.get(pair) {
            // Two bodies that start together meet when the upper one has fallen by less than the gap at which they
            // touch.
            Some(since) if *since <= (2.0 * accuracy.gap * scene.bodies[pair.0].shape.reach() / G).sqrt() => {}
            other => faults.late.push(format!("{name}: {pair:?} {other:?}")),
        }
    }
    for (k, (spec, body)) in scene.bodies.iter().zip(state.bodies()).enumerate() {
        if body.phase != Phase::Rest {
            continue;
        }
        let (reach, weight) = (spec.shape.reach(), spec.mass.mass * G);
        let [force, torque] = listener.on(k, body.path.x);
        let own = DVec3::NEG_Z * weight + if k == last { scene.force } else { DVec3::ZERO };
        let missing = (force + own).length().max(torque.length() / reach) / own.length();
        faults.carried += 1;
        faults.most = faults.most.max(missing);
        if missing > MISSING {
            faults.uncarried.push(format!("{name}, body {k}: {missing:e}"));
        }
    }
    for point in listener.now.iter().flat_map(|told| &told.points) {
        let other =
            if let Other::Body(other) = point.other { scene.bodies[other].shape.reach() } else { f64::INFINITY };
        // A body's size is at most its reach. In groups of three or more, points that are 50 gaps farther belong to the
        // contacts (`contacts.rs`), and may be what holds them.
        let most = accuracy.gap * if last < 2 { 1.0 } else { 51.0 };
        let size = scene.bodies[point.body].shape.reach().min(other);
        if point.gap > most * size {
            faults.apart.push(format!("{name}: {:e} over {:e}", point.gap, most * size));
        }
    }
}

type Make = fn(&mut Dice) -> Scene;

const KINDS: [(&str, Make, u64); 6] = [
    ("stack", Scene::stack, 12),
    ("sleepers", Scene::sleepers, 6),
    ("lintel", Scene::lintel, 12),
    ("ladder", Scene::ladder, 6),
    ("groove", Scene::groove, 10),
    ("pressed", Scene::pressed, 10),
];

fn faults(twin: Twin, presets: &[Preset]) -> Faults {
    let mut faults = Faults::default();
    for (kind, make, count) in KINDS {
        for nth in 0..count {
            for preset in presets {
                let scene = make(&mut Dice::new(45, nth));
                check(&scene, *preset, twin, &format!("{kind} {nth} {preset:?}"), &mut faults);
            }
        }
    }
    faults
}

#[test]
fn contacts_that_are_told_carry_what_bodies_weigh() {
    let found = faults(Twin::None, &Preset::ALL);
    println!("{} at rest, {:e} missing at most", found.carried, found.most);
    assert!(found.uncarried.is_empty(), "{} of {}: {:#?}", found.uncarried.len(), found.carried, found.uncarried);
    assert!(found.late.is_empty(), "{:#?}", found.late);
    assert!(found.apart.is_empty(), "{:#?}", found.apart);
    // Most of what is made stays at rest.
    assert!(found.carried > 300, "{}", found.carried);
}

/// Who leaves out the second contact of a body, or all but one point of a pair, is found out.
#[test]
fn contacts_that_are_left_out_are_missed() {
    for twin in [Twin::OnePartner, Twin::OnePoint] {
        let found = faults(twin, &[Preset::Standard]);
        assert!(found.uncarried.len() > 20, "{twin:?}: {} of {}", found.uncarried.len(), found.carried);
    }
    assert!(faults(Twin::OnePartner, &[Preset::Standard]).late.len() > 20);
}

/// Within steps of lasting contact, what is told is what changes the momentum: of a box that slides along a wall and a
/// floor, at every preset. The velocity at a step's end is that of the motion after it.
#[test]
fn forces_of_moving_bodies_change_their_momentum() {
    struct Steps<'w> {
        world: &'w RigidWorld,
        listener: Listener<RigidWorld>,
        mass: f64,
        force: DVec3,
        worst: f64,
        count: u32,
    }
    impl Observer<RigidWorld> for Steps<'_> {
        fn settled(&mut self, mechanics: &RigidWorld, island: &Island<'_, RigidWorld>) {
            self.listener.settled(mechanics, island);
            let body = &island.bodies[0];
            if body.phase != Phase::Step {
                return;
            }
            let end = mechanics.expiry(body);
            let [before, after] = [body.path.t, end].map(|time| self.world.at(0, body, time).path.v);
            let wanted = (after - before) * (self.mass / (end - body.path.t)) - self.force;
            let [told, _] = self.listener.on(0, body.path.x);
            self.worst = self.worst.max((told - wanted).length() / self.force.length());
            self.count += 1;
        }
    }
    for preset in Preset::ALL {
        for nth in 0..10 {
            let scene = Scene::pressed(&mut Dice::new(45, nth));
            let mut world = RigidWorld::new(RigidWorldDesc {
                bodies: scene.bodies.clone(),
                parts: scene.parts.clone(),
                laws: Laws::uniform(Law::new(scene.friction, 0.2)).unwrap(),
                accuracy: Accuracy::preset(preset),
                ..RigidWorldDesc::default()
            })
            .unwrap();
            world.act_on(0, Forces { force: scene.force, ..Forces::default() }).unwrap();
            let start = Start { velocity: DVec3::Y * 0.3, ..scene.starts[0] };
            let mut state = world.state(&[start]).unwrap();
            let mass = scene.bodies[0].mass.mass;
            let force = scene.force + DVec3::NEG_Z * G * mass;
            let listener = Listener::new(Twin::None);
            let mut steps = Steps { world: &world, listener, mass, force, worst: 0.0, count: 0 };
            world.run(&mut state, &mut Scratch::default(), 0.05, &mut steps).unwrap();
            assert!(steps.count > 0, "{preset:?} {nth}");
            // What is too small to be told, as above.
            assert!(steps.worst < MISSING, "{preset:?} {nth}: {:e} in {} steps", steps.worst, steps.count);
        }
    }
}

/// Marbles that come to rest in heaps between walls are carried too, at every preset. The twin leaves out what a marble
/// touches besides one thing.
#[test]
fn heaps_of_marbles_are_carried() {
    let (mut at_rest, mut missed_by_twin) = (0, 0);
    for preset in Preset::ALL {
        for nth in 0..6 {
            let mut dice = Dice::new(45, nth);
            let count = 1 + below(&mut dice, 5);
            let specs: Vec<MarbleSpec> = (0..count)
                .map(|_| {
                    let radius = dice.between(0.008, 0.012);
                    MarbleSpec::solid(radius, 2500.0 * 4.0 * radius * radius * radius, M)
                })
                .collect();
            let walls = [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y].map(|n| Plane::new(n * -0.025, n, M).unwrap());
            let mut planes = vec![Plane::new(DVec3::ZERO, DVec3::Z, M).unwrap()];
            planes.extend(walls);
            let world = Marbles::new(MarbleWorld {
                specs: specs.clone(),
                laws: Laws::uniform(Law::new(0.4, 0.3).with_resistance(0.02, 0.02)).unwrap(),
                scenery: Scenery::new(planes, Mesh::default(), Vec::new(), 0.012).unwrap(),
                accuracy: Accuracy::preset(preset),
                ..MarbleWorld::default()
            })
            .unwrap();
            let starts: Vec<plaus_sim::marbles::Start> = (0..count)
                .map(|k| {
                    let at = DVec3::new(dice.between(-0.01, 0.01), dice.between(-0.01, 0.01), 0.02 + 0.03 * k as f64);
                    plaus_sim::marbles::Start::at_rest(at)
                })
                .collect();
            for twin in [Twin::None, Twin::OnePartner] {
                let mut state = world.state(&starts).unwrap();
                let mut listener = Listener::<Marbles>::new(twin);
                let outcome = world.run(&mut state, &mut Scratch::default(), 5.0, &mut listener).unwrap();
                if outcome != Outcome::AllAtRest {
                    continue;
                }
                for (k, (spec, body)) in specs.iter().zip(state.bodies()).enumerate() {
                    let [force, _] = listener.on(k, body.path.x);
                    let missing = (force / spec.mass + DVec3::NEG_Z * G).length() / G;
                    if twin == Twin::None {
                        at_rest += 1;
                        assert!(missing < MISSING, "{preset:?} {nth}, marble {k}: {missing:e}");
                    } else {
                        missed_by_twin += u32::from(missing > MISSING);
                    }
                }
            }
        }
    }
    assert!(at_rest > 40 && missed_by_twin > 10, "{at_rest} {missed_by_twin}");
}
