//! Sliding friction at one contact: the direction of the remaining slip, and the load.
//!
//! With velocity `f` before any impulse and response `K`, a load `λ` with friction against the unit slip `s` leaves
//! `u = f + (K n − μ K s) λ`, whose normal part must have the wanted value. Coulomb's law holds if the velocity that is
//! left slips along `s`: `s⊥ · u = 0` and `s · u > 0`. The angle of `s` is found by Newton's rule from the direction of
//! the last visit, in a frame along the first direction. Each further round squares the error, and a mirrored world
//! gives the mirrored bits.
//!
//! Surfaces may grip better while they do not slide ([`Stiction`]).

use crate::rigid::tolerances::{SLIP_TURN_LIMIT, WEDGED_RESPONSE};
use glam::{DMat3, DVec2, DVec3};

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

/// The slip of a contact that slides.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Slip {
    /// Unit vectors along the slip when it was first seen, and across it.
    frame: [DVec3; 2],
    /// The response in that frame: along, mixed, across.
    k: [f64; 3],
    /// Response along the normal to forces in the frame; this equals the response in the frame to a normal force.
    kn: DVec2,
    /// The direction of the slip, in the frame.
    towards: DVec2,
}

/// What a contact wants to know about its slip.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SlipProblem {
    pub(crate) friction: f64,
    /// The missing change of normal velocity; `along` is its response to a normal force.
    pub(crate) missing: f64,
    pub(crate) along: f64,
    /// An upper bound on the response across the normal.
    pub(crate) stiff: f64,
    /// Angle in radians by which the slip's direction may be off.
    pub(crate) turn: f64,
    /// Maximum number of rounds of looking for it.
    pub(crate) rounds: u32,
}

/// Sliding with a load.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SlipSolution {
    pub(crate) load: f64,
    /// Unit vector of the slip.
    pub(crate) slip: DVec3,
    /// Whether slip is left in this direction; if not, friction has reversed it.
    pub(crate) goes_on: bool,
    /// Whether the direction was found within the angle allowed.
    pub(crate) is_right: bool,
}

/// A unit vector turned towards another one across it, by the angle whose half has the tangent `angle/2`.
#[inline]
fn turned_by(s: DVec2, t: DVec2, angle: f64) -> DVec2 {
    let half = 0.5 * angle;
    let square = half * half;
    (s * (1.0 - square) + t * angle) * (1.0 / (1.0 + square))
}

impl Slip {
    /// Slip in the direction of a vector across the normal; `None` if that vanishes.
    pub(crate) fn new(direction: DVec3, normal: DVec3, k: &DMat3, kn: DVec3) -> Option<Self> {
        let along = direction.try_normalize()?;
        let across = normal.cross(along);
        let (p, q) = (*k * along, *k * across);
        Some(Self {
            frame: [along, across],
            k: [along.dot(p), across.dot(p), across.dot(q)],
            kn: DVec2::new(along.dot(kn), across.dot(kn)),
            towards: DVec2::X,
        })
    }

    /// The unit vector of the slip.
    pub(crate) fn direction(&self) -> DVec3 {
        self.frame[0] * self.towards.x + self.frame[1] * self.towards.y
    }

    /// The response to a force in the frame.
    #[inline]
    fn response(&self, force: DVec2) -> DVec2 {
        let [xx, xy, yy] = self.k;
        DVec2::new(xx * force.x + xy * force.y, xy * force.x + yy * force.y)
    }

    /// How the contact slides on from velocity `free`; `None` if friction wedges it.
    #[inline]
    pub(crate) fn slide(&mut self, free: DVec3, asked: &SlipProblem) -> Option<SlipSolution> {
        let SlipProblem { friction, missing, along, stiff, turn, rounds } = *asked;
        let free = DVec2::new(free.dot(self.frame[0]), free.dot(self.frame[1]));
        let (mut goes_on, mut is_right) = (true, false);
        for _ in 0..rounds {
            let s = self.towards;
            let gain = along - friction * self.kn.dot(s);
            if gain <= WEDGED_RESPONSE * along {
                return None;
            }
            let inverse = 1.0 / gain;
            let load = missing * inverse;
            let t = s.perp();
            let pushed = self.kn - self.response(s) * friction;
            let left = free + pushed * load;
            let (on, off) = (s.dot(left), t.dot(left));
            goes_on = on > 0.0;
            let turned = t.dot(pushed) * self.kn.dot(t) * inverse - t.dot(self.response(t));
            let slope = friction * load * turned - on;
            if goes_on && slope < 0.0 {
                let angle = (-off / slope).clamp(-SLIP_TURN_LIMIT, SLIP_TURN_LIMIT);
                self.towards = turned_by(s, t, angle);
                is_right = angle.abs() <= turn;
                if is_right {
                    break;
                }
            } else {
                // Far from the solution: take a direction between the slip that is left and the previous one.
                self.towards = (left + s * (friction * load * stiff)).normalize_or(s);
            }
        }
        let gain = along - friction * self.kn.dot(self.towards);
        (gain > WEDGED_RESPONSE * along).then_some(SlipSolution {
            load: missing / gain,
            slip: self.direction(),
            goes_on,
            is_right,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A contact of a body with unit mass, from a sequence that fills the box of its numbers evenly: response, its
    /// inverse, and a downward velocity.
    fn contact(n: u32) -> (DMat3, DVec3) {
        let part = |step: f64| (f64::from(n) * step) % 1.0;
        let r =
            DVec3::new(part(0.618_033_988_749) - 0.5, part(0.754_877_666_246) - 0.5, -0.3 - part(0.324_717_957_244));
        let cross =
            DMat3::from_cols(DVec3::new(0.0, r.z, -r.y), DVec3::new(-r.z, 0.0, r.x), DVec3::new(r.y, -r.x, 0.0));
        let inertia = DMat3::from_diagonal(DVec3::new(1.0, 2.0 + 3.0 * part(0.472), 6.0));
        let u = DVec3::new(2.0 * part(0.569_840_290_998) - 1.0, 2.0 * part(0.220_744_084_605) - 1.0, -0.5);
        (DMat3::IDENTITY - cross * inertia * cross, u)
    }

    /// Where no force within the cone can hold a contact, the slip left after one visit points against the friction,
    /// and its normal part is as wanted.
    #[test]
    fn the_slip_that_is_left_obeys_coulomb() {
        let (n, friction) = (DVec3::Z, 0.3);
        let (mut slid, mut right) = (0, 0);
        for case in 1..2000 {
            let (k, u) = contact(case);
            let stick = k.inverse() * -u;
            let held = stick.z > 0.0 && stick.truncate().length() <= friction * stick.z;
            let kn = k * n;
            let across = u + kn * (-u.z / kn.z);
            let Some(mut slip) = Slip::new(across - n * across.z, n, &k, kn).filter(|_| !held) else { continue };
            let asked = SlipProblem {
                friction,
                missing: -u.z,
                along: kn.z,
                stiff: k.x_axis.x + k.y_axis.y,
                turn: 1e-6,
                rounds: 20,
            };
            let Some(slide) = slip.slide(u, &asked) else { continue };
            let left = u + k * (n - slide.slip * friction) * slide.load;
            slid += 1;
            assert!(left.z.abs() < 1e-12 && slide.load > 0.0 && (slide.slip.length() - 1.0).abs() < 1e-12, "{case}");
            if slide.is_right && slide.goes_on {
                right += 1;
                let tangent = left - n * left.z;
                // The last round turned it by at most 1e-6 and left the square of that; where little slip is left,
                // rounding adds its share.
                assert!(tangent.cross(slide.slip).length() <= 1e-9 * tangent.length() + 1e-14, "{case}: {left}");
                assert!(tangent.dot(slide.slip) > 0.0, "{case}");
            }
        }
        assert!(slid > 500 && right == slid, "{right} of {slid}");
    }
}
