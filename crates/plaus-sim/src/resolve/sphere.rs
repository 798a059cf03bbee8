//! Impact of spheres: Newton's restitution along the normal, Coulomb friction with sticking across it.
//!
//! With contact velocity `u` (tangential part) and normal speed `v_n < 0`, the impulse is `J_n = m_eff (1+e) |v_n|`,
//! `J_t = min(μ J_n, (1+e_t) |u| / Σ(1/m + r²/I))`, opposed to `u`. For solid spheres the sum is `7/(2m)` against
//! something that does not move and `7/m` for an equal pair. A sphere's contact force has no lever arm about its centre
//! in the normal direction, so Newton's, Poisson's and Stronge's restitution agree and energy cannot grow.
//!
//! Sources: Garwin, "Kinematics of an ultraelastic rough ball", Am. J. Phys. 37 (1969) for `e_t`; Walton & Braun (1986)
//! for the stick/slip form.

use crate::material::Law;
use glam::DVec3;

/// The properties of one sphere that matter in an impact.
#[derive(Debug, Clone, Copy)]
pub struct Touch {
    /// Velocity of the centre in m/s.
    pub v: DVec3,
    /// Angular velocity in rad/s.
    pub w: DVec3,
    /// 1 / mass; 0 for something that never moves.
    pub inverse_mass: f64,
    /// Radius in m.
    pub radius: f64,
    /// Inertia / (mass × radius²): 2/5 for a solid sphere.
    pub gyration: f64,
}

impl Touch {
    /// Something that never moves.
    #[inline]
    #[must_use]
    pub const fn fixed() -> Self {
        Self { v: DVec3::ZERO, w: DVec3::ZERO, inverse_mass: 0.0, radius: 0.0, gyration: 1.0 }
    }

    /// Velocity of the surface point in direction `to_contact` (a unit vector from the centre).
    #[inline]
    #[must_use]
    pub fn surface_velocity(&self, to_contact: DVec3) -> DVec3 {
        self.v + self.w.cross(to_contact * self.radius)
    }

    /// Applies `impulse` at the surface point in direction `to_contact`.
    #[inline]
    pub fn push(&mut self, impulse: DVec3, to_contact: DVec3) {
        self.v += impulse * self.inverse_mass;
        if self.inverse_mass > 0.0 {
            self.w += to_contact.cross(impulse) * (self.inverse_mass / (self.gyration * self.radius));
        }
    }
}

/// The result of an impact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impulse {
    /// Impulse on the first body in N s.
    pub on_first: DVec3,
    /// Normal relative speed before, positive for approach, in m/s.
    pub approach: f64,
}

/// Collides `first` with `second`; `normal` is the unit vector from the second towards the first. Nothing happens if
/// they do not approach.
#[inline]
pub fn sphere_impact(first: &mut Touch, second: &mut Touch, normal: DVec3, law: &Law) -> Impulse {
    let relative = first.surface_velocity(-normal) - second.surface_velocity(normal);
    let normal_speed = relative.dot(normal);
    let inverse = first.inverse_mass + second.inverse_mass;
    if normal_speed >= 0.0 || inverse == 0.0 {
        return Impulse { on_first: DVec3::ZERO, approach: -normal_speed };
    }
    let along = -(1.0 + law.restitution) * normal_speed / inverse;
    let slip = relative - normal * normal_speed;
    let slip_speed = slip.length();
    let compliance =
        first.inverse_mass * (1.0 + 1.0 / first.gyration) + second.inverse_mass * (1.0 + 1.0 / second.gyration);
    let mut impulse = normal * along;
    if slip_speed > 0.0 {
        let stick = (1.0 + law.tangential) / compliance;
        let limit = law.friction * along;
        impulse -= slip * if stick * slip_speed <= limit { stick } else { limit / slip_speed };
    }
    first.push(impulse, -normal);
    second.push(-impulse, normal);
    Impulse { on_first: impulse, approach: -normal_speed }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn ball(v: DVec3, w: DVec3) -> Touch {
        Touch { v, w, inverse_mass: 2.0, radius: 0.25, gyration: 0.4 }
    }

    fn energy(t: &Touch) -> f64 {
        if t.inverse_mass == 0.0 {
            return 0.0;
        }
        0.5 / t.inverse_mass * (t.v.length_squared() + t.gyration * t.radius * t.radius * t.w.length_squared())
    }

    fn close(a: f64, b: f64, scale: f64) {
        assert!((a - b).abs() <= 1e-14 * scale, "{a} for {b}");
    }

    /// A floor hit in the x–z plane: tangential speed v, spin such that the surface moves Rω the same way at the top.
    fn oblique(v: f64, spin: f64, law: Law) -> (f64, f64, f64) {
        let mut first = ball(DVec3::new(v, 0.0, -2.0), DVec3::new(0.0, spin / 0.25, 0.0));
        sphere_impact(&mut first, &mut Touch::fixed(), DVec3::Z, &law);
        (first.v.x, first.w.y * 0.25, first.v.z)
    }

    #[test]
    fn oblique_bounce_sticks_or_slips() {
        // u = v − Rω. Stick: v' = (5v + 2Rω)/7, and then Rω' = v'.
        let (v, spin, up) = oblique(3.0, 1.0, Law::new(10.0, 0.5));
        close(v, 17.0 / 7.0, 3.0);
        close(spin, 17.0 / 7.0, 3.0);
        close(up, 1.0, 2.0);
        // Slip: J_t/m = μ(1+e)|v_n| = 0.05·1.5·2 = 0.15.
        let (v, spin, _) = oblique(3.0, 1.0, Law::new(0.05, 0.5));
        close(v, 3.0 - 0.15, 3.0);
        close(spin, 1.0 + 2.5 * 0.15, 3.0);
    }

    #[test]
    fn super_ball_twice_is_the_identity() {
        let law = Law::new(1e6, 1.0).with_tangential(1.0);
        let (v, spin, _) = oblique(3.0, 1.0, law);
        close(v, (3.0 * 3.0 + 4.0) / 7.0, 3.0);
        close(spin, (10.0 * 3.0 - 3.0) / 7.0, 5.0);
        let (v, spin, _) = oblique(v, spin, law);
        close(v, 3.0, 5.0);
        close(spin, 1.0, 5.0);
    }

    #[test]
    fn friction_stops_the_slip_of_an_equal_pair_with_a_seventh() {
        let mut a = ball(DVec3::new(0.0, 1.4, -1.0), DVec3::ZERO);
        let mut b = ball(DVec3::ZERO, DVec3::ZERO);
        let impulse = sphere_impact(&mut a, &mut b, DVec3::Z, &Law::new(1e9, 1.0));
        close(impulse.on_first.y, -0.5 * 1.4 / 7.0, 1.0);
        let slip = (a.surface_velocity(-DVec3::Z) - b.surface_velocity(DVec3::Z)) * DVec3::new(1.0, 1.0, 0.0);
        assert!(slip.length() < 1e-15);
    }

    proptest! {
        #[test]
        fn energy_never_grows_and_momentum_is_kept(
            va in prop::array::uniform3(-5.0..5.0_f64), wa in prop::array::uniform3(-50.0..50.0_f64),
            vb in prop::array::uniform3(-5.0..5.0_f64), wb in prop::array::uniform3(-50.0..50.0_f64),
            n in prop::array::uniform3(-1.0..1.0_f64),
            friction in 0.0..2.0_f64,
            e in 0.0..1.0_f64,
            et in 0.0..1.0_f64,
            ratio in -6.0..6.0_f64,
        ) {
            let n = DVec3::from(n);
            prop_assume!(n.length() > 0.1);
            let mut a = ball(DVec3::from(va), DVec3::from(wa));
            let of_b = ball(DVec3::from(vb), DVec3::from(wb));
            let mut b = Touch { inverse_mass: libm_pow10(ratio), radius: 0.1, ..of_b };
            let before = energy(&a) + energy(&b);
            let momentum = a.v / a.inverse_mass + b.v / b.inverse_mass;
            sphere_impact(&mut a, &mut b, n.normalize(), &Law::new(friction, e).with_tangential(et));
            prop_assert!(energy(&a) + energy(&b) <= before * (1.0 + 1e-14));
            let change = (a.v / a.inverse_mass + b.v / b.inverse_mass - momentum).length();
            let (speeds, masses) = (va.iter().chain(&vb).map(|x| x.abs()), 1.0 / a.inverse_mass + 1.0 / b.inverse_mass);
            prop_assert!(change <= 1e-14 * speeds.sum::<f64>() * masses);
        }
    }

    fn libm_pow10(x: f64) -> f64 {
        plaus_dist::math::powf(10.0, x)
    }
}
