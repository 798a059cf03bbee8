//! What a group of marbles does next: drops contacts and links that have ended, then chooses a closed form, a step or
//! rest.

use super::body::{Ending, Marble, Phase};
use super::island::{MarbleScratch, OVERLAP};
use super::{Marbles, analytic, single};
use crate::links::{Link, Links};
use crate::scenery::{Projection, Surface};

/// Separating speed, over `√(g r)` plus the body's own, that never ends a contact. Default 1e-9: far above rounding,
/// far below any motion.
const KEEP: f64 = 1e-9;

/// Decides what a group of marbles does next.
pub(super) fn settle(
    world: &Marbles,
    members: &[u32],
    bodies: &mut [Marble],
    links: &mut Links,
    scratch: &mut MarbleScratch,
) {
    let mut projection = None;
    for &k in members {
        projection = follow_contacts(world, k as usize, &mut bodies[k as usize]);
    }
    if !links.is_empty() {
        links.retain(|link| members.binary_search(&link[0]).is_err() || link_lasts(world, link, bodies));
    }
    if let [only] = *members {
        let (index, body) = (only as usize, &mut bodies[only as usize]);
        if body.contacts().is_empty() {
            return body.begin(Phase::Flight, world.gravity);
        }
        if let (&[surface], Some(projection)) = (body.contacts(), projection) {
            let radius = world.specs[index].radius;
            let sunk = radius - projection.distance > OVERLAP * radius;
            if sunk || !analytic::begin(world, index, body, surface) {
                single::settle(world, index, body, surface, projection);
            }
            return;
        }
    }
    scratch.go_on(world, members, bodies, links);
}

/// Moves contacts along with the surface, and ends those that separate. Gives the marble's position relative to the
/// last contact kept.
fn follow_contacts(world: &Marbles, index: usize, body: &mut Marble) -> Option<Projection> {
    let at_end = body.path.t >= body.expiry;
    let leaves = match body.ending {
        Ending::Leaves(side) if at_end => Some(side),
        _ => None,
    };
    let was_hit = body.was_hit();
    let was_waiting = body.phase == Phase::Waiting;
    body.ending = Ending::Plain;
    if was_waiting || body.contacts().is_empty() {
        return None;
    }
    let (x, v, radius) = (body.path.x, body.path.v, world.specs[index].radius);
    let scale = world.speed_scale(index);
    let (before, count) = (*body.contacts_in_full(), body.contacts().len());
    let (unnoticed, mut last) = (KEEP * (scale + v.length()), None);
    body.revise_contacts(|old| {
        let (mut surface, mut projection) = match (leaves, old) {
            (Some(side), Surface::Face(f)) => {
                let beyond = across(world, f, usize::from(side));
                (beyond, world.scenery.project(beyond, x))
            }
            _ => world.scenery.follow(old, x)?,
        };
        // Two contacts never merge: the one that is then missing would be found again at once.
        if surface != old && before[..count].contains(&surface) {
            (surface, projection) = (old, world.scenery.project(old, x));
        }
        let most = world.parting_speed(scale, world.surface_law(index, surface), was_hit).max(unnoticed);
        let keeps = v.dot(projection.normal) <= most && projection.distance - radius <= world.unseen * radius;
        last = if keeps { Some(projection) } else { last };
        keeps.then_some(surface)
    });
    last
}

fn link_lasts(world: &Marbles, [i, j]: Link, bodies: &[Marble]) -> bool {
    let (i, j) = (i as usize, j as usize);
    let (a, b) = (&bodies[i], &bodies[j]);
    let (offset, v) = (a.path.x - b.path.x, a.path.v - b.path.v);
    let (distance, reach) = (offset.length(), world.specs[i].radius + world.specs[j].radius);
    let scale = world.speed_scale(i).min(world.speed_scale(j));
    let were_hit = a.was_hit() || b.was_hit();
    let most = world.parting_speed(scale, world.pair_law(i, j), were_hit).max(KEEP * (scale + v.length()));
    v.dot(offset) <= most * distance && distance - reach <= world.unseen * reach
}

/// What is beyond a side of a triangle: its neighbour if they are level, otherwise the edge.
fn across(world: &Marbles, f: u32, side: usize) -> Surface {
    let mesh = world.scenery.mesh();
    let face = &mesh.faces[f as usize];
    if let Some(g) = face.neighbours[side]
        && mesh.faces[g as usize].normal.cross(face.normal).length() <= 1e-12
    {
        return Surface::Face(g);
    }
    let (a, b) = (face.corners[side], face.corners[(side + 1) % 3]);
    mesh.edge_between(a, b).map_or(Surface::Face(f), Surface::Edge)
}
