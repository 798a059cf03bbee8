//! How hard driven bodies press at most.

use super::contact_constraint::{ConstraintKind, ContactConstraint, ForceLimit, SolverBody};
use crate::rigid::tolerances::DRIVEN_FORCE_LIMIT;

/// Limits the impulses of driven bodies within `time` seconds, in which forces and other contacts change velocities by
/// `kick`. Driven bodies move on whatever they meet: where that leaves others no way, no impulse would be large enough.
pub(crate) fn limit_driven(contacts: &mut [ContactConstraint], members: &[SolverBody], time: f64, kick: f64) {
    if members.iter().all(|m| m.inverse_mass > 0.0) {
        return;
    }
    let mass: f64 = members.iter().filter(|m| m.inverse_mass > 0.0).map(|m| 1.0 / m.inverse_mass).sum();
    let approach = |c: &ContactConstraint| {
        let u = c.velocity(members);
        match c.hold {
            ConstraintKind::Coulomb => -u.dot(c.normal),
            ConstraintKind::Across => (u - c.normal * u.dot(c.normal)).length(),
            _ => u.length(),
        }
    };
    for c in contacts {
        let Some(b) = c.b else { continue };
        let (k, arm, other) = match [c.a, b].map(|k| members[k].inverse_mass > 0.0) {
            [false, true] => (c.a, c.arms[0], b),
            [true, false] => (b, c.arms[1], c.a),
            _ => continue,
        };
        let speed = (members[k].v + members[k].w.cross(arm)).length();
        let gained = approach(c).max(0.0) + kick + speed * speed / members[other].bounding_radius * time;
        if gained > 0.0 {
            let most = DRIVEN_FORCE_LIMIT * mass * gained;
            c.force_limit = Some(ForceLimit { most, compliance: (speed + gained) / most });
        }
    }
}
