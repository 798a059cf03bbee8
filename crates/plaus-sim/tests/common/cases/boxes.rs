//! Several cuboids: on balls, in stacks, in rows.

use super::guard::go;
use super::throws::cuboid;
use super::{Found, Setting};
use crate::laws::worlds::{G, M, on_floor};
use glam::DVec3;
use plaus_sim::rigid::{BodySpec, RigidBodyState, RigidWorld, Start};
use plaus_sim::shape::{MassProperties, Shape};
use plaus_sim::trace::Observer;
use plaus_sim::{Law, Outcome};

/// A box that rolls on 5 × 5 balls, with gravity tilted by 0.05: nothing slides.
///
/// For a box of mass M and balls of total mass N m, Lagrange's equation with the velocity V of the box and V/2 of the
/// balls gives a = g_x (M + N m/2)/(M + 7 N m/20). This is 1.2 g_x for N m = 2.5 M; the balls have half of it.
pub fn on_balls(s: &Setting<'_>) -> Found {
    let (r, mass) = (0.02, 0.1);
    let ball = BodySpec { mass: MassProperties::ball(r, 1.0).with_mass(mass), shape: Shape::Ball(r), material: M };
    let mut bodies = vec![ball; 25];
    let mut lid = cuboid(DVec3::new(0.4, 0.4, 0.04));
    lid.mass = lid.mass.with_mass(10.0 * mass);
    bodies.push(lid);
    let mut starts: Vec<Start> = (0..25)
        .map(|k| Start::at_rest(DVec3::new((k % 5) as f64 - 2.0, (k / 5) as f64 - 2.0, 0.0) * 0.06 + DVec3::Z * r))
        .collect();
    starts.push(Start::at_rest(DVec3::Z * (2.0 * r + 0.02)));
    let (world, tilt) = (on_floor(bodies, Law::new(0.5, 0.2), s.preset), 0.05);
    let mut world = world;
    world.gravity = DVec3::new(tilt, 0.0, -1.0).normalize() * G;
    let g_x = world.gravity.x;
    let world = RigidWorld::new(world).expect("a sound world");
    let until = 0.5;
    let went = go(&world, &starts, until, s.guard, &mut ());
    let t = went.state.time();
    let at = |k: usize| world.at(k, &went.state.bodies()[k], t);
    let pace = |k: usize| at(k).path.v.x / (g_x * t);
    let balls: Vec<f64> = (0..25).map(pace).collect();
    let (low, high) = balls.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), b| (l.min(*b), h.max(*b)));
    let lid = pace(25);
    // Load sharing within 1 %.
    let holds = (lid - 1.2).abs() < 0.012 && low > 0.594 && high < 0.606 && !went.cut;
    let off = (lid / 1.2 - 1.0).abs().max((low / 0.6 - 1.0).abs()).max((high / 0.6 - 1.0).abs());
    let off = if went.cut { f64::NAN } else { off };
    Found::new(holds, off, format!("box {lid:.4}, balls {low:.4} to {high:.4} g_x, {}", went.told()))
}

/// Whether cubes that stand on each other come to rest where they stand.
fn stands(s: &Setting<'_>, places: &[DVec3], edge: f64) -> Found {
    let bodies = vec![cuboid(DVec3::splat(edge)); places.len()];
    let starts: Vec<Start> = places.iter().map(|p| Start::at_rest(*p * edge)).collect();
    let world = RigidWorld::new(on_floor(bodies, Law::new(0.5, 0.2), s.preset)).expect("a sound world");
    let went = go(&world, &starts, 5.0, s.guard, &mut ());
    let t = went.state.time();
    let ends: Vec<RigidBodyState> = went.state.bodies().iter().enumerate().map(|(k, b)| world.at(k, b, t)).collect();
    let shift = ends.iter().zip(&starts).map(|(e, s)| (e.path.x - s.position).length()).fold(0.0, f64::max) / edge;
    let deep = deepest(&world, &ends) / edge;
    let holds = went.outcome == Outcome::AllAtRest && shift < 0.01;
    let off = if went.cut { f64::NAN } else { shift };
    Found::new(holds, off, format!("shift {shift:.1e}, overlap {deep:.1e} edges at {t:.3} s, {}", went.told()))
}

/// The deepest overlap of any two bodies, or of a body with the floor.
pub fn deepest(world: &RigidWorld, at: &[RigidBodyState]) -> f64 {
    let mut deepest = 0.0_f64;
    for (k, a) in at.iter().enumerate() {
        deepest = deepest.max(world.depth(k, a));
        for (j, b) in at[..k].iter().enumerate() {
            deepest = deepest.max(-world.gap([j, k], [b, a]));
        }
    }
    deepest
}

pub fn stack(s: &Setting<'_>) -> Found {
    let places: Vec<DVec3> = (0..10).map(|k| DVec3::new(0.0, 0.0, f64::from(k) + 0.5)).collect();
    stands(s, &places, 0.05)
}

/// Layers of 5², 4², 3², 2² and 1 cubes, each cube over the corner of four.
pub fn pyramid(s: &Setting<'_>) -> Found {
    let mut places = Vec::new();
    for layer in 0..5 {
        let side = 5 - layer;
        for k in 0..side * side {
            let (i, j) = (f64::from(k % side), f64::from(k / side));
            let middle = 0.5 * f64::from(side - 1);
            // A little apart: cubes side by side do not touch.
            places.push(DVec3::new((i - middle) * 1.02, (j - middle) * 1.02, f64::from(layer) + 0.5));
        }
    }
    stands(s, &places, 0.05)
}

/// When each body was first struck by its neighbour.
#[derive(Default)]
pub struct Wave(pub Vec<Option<f64>>);

impl Observer<RigidWorld> for Wave {
    fn impact(&mut self, impact: &plaus_sim::mechanics::Impact) {
        if let plaus_sim::mechanics::Other::Body(other) = impact.other {
            let struck = other.max(impact.body);
            if self.0.len() <= struck {
                self.0.resize(struck + 1, None);
            }
            self.0[struck].get_or_insert(impact.time);
        }
    }
}

pub const DOMINO: DVec3 = DVec3::new(0.0075, 0.024, 0.048);
/// Without restitution, so that the order of impacts matters least.
pub const DOMINO_LAW: Law = Law::new(0.2, 0.0);

/// Twenty dominoes whose gap is this fraction of the height. The first tips about its lower front edge; its upper edge
/// moves at √(g h).
pub fn domino_starts(gap: f64) -> Vec<Start> {
    let pitch = DOMINO.x + gap * DOMINO.z;
    let mut starts: Vec<Start> =
        (0..20).map(|k| Start::at_rest(DVec3::new(f64::from(k) * pitch, 0.0, 0.5 * DOMINO.z))).collect();
    let arm = DVec3::new(-0.5 * DOMINO.x, 0.0, 0.5 * DOMINO.z);
    starts[0].spin = DVec3::Y * (G / DOMINO.z).sqrt();
    starts[0].velocity = starts[0].spin.cross(arm);
    starts
}

/// Speed of the wave between the ninth and the nineteenth domino, over √(g h).
pub fn wave_speed(times: &[Option<f64>], gap: f64) -> Option<f64> {
    let (from, to) = ((*times.get(8)?)?, (*times.get(18)?)?);
    Some(10.0 * (DOMINO.x + gap * DOMINO.z) / (to - from) / (G * DOMINO.z).sqrt())
}

/// A wave of dominoes; `truth` is its speed found in small steps (the example `truths`).
pub fn dominoes(s: &Setting<'_>, gap: f64, truth: f64) -> Found {
    let world = RigidWorld::new(on_floor(vec![cuboid(DOMINO); 20], DOMINO_LAW, s.preset)).expect("a sound world");
    let mut wave = Wave::default();
    let went = go(&world, &domino_starts(gap), 3.0, s.guard, &mut wave);
    let speed = wave_speed(&wave.0, gap);
    // The goal for the simulator: within 3 %.
    let near = speed.is_some_and(|v| (v / truth - 1.0).abs() < 0.03);
    let holds = near && !went.cut && went.outcome != Outcome::OutOfEvents;
    let off = speed.map_or(f64::NAN, |v| (v / truth - 1.0).abs());
    let speed = speed.map_or("no wave".to_owned(), |v| format!("{v:.3} for {truth:.3}"));
    Found::new(holds, off, format!("{speed}, {}", went.told()))
}
