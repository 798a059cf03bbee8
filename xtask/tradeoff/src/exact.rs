//! Cases with an exact answer: a ball that slides until it rolls, and one that bounces.

use crate::world::Way;
use glam::DVec3;
use plaus_figures::Result;
use plaus_figures::report::table;
use plaus_sim::marbles::{MarbleSpec, MarbleWorld, Marbles, Start};
use plaus_sim::scenery::{Mesh, Plane, Scenery};
use plaus_sim::{Accuracy, Law, Laws, Material, Preset, Scratch};
use rapier3d_f64::prelude as peer;

const G: f64 = 9.81;
const RADIUS: f64 = 0.1;

struct Case {
    name: &'static str,
    friction: f64,
    restitution: f64,
    start: DVec3,
    velocity: DVec3,
    until: f64,
    exact: f64,
    measured: fn(DVec3) -> f64,
}

fn cases() -> [Case; 2] {
    let (v, mu, until) = (3.0, 0.2, 2.0);
    let (t, x) = (2.0 * v / (7.0 * mu * G), 12.0 * v * v / (49.0 * mu * G));
    let (h, e, fifth) = (1.0, 0.5_f64, 1.0);
    let fall = (2.0 * h / G).sqrt();
    // Height after the first bounce and the second, at one second.
    let (up, first) = (e * G * fall, fall + 2.0 * e * fall);
    let height = if fifth < first {
        up * (fifth - fall) - 0.5 * G * (fifth - fall) * (fifth - fall)
    } else {
        e * up * (fifth - first) - 0.5 * G * (fifth - first) * (fifth - first)
    };
    [
        Case {
            name: "slide, then roll: way after 2 s",
            friction: mu,
            restitution: 0.5,
            start: DVec3::Z * RADIUS,
            velocity: DVec3::X * v,
            until,
            exact: x + 5.0 / 7.0 * v * (until - t),
            measured: |p| p.x,
        },
        Case {
            name: "bounce from 1 m: height after 1 s",
            friction: 0.0,
            restitution: e,
            start: DVec3::Z * (RADIUS + h),
            velocity: DVec3::ZERO,
            until: fifth,
            exact: height,
            measured: |p| p.z - RADIUS,
        },
    ]
}

/// A table of relative errors.
pub(crate) fn report() -> Result<String> {
    let cases = cases();
    let mut head = vec!["simulator"];
    head.extend(cases.iter().map(|c| c.name));
    let mut rows = Vec::new();
    let presets = Preset::ALL.into_iter().rev().map(Way::Preset);
    for way in presets.chain([60.0, 240.0, 1000.0].map(Way::Peer)) {
        let mut cells = vec![way.name()];
        for case in &cases {
            let found = (case.measured)(if let Way::Peer(rate) = way { by_peer(case, rate) } else { ours(case, way)? });
            cells.push(format!("{:.1e}", ((found - case.exact) / case.exact).abs()));
        }
        rows.push(cells);
    }
    Ok(table(&head, rows))
}

fn ours(case: &Case, way: Way) -> Result<DVec3> {
    let Way::Preset(preset) = way else { return Err("not a preset".into()) };
    let world = Marbles::new(MarbleWorld {
        specs: vec![MarbleSpec::solid(RADIUS, 1.0, Material(0))],
        laws: Laws::uniform(Law::new(case.friction, case.restitution))?,
        scenery: Scenery::new(
            vec![Plane::new(DVec3::ZERO, DVec3::Z, Material(0))?],
            Mesh::new(Vec::new(), &[], 0.0)?,
            Vec::new(),
            RADIUS,
        )?,
        gravity: DVec3::new(0.0, 0.0, -G),
        accuracy: Accuracy::preset(preset),
        duration: 10.0,
    })?;
    let mut state = world.state(&[Start { velocity: case.velocity, ..Start::at_rest(case.start) }])?;
    world.run(&mut state, &mut Scratch::default(), case.until, &mut ())?;
    Ok(state.bodies()[0].path.at(case.until))
}

fn by_peer(case: &Case, rate: f64) -> DVec3 {
    let gravity = peer::Vector::new(0.0, 0.0, -G);
    let mut world = peer::PhysicsWorld { gravity, ..Default::default() };
    world.integration_parameters.dt = 1.0 / rate;
    let floor = peer::ColliderBuilder::cuboid(20.0, 20.0, 1.0)
        .translation(peer::Vector::new(0.0, 0.0, -1.0))
        .friction(case.friction)
        .restitution(case.restitution);
    world.colliders.insert(floor);
    let (x, v) = (case.start, case.velocity);
    let body = peer::RigidBodyBuilder::dynamic()
        .translation(peer::Vector::new(x.x, x.y, x.z))
        .linvel(peer::Vector::new(v.x, v.y, v.z))
        .ccd_enabled(true);
    let handle = world.bodies.insert(body);
    let ball = peer::ColliderBuilder::ball(RADIUS).friction(case.friction).restitution(case.restitution);
    world.colliders.insert_with_parent(ball, handle, &mut world.bodies);
    for _ in 0..(case.until * rate).round() as u64 {
        world.step();
    }
    let p = world.bodies[handle].translation();
    DVec3::new(p.x, p.y, p.z)
}
