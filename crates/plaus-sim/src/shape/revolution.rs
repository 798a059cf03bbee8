//! Bodies of revolution about their z axis, from a meridian profile.
//!
//! The profile is a flat foot, a rounded rim, and a cubic spline of the radius over the height, up to a cap that is
//! part of a sphere: half a ball on a neck, or, where the top is lower, a flatter part of a larger one. Mass, centre of
//! gravity and inertia are integrated exactly over the spline's pieces (they are polynomials), and by closed forms over
//! rim and cap. The skin consists of `stations` balls on the axis that touch it from inside, and of rings: the rim of
//! the foot and the flank above it, where balls on the axis would stick out below; and, under a flat cap, its edge and
//! the cap itself, where such balls would stick out above.

mod cap;

use super::piece::RIM;
use super::{ContactSphere, MassProperties};
use crate::error::{ProfileError, WorldError};
use cap::Cap;
use glam::DVec3;
use std::f64::consts::PI;

/// A circle about the axis, thickened to a ring.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Ring {
    /// Height over the centre of gravity in m.
    pub height: f64,
    /// Radius of the circle in m.
    pub circle: f64,
    /// Radius of the ring's section in m.
    pub radius: f64,
}

/// The meridian profile of a body of revolution, from its foot upwards; lengths in m.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Radius of the flat part of the foot.
    pub foot: f64,
    /// Rounding of the foot's rim.
    pub rim: f64,
    /// Heights and radii, from low to high; the last is where the cap begins.
    pub points: Vec<[f64; 2]>,
    /// Height of the top.
    pub top: f64,
}

/// A body of revolution about its centre of gravity.
#[derive(Debug, Clone, PartialEq)]
pub struct Revolution {
    row: Vec<ContactSphere>,
    rings: Vec<Ring>,
    bounding_radius: f64,
    /// Centre of gravity over the foot, volume, and second moments of the volume about it.
    balance: f64,
    volume: f64,
    across: f64,
    along: f64,
    is_off_centre: bool,
}

/// A cubic piece of the radius: `c₀ + c₁ s + c₂ s² + c₃ s³`, `s` from 0 to `length` above `base`.
#[derive(Debug, Clone, Copy)]
struct Piece {
    base: f64,
    length: f64,
    c: [f64; 4],
}

const INCH: f64 = 0.0254;

impl Profile {
    /// The regulation pin: diameters at heights from USBC's drawing, with a foot of 2.031 in, its rim rounded by 5/32
    /// in, and a head of radius 1.2735 in.
    #[must_use]
    pub fn pin() -> Self {
        let table = [
            [0.75, 2.828],
            [2.25, 3.906],
            [3.375, 4.510],
            [4.5, 4.766],
            [5.875, 4.563],
            [7.25, 3.703],
            [8.625, 2.472],
            [9.375, 1.965],
            [10.0, 1.797],
            [10.875, 1.870],
            [11.75, 2.094],
            [12.625, 2.406],
            [13.5, 2.547],
        ];
        let points = table.map(|[height, diameter]| [height * INCH, 0.5 * diameter * INCH]).to_vec();
        Self { foot: 0.5 * 2.031 * INCH, rim: 5.0 / 32.0 * INCH, points, top: 15.0 * INCH }
    }

    fn check(&self) -> Result<(), WorldError> {
        let bad = |error| Err(WorldError::BadProfile(error));
        for (what, value) in [("foot", self.foot), ("rim", self.rim), ("top", self.top)] {
            if !(value > 0.0 && value.is_finite()) {
                return bad(ProfileError::NotPositive { what, value });
            }
        }
        if self.points.len() < 3 {
            return bad(ProfileError::FewPoints { points: self.points.len() });
        }
        let (mut after, top) = (self.rim, self.top);
        for &[height, radius] in &self.points {
            if height.is_nan() || height <= after {
                return bad(ProfileError::Falls { height, after });
            }
            if height.is_nan() || height >= top {
                return bad(ProfileError::AboveTop { height, top });
            }
            if !(radius > 0.0 && radius.is_finite()) {
                return bad(ProfileError::NotPositive { what: "radius", value: radius });
            }
            after = height;
        }
        let [height, radius] = self.points[self.points.len() - 1];
        if top - height < Cap::FLATTEST * radius {
            return bad(ProfileError::NoRoom { top, height, least: Cap::FLATTEST * radius });
        }
        Ok(())
    }

    /// About this many points (radius, height over the foot) on the meridian from the foot's edge to the top, for
    /// drawing; closer together where it bends more.
    ///
    /// # Errors
    /// [`WorldError::BadProfile`] if the profile does not rise from its foot to its cap.
    pub fn outline(&self, points: usize) -> Result<Vec<[f64; 2]>, WorldError> {
        self.check()?;
        let pieces = self.pieces();
        let share = |count: usize| (0..count).map(move |k| k as f64 / count as f64);
        let mut outline: Vec<[f64; 2]> = share(4)
            .map(|s| {
                let height = pieces[0].base * s * s;
                [self.foot + (self.rim * self.rim - (self.rim - height) * (self.rim - height)).max(0.0).sqrt(), height]
            })
            .collect();
        let each = (points / (pieces.len() + 4)).max(1);
        for piece in &pieces {
            outline.extend(share(each).map(|s| [piece.radius(s * piece.length), piece.base + s * piece.length]));
        }
        let cap = Cap::of(self);
        outline.extend(share(4 * each).chain([1.0]).map(|s| cap.outline(s)));
        Ok(outline)
    }

    /// The spline: it leaves the rim in the rim's own direction, and is vertical where the cap begins.
    fn pieces(&self) -> Vec<Piece> {
        let [z1, r1] = self.points[0];
        // The rim's tangent towards the first point. The place where it leaves the rim depends on the slope, so it
        // takes a few rounds.
        let mut slope = 0.0_f64;
        let mut start = [0.0; 2];
        for _ in 0..60 {
            let c = 1.0 / (1.0 + slope * slope).sqrt();
            start = [self.rim * (1.0 - slope * c), self.foot + self.rim * c];
            slope = (r1 - start[1]) / (z1 - start[0]);
        }
        let mut knots = vec![start];
        knots.extend_from_slice(&self.points);
        let slopes = clamped_slopes(&knots, slope);
        let pieces = knots.windows(2).zip(slopes.windows(2)).map(|(k, s)| {
            let length = k[1][0] - k[0][0];
            let rise = (k[1][1] - k[0][1]) / length;
            let c2 = (3.0 * rise - 2.0 * s[0] - s[1]) / length;
            let c3 = (s[0] + s[1] - 2.0 * rise) / (length * length);
            Piece { base: k[0][0], length, c: [k[0][1], s[0], c2, c3] }
        });
        pieces.collect()
    }
}

/// Slopes at the knots of the twice differentiable cubic spline with the given slope at the lower end and slope 0 at
/// the upper end.
fn clamped_slopes(knots: &[[f64; 2]], first: f64) -> Vec<f64> {
    let n = knots.len();
    let h: Vec<f64> = knots.windows(2).map(|k| k[1][0] - k[0][0]).collect();
    let d: Vec<f64> = knots.windows(2).map(|k| (k[1][1] - k[0][1]) / (k[1][0] - k[0][0])).collect();
    // Thomas' algorithm on h_i s_{i-1} + 2 (h_{i-1} + h_i) s_i + h_{i-1} s_{i+1} = 3 (h_i d_{i-1} + h_{i-1} d_i).
    let (mut upper, mut right) = (vec![0.0; n], vec![0.0; n]);
    right[0] = first;
    for i in 1..n - 1 {
        let diagonal = 2.0 * (h[i - 1] + h[i]) - h[i] * upper[i - 1];
        upper[i] = h[i - 1] / diagonal;
        right[i] = (3.0 * (h[i] * d[i - 1] + h[i - 1] * d[i]) - h[i] * right[i - 1]) / diagonal;
    }
    let mut slopes = vec![0.0; n];
    for i in (0..n - 1).rev() {
        slopes[i] = right[i] - upper[i] * slopes[i + 1];
    }
    slopes
}

/// `∫ z^k r^m dz` over a piece.
fn integral(p: &Piece, k: usize, m: usize) -> f64 {
    moment(p.base, p.length, |s| p.radius(s), k, m)
}

/// `∫ z^k r(s)^m ds` for `z = base + s` over `s` in `[0, length]`, by Gauss–Legendre with eight points: exact up to
/// degree 15, and `r⁴ z²` of a cubic has degree 14.
fn moment(base: f64, length: f64, radius: impl Fn(f64) -> f64, k: usize, m: usize) -> f64 {
    const NODES: [[f64; 2]; 4] = [
        [0.183_434_642_495_649_8, 0.362_683_783_378_362],
        [0.525_532_409_916_329, 0.313_706_645_877_887_27],
        [0.796_666_477_413_626_7, 0.222_381_034_453_374_48],
        [0.960_289_856_497_536_3, 0.101_228_536_290_376_26],
    ];
    let f = |s: f64| {
        let (z, r) = (base + s, radius(s));
        (0..k).map(|_| z).product::<f64>() * (0..m).map(|_| r).product::<f64>()
    };
    let half = 0.5 * length;
    NODES.iter().map(|[x, w]| w * (f(half * (1.0 - x)) + f(half * (1.0 + x)))).sum::<f64>() * half
}

impl Piece {
    fn radius(&self, s: f64) -> f64 {
        self.c[0] + s * (self.c[1] + s * (self.c[2] + s * self.c[3]))
    }

    fn slope(&self, s: f64) -> f64 {
        self.c[1] + s * (2.0 * self.c[2] + s * (3.0 * self.c[3]))
    }
}

impl Revolution {
    /// A body of revolution whose skin is made of about `stations` balls. Usual 24–64; between two of them the skin
    /// lies too deep by up to about `spacing²/(8 radius)`.
    ///
    /// # Errors
    /// [`WorldError::BadProfile`] if the profile does not rise from its foot to its cap.
    pub fn new(profile: &Profile, stations: usize) -> Result<Self, WorldError> {
        profile.check()?;
        let pieces = profile.pieces();
        let cap = Cap::of(profile);
        // Moments ∫ z^k r^m of all parts: spline, cap, and the foot with its rim.
        let moment = |k: usize, m: usize| {
            let spline: f64 = pieces.iter().map(|p| integral(p, k, m)).sum();
            cap.add_moment(spline, k, m) + rim(profile, pieces[0].base, k, m)
        };
        let volume = PI * moment(0, 2);
        let balance = PI * moment(1, 2) / volume;
        let along = 0.5 * PI * moment(0, 4);
        let across = 0.5 * along + PI * moment(2, 2) - volume * balance * balance;
        let (row, flank) = row(&pieces, stations, balance, &cap);
        let mut rings = vec![Ring { height: profile.rim - balance, circle: profile.foot, radius: profile.rim }];
        rings.extend(flank_rings(&pieces, flank, profile.rim, balance));
        rings.extend(cap.rings(&pieces, profile.rim, balance));
        let bounding_radius =
            row.iter().map(|f| f.centre.length() + f.radius).chain(rings.iter().map(Ring::reach)).fold(0.0, f64::max);
        Ok(Self { row, rings, bounding_radius, balance, volume, across, along, is_off_centre: false })
    }

    /// The same about another point of its axis.
    pub(super) fn about(&self, point: DVec3) -> Result<Self, WorldError> {
        if point.x != 0.0 || point.y != 0.0 {
            let value = point.truncate().length();
            let field = "distance from its axis of the origin of a body of revolution";
            return Err(WorldError::BadNumber { field, value, expected: "0" });
        }
        let mut moved = Self { is_off_centre: true, ..self.clone() };
        moved.row.iter_mut().for_each(|ball| ball.centre.z -= point.z);
        moved.rings.iter_mut().for_each(|ring| ring.height -= point.z);
        let balls = moved.row.iter().map(|f| f.centre.length() + f.radius);
        moved.bounding_radius = balls.chain(moved.rings.iter().map(Ring::reach)).fold(0.0, f64::max);
        Ok(moved)
    }

    pub(super) fn is_off_centre(&self) -> bool {
        self.is_off_centre
    }

    /// The balls of the skin, from the lowest up; all on the axis.
    #[must_use]
    pub fn row(&self) -> &[ContactSphere] {
        &self.row
    }

    /// Balls along its rings and under its foot, which the balls of its row leave out; at most 16 along a radius.
    pub(super) fn contact_spheres_between(&self, spacing: f64) -> Vec<ContactSphere> {
        let around = |ring: Ring, circle: f64| {
            (0..RIM).map(move |k| {
                let (s, c) = plaus_dist::math::sin_cos(2.0 * PI * (k as f64 / RIM as f64));
                ContactSphere { centre: DVec3::new(circle * c, circle * s, ring.height), radius: ring.radius }
            })
        };
        let mut spheres: Vec<_> = self.rings.iter().flat_map(|ring| around(*ring, ring.circle)).collect();
        if let Some(&foot) = self.rings.first() {
            let parts = (foot.circle / spacing).ceil().clamp(1.0, 16.0) as usize;
            spheres.extend((1..parts).flat_map(|k| around(foot, foot.circle * (k as f64 / parts as f64))));
            spheres.push(ContactSphere { centre: DVec3::Z * foot.height, radius: foot.radius });
        }
        spheres
    }

    /// The rings of the skin; the first is the rim of the foot.
    #[must_use]
    pub fn rings(&self) -> &[Ring] {
        &self.rings
    }

    /// Radius of the sphere around the centre of gravity that holds the body.
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.bounding_radius
    }

    /// Height of the centre of gravity over the foot, in m.
    #[must_use]
    pub fn balance(&self) -> f64 {
        self.balance
    }

    /// Mass and inertia for a uniform density.
    #[must_use]
    pub fn mass_properties(&self, density: f64) -> MassProperties {
        MassProperties {
            mass: density * self.volume,
            inertia: DVec3::new(self.across, self.across, self.along) * density,
        }
    }
}

impl Ring {
    fn reach(&self) -> f64 {
        (self.height * self.height + self.circle * self.circle).sqrt() + self.radius
    }
}

/// The slice between the floor and the height where the spline leaves the rim, whose radius is
/// `foot + √(rim² − (rim − z)²)`: a sum over fine slices.
fn rim(profile: &Profile, height: f64, k: usize, m: usize) -> f64 {
    // The substitution z = height · x² removes the square root's singularity at the floor; the rest is smooth.
    const SLICES: usize = 64;
    let piece_sum: f64 = (0..SLICES)
        .map(|i| {
            let x = (i as f64 + 0.5) / SLICES as f64;
            let z = height * x * x;
            let depth = profile.rim - z;
            let r = profile.foot + (profile.rim * profile.rim - depth * depth).max(0.0).sqrt();
            (0..k).map(|_| z).product::<f64>() * (0..m).map(|_| r).product::<f64>() * 2.0 * x * height / SLICES as f64
        })
        .sum();
    piece_sum
}

/// Balls on the axis that touch the profile, evenly over its height, and the height below which they would stick out of
/// the foot.
fn row(pieces: &[Piece], stations: usize, balance: f64, cap: &Cap) -> (Vec<ContactSphere>, f64) {
    let (base, end) = (pieces[0].base, pieces[pieces.len() - 1].base + pieces[pieces.len() - 1].length);
    let mut row = Vec::new();
    let mut flank = base;
    for k in 0..stations {
        let z = base + (end - base) * (k as f64 / stations as f64);
        let p = pieces.iter().rev().find(|p| p.base <= z).unwrap_or(&pieces[0]);
        let (r, slope) = (p.radius(z - p.base), p.slope(z - p.base));
        let (centre, radius) = (z + r * slope, r * (1.0 + slope * slope).sqrt());
        if centre - radius <= 0.0 {
            flank = z;
        } else if cap.covers(centre, radius) {
            row.push(ContactSphere { centre: DVec3::new(0.0, 0.0, centre - balance), radius });
        }
    }
    let [centre, radius] = cap.ball(pieces);
    row.push(ContactSphere { centre: DVec3::new(0.0, 0.0, centre - balance), radius });
    (row, flank)
}

/// Rings that touch the profile from inside, from the rim up to the first ball.
fn flank_rings(pieces: &[Piece], flank: f64, thickness: f64, balance: f64) -> Vec<Ring> {
    const COUNT: usize = 3;
    let base = pieces[0].base;
    (1..=COUNT)
        .map(|k| {
            let z = base + (flank - base) * (k as f64 / COUNT as f64);
            let p = pieces.iter().rev().find(|p| p.base <= z).unwrap_or(&pieces[0]);
            let (r, slope) = (p.radius(z - p.base), p.slope(z - p.base));
            let c = 1.0 / (1.0 + slope * slope).sqrt();
            Ring { height: z + thickness * slope * c - balance, circle: r - thickness * c, radius: thickness }
        })
        .collect()
}

#[cfg(test)]
mod tests;
