//! How the impulse of a contact responds to its velocity: projections onto cones of friction, and their derivatives,
//! for Newton's method (`newton.rs`).

use super::contact_constraint::{ConstraintKind, ContactConstraint};
use crate::rigid::tolerances::{CONTACT_COMPLIANCE, GUESS_COMPLIANCE};
use glam::{DMat3, DVec3};

/// How a contact responds to a change of its velocity.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ConeProjection {
    pub(crate) impulse: DVec3,
    /// Derivative of the impulse with respect to the velocity, with its sign changed.
    pub(super) stiffness: DMat3,
    /// Direction of the friction, if the contact slides.
    sliding: Option<DVec3>,
}

impl ConeProjection {
    /// The response of a contact that sticks.
    pub(super) fn sticking(c: &ContactConstraint, impulse: DVec3, stiff: f64) -> Self {
        let (impulse, ways) = match c.hold {
            ConstraintKind::DryFriction(_) => (c.normal * impulse.dot(c.normal), outer(c.normal, c.normal)),
            ConstraintKind::Across => (c.project(impulse).0, DMat3::IDENTITY - outer(c.normal, c.normal)),
            _ => (impulse, DMat3::IDENTITY),
        };
        Self { impulse, stiffness: ways * stiff, sliding: None }
    }

    /// Whether friction has reversed since `before`. The slip then went through zero, and the contact is tried without
    /// slip; otherwise rounds might alternate for ever.
    pub(super) fn reverses(&self, before: &Self, c: &ContactConstraint) -> bool {
        let (Some(was), Some(is)) = (before.sliding, self.sliding) else { return false };
        was.dot(is) < 0.0 && c.held_slip.is_none_or(|s| is != -s)
    }

    /// Whether it bears, and whether it slides.
    pub(crate) fn state(&self) -> [bool; 2] {
        [self.stiffness != DMat3::ZERO, self.sliding.is_some()]
    }

    /// A number that tells which of several contacts are open, stick or slide.
    pub(super) fn mixed_into(&self, states: u64) -> u64 {
        let state = match self.sliding {
            _ if self.stiffness == DMat3::ZERO => 1,
            None => 2,
            // Slips that have turned round are other states.
            Some(t) => t.to_array().iter().fold(3, |hash, x| hash * 16 + ((x + 1.0) * 4.0).round() as u64),
        };
        (states ^ state).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29)
    }
}

const OPEN: ConeProjection = ConeProjection { impulse: DVec3::ZERO, stiffness: DMat3::ZERO, sliding: None };

/// The impulse of a contact with this compliance, over its response, if its cone did not matter, and impulse per
/// velocity. A contact that gives way has a compliance of its own, from no impulse on.
pub(super) fn trial(c: &ContactConstraint, residual: DVec3, compliance: f64) -> (DVec3, f64) {
    if c.compliance > 0.0 {
        return (-residual / c.compliance, 1.0 / c.compliance);
    }
    let stiff = 1.0 / (compliance * c.compliance());
    (c.impulse - residual * stiff, stiff)
}

/// A joint's response to the impulse that would hold it.
fn joint(c: &ContactConstraint, trial: DVec3, stiff: f64) -> ConeProjection {
    let (impulse, gives_way) = c.project(trial);
    let open = ConeProjection { impulse, sliding: impulse.try_normalize(), ..OPEN };
    if gives_way { open } else { ConeProjection::sticking(c, impulse, stiff) }
}

/// The response that Coulomb's law gives for a contact with the velocity `residual` to be removed.
pub(super) fn coulomb(c: &ContactConstraint, residual: DVec3) -> ConeProjection {
    coulomb_with(c, residual, CONTACT_COMPLIANCE)
}

/// The stiff response of a contact in the state of its impulse, if that is known; otherwise its state is guessed with
/// the compliance [`GUESS_COMPLIANCE`].
pub(super) fn guessed(c: &ContactConstraint, residual: DVec3) -> ConeProjection {
    if c.hold != ConstraintKind::Coulomb {
        return coulomb(c, residual);
    }
    let (is_open, sliding) = if c.is_known && c.friction > 0.0 {
        (c.impulse.dot(c.normal) <= 0.0, c.friction_at_edge().and_then(DVec3::try_normalize))
    } else {
        let guess = coulomb_with(c, residual, GUESS_COMPLIANCE);
        (guess.stiffness == DMat3::ZERO, guess.sliding)
    };
    if is_open {
        return OPEN;
    }
    let (trial, stiff) = trial(c, residual, CONTACT_COMPLIANCE);
    match sliding {
        None => ConeProjection::sticking(c, trial, stiff),
        Some(t) => {
            let direction = c.normal + t * c.friction;
            let impulse = direction * trial.dot(c.normal);
            ConeProjection { impulse, stiffness: outer(direction, c.normal) * stiff, sliding: Some(t) }
        }
    }
}

/// The response that Coulomb's law gives for a contact with this compliance.
fn coulomb_with(c: &ContactConstraint, residual: DVec3, compliance: f64) -> ConeProjection {
    let n = c.normal;
    let (trial, stiff) = trial(c, residual, compliance);
    if c.hold != ConstraintKind::Coulomb {
        return joint(c, trial, stiff);
    }
    let load = trial.dot(n);
    if load.is_nan() || load <= 0.0 {
        return OPEN;
    }
    let across = trial - n * load;
    let (side, most) = (across.length(), c.friction * load);
    let slides = |t: DVec3, turning: DMat3| {
        let direction = n + t * c.friction;
        ConeProjection {
            impulse: direction * load,
            stiffness: (outer(direction, n) + turning) * stiff,
            sliding: Some(t),
        }
    };
    if let Some(s) = c.held_slip.filter(|s| across.dot(*s) < -most) {
        // Friction opposes the slip as it was, as long as that goes on.
        return slides(-s, DMat3::ZERO);
    }
    if side <= most {
        return ConeProjection::sticking(c, trial, stiff);
    }
    let t = across / side;
    slides(t, (DMat3::IDENTITY - outer(n, n) - outer(t, t)) * (most / side))
}

/// The nearest point of the cone of friction.
pub(super) fn cone(c: &ContactConstraint, residual: DVec3, compliance: f64) -> ConeProjection {
    let (n, friction) = (c.normal, c.friction);
    let (trial, stiff) = trial(c, residual, compliance);
    if c.hold != ConstraintKind::Coulomb {
        return joint(c, trial, stiff);
    }
    let along = trial.dot(n);
    let across = trial - n * along;
    let side = across.length();
    if !side.is_finite() || friction * side <= -along {
        return OPEN;
    }
    if side <= friction * along {
        return ConeProjection::sticking(c, trial, stiff);
    }
    let (t, narrow) = (across / side, 1.0 / (1.0 + friction * friction));
    let direction = n + t * friction;
    let load = (along + friction * side) * narrow;
    let turning = (DMat3::IDENTITY - outer(n, n) - outer(t, t)) * (load * friction / side);
    ConeProjection {
        impulse: direction * load,
        stiffness: (outer(direction, direction) * narrow + turning) * stiff,
        sliding: Some(t),
    }
}

fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}
