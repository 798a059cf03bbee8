//! Spheres struck at several points at one instant, all at once.
//!
//! Each point that is struck parts at least at its restitution times its approach (Newton's rule), with an impulse only
//! if no faster; its impulse lies in Coulomb's cone and leaves no slip, or that of the tangential restitution, unless
//! it is at the edge of the cone. Moreau, "Unilateral contact and dry friction in finite freedom dynamics" (1988). The
//! impulses are found by sweeps over the points, in each of which one point is solved exactly while all others stay
//! (Gauss–Seidel); what the sweeps come to does not depend on their order.
//!
//! Deviation: with friction, Newton's rule at several points can make energy, so all restitutions are then multiplied
//! by the largest factor with which energy does not grow.

use super::sphere::Touch;
use crate::material::Law;
use glam::DVec3;

/// A point at which a sphere strikes another one, or something that never moves.
#[derive(Debug, Clone, Copy)]
pub struct Struck {
    a: usize,
    b: Option<usize>,
    /// Unit vector towards the first.
    pub normal: DVec3,
    law: Law,
    /// Impulse on the first in N s.
    pub impulse: DVec3,
    /// Velocity before.
    before: DVec3,
}

/// Halvings of the interval that holds the largest factor of the restitutions that makes no energy.
const HALVINGS: usize = 16;

/// Change of velocity, over the fastest before, at which sweeps end: rounding.
const SOLVED: f64 = 1e-14;

/// Maximum number of sweeps. Default 5000: a rack of fifteen balls takes a few hundred.
const SWEEPS: usize = 5000;

/// Energy, over that of impulses and velocities, that counts as zero: rounding.
const NO_ENERGY: f64 = 1e-12;

impl Struck {
    /// A point between the spheres with these indices; `normal` is the unit vector towards the first.
    #[must_use]
    pub fn new(a: usize, b: Option<usize>, normal: DVec3, law: Law) -> Self {
        Self { a, b, normal, law, impulse: DVec3::ZERO, before: DVec3::ZERO }
    }

    fn velocity(&self, touches: &[Touch]) -> DVec3 {
        let u = touches[self.a].surface_velocity(-self.normal);
        self.b.map_or(u, |b| u - touches[b].surface_velocity(self.normal))
    }

    /// Gives this point the impulse that it needs while all others stay; returns the change of velocity. All
    /// restitutions are multiplied by `part`.
    fn solve(&mut self, touches: &mut [Touch], part: f64) -> f64 {
        let (n, law) = (self.normal, &self.law);
        let second = self.b.map_or(Touch::fixed(), |b| touches[b]);
        let inverse = touches[self.a].inverse_mass + second.inverse_mass;
        let across = |t: &Touch| t.inverse_mass * (1.0 + 1.0 / t.gyration);
        let compliance = across(&touches[self.a]) + across(&second);
        if inverse == 0.0 {
            return 0.0;
        }
        let (u, coming) = (self.velocity(touches), self.before.dot(n));
        let (rate, load) = (u.dot(n), self.impulse.dot(n));
        let next_load = (load - (rate + part * law.restitution * coming.min(0.0)) / inverse).max(0.0);
        let slip = (u - n * rate) + (self.before - n * coming) * (part * law.tangential);
        let stick = (self.impulse - n * load) - slip / compliance;
        let (most, wanted) = (law.friction * next_load, stick.length());
        let next = n * next_load + if wanted > most { stick * (most / wanted) } else { stick };
        let change = next - self.impulse;
        touches[self.a].push(change, -n);
        if let Some(b) = self.b {
            touches[b].push(-change, n);
        }
        self.impulse = next;
        change.length() * compliance
    }
}

/// Resolves an impact at all these points of these spheres at once.
pub fn spheres_at_once(touches: &mut [Touch], struck: &mut [Struck]) {
    for s in &mut *struck {
        s.before = s.velocity(touches);
    }
    let fastest = struck.iter().map(|s| s.before.length()).fold(0.0, f64::max);
    let start = touches.to_vec();
    let mut makes_energy = |part: f64| {
        touches.copy_from_slice(&start);
        struck.iter_mut().for_each(|s| s.impulse = DVec3::ZERO);
        for _ in 0..SWEEPS {
            let change = struck.iter_mut().map(|s| s.solve(touches, part)).fold(0.0, f64::max);
            if change <= SOLVED * fastest {
                break;
            }
        }
        let (mut energy, mut scale) = (0.0, 0.0);
        for s in &*struck {
            energy += 0.5 * s.impulse.dot(s.before + s.velocity(touches));
            scale += s.impulse.length() * fastest;
        }
        energy > NO_ENERGY * scale
    };
    if makes_energy(1.0) {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if makes_energy(middle) { high = middle } else { low = middle }
        }
        makes_energy(low);
    }
}
