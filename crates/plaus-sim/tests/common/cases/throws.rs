//! Throws of cuboids: what they conserve, how friction slows them, where they end.

use super::guard::go;
use super::{Found, Setting};
use crate::laws::checks::{Free, coulomb, momentum};
use crate::laws::record::record;
use crate::laws::worlds::{Dice, G, M, on_floor};
use glam::{DQuat, DVec3};
use plaus_dist::math;
use plaus_sim::rigid::{BodySpec, RigidWorld, RigidWorldDesc, Start};
use plaus_sim::shape::{Cuboid, Shape};
use plaus_sim::{Law, Outcome};
use std::time::Duration;

/// A cuboid with these edges.
pub fn cuboid(edges: DVec3) -> BodySpec {
    BodySpec::solid(Shape::Cuboid(Cuboid::new(edges, 0.0).expect("a cuboid")), 1000.0, M)
}

/// Throws of a cuboid of 6, 8 and 10 cm: fast enough to slide for seconds.
fn cuboids(throws: u64) -> impl Iterator<Item = (BodySpec, Start)> {
    (0..throws).map(|k| {
        let mut dice = Dice::new(3, k);
        let body = cuboid(DVec3::new(0.06, 0.08, 0.1));
        let velocity = DVec3::new(dice.between(0.5, 1.5), dice.between(-0.2, 0.2), dice.between(-0.5, 0.0));
        let position = DVec3::Z * dice.between(0.1, 0.2);
        (body, Start { velocity, orientation: dice.turn(), spin: dice.in_cube() * 10.0, ..Start::at_rest(position) })
    })
}

/// Frictionless floor: how much of the horizontal momentum is lost within 3 s.
pub fn ice(s: &Setting<'_>, e: f64) -> Found {
    let (mut lost, mut worst, mut dead, mut broken) = (0.0, 0.0_f64, 0, 0);
    for (body, start) in cuboids(s.throws) {
        let world = on_floor(vec![body], Law::new(0.0, e), s.preset);
        let r = record(world, &[start], 3.0, s.guard.events);
        let end = r.moments[0].last().expect("an end").v.with_z(0.0);
        let from = start.velocity.with_z(0.0);
        let part = 1.0 - end.length() / from.length();
        (lost, worst) = (lost + part / s.throws as f64, worst.max(part.abs()));
        dead += u32::from(end.length() < 1e-3 * from.length());
        broken += u32::from(momentum(&r, Free::Level).iter().any(|f| f.is_breach()));
    }
    let text = format!("lost {lost:.1e} in the mean, {worst:.1e} at worst; {dead} dead, {broken} not to rounding");
    Found::new(broken == 0, worst, text)
}

/// Coulomb's bound over whole throws, and from event to event.
pub fn bound(s: &Setting<'_>) -> Found {
    let friction = 0.18;
    let (mut beyond, mut excess, mut worst, mut steps) = (0, 0.0, 0.0_f64, 0);
    for (body, start) in cuboids(s.throws) {
        let r = record(on_floor(vec![body], Law::new(friction, 0.125), s.preset), &[start], 3.0, s.guard.events);
        // While it still slides: a body at rest needs no friction.
        let moving = r.moments[0].iter().rfind(|m| m.v.with_z(0.0).length() > 0.0).expect("it is thrown");
        let dv = moving.v - start.velocity;
        let over = dv.with_z(0.0).length() - friction * (G * moving.time + dv.z);
        worst = worst.max(over);
        if over > 1e-9 {
            (beyond, excess) = (beyond + 1, excess + over);
        }
        steps += u32::from(coulomb(&r, friction).is_breach());
    }
    let mean = excess / f64::from(beyond.max(1));
    let text = format!("{beyond} of {} beyond, by {mean:.2} m/s in the mean; {steps} in some step", s.throws);
    Found::new(beyond == 0 && steps == 0, worst, text)
}

/// A toss of a real cube: first state and last pose.
#[derive(Debug, Clone, Copy)]
pub struct Toss {
    pub start: Start,
    pub end: DVec3,
    pub end_turn: DQuat,
}

/// Half the width of the cube of the published tosses, in m (ContactNets: Pfrommer, Halm and Posa, CoRL 2020).
const HALF: f64 = 0.0524;

/// Reads tosses in the format of `xtask/figures/data/tosses/tosses.csv`. After the line of names there is one line per
/// toss: its number and its seconds; position, quaternion (real part first), velocity, and angular velocity in the
/// body's axes, at the first frame; position and quaternion at the last frame. Velocities are means over the 1/148 s
/// before the frame: in free fall, the velocity at the frame is larger downwards by half of what gravity adds in that
/// time.
///
/// # Errors
/// The line that cannot be read.
pub fn read_tosses(text: &str) -> Result<Vec<Toss>, String> {
    text.lines()
        .skip(1)
        .map(|line| {
            let n: Vec<f64> = line.split(',').filter_map(|n| n.parse().ok()).collect();
            if n.len() != 22 {
                return Err(format!("no toss: {line}"));
            }
            let vec = |k: usize| DVec3::new(n[k], n[k + 1], n[k + 2]);
            let turn = |k: usize| DQuat::from_xyzw(n[k + 1], n[k + 2], n[k + 3], n[k]).normalize();
            let orientation = turn(5);
            let start = Start {
                position: vec(2),
                orientation,
                velocity: vec(9) - DVec3::Z * (0.5 * G / 148.0),
                spin: orientation * vec(12),
                time: 0.0,
            };
            Ok(Toss { start, end: vec(15), end_turn: turn(18) })
        })
        .collect()
}

/// The cube of the published tosses, with the mass and the moment of inertia that their authors state.
pub fn toss_body() -> BodySpec {
    let mut body = cuboid(DVec3::splat(2.0 * HALF));
    body.mass.mass = 0.37;
    body.mass.inertia = DVec3::splat(0.295 * HALF * HALF);
    body
}

/// Its world, with the friction and the restitution that the authors state.
pub fn toss_world(s: &Setting<'_>) -> RigidWorldDesc {
    on_floor(vec![toss_body()], Law::new(0.18, 0.125), s.preset)
}

/// Random tosses like the published ones, for when those are not available.
pub fn random_tosses(count: u64) -> Vec<Start> {
    (0..count)
        .map(|k| {
            let mut dice = Dice::new(17, k);
            let position = DVec3::Z * dice.between(0.15, 0.3);
            let velocity = DVec3::new(dice.between(0.5, 1.5), dice.between(-0.3, 0.3), dice.between(-0.5, 0.5));
            Start { orientation: dice.turn(), velocity, spin: dice.in_cube() * 8.0, ..Start::at_rest(position) }
        })
        .collect()
}

/// How far tossed cubes travel, in widths, and how far from the real cubes they end.
pub fn travel(s: &Setting<'_>) -> Found {
    let world = RigidWorld::new(toss_world(s)).expect("a sound world");
    let real: Vec<&Toss> = s.tosses.iter().filter(|t| start_is_free(&world, &t.start)).collect();
    let starts = if real.is_empty() { random_tosses(s.throws) } else { real.iter().map(|t| t.start).collect() };
    let (mut sum, mut off, mut same, mut wall, mut cut) = (0.0, 0.0, 0, Duration::ZERO, 0);
    let far = |to: DVec3, from: DVec3| (to - from).with_z(0.0).length() / (2.0 * HALF);
    let expected = real.iter().map(|t| far(t.end, t.start.position)).sum::<f64>() / real.len() as f64;
    for (k, start) in starts.iter().enumerate() {
        let went = go(&world, &[*start], 10.0, s.guard, &mut ());
        let body = world.at(0, &went.state.bodies()[0], went.state.time());
        sum += far(body.path.x, start.position);
        if let Some(toss) = real.get(k) {
            off += (body.path.x - toss.end).length() / (2.0 * HALF);
            let up = |q: DQuat| (q.conjugate() * DVec3::Z).abs().max_position();
            let side = |q: DQuat| (q.conjugate() * DVec3::Z)[up(q)].signum();
            same += u32::from(up(body.turn) == up(toss.end_turn) && side(body.turn) == side(toss.end_turn));
        }
        wall += Duration::from_secs_f64(went.wall);
        cut += u32::from(went.cut || went.outcome == Outcome::OutOfEvents);
    }
    let n = starts.len() as f64;
    let kind = if real.is_empty() { "random" } else { "real" };
    let against = if real.is_empty() {
        String::new()
    } else {
        let (off, same) = (100.0 * off / n, 100.0 * f64::from(same) / n);
        format!(" for {expected:.3}, {off:.1} % of the width from the real end, same face {same:.0} %")
    };
    let mean = sum / n;
    let text = format!("{n} {kind}: {mean:.3} widths{against}, {cut} cut, {:.2} ms each", 1e3 * wall.as_secs_f64() / n);
    // The mean of 570 tosses whose ends are each off by 0.28 is known to 0.28/√570 = 0.012: three times that is
    // allowed.
    let far = if cut == 0 { (mean / expected - 1.0).abs() } else { f64::NAN };
    Found::new(cut == 0 && (real.is_empty() || (mean - expected).abs() < 0.036), far, text)
}

fn start_is_free(world: &RigidWorld, start: &Start) -> bool {
    world.state(&[*start]).is_ok()
}

/// A cube dropped exactly flat, from a height of two edges.
pub fn flat(s: &Setting<'_>, e: f64) -> Found {
    let edge = 0.1;
    let world = RigidWorld::new(on_floor(vec![cuboid(DVec3::splat(edge))], Law::new(0.3, e), s.preset)).expect("sound");
    let went = go(&world, &[Start::at_rest(DVec3::Z * 2.5 * edge)], 10.0, s.guard, &mut ());
    let body = world.at(0, &went.state.bodies()[0], went.state.time());
    let aside = body.path.x.with_z(0.0).length() / edge;
    let ahead = body.turn * DVec3::X;
    let yaw = math::atan2(ahead.y, ahead.x).to_degrees();
    // Positions are known to the gap at which bodies touch.
    let enough = 10.0 * s.accuracy().gap;
    let holds = aside <= enough && yaw.to_radians().abs() <= enough && went.outcome == Outcome::AllAtRest;
    let off = if went.cut { f64::NAN } else { aside + yaw.to_radians().abs() };
    Found::new(holds, off, format!("{aside:.1e} edges aside, turned by {yaw:.1e}°, {}", went.told()))
}

/// A cuboid on a slope a little steeper than friction can hold, from rest, for 10 s: gravity is tilted over a level
/// floor.
pub fn slope(s: &Setting<'_>) -> Found {
    let friction: f64 = 0.3;
    let angle = math::atan2(friction, 1.0) + 1e-6;
    let mut world = on_floor(vec![cuboid(DVec3::new(0.1, 0.1, 0.04))], Law::new(friction, 0.2), s.preset);
    let (sin, cos) = math::sin_cos(angle);
    world.gravity = DVec3::new(G * sin, 0.0, -G * cos);
    let exact = 0.5 * G * (sin - friction * cos) * 100.0;
    let world = RigidWorld::new(world).expect("a sound world");
    let went = go(&world, &[Start::at_rest(DVec3::Z * 0.02)], 10.0, s.guard, &mut ());
    let body = world.at(0, &went.state.bodies()[0], went.state.time());
    let moved = body.path.x.x;
    let text = format!("{:.3} mm, exact {:.3} mm, {}", 1e3 * moved, 1e3 * exact, went.told());
    // A preset may hold a body that is out of balance by less than it resolves, but the body must never run ahead.
    let off = if went.cut { f64::NAN } else { (moved / exact - 1.0).abs() };
    Found::new(!went.cut && moved <= 1.01 * exact && moved >= -1e-9, off, text)
}

/// A flat cuboid that slides to rest in a direction askew to its edges: friction slows it by µ g all the way, and it
/// does not turn.
pub fn slides(s: &Setting<'_>) -> Found {
    let (friction, v) = (0.3, DVec3::new(1.0, 0.3, 0.0));
    let world = on_floor(vec![cuboid(DVec3::new(0.1, 0.08, 0.02))], Law::new(friction, 0.2), s.preset);
    let world = RigidWorld::new(world).expect("a sound world");
    let start = Start { velocity: v, ..Start::at_rest(DVec3::Z * 0.01) };
    let went = go(&world, &[start], 10.0, s.guard, &mut ());
    let body = world.at(0, &went.state.bodies()[0], went.state.time());
    let exact = v * (v.length() / (2.0 * friction * G));
    let far = (body.path.x.with_z(0.0) - exact).length() / exact.length();
    let ahead = body.turn * DVec3::X;
    let yaw = math::atan2(ahead.y, ahead.x);
    let text = format!("off by {far:.1e} of the way, turned by {yaw:.1e} rad, {}", went.told());
    // Rounding, over a hundred steps or so.
    let holds = went.outcome == Outcome::AllAtRest && far < 1e-9 && yaw.abs() < 1e-9;
    Found::new(holds, if went.cut { f64::NAN } else { far }, text)
}

/// Two cubes thrown at each other as mirror images: they stay mirror images, whatever else happens to them. Rounding
/// differs between the two, and impacts let it grow, so the median says what the law does.
pub fn mirrored(s: &Setting<'_>) -> Found {
    let edge = 0.05;
    let (mut offs, mut met, mut cut) = (Vec::new(), 0, false);
    for k in 0..s.throws {
        let mut dice = Dice::new(41, k);
        let position = DVec3::new(-dice.between(2.0, 3.0) * edge, 0.0, dice.between(1.0, 3.0) * edge);
        let velocity = DVec3::new(dice.between(1.0, 1.5), dice.between(-0.1, 0.1), dice.between(-0.2, 0.5));
        let one = Start { velocity, orientation: dice.turn(), spin: dice.in_cube() * 8.0, ..Start::at_rest(position) };
        let world = on_floor(vec![cuboid(DVec3::splat(edge)); 2], Law::new(0.3, 0.4), s.preset);
        let world = RigidWorld::new(world).expect("a sound world");
        let went = go(&world, &[one, mirror(&one)], 0.3, s.guard, &mut ());
        let [a, b] = [0, 1].map(|k| world.at(k, &went.state.bodies()[k], went.state.time()));
        let image = mirror(&Start { position: a.path.x, orientation: a.turn, ..one });
        let turned = b.turn * image.orientation.conjugate();
        offs.push((b.path.x - image.position).length() / edge + turned.xyz().length());
        met += u32::from(a.path.v.x < 0.9 * one.velocity.x);
        cut |= went.cut;
    }
    offs.sort_by(f64::total_cmp);
    // About ten impacts, each of which lets rounding grow tenfold.
    let (median, worst) = (offs[offs.len() / 2], offs[offs.len() - 1]);
    let text =
        format!("{median:.1e} from the mirror image after 0.3 s, at worst {worst:.1e}; {met} of {} met", s.throws);
    Found::new(median < 1e-6 && !cut, if cut { f64::NAN } else { median }, text)
}

/// The mirror image in the plane x = 0; angular velocities are pseudovectors.
fn mirror(start: &Start) -> Start {
    let flip = DVec3::new(-1.0, 1.0, 1.0);
    let q = start.orientation;
    Start {
        position: start.position * flip,
        velocity: start.velocity * flip,
        spin: start.spin * -flip,
        orientation: DQuat::from_xyzw(q.x, -q.y, -q.z, q.w),
        time: start.time,
    }
}
