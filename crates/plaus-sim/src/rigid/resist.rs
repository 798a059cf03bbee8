//! Resistance to rolling and to spinning in lasting contact on fixed parts.
//!
//! A contact with normal force N at distance R from the centre of gravity resists with a torque of at most ρ N R against the part of the angular velocity across its normal (rolling) and σ N R
//! against that along it (spinning), ρ and σ being the law's. Without it a pin that was nudged runs around on the rim of its foot, and one that lies rolls, for ever: nothing else takes
//! their energy.

use super::Rigid;
use super::contact::Touch;
use super::solve::{Contact, Member};
use super::step::Place;
use glam::DVec3;

/// Takes from the members' angular velocities what the contacts' resistance takes over a step whose halves have the contacts' impulses. Energy only falls, and no rotation is
/// reversed: the contacts' friction, found afterwards, brings the velocities of what rolls into line.
pub(super) fn resist(
    world: &Rigid,
    places: &[Place],
    touches: &[(usize, Touch)],
    contacts: &[Contact],
    members: &mut [Member],
) {
    for ((k, touch), contact) in touches.iter().zip(contacts) {
        let load = 2.0 * contact.impulse.dot(touch.normal);
        if load <= 0.0 {
            continue;
        }
        let place = &places[*k];
        let law = world.law_at(place.body, touch.part, place.start.x + touch.arm);
        let torque = load * touch.arm.length();
        let member = &mut members[*k];
        let about = touch.normal * member.w.dot(touch.normal);
        slow_down(member, member.w - about, law.rolling * torque);
        let about = touch.normal * member.w.dot(touch.normal);
        slow_down(member, about, law.spinning * torque);
    }
}

/// Takes an angular impulse of this size from a part of the angular velocity, or as much as that part has.
fn slow_down(member: &mut Member, part: DVec3, impulse: f64) {
    let speed = part.length();
    if impulse <= 0.0 || speed <= 0.0 {
        return;
    }
    let axis = part / speed;
    let response = member.inverse_inertia * axis;
    let whole = speed / axis.dot(response);
    member.w -= response * impulse.min(whole);
}
