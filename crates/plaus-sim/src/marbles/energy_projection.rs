//! Takes back the energy that discretisation adds to a step, only from motions that contacts and gravity act on.
//!
//! A group has some rigid motions in which no contact and no gravity does work: two balls over a frictionless floor
//! move on together and turn about each other, or a ball rolls around a bowl. The laws conserve the momentum of each
//! such motion, so the guard must not take from it. Velocities are split into that part and the rest, which are
//! orthogonal in the kinetic energy, and only the rest is slowed. If the rest does not have enough energy, as at the
//! turning point of a swing, it is stopped, and the remainder stays.

use super::Marbles;
use super::solve::{Contact, Member, With};
use glam::DVec3;

/// A unit vector counts as spanned by others if less than this length of it is left. Default 1e-9.
const SPANNED: f64 = 1e-9;

/// Energy that is ignored, relative to that of a lift by the height that the preset does not see. Default 1e-3.
pub(super) const FORGIVEN: f64 = 1e-3;

type Row = [f64; 6];

/// Takes back the energy that a step of a group has added; false if there was not enough to take it from.
pub(super) fn guard(world: &Marbles, members: &mut [Member], contacts: &[Contact]) -> bool {
    let rubs = |k: usize| contacts.iter().any(|c| c.is_loaded() && c.law.friction > 0.0 && c.concerns(k));
    let kinetic = |m: &Member, turns: bool, v: DVec3, w: DVec3| {
        0.5 * (m.ball.mass * v.length_squared() + if turns { m.ball.inertia() * w.length_squared() } else { 0.0 })
    };
    let (mut before, mut after) = (0.0, 0.0);
    for m in members.iter().filter(|m| m.is_held) {
        before += kinetic(m, true, m.start_v, m.start_w) + m.ball.mass * world.gravity.dot(m.x - m.start);
        after += kinetic(m, true, m.v, m.w);
    }
    if after <= before {
        return true;
    }
    let turning: Vec<bool> = (0..members.len()).map(rubs).collect();
    let kept = kept_motion(world, members, contacts, &turning);
    let (mut fixed, mut rest) = (0.0, 0.0);
    for (k, m) in members.iter().enumerate().filter(|(_, m)| m.is_held) {
        let (v, w) = kept[k];
        let spin = if turning[k] { 0.0 } else { 0.5 * m.ball.inertia() * m.w.length_squared() };
        fixed += kinetic(m, turning[k], v, w) + spin;
        rest += kinetic(m, turning[k], m.v - v, m.w - w);
    }
    let part = if rest > 0.0 { ((before - fixed) / rest).clamp(0.0, 1.0).sqrt() } else { 1.0 };
    let weight: f64 = members.iter().filter(|m| m.is_held).map(|m| m.ball.mass * m.ball.radius).sum();
    let enough = fixed - before <= FORGIVEN * world.unseen * world.strength * weight;
    for (k, m) in members.iter_mut().enumerate().filter(|(_, m)| m.is_held) {
        let (v, w) = kept[k];
        m.v = v + (m.v - v) * part;
        if turning[k] {
            m.w = w + (m.w - w) * part;
        }
    }
    enough
}

/// The part of the velocities and spins that is a rigid motion on which neither contacts nor gravity act.
fn kept_motion(world: &Marbles, members: &[Member], contacts: &[Contact], turning: &[bool]) -> Vec<(DVec3, DVec3)> {
    let held = || members.iter().enumerate().filter(|(_, m)| m.is_held);
    let mass: f64 = held().map(|(_, m)| m.ball.mass).sum();
    let centre = held().map(|(_, m)| m.x * m.ball.mass).sum::<DVec3>() / mass;
    let size = held().map(|(_, m)| (m.x - centre).length() + m.ball.radius).fold(0.0, f64::max);
    let mut acted_on = Vec::new();
    let row = |d: DVec3, at: DVec3| {
        let turn = (at - centre).cross(d) / size;
        [d.x, d.y, d.z, turn.x, turn.y, turn.z]
    };
    add(&mut acted_on, row(world.gravity.normalize_or_zero(), centre));
    for c in contacts.iter().filter(|c| c.is_loaded() && matches!(c.with, With::Surface(_))) {
        let (m, n) = (&members[c.a], c.push.last);
        if c.law.friction > 0.0 {
            let at = m.x - n * m.ball.radius;
            [DVec3::X, DVec3::Y, DVec3::Z].into_iter().for_each(|d| add(&mut acted_on, row(d, at)));
        } else {
            add(&mut acted_on, row(n, m.x));
        }
    }
    let mut kept = vec![(DVec3::ZERO, DVec3::ZERO); members.len()];
    let mut ways: Vec<Vec<(DVec3, DVec3)>> = Vec::new();
    for twist in complement(&acted_on) {
        let (u, turn) = (DVec3::from_slice(&twist), DVec3::from_slice(&twist[3..]) / size);
        let mut way: Vec<(DVec3, DVec3)> = members
            .iter()
            .zip(turning)
            .map(|(m, &t)| (u + turn.cross(m.x - centre), if t { turn } else { DVec3::ZERO }))
            .collect();
        let dot = |way: &[(DVec3, DVec3)], of: &dyn Fn(usize) -> (DVec3, DVec3)| -> f64 {
            held().map(|(k, m)| m.ball.mass * way[k].0.dot(of(k).0) + m.ball.inertia() * way[k].1.dot(of(k).1)).sum()
        };
        let whole = dot(&way, &|k| way[k]).sqrt();
        for known in &ways {
            let share = dot(known, &|k| way[k]);
            way.iter_mut().zip(known).for_each(|(a, b)| *a = (a.0 - b.0 * share, a.1 - b.1 * share));
        }
        let left = dot(&way, &|k| way[k]).sqrt();
        if left <= SPANNED * whole {
            continue;
        }
        way.iter_mut().for_each(|a| *a = (a.0 / left, a.1 / left));
        let amount = dot(&way, &|k| (members[k].v, members[k].w));
        kept.iter_mut().zip(&way).for_each(|(a, b)| *a = (a.0 + b.0 * amount, a.1 + b.1 * amount));
        ways.push(way);
    }
    kept
}

/// Adds the new part of a row to orthonormal ones.
fn add(rows: &mut Vec<Row>, row: Row) {
    let whole = length(&row);
    let mut rest = row;
    rows.iter().for_each(|known| remove(&mut rest, known));
    let left = length(&rest);
    if left > SPANNED * whole {
        rows.push(rest.map(|x| x / left));
    }
}

/// An orthonormal basis of the complement of orthonormal rows.
fn complement(rows: &[Row]) -> Vec<Row> {
    let mut known = rows.to_vec();
    while known.len() < 6 {
        let rest = |axis: usize| {
            let mut unit = [0.0; 6];
            unit[axis] = 1.0;
            known.iter().for_each(|k| remove(&mut unit, k));
            unit
        };
        // The longest is at least the root of a sixth.
        let longest = (0..6).map(rest).reduce(|a, b| if length(&b) > length(&a) { b } else { a }).unwrap_or([0.0; 6]);
        let scale = length(&longest);
        known.push(longest.map(|x| x / scale));
    }
    known.split_off(rows.len())
}

fn remove(from: &mut Row, unit: &Row) {
    let share: f64 = from.iter().zip(unit).map(|(x, y)| x * y).sum();
    from.iter_mut().zip(unit).for_each(|(x, y)| *x -= share * y);
}

fn length(row: &Row) -> f64 {
    row.iter().map(|x| x * x).sum::<f64>().sqrt()
}
