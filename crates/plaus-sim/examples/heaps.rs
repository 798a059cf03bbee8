//! What crowds of bodies in lasting contact cost, and whether their laws hold: dominoes, shards, hulls in a bowl, a
//! seesaw, a pyramid with gaps and without, a tower, an arch, balls poured into a box. Dominoes, shards, bowl and
//! seesaw are the worlds of the same names of `cargo xtask tradeoff`, with starts of their own.
//!
//!     cargo run --release -p plaus-sim --example heaps -- [world|all] [draws] [preset|both] [repeats] [crowd]
//!
//! Without arguments: one draw of the dominoes. Prints for each world and preset the mean over the draws of: processor
//! time (the least of the repeats; also its median and the longest), events, motions, the time at the end, how many
//! draws came to rest, the mean height of the bodies and their mean distance from the middle, each with its standard
//! error, the deepest overlap over the smaller size at the end, the largest rise of energy over the bodies' weights
//! times their sizes, and of rows of equal dominoes the error of the wave's speed. `crowd`, at least 4, takes the
//! place of the preset's.
#![allow(clippy::print_stdout, reason = "a measuring program: it prints")]

mod measure;

use glam::{DQuat, DVec3};
use measure::{Digest, Stopwatch};
use plaus_dist::{Purpose, Seed, Stream, math, open_unit};
use plaus_sim::mechanics::{Impact, Other};
use plaus_sim::rigid::{BodySpec, Joint, RigidBodyState, RigidWorld, RigidWorldDesc, Start, StaticShape};
use plaus_sim::scenery::{Mesh, Plane};
use plaus_sim::shape::{Compound, Convex, ConvexHull, Cuboid, Member, Shape};
use plaus_sim::trace::Observer;
use plaus_sim::{Accuracy, Law, Laws, Material, Outcome, Preset, Scratch, State};
use std::error::Error;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

type Made = Result<((RigidWorld, Vec<BodySpec>), Vec<Start>), Box<dyn Error>>;

/// A world's name, how a draw of it is made at an accuracy, and its duration in s.
type World = (&'static str, fn(&mut Stream, Accuracy) -> Made, f64);

const M: Material = Material(0);
const G: f64 = 9.81;

const WORLDS: [World; 13] = [
    ("dominoes", dominoes, 4.0),
    ("bowl", bowl, 6.0),
    ("shards", shards, 6.0),
    ("seesaw", seesaw, 4.0),
    ("pyramid", |s, p| pyramid(s, p, 0.0), 3.0),
    ("gaps", |s, p| pyramid(s, p, 0.01), 3.0),
    ("tower", tower, 3.0),
    ("arch", arch, 3.0),
    ("balls", |s, p| balls(s, p, 300), 1.5),
    ("100 balls", |s, p| balls(s, p, 100), 1.5),
    ("row 0.1", |_, p| row(p, 0.1), 3.0),
    ("row 0.3", |_, p| row(p, 0.3), 3.0),
    ("row 0.5", |_, p| row(p, 0.5), 3.0),
];

/// Speeds of waves of dominoes over √(g h), for gaps over the height, found in small steps (the example `truths`).
const WAVES: [(&str, f64, f64); 3] = [("row 0.1", 0.1, 1.166), ("row 0.3", 0.3, 1.433), ("row 0.5", 0.5, 1.310)];

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let wanted = args.first().map_or("dominoes", String::as_str);
    let draws: usize = args.get(1).map_or(Ok(1), |a| a.parse())?;
    let presets = match args.get(2).map_or("both", String::as_str) {
        "both" => vec![Preset::Draft, Preset::Standard],
        name => vec![Preset::ALL.into_iter().find(|p| p.name() == name).ok_or("no such preset")?],
    };
    let repeats: usize = args.get(3).map_or(Ok(1), |a| a.parse())?;
    let crowd: Option<u32> = args.get(4).map(|a| a.parse()).transpose()?;
    println!(
        "{:<10} {:<9} {:>9} {:>8} {:>8} {:>7} {:>8} {:>6} {:>7} {:>13} {:>13} {:>8} {:>8} {:>7}",
        "world",
        "preset",
        "ms",
        "median",
        "longest",
        "events",
        "motions",
        "s",
        "rest",
        "z, mm",
        "r, mm",
        "overlap",
        "rise",
        "wave"
    );
    let is_wanted = |name: &str| wanted == "all" || name.starts_with(wanted);
    for world in WORLDS.iter().filter(|w| is_wanted(w.0)) {
        for &preset in &presets {
            let of_one = if world.0.starts_with("row") { 1 } else { draws };
            let all: Result<Vec<Found>, _> =
                (0..of_one).map(|draw| run(world, draw as u64, (preset, crowd), repeats)).collect();
            tell(world.0, preset, &all?);
        }
    }
    Ok(())
}

/// What a run came to.
struct Found {
    spent: f64,
    events: f64,
    motions: f64,
    time: f64,
    rests: bool,
    height: f64,
    distance: f64,
    deepest: f64,
    rise: f64,
    wave: f64,
    digest: u64,
}

fn tell(name: &str, preset: Preset, all: &[Found]) {
    let mean = |of: fn(&Found) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
    let most = |of: fn(&Found) -> f64| all.iter().map(of).fold(0.0, f64::max);
    let with_error = |of: fn(&Found) -> f64| {
        let (mean, n) = (mean(of), all.len() as f64);
        let squares: f64 = all.iter().map(|f| (of(f) - mean) * (of(f) - mean)).sum();
        format!("{:.2}±{:.2}", 1e3 * mean, 1e3 * (squares / (n * (n - 1.0).max(1.0))).sqrt())
    };
    let mut spent: Vec<f64> = all.iter().map(|f| f.spent).collect();
    spent.sort_unstable_by(f64::total_cmp);
    println!(
        "{name:<10} {:<9} {:>9.2} {:>8.1} {:>8.1} {:>7.0} {:>8.0} {:>6.3} {:>3}/{:<3} {:>13} {:>13} {:>8.1e} \
         {:>8.1e} {:>6.2}% {:016x}",
        preset.name(),
        1e3 * mean(|f| f.spent),
        1e3 * spent[spent.len() / 2],
        1e3 * spent[spent.len() - 1],
        mean(|f| f.events),
        mean(|f| f.motions),
        mean(|f| f.time),
        all.iter().filter(|f| f.rests).count(),
        all.len(),
        with_error(|f| f.height),
        with_error(|f| f.distance),
        most(|f| f.deepest),
        most(|f| f.rise),
        1e2 * mean(|f| f.wave),
        all.iter().fold(0, |digest, f| digest ^ f.digest),
    );
}

/// Notes when each body was first struck by another, and the rise of the energy.
struct Watch<'w> {
    world: &'w RigidWorld,
    struck: Vec<Option<f64>>,
    least: f64,
    rise: f64,
    is_on: bool,
}

impl Observer<RigidWorld> for Watch<'_> {
    fn impact(&mut self, impact: &Impact) {
        if let Other::Body(other) = impact.other {
            self.struck[other.max(impact.body)].get_or_insert(impact.time);
        }
    }

    fn proceed(&mut self, state: &State<RigidBodyState>) -> bool {
        if self.is_on {
            let at = |k: usize| self.world.energy(k, &self.world.at(k, &state.bodies()[k], state.time()));
            let energy = (0..state.bodies().len()).map(at).sum::<f64>();
            self.rise = self.rise.max(energy - self.least);
            self.least = self.least.min(energy);
        }
        true
    }
}

fn run(
    (name, make, until): &World,
    draw: u64,
    (preset, crowd): (Preset, Option<u32>),
    repeats: usize,
) -> Result<Found, Box<dyn Error>> {
    let mut spent = f64::INFINITY;
    let accuracy = Accuracy::preset(preset);
    let accuracy = Accuracy { crowd: crowd.unwrap_or(accuracy.crowd), ..accuracy };
    let ((world, specs), starts) = make(&mut Seed(7).chain(4).at(draw, Purpose::START), accuracy)?;
    for _ in 0..repeats {
        let mut state = world.state(&starts)?;
        let mut watch = Stopwatch::start();
        watch.time(|| world.run(&mut state, &mut Scratch::default(), *until, &mut ()))?;
        spent = spent.min(watch.mean());
    }
    let mut state = world.state(&starts)?;
    let mut watch =
        Watch { world: &world, struck: vec![None; starts.len()], least: f64::INFINITY, rise: 0.0, is_on: repeats > 0 };
    let outcome = world.run(&mut state, &mut Scratch::default(), *until, &mut watch)?;
    let ends: Vec<_> = state.bodies().iter().enumerate().map(|(k, b)| world.at(k, b, state.time())).collect();
    let count = ends.len() as f64;
    let size = |k: usize| specs[k].shape.size();
    let mut deepest = ends.iter().enumerate().map(|(k, b)| world.depth(k, b) / size(k)).fold(0.0, f64::max);
    for (k, a) in ends.iter().enumerate() {
        let overlaps = ends[..k].iter().enumerate().map(|(j, b)| -world.gap([j, k], [b, a]) / size(j).min(size(k)));
        deepest = overlaps.fold(deepest, f64::max);
    }
    let mut digest = Digest::new();
    digest.add_all(ends.iter().flat_map(|b| b.path.x.to_array()));
    let counts = state.counts();
    let wave = WAVES.iter().find(|w| w.0 == *name).map_or(0.0, |(_, gap, truth)| {
        let speed = (watch.struck[8].zip(watch.struck[18]))
            .map(|(from, to)| 10.0 * (0.0075 + gap * 0.048) / (to - from) / (G * 0.048_f64).sqrt());
        speed.map_or(f64::NAN, |v| v / truth - 1.0)
    });
    let weight: f64 = (0..starts.len()).map(|k| specs[k].mass.mass * G * size(k)).sum();
    Ok(Found {
        spent,
        events: counts.events as f64,
        motions: counts.motions as f64,
        time: state.time(),
        rests: outcome == Outcome::AllAtRest,
        distance: ends.iter().map(|b| b.path.x.truncate().length()).sum::<f64>() / count,
        height: ends.iter().map(|b| b.path.x.z).sum::<f64>() / count,
        deepest,
        rise: watch.rise / weight,
        wave,
        digest: digest.get(),
    })
}

fn world(
    accuracy: Accuracy,
    bodies: Vec<BodySpec>,
    parts: Vec<StaticShape>,
    law: Law,
) -> Result<(RigidWorld, Vec<BodySpec>), Box<dyn Error>> {
    let (laws, specs) = (Laws::uniform(law)?, bodies.clone());
    let world = RigidWorldDesc { bodies, parts, laws, accuracy, skin: 0.5, ..RigidWorldDesc::default() };
    Ok((RigidWorld::new(world)?, specs))
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
fn balls(stream: &mut Stream, accuracy: Accuracy, n: usize) -> Made {
    let (r, half) = (0.01, 0.1);
    let mut parts = vec![plane(DVec3::ZERO, DVec3::Z)?];
    for n in [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y] {
        parts.push(plane(n * -half, n)?);
    }
    let law = Law::new(0.3, 0.5).with_resistance(0.01, 0.01);
    let world = world(accuracy, vec![BodySpec::solid(Shape::Ball(r), 2500.0, M); n], parts, law)?;
    let start = |k: usize| {
        let (layer, place) = (k / 49, k % 49);
        let at = DVec3::new((place % 7) as f64 - 3.0, (place / 7) as f64 - 3.0, layer as f64 + 1.0) * (2.4 * r);
        let jitter = three(stream, 0.15 * r);
        Start::at_rest(at + jitter * DVec3::new(1.0, 1.0, 0.0))
    };
    Ok((world, (0..n).map(start).collect()))
}

/// A row of twenty, with gaps of 0.35 to 0.75 of the height; the first tips about its lower front edge.
fn dominoes(stream: &mut Stream, accuracy: Accuracy) -> Made {
    let edges = DVec3::new(0.008, 0.024, 0.048);
    let spec = BodySpec::solid(Shape::Cuboid(Cuboid::new(edges, 0.0)?), 1200.0, M);
    let world = world(accuracy, vec![spec; 20], vec![plane(DVec3::ZERO, DVec3::Z)?], Law::new(0.3, 0.2))?;
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
fn shards(stream: &mut Stream, accuracy: Accuracy) -> Made {
    let edges = DVec3::new(0.022, 0.03, 0.005);
    let box_at = |side: f64| -> Result<Member, Box<dyn Error>> {
        let turn = DQuat::from_rotation_y(-0.5 * side);
        let at = DVec3::new(0.019 * side, 0.0, 0.005 * side.abs());
        Ok(Member { turn, ..Member::new(Convex::Cuboid(Cuboid::new(edges, 0.0)?), at) })
    };
    let shard = Compound::new(&[-1.0, 0.0, 1.0].into_iter().map(box_at).collect::<Result<Vec<_>, _>>()?)?;
    let spec = BodySpec::solid(Shape::from(shard), 2400.0, M);
    let world = world(accuracy, vec![spec; 30], vec![plane(DVec3::ZERO, DVec3::Z)?], Law::new(0.4, 0.3))?;
    let start = |k: usize| {
        let (i, j, layer) = (k % 3, k / 3 % 2, k / 6);
        let place = DVec3::new(i as f64 - 1.0, j as f64 - 0.5, layer as f64) * 0.09 + DVec3::Z;
        let orientation = DQuat::from_scaled_axis(three(stream, 3.0));
        Start { position: place + three(stream, 0.005), orientation, spin: three(stream, 6.0), ..Start::at_rest(place) }
    };
    Ok((world, (0..30).map(start).collect()))
}

/// Twelve hulls of thirty corners over a bowl of triangles.
fn bowl(stream: &mut Stream, accuracy: Accuracy) -> Made {
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
    let world = world(accuracy, vec![spec; 12], vec![mesh, plane(DVec3::Z * -0.05, DVec3::Z)?], Law::new(0.4, 0.3))?;
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

/// A plank on a hinge; a cube lies on its lower end, another falls on the upper one.
fn seesaw(stream: &mut Stream, accuracy: Accuracy) -> Made {
    let (plank, cube, axle, tilt) = (DVec3::new(0.4, 0.06, 0.01), 0.04, 0.06, 0.24);
    let body = |edges: DVec3, density: f64| -> Result<BodySpec, Box<dyn Error>> {
        Ok(BodySpec::solid(Shape::Cuboid(Cuboid::new(edges, 0.0)?), density, M))
    };
    let bodies = vec![body(plank, 600.0)?, body(DVec3::splat(cube), 800.0)?, body(DVec3::splat(cube), 2400.0)?];
    let mut world = world(accuracy, bodies, vec![plane(DVec3::ZERO, DVec3::Z)?], Law::new(0.5, 0.2))?;
    let held = Start { orientation: DQuat::from_rotation_y(-tilt), ..Start::at_rest(DVec3::Z * axle) };
    world.0.join(Joint::hinge(DVec3::Z * axle, DVec3::Y, 0, &held))?;
    let above = 0.5 * (plank.z + cube) + 1e-4;
    let mut between = |low: f64, high: f64| between(stream, low, high);
    let lies = held.position + held.orientation * DVec3::new(-between(0.15, 0.17), between(-0.01, 0.01), above);
    let turn = DQuat::from_rotation_z(between(-0.5, 0.5));
    let falls = DVec3::new(between(0.13, 0.18), between(-0.01, 0.01), axle + between(0.2, 0.5));
    let lying = Start { orientation: held.orientation, ..Start::at_rest(lies) };
    Ok((world, vec![held, lying, Start { orientation: turn, ..Start::at_rest(falls) }]))
}

fn cube(edge: f64) -> Result<BodySpec, Box<dyn Error>> {
    Ok(BodySpec::solid(Shape::Cuboid(Cuboid::new(DVec3::splat(edge), 0.0)?), 1000.0, M))
}

/// Twenty rows of cubes in a plane, each over two of the row below; between rows, random gaps of at most this part of
/// the edge.
fn pyramid(stream: &mut Stream, accuracy: Accuracy, gap: f64) -> Made {
    let (edge, rows) = (0.05, 20);
    let mut starts = Vec::new();
    for row in 0..rows {
        for k in 0..rows - row {
            let x = f64::from(k) - 0.5 * f64::from(rows - row - 1);
            let rise = f64::from(row) * gap + between(stream, 0.0, gap);
            starts.push(Start::at_rest(DVec3::new(1.05 * x, 0.0, f64::from(row) + 0.5 + rise) * edge));
        }
    }
    let law = Law::new(0.5, 0.2);
    Ok((world(accuracy, vec![cube(edge)?; starts.len()], vec![plane(DVec3::ZERO, DVec3::Z)?], law)?, starts))
}

/// Forty blocks on each other, each a little off its place and turned.
fn tower(stream: &mut Stream, accuracy: Accuracy) -> Made {
    let edges = DVec3::new(0.06, 0.06, 0.03);
    let spec = BodySpec::solid(Shape::Cuboid(Cuboid::new(edges, 0.0)?), 600.0, M);
    let start = |k: i32| {
        let off = three(stream, 0.003).with_z(edges.z * (f64::from(k) * 1.005 + 0.5));
        Start { orientation: DQuat::from_rotation_z(between(stream, -0.1, 0.1)), ..Start::at_rest(off) }
    };
    let starts: Vec<Start> = (0..40).map(start).collect();
    Ok((world(accuracy, vec![spec; 40], vec![plane(DVec3::ZERO, DVec3::Z)?], Law::new(0.5, 0.2))?, starts))
}

/// Twenty-seven stones of a half circle, a little apart.
fn arch(stream: &mut Stream, accuracy: Accuracy) -> Made {
    let (stones, inner, outer, depth) = (27, 0.4, 0.52, 0.1);
    let angle = PI / f64::from(stones);
    let corner = |turn: f64, r: f64, y: f64| {
        let (s, c) = math::sin_cos(turn);
        DVec3::new(r * s, y, r * c)
    };
    let corners: Vec<DVec3> = (0..8)
        .map(|k| {
            corner(if k & 1 == 0 { -0.5 } else { 0.5 } * angle, [inner, outer][k >> 1 & 1], [-0.5, 0.5][k >> 2] * depth)
        })
        .collect();
    let hull = ConvexHull::new(&corners, 0.0)?;
    let (middle, own) = (hull.centre(), hull.turn());
    let spec = BodySpec::solid(Shape::Hull(Arc::new(hull)), 2400.0, M);
    let gap = between(stream, 0.0, 2e-5);
    let start = |k: i32| {
        let turn = DQuat::from_rotation_y((f64::from(k) + 0.5) * angle - FRAC_PI_2);
        let at = turn * (middle * (1.0 + gap));
        Start { orientation: turn * own, ..Start::at_rest(at + DVec3::Z * 1e-6) }
    };
    let starts: Vec<Start> = (0..stones).map(start).collect();
    Ok((world(accuracy, vec![spec; 27], vec![plane(DVec3::ZERO, DVec3::Z)?], Law::new(0.6, 0.0))?, starts))
}

/// Twenty equal dominoes, apart by this fraction of their height; the first tips about its lower front edge.
fn row(accuracy: Accuracy, gap: f64) -> Made {
    let edges = DVec3::new(0.0075, 0.024, 0.048);
    let spec = BodySpec::solid(Shape::Cuboid(Cuboid::new(edges, 0.0)?), 1000.0, M);
    let place = |k: i32| DVec3::new(f64::from(k) * (edges.x + gap * edges.z), 0.0, 0.5 * edges.z);
    let mut starts: Vec<Start> = (0..20).map(|k| Start::at_rest(place(k))).collect();
    starts[0].spin = DVec3::Y * (G / edges.z).sqrt();
    starts[0].velocity = starts[0].spin.cross(DVec3::new(-0.5 * edges.x, 0.0, 0.5 * edges.z));
    Ok((world(accuracy, vec![spec; 20], vec![plane(DVec3::ZERO, DVec3::Z)?], Law::new(0.2, 0.0))?, starts))
}
