//! Rest: slow bodies that their contacts can hold.

use crate::rigid::body_state::Pose;
use crate::rigid::motion::free_rotation::rotation;
use crate::rigid::narrow_phase::contact_point::ContactPoint;
use crate::rigid::scratch::{RigidScratch, StepPoses};
use crate::rigid::solver::contact_constraint::SolverBody;
use crate::rigid::solver::{SolverTolerance, solve};
use crate::rigid::tolerances::{
    LEVEL_UNDER_BALL, NO_MOTION, OPPOSITE_POINTS, SLEEP_OVERLAP, SLEEP_PATIENCE, STILL_OVERLAP, STOPPED_MOTION,
};
use crate::rigid::{BodyDef, RigidWorld};
use glam::{DMat3, DVec3};

/// Whether all bodies of an island are slow enough to be tested for rest.
pub(super) fn is_slow(world: &RigidWorld, island: &RigidScratch) -> bool {
    island.places.iter().all(|p| {
        let spec = &world.specs[p.body];
        match &spec.drive {
            Some(drive) => drive.is_still(p.clock),
            None => may_rest(world, spec, p.start.v, p.start.w),
        }
    }) && island.motors(world).all(|(motor, clock)| motor.is_still(clock))
}

/// Whether a body with these velocities is slow enough to be tested for rest.
pub(super) fn may_rest(world: &RigidWorld, spec: &BodyDef, v: DVec3, w: DVec3) -> bool {
    let limit = world.accuracy.rest_speed * spec.speed;
    v.length() <= limit && w.length() * spec.bounding_radius <= limit
}

/// A body that wobbles on the rim of its foot, or that touches with only a part of its foot yet. Its energy above lying
/// flat must be less than the preset's rest speed allows for its height. Returns the points of its foot, and the shift
/// and small rotation that lay it flat. A wobbling disk wobbles faster and faster, so its steps would get smaller and
/// smaller without end.
pub(super) fn lies_nearly_flat(world: &RigidWorld, island: &RigidScratch) -> Option<(Vec<ContactPoint>, DVec3, DVec3)> {
    let ([place], [(_, first), ..], []) = (&island.places[..], &island.touches[..], &island.leaving[..]) else {
        return None;
    };
    let spec = &world.specs[place.body];
    let is_revolved = !spec.rings.is_empty();
    if !island.rows.is_empty()
        || !(spec.is_compound() || is_revolved)
        || !island.pairs.is_empty()
        || !island.parting.is_empty()
        || spec.is_driven()
    {
        return None;
    }
    if spec.is_turned() {
        return None;
    }
    // Heights above lying flat are at most two thirds of this if half of the energy is kinetic.
    let height = 0.5 * world.accuracy.rest_speed * world.accuracy.rest_speed * spec.size;
    let inertia = spec.inertia.momentum(place.turn, place.start.w).dot(place.start.w) / spec.mass;
    let motion = 0.5 * (place.start.v.length_squared() + inertia);
    let n = first.normal;
    let press = -n.dot(spec.gravity);
    let slide = (spec.gravity + n * press).length();
    let law = world.law_at(place.body, first, place.start.x + first.arm);
    // On ice, or on a slope too steep for friction to hold it, the body slides on.
    if motion > height * spec.gravity_magnitude.min(law.friction * press - slide) || press <= 0.0 {
        return None;
    }
    let mut projection = Vec::new();
    world.for_touches(place.body, &place.start, 2.0 * height, |t| projection.push(t));
    if projection.len() < 3 || !is_above(projection.iter().map(|t| t.arm), spec.gravity / spec.gravity_magnitude) {
        return None;
    }
    let (shift, turn) = flatten(projection.iter())?;
    if motion + spec.gravity.dot(shift) > height * spec.gravity_magnitude {
        return None;
    }
    // Points in a row, such as those of a can on its side, do not determine the rotation about their line.
    let turned = (rotation(turn) * place.turn).normalize();
    let there = Pose { x: place.start.x + shift, r: DMat3::from_quat(turned), ..place.start };
    let mut is_deep = false;
    world.for_touches(place.body, &there, -spec.gap, |_| is_deep = true);
    (!is_deep).then_some((projection, shift, turn))
}

/// Whether contacts can hold bodies at rest. `h` is the length of a step.
pub(super) fn is_supported(world: &RigidWorld, island: &mut RigidScratch, h: f64) -> bool {
    if !island.leaving.is_empty() || !island.parting.is_empty() || !h.is_finite() {
        return false;
    }
    if island.has_faces_in_touch() && island.least_gap(world) < 0.0 {
        return false;
    }
    // Another step reduces an overlap that is too large to be tidied.
    if is_deep(world, island) {
        return false;
    }
    if let [place] = &island.places[..]
        && island.rows.is_empty()
        && !world.specs[place.body].is_turned()
    {
        let spec = &world.specs[place.body];
        // Its points are in a row: nothing but resistance keeps it from rolling.
        let is_on_its_side = spec.is_round && lies(island, 0, spec.size);
        if spec.is_ball {
            if let [(_, only)] = &island.touches[..] {
                return rests_on_its_point(world, place, only, h);
            }
            if island.touches.iter().all(|t| t.1.point().is_some()) {
                return false;
            }
        } else if island.touches.len() < 3 && !is_on_its_side && !is_sphere(spec) {
            return false;
        }
        let normal = island.touches.first().map_or(DVec3::Z, |t| t.1.normal);
        if island.touches.len() >= 3 && !is_on_its_side && island.touches.iter().all(|t| t.1.normal == normal) {
            // Flat ground: the centre of gravity must be above the points, and the slope no steeper than friction
            // allows.
            let first = &island.touches[0].1;
            let law = world.law_at(place.body, first, place.start.x + first.arm);
            let press = -spec.gravity.dot(normal);
            let slide = (spec.gravity + normal * press).length();
            // Friction must be able to stop the remaining motion within a step: on ice the body slides on.
            let (v, w) = (place.start.v, place.start.w);
            let moves = (v - normal * v.dot(normal)).length() + w.dot(normal).abs() * spec.bounding_radius;
            let stops = |friction: f64| moves <= (friction * press - slide + NO_MOTION * press) * h;
            let holds = |friction: f64| slide <= friction * press;
            return (stops(law.friction) && holds(law.friction) || moves <= NO_MOTION * press * h && holds(law.grip()))
                && is_above(island.touches.iter().map(|t| t.1.arm), spec.gravity / spec.gravity_magnitude);
        }
    }
    let limit = world.accuracy.rest_residual * world.gravity_magnitude * h;
    let fastest = |p: &StepPoses| p.start.v.length().max(p.start.w.length() * world.specs[p.body].bounding_radius);
    let fastest = island.places.iter().map(fastest).fold(0.0, f64::max);
    let residual = limit.min(STOPPED_MOTION * fastest).max(NO_MOTION * world.gravity_magnitude * h);
    // In an island near tipping, the forces that a corner carries are found slowly; in a large island, all are.
    let patience = if island.has_faces_in_touch() || island.newton.in_rounds { SLEEP_PATIENCE } else { 1 };
    let enough = SolverTolerance::new(0.03 * limit / f64::from(patience), world.gravity_magnitude * h);
    // A body that contacts cannot stop within a step is not at rest. Nor is one that swings or rocks, at its turning
    // point: contacts cannot hold it there.
    let sweeps = world.accuracy.sweeps * patience;
    if !are_stopped(world, island, [h, 1.0, residual], enough, sweeps) {
        return island.stays;
    }
    if island.rows.is_empty() {
        return are_stopped(world, island, [h, 0.0, limit], enough, sweeps);
    }
    let held = NO_MOTION * world.gravity_magnitude * h;
    are_stopped(world, island, [h, 0.0, held], SolverTolerance::new(0.1 * held, held), sweeps)
}

/// Whether a step of `h` seconds that was found by lawful impulses, but not exactly, began and left bodies still, and
/// out of overlaps but for a few gaps.
pub(super) fn is_still(world: &RigidWorld, island: &RigidScratch, h: f64) -> bool {
    let limit = world.accuracy.rest_residual * world.gravity_magnitude * h;
    let mut ends = island.places.iter().zip(&island.members);
    let is_still = |(p, m): (&StepPoses, &SolverBody)| {
        m.fastest().max(p.start.v.length()).max(p.start.w.length() * m.bounding_radius) <= limit
    };
    ends.all(is_still) && !is_deep(world, island) && island.least_gap(world) >= -STILL_OVERLAP
}

/// Whether points are so deep in what they touch that a body must not lie down there.
pub(super) fn is_deep(world: &RigidWorld, island: &RigidScratch) -> bool {
    let size = |k: usize| world.specs[island.places[k].body].size;
    island.touches.iter().any(|(k, t)| t.gap < -SLEEP_OVERLAP * size(*k))
        || island.pairs.iter().any(|([a, b], t)| t.gap < -SLEEP_OVERLAP * size(*a).min(size(*b)))
}

/// Whether contacts leave bodies at most the speed `most` after a kick of `h` seconds, when bodies start with the
/// fraction `part` of their velocities. In a time-stepped island too, this is found as exactly as elsewhere.
fn are_stopped(
    world: &RigidWorld,
    island: &mut RigidScratch,
    kick: [f64; 3],
    enough: SolverTolerance,
    sweeps: u32,
) -> bool {
    let [is_time_stepped, is_hard] =
        [&mut island.newton.is_time_stepped, &mut island.newton.is_hard].map(|is| std::mem::replace(is, false));
    let are_stopped = are_stopped_exactly(world, island, kick, enough, sweeps);
    (island.newton.is_time_stepped, island.newton.is_hard) = (is_time_stepped, is_hard);
    are_stopped
}

/// The same, as exactly as in a small island.
pub(super) fn are_stopped_exactly(
    world: &RigidWorld,
    island: &mut RigidScratch,
    [h, part, most]: [f64; 3],
    enough: SolverTolerance,
    sweeps: u32,
) -> bool {
    let prepare = |island: &mut RigidScratch| {
        island.prepare(world, h, |spec, p| {
            let (v, w) = (p.start.v * part, p.start.w * part);
            if spec.is_driven() { (v, w) } else { spec.kicked(&p.start.r, [v, w], h) }
        });
        island.leave_out_distant(world);
    };
    prepare(island);
    if island.newton.in_rounds {
        island.guess_loads(h);
    }
    island.newton.is_rough = false;
    solve(&mut island.contacts, &mut island.members, &mut island.newton, enough, sweeps);
    if island.members.iter().all(|m| m.fastest() <= most) {
        return true;
    }
    if island.resistance_stops(world, most, SolverTolerance::new(0.1 * most, world.gravity_magnitude * h), sweeps) {
        return true;
    }
    if !island.newton.is_rough || island.newton.in_rounds || island.is_open(world) {
        return false;
    }
    // Bodies that wedge each other: no motion that obeys the law was found.
    prepare(island);
    island.newton.hold(&mut island.contacts, &mut island.members, most)
}

/// Whether a ball that touches at one point stays: the ground is no steeper than its resistance to rolling can hold,
/// and it is no faster than its weight along the ground can make it within a step.
fn rests_on_its_point(world: &RigidWorld, place: &StepPoses, touch: &ContactPoint, h: f64) -> bool {
    let spec = &world.specs[place.body];
    let slope = touch.normal.cross(spec.gravity).length() / spec.gravity_magnitude;
    let press = -touch.normal.dot(spec.gravity) / spec.gravity_magnitude;
    let rolling = world.law_at(place.body, touch, place.start.x + touch.arm).rolling;
    let limit = (slope + NO_MOTION) * spec.gravity_magnitude * h;
    press > 0.0
        && (slope <= LEVEL_UNDER_BALL || slope <= rolling * press)
        && place.start.v.length().max(place.start.w.length() * spec.bounding_radius) <= limit
}

/// Whether a body's skin is one sphere, wherever its centre of gravity is.
fn is_sphere(spec: &BodyDef) -> bool {
    spec.hull == 1 && spec.rings.is_empty()
}

/// Whether a member can turn in no other way than by rolling: a ball, or a body of revolution on its side. A pin that
/// leans on the rim of its foot can also tip.
pub(super) fn only_rolls(world: &RigidWorld, island: &RigidScratch, member: usize) -> bool {
    let spec = &world.specs[island.places[member].body];
    is_sphere(spec) || (spec.is_round && lies(island, member, spec.size))
}

/// Whether a body of revolution lies on two points of its side.
fn lies(island: &RigidScratch, member: usize, size: f64) -> bool {
    let axis = island.places[member].start.r.z_axis;
    let on_parts = island.touches.iter().map(|(k, t)| (*k, t.arm));
    let between = island.pairs.iter().flat_map(|(ab, t)| ab.iter().copied().zip(t.arms));
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
        let margin = OPPOSITE_POINTS * p.length_squared();
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

/// Shift and small rotation that bring the touching points of a body on flat ground to gap 0: by least squares, exact
/// for three points and for the corners of a face.
pub(crate) fn flatten<'t>(touches: impl Iterator<Item = &'t ContactPoint> + Clone) -> Option<(DVec3, DVec3)> {
    let normal = touches.clone().next()?.normal;
    if touches.clone().count() < 3 || touches.clone().any(|t| t.normal != normal) {
        return None;
    }
    let (first, second) = normal.any_orthonormal_pair();
    let size = touches.clone().map(|t| t.arm.length()).fold(0.0, f64::max);
    // Unknowns: the shift along the normal, and the rotations about the two tangents, times the size.
    let row = |t: &ContactPoint| {
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
