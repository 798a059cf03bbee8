//! Cases with an exact answer: a ball that slides until it rolls, one that bounces, and two swings that keep their
//! energy.

use crate::peer::{CastPeer, GRAVITY};
use crate::staged::{Setting, build};
use crate::world::Way;
use crate::worlds::{Cradle, Pendulum};
use glam::DVec3;
use plaus_dist::{Purpose, Seed};
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

/// A table of relative errors of all presets, and of the peer at its rates.
pub(crate) fn report(rates: &[f64]) -> Result<String> {
    let cases = cases();
    let swings: [(&str, &dyn Setting); 2] = [("cradle", &Cradle), ("double pendulum", &Pendulum)];
    let mut head = vec!["simulator".to_owned()];
    head.extend(cases.iter().map(|c| c.name.to_owned()));
    head.extend(swings.iter().map(|(name, _)| format!("{name}: energy within 10 s")));
    let mut rows = Vec::new();
    let presets = Preset::ALL.into_iter().rev().map(Way::Preset);
    for way in presets.chain(rates.iter().copied().map(Way::Peer)) {
        let mut cells = vec![way.name()];
        for case in &cases {
            let found = (case.measured)(if let Way::Peer(rate) = way { by_peer(case, rate) } else { ours(case, way)? });
            cells.push(format!("{:.1e}", ((found - case.exact) / case.exact).abs()));
        }
        for (_, setting) in swings {
            cells.push(format!("{:.1e}", drift(setting, way)?));
        }
        rows.push(cells);
    }
    Ok(table(&head.iter().map(String::as_str).collect::<Vec<_>>(), rows))
}

/// Largest change of energy within 10 s, seen every 0.05 s, over what the bodies have above their lowest places.
fn drift(setting: &dyn Setting, way: Way) -> Result<f64> {
    let cast = setting.cast()?;
    let starts = setting.starts(&mut Seed(7).chain(4).at(0, Purpose::START));
    let times = (1..=200).map(|k| f64::from(k) / 20.0);
    let mass: f64 = cast.bodies.iter().map(|(spec, _)| spec.mass.mass).sum();
    let low = mass * GRAVITY * setting.lowest();
    let energies: Vec<f64> = match way {
        Way::Preset(preset) => {
            let world = build(&cast, preset, 10.0)?;
            let (mut state, mut scratch) = (world.state(&starts)?, Scratch::default());
            let mut at = |time: f64| -> Result<f64> {
                world.run(&mut state, &mut scratch, time, &mut ())?;
                // Each at its own clock, the end of its last step; between the ends, bodies are on chords.
                let bodies = state.bodies().iter().enumerate();
                Ok(bodies.map(|(k, body)| world.energy(k, body)).sum())
            };
            std::iter::once(0.0).chain(times).map(&mut at).collect::<Result<_>>()?
        }
        Way::Peer(rate) => {
            let mut peer = CastPeer::new(&cast, &starts, rate);
            let mut at = |time: f64| {
                peer.run_to(time);
                peer.energy(&cast)
            };
            std::iter::once(0.0).chain(times).map(&mut at).collect()
        }
    };
    let from = energies[0];
    Ok(energies.iter().map(|e| (e - from).abs()).fold(0.0, f64::max) / (from - low).abs())
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
