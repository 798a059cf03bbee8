//! Surfaces that grip better while they do not slide.

use glam::DVec3;

/// What decides whether a contact has the friction of surfaces that slide or that of surfaces that do not.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stiction {
    /// The coefficients while it slides, and while it does not.
    pub(crate) friction: [f64; 2],
    /// Its slip up to now, in m/s.
    pub(crate) slip: DVec3,
    /// Its slip once it has been solved.
    pub(crate) slip_after: DVec3,
    /// Slip up to this speed counts as none.
    pub(crate) still: f64,
}
