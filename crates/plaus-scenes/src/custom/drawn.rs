//! Corners and triangles of shapes, as they are drawn.

use crate::animation;
use glam::DVec3;
use plaus_dist::math;
use plaus_sim::shape::Frustum;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Points of a drawn quarter circle.
const ARC: usize = 8;
/// Corners of a drawn circle.
const ROUND: u32 = 48;

/// The outline of a solid of revolution, from the lowest height to the highest: its rounding as arcs.
pub(super) fn profile(frustum: &Frustum) -> Vec<[f64; 2]> {
    let [[low, wide], [high, narrow]] = frustum.discs();
    let rounding = frustum.rounding();
    if rounding == 0.0 {
        return vec![[0.0, low], [wide, low], [narrow, high], [0.0, high]];
    }
    let arc = |height: f64, radius: f64, from: f64| {
        (0..=ARC).map(move |k| {
            let (sin, cos) = math::sin_cos(from + FRAC_PI_2 * k as f64 / ARC as f64);
            [radius + rounding * cos.max(0.0), height + rounding * sin]
        })
    };
    arc(low, wide, -FRAC_PI_2).chain(arc(high, narrow, 0.0)).collect()
}

/// Corners and triangles of a drawn shape, anticlockwise as seen from outside: for what stands still.
pub(super) fn mesh(shape: &animation::Shape) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let outline: Vec<[f64; 2]> = match shape {
        animation::Shape::Solid { vertices, triangles } => return (vertices.clone(), triangles.clone()),
        animation::Shape::Cuboid { half, .. } => return cuboid(*half),
        animation::Shape::Revolution { profile, .. } => profile.clone(),
        animation::Shape::Disc { radius, thickness } => {
            vec![[*radius, -0.5 * thickness], [*radius, 0.5 * thickness]]
        }
        animation::Shape::Sphere { radius, .. } => {
            let point = |k: usize| {
                let (sin, cos) = math::sin_cos(FRAC_PI_2 * (k as f64 / ARC as f64 - 1.0));
                [radius * cos.max(0.0), radius * sin]
            };
            (0..=2 * ARC).map(point).collect()
        }
    };
    revolved(&outline)
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
