//! The cap of a body of revolution.

use super::{Piece, Profile, Ring, moment};
use plaus_dist::math;
use std::f64::consts::FRAC_PI_2;

/// Part of a sphere: half a ball with a neck of constant radius under it, or a flatter part.
pub(super) struct Cap {
    /// Where the outline ends: height and radius.
    base: f64,
    edge: f64,
    /// Height of the sphere's centre, and its radius.
    centre: f64,
    radius: f64,
    top: f64,
    is_flat: bool,
}

impl Cap {
    /// Least height of a cap over the radius where it begins.
    pub(super) const FLATTEST: f64 = 0.01;
    /// Rings of a flat cap between its edge and its middle, and as far down from its edge.
    const RINGS: u32 = 5;

    pub(super) fn of(profile: &Profile) -> Self {
        let ([base, edge], top) = (profile.points[profile.points.len() - 1], profile.top);
        let height = top - base;
        // But for rounding, a ball of the last radius fits under the top.
        let is_flat = height < edge * (1.0 - 1e-9);
        let radius = if is_flat { 0.5 * (edge * edge + height * height) / height } else { edge };
        Self { base, edge, centre: top - radius, radius, top, is_flat }
    }

    /// The radius of the section at a height.
    fn section(&self, z: f64) -> f64 {
        (self.radius * self.radius - (z - self.centre) * (z - self.centre)).max(0.0).sqrt()
    }

    /// Radius and height of the outline's point at a share of the way from its edge to the top.
    pub(super) fn outline(&self, share: f64) -> [f64; 2] {
        let (sin, cos) = match self.is_flat {
            false => math::sin_cos(share * FRAC_PI_2),
            true => {
                let (radius, height) = (self.edge * (1.0 - share) / self.radius, self.base - self.centre);
                ((1.0 - radius * radius).sqrt().max(height / self.radius), radius)
            }
        };
        [self.radius * cos, self.centre + self.radius * sin]
    }

    /// `sum + ∫ z^k r^m` over the cap and its neck, for m = 2 or 4 and k up to 2.
    pub(super) fn add_moment(&self, sum: f64, k: usize, m: usize) -> f64 {
        if self.is_flat {
            // The square of the radius is a polynomial, so that this is exact too.
            return sum + moment(self.base, self.top - self.base, |s| self.section(self.base + s), k, m);
        }
        let neck = moment(self.base, self.centre - self.base, |_| self.edge, k, m);
        sum + neck + half_ball(self.centre, self.radius, k, m)
    }

    /// Whether a ball on the axis stays below the cap.
    pub(super) fn covers(&self, centre: f64, radius: f64) -> bool {
        !self.is_flat || centre + radius <= self.top
    }

    /// Height of the centre and radius of the highest ball on the axis.
    pub(super) fn ball(&self, pieces: &[Piece]) -> [f64; 2] {
        if !self.is_flat {
            return [self.centre, self.radius];
        }
        let radius = self.largest(pieces, self.edge, |radius| [0.0, self.top - radius]);
        [self.top - radius, radius]
    }

    /// The rings of a flat cap: those below its edge, where balls on the axis would stick out above it, its edge, which
    /// is rounded like the `rim` of the foot, and the cap itself.
    pub(super) fn rings(&self, pieces: &[Piece], rim: f64, balance: f64) -> Vec<Ring> {
        if !self.is_flat {
            return Vec::new();
        }
        let height = self.top - self.base;
        let round = rim.min(0.5 * height).min(0.5 * self.edge);
        // Touches the cap from inside, and the vertical at its edge.
        let inner = self.radius - round;
        let circle = self.edge - round;
        let edge = [circle, self.centre + (inner * inner - circle * circle).max(0.0).sqrt()];
        let ring = |[circle, z]: [f64; 2], radius: f64| Ring { height: z - balance, circle, radius };
        let mut rings = vec![ring(edge, round)];
        // Balls on the axis end where their tops reach the cap's: a radius below it.
        let shoulder = (1..=Self::RINGS).map(|k| self.base - f64::from(k) / f64::from(Self::RINGS) * self.edge);
        let lowest = pieces[0].base;
        rings.extend(shoulder.filter(|z| *z > lowest).map(|z| {
            let (edge, slope) = profile_at(pieces, z);
            let cos = 1.0 / (1.0 + slope * slope).sqrt();
            let at = |radius: f64| [edge - radius * cos, z + radius * slope * cos];
            let radius = self.largest(pieces, 0.5 * self.edge, at);
            ring(at(radius), radius)
        }));
        // The angle from the axis to the edge, as seen from the sphere's centre.
        let whole = math::acos((self.base - self.centre) / self.radius);
        rings.extend((1..Self::RINGS).map(|k| {
            let (sin, cos) = math::sin_cos(whole * f64::from(k) / f64::from(Self::RINGS));
            let at = |radius: f64| [(self.radius - radius) * sin, self.centre + (self.radius - radius) * cos];
            let radius = self.largest(pieces, 0.5 * self.edge, at);
            ring(at(radius), radius)
        }));
        rings
    }

    /// The largest radius, of `most` and its parts, with which a ring whose section lies `at` a circle's radius and a
    /// height is inside the body.
    fn largest(&self, pieces: &[Piece], most: f64, at: impl Fn(f64) -> [f64; 2]) -> f64 {
        const ANGLES: u32 = 48;
        let allowed = 1e-9 * self.edge;
        let fits = |radius: f64| {
            let [circle, height] = at(radius);
            circle >= 0.0
                && (0..ANGLES).all(|k| {
                    let (sin, cos) = math::sin_cos(2.0 * FRAC_PI_2 * (f64::from(k) / f64::from(ANGLES - 1) - 0.5));
                    let z = height + radius * sin;
                    let outside = if z >= self.base { self.section(z) } else { profile_at(pieces, z).0 };
                    z <= self.top + allowed && circle + radius * cos <= outside + allowed
                })
        };
        (0..40).map(|k| most * math::powi(0.9, k)).find(|&radius| fits(radius)).unwrap_or(0.02 * most)
    }
}

/// The radius of the spline at a height, and its slope; those of its lower end below it.
fn profile_at(pieces: &[Piece], z: f64) -> (f64, f64) {
    let piece = pieces.iter().rev().find(|p| p.base <= z).unwrap_or(&pieces[0]);
    let s = (z - piece.base).clamp(0.0, piece.length);
    (piece.radius(s), piece.slope(s))
}

/// Half a ball above `centre`: `∫ z^k (R² − s²)^(m/2) ds`.
fn half_ball(centre: f64, radius: f64, k: usize, m: usize) -> f64 {
    let r = radius;
    let (r2, r3) = (r * r, r * r * r);
    // Moments of s against the section's power: m = 2 or 4, k up to 2.
    let s = |j: usize| match (j, m) {
        (0, 2) => 2.0 * r3 / 3.0,
        (1, 2) => r2 * r2 / 4.0,
        (2, 2) => 2.0 * r3 * r2 / 15.0,
        _ => 8.0 * r3 * r2 / 15.0,
    };
    match k {
        0 => s(0),
        1 => centre * s(0) + s(1),
        _ => centre * centre * s(0) + 2.0 * centre * s(1) + s(2),
    }
}
