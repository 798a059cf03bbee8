//! What many bodies in lasting contact cost: balls poured into a box, dominoes, shards, hulls in a bowl. The last three
//! are the worlds of the same names of `cargo xtask tradeoff`, with starts of their own.
//!
//!     cargo run --release -p plaus-sim --example heaps -- [balls|dominoes|shards|bowl|all] [number] [seconds] [preset]
//!
//! The number is that of balls, or of draws; the preset is for balls. Prints processor time, events, and how
//! deep bodies are in each other.
#![allow(clippy::print_stdout, reason = "a measuring program: it prints")]

mod measure;

use glam::{DQuat, DVec3};
use measure::{Digest, Stopwatch};
use plaus_dist::{Purpose, Seed, Stream, math, open_unit};
use plaus_sim::rigid::{BodySpec, RigidWorld, RigidWorldDesc, Start, StaticShape};
use plaus_sim::scenery::{Mesh, Plane};
use plaus_sim::shape::{Compound, Convex, ConvexHull, Cuboid, Member, Shape};
use plaus_sim::{Accuracy, Law, Laws, Material, Preset, Scratch};
use std::error::Error;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

type Made = Result<(RigidWorld, Vec<Start>), Box<dyn Error>>;

/// A world's name, how a draw of it is made, and its duration in s.
type World = (&'static str, fn(&mut Stream) -> Made, f64);

const M: Material = Material(0);

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let wanted = args.first().map_or("all", String::as_str);
    let number: Option<usize> = args.get(1).map(|a| a.parse()).transpose()?;
    let seconds: Option<f64> = args.get(2).map(|a| a.parse()).transpose()?;
    let preset = args.get(3).map(|a| Preset::ALL.into_iter().find(|p| p.name() == a).ok_or("no such preset"));
    let preset = preset.transpose()?.unwrap_or(Preset::Standard);
    let is_wanted = |name: &str| wanted == "all" || wanted == name;
    if is_wanted("balls") {
        let n = number.unwrap_or(100);
        run(&format!("{n} balls"), balls(n, preset)?, seconds.unwrap_or(0.2))?;
    }
    let worlds: [World; 3] = [("dominoes", dominoes, 4.0), ("shards", shards, 6.0), ("bowl", bowl, 6.0)];
    for (name, make, duration) in worlds.into_iter().filter(|w| is_wanted(w.0)) {
        for draw in 0..number.unwrap_or(2) {
            let mut stream = Seed(7).chain(4).at(draw as u64, Purpose::START);
            run(name, make(&mut stream)?, seconds.unwrap_or(duration))?;
        }
    }
    Ok(())
}

fn run(name: &str, (world, starts): (RigidWorld, Vec<Start>), until: f64) -> Result<(), Box<dyn Error>> {
    let mut state = world.state(&starts)?;
    let mut watch = Stopwatch::start();
    let outcome = watch.time(|| world.run(&mut state, &mut Scratch::default(), until, &mut ()))?;
    let spent = watch.mean();
    let ends: Vec<_> = state.bodies().iter().enumerate().map(|(k, b)| world.at(k, b, state.time())).collect();
    let count = ends.len() as f64;
    let mut deepest = ends.iter().enumerate().map(|(k, b)| world.depth(k, b)).fold(0.0, f64::max);
    for (k, a) in ends.iter().enumerate() {
        deepest = ends[..k].iter().enumerate().map(|(j, b)| -world.gap([j, k], [b, a])).fold(deepest, f64::max);
    }
    let mut digest = Digest::new();
    digest.add_all(ends.iter().flat_map(|b| b.path.x.to_array()));
    let height: f64 = ends.iter().map(|b| b.path.x.z).sum::<f64>() / count;
    let counts = state.counts();
    println!(
        "{name}: {:.1} ms of processor, {} events ({} impacts, {} ends of motions) in {:.3} s, {outcome:?}, {} links, \
         {:.2} mm high, {:.1e} m deep, {:016x}",
        1e3 * spent,
        counts.events,
        counts.impacts,
        counts.expiries,
        state.time(),
        state.links().len(),
        1e3 * height,
        deepest,
        digest.get()
    );
    Ok(())
}

fn world(bodies: Vec<BodySpec>, parts: Vec<StaticShape>, law: Law) -> Result<RigidWorld, Box<dyn Error>> {
    world_at(Preset::Standard, bodies, parts, law)
}

fn world_at(
    preset: Preset,
    bodies: Vec<BodySpec>,
    parts: Vec<StaticShape>,
    law: Law,
) -> Result<RigidWorld, Box<dyn Error>> {
    let (laws, accuracy) = (Laws::uniform(law)?, Accuracy::preset(preset));
    Ok(RigidWorld::new(RigidWorldDesc { bodies, parts, laws, accuracy, skin: 0.5, ..RigidWorldDesc::default() })?)
}

fn plane(at: DVec3, normal: DVec3) -> Result<StaticShape, Box<dyn Error>> {
    Ok(StaticShape::Plane(Plane::new(at, normal, M)?))
}

fn between(stream: &mut Stream, low: f64, high: f64) -> f64 {
    low + (high - low) * open_unit(stream)
}

fn three(stream: &mut Stream, most: f64) -> DVec3 {
    let mut one = || between(stream, -most, most);
    DVec3::new(one(), one(), one())
}

/// Balls of 10 mm radius, in layers of 7 × 7, that fall into a box of 200 × 200 mm.
fn balls(n: usize, preset: Preset) -> Made {
    let (r, half) = (0.01, 0.1);
    let mut parts = vec![plane(DVec3::ZERO, DVec3::Z)?];
    for n in [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y] {
        parts.push(plane(n * -half, n)?);
    }
    let law = Law::new(0.3, 0.5).with_resistance(0.01, 0.01);
    let world = world_at(preset, vec![BodySpec::solid(Shape::Ball(r), 2500.0, M); n], parts, law)?;
    let mut stream = Seed(7).chain(4).at(0, Purpose::START);
    let start = |k: usize| {
        let (layer, place) = (k / 49, k % 49);
        let at = DVec3::new((place % 7) as f64 - 3.0, (place / 7) as f64 - 3.0, layer as f64 + 1.0) * (2.4 * r);
        let jitter = three(&mut stream, 0.15 * r);
        Start::at_rest(at + jitter * DVec3::new(1.0, 1.0, 0.0))
    };
    Ok((world, (0..n).map(start).collect()))
}

/// A row of twenty, with gaps of 0.35 to 0.75 of the height; the first tips about its lower front edge.
fn dominoes(stream: &mut Stream) -> Made {
    let edges = DVec3::new(0.008, 0.024, 0.048);
    let spec = BodySpec::solid(Shape::Cuboid(Cuboid::new(edges, 0.0)?), 1200.0, M);
    let world = world(vec![spec; 20], vec![plane(DVec3::ZERO, DVec3::Z)?], Law::new(0.3, 0.2))?;
    let mut x = 0.0;
    let mut starts = Vec::new();
    for _ in 0..20 {
        let mut start = Start::at_rest(DVec3::new(x, 0.0, 0.5 * edges.z));
        start.orientation = DQuat::from_rotation_z(between(stream, -0.17, 0.17));
        starts.push(start);
        x += edges.x + between(stream, 0.35, 0.75) * edges.z;
    }
    let first = &mut starts[0];
    let (forward, across) = (first.orientation * DVec3::X, first.orientation * DVec3::Y);
    first.spin = across * between(stream, 12.0, 18.0);
    first.velocity = first.spin.cross(forward * (-0.5 * edges.x) + DVec3::Z * (0.5 * edges.z));
    Ok((world, starts))
}

/// Thirty bodies of three boxes each, from 1 m and higher onto a floor.
fn shards(stream: &mut Stream) -> Made {
    let edges = DVec3::new(0.022, 0.03, 0.005);
    let box_at = |side: f64| -> Result<Member, Box<dyn Error>> {
        let turn = DQuat::from_rotation_y(-0.5 * side);
        let at = DVec3::new(0.019 * side, 0.0, 0.005 * side.abs());
        Ok(Member { turn, ..Member::new(Convex::Cuboid(Cuboid::new(edges, 0.0)?), at) })
    };
    let shard = Compound::new(&[-1.0, 0.0, 1.0].into_iter().map(box_at).collect::<Result<Vec<_>, _>>()?)?;
    let spec = BodySpec::solid(Shape::from(shard), 2400.0, M);
    let world = world(vec![spec; 30], vec![plane(DVec3::ZERO, DVec3::Z)?], Law::new(0.4, 0.3))?;
    let start = |k: usize| {
        let (i, j, layer) = (k % 3, k / 3 % 2, k / 6);
        let place = DVec3::new(i as f64 - 1.0, j as f64 - 0.5, layer as f64) * 0.09 + DVec3::Z;
        let orientation = DQuat::from_scaled_axis(three(stream, 3.0));
        Start { position: place + three(stream, 0.005), orientation, spin: three(stream, 6.0), ..Start::at_rest(place) }
    };
    Ok((world, (0..30).map(start).collect()))
}

/// Twelve hulls of thirty corners over a bowl of triangles.
fn bowl(stream: &mut Stream) -> Made {
    let (radius, [up, around]) = (0.12, [12, 32]);
    let mut points = vec![DVec3::ZERO];
    for i in 1..=up {
        let (s, c) = math::sin_cos(FRAC_PI_2 * i as f64 / up as f64);
        points.extend((0..around).map(|j| {
            let (y, x) = math::sin_cos(TAU * j as f64 / around as f64);
            radius * DVec3::new(s * x, s * y, 1.0 - c)
        }));
    }
    let at = |i: usize, j: usize| if i == 0 { 0 } else { (1 + (i - 1) * around + j % around) as u32 };
    let mut triangles = Vec::new();
    for j in 0..around {
        for i in 0..up {
            triangles.push(([at(i, j), at(i + 1, j), at(i + 1, j + 1)], M));
            if i > 0 {
                triangles.push(([at(i, j), at(i + 1, j + 1), at(i, j + 1)], M));
            }
        }
    }
    let mesh = StaticShape::Mesh(Arc::new(Mesh::new(points, &triangles, 0.0)?));
    let spec = BodySpec::solid(Shape::Hull(Arc::new(ConvexHull::new(&corners(), 0.0)?)), 1000.0, M);
    let world = world(vec![spec; 12], vec![mesh, plane(DVec3::Z * -0.05, DVec3::Z)?], Law::new(0.4, 0.3))?;
    let start = |k: usize| {
        let (y, x) = math::sin_cos(FRAC_PI_2 * (k % 4) as f64);
        let place = DVec3::new(0.045 * x, 0.045 * y, 0.16 + 0.06 * (k / 4) as f64);
        let orientation = DQuat::from_scaled_axis(three(stream, 3.0));
        Start { position: place + three(stream, 0.006), orientation, spin: three(stream, 5.0), ..Start::at_rest(place) }
    };
    Ok((world, (0..12).map(start).collect()))
}

/// Thirty corners spread over an ellipsoid, each a little off its place.
fn corners() -> Vec<DVec3> {
    let mut stream = Seed(11).chain(0).at(0, Purpose::START);
    let corner = |k: usize| {
        let z = 1.0 - (2 * k + 1) as f64 / 30.0;
        let (s, c) = math::sin_cos(TAU * 0.381_966_011_250_105 * k as f64 + 0.2 * open_unit(&mut stream));
        let r = (1.0 - z * z).sqrt();
        DVec3::new(0.022, 0.018, 0.014) * DVec3::new(r * c, r * s, z)
    };
    (0..30).map(corner).collect()
}
