//! Where the ball comes to rest as a function of one normal's angle, and that function's inverse.
//!
//! With every other normal fixed, the resting place is a trigonometric polynomial of degree two in twice the angle θ of
//! one normal. The reason: the bounce maps the incoming velocity to one affine in (cos 2θ, sin 2θ), all later bounces
//! are linear maps, and each hop's length is a quadratic form of its velocity. So the angles that land the ball at a
//! given x are the roots of a quartic in tan θ. If a bounce is downward, its rule is another linear map: a *pattern*
//! says which bounces are.

use super::roots::{Roots, quartic};
use crate::ball2d::config::{Downward, MAX_COLLISIONS};
use crate::ball2d::flight::{self, Pattern, Table};
use glam::{DMat2, DVec2};

/// All normals of a draw as unit vectors, one of them to be solved for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Course<'a> {
    table: &'a Table,
    normals: [DVec2; MAX_COLLISIONS as usize],
    pub(super) collisions: usize,
    pub(super) aimed: usize,
    /// Where and how the ball comes down on the aimed bounce; `None` if a bounce before it rejects the draw.
    start: Option<(f64, DVec2)>,
}

impl<'a> Course<'a> {
    pub(super) fn new(table: &'a Table, height: f64, degrees: &[f64], aimed: usize) -> Self {
        let mut normals = [DVec2::Y; MAX_COLLISIONS as usize];
        for (normal, &angle) in normals.iter_mut().zip(degrees) {
            *normal = flight::normal(angle);
        }
        let before = normals[..aimed].iter().copied();
        let start = flight::go_on(table, (0.0, flight::fallen(height)), before, |_, _, _| {});
        Self { table, normals, collisions: degrees.len(), aimed, start }
    }

    /// Which bounces after the aimed one are downward if that one's normal is `normal`; `None` if it is downward
    /// itself, or the draw is rejected.
    pub(super) fn pattern(&self, normal: DVec2) -> Option<Pattern> {
        let (rest, downward) = flight::rest_from(self.table, self.start?, self.aimed_and_later(normal));
        (rest.is_some() && downward & 1 == 0).then_some(downward << self.aimed)
    }

    /// Whether this is the pattern.
    pub(super) fn follows(&self, normal: DVec2, pattern: Pattern) -> bool {
        let Some((_, mut incoming)) = self.start else { return false };
        self.aimed_and_later(normal).enumerate().all(|(later, normal)| {
            let bounce = self.table.bounce(incoming, normal);
            let as_said = bounce.filter(|b| b.downward == (pattern >> (self.aimed + later) & 1 == 1));
            as_said.is_some_and(|b| {
                incoming = flight::landing(b.velocity);
                true
            })
        })
    }

    /// The normals from the aimed one on, if that is `normal`.
    fn aimed_and_later(&self, normal: DVec2) -> impl Iterator<Item = DVec2> {
        std::iter::once(normal).chain(self.normals[self.aimed + 1..self.collisions].iter().copied())
    }

    /// The unit vector at tan θ.
    pub(super) fn normal(t: f64) -> DVec2 {
        DVec2::new(t, 1.0) / (1.0 + t * t).sqrt()
    }

    /// The resting place under `pattern`; `None` if a bounce before the aimed one rejects the draw.
    pub(super) fn landing(&self, pattern: Pattern) -> Option<Landing> {
        let (start, incoming) = self.start?;
        // Place of rest = start + vᵀ·form·v, v the velocity after the aimed bounce.
        let mut form = hop(DMat2::IDENTITY);
        let mut map = DMat2::IDENTITY;
        for index in self.aimed + 1..self.collisions {
            map = bounce(self.table, self.normals[index], pattern >> index & 1 == 1) * map;
            form += hop(map);
        }
        // v = level + cosine·cos φ + sine·sin φ.
        let half = 0.5 * (1.0 + self.table.restitution);
        let level = (1.0 - half) * incoming;
        let cosine = half * DVec2::new(incoming.x, -incoming.y);
        let sine = -half * DVec2::new(incoming.y, incoming.x);
        let [cc, ss] = [cosine.dot(form * cosine), sine.dot(form * sine)];
        Some(Landing {
            a: [
                start + level.dot(form * level) + 0.5 * (cc + ss),
                2.0 * level.dot(form * cosine),
                2.0 * level.dot(form * sine),
                0.5 * (cc - ss),
                cosine.dot(form * sine),
            ],
        })
    }
}

/// The linear map from the velocity after one bounce to that after the next.
fn bounce(table: &Table, n: DVec2, downward: bool) -> DMat2 {
    let e = table.restitution;
    let land = DMat2::from_diagonal(DVec2::new(1.0, -1.0));
    let reflect = DMat2::IDENTITY - (1.0 + e) * DMat2::from_cols(n * n.x, n * n.y);
    let map = match (downward, table.downward) {
        (false, _) | (true, Downward::Reject) => reflect,
        (true, Downward::Mirror) => land * reflect,
        (true, Downward::Zero) => DMat2::from_diagonal(DVec2::new(1.0, 0.0)) * reflect,
        (true, Downward::Level) => DMat2::from_diagonal(DVec2::new(1.0, -e)),
        (true, Downward::Back) => DMat2::from_diagonal(DVec2::splat(-e)),
    };
    map * land
}

/// The quadratic form of a hop's length, for a velocity that `map` makes of the aimed bounce's: 2·vx·vy.
fn hop(map: DMat2) -> DMat2 {
    let (x, y) = (map.row(0), map.row(1));
    DMat2::from_cols(x * y.x + y * x.x, x * y.y + y * x.y)
}

/// `a0 + a1·cos φ + a2·sin φ + a3·cos 2φ + a4·sin 2φ`, φ = 2θ.
pub(super) struct Landing {
    a: [f64; 5],
}

impl Landing {
    /// Place of rest and its slope in θ (per radian), from t = tan θ.
    pub(super) fn at(&self, t: f64) -> (f64, f64) {
        let over = 1.0 / (1.0 + t * t);
        let (c, s) = ((1.0 - t * t) * over, 2.0 * t * over);
        let (c2, s2) = (c * c - s * s, 2.0 * c * s);
        let [a0, a1, a2, a3, a4] = self.a;
        (a0 + a1 * c + a2 * s + a3 * c2 + a4 * s2, 2.0 * (a2 * c - a1 * s + 2.0 * (a4 * c2 - a3 * s2)))
    }

    /// tan θ of every angle that lands the ball at `x`, within ±`reach`.
    pub(super) fn tangents(&self, x: f64, reach: f64) -> Roots {
        let [a0, a1, a2, a3, a4] = self.a;
        let a0 = a0 - x;
        let c = [a0 + a1 + a3, 2.0 * a2 + 4.0 * a4, 2.0 * a0 - 6.0 * a3, 2.0 * a2 - 4.0 * a4, a0 - a1 + a3];
        quartic(&c, reach)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn rule() -> impl Strategy<Value = Downward> {
        prop::sample::select(vec![Downward::Mirror, Downward::Zero, Downward::Level, Downward::Back])
    }

    proptest! {
        /// The polynomial is the flight, whatever the rule, as long as the bounces follow the pattern: to 1e-10 of the
        /// largest hop (v² ≤ 2 · 4.5 · 2, tens of rounded products).
        #[test]
        fn the_polynomial_lands_where_the_ball_does(
            degrees in prop::collection::vec(-30.0_f64..30.0, 1..12),
            aimed in 0_usize..12,
            restitution in 0.0_f64..1.0,
            downward in rule(),
        ) {
            let aimed = aimed % degrees.len();
            let table = Table { restitution, downward };
            let course = Course::new(&table, 4.5, &degrees, aimed);
            let normals = degrees.iter().map(|&angle| flight::normal(angle));
            let (x, _) = flight::rest(&table, 4.5, normals);
            if let Some(pattern) = course.pattern(flight::normal(degrees[aimed])) {
                let landing = course.landing(pattern).unwrap();
                let t = plaus_dist::math::tan(degrees[aimed].to_radians());
                prop_assert!((landing.at(t).0 - x.unwrap()).abs() < 1e-10);
                let (up, down) = (landing.at(t + 1e-6).0, landing.at(t - 1e-6).0);
                let slope = (up - down) / 2e-6 * (1.0 + t * t);
                // A central difference: truncation 1e-12 times a third derivative of at most a few thousand, rounding
                // 1e-13/1e-6.
                prop_assert!((landing.at(t).1 - slope).abs() < 1e-4);
            }
        }

        /// The angle a draw has is among those found for where it lands, away from turning points (where two merge).
        #[test]
        fn the_way_back_is_found(degrees in prop::collection::vec(-25.0_f64..25.0, 1..8), aimed in 0_usize..8) {
            let aimed = aimed % degrees.len();
            let table = Table { restitution: 0.7, downward: Downward::Back };
            let course = Course::new(&table, 4.5, &degrees, aimed);
            let t = plaus_dist::math::tan(degrees[aimed].to_radians());
            if let Some(pattern) = course.pattern(flight::normal(degrees[aimed])) {
                let landing = course.landing(pattern).unwrap();
                let (x, slope) = landing.at(t);
                let roots = landing.tangents(x, 2.0);
                let nearest = roots.as_slice().iter().map(|root| (root - t).abs()).fold(f64::INFINITY, f64::min);
                // The rounding of x, some 1e-14, over the slope; below a slope of 1e-3 the curvature matters and the
                // bound is left.
                prop_assert!(slope.abs() < 1e-3 || nearest < 1e-9, "off by {}", nearest);
            }
        }
    }
}
