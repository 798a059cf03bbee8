//! Corners and triangles of shapes.

use super::shape::Shape;
use glam::DVec3;
use plaus_dist::math;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Points of a quarter circle.
const ARC: usize = 8;
/// Corners of a circle.
const ROUND: u32 = 48;

impl Shape {
    /// Corners and triangles, anticlockwise as seen from outside; what is round is a polyhedron with its corners on the
    /// surface.
    #[must_use]
    pub fn surface(&self) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        match self {
            Self::Solid { vertices, triangles } => (vertices.clone(), triangles.clone()),
            Self::Cuboid { half, .. } => cuboid(*half),
            Self::Revolution { profile, .. } => revolved(profile),
            Self::Disc { radius, thickness } => revolved(&[[*radius, -0.5 * thickness], [*radius, 0.5 * thickness]]),
            Self::Sphere { radius, .. } => {
                let point = |k: usize| {
                    let (sin, cos) = math::sin_cos(FRAC_PI_2 * (k as f64 / ARC as f64 - 1.0));
                    [radius * cos.max(0.0), radius * sin]
                };
                revolved(&(0..=2 * ARC).map(point).collect::<Vec<_>>())
            }
        }
    }
}

fn cuboid(half: DVec3) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let side = |k: u32, axis: u32| if k >> axis & 1 == 1 { 1.0 } else { -1.0 };
    let corners = (0..8).map(|k| half * DVec3::new(side(k, 0), side(k, 1), side(k, 2))).collect();
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    (corners, faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect())
}

/// An outline turned about the z axis, closed at both ends.
fn revolved(outline: &[[f64; 2]]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let rows = outline.len() as u32;
    let mut vertices = Vec::new();
    for &[radius, height] in outline {
        vertices.extend((0..ROUND).map(|k| {
            let (sin, cos) = math::sin_cos(TAU * f64::from(k) / f64::from(ROUND));
            DVec3::new(radius * cos, radius * sin, height)
        }));
    }
    let ends = [outline.first(), outline.last()].map(|end| DVec3::new(0.0, 0.0, end.map_or(0.0, |end| end[1])));
    vertices.extend(ends);
    let mut triangles = Vec::new();
    for k in 0..ROUND {
        let next = (k + 1) % ROUND;
        for row in 0..rows.saturating_sub(1) {
            let [a, b, c, d] = [row * ROUND + k, row * ROUND + next, (row + 1) * ROUND + next, (row + 1) * ROUND + k];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
        let top = rows.saturating_sub(1) * ROUND;
        triangles.extend([[rows * ROUND, next, k], [rows * ROUND + 1, top + k, top + next]]);
    }
    (vertices, triangles)
}
