//! Impulses of lasting contacts, found together: block Gauss–Seidel whose blocks obey Coulomb's law exactly.

use glam::{DMat3, DVec3};

/// A body while its contacts are solved.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Member {
    pub(crate) inverse_mass: f64,
    pub(crate) inverse_inertia: DMat3,
    pub(crate) v: DVec3,
    pub(crate) w: DVec3,
    /// Largest distance of a point from the centre of gravity.
    pub(crate) reach: f64,
    /// Velocities a round ago.
    pub(crate) last: [DVec3; 2],
}

/// A contact between a member and a fixed part or another member.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Contact {
    pub(crate) a: usize,
    pub(crate) b: Option<usize>,
    pub(crate) arms: [DVec3; 2],
    /// Unit normal towards `a`.
    pub(crate) normal: DVec3,
    pub(crate) friction: f64,
    /// Least normal velocity after solving.
    pub(crate) target: f64,
    /// Velocity change per impulse.
    k: DMat3,
    k_inverse: DMat3,
    kn: DVec3,
    along: f64,
    /// At least the largest response across the normal.
    stiff: f64,
    /// Impulse on `a` so far.
    pub(crate) impulse: DVec3,
    slip: DVec3,
}

/// Rounds over the direction of slip per visit; the sweeps around it do the rest.
const ROUNDS: usize = 2;

impl Contact {
    pub(crate) fn new(a: usize, b: Option<usize>, arms: [DVec3; 2], normal: DVec3, friction: f64, k: DMat3) -> Self {
        let kn = k * normal;
        let along = normal.dot(kn);
        let stiff = k.x_axis.x + k.y_axis.y + k.z_axis.z - along;
        let k_inverse = k.inverse();
        Self {
            a,
            b,
            arms,
            normal,
            friction,
            target: 0.0,
            k,
            k_inverse,
            kn,
            along,
            stiff,
            impulse: DVec3::ZERO,
            slip: DVec3::ZERO,
        }
    }

    /// Relative velocity at the contact.
    #[inline]
    pub(crate) fn velocity(&self, members: &[Member]) -> DVec3 {
        let a = &members[self.a];
        let u = a.v + a.w.cross(self.arms[0]);
        match self.b {
            Some(b) => u - (members[b].v + members[b].w.cross(self.arms[1])),
            None => u,
        }
    }

    #[inline]
    pub(crate) fn push(&self, members: &mut [Member], impulse: DVec3) {
        let a = &mut members[self.a];
        a.v += impulse * a.inverse_mass;
        a.w += a.inverse_inertia * self.arms[0].cross(impulse);
        if let Some(b) = self.b {
            let b = &mut members[b];
            b.v -= impulse * b.inverse_mass;
            b.w -= b.inverse_inertia * self.arms[1].cross(impulse);
        }
    }

    /// Gives this contact the impulse that it needs with all others as they are; returns the change of velocity that this meant.
    #[inline]
    pub(crate) fn solve(&mut self, members: &mut [Member]) -> f64 {
        let u = self.velocity(members);
        let n = self.normal;
        let wanted = n * self.target - u;
        if self.impulse == DVec3::ZERO && wanted.dot(n) <= 0.0 {
            return 0.0;
        }
        // Sticking is by far the most frequent: no slip is left, and the impulse lies in the cone.
        let mut change = self.k_inverse * wanted;
        let mut next = self.impulse + change;
        let load = next.dot(n);
        if load <= 0.0 || (next - n * load).length_squared() > self.friction * self.friction * load * load {
            next = self.sliding(u - self.k * self.impulse);
            change = next - self.impulse;
        }
        self.push(members, change);
        self.impulse = next;
        change.length() * self.along
    }

    /// The impulse after which a contact with velocity `free`, that cannot stick, obeys Coulomb's law: the friction opposes the slip that is left.
    fn sliding(&mut self, free: DVec3) -> DVec3 {
        let n = self.normal;
        let missing = self.target - free.dot(n);
        if missing <= 0.0 {
            return DVec3::ZERO;
        }
        if self.friction == 0.0 {
            return n * (missing / self.along);
        }
        if self.slip == DVec3::ZERO {
            let across = free - n * free.dot(n);
            self.slip = (across + (self.kn - n * self.along) * (missing / self.along)).normalize_or_zero();
        }
        for _ in 0..ROUNDS {
            let ks = self.k * self.slip;
            let gain = self.along - self.friction * self.kn.dot(self.slip);
            if gain <= 1e-3 * self.along {
                // Friction wedges the contact.
                return self.wedged(free, missing);
            }
            let load = missing / gain;
            let after = free + (self.kn - ks * self.friction) * load;
            let before = self.slip;
            self.slip = (after - n * after.dot(n) + before * (self.friction * load * self.stiff)).normalize_or(before);
            if before.dot(self.slip) > 1.0 - 1e-9 {
                break;
            }
        }
        let gain = self.along - self.friction * self.kn.dot(self.slip);
        if gain <= 1e-3 * self.along {
            return self.wedged(free, missing);
        }
        (n - self.slip * self.friction) * (missing / gain)
    }

    /// The sticking impulse where the cone allows its normal part at all, else one without friction: neither gains energy.
    fn wedged(&self, free: DVec3, missing: f64) -> DVec3 {
        let n = self.normal;
        let stick = self.k_inverse * (n * missing - (free - n * free.dot(n)));
        let load = stick.dot(n);
        let side = stick - n * load;
        if load > 0.0 && side.length() <= self.friction * load { stick } else { n * (missing / self.along) }
    }
}

/// Sweeps up and down over all contacts until a round changes no body's velocity by more than `enough`, at most `most` times.
///
/// Velocities decide, not impulses: where contacts are redundant, impulses that cancel each other may go on growing for ever.
pub(crate) fn sweep(contacts: &mut [Contact], members: &mut [Member], enough: f64, most: u32) {
    if let [only] = contacts {
        for _ in 0..4 {
            if only.solve(members) <= enough {
                break;
            }
        }
        return;
    }
    for _ in 0..most {
        for m in members.iter_mut() {
            m.last = [m.v, m.w];
        }
        for c in contacts.iter_mut() {
            c.solve(members);
        }
        for c in contacts.iter_mut().rev().skip(1) {
            c.solve(members);
        }
        let quiet = |m: &Member| {
            (m.v - m.last[0]).length_squared() <= enough * enough
                && (m.w - m.last[1]).length_squared() * m.reach * m.reach <= enough * enough
        };
        if members.iter().all(quiet) {
            break;
        }
    }
}
