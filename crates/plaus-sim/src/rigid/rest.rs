//! Rest: slow bodies that their contacts can hold.

use super::body::Pose;
use super::scratch::{Place, RigidScratch};
use super::solve::{Enough, solve};
use super::touch::Touch;
use super::tumble::rotation;
use super::{Rigid, Spec};
use glam::{DMat3, DVec3};

/// Whether all bodies of a group are slow enough to be tested for rest.
pub(super) fn is_slow(world: &Rigid, group: &RigidScratch) -> bool {
    group.places.iter().all(|p| {
        let spec = &world.specs[p.body];
        match &spec.drive {
            Some(drive) => drive.is_still(p.clock),
            None => may_rest(world, spec, p.start.v, p.start.w),
        }
    })
}

/// Whether a body with these velocities is slow enough to be tested for rest.
pub(super) fn may_rest(world: &Rigid, spec: &Spec, v: DVec3, w: DVec3) -> bool {
    let limit = world.accuracy.rest_speed * spec.speed;
    v.length() <= limit && w.length() * spec.reach <= limit
}

/// A body that wobbles on the rim of its foot, or that touches with only a part of its foot yet. Its energy above lying
/// flat must be less than the preset's rest speed allows for its height. Returns the points of its foot, and the shift
/// and small rotation that lay it flat. A wobbling disk wobbles faster and faster, so its steps would get smaller and
/// smaller without end.
pub(super) fn lies_nearly_flat(world: &Rigid, group: &RigidScratch) -> Option<(Vec<Touch>, DVec3, DVec3)> {
    let ([place], [(_, first), ..], []) = (&group.places[..], &group.touches[..], &group.leaving[..]) else {
        return None;
    };
    let spec = &world.specs[place.body];
    let is_revolved = !spec.rings.is_empty();
    if !group.rows.is_empty()
        || !(spec.is_compound() || is_revolved)
        || !group.pairs.is_empty()
        || !group.parting.is_empty()
        || spec.is_driven()
    {
        return None;
    }
    if spec.torque() != DVec3::ZERO {
        return None;
    }
    // Heights above lying flat are at most two thirds of this if half of the energy is kinetic.
    let height = 0.5 * world.accuracy.rest_speed * world.accuracy.rest_speed * spec.size;
    let inertia = spec.inertia.momentum(place.turn, place.start.w).dot(place.start.w) / spec.mass;
    let motion = 0.5 * (place.start.v.length_squared() + inertia);
    let n = first.normal;
    let press = -n.dot(spec.pull);
    let slide = (spec.pull + n * press).length();
    let law = world.law_at(place.body, first, place.start.x + first.arm);
    // On ice, or on a slope too steep for friction to hold it, the body slides on.
    if motion > height * spec.strength.min(law.friction * press - slide) || press <= 0.0 {
        return None;
    }
    let mut foot = Vec::new();
    world.for_touches(place.body, &place.start, 2.0 * height, |t| foot.push(t));
    if foot.len() < 3 || !is_above(foot.iter().map(|t| t.arm), spec.pull / spec.strength) {
        return None;
    }
    let (shift, turn) = flatten(foot.iter())?;
    if motion + spec.pull.dot(shift) > height * spec.strength {
        return None;
    }
    // Points in a row, such as those of a can on its side, do not determine the rotation about their line.
    let turned = (rotation(turn) * place.turn).normalize();
    let there = Pose { x: place.start.x + shift, r: DMat3::from_quat(turned), ..place.start };
    let mut is_deep = false;
    world.for_touches(place.body, &there, -spec.gap, |_| is_deep = true);
    (!is_deep).then_some((foot, shift, turn))
}

/// Whether contacts can hold bodies at rest. `h` is the length of a step.
pub(super) fn is_supported(world: &Rigid, group: &mut RigidScratch, h: f64) -> bool {
    if !group.leaving.is_empty() || !group.parting.is_empty() || !h.is_finite() {
        return false;
    }
    if group.has_faces_in_touch() && group.least_gap(world) < 0.0 {
        return false;
    }
    // Another step reduces an overlap that is too large to be tidied.
    if is_deep(world, group) {
        return false;
    }
    if let [place] = &group.places[..]
        && group.rows.is_empty()
        && world.specs[place.body].torque() == DVec3::ZERO
    {
        let spec = &world.specs[place.body];
        // Its points are in a row: nothing but resistance keeps it from rolling.
        let is_on_its_side = spec.is_round && lies(group, 0, spec.size);
        if spec.is_ball {
            if let [(_, only)] = &group.touches[..] {
                return rests_on_its_point(world, place, only, h);
            }
            if group.touches.iter().all(|t| t.1.point().is_some()) {
                return false;
            }
        } else if group.touches.len() < 3 && !is_on_its_side && !is_sphere(spec) {
            return false;
        }
        let normal = group.touches.first().map_or(DVec3::Z, |t| t.1.normal);
        if group.touches.len() >= 3 && !is_on_its_side && group.touches.iter().all(|t| t.1.normal == normal) {
            // Flat ground: the centre of gravity must be above the points, and the slope no steeper than friction
            // allows.
            let first = &group.touches[0].1;
            let law = world.law_at(place.body, first, place.start.x + first.arm);
            let press = -spec.pull.dot(normal);
            let slide = (spec.pull + normal * press).length();
            // Friction must be able to stop the remaining motion within a step: on ice the body slides on.
            let (v, w) = (place.start.v, place.start.w);
            let moves = (v - normal * v.dot(normal)).length() + w.dot(normal).abs() * spec.reach;
            return moves <= (law.friction * press - slide + NO_MOTION * press) * h
                && slide <= law.friction * press
                && is_above(group.touches.iter().map(|t| t.1.arm), spec.pull / spec.strength);
        }
    }
    let limit = world.accuracy.rest_residual * world.strength * h;
    let fastest = |p: &Place| p.start.v.length().max(p.start.w.length() * world.specs[p.body].reach);
    let fastest = group.places.iter().map(fastest).fold(0.0, f64::max);
    let residual = limit.min(STOPPED * fastest).max(NO_MOTION * world.strength * h);
    // In a pile near tipping, the forces that a corner carries are found slowly; in a large heap, all are.
    let patience = if group.has_faces_in_touch() || group.newton.in_rounds { PATIENCE } else { 1 };
    let enough = Enough::new(0.03 * limit / f64::from(patience), world.strength * h);
    // A body that contacts cannot stop within a step is not at rest. Nor is one that swings, at its turning point.
    let sweeps = world.accuracy.sweeps * patience;
    if !are_stopped(world, group, [h, 1.0, residual], enough, sweeps) {
        return group.stays;
    }
    let held = NO_MOTION * world.strength * h;
    group.rows.is_empty() || are_stopped(world, group, [h, 0.0, held], Enough::new(0.1 * held, held), sweeps)
}

/// Whether points are so deep in what they touch that a body must not lie down there.
pub(super) fn is_deep(world: &Rigid, group: &RigidScratch) -> bool {
    let size = |k: usize| world.specs[group.places[k].body].size;
    group.touches.iter().any(|(k, t)| t.gap < -OVERLAP * size(*k))
        || group.pairs.iter().any(|([a, b], t)| t.gap < -OVERLAP * size(*a).min(size(*b)))
}

/// Whether contacts leave bodies at most the speed `most` after a kick of `h` seconds, when bodies start with the
/// fraction `part` of their velocities. In a crowd too, this is found as exactly as elsewhere.
fn are_stopped(world: &Rigid, group: &mut RigidScratch, kick: [f64; 3], enough: Enough, sweeps: u32) -> bool {
    let [in_crowd, is_hard] =
        [&mut group.newton.in_crowd, &mut group.newton.is_hard].map(|is| std::mem::replace(is, false));
    let are_stopped = are_stopped_exactly(world, group, kick, enough, sweeps);
    (group.newton.in_crowd, group.newton.is_hard) = (in_crowd, is_hard);
    are_stopped
}

/// The same, as exactly as in a small group.
pub(super) fn are_stopped_exactly(
    world: &Rigid,
    group: &mut RigidScratch,
    [h, part, most]: [f64; 3],
    enough: Enough,
    sweeps: u32,
) -> bool {
    let prepare = |group: &mut RigidScratch| {
        group.prepare(world, h, |spec, p| {
            let (v, w) = (p.start.v * part, p.start.w * part);
            if spec.is_driven() { (v, w) } else { spec.kicked(&p.start.r, [v, w], h) }
        });
        group.leave_out_distant(world);
    };
    prepare(group);
    if group.newton.in_rounds {
        group.guess_loads(h);
    }
    group.newton.is_rough = false;
    solve(&mut group.contacts, &mut group.members, &mut group.newton, enough, sweeps);
    if group.members.iter().all(|m| m.fastest() <= most) {
        return true;
    }
    if group.resistance_stops(world, most, Enough::new(0.1 * most, world.strength * h), sweeps) {
        return true;
    }
    if !group.newton.is_rough || group.newton.in_rounds || group.is_open(world) {
        return false;
    }
    // Bodies that wedge each other: no motion that obeys the law was found.
    prepare(group);
    group.newton.hold(&mut group.contacts, &mut group.members, most)
}

/// Fraction of a motion that may remain after contacts try to stop it. Default 0.1: friction that is too weak leaves
/// all of it.
const STOPPED: f64 = 0.1;

/// Velocity over `g · step` that counts as none when contacts are tested. Default 1e-6, above the solver's error.
pub(super) const NO_MOTION: f64 = 1e-6;

/// Whether a ball that touches at one point stays: the ground is no steeper than its resistance to rolling can hold,
/// and it is no faster than its weight along the ground can make it within a step.
fn rests_on_its_point(world: &Rigid, place: &Place, touch: &Touch, h: f64) -> bool {
    let spec = &world.specs[place.body];
    let slope = touch.normal.cross(spec.pull).length() / spec.strength;
    let press = -touch.normal.dot(spec.pull) / spec.strength;
    let rolling = world.law_at(place.body, touch, place.start.x + touch.arm).rolling;
    let limit = (slope + NO_MOTION) * spec.strength * h;
    press > 0.0
        && (slope <= LEVEL || slope <= rolling * press)
        && place.start.v.length().max(place.start.w.length() * spec.reach) <= limit
}

/// Sine of the slope up to which ground counts as level under a ball. Default 1e-9, rounding of a triangle's normal.
const LEVEL: f64 = 1e-9;

/// Whether a body's skin is one sphere, wherever its centre of gravity is.
fn is_sphere(spec: &Spec) -> bool {
    spec.hull == 1 && spec.rings.is_empty()
}

/// Whether a member can turn in no other way than by rolling: a ball, or a body of revolution on its side. A pin that
/// leans on the rim of its foot can also tip.
pub(super) fn only_rolls(world: &Rigid, group: &RigidScratch, member: usize) -> bool {
    let spec = &world.specs[group.places[member].body];
    is_sphere(spec) || (spec.is_round && lies(group, member, spec.size))
}

/// Whether a body of revolution lies on two points of its side.
fn lies(group: &RigidScratch, member: usize, size: f64) -> bool {
    let axis = group.places[member].start.r.z_axis;
    let on_parts = group.touches.iter().map(|(k, t)| (*k, t.arm));
    let between = group.pairs.iter().flat_map(|(ab, t)| ab.iter().copied().zip(t.arms));
    let arms = on_parts.chain(between).filter(|(k, _)| *k == member);
    let along = || arms.clone().map(|(_, arm)| arm.dot(axis));
    along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min) > 0.5 * size
}

/// Whether the vertical line through the centre of gravity meets the convex hull of the points: then no half plane
/// holds them all.
fn is_above(arms: impl Iterator<Item = DVec3> + Clone, down: DVec3) -> bool {
    let flat = |arm: DVec3| arm - down * arm.dot(down);
    arms.clone().all(|a| {
        let p = flat(a);
        let margin = MARGIN * p.length_squared();
        let (mut left, mut right, mut opposite) = (false, false, false);
        for b in arms.clone() {
            let q = flat(b);
            let side = p.cross(q).dot(down);
            left |= side > margin;
            right |= side < -margin;
            opposite |= side.abs() <= margin && p.dot(q) < 0.0;
        }
        (left && right) || (opposite && (left || right))
    })
}

/// Factor by which the test of a pile may take more sweeps, and by which their last change must be smaller. Default 10.
const PATIENCE: u32 = 10;

/// Overlap over the size up to which a body may lie down; it is then lifted out. Default 1e-3, a hundred times the
/// overlap that steps of the draft preset leave.
const OVERLAP: f64 = 1e-3;

/// Shift and small rotation that bring the touching points of a body on flat ground to gap 0: by least squares, exact
/// for three points and for the corners of a face.
pub(super) fn flatten<'t>(touches: impl Iterator<Item = &'t Touch> + Clone) -> Option<(DVec3, DVec3)> {
    let normal = touches.clone().next()?.normal;
    if touches.clone().count() < 3 || touches.clone().any(|t| t.normal != normal) {
        return None;
    }
    let (first, second) = normal.any_orthonormal_pair();
    let size = touches.clone().map(|t| t.arm.length()).fold(0.0, f64::max);
    // Unknowns: the shift along the normal, and the rotations about the two tangents, times the size.
    let row = |t: &Touch| {
        let lever = t.arm.cross(normal) / size;
        DVec3::new(1.0, first.dot(lever), second.dot(lever))
    };
    let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for t in touches {
        let r = row(t);
        matrix += DMat3::from_cols(r * r.x, r * r.y, r * r.z);
        right -= r * t.gap;
    }
    // Points on one line do not determine one of the rotations.
    if matrix.determinant().abs() <= 1e-9 {
        return None;
    }
    let s = matrix.inverse() * right;
    Some((normal * s.x, (first * s.y + second * s.z) / size))
}

/// Sine of the angle below which points count as opposite. Default 1e-6.
const MARGIN: f64 = 1e-6;
