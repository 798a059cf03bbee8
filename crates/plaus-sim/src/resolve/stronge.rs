//! Impact of bodies with lever arms: Stronge's energetic restitution, integrated over the normal impulse after Darboux
//! and Keller.
//!
//! With `K` the inverse inertia seen at the contact, velocities change as `du/dp = K (−μ û, 1)` while the contact slips
//! in direction `û`. Slip may stop, stay stuck (if the friction needed to hold it is inside the cone) or turn. The
//! normal work `W = ∫ u_n dp` decides the end: the impact is over when the fraction `e²` of the energy of compression
//! has come back. Newton's rule gains energy under friction, and Poisson's may too. This rule cannot, because normal
//! work is −(1−e²) of the compression's, and friction only takes energy. Strong friction can press the bodies together
//! again before the end: the energy that they then absorb is added to what has not come back yet.
//!
//! Sources: Keller, "Impact with friction", J. Appl. Mech. 53 (1986); Stronge, *Impact Mechanics* (2000), ch. 4;
//! Darboux (1880). Deviation: if the slip turns while it shrinks (three dimensions), the path is followed by
//! third-order steps that turn it by at most `turn` radians each; slip that keeps its direction (every planar impact)
//! is followed exactly.

use super::path::{End, Path};
use glam::{DMat3, DVec2, DVec3};
use plaus_dist::math;

/// Inverse inertia at a contact, in a frame whose z axis is the normal (1/kg): velocity change per impulse. Symmetric
/// and positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactMatrix(pub DMat3);

impl ContactMatrix {
    fn tangential(&self, f: DVec2) -> DVec2 {
        let m = &self.0;
        DVec2::new(m.x_axis.x * f.x + m.y_axis.x * f.y, m.x_axis.y * f.x + m.y_axis.y * f.y)
    }

    fn coupling(&self) -> DVec2 {
        DVec2::new(self.0.z_axis.x, self.0.z_axis.y)
    }

    /// `du/dp` under the friction force `f` per unit normal force.
    pub(super) fn rate(&self, f: DVec2) -> (DVec2, f64) {
        (self.tangential(f) + self.coupling(), self.0.z_axis.z + self.coupling().dot(f))
    }

    /// The friction per unit normal force that keeps a stuck contact stuck.
    pub(super) fn holding(&self) -> DVec2 {
        let (m, c) = (&self.0, self.coupling());
        let det = m.x_axis.x * m.y_axis.y - m.y_axis.x * m.x_axis.y;
        -DVec2::new(m.y_axis.y * c.x - m.y_axis.x * c.y, m.x_axis.x * c.y - m.x_axis.y * c.x) / det
    }

    /// The direction in which a contact that cannot stick starts to slip: where the slip's change points along the
    /// slip.
    pub(super) fn escape(&self, friction: f64) -> DVec2 {
        const SECTORS: usize = 32;
        let rate_in = |angle: f64| {
            let (s, c) = math::sin_cos(angle);
            let u = DVec2::new(c, s);
            let (slip, _) = self.rate(-u * friction);
            (u, u.perp_dot(slip), u.dot(slip))
        };
        let width = std::f64::consts::TAU / SECTORS as f64;
        let mut best = (f64::NEG_INFINITY, DVec2::X);
        for k in 0..SECTORS {
            let (mut low, mut high) = (k as f64 * width, (k + 1) as f64 * width);
            let at_low = rate_in(low).1;
            if (at_low > 0.0) == (rate_in(high).1 > 0.0) {
                continue;
            }
            for _ in 0..52 {
                let middle = 0.5 * (low + high);
                if (rate_in(middle).1 > 0.0) == (at_low > 0.0) { low = middle } else { high = middle }
            }
            let (u, _, outward) = rate_in(0.5 * (low + high));
            if outward > best.0 {
                best = (outward, u);
            }
        }
        best.1
    }
}

/// Impulse (in the contact's frame) that ends an impact with relative velocity `u` (z is the normal part, negative for
/// approach).
///
/// `turn` is the largest angle in radians by which the slip may turn within one integration step.
#[must_use]
pub fn stronge_impulse(k: &ContactMatrix, u: DVec3, restitution: f64, friction: f64, turn: f64) -> DVec3 {
    stronge_impulse_with_grip(k, u, restitution, [friction; 2], turn)
}

/// The same with a coefficient of friction while it slips, and one that tells whether it stays stuck.
pub(crate) fn stronge_impulse_with_grip(
    k: &ContactMatrix,
    u: DVec3,
    restitution: f64,
    friction: [f64; 2],
    turn: f64,
) -> DVec3 {
    if u.z >= 0.0 {
        return DVec3::ZERO;
    }
    let mut path = Path::new(k, u, restitution, friction, turn);
    // The normal work at which all the energy that returns has returned, and the work at the beginning of the
    // compression.
    let mut released = 0.0;
    let mut begin = 0.0;
    let mut compresses = true;
    let mut wound = WOUND;
    let steps = |turns: f64| (turns / turn) as usize;
    let (many, most) = (steps(MANY_TURNS), steps(MOST_TURNS));
    for count in 0..most {
        if count >= many {
            wound += wound * WIDENS / many as f64;
        }
        let tiny = if count < many { f64::EPSILON } else { wound } * u.length();
        match path.step(tiny, (!compresses).then_some(released)) {
            End::Open => continue,
            End::Never => break,
            End::Turned if compresses => released += (path.work() - begin) * (1.0 - restitution * restitution),
            End::Turned => {}
            End::Released => break,
        }
        if restitution == 0.0 {
            break;
        }
        begin = path.work();
        compresses = !compresses;
    }
    path.impulse()
}

/// A slip that winds round and round while it dies would take endless steps. When it has turned by this many radians
/// (eight rounds), it counts as stuck below a fraction of the relative velocity. The default of that fraction is 1e-6,
/// far less than steps that turn by `turn` resolve. If a round hardly reduces the slip, the fraction grows with each
/// step, by a factor of 20,000 in eight more rounds.
const MANY_TURNS: f64 = 51.2;
const WOUND: f64 = 1e-6;
const WIDENS: f64 = 10.0;

/// The bound on turns only guards against our own mistakes.
const MOST_TURNS: f64 = 4.0 * MANY_TURNS;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const TURN: f64 = 0.05;

    /// The rod of the regression vectors: planar, so the second tangential direction is decoupled.
    fn rod() -> ContactMatrix {
        ContactMatrix(DMat3::from_cols(
            DVec3::new(2.5, 0.0, -1.5),
            DVec3::new(0.0, 1.0, 0.0),
            DVec3::new(-1.5, 0.0, 2.5),
        ))
    }

    /// A body of unit mass with these inverse moments, touched at `r` from its centre.
    fn matrix(inverse: DVec3, r: DVec3) -> ContactMatrix {
        let cross =
            DMat3::from_cols(DVec3::new(0.0, r.z, -r.y), DVec3::new(-r.z, 0.0, r.x), DVec3::new(r.y, -r.x, 0.0));
        ContactMatrix(DMat3::IDENTITY - cross * DMat3::from_diagonal(inverse) * cross)
    }

    fn after(k: &ContactMatrix, u: DVec3, e: f64, mu: f64) -> (DVec3, f64) {
        let impulse = stronge_impulse(k, u, e, mu, TURN);
        let next = u + k.0 * impulse;
        // ΔE = J · (u + u')/2, exact for rigid bodies.
        (next, impulse.dot(u + next) * 0.5)
    }

    #[test]
    fn rod_that_comes_to_stick() {
        let (u, energy) = after(&rod(), DVec3::new(0.5, 0.0, -1.0), 1.0, 1.0);
        assert!((u.z - 0.741_619_848_709_566_6).abs() < 1e-12, "{u}");
        assert!((energy + 1.0 / 32.0).abs() < 1e-12, "{energy}");
    }

    #[test]
    fn rod_whose_slip_reverses() {
        let (u, energy) = after(&rod(), DVec3::new(0.5, 0.0, -1.0), 0.8, 0.5);
        assert!((u.x + 0.148_118).abs() < 1e-6 && (u.z - 0.627_734).abs() < 1e-6, "{u}");
        assert!(energy < 0.0);
    }

    /// Friction of 0.6 holds this rod. Where sliding has 0.5 but sticking 0.7, its slip stops and stays 0; with 0.5 for
    /// both it turns round.
    #[test]
    fn a_rod_that_grips_better_than_it_slides_comes_to_stick() {
        let after = |friction| {
            let u = DVec3::new(0.5, 0.0, -1.0);
            let impulse = stronge_impulse_with_grip(&rod(), u, 0.8, friction, TURN);
            (u + rod().0 * impulse, impulse)
        };
        let (u, impulse) = after([0.5, 0.7]);
        // It slips until p = 0.5 / (2.5 · 0.5 + 1.5), with friction -0.5 p, and then sticks with 0.6 of the rest.
        let stop = 0.5 / 2.75;
        assert!((impulse.x - (-0.5 * stop + 0.6 * (impulse.z - stop))).abs() < 1e-12, "{impulse}");
        assert!(u.x.abs() < 1e-12, "{u}");
        assert!(after([0.5, 0.5]).0.x < -0.1);
    }

    #[test]
    fn a_sphere_agrees_with_the_closed_form() {
        // K of a solid sphere of unit mass against the ground: 7/2 across, 1 along.
        let k = ContactMatrix(DMat3::from_diagonal(DVec3::new(3.5, 3.5, 1.0)));
        let (stick, _) = after(&k, DVec3::new(0.3, 0.4, -2.0), 0.5, 1.0);
        assert!(stick.truncate().length() < 1e-15 && (stick.z - 1.0).abs() < 1e-15);
        let (slip, _) = after(&k, DVec3::new(3.0, 4.0, -2.0), 0.5, 0.1);
        let left = 5.0 - 3.5 * 0.1 * 3.0;
        assert!((slip - DVec3::new(0.6 * left, 0.8 * left, 1.0)).length() < 1e-14);
    }

    /// Response and approach of the corner of a cube of unit mass, from a sequence that fills the box of their numbers
    /// evenly.
    fn corner(n: u32) -> (ContactMatrix, DVec3) {
        let part = |step: f64| (f64::from(n) * step) % 1.0;
        let down = -0.2 - 0.8 * part(0.324_717_957_244);
        let r = DVec3::new(part(0.618_033_988_749) - 0.5, part(0.754_877_666_246) - 0.5, down).normalize() * 0.866;
        let along = DVec2::new(part(0.569_840_290_998), part(0.220_744_084_605)) * 2.0 - 1.0;
        (matrix(DVec3::splat(6.0), r), along.extend(-0.01 - part(0.819_172_513_396)))
    }

    #[test]
    fn finer_turns_converge() {
        let mean = |turn: f64| {
            let error = |n: u32| {
                let (k, u) = corner(n);
                let exact = stronge_impulse(&k, u, 0.5, 0.35, 2e-3);
                (stronge_impulse(&k, u, 0.5, 0.35, turn) - exact).length() / exact.length()
            };
            (1..=500).map(error).sum::<f64>() / 500.0
        };
        let errors = [0.4, 0.2, 0.1, 0.05].map(mean);
        // Third order would be an eighth each time. Cases in which the slip nearly stops and goes on converge more
        // slowly, and make up most of the mean.
        assert!(errors[0] < 5e-3, "{errors:?}");
        assert!(errors.windows(2).all(|e| e[1] < 0.45 * e[0]), "{errors:?}");
    }

    /// Compared with Darboux and Keller's equations in 20,000 steps of Euler's rule.
    #[test]
    fn corners_agree_with_tiny_steps() {
        for n in 1..60 {
            let (k, u) = corner(n);
            let (e, mu) = (0.5, 0.35);
            let impulse = stronge_impulse(&k, u, e, mu, 0.01);
            let (mut v, mut stored, mut sum) = (u, 0.0, DVec3::ZERO);
            let step = impulse.z / 20_000.0;
            loop {
                let slip = v.truncate();
                let resting = slip.length() < 1e-3 && k.holding().length() <= mu;
                let force = if resting { k.holding() } else { -slip / slip.length() * mu };
                let next = v + k.0 * force.extend(1.0) * step;
                let work = step * 0.5 * (v.z + next.z);
                stored -= if work < 0.0 { work } else { work / (e * e) };
                v = next;
                sum += force.extend(1.0) * step;
                if stored <= 0.0 {
                    break;
                }
            }
            // Euler's rule is off by the impulse of a few steps, and by the slip below which it treats the contact as
            // stuck.
            assert!(
                (impulse - sum).length() < 2e-3 * sum.length().max(u.length() / k.0.z_axis.z),
                "{n}: {impulse} {sum}"
            );
        }
    }

    /// The slip spirals inwards: it shrinks by a hundredth per step. The impact must still come to an end.
    #[test]
    fn slip_that_winds_into_sticking_ends() {
        let r = DVec3::new(-0.896_100_684_939_962_4, -0.048_564_373_434_830_63, 0.464_968_417_468_366_2);
        let inertia = DVec3::new(18.267_625_327_358_896, 2.628_152_610_138_884_3, 8.513_600_154_202_017);
        let k = matrix(inertia, r);
        let u = DVec3::new(-0.554_847_839_656_371_5, 2.901_160_441_551_255, -2.188_011_343_914_404);
        let (next, energy) = after(&k, u, 0.0, 0.718_941_642_833_180_6);
        assert!(next.z.abs() < 1e-9 && energy < 0.0, "{next}, {energy}");
    }

    /// Friction of 2.7 presses the bodies together again while they part. A spring that stores the work done on it and
    /// gives back e² of it says when they are apart.
    #[test]
    fn bodies_pressed_together_again_part_in_the_end() {
        let r = DVec3::new(0.526_778_335_066_164_2, -0.914_060_086_875_240_7, 0.858_917_085_839_797_4);
        let inertia = DVec3::new(6.899_890_939_022_494, 9.048_906_640_721_714, 11.109_895_380_266_735);
        let k = matrix(inertia, r);
        let u = DVec3::new(2.411_761_369_790_216, 1.997_349_731_276_005, -0.212_421_147_996_087_9);
        let (e, mu) = (0.499_240_527_307_221_46, 2.699_420_945_821_742);
        // Darboux and Keller's equations in steps of 1e-5 of the normal impulse, by Euler's rule: its error is of the
        // order of the step.
        let (mut v, mut stored) = (u, 0.0);
        let step = 1e-5;
        let mut again = false;
        loop {
            let slip = DVec2::new(v.x, v.y);
            let force = if slip.length() < 1e-3 { k.holding() } else { -slip / slip.length() * mu };
            let next = v + k.0 * DVec3::new(force.x, force.y, 1.0) * step;
            let work = step * 0.5 * (v.z + next.z);
            again |= stored > 0.0 && v.z >= 0.0 && next.z < 0.0;
            stored -= if work < 0.0 { work } else { work / (e * e) };
            v = next;
            if stored <= 0.0 {
                break;
            }
        }
        let (next, energy) = after(&k, u, e, mu);
        assert!(again && energy < 0.0, "{energy}");
        assert!((next - v).length() < 2e-2 * u.length(), "{next} {v}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]
        /// For every inertia, lever arm, friction and restitution: energy does not grow, the bodies separate, and the
        /// impulse lies in the cone.
        #[test]
        fn energy_never_grows(
            inertia in prop::array::uniform3(0.05..20.0_f64),
            r in prop::array::uniform3(-1.0..1.0_f64),
            u in prop::array::uniform3(-3.0..3.0_f64),
            e in 0.0..=1.0_f64, mu in 0.0..3.0_f64, turn in 0.03..0.5_f64,
        ) {
            let k = matrix(DVec3::from(inertia), DVec3::from(r));
            let u = DVec3::new(u[0], u[1], -u[2].abs() - 1e-3);
            let impulse = stronge_impulse(&k, u, e, mu, turn);
            let next = u + k.0 * impulse;
            let energy = impulse.dot(u + next) * 0.5;
            let scale = impulse.length() * u.length();
            prop_assert!(energy <= 1e-12 * scale, "{energy} of {scale}");
            prop_assert!(next.z >= -1e-9 * u.length(), "{next}");
            prop_assert!(impulse.truncate().length() <= mu * impulse.z * (1.0 + 1e-9) + 1e-12 * scale);
        }
    }
}
