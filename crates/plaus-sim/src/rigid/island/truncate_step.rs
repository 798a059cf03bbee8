//! Steps of bodies on joints, and of a body alone that pivots, that an event interrupts.
//!
//! Half way through a step, the points of a joint are apart by the mid-step drift of its curve, and velocities are
//! means of those at its ends. The next step would have to close the gap, however short it is, and a body that is
//! pushed aside keeps the speed. So a step that is interrupted is taken again, from where it began to the time of the
//! event: what a joint holds is together then, and energy is as right as after any other step. The same holds for a
//! body that pivots about a corner or an edge: half way through a step, that is not where it turns.

use super::articulated_step::is_stepping;
use crate::links::Links;
use crate::rigid::RigidWorld;
use crate::rigid::body_state::{Phase, Pose, RigidBodyState};
use crate::rigid::scratch::RigidScratch;
use crate::rigid::tolerances::{CONTACT_MARGIN, UNTRUNCATED_ENDS};
use crate::scenery::Surface;

/// Takes the step of an island again if `time` is within it, so that it ends then.
pub(crate) fn truncate_step(
    world: &RigidWorld,
    island: &[u32],
    bodies: &mut [RigidBodyState],
    links: &mut Links,
    scratch: &mut RigidScratch,
    time: f64,
) {
    let Some(first) = island.iter().copied().find(|&k| is_stepping(&bodies[k as usize])) else { return };
    let (start, end) = (bodies[first as usize].path.t, bodies[first as usize].expiry);
    let margin = UNTRUNCATED_ENDS * (end - start);
    let is_within = start + margin < time && time < end - margin;
    let is_one_step = island.iter().all(|&k| {
        let body = &bodies[k as usize];
        body.path.t == start && (!is_stepping(body) || body.expiry == end)
    });
    if !is_within || !is_one_step {
        return;
    }
    let is_held = island.iter().any(|&k| world.bonds_of(k as usize, bodies).next().is_some());
    if !is_held && (island.len() > 1 || !leaves_contact(world, island, bodies, time)) {
        return;
    }
    let before: Vec<RigidBodyState> =
        if is_held { Vec::new() } else { island.iter().map(|&k| bodies[k as usize].clone()).collect() };
    for &k in island {
        if is_stepping(&bodies[k as usize]) {
            bodies[k as usize].go_back(&world.specs[k as usize]);
        }
    }
    scratch.gather(world, island, bodies, links);
    let h = time - start;
    scratch.nominal = end - start;
    scratch.newton.gives_way = false;
    let is_found = scratch.retake_articulated_step(world, bodies, h)
        || scratch.arc_step(world, bodies, h)
        || scratch.pivot_step(world, bodies, h);
    if !is_found {
        if !is_held {
            for (&k, before) in island.iter().zip(before) {
                bodies[k as usize] = before;
            }
            return;
        }
        (scratch.push, scratch.closed) = (1.0, world.joint_gap());
        let step = scratch.drift(world, h);
        if scratch.tears(world, h).is_some() {
            scratch.give_in(world, h);
        } else {
            scratch.second_kick(world, &step);
        }
        scratch.write(world, bodies, h);
    }
    for &k in island {
        if is_stepping(&bodies[k as usize]) {
            bodies[k as usize].expiry = time;
        }
    }
}

/// Whether points of an island's lasting contacts are, at this time within its step, farther from what they touch than
/// points that touch, or deeper in it, than they were at its start.
fn leaves_contact(world: &RigidWorld, island: &[u32], bodies: &[RigidBodyState], time: f64) -> bool {
    island.iter().any(|&k| {
        let (index, body) = (k as usize, &bodies[k as usize]);
        if body.phase != Phase::Step || body.time_step_island != 0 {
            return false;
        }
        let (now, then) = (body.pose(), world.on_its_way(index, body, time).pose());
        let strays = |gaps: [f64; 2], level: f64| (gaps[1] - gaps[0]).abs() > CONTACT_MARGIN * level;
        let gap = |pose: &Pose, surface: Surface| world.touch(index, pose, surface).gap;
        body.touching().iter().any(|&s| strays([gap(&now, s), gap(&then, s)], world.specs[index].gap))
    })
}
