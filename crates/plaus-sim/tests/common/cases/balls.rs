//! Balls: large ratios of mass, many impacts, e = 1.

use super::boxes::deepest;
use super::guard::go;
use super::{Found, Setting};
use crate::laws::worlds::{M, on_floor};
use glam::DVec3;
use plaus_sim::mechanics::{Impact, Other};
use plaus_sim::rigid::{BodySpec, Phase, RigidBodyState, RigidWorld, Start, StaticShape};
use plaus_sim::scenery::Plane;
use plaus_sim::shape::{MassProperties, Shape};
use plaus_sim::trace::Observer;
use plaus_sim::{Law, Outcome};

const R: f64 = 0.02;

fn ball(mass: f64) -> BodySpec {
    BodySpec { shape: Shape::Ball(R), mass: MassProperties::ball(R, 1.0).with_mass(mass), material: M }
}

/// The deepest overlap at any event, and half way between a body's events.
struct Overlap<'w> {
    world: &'w RigidWorld,
    last: Vec<RigidBodyState>,
    worst: f64,
}

impl Observer<RigidWorld> for Overlap<'_> {
    fn motion(&mut self, index: usize, body: &RigidBodyState) {
        if self.last.len() <= index {
            return self.last.push(body.clone());
        }
        for time in [0.5 * (self.last[index].path.t + body.path.t), body.path.t] {
            let there: Vec<RigidBodyState> =
                self.last.iter().enumerate().map(|(k, b)| self.world.at(k, b, time.max(b.path.t))).collect();
            if there.iter().all(|b| b.path.t <= time && b.phase != Phase::Waiting) {
                self.worst = self.worst.max(deepest(self.world, &there));
            }
        }
        self.last[index] = body.clone();
    }
}

/// A heavy ball comes down from a height of a tenth of a radius onto a light one on the floor, straight above it.
pub fn heavy(s: &Setting<'_>, ratio: f64) -> Found {
    let bodies = vec![ball(0.01), ball(0.01 * ratio)];
    let world = RigidWorld::new(on_floor(bodies, Law::new(0.3, 0.5), s.preset)).expect("a sound world");
    let starts = [Start::at_rest(DVec3::Z * R), Start::at_rest(DVec3::Z * 3.1 * R)];
    let mut overlap = Overlap { world: &world, last: Vec::new(), worst: 0.0 };
    let went = go(&world, &starts, 2.0, s.guard, &mut overlap);
    let deep = overlap.worst / R;
    let ends: Vec<RigidBodyState> =
        went.state.bodies().iter().enumerate().map(|(k, b)| world.at(k, b, went.state.time())).collect();
    let left = deepest(&world, &ends) / R;
    let is_called_rest = went.outcome == Outcome::AllAtRest;
    // At rest nothing may overlap by more than the gap that a preset resolves.
    let honest = !is_called_rest || left <= 10.0 * s.accuracy().gap;
    let most = if ratio > 1e6 { 0.1 } else { 0.01 };
    let holds = honest && !went.cut && deep < most;
    Found::new(
        holds,
        if went.cut { f64::NAN } else { deep },
        format!("overlap {deep:.1e} r, {left:.1e} r in the end, {}", went.told()),
    )
}

/// Counts impacts that are more than the beginning of rest.
#[derive(Default)]
struct Count {
    pairs: u64,
    walls: u64,
}

impl Observer<RigidWorld> for Count {
    fn impact(&mut self, impact: &Impact) {
        match impact.other {
            Other::Body(_) => self.pairs += 1,
            Other::Surface(_) if impact.normal.x.abs() > 0.5 => self.walls += 1,
            Other::Surface(_) => {}
        }
    }
}

/// Galperin's billiard: a heavy ball drives a light one against a wall; both lie on a floor, under gravity, e = 1. With
/// a ratio of masses of 100^N, the number of impacts shows the first N + 1 digits of π (Galperin 2003).
pub fn galperin(s: &Setting<'_>, n: i32) -> Found {
    let ratio = plaus_dist::math::powi(100.0, n);
    let bodies = vec![ball(0.01), ball(0.01 * ratio)];
    let mut world = on_floor(bodies, Law::new(0.0, 1.0), s.preset);
    world.parts.push(StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::X, M).expect("a plane")));
    let world = RigidWorld::new(world).expect("a sound world");
    let at = |x: f64, v: f64| Start { velocity: DVec3::X * v, ..Start::at_rest(DVec3::new(x, 0.0, R)) };
    let mut count = Count::default();
    let went = go(&world, &[at(3.0 * R, 0.0), at(8.0 * R, -1.0)], 10.0, s.guard, &mut count);
    let all = count.pairs + count.walls;
    let digits = [3_u32, 31, 314, 3141, 31415];
    let end = world.at(1, &went.state.bodies()[1], went.state.time()).path.v.x;
    let holds = all == u64::from(digits[n as usize]) && !went.cut && went.outcome != Outcome::OutOfEvents;
    let far = (all as f64 / f64::from(digits[n as usize]) - 1.0).abs();
    let far = if went.cut { f64::NAN } else { far };
    Found::new(holds, far, format!("{all} impacts, heavy ball leaves at {end:.6}, {}", went.told()))
}

/// Five touching balls on a floor with e = 1. Two of them come in, and as many leave.
pub fn cradle(s: &Setting<'_>) -> Found {
    let world = RigidWorld::new(on_floor(vec![ball(0.03); 5], Law::new(0.0, 1.0), s.preset)).expect("a sound world");
    // Two come in together and three wait, each touching its neighbours.
    let start = |k: usize| {
        let away = if k < 2 { -R } else { 0.0 };
        let v = if k < 2 { 1.0 } else { 0.0 };
        Start { velocity: DVec3::X * v, ..Start::at_rest(DVec3::new(2.0 * R * k as f64 + away, 0.0, R)) }
    };
    let starts: Vec<Start> = (0..5).map(start).collect();
    let went = go(&world, &starts, 0.1, s.guard, &mut ());
    let t = went.state.time();
    let v: Vec<f64> = (0..5).map(|k| world.at(k, &went.state.bodies()[k], t).path.v.x).collect();
    let off = v.iter().zip([0.0, 0.0, 0.0, 1.0, 1.0]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    // Positions, and so the directions of impacts, are known to the gap.
    let holds = off < 10.0 * s.accuracy().gap && !went.cut;
    let text = format!("({:.3}, {:.3}, {:.3}, {:.3}, {:.3}), {}", v[0], v[1], v[2], v[3], v[4], went.told());
    Found::new(holds, if went.cut { f64::NAN } else { off }, text)
}

/// A ball that lies on a floor with e = 1: exactly, a little in it, and a little over it, but within the gap at which
/// bodies touch.
pub fn at_rest(s: &Setting<'_>) -> Found {
    let world = RigidWorld::new(on_floor(vec![ball(0.01)], Law::new(0.3, 1.0), s.preset)).expect("a sound world");
    let gap = s.accuracy().gap;
    let went = [0.0, -0.5 * gap.min(1e-6), 0.5 * gap]
        .map(|above| go(&world, &[Start::at_rest(DVec3::Z * (R * (1.0 + above)))], 5.0, s.guard, &mut ()));
    let holds = went.iter().all(|w| w.outcome == Outcome::AllAtRest && w.state.counts().events < 100);
    let told: Vec<String> = went.iter().map(|w| format!("{:?} after {}", w.outcome, w.state.counts().events)).collect();
    let most = went.iter().map(|w| w.state.counts().events).max().unwrap_or(0) as f64;
    Found::new(holds, most, format!("on, in, over the floor: {} events", told.join(", ")))
}
