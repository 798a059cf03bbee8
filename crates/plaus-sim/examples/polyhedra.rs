//! Throws a d4, a d8, a d20 and a random rock onto a flat and a bumpy table, each alone and then all together. Prints
//! how they fell and what that cost. The first throw of all together is written as JSON, with all its motions and
//! impacts, the corners and faces of the bodies, and where these are among the points from which the bodies were made.
//!
//! `cargo run --release -p plaus-sim --example polyhedra -- [throws] [bumps] [--trace PATH]`
#![allow(clippy::print_stdout, reason = "a measuring program: it prints")]

mod measure;

use glam::{DQuat, DVec3};
use measure::{Digest, Stopwatch, arguments, noise, write_trace};
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_sim::field::{Grid, Spline};
use plaus_sim::rigid::{BodySpec, RigidBodyState, RigidWorld, RigidWorldDesc, Start, StaticShape, Table};
use plaus_sim::scenery::Plane;
use plaus_sim::shape::{ConvexHull, Shape, Solid};
use plaus_sim::trace::Trace;
use plaus_sim::worlds::DieOnTable;
use plaus_sim::{Accuracy, Law, Laws, Material, Outcome, Scratch, WorldError};
use serde::Serialize;
use std::error::Error;
use std::sync::Arc;

const MATERIAL: Material = Material(0);

/// Distance of opposite faces of a cube of the same size, in m.
const EDGE: f64 = 0.016;

fn main() -> Result<(), Box<dyn Error>> {
    let (args, path) = arguments("target/polyhedra.json")?;
    let throws: u64 = args.first().map_or(Ok(300), |a| a.parse())?;
    let bumps: f64 = args.get(1).map_or(Ok(0.1), |a| a.parse())?;
    let bodies = [
        ("d4", solid(Solid::Tetrahedron)?),
        ("d8", solid(Solid::Octahedron)?),
        ("d20", solid(Solid::Icosahedron)?),
        ("rock", rock()?),
    ];
    let all: Vec<_> = bodies.iter().map(|b| Arc::clone(&b.1)).collect();
    println!(
        "{:>5} {:>6} {:>8} {:>8} {:>8} {:>7} {:>8} {:>6} {:>6}  {:<16}  faces down, most often first",
        "body", "bumps", "median", "90 %", "cpu/thr", "events", "impacts", "rest", "other", "digest"
    );
    for bumps in [0.0, bumps] {
        for (name, hull) in &bodies {
            row(name, &[Arc::clone(hull)], bumps, throws)?;
        }
        row("all", &all, bumps, throws)?;
    }
    let world = world(&all, 0.0)?;
    let mut state = world.state(&starts(all.len(), 0))?;
    let mut trace = Trace::default();
    let outcome = world.run(&mut state, &mut Scratch::default(), 20.0, &mut trace)?;
    let bodies = bodies.iter().map(|(name, hull)| Drawn::new(name, hull)).collect();
    let (motions, impacts) = (trace.motions.iter().map(Vec::len).sum::<usize>(), trace.impacts.len());
    write_trace(&path, &Written { bodies, trace })?;
    println!("wrote {path}: {motions} motions and {impacts} impacts, {outcome:?} at {:.3} s", state.time());
    Ok(())
}

/// With an insphere as large as that of a cube with the usual edge.
fn solid(solid: Solid) -> Result<Arc<ConvexHull>, WorldError> {
    let unit = Arc::new(ConvexHull::new(&solid.corners(1.0), 0.0)?);
    let size = Shape::Hull(Arc::clone(&unit)).size();
    Ok(Arc::new(ConvexHull::new(&solid.corners(0.5 * EDGE / size), 0.0)?))
}

/// The hull of points in an ellipsoid, slightly rounded.
fn rock() -> Result<Arc<ConvexHull>, WorldError> {
    let mut stream = Seed(4).chain(0).at(0, Purpose::START);
    let mut side = || 2.0 * open_unit(&mut stream) - 1.0;
    let mut points = Vec::new();
    while points.len() < 40 {
        let p = DVec3::new(side(), side(), side());
        if p.length() <= 1.0 {
            points.push(p * DVec3::new(0.9, 0.7, 0.5) * EDGE);
        }
    }
    Ok(Arc::new(ConvexHull::new(&points, 0.05 * EDGE)?))
}

fn world(bodies: &[Arc<ConvexHull>], bumps: f64) -> Result<RigidWorld, WorldError> {
    let table = if bumps > 0.0 {
        let spacing = 0.5 * EDGE;
        let spread = bumps * spacing;
        let grid = Grid { origin: [0.0; 2], spacing };
        let height = Spline::new("height", grid, [-8.0 * spread, 8.0 * spread], move |i, j| spread * noise(i, j))?;
        StaticShape::Table(Box::new(Table::new(height, MATERIAL)))
    } else {
        StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, MATERIAL)?)
    };
    RigidWorld::new(RigidWorldDesc {
        bodies: bodies.iter().map(|h| BodySpec::solid(Shape::Hull(Arc::clone(h)), 1200.0, MATERIAL)).collect(),
        parts: vec![table],
        laws: Laws::uniform(Law::new(0.35, 0.5))?,
        gravity: DVec3::new(0.0, 0.0, -9.81),
        accuracy: Accuracy::default(),
        skin: 1.0,
        sink: f64::NEG_INFINITY,
        duration: 20.0,
    })
}

/// Thrown as dice are, with room for the largest body.
fn starts(bodies: usize, throw: u64) -> Vec<Start> {
    let mut stream = Seed(1).chain(0).at(throw, Purpose::START);
    let die = DieOnTable { edges: DVec3::splat(2.0 * EDGE), ..DieOnTable::default() };
    match bodies {
        1 => vec![die.throw(|| open_unit(&mut stream))],
        _ => die.throw_together(bodies, || open_unit(&mut stream)),
    }
}

/// The face that points down most steeply.
fn down(hull: &ConvexHull, body: &RigidBodyState) -> usize {
    let height = |k: usize| hull.normal(k).map_or(0.0, |n| (body.turn * n).z);
    (0..hull.faces().count()).fold(0, |low, k| if height(k) < height(low) { k } else { low })
}

fn row(name: &str, bodies: &[Arc<ConvexHull>], bumps: f64, throws: u64) -> Result<(), WorldError> {
    let (mut scratch, mut watch, mut digest) = (Scratch::default(), Stopwatch::start(), Digest::new());
    let (mut events, mut impacts, mut rest) = (0, 0, 0);
    let mut faces = vec![0; bodies[0].faces().count()];
    for throw in 0..throws {
        let starts = starts(bodies.len(), throw);
        let (state, outcome) = watch.time(|| {
            let world = world(bodies, bumps)?;
            let mut state = world.state(&starts)?;
            let outcome = world.run(&mut state, &mut scratch, 20.0, &mut ())?;
            Ok::<_, WorldError>((state, outcome))
        })?;
        events += state.counts().events;
        impacts += state.counts().impacts;
        rest += u64::from(outcome == Outcome::AllAtRest);
        for body in state.bodies() {
            digest.add_all(body.path.x.to_array().into_iter().chain(body.turn.to_array()));
        }
        faces[down(&bodies[0], &state.bodies()[0])] += 1;
    }
    faces.sort_unstable_by(|a, b| b.cmp(a));
    let faces: Vec<String> = faces.iter().take(8).map(ToString::to_string).collect();
    println!(
        "{name:>5} {bumps:>6} {:>6.1}us {:>6.1}us {:>6.1}us {:>7.1} {:>8.1} {rest:>6} {:>6}  {:016x}  {}",
        1e6 * watch.quantile(0.5),
        1e6 * watch.quantile(0.9),
        1e6 * watch.mean(),
        events as f64 / throws as f64,
        impacts as f64 / throws as f64,
        throws - rest,
        digest.get(),
        if bodies.len() == 1 { faces.join(" ") } else { String::new() }
    );
    Ok(())
}

/// A body in a form that can be drawn: its trace gives the centre of gravity and the orientation of these axes.
#[derive(Serialize)]
struct Drawn {
    name: String,
    corners: Vec<DVec3>,
    faces: Vec<Vec<u8>>,
    rounding: f64,
    centre: DVec3,
    turn: DQuat,
}

impl Drawn {
    fn new(name: &str, hull: &ConvexHull) -> Self {
        Self {
            name: name.into(),
            corners: hull.corners().to_vec(),
            faces: hull.faces().map(<[u8]>::to_vec).collect(),
            rounding: hull.rounding(),
            centre: hull.centre(),
            turn: hull.turn(),
        }
    }
}

#[derive(Serialize)]
struct Written {
    bodies: Vec<Drawn>,
    trace: Trace<RigidBodyState>,
}
