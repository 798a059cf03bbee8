//! One point's impact: Stronge's restitution with Coulomb's friction, in small increments of the normal impulse.
//!
//! Within an increment friction is implicit: of all tangential impulses within the cone, the one is taken that leaves
//! the least tangential energy. So the contact sticks if it can, and otherwise friction opposes the slip that is left.
//! This is of the first order in the increment; a second run with half the increments removes the error of that order.

use glam::{DMat2, DMat3, DVec2, DVec3};

/// Number of increments up to the end of compression if friction did nothing.
const INCREMENTS: f64 = 1000.0;

/// Impulse at a point with relative velocity `u` (z the normal part, negative) and response `k` (velocity per impulse).
pub fn impulse(k: &DMat3, u: DVec3, restitution: f64, friction: f64) -> DVec3 {
    let [rough, fine] = [0.5 * INCREMENTS, INCREMENTS].map(|n| run(k, u, restitution, friction, n));
    let both = fine * 2.0 - rough;
    // Where sticking begins, the error has no clean order; so the result is kept inside the cone, and never pulls.
    let flat = both.truncate().clamp_length_max(friction * both.z.max(0.0));
    flat.extend(both.z.max(0.0))
}

fn run(k: &DMat3, u: DVec3, restitution: f64, friction: f64, increments: f64) -> DVec3 {
    let flat = DMat2::from_cols(k.x_axis.truncate(), k.y_axis.truncate());
    let across = k.z_axis.truncate();
    let dp = -u.z / (k.z_axis.z * increments);
    let (mut u, mut sum) = (u, DVec3::ZERO);
    // Work of compression, all negative, and the part of it that restitution will give back.
    let (mut work, mut back) = (0.0, f64::NAN);
    for _ in 0..(50.0 * increments) as usize {
        let rub = friction_of(&flat, u.truncate() + across * dp, friction * dp);
        let push = rub.extend(dp);
        let du = *k * push;
        // Within the increment u_z changes evenly, and with it the work ∫ u_z dp.
        let whole = (u.z + 0.5 * du.z) * dp;
        if back.is_nan() {
            if u.z + du.z >= 0.0 {
                let part = (-u.z / du.z).clamp(0.0, 1.0);
                (u, sum) = (u + du * part, sum + push * part);
                work += 0.5 * u.z.min(0.0) * dp;
                u.z = 0.0;
                back = restitution * restitution * -work;
                if back <= 0.0 {
                    return sum;
                }
                work = 0.0;
                continue;
            }
        } else if work + whole >= back {
            // u_z s + du_z s²/2 = (back − work)/dp for the fraction s of the increment.
            let (b, c) = (u.z, (back - work) / dp);
            let part = 2.0 * c / (b + (b * b + 2.0 * du.z * c).max(0.0).sqrt());
            return sum + push * part.clamp(0.0, 1.0);
        }
        (u, sum, work) = (u + du, sum + push, work + whole);
    }
    sum
}

/// The tangential impulse of at most `most` that leaves the least energy: `(K + λ) τ = −slip` with λ ≥ 0.
pub fn friction_of(k: &DMat2, slip: DVec2, most: f64) -> DVec2 {
    if most <= 0.0 || slip == DVec2::ZERO {
        return DVec2::ZERO;
    }
    let at = |lambda: f64| -((*k + DMat2::from_diagonal(DVec2::splat(lambda))).inverse() * slip);
    let free = at(0.0);
    if free.length() <= most {
        return free;
    }
    let (mut low, mut high) = (0.0, slip.length() / most);
    let mut lambda = high;
    for _ in 0..60 {
        let tau = at(lambda);
        let length = tau.length();
        if length > most {
            low = lambda
        } else {
            high = lambda
        }
        // Newton's step for 1/|τ| = 1/most, which is nearly straight.
        let slope =
            tau.dot((*k + DMat2::from_diagonal(DVec2::splat(lambda))).inverse() * tau) / (length * length * length);
        let next = lambda - (1.0 / length - 1.0 / most) / slope;
        let next = if next > low && next < high { next } else { 0.5 * (low + high) };
        if (next - lambda).abs() <= 1e-15 * next {
            break;
        }
        lambda = next;
    }
    at(lambda).clamp_length_max(most)
}
