//! Steps of bodies on joints that an event interrupts.
//!
//! Half way through a step, the points of a joint are apart by the mid-step drift of its curve, and velocities are
//! means of those at its ends. The next step would have to close the gap, however short it is, and a body that is
//! pushed aside keeps the speed. So a step that is interrupted is taken again, from where it began to the time of the
//! event: what a joint holds is together then, and energy is as right as after any other step.

use super::swing_step::is_stepping;
use crate::links::Links;
use crate::rigid::RigidWorld;
use crate::rigid::body_state::RigidBodyState;
use crate::rigid::scratch::RigidScratch;
use crate::rigid::tolerances::{JOINT_GAP, UNTRUNCATED_ENDS};

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
    let is_held = island.iter().any(|&k| world.bonds_of(k as usize, bodies).next().is_some());
    if !is_within || !is_one_step || !is_held {
        return;
    }
    for &k in island {
        if is_stepping(&bodies[k as usize]) {
            bodies[k as usize].go_back(&world.specs[k as usize]);
        }
    }
    scratch.gather(world, island, bodies, links);
    let h = time - start;
    scratch.nominal = end - start;
    scratch.newton.gives_way = false;
    if !scratch.swing_again(world, bodies, h) {
        (scratch.push, scratch.closed) = (1.0, JOINT_GAP);
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
